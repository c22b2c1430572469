"""COLMAP's cameras and images, in text and binary: https://colmap.github.io/format.html."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from firsthit import _firsthit
from firsthit._base.errors import FileReadError, blaming

if TYPE_CHECKING:
    import os

    from .camera_view import CameraView


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


def from_camera(camera: CameraView) -> ColmapCamera:
    """Return a camera in COLMAP's words."""
    model, params, qvec, tvec = camera._native.to_colmap()
    w, x, y, z = qvec
    tx, ty, tz = tvec
    return ColmapCamera(
        model, camera.columns, camera.rows, tuple(params), (w, x, y, z), (tx, ty, tz)
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
