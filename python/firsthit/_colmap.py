"""COLMAP's cameras and images, in text and binary: https://colmap.github.io/format.html."""

from __future__ import annotations

import math
import os
import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ._conventions import quaternion
from ._errors import FileFormatError, FileReadError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ._camera import Camera

#: The models by their numbers in binary files: name, parameters as this package's projection
#: names them, and the projection.
_MODELS: dict[int, tuple[str, tuple[str, ...], str]] = {
    0: ("SIMPLE_PINHOLE", ("f", "cx", "cy"), "perspective"),
    1: ("PINHOLE", ("fx", "fy", "cx", "cy"), "perspective"),
    2: ("SIMPLE_RADIAL", ("f", "cx", "cy", "k1"), "opencv"),
    3: ("RADIAL", ("f", "cx", "cy", "k1", "k2"), "opencv"),
    4: ("OPENCV", ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2"), "opencv"),
    5: ("OPENCV_FISHEYE", ("fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"), "opencv_fisheye"),
    6: (
        "FULL_OPENCV",
        ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"),
        "opencv",
    ),
    7: ("FOV", ("fx", "fy", "cx", "cy", "omega"), "fov"),
    8: ("SIMPLE_RADIAL_FISHEYE", ("f", "cx", "cy", "k1"), "opencv_fisheye"),
    9: ("RADIAL_FISHEYE", ("f", "cx", "cy", "k1", "k2"), "opencv_fisheye"),
    10: (
        "THIN_PRISM_FISHEYE",
        ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "sx1", "sy1"),
        "thin_prism_fisheye",
    ),
    11: (
        "RAD_TAN_THIN_PRISM_FISHEYE",
        (
            *("fx", "fy", "cx", "cy", "k0", "k1", "k2", "k3", "k4", "k5"),
            *("p0", "p1", "s0", "s1", "s2", "s3"),
        ),
        "rad_tan_thin_prism_fisheye",
    ),
    14: ("SIMPLE_FISHEYE", ("f", "cx", "cy"), "equidistant"),
    15: ("FISHEYE", ("fx", "fy", "cx", "cy"), "equidistant"),
    16: ("EUCM", ("fx", "fy", "cx", "cy", "alpha", "beta"), "eucm"),
}
#: Those that are known and that no projection here is.
_OTHERS = {12: "SIMPLE_DIVISION", 13: "DIVISION", 17: "EQUIRECTANGULAR"}


@dataclass(frozen=True)
class ColmapCamera:
    """A camera as COLMAP has it; the centre of the first pixel is at (0.5, 0.5).

    Attributes
    ----------
    model : str
        The model's name, such as ``OPENCV``.
    width, height : int
        Columns and rows.
    params : tuple of float
        The model's parameters, in COLMAP's order.
    qvec : tuple of 4 float
        The rotation from the world to the camera as a quaternion, real part first.
    tvec : tuple of 3 float
        The translation from the world to the camera.
    """

    model: str
    width: int
    height: int
    params: tuple[float, ...]
    qvec: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    tvec: tuple[float, float, float] = field(default=(0.0, 0.0, 0.0))

    def camera_line(self, camera_id: int = 1) -> str:
        """Return the line of ``cameras.txt``."""
        numbers = " ".join(map(repr, self.params))
        return f"{camera_id} {self.model} {self.width} {self.height} {numbers}"

    def image_lines(self, name: str, image_id: int = 1, camera_id: int = 1) -> str:
        """Return the two lines of ``images.txt``; the second, of observed points, is empty."""
        pose = " ".join(map(repr, (*self.qvec, *self.tvec)))
        return f"{image_id} {pose} {camera_id} {name}\n"


