"""Calibrations and sets of images as other programs write them: ROS, Kalibr, nerfstudio."""

from __future__ import annotations

import json
import math
import os
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from firsthit._base.arrays import one_of
from firsthit._base.errors import FileFormatError
from firsthit._base.optional import optional

from .colmap import content
from .conventions import FISHEYE, OPENCV

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit.typing import Convention, Projection

#: Calibrations are small; a list of images may have some hundred thousand of them.
_MOST_BYTES = 1 << 28


class Calibration(NamedTuple):
    """The arguments of `Camera.from_intrinsics`."""

    rows: int
    columns: int
    K: list[float]
    convention: Convention
    pose: npt.NDArray[np.float64]
    projection: Projection
    parameters: dict[str, float]


class _Table:
    """A table of a file, which knows where it stands there."""

    def __init__(self, value: object, where: str) -> None:
        if not isinstance(value, dict):
            raise ValueError(f"{where or 'the file'} must be a table, got {_shown(value)}")
        self.value, self.where = value, where

    def has(self, name: str) -> bool:
        return self.value.get(name) is not None

    def get(self, *names: str) -> Any:
        """Return the value that stands there by one of some names."""
        for name in names:
            if self.has(name):
                return self.value[name]
        raise ValueError(f"{self._at(names[0])} is missing")

    def table(self, name: str) -> _Table:
        return _Table(self.get(name), self._at(name))

    def word(self, name: str, default: str) -> str:
        value = self.get(name) if self.has(name) else default
        if not isinstance(value, str):
            raise ValueError(f"{self._at(name)} must be a word, got {_shown(value)}")
        return value

    def number(self, *names: str) -> float:
        return _number(self._at(names[0]), self.get(*names))

    def whole(self, *names: str) -> int:
        number = self.number(*names)
        if number != int(number) or number < 0:
            raise ValueError(f"{self._at(names[0])} must be a whole number, got {number}")
        return int(number)

    def numbers(self, name: str, *counts: int) -> list[float]:
        """Return a list of numbers, as long as one of these counts if there are any."""
        value = self.get(name)
        # A matrix is a table with its size beside its numbers, or the numbers alone.
        listed = value.get("data") if isinstance(value, dict) else value
        if not isinstance(listed, list) or (counts and len(listed) not in counts):
            lengths = " or ".join(map(str, counts)) or "some"
            raise ValueError(f"{self._at(name)} must be {lengths} numbers, got {_shown(value)}")
        return [_number(self._at(name), each) for each in listed]

    def matrix(self, name: str) -> npt.NDArray[np.float64]:
        """Return a 4 x 4 matrix, of which the last row may be missing."""
        rows = self.get(name)
        fine = isinstance(rows, list) and len(rows) in (3, 4)
        if not fine or not all(isinstance(row, list) and len(row) == 4 for row in rows):
            raise ValueError(f"{self._at(name)} must be a 4 x 4 matrix, got {_shown(rows)}")
        made = np.array([[_number(self._at(name), each) for each in row] for row in rows])
        return made if len(rows) == 4 else np.vstack([made, (0.0, 0.0, 0.0, 1.0)])

    def _at(self, name: str) -> str:
        return f"{self.where}.{name}" if self.where else name


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) < 80 else f"{text[:76]} ..."


def _number(name: str, value: object) -> float:
    # To YAML 1.1 what has an exponent and no point is a word.
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError(f"{name} must be a number, got {_shown(value)}")
    try:
        number = float(value)
    except (ValueError, OverflowError):
        raise ValueError(f"{name} must be a number, got {_shown(value)}") from None
    if not math.isfinite(number):
        raise ValueError(f"{name} must be finite, got {number}")
    return number


class CalibrationFile:
    """A file of one table, whose errors name it."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = os.fspath(path)

    def __enter__(self) -> CalibrationFile:
        return self

    def __exit__(self, _kind: object, error: BaseException | None, _trace: object) -> None:
        if isinstance(error, FileFormatError):
            return
        if isinstance(error, ValueError | RecursionError):
            why = "nested too deeply" if isinstance(error, RecursionError) else str(error)
            raise FileFormatError._of(self.path, why) from None

    def _text(self) -> str:
        read = content(self.path)
        if len(read) > _MOST_BYTES:
            raise ValueError(f"over the limit of {_MOST_BYTES} bytes")
        return read.decode("utf-8-sig")

    def yaml(self) -> _Table:
        """Return the table of the file's first document."""
        yaml = optional("yaml", "a YAML file", "PyYAML")
        text = self._text()
        try:
            return _Table(next(iter(yaml.safe_load_all(text)), None), "")
        except yaml.YAMLError as error:
            raise ValueError(" ".join(str(error).split())) from None

    def json(self) -> _Table:
        """Return the table of a file in JSON."""
        return _Table(json.loads(self._text()), "")


