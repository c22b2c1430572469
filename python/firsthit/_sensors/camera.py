"""The camera."""

from __future__ import annotations

from typing import TYPE_CHECKING, get_args

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import count, number, one_of, text, vector
from firsthit._base.errors import name_methods, warn
from firsthit.typing import Projection

from .camera_conventions import ConvertedCamera
from .camera_derived import DerivedCamera
from .camera_view import FLAT, LENS, CameraView, checked_parameters
from .read_cameras import ReadCameras

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy.typing as npt

    from firsthit._objects.traceable import Traceable
    from firsthit.typing import CubeLayout, FisheyeName, FovAxis, RayStart, ViewName

    from .sensor import Sensor

#: Rows and columns of faces of each layout of a cube map.
_CUBES: dict[str, tuple[int, int]]
_CUBES = {"row": (1, 6), "column": (6, 1), "two rows": (2, 3), "cross": (3, 4)}


class Camera(ReadCameras):
    """A camera at any position, with any aim: it makes a ray for every pixel. Immutable.

    Rays start on the viewplane unless ``ray_start`` is ``"eye"``: what is nearer than
    ``focal_length``, in scene units, is not seen. A focal length of 1500 is behind most scenes;
    `from_intrinsics` takes focal lengths in pixels, and its rays start at the eye.

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
        An ``orthographic`` camera has one: its rays start so far ahead, or with the ``ray_start``
        ``"eye"`` at the camera, where any positive distance does.
    width, height : float or None
        Size of the viewplane; ``None`` for a projection without a viewplane.
    rows, columns : int
        Pixels down and across.
    projection : str
        How rays are made: ``perspective`` rays go from the position through the viewplane,
        ``orthographic`` ones are parallel to the aim. The others have no viewplane; the notes list
        them.
    ray_start : {"viewplane", "eye"}
        Where rays start, and ``t`` is 0. Rays that start on the viewplane do not meet what is
        between it and the eye. Without a viewplane they start at the eye.
    parameters : mapping of str to float, optional
        The other numbers of the projection, which the notes list.
    aperture : float
        The diameter of the lens of a camera with the projection ``perspective``, ``opencv`` or
        ``fov``; 0 is a pinhole. Only the colours of pictures with several samples see it:
        `thin_lens` says how.
    focus : float, optional
        With an aperture: the distance along the aim at which the picture is sharp.

    Raises
    ------
    ValueError
        For a value that makes no sense, with its name: a zero direction, ``up`` parallel to
        ``aim``, a length that is not positive, no pixels, numbers that are not finite, lengths, a
        ``ray_start``, parameters or an aperture that do not fit the projection, and an aperture
        or a focus alone.

    Notes
    -----
    Pixel coordinates count columns to the right and rows down from the picture's upper left corner:
    the centre of the first pixel is at (0.5, 0.5). Angles of fields of view and tilts are in
    degrees. ``docs/cameras.md`` has the formulas and their sources.

    ============================== ================================================================
    projection                     parameters
    ============================== ================================================================
    ``perspective``                ``shift_x``, ``shift_y``: from where the aim meets the viewplane
                                   to its middle, to the right and upwards; ``tilt_x``, ``tilt_y``:
                                   how it is turned; ``skew``
    ``orthographic``               ``shift_x``, ``shift_y``, ``skew``
    ``equirectangular``            ``horizontal_fov``, ``vertical_fov``
    ``cylindrical``                the same
    ``cube_map``                   none; the picture's shape says how the faces lie
    ``octahedral``                 none
    all below                      ``fx``, ``fy``, ``cx``, ``cy``, ``skew``: the intrinsic matrix,
                                   and:
    ``opencv``                     ``k1`` to ``k6``, ``p1``, ``p2``, ``s1`` to ``s4``, ``tau_x``,
                                   ``tau_y``
    ``opencv_fisheye``             ``k1`` to ``k4``; ``fov``, beyond which nothing is seen
    ``kannala_brandt``             ``k1`` to ``k5``
    ``double_sphere``              ``xi``, ``alpha``
    ``eucm``                       ``alpha``, ``beta``
    ``ucm``                        ``alpha``
    ``mei``                        ``xi``, ``k1``, ``k2``, ``p1``, ``p2``
    ``fov``                        ``omega``
    ``thin_prism_fisheye``         ``k1`` to ``k4``, ``p1``, ``p2``, ``sx1``, ``sy1``
    ``rad_tan_thin_prism_fisheye`` ``k0`` to ``k5``, ``p0``, ``p1``, ``s0`` to ``s3``
    ``equidistant``,               ``fov``, beyond which nothing is seen
    ``equisolid``,
    ``stereographic``,
    ``orthographic_fisheye``
    ============================== ================================================================

    A pixel that no direction is seen at, beyond a fold of the distortion or outside a fisheye's
    circle, has a ray of NaN, which is a miss; the channel ``valid`` is false there.

    Examples
    --------
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
        parameters: Mapping[str, float] | None = None,
        *,
        aperture: float = 0.0,
        focus: float | None = None,
    ) -> None:
        lengths = {"focal_length": focal_length, "width": width, "height": height}
        one_of("projection", text("projection", projection), get_args(Projection))
        has_viewplane = projection in FLAT
        for name, length in lengths.items():
            if has_viewplane != (length is not None):
                how = "given with" if has_viewplane else "None with"
                raise ValueError(f"{name} must be {how} projection {projection}, got {length!r}")
        if not has_viewplane and ray_start != "eye":
            raise ValueError(
                f"ray_start must be eye with projection {projection}, got {ray_start!r}"
            )
        given = checked_parameters(parameters)
        for name, length in lengths.items():
            if name in given:
                raise ValueError(f"{name} is an argument of its own, not one of parameters")
            if length is not None:
                given[name] = number(name, length)
        given.update(_thin_lens(projection, given, aperture, focus))
        native = _firsthit.Camera(
            vector("position", position),
            vector("aim", aim),
            vector("up", up),
            (count("rows", rows), count("columns", columns)),
            text("projection", projection),
            text("ray_start", ray_start),
            list(given.items()),
            is_exact=False,
        )
        self._take(native, vector("aim", aim))

    @classmethod
    def look_at(
        cls,
        position: npt.ArrayLike,
        target: npt.ArrayLike,
        up: npt.ArrayLike,
        fov: float,
        rows: int,
        columns: int,
        projection: Projection = "perspective",
        ray_start: RayStart = "eye",
        *,
        fov_axis: FovAxis = "vertical",
    ) -> Camera:
        """Make a camera with a target in the middle of the picture, and square pixels.

        Parameters
        ----------
        position, target : (3,) array_like
            The points, in world space, where the camera is and at which it looks.
        up : (3,) array_like
            Which way is up, of any length but zero; not parallel to the direction of the target.
        fov : float
            The field of view: degrees along ``fov_axis``, above 0 and below 180.
        rows, columns : int
            Pixels down and across.
        projection : {"perspective", "orthographic"}
            As for `Camera`. An orthographic camera has the same viewplane.
        ray_start : {"eye", "viewplane"}
            As for `Camera`.
        fov_axis : {"vertical", "horizontal", "diagonal"}
            How ``fov`` is measured: from the picture's lower to its upper edge, from the left to
            the right one, or from corner to corner.

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
        >>> camera = fh.Camera.look_at((0, -5, 0), (0, 0, 0), (0, 0, 1), 90, rows=480, columns=640)
        >>> round(camera.height, 12), camera.aim.tolist()
        (2.0, [0.0, 1.0, 0.0])
        """
        where, there = vector("position", position), vector("target", target)
        if where == there:
            raise ValueError(f"target must be another point than position, got {there}")
        down, across = count("rows", rows), count("columns", columns)
        degrees, axis = number("fov", fov), text("fov_axis", fov_axis)
        focal, width, height = _firsthit.Camera.lens(degrees, axis, down, across)
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
        *,
        horizontal_fov: float = 360.0,
        vertical_fov: float = 180.0,
    ) -> Camera:
        """Make a camera for panoramas, which sees the whole sphere unless told otherwise.

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
        horizontal_fov, vertical_fov : float
            Degrees from edge to edge: up to 360 and 180.

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
        >>> camera = fh.Camera.equirectangular((0, 0, 0), (0, 1, 0), (0, 0, 1), rows=2, columns=4)
        >>> camera.rays()[1][0, 1].round(3)
        array([-0.5  ,  0.5  ,  0.707])
        """
        parameters = {"horizontal_fov": horizontal_fov, "vertical_fov": vertical_fov}
        lengths = None, None, None
        kind: Projection = "equirectangular"
        return cls(position, aim, up, *lengths, rows, columns, kind, "eye", parameters)

    @classmethod
    def cube_map(
        cls,
        position: npt.ArrayLike,
        aim: npt.ArrayLike,
        up: npt.ArrayLike,
        face: int,
        layout: CubeLayout = "row",
    ) -> Camera:
        """Make a camera that sees all directions, on the six faces of a cube.

        Each face is a perspective picture of 90 degrees, seen from inside.

        Parameters
        ----------
        position : (3,) array_like
            The point, in world space, where the camera is.
        aim, up : (3,) array_like
            The directions of the middles of the front and of the upper face, of any length but
            zero; not parallel.
        face : int
            Pixels along an edge of a face.
        layout : {"row", "column", "two rows", "cross"}
            How the faces lie: right, left, up, down, front, back in a row or a column, three of
            them above the others, or a cross in which up and down are above and below the front.

        Returns
        -------
        Camera
            Its rays start at ``position``. Of a cross the pixels beside the faces have none.

        Raises
        ------
        ValueError
            For an unknown layout, directions that do not fit, no pixels, and numbers that are not
            finite.

        Examples
        --------
        >>> camera = fh.Camera.cube_map((0, 0, 0), (0, 1, 0), (0, 0, 1), face=3)
        >>> camera.rays()[1][1, 1::3].tolist()[:3]  # The middles of right, left, up.
        [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
        """
        sides = _CUBES[one_of("layout", layout, _CUBES)]
        down, across = (each * count("face", face, 1) for each in sides)
        return cls(position, aim, up, None, None, None, down, across, "cube_map", "eye")

    @classmethod
    def fisheye(
        cls,
        position: npt.ArrayLike,
        aim: npt.ArrayLike,
        up: npt.ArrayLike,
        fov: float,
        rows: int,
        columns: int,
        projection: FisheyeName = "equidistant",
    ) -> Camera:
        """Make a fisheye whose field of view is a circle that touches the picture's longer edges.

        Parameters
        ----------
        position : (3,) array_like
            The point, in world space, where the camera is.
        aim, up : (3,) array_like
            The directions of the picture's middle and of up, of any length but zero; not parallel.
        fov : float
            The field of view: up to 360 degrees, below 360 of ``stereographic``, up to 180 of
            ``orthographic_fisheye``. Points beyond it are not seen.
        rows, columns : int
            Pixels down and across.
        projection : str
            The distance from the middle as a function of the angle a to the aim:
            ``equidistant`` a, ``equisolid`` 2 sin(a / 2), ``stereographic`` 2 tan(a / 2),
            ``orthographic_fisheye`` sin(a); ``opencv_fisheye`` a, without distortion.

        Returns
        -------
        Camera
            Its rays start at ``position``.

        Raises
        ------
        ValueError
            For a field of view that the projection does not reach, directions that do not fit, no
            pixels, and numbers that are not finite.

        Examples
        --------
        >>> camera = fh.Camera.fisheye((0, 0, 0), (0, 0, 1), (0, 1, 0), 180, rows=9, columns=9)
        >>> camera.project((1, 0, 1)).round(3)  # Half of the way to the left edge.
        array([2.25, 4.5 ])
        """
        pixels = count("rows", rows), count("columns", columns)
        kind, degrees = text("projection", projection), number("fov", fov)
        given = dict(_firsthit.Camera.with_fov(kind, degrees, pixels))
        lengths = None, None, None
        return cls(position, aim, up, *lengths, *pixels, projection, "eye", given)

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
            The scene to see. Infinite objects do not count. For a scene without finite
            objects the camera is placed as for a box from (-1, -1, -1) to (1, 1, 1).
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
        return cls._of(native)


name_methods(Camera, ReadCameras, ConvertedCamera, DerivedCamera, CameraView)


def warn_before_viewplane(scene: _firsthit.Scene, camera: Sensor) -> None:
    """Warn where a camera sees nothing because its rays start behind what there is."""
    if not isinstance(camera, Camera) or camera.ray_start == "eye":
        return
    passed = _firsthit.before_viewplane(scene, camera._native)
    if passed:
        objects = "1 object is" if passed == 1 else f"{passed} objects are"
        why = "where this camera's rays start, and it sees nothing else"
        warn(f'{objects} between the eye and the viewplane, {why}; ray_start="eye" sees them')


def _thin_lens(
    projection: str, given: Mapping[str, float], aperture: float, focus: float | None
) -> dict[str, float]:
    """Return the numbers of a thin lens, if there is one."""
    for name in LENS:
        if name in given:
            raise ValueError(f"{name} is an argument of its own, not one of parameters")
    diameter = number("aperture", aperture)
    if focus is None:
        if diameter != 0.0:
            raise ValueError(f"focus must be given with an aperture, got {focus} with {diameter}")
        return {}
    expected = _firsthit.Camera.no_thin_lens(projection)
    if expected is not None:
        raise ValueError(f"aperture must be {expected}, got {projection}")
    far = number("focus", focus)
    if not far > 0.0:
        raise ValueError(f"focus must be a positive distance, got {far}")
    return {"aperture": diameter, "focus": far}
