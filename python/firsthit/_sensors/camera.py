"""The camera."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, get_args

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import count, index, number, numbers, one_of, text, vector, vectors
from firsthit._base.errors import warn
from firsthit.typing import Projection

from . import colmap, conventions
from .conventions import OpenCvCamera
from .read_cameras import ReadCameras
from .sensor import Sensor

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping, Sequence

    import numpy.typing as npt

    from firsthit._objects.traceable import Traceable
    from firsthit.typing import (
        Convention,
        CubeLayout,
        FisheyeName,
        FovAxis,
        RayStart,
        Vector,
        ViewName,
    )

    from .colmap import ColmapCamera

#: The projections with a viewplane.
_FLAT = ("perspective", "orthographic")
#: A viewplane's numbers that are arguments of their own.
_LENGTHS = ("focal_length", "width", "height")
#: The numbers of its thin lens, which are too.
_LENS = ("aperture", "focus")
#: Rows and columns of faces of each layout of a cube map.
_CUBES: dict[str, tuple[int, int]]
_CUBES = {"row": (1, 6), "column": (6, 1), "two rows": (2, 3), "cross": (3, 4)}


class Camera(ReadCameras, Sensor):
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
        if text("projection", projection) not in get_args(Projection):
            names = ", ".join(get_args(Projection))
            raise ValueError(f"projection must be one of {names}, got {projection!r}")
        has_viewplane = projection in _FLAT
        for name, length in lengths.items():
            if has_viewplane != (length is not None):
                how = "given with" if has_viewplane else "None with"
                raise ValueError(f"{name} must be {how} projection {projection}, got {length!r}")
        if not has_viewplane and ray_start != "eye":
            raise ValueError(
                f"ray_start must be eye with projection {projection}, got {ray_start!r}"
            )
        given = _parameters(parameters)
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

    _native: _firsthit.Camera
    #: Position, aim as it was given, up; rows and columns; projection and ray start; parameters.
    _arguments: tuple[
        Vector,
        Vector,
        Vector,
        tuple[int, int],
        tuple[Projection, RayStart],
        tuple[tuple[str, float], ...],
    ]
    #: Whether the arguments were taken from a camera: its aim is then to stay as it is, bit by bit.
    _is_taken: bool

    def _take(self, native: _firsthit.Camera, aim: Vector | None = None) -> None:
        """Become the camera that the native half made."""
        (where, own_aim, up), (rows, columns), (kind, start), parameters = native.view()
        aimed = vector("aim", own_aim) if aim is None else aim
        position, upwards = vector("position", where), vector("up", up)
        pixels, words = (rows, columns), (kind, start)
        self._arguments = (position, aimed, upwards, pixels, words, tuple(parameters))
        self._native, self._is_taken = native, aim is None

    @classmethod
    def _of(cls, native: _firsthit.Camera) -> Camera:
        camera = cls.__new__(cls)
        camera._take(native)
        return camera

    @classmethod
    def _again(
        cls,
        is_taken: bool,  # noqa: FBT001 - pickled by place
        vectors_: tuple[npt.ArrayLike, npt.ArrayLike, npt.ArrayLike],
        pixels: tuple[int, int],
        words: tuple[Projection, RayStart],
        parameters: Sequence[tuple[str, float]],
    ) -> Camera:
        """Return the camera of arguments as `_arguments` has them, if need be taken from one."""
        where, aim, up = (vector("view", each) for each in vectors_)
        native = _firsthit.Camera(where, aim, up, pixels, *words, parameters, is_exact=is_taken)
        camera = cls.__new__(cls)
        camera._take(native, None if is_taken else aim)
        return camera

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
            ``orthographic_fisheye``. What is beyond it is not seen.
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
    def from_intrinsics(
        cls,
        K: npt.ArrayLike,
        *,
        rows: int,
        columns: int,
        convention: Convention,
        pose: npt.ArrayLike | None = None,
        projection: Projection = "perspective",
        parameters: Mapping[str, float] | None = None,
    ) -> Camera:
        """Make a camera from an intrinsic matrix and a pose, as another program writes them.

        Parameters
        ----------
        K : (3, 3) or (4,) array_like
            The intrinsic matrix, upper triangular with (0, 0, 1) as its last row; or its
            (fx, fy, cx, cy). In pixels.
        rows, columns : int
            Pixels down and across.
        convention : str
            Whose words these are; it is never guessed. The table below says what each means.
        pose : (4, 4) or (3, 4) array_like, optional
            The pose, without a scale or a mirror; the identity if left out. A rotation whose
            numbers are up to 1e-3 off, as of three decimals, becomes the nearest one.
        projection : str
            ``perspective``, or one with distortion, such as ``opencv``.
        parameters : mapping of str to float, optional
            Those of the distortion, as `Camera` lists them.

        Returns
        -------
        Camera
            Its rays start at the eye.

        Raises
        ------
        ValueError
            For matrices of another shape or kind, an unknown convention, a focal length that is not
            positive, and what `Camera` refuses.

        Warns
        -----
        FirsthitWarning
            For a rotation that is rounded to less than four decimals.

        Notes
        -----
        ==============  ======================  ==============================  ================
        convention      the camera's x, y, z    the pose takes                  first pixel at
        ==============  ======================  ==============================  ================
        ``opencv``      right, down, forwards   the world to the camera         (0, 0)
        ``colmap``      right, down, forwards   the world to the camera         (0.5, 0.5)
        ``ros``         right, down, forwards   the camera to the world         (0, 0)
        ``opengl``      right, up, backwards    the camera to the world         (0.5, 0.5)
        ``blender``     right, up, backwards    the camera to the world         (0.5, 0.5)
        ``gltf``        right, up, backwards    the camera to the world         (0.5, 0.5)
        ``nerfstudio``  right, up, backwards    the camera to the world         (0.5, 0.5)
        ``pytorch3d``   left, up, forwards      the world to the camera, rows   (0.5, 0.5)
        ==============  ======================  ==============================  ================

        The last column is the place of the first pixel's centre in the coordinates that K gives.
        PyTorch3D's matrix is applied to rows, so its translation is in the last row.

        Examples
        --------
        >>> camera = fh.Camera.from_intrinsics([500, 500, 319.5, 239.5], rows=480, columns=640,
        ...                                    convention="opencv")
        >>> camera.aim.tolist(), camera.project((0, 0, 2)).tolist()
        ([0.0, 0.0, 1.0], [320.0, 240.0])
        """
        native = _firsthit.Camera.from_intrinsics(
            conventions.intrinsics(K),
            conventions.pose4(pose),
            text("convention", convention),
            (count("rows", rows), count("columns", columns)),
            text("projection", projection),
            list(_parameters(parameters).items()),
        )
        return cls._of(native)

    @classmethod
    def from_opencv(
        cls,
        K: npt.ArrayLike,
        distortion: npt.ArrayLike | None = None,
        rvec: npt.ArrayLike | None = None,
        tvec: npt.ArrayLike | None = None,
        *,
        R: npt.ArrayLike | None = None,
        rows: int,
        columns: int,
        model: str = "pinhole",
        xi: float = 0.0,
    ) -> Camera:
        """Make the camera whose pictures OpenCV's functions describe.

        A point of the world that a ray of this camera meets is one that ``cv2.projectPoints``, or
        ``cv2.fisheye.projectPoints`` or ``cv2.omnidir.projectPoints``, puts at that pixel.

        Parameters
        ----------
        K : (3, 3) or (4,) array_like
            The camera matrix, or its (fx, fy, cx, cy), in which the centre of the first pixel is at
            (0, 0). Of a fisheye ``K[0, 1]`` is ``alpha`` times fx, as ``cv2.fisheye.calibrate``
            writes it.
        distortion : (n,), (1, n) or (n, 1) array_like, optional
            OpenCV's coefficients in its order: 4, 5, 8, 12 or 14 of them; 4 of the other models.
        rvec : (3,) or (3, 3) array_like, optional
            The rotation from the world to the camera as axis times angle in radians, or as a
            matrix.
        tvec : (3,) array_like, optional
            The translation from the world to the camera.
        R : (3, 3) array_like, optional
            The rotation as a matrix, instead of ``rvec``. Without both the camera is not turned.
        rows, columns : int
            Pixels down and across.
        model : {"pinhole", "fisheye", "omnidir"}
            Whose coefficients these are.
        xi : float
            That of ``cv2.omnidir``.

        Returns
        -------
        Camera
            Its rays start at the eye.

        Raises
        ------
        ValueError
            For both ``rvec`` and ``R``, other numbers of coefficients, a skew in K with the model
            ``pinhole``, which ``cv2.projectPoints`` leaves out, and what `from_intrinsics` refuses.

        Examples
        --------
        >>> camera = fh.Camera.from_opencv([600, 600, 320, 240], (-0.2, 0.05, 0, 0),
        ...                                rows=480, columns=640)
        >>> camera.projection
        'opencv'
        """
        named = conventions.coefficients(distortion, model, xi)
        kind: Projection = "perspective"
        if model == "fisheye":
            kind = "opencv_fisheye"
        elif model == "omnidir":
            kind = "mei"
        elif any(named.values()):
            kind = "opencv"
        else:
            named = {}
        matrix = conventions.intrinsics(K)
        conventions.check_skew(model, matrix[0][1])
        turned = np.eye(3)
        if rvec is not None or R is not None:
            turned = conventions.rotation_of(rvec, R)
        moved = numbers("tvec", (0.0, 0.0, 0.0) if tvec is None else tvec)
        moved = np.array(vector("tvec", moved.ravel() if moved.size == 3 else moved))
        return cls.from_intrinsics(
            matrix,
            rows=rows,
            columns=columns,
            convention="opencv",
            pose=np.column_stack([turned, moved]),
            projection=kind,
            parameters=named,
        )

    @classmethod
    def from_projection_matrix(
        cls,
        P: npt.ArrayLike,
        *,
        rows: int,
        columns: int,
        view: npt.ArrayLike | None = None,
        convention: Convention = "opencv",
    ) -> Camera:
        """Make a camera from a projection matrix.

        Parameters
        ----------
        P : (3, 4) or (4, 4) array_like
            A 3 x 4 matrix takes points of the world to pixels, ``K [R | t]``, up to its scale and
            sign. A 4 x 4 one is OpenGL's, up to a positive scale, applied to columns: from the
            camera's coordinates (right, up, backwards) to clip space. Its near and far planes count
            for nothing: rays start at the eye.
        rows, columns : int
            Pixels down and across.
        view : (4, 4) array_like, optional
            With a 4 x 4 ``P``: OpenGL's view matrix, which takes the world to the camera. The
            identity if left out.
        convention : {"opencv", "colmap"}
            With a 3 x 4 ``P``: where it puts the first pixel's centre, at (0, 0) or (0.5, 0.5).

        Returns
        -------
        Camera
            A perspective one, or of an orthographic ``P`` an orthographic one.

        Raises
        ------
        ValueError
            For a matrix that is no projection of this kind.

        Examples
        --------
        >>> camera = fh.Camera.from_projection_matrix(
        ...     [[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, -1, -0.2], [0, 0, -1, 0]], rows=10, columns=10)
        >>> camera.aim.tolist(), camera.focal_length / camera.width
        ([0.0, 0.0, -1.0], 1.0)
        """
        matrix = numbers("P", P).astype(np.float64)
        if matrix.shape == (3, 4):
            if view is not None:
                raise ValueError("view is for a 4 x 4 P; a 3 x 4 one has the pose in it")
            if convention not in ("opencv", "colmap"):
                raise ValueError(f"convention must be opencv or colmap, got {convention!r}")
            k, pose = conventions.decomposed(matrix)
            return cls.from_intrinsics(
                k, rows=rows, columns=columns, convention=convention, pose=pose
            )
        if matrix.shape != (4, 4):
            raise ValueError(f"P must be a 3 x 4 or 4 x 4 matrix, got shape {matrix.shape}")
        down, across = count("rows", rows, 1), count("columns", columns, 1)
        says = conventions.of_gl_projection(matrix, down, across)
        seen = np.array(conventions.pose4(view))
        try:
            world = np.linalg.inv(seen)
        except np.linalg.LinAlgError:
            raise ValueError("view must have an inverse") from None
        if "K" in says:
            return cls.from_intrinsics(
                says["K"], rows=down, columns=across, convention="opengl", pose=world
            )
        base = cls.from_intrinsics(
            np.eye(3), rows=down, columns=across, convention="opengl", pose=world
        )
        shifts = {name: says[name] for name in ("shift_x", "shift_y")}
        return cls(
            base.position,
            base.aim,
            base.up,
            1.0,
            says["width"],
            says["height"],
            down,
            across,
            "orthographic",
            "eye",
            shifts,
        )

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Camera:
        """Read the camera that made an output from what the output says of itself.

        Parameters
        ----------
        path : path-like
            A picture or a point cloud that firsthit wrote, of any kind: ``docs/outputs.md``.

        Returns
        -------
        Camera
            The camera, bit for bit: it makes the same picture. Of a region, it is the camera of the
            whole.

        Raises
        ------
        ValueError
            For a file that does not say which camera made it.
        FileReadError, FileFormatError
            As `Frame.load`.

        Examples
        --------
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> camera = fh.Camera.framing(scene, rows=30, columns=40)
        >>> fh.render(scene, camera, channels="z").save("z.npz")
        >>> fh.Camera.load("z.npz") == camera
        True
        """
        # Frames import cameras' types.
        from firsthit._files.frame import read_metadata

        said = read_metadata(path)
        record = None if said is None else said.get("camera")
        if record is None:
            raise ValueError(f"{path} does not say which camera made it")
        _firsthit.note_input(Path(path))
        return cls._of(_firsthit.Camera.of_record(json.dumps(record)))

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

    @property
    def position(self) -> npt.NDArray[np.float64]:
        """The camera's position, in world space, (3,) float64: a copy."""
        return np.array(self._arguments[0])

    @property
    def aim(self) -> npt.NDArray[np.float64]:
        """The direction in which it looks, in world space, (3,) float64, of length one: a copy."""
        return np.array(self._native.frame()[1])

    @property
    def up(self) -> npt.NDArray[np.float64]:
        """The direction upwards, in world space, (3,) float64, as it was given: a copy."""
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
        return self._length("focal_length")

    @property
    def width(self) -> float | None:
        """Width of the viewplane, in scene units; ``None`` for a projection without one."""
        return self._length("width")

    @property
    def height(self) -> float | None:
        """Height of the viewplane, in scene units; ``None`` for a projection without one."""
        return self._length("height")

    @property
    def aperture(self) -> float:
        """Diameter of the lens, in scene units; 0 of a pinhole."""
        return self.parameters.get("aperture", 0.0)

    @property
    def focus(self) -> float | None:
        """Distance along the aim at which pictures are sharp; ``None`` if it was not given."""
        return self.parameters.get("focus") or None

    def _length(self, name: str) -> float | None:
        return self.parameters[name] if self.projection in _FLAT else None

    @property
    def rows(self) -> int:
        """Pixels down."""
        return self._arguments[3][0]

    @property
    def columns(self) -> int:
        """Pixels across."""
        return self._arguments[3][1]

    @property
    def projection(self) -> Projection:
        """The projection: one of those that `Camera` lists."""
        return self._arguments[4][0]

    @property
    def ray_start(self) -> RayStart:
        """``viewplane`` or ``eye``."""
        return self._arguments[4][1]

    @property
    def parameters(self) -> dict[str, float]:
        """All numbers of the projection by their names, also of the viewplane: a copy."""
        return dict(self._arguments[5])

    @property
    def intrinsic_matrix(self) -> npt.NDArray[np.float64] | None:
        """The intrinsic matrix K, (3, 3) float64; ``None`` for a projection without one.

        For the camera's coordinates x to the right, y down, z forwards; the centre of the first
        pixel is at (0.5, 0.5), as in COLMAP. Distortion comes before it. `to_opencv` gives
        OpenCV's.
        """
        k, _ = self._native.matrices("colmap")
        return None if k is None else np.array(k)

    @property
    def world_from_camera(self) -> npt.NDArray[np.float64]:
        """The pose, (4, 4) float64: from right, up and backwards to the world."""
        return np.array(self._native.matrices("opengl")[1])

    def to_convention(
        self, convention: Convention
    ) -> tuple[npt.NDArray[np.float64] | None, npt.NDArray[np.float64]]:
        """Return the intrinsic matrix and the pose as another program writes them.

        Parameters
        ----------
        convention : str
            As for `from_intrinsics`, which takes both back.

        Returns
        -------
        K : (3, 3) array of float64, or None
            ``None`` where there is none, as for parallel rays and panoramas.
        pose : (4, 4) array of float64
            The matrix of the pose.
        """
        k, pose = self._native.matrices(text("convention", convention))
        return None if k is None else np.array(k), np.array(pose)

    def to_opencv(self) -> OpenCvCamera:
        """Return the camera as OpenCV's functions take it.

        Returns
        -------
        OpenCvCamera
            ``K``, ``distortion``, ``rvec``, ``tvec``, ``R``, ``model`` and ``xi``.

        Raises
        ------
        ValueError
            For a projection that OpenCV does not have, and for a skew that it leaves out.
        """
        names = {
            "perspective": ("pinhole", ()),
            "opencv": ("pinhole", conventions.OPENCV),
            "opencv_fisheye": ("fisheye", conventions.FISHEYE),
            "mei": ("omnidir", conventions.OMNIDIR),
            "equidistant": ("fisheye", ()),
        }
        k, pose = self.to_convention("opencv")
        if k is None or self.projection not in names:
            raise ValueError(f"OpenCV has no such camera: {self.projection}")
        (model, order), values = names[self.projection], self.parameters
        conventions.check_skew(model, k[0, 1])
        distortion = np.array([values[name] for name in order])
        if self.projection == "equidistant":
            # The polynomial without a distortion.
            distortion = np.zeros(len(conventions.FISHEYE))
        turned = pose[:3, :3]
        rvec = conventions.rotation_vector(turned)
        xi = values.get("xi", 0.0) if model == "omnidir" else 0.0
        return OpenCvCamera(k, distortion, rvec, pose[:3, 3], turned, model, xi)

    def to_colmap(self) -> ColmapCamera:
        """Return the camera as COLMAP's files have it.

        Returns
        -------
        ColmapCamera
            The model, its parameters, and the pose; it writes lines of the text files. COLMAP has
            no aperture: that of a thin lens is left out.

        Raises
        ------
        ValueError
            For a camera that COLMAP has no model for.
        """
        return colmap.from_camera(self)

    def to_opengl(
        self, near: float, far: float
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """Return OpenGL's projection and view matrices.

        Parameters
        ----------
        near, far : float
            The distances of the planes between which OpenGL keeps what it draws; positive, and
            ``far`` may be infinite.

        Returns
        -------
        projection, view : (4, 4) array of float64
            Applied to columns: ``projection @ view @ (x, y, z, 1)`` is in clip space.

        Raises
        ------
        ValueError
            For a camera other than a perspective one without tilt, and for other planes.
        """
        k, pose = self.to_convention("opengl")
        if k is None or self.projection != "perspective":
            raise ValueError(f"OpenGL has no such camera: {self.projection}")
        planes = number("near", near), number("far", far)
        view = np.linalg.inv(pose).astype(np.float64, copy=False)
        return conventions.gl_projection(k, self.rows, self.columns, *planes), view

    def project(self, points: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """Say where in the picture points are seen, whether or not anything hides them.

        Parameters
        ----------
        points : (..., 3) array_like
            Points in world space.

        Returns
        -------
        (..., 2) array of float64
            Columns from the picture's left edge and rows from its upper edge: the centre of the
            first pixel is (0.5, 0.5), and what is beyond the edges has places there. NaN where the
            projection sees no such direction, as behind a pinhole or beyond a fold.

        Examples
        --------
        >>> camera = fh.Camera.look_at((0, -5, 0), (0, 0, 0), (0, 0, 1), 90, rows=480, columns=640)
        >>> camera.project([(0, 0, 0), (0, -9, 0)])
        array([[320., 240.],
               [ nan,  nan]])
        """
        given = vectors("points", points)
        flat_points = np.ascontiguousarray(given, np.float64).reshape(-1)
        return self._native.project(flat_points).reshape((*given.shape[:-1], 2))

    def crop(
        self,
        rows: slice | tuple[int, int] | tuple[slice, slice],
        columns: slice | tuple[int, int] | None = None,
    ) -> Camera:
        """Make the camera of a part of the picture; its intrinsic matrix follows.

        Parameters
        ----------
        rows, columns : slice or pair of int
            From and to, without steps, as NumPy counts them; or both in one, as
            ``np.s_[100:200, :]``.

        Returns
        -------
        Camera
            Its rays are those of the part, but for rounding; `render` with a ``region`` gives the
            same bits.

        Raises
        ------
        ValueError
            For an empty part or one beyond the picture, steps, and a projection without an
            intrinsic matrix other than ``orthographic``.

        Examples
        --------
        >>> camera = fh.Camera.from_intrinsics([50, 50, 32, 24], rows=48, columns=64,
        ...                                    convention="colmap")
        >>> camera.crop(slice(4, 40), slice(8, 60)).intrinsic_matrix[:2, 2]
        array([24., 20.])
        """
        if columns is None:
            if not isinstance(rows, tuple) or len(rows) != 2 or not isinstance(rows[0], slice):
                raise ValueError("crop takes rows and columns, or both as np.s_[rows, columns]")
            rows, columns = rows
        top, bottom = _span("rows", rows, self.rows)
        left, right = _span("columns", columns, self.columns)
        return self._of(self._native.crop((top, bottom, left, right)))

    def resize(self, rows: int, columns: int) -> Camera:
        """Make the camera of the same picture with other numbers of pixels, as by binning.

        Parameters
        ----------
        rows, columns : int
            Pixels down and across.

        Returns
        -------
        Camera
            Its intrinsic matrix follows; its viewplane is the same.

        Raises
        ------
        ValueError
            For no pixels, and for a shape that a cube map does not have.

        Examples
        --------
        >>> camera = fh.Camera.from_intrinsics([50, 50, 32, 24], rows=48, columns=64,
        ...                                    convention="colmap")
        >>> camera.resize(24, 32).intrinsic_matrix[:2, 2]
        array([16., 12.])
        """
        return self._of(self._native.resize(count("rows", rows, 1), count("columns", columns, 1)))

    def thin_lens(self, aperture: float, focus: npt.ArrayLike) -> Camera:
        """Return the same camera with a lens of some diameter, in focus at some distance.

        Parameters
        ----------
        aperture : float
            The diameter of the lens, a disc around ``position`` at right angles to ``aim``, in
            scene units; 0 for a pinhole.
        focus : float or (3,) array_like
            What is sharp: the distance along ``aim`` of a plane parallel to the viewplane, or a
            point of that plane in world space.

        Returns
        -------
        Camera
            Its own rays are those of the pinhole at ``position``, and so are all channels of its
            pictures but ``color``.

        Raises
        ------
        ValueError
            For an aperture that is negative, a focus that is not ahead of the camera, a projection
            other than ``perspective``, ``opencv`` and ``fov``, and a tilted viewplane or sensor.

        Notes
        -----
        Each sample of a picture comes from another point of the lens, through another point of the
        pixel; the first from the middle of both. A point at the distance z along the aim becomes a
        disc, whose diameter on the viewplane is
        ``aperture * abs(z - focus) / (z * focus) * focal_length``. With few samples one sees so
        many sharp pictures over each other: 64 or more make the blur smooth. With distortion the
        disc is that of the undistorted image: each ray goes from its point of the lens to where the
        pixel's own ray is in focus.

        Examples
        --------
        >>> camera = fh.Camera.look_at((0, -5, 0), (0, 0, 0), (0, 0, 1), 45, rows=48, columns=64)
        >>> camera = camera.thin_lens(0.5, focus=(1, -1, 2))
        >>> camera.aperture, camera.focus
        (0.5, 4.0)
        """
        is_point = np.ndim(focus) > 0
        far = self._native.depth(vector("focus", focus)) if is_point else number("focus", focus)
        return self._of(self._native.thin_lens(number("aperture", aperture), far))

    def moved(self, pose: npt.ArrayLike) -> Camera:
        """Return the same camera, carried by a body.

        Parameters
        ----------
        pose : (4, 4) or (3, 4) array_like
            The matrix that takes the coordinates in which this camera's position, aim and up are to
            others, such as those of the world; a rotation and a translation.

        Returns
        -------
        Camera
            One that is not turned keeps its bits, but for the position.

        Raises
        ------
        ValueError
            For a matrix that is no rigid motion.

        Examples
        --------
        >>> camera = fh.Camera.look_at((0, 0, 1), (1, 0, 1), (0, 0, 1), 60, rows=4, columns=6)
        >>> moved = camera.moved([[0, -1, 0, 5], [1, 0, 0, 0], [0, 0, 1, 0]])
        >>> moved.position.tolist(), moved.aim.tolist()
        ([5.0, 0.0, 1.0], [0.0, 1.0, 0.0])
        """
        return self._of(self._native.moved(conventions.pose4(pose)))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Camera):
            return False
        # The arguments may be the same and the aim, made of length one once more, not.
        mine, theirs = self._arguments, other._arguments
        same_frame = self._native.frame() == other._native.frame()
        return mine[:1] + mine[2:] == theirs[:1] + theirs[2:] and same_frame

    def __hash__(self) -> int:
        return hash(self._arguments[:1] + self._arguments[2:])

    def __repr__(self) -> str:
        position, aim, up, (rows, columns), (projection, ray_start), parameters = self._arguments
        others = dict(parameters)
        lens = [(name, others.pop(name)) for name in _LENS if name in others]
        lengths = [(name, others.pop(name, None)) for name in _LENGTHS]
        pairs: list[tuple[str, object]] = [("position", position), ("aim", aim), ("up", up)]
        pairs += [*lengths, ("rows", rows), ("columns", columns)]
        pairs += [("projection", projection), ("ray_start", ray_start)]
        if others := {name: value for name, value in others.items() if value}:
            pairs.append(("parameters", others))
        pairs += lens
        return f"Camera({', '.join(f'{name}={value!r}' for name, value in pairs)})"

    def __reduce__(self) -> tuple[object, tuple[object, ...]]:
        """Pickle by what it was made from."""
        vectors_, others = self._arguments[:3], self._arguments[3:]
        return type(self)._again, (self._is_taken, vectors_, *others)


def warn_before_viewplane(scene: _firsthit.Scene, camera: Sensor) -> None:
    """Warn where a camera sees nothing because its rays start behind what there is."""
    if not isinstance(camera, Camera) or camera.ray_start == "eye":
        return
    passed = _firsthit.before_viewplane(scene, camera._native)
    if passed:
        objects = "1 object is" if passed == 1 else f"{passed} objects are"
        why = "where this camera's rays start, and it sees nothing else"
        warn(f'{objects} between the eye and the viewplane, {why}; ray_start="eye" sees them')


def _parameters(given: Mapping[str, float] | None) -> dict[str, float]:
    if given is None:
        return {}
    if not isinstance(given, dict) and not hasattr(given, "items"):
        raise TypeError(f"parameters must be a dict of numbers, got {given!r}")
    return {text("a parameter", name): number(str(name), each) for name, each in given.items()}


def _thin_lens(
    projection: str, given: Mapping[str, float], aperture: float, focus: float | None
) -> dict[str, float]:
    """Return the numbers of a thin lens, if there is one."""
    for name in _LENS:
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


def _span(name: str, part: object, length: int) -> tuple[int, int]:
    """Return the first index of a part and the one behind it."""
    if isinstance(part, slice):
        first, last, step = part.indices(length)
        stop = part.stop
        if step != 1:
            raise ValueError(f"{name} must be without steps, got {part}")
        if stop is not None and stop > length:
            last = int(stop)
    elif isinstance(part, tuple | list) and len(part) == 2:
        first, last = (index(name, each) for each in part)
    else:
        raise ValueError(f"{name} must be a slice or a pair of ints, got {part!r}")
    if not 0 <= first < last <= length:
        raise ValueError(f"{name} must be a part of 0 to {length}, got {first} to {last}")
    return first, last