#: ROS's names of the models, and how many coefficients they take.
_ROS: dict[str, tuple[Projection, tuple[str, ...], tuple[int, ...]]]
_ROS = {
    "plumb_bob": ("opencv", OPENCV, (4, 5)),
    "rational_polynomial": ("opencv", OPENCV, (8, 12, 14)),
    "equidistant": ("opencv_fisheye", FISHEYE, (4,)),
    "fisheye": ("opencv_fisheye", FISHEYE, (4,)),
}


class RosCamera(NamedTuple):
    """The camera of a ``CameraInfo`` without its binning and its region."""

    calibration: Calibration
    #: Rows and columns that are read out, each from and to.
    region: tuple[int, int, int, int] | None
    #: How many rows and columns become one.
    binning: tuple[int, int]


def of_ros(info: _Table, pose: npt.NDArray[np.float64]) -> RosCamera:
    """Return the camera of a ``CameraInfo``: a message's text, or a file of camera_calibration."""
    rows, columns = info.whole("image_height", "height"), info.whole("image_width", "width")
    names = {"K": ("camera_matrix", "K", "k"), "D": ("distortion_coefficients", "D", "d")}
    k = next((info.numbers(name, 9) for name in names["K"] if info.has(name)), None)
    if k is None:
        raise ValueError("camera_matrix (or K) is missing")
    given = next((info.numbers(name) for name in names["D"] if info.has(name)), [])
    model = info.word("distortion_model", "plumb_bob" if given else "")
    projection: Projection = "perspective"
    parameters: dict[str, float] = {}
    if any(given):
        one_of("distortion_model", model, _ROS)
        projection, order, counts = _ROS[model]
        if len(given) not in counts:
            lengths = " or ".join(map(str, counts))
            raise ValueError(f"{model} must have {lengths} coefficients, got {len(given)}")
        parameters = dict(zip(order, given, strict=False))
    elif model in ("equidistant", "fisheye"):
        projection = "opencv_fisheye"
    fx, skew, cx, below, fy, cy, *last = k
    if (skew, below, last) != (0.0, 0.0, [0.0, 0.0, 1.0]):
        raise ValueError(f"camera_matrix must be fx 0 cx 0 fy cy 0 0 1, got {k}")
    made = Calibration(rows, columns, [fx, fy, cx, cy], "ros", pose, projection, parameters)
    steps = [info.whole(name) if info.has(name) else 0 for name in ("binning_y", "binning_x")]
    region = None
    if info.has("roi"):
        roi = info.table("roi")
        names_ = ("y_offset", "height", "x_offset", "width")
        top, height, left, width = (roi.whole(name) if roi.has(name) else 0 for name in names_)
        # All of them zero is the whole.
        if height or width:
            region = top, top + height, left, left + width
    return RosCamera(made, region, (max(steps[0], 1), max(steps[1], 1)))


#: Kalibr's models and distortions: the projection, and the names of its numbers.
_KALIBR: dict[tuple[str, str], tuple[Projection, tuple[str, ...], tuple[str, ...]]]
_KALIBR = {
    ("pinhole", "none"): ("perspective", (), ()),
    ("pinhole", "radtan"): ("opencv", (), OPENCV[:4]),
    ("pinhole", "equidistant"): ("opencv_fisheye", (), FISHEYE),
    ("pinhole", "fov"): ("fov", (), ("omega",)),
    ("omni", "none"): ("mei", ("xi",), ()),
    ("omni", "radtan"): ("mei", ("xi",), OPENCV[:4]),
    ("ds", "none"): ("double_sphere", ("xi", "alpha"), ()),
    ("eucm", "none"): ("eucm", ("alpha", "beta"), ()),
}


def of_kalibr(chain: _Table, frame: str) -> dict[str, Calibration]:
    """Return the cameras of a camchain by their names, in the first camera's frame or the IMU's."""
    names = sorted(chain.value, key=lambda name: (len(str(name)), str(name)))
    made: dict[str, Calibration] = {}
    before = np.eye(4)
    first: npt.NDArray[np.float64] | None = None
    for k, name in enumerate(names):
        camera = _Table(chain.value[name], str(name))
        from_imu = camera.matrix("T_cam_imu") if camera.has("T_cam_imu") else None
        if k == 0:
            before, first = np.eye(4), from_imu
        elif camera.has("T_cn_cnm1"):
            before = camera.matrix("T_cn_cnm1") @ before
        elif from_imu is not None and first is not None:
            before = from_imu @ np.linalg.inv(first)
        else:
            raise ValueError(f"{name}.T_cn_cnm1 is missing")
        pose = before
        if frame == "imu":
            if from_imu is None and first is not None:
                from_imu = before @ first
            if from_imu is None:
                raise ValueError(f"{name}.T_cam_imu is missing")
            pose = from_imu
        made[str(name)] = _kalibr_camera(camera, pose)
    return made