def from_camera(camera: Camera) -> ColmapCamera:
    """Return a camera in COLMAP's words."""
    k, matrix = camera._native.matrices("colmap")
    numbers = dict(camera.parameters)
    if k is None or camera.ray_start != "eye" or k[0][1]:
        raise ValueError(
            "COLMAP has perspective and calibrated cameras without skew whose rays start at the "
            f"eye, got {camera.projection} with skew {0.0 if k is None else k[0][1]} and rays from "
            f"the {camera.ray_start}"
        )
    numbers.update(fx=k[0][0], fy=k[1][1], cx=k[0][2], cy=k[1][2])
    used = {name for name, value in numbers.items() if value and name not in _PLACE}
    # COLMAP's fisheyes have no edge.
    used -= {"fov"} if numbers.get("fov") == 360.0 else set()
    for name, parameters, projection in _MODELS.values():
        is_simple = "f" in parameters
        if is_simple or projection != camera.projection:
            continue
        if projection == "perspective" or used <= set(parameters):
            params = tuple(numbers[each] for each in parameters)
            w, (x, y, z) = quaternion(np.array(matrix)[:3, :3])
            qvec = (w, float(x), float(y), float(z))
            tx, ty, tz = (row[3] for row in matrix[:3])
            return ColmapCamera(name, camera.columns, camera.rows, params, qvec, (tx, ty, tz))
    raise ValueError(
        f"COLMAP has no model for {camera.projection} with {', '.join(sorted(used)) or 'nothing'}"
    )


#: What is in K, or says where a viewplane is.
_PLACE = frozenset(("fx", "fy", "cx", "cy", "skew", "focal_length", "width", "height"))


@dataclass(frozen=True)
class Intrinsics:
    """A line of ``cameras.txt`` in this package's words."""

    projection: str
    matrix: tuple[float, float, float, float]
    parameters: tuple[tuple[str, float], ...]
    rows: int
    columns: int


@dataclass(frozen=True)
class Pose:
    """A line of ``images.txt``: its name, its camera, and camera from world."""

    name: str
    camera: int
    matrix: tuple[tuple[float, float, float, float], ...]


def read_cameras(path: str | os.PathLike[str]) -> dict[int, Intrinsics]:
    """Read ``cameras.txt`` or ``cameras.bin``."""
    data = _bytes(path)
    made = {}
    if Path(path).suffix == ".bin":
        reader = _Binary(path, data)
        for _ in range(reader.count()):
            number, model, width, height = reader.take("<iiQQ")
            parameters = _MODELS.get(model)
            if parameters is None:
                raise reader.wrong(_unknown(model, str(model)))
            values = reader.take(f"<{len(parameters[1])}d")
            made[number] = _intrinsics(path, "", parameters, width, height, values)
        return made
    for line, words in _lines(path, data):
        where = f"line {line}: "
        if not words:
            continue
        if len(words) < 4:
            raise _wrong(path, f"{where}expected CAMERA_ID MODEL WIDTH HEIGHT PARAMS")
        parameters = next((m for m in _MODELS.values() if m[0] == words[1]), None)
        if parameters is None:
            raise _wrong(path, where + _unknown(None, words[1]))
        number, width, height = (_whole(path, where, word) for word in (words[0], *words[2:4]))
        values = tuple(_float(path, where, word) for word in words[4:])
        if len(values) != len(parameters[1]):
            wanted = f"{len(parameters[1])} parameters ({', '.join(parameters[1])})"
            raise _wrong(path, f"{where}{words[1]} must have {wanted}, got {len(values)}")
        made[number] = _intrinsics(path, where, parameters, width, height, values)
    return made


def read_images(path: str | os.PathLike[str]) -> list[Pose]:
    """Read ``images.txt`` or ``images.bin``, in the order of the file."""
    data = _bytes(path)
    made = []
    if Path(path).suffix == ".bin":
        reader = _Binary(path, data)
        for _ in range(reader.count()):
            _, *numbers, camera = reader.take("<i7di")
            name = reader.text()
            (points,) = reader.take("<Q")
            reader.skip(24 * points)
            made.append(Pose(name, camera, _matrix(path, f"image {name!r}: ", numbers)))
        return made
    is_points = False
    for line, words in _lines(path, data, keep_empty=True):
        # Every second line has an image's points, and may be empty.
        if is_points or not words:
            is_points = False
            continue
        is_points = True
        where = f"line {line}: "
        if len(words) < 10:
            raise _wrong(path, f"{where}expected IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME")
        numbers = [_float(path, where, word) for word in words[1:8]]
        name = " ".join(words[9:])
        camera = _whole(path, where, words[8])
        made.append(Pose(name, camera, _matrix(path, where, numbers)))
    return made


