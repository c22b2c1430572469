"""COLMAP's cameras and images, in text and binary: https://colmap.github.io/format.html."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from firsthit import _firsthit
from firsthit._base.errors import FileReadError, blaming

from .conventions import quaternion

if TYPE_CHECKING:
    import os

    from .camera import Camera


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
    used = {name for name, value in numbers.items() if value and name not in _NO_DISTORTION}
    # COLMAP's fisheyes have no edge.
    used -= {"fov"} if numbers.get("fov") == 360.0 else set()
    for name, parameters, projection in _firsthit.Camera.colmap_models():
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


#: What distorts nothing: K, the viewplane, and a thin lens, which COLMAP does not have.
_NO_DISTORTION = frozenset(
    ("fx", "fy", "cx", "cy", "skew", "focal_length", "width", "height", "aperture", "focus")
)


def content(path: str | os.PathLike[str]) -> bytes:
    """Return the bytes of a regular file."""
    # To open a pipe would wait for its other end.
    if Path(path).exists() and not Path(path).is_file():
        raise FileReadError._of(path, "not a regular file")
    with blaming(path, FileReadError):
        read = Path(path).read_bytes()
    _firsthit.note_input(Path(path))
    return read