def _kalibr_camera(camera: _Table, pose: npt.NDArray[np.float64]) -> Calibration:
    words = camera.word("camera_model", ""), camera.word("distortion_model", "none")
    if words not in _KALIBR:
        known = ", ".join(f"{model} with {distortion}" for model, distortion in _KALIBR)
        raise ValueError(f"{camera.where}: expected {known}, got {words[0]!r} with {words[1]!r}")
    projection, own, distortion = _KALIBR[words]
    *numbers, fx, fy, cx, cy = camera.numbers("intrinsics", len(own) + 4)
    parameters = dict(zip(own, numbers, strict=True))
    if distortion:
        given = camera.numbers("distortion_coeffs", len(distortion))
        parameters |= dict(zip(distortion, given, strict=True))
    columns, rows = camera.numbers("resolution", 2)
    if columns != int(columns) or rows != int(rows):
        raise ValueError(f"{camera.where}.resolution must be whole numbers, got {columns}, {rows}")
    size = int(rows), int(columns)
    return Calibration(*size, [fx, fy, cx, cy], "opencv", pose, projection, parameters)


#: Radial and tangential: nerfstudio takes what is there, whatever of these models is named.
_BROWN: tuple[Projection, tuple[str, ...]] = ("opencv", ("k1", "k2", "p1", "p2", "k3"))
#: The models of ``transforms.json``, nerfstudio's and instant-ngp's.
_NERFSTUDIO: dict[str, tuple[Projection, tuple[str, ...]]]
_NERFSTUDIO = {
    "SIMPLE_PINHOLE": _BROWN,
    "PINHOLE": _BROWN,
    "SIMPLE_RADIAL": _BROWN,
    "RADIAL": _BROWN,
    "OPENCV": _BROWN,
    "OPENCV_FISHEYE": ("opencv_fisheye", FISHEYE),
    "EQUIRECTANGULAR": ("equirectangular", ()),
}


def of_nerfstudio(document: _Table, size: tuple[int, int] | None) -> dict[str, Calibration]:
    """Return the cameras of ``transforms.json`` by the paths of their images.

    The size, rows and columns, is that of images where the file does not say it.
    """
    frames = document.get("frames")
    if not isinstance(frames, list):
        raise ValueError(f"frames must be a list, got {_shown(frames)}")
    made: dict[str, Calibration] = {}
    for k, frame in enumerate(frames):
        own = _Table(frame, f"frames[{k}]")
        name = own.word("file_path", "")
        if name in made:
            raise ValueError(f"{own.where}.file_path is there twice: {name!r}")
        # A frame's own numbers go before the file's for all.
        both = _Table(document.value | own.value, own.where)
        made[name] = _nerfstudio_camera(both, size)
    return made


def _nerfstudio_camera(frame: _Table, size: tuple[int, int] | None) -> Calibration:
    is_fisheye = frame.value.get("is_fisheye") is True
    model = frame.word("camera_model", "OPENCV_FISHEYE" if is_fisheye else "OPENCV")
    projection, names = _NERFSTUDIO[one_of("camera_model", model, _NERFSTUDIO)]
    if frame.has("h") or frame.has("w") or size is None:
        size = frame.whole("h"), frame.whole("w")
    rows, columns = size
    pose = frame.matrix("transform_matrix")
    if projection == "equirectangular":
        return Calibration(*size, [], "nerfstudio", pose, projection, {})
    lengths = [_focal_length(frame, *each) for each in (("x", columns), ("y", rows))]
    fx = lengths[0] if lengths[0] is not None else lengths[1]
    fy = lengths[1] if lengths[1] is not None else lengths[0]
    if fx is None or fy is None:
        raise ValueError(f"{frame.where}: fl_x or camera_angle_x is missing")
    cx = frame.number("cx") if frame.has("cx") else 0.5 * columns
    cy = frame.number("cy") if frame.has("cy") else 0.5 * rows
    every = ("k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2")
    given = {name: frame.number(name) for name in every if frame.has(name)}
    parameters = {name: number for name, number in given.items() if number}
    if others := sorted(set(parameters) - set(names)):
        # Its k4 is a coefficient of the eighth power, and OpenCV's one of the divisor.
        raise ValueError(f"{frame.where}: {model} with {', '.join(others)} is not supported")
    if projection == "opencv" and not parameters:
        projection = "perspective"
    return Calibration(*size, [fx, fy, cx, cy], "nerfstudio", pose, projection, parameters)


def _focal_length(frame: _Table, axis: str, pixels: int) -> float | None:
    """Return a focal length in pixels, if the file says it or an angle."""
    if frame.has(f"fl_{axis}"):
        return frame.number(f"fl_{axis}")
    if not frame.has(f"camera_angle_{axis}"):
        return None
    angle = frame.number(f"camera_angle_{axis}")
    if not 0.0 < angle < math.pi:
        raise ValueError(f"camera_angle_{axis} must be between 0 and pi, got {angle}")
    return 0.5 * pixels / math.tan(0.5 * angle)