def _intrinsics(
    path: str | os.PathLike[str],
    where: str,
    model: tuple[str, tuple[str, ...], str],
    width: int,
    height: int,
    values: tuple[float, ...],
) -> Intrinsics:
    _, names, projection = model
    if not all(map(math.isfinite, values)):
        raise _wrong(path, f"{where}parameters must be finite, got {values}")
    numbers = dict(zip(names, values, strict=True))
    both = numbers.pop("f", None)
    fx, fy = (numbers.pop("fx"), numbers.pop("fy")) if both is None else (both, both)
    matrix = fx, fy, numbers.pop("cx"), numbers.pop("cy")
    return Intrinsics(projection, matrix, tuple(numbers.items()), height, width)


def _matrix(
    path: str | os.PathLike[str], where: str, numbers: list[float]
) -> tuple[tuple[float, float, float, float], ...]:
    """Return camera from world of a quaternion, real part first, and a translation."""
    w, x, y, z, *t = numbers
    square = w * w + x * x + y * y + z * z
    if not all(map(math.isfinite, numbers)) or not 0.0 < square < math.inf:
        raise _wrong(path, f"{where}a pose must be a quaternion and a translation, got {numbers}")
    s = 2.0 / square
    return (
        (1.0 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y), t[0]),
        (s * (x * y + w * z), 1.0 - s * (x * x + z * z), s * (y * z - w * x), t[1]),
        (s * (x * z - w * y), s * (y * z + w * x), 1.0 - s * (x * x + y * y), t[2]),
        (0.0, 0.0, 0.0, 1.0),
    )


def _unknown(number: int | None, name: str) -> str:
    name = name if number is None else _OTHERS.get(number, name)
    if name in _OTHERS.values():
        return f"the model {name} is not supported"
    known = ", ".join(model[0] for model in _MODELS.values())
    return f"the model must be one of {known}, got {name!r}"


def _bytes(path: str | os.PathLike[str]) -> bytes:
    # To open a pipe would wait for its other end.
    if Path(path).exists() and not Path(path).is_file():
        text = os.fspath(path)
        raise FileReadError(f"{text}: not a regular file", text)
    try:
        return Path(path).read_bytes()
    except OSError as error:
        text = os.fspath(path)
        raise FileReadError(f"{text}: {error.strerror}", text) from None


def _lines(
    path: str | os.PathLike[str], data: bytes, *, keep_empty: bool = False
) -> Iterator[tuple[int, list[str]]]:
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise _wrong(path, f"must be UTF-8 text: {error}") from None
    for line, content in enumerate(text.splitlines(), 1):
        if content.startswith("#") or not (keep_empty or content.strip()):
            continue
        yield line, content.split()


class _Binary:
    """A binary file, from its beginning on."""

    def __init__(self, path: str | os.PathLike[str], data: bytes) -> None:
        self._path, self._data, self._at = path, data, 0

    def take(self, layout: str) -> tuple[Any, ...]:
        size = struct.calcsize(layout)
        if self._at + size > len(self._data):
            raise self.wrong("the file is cut off")
        made = struct.unpack_from(layout, self._data, self._at)
        self._at += size
        return made

    def count(self) -> int:
        count: int
        (count,) = self.take("<Q")
        if count > len(self._data):
            raise self.wrong(f"the file says that it has {count} entries, and is too short")
        return count

    def text(self) -> str:
        end = self._data.find(b"\0", self._at)
        if end < 0:
            raise self.wrong("the file is cut off")
        made = self._data[self._at : end].decode("utf-8", "replace")
        self._at = end + 1
        return made

    def skip(self, count: int) -> None:
        if self._at + count > len(self._data):
            raise self.wrong("the file is cut off")
        self._at += count

    def wrong(self, what: str) -> FileFormatError:
        return _wrong(self._path, f"byte {self._at}: {what}")


def _whole(path: str | os.PathLike[str], where: str, word: str) -> int:
    try:
        return int(word)
    except ValueError:
        raise _wrong(path, f"{where}expected a whole number, got {word[:40]!r}") from None


def _float(path: str | os.PathLike[str], where: str, word: str) -> float:
    try:
        return float(word)
    except ValueError:
        raise _wrong(path, f"{where}expected a number, got {word[:40]!r}") from None


def _wrong(path: str | os.PathLike[str], what: str) -> FileFormatError:
    text = os.fspath(path)
    return FileFormatError(f"{text}: {what}", text)
