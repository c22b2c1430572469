"""Cameras that files bring along."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from firsthit._base.arrays import count

from .camera import Camera

if TYPE_CHECKING:
    from collections.abc import Sequence

    from firsthit import _firsthit


@dataclass(frozen=True)
class NamedCamera:
    """A camera of a file.

    Attributes
    ----------
    name : str
        Its name; may be empty.
    camera : Camera
        The camera as the file describes it, in world space. Where ``has_size`` is false, its number
        of pixels and the shape of its viewplane have no meaning: `at` makes a camera of a size.
    has_size : bool
        Whether the file also gives the number of pixels and the shape of the viewplane.
    """

    name: str
    camera: Camera
    has_size: bool

    def at(self, *, rows: int | None = None, columns: int | None = None) -> Camera:
        """Make the camera at a size.

        Parameters
        ----------
        rows, columns : int, optional
            Pixels down and across: both, or neither for those of the file.

        Returns
        -------
        Camera
            The viewplane's height is the file's. If a size is given, the viewplane's width follows
            from square pixels.

        Raises
        ------
        ValueError
            If only one of the two is given, or neither and the file has no size; and for no pixels.
        """
        if columns is None and rows is None and self.has_size:
            return self.camera
        if columns is None or rows is None:
            raise ValueError("columns and rows must be given: the file does not say them")
        across, down = count("columns", columns), count("rows", rows)
        return _resized(self.camera, across, down)


def _resized(camera: Camera, columns: int, rows: int) -> Camera:
    height = camera.height
    if height is None:
        return camera.resize(rows, columns)
    parameters = camera.parameters
    for name in ("focal_length", "width", "height"):
        del parameters[name]
    return Camera(
        camera.position,
        camera.aim,
        camera.up,
        camera.focal_length,
        height * columns / max(rows, 1),
        height,
        rows,
        columns,
        camera.projection,
        camera.ray_start,
        parameters,
    )


def find(cameras: Sequence[NamedCamera], name: str | int) -> NamedCamera:
    """Return the camera of a name or number."""
    if isinstance(name, str):
        for camera in cameras:
            if camera.name == name:
                return camera
    elif 0 <= name < len(cameras):
        return cameras[name]
    names = ", ".join(f"{k} {camera.name!r}" for k, camera in enumerate(cameras)) or "none"
    raise KeyError(f"there is no camera {name!r}; there are: {names}")


def from_native(
    name: str,
    view: _firsthit._View,
    has_size: bool,  # noqa: FBT001 - as the native half sends it
    *,
    settled: bool,
) -> NamedCamera:
    """Return the camera that the native half read; it is as it is where it is ``settled``."""
    return NamedCamera(name, Camera._of_arguments(*view, settled), has_size)
