"""The camera."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from . import _firsthit
from ._arrays import count, number, vector

if TYPE_CHECKING:
    import numpy.typing as npt

Projection = Literal["perspective", "orthographic"]
RayStart = Literal["viewplane", "eye"]


class Camera:
    """A camera anywhere, aimed anywhere, that makes a ray for every pixel. Immutable.

    Its frame is right-handed: ``right``, ``upwards``, and backwards. Row 0 is the top row, and a
    pixel's ray passes through its centre.

    Parameters
    ----------
    position : (3,) array_like
        Where the camera is.
    aim : (3,) array_like
        The direction it looks in, of any length but zero.
    up : (3,) array_like
        Which way is up; anything but parallel to ``aim``.
    focal_length : float
        Distance from the camera to the viewplane, in scene units.
    width, height : float
        Size of the viewplane, in scene units.
    rows, columns : int
        Pixels down and across.
    projection : {"perspective", "orthographic"}
        Rays through the position, or parallel to the aim.
    ray_start : {"viewplane", "eye"}
        Where rays start, and ``t`` counts from. What lies between the eye and the viewplane is not
        seen from the viewplane.

    Raises
    ------
    ValueError
        For values that make no sense, with their name.

    Examples
    --------
    >>> import firsthit as fh
    >>> camera = fh.Camera(position=(0, 1, 5), aim=(0, 0, -1), up=(0, 1, 0), focal_length=1.0,
    ...                    width=1.6, height=0.9, rows=720, columns=1280)
    >>> origins, directions = camera.rays()
    >>> origins.shape
    (720, 1280, 3)
    """

    def __init__(
        self,
        position: npt.ArrayLike,
        aim: npt.ArrayLike,
        up: npt.ArrayLike,
        focal_length: float,
        width: float,
        height: float,
        rows: int,
        columns: int,
        projection: Projection = "perspective",
        ray_start: RayStart = "viewplane",
    ) -> None:
        self._arguments = (
            vector("position", position),
            vector("aim", aim),
            vector("up", up),
            number("focal_length", focal_length),
            number("width", width),
            number("height", height),
            count("rows", rows),
            count("columns", columns),
            str(projection),
            str(ray_start),
        )
        where, aimed, upward, focal, wide, high, down, across, kind, start = self._arguments
        self._native = _firsthit.Camera(
            where, aimed, upward, focal, (wide, high), (down, across), kind, start
        )

    @classmethod
    def look_at(
        cls,
        position: npt.ArrayLike,
        target: npt.ArrayLike,
        up: npt.ArrayLike,
        vertical_fov_degrees: float,
        rows: int,
        columns: int,
        projection: Projection = "perspective",
        ray_start: RayStart = "eye",
    ) -> Camera:
        """Make a camera with a target in the middle of the picture, and square pixels.

        Parameters
        ----------
        position, target : (3,) array_like
            Where the camera is, and where it looks.
        up : (3,) array_like
            Which way is up.
        vertical_fov_degrees : float
            Between the picture's lower and upper edge, from 0 to 180.
        rows, columns : int
            Pixels down and across.
        projection, ray_start : str
            As for `Camera`; the rays start at the eye.

        Returns
        -------
        Camera
            Its viewplane is at distance 1.
        """
        where, there = vector("position", position), vector("target", target)
        if where == there:
            raise ValueError(f"target must be another point than position, got {there}")
        down, across = count("rows", rows), count("columns", columns)
        degrees = number("vertical_fov_degrees", vertical_fov_degrees)
        focal, width, height = _firsthit.Camera.lens(degrees, down, across)
        aim = np.subtract(there, where)
        return cls(where, aim, up, focal, width, height, down, across, projection, ray_start)

    @property
    def position(self) -> npt.NDArray[np.float64]:
        """Where the camera is, (3,)."""
        return np.array(self._arguments[0])

    @property
    def aim(self) -> npt.NDArray[np.float64]:
        """The direction it looks in, (3,), of length one."""
        return np.array(self._native.frame()[1])

    @property
    def up(self) -> npt.NDArray[np.float64]:
        """Which way is up, (3,), as it was given."""
        return np.array(self._arguments[2])

    @property
    def right(self) -> npt.NDArray[np.float64]:
        """To the right in the picture, (3,), of length one."""
        return np.array(self._native.frame()[2])

    @property
    def upwards(self) -> npt.NDArray[np.float64]:
        """Upwards in the picture, (3,), of length one."""
        return np.array(self._native.frame()[3])

    @property
    def focal_length(self) -> float:
        """Distance from the camera to the viewplane."""
        return self._arguments[3]

    @property
    def width(self) -> float:
        """Width of the viewplane."""
        return self._arguments[4]

    @property
    def height(self) -> float:
        """Height of the viewplane."""
        return self._arguments[5]

    @property
    def rows(self) -> int:
        """Pixels down."""
        return self._arguments[6]

    @property
    def columns(self) -> int:
        """Pixels across."""
        return self._arguments[7]

    @property
    def projection(self) -> str:
        """``perspective`` or ``orthographic``."""
        return self._arguments[8]

    @property
    def ray_start(self) -> str:
        """``viewplane`` or ``eye``."""
        return self._arguments[9]

    def rays(self) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """Make the rays through the pixels' centres.

        Returns
        -------
        origins, directions : (rows, columns, 3) array of float64
            World space; directions of length one. Row 0 is the top row.
        """
        origins, directions = self._native.rays((0, self.rows), None)
        shape = (self.rows, self.columns, 3)
        return origins.reshape(shape), directions.reshape(shape)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Camera) and self._arguments == other._arguments

    def __hash__(self) -> int:
        return hash(self._arguments)

    def __repr__(self) -> str:
        names = [
            "position",
            "aim",
            "up",
            "focal_length",
            "width",
            "height",
            "rows",
            "columns",
            "projection",
            "ray_start",
        ]
        pairs = zip(names, self._arguments, strict=True)
        return f"Camera({', '.join(f'{name}={value!r}' for name, value in pairs)})"

    def __reduce__(self) -> tuple[type[Camera], tuple[object, ...]]:
        """Pickle by what it was made from."""
        return type(self), self._arguments
