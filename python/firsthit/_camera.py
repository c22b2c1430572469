"""The camera."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from . import _firsthit
from ._arrays import count, number, text, vector

if TYPE_CHECKING:
    import numpy.typing as npt

    from ._traceable import Traceable
    from ._types import Projection, RayStart, Vector, ViewName


class Camera:
    """A camera at any position, with any aim: it makes a ray for every pixel. Immutable.

    All vectors are in world space, all lengths in scene units. The camera's own frame is
    right-handed: ``right``, ``upwards``, and backwards, against ``aim``. Row 0 is the top row, and
    a pixel's ray passes through its centre.

    Parameters
    ----------
    position : (3,) array_like
        Where the camera is.
    aim : (3,) array_like
        The direction in which it looks, of any length but zero.
    up : (3,) array_like
        Which way is up, of any length but zero; not parallel to ``aim``.
    focal_length : float or None
        Distance from the camera to the viewplane; ``None`` for a projection without a viewplane.
    width, height : float or None
        Size of the viewplane; ``None`` for a projection without a viewplane.
    rows, columns : int
        Pixels down and across.
    projection : {"perspective", "orthographic", "equirectangular"}
        Perspective rays go from the position through the viewplane, orthographic ones are parallel
        to the aim, and equirectangular ones go in all directions: see `equirectangular`.
    ray_start : {"viewplane", "eye"}
        Where rays start, and ``t`` is 0. Rays that start on the viewplane do not meet what is
        between it and the eye. Equirectangular rays start at the eye.

    Raises
    ------
    ValueError
        For a value that makes no sense, with its name: a zero direction, ``up`` parallel to
        ``aim``, a length that is not positive, no pixels, numbers that are not finite, lengths or a
        ``ray_start`` that do not fit the projection.

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
        focal_length: float | None,
        width: float | None,
        height: float | None,
        rows: int,
        columns: int,
        projection: Projection = "perspective",
        ray_start: RayStart = "viewplane",
    ) -> None:
        lengths = {"focal_length": focal_length, "width": width, "height": height}
        has_viewplane = text("projection", projection) != "equirectangular"
        for name, length in lengths.items():
            if has_viewplane != (length is not None):
                how = "given with" if has_viewplane else "None with"
                raise ValueError(f"{name} must be {how} projection {projection}, got {length!r}")
        if not has_viewplane and ray_start != "eye":
            raise ValueError(
                f"ray_start must be eye with projection {projection}, got {ray_start!r}"
            )
        self._arguments = (
            vector("position", position),
            vector("aim", aim),
            vector("up", up),
            _length("focal_length", focal_length),
            _length("width", width),
            _length("height", height),
            count("rows", rows),
            count("columns", columns),
            text("projection", projection),
            text("ray_start", ray_start),
        )
        self._native, self._is_taken = self._made(again=False), False

    _native: _firsthit.Camera
    #: Whether the arguments were taken from a camera: its aim is then to stay as it is, bit by bit.
    _is_taken: bool

    def _made(self, *, again: bool) -> _firsthit.Camera:
        where, aimed, upward, focal, wide, high, down, across, kind, start = self._arguments
        # A projection without a viewplane has no use for these.
        size = 1.0 if wide is None else wide, 1.0 if high is None else high
        focal = 1.0 if focal is None else focal
        return _firsthit.Camera(
            where, aimed, upward, focal, size, (down, across), str(kind), str(start), again
        )

    @classmethod
    def _again(cls, view: _firsthit._View) -> Camera:
        """Return the camera from which the view was taken."""
        vectors, lengths, pixels, words = view
        position, aim, up = (vector("view", each) for each in vectors)
        return _taken(cls, position, aim, up, *lengths, *pixels, *words)

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
            The points, in world space, where the camera is and at which it looks.
        up : (3,) array_like
            Which way is up, of any length but zero; not parallel to the direction of the target.
        vertical_fov_degrees : float
            The vertical field of view: degrees between the picture's lower and upper edge, above 0
            and below 180.
        rows, columns : int
            Pixels down and across.
        projection : {"perspective", "orthographic"}
            As for `Camera`. An orthographic camera has the same viewplane.
        ray_start : {"eye", "viewplane"}
            As for `Camera`.

        Returns
        -------
        Camera
            Its viewplane is at distance 1.

        Raises
        ------
        ValueError
            For a target at the position, an angle out of range, an ``up`` that does not fit, no
            pixels, numbers that are not finite, and an equirectangular projection.

        Examples
        --------
        >>> import firsthit as fh
        >>> camera = fh.Camera.look_at((0, -5, 0), (0, 0, 0), (0, 0, 1), 90, rows=480, columns=640)
        >>> round(camera.height, 12), camera.aim.tolist()
        (2.0, [0.0, 1.0, 0.0])
        """
        where, there = vector("position", position), vector("target", target)
        if where == there:
            raise ValueError(f"target must be another point than position, got {there}")
        down, across = count("rows", rows), count("columns", columns)
        degrees = number("vertical_fov_degrees", vertical_fov_degrees)
        focal, width, height = _firsthit.Camera.lens(degrees, down, across)
        aim = np.subtract(there, where)
        return cls(where, aim, up, focal, width, height, down, across, projection, ray_start)

    @classmethod
    def equirectangular(
        cls,
        position: npt.ArrayLike,
        aim: npt.ArrayLike,
        up: npt.ArrayLike,
        rows: int,
        columns: int,
    ) -> Camera:
        """Make a camera for panoramas, which sees the whole sphere.

        The aim is in the middle of the picture. Longitude is linear in the columns, from -180
        degrees at the left edge to 180 at the right one. Latitude is linear in the rows, from 90
        degrees at the top edge, which is upwards, to -90 at the bottom one.

        Parameters
        ----------
        position : (3,) array_like
            The point, in world space, where the camera is.
        aim, up : (3,) array_like
            The directions of the picture's middle and of up, of any length but zero; not parallel.
        rows, columns : int
            Pixels down and across; twice as many columns as rows make square pixels at the horizon.

        Returns
        -------
        Camera
            Its rays start at ``position``; it has no viewplane and no intrinsic matrix.

        Raises
        ------
        ValueError
            For directions that do not fit, no pixels, and numbers that are not finite.

        Examples
        --------
        >>> import firsthit as fh
        >>> camera = fh.Camera.equirectangular((0, 0, 0), (0, 1, 0), (0, 0, 1), rows=2, columns=4)
        >>> camera.rays()[1][0, 1].round(3)
        array([-0.5  ,  0.5  ,  0.707])
        """
        lengths = None, None, None
        return cls(position, aim, up, *lengths, rows, columns, "equirectangular", "eye")

    @classmethod
    def framing(
        cls,
        scene: Traceable,
        rows: int | None = None,
        columns: int | None = None,
        view: ViewName = "iso",
        up: npt.ArrayLike | None = None,
    ) -> Camera:
        """Make a perspective camera that sees all of a scene, filling the picture.

        It is the program's own default camera. Pixels are square, the vertical field of view is 45
        degrees, and the picture is 1.05 times as large as the scene in one of its two directions.
        Rays start at the eye, which stays away from the scene by at least a millionth of its depth:
        a scene that is narrower than that looks small.

        Parameters
        ----------
        scene : Scene
            What to see. Infinite objects do not count. For a scene without finite objects the
            camera is placed as for a box from (-1, -1, -1) to (1, 1, 1).
        rows, columns : int, optional
            Pixels down and across. If one is left out, the picture is 4:3; if both are, it is 768
            rows of 1024.
        view : {"iso", "front", "back", "left", "right", "top", "bottom"}
            The side from which it looks: ``iso`` is a three-quarter view from above. The front is
            the side that faces -y where z is up, and +z where y is up.
        up : (3,) array_like, optional
            Which way is up in world space; `Scene.up` if left out.

        Returns
        -------
        Camera
            With ``up`` upwards in the picture.

        Raises
        ------
        ValueError
            For an unknown view, an ``up`` that is no direction, no pixels, and a scene that reaches
            so far that no camera can see all of it.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> camera = fh.Camera.framing(scene, rows=480, columns=640, view="front")
        >>> float(camera.aim[1])
        1.0
        """
        above = scene.up if up is None else vector("up", up)
        down = None if rows is None else count("rows", rows)
        across = None if columns is None else count("columns", columns)
        native = _firsthit.Camera.framing(scene._native(), above, text("view", view), down, across)
        return cls._again(native.view())

    @property
    def position(self) -> npt.NDArray[np.float64]:
        """Where the camera is, in world space, (3,) float64: a copy."""
        return np.array(self._arguments[0])

    @property
    def aim(self) -> npt.NDArray[np.float64]:
        """The direction in which it looks, in world space, (3,) float64, of length one: a copy."""
        return np.array(self._native.frame()[1])

    @property
    def up(self) -> npt.NDArray[np.float64]:
        """Which way is up, in world space, (3,) float64, as it was given: a copy."""
        return np.array(self._arguments[2])

    @property
    def right(self) -> npt.NDArray[np.float64]:
        """To the right in the picture, in world space, (3,) float64, of length one: a copy."""
        return np.array(self._native.frame()[2])

    @property
    def upwards(self) -> npt.NDArray[np.float64]:
        """Upwards in the picture, in world space, (3,) float64, of length one: a copy."""
        return np.array(self._native.frame()[3])

    @property
    def focal_length(self) -> float | None:
        """Distance to the viewplane, in scene units; ``None`` for a projection without one."""
        return self._arguments[3]

    @property
    def width(self) -> float | None:
        """Width of the viewplane, in scene units; ``None`` for a projection without one."""
        return self._arguments[4]

    @property
    def height(self) -> float | None:
        """Height of the viewplane, in scene units; ``None`` for a projection without one."""
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
    def projection(self) -> Projection:
        """``perspective``, ``orthographic`` or ``equirectangular``."""
        return self._arguments[8]

    @property
    def ray_start(self) -> RayStart:
        """``viewplane`` or ``eye``."""
        return self._arguments[9]

    def rays(self) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """Make the rays through the pixels' centres.

        Returns
        -------
        origins, directions : (rows, columns, 3) array of float64
            In world space; directions of length one. Row 0 is the top row.
        """
        origins, directions = self._native.rays((0, self.rows), 0)
        shape = (self.rows, self.columns, 3)
        return origins.reshape(shape), directions.reshape(shape)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Camera):
            return False
        # The arguments may be the same and the aim, made of length one once more, not.
        same_frame = self._native.frame() == other._native.frame()
        return self._arguments == other._arguments and same_frame

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

    def __reduce__(self) -> tuple[object, tuple[object, ...]]:
        """Pickle by what it was made from."""
        if self._is_taken:
            return _taken, (type(self), *self._arguments)
        return type(self), self._arguments


def _length(name: str, length: float | None) -> float | None:
    return None if length is None else number(name, length)


def _taken(
    kind: type[Camera],
    position: Vector,
    aim: Vector,
    up: Vector,
    focal_length: float | None,
    width: float | None,
    height: float | None,
    rows: int,
    columns: int,
    projection: Projection,
    ray_start: RayStart,
) -> Camera:
    """Return the camera from which the arguments were taken."""
    camera = kind.__new__(kind)
    lengths = focal_length, width, height
    camera._arguments = (position, aim, up, *lengths, rows, columns, projection, ray_start)
    camera._native, camera._is_taken = camera._made(again=True), True
    return camera
