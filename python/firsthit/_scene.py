"""Scenes: objects, lights, and what rays meet in them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple, overload

import numpy as np

from . import _firsthit, _foreign
from ._arrays import color_of, numbers, text, threads_or_all, vector
from ._camera import Camera
from ._cameras import NamedCamera, find
from ._hits import Hits, hits_arrays
from ._lights import TRANSPARENT, Light, Sky, is_transparent
from ._object import Object, affine, placed
from ._progress import following, later
from ._rays import NO_MAXIMUM, NO_MINIMUM, Rays
from ._rounding import is_single
from ._shading import Shading
from ._shapes import Shape
from ._turn import Turn

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from ._material import Material
    from ._progress import Report
    from .typing import MeshLike, Progress, SceneLike, Vector


class _Built(NamedTuple):
    """What rays are shot at, and how many objects and lights it was built from."""

    native: _firsthit.Scene
    counts: tuple[int, int]


class Scene:
    """Objects and lights, to be shot at from any number of threads.

    An object's identifier is its index in the order of insertion. Adding is cheap: what rays need
    is built on the first shot, and what did not change since is kept.

    Examples
    --------
    >>> import firsthit as fh
    >>> scene = fh.Scene()
    >>> scene.add(fh.Plane(point=(0, 0, 0), normal=(0, 0, 1)), name="ground")
    0
    >>> scene.add(fh.Sphere(center=(0, 0, 1), radius=1), name="ball")
    1
    >>> scene
    Scene(2 objects, 0 triangles)
    """

    def __init__(self) -> None:
        self._objects: list[Object] = []
        self._lights: list[Light] = []
        self._cameras: tuple[NamedCamera, ...] = ()
        self._background: Sky | Vector | str | None = None
        self._shading = Shading()
        self._up: Vector = (0.0, 0.0, 1.0)
        #: Whether that is only the convention of the file's format.
        self._up_is_guessed = False
        #: Whether the first camera is the one to look through, as in scene files.
        self._has_view = False
        #: What was built last, of which the next takes what did not change.
        self._built: _Built | None = None
        self._turn = Turn()

    @overload
    def add(
        self,
        shape: Shape | MeshLike,
        *,
        name: str = "",
        transform: npt.ArrayLike | None = None,
        color: npt.ArrayLike | None = None,
        material: Material | Sequence[Material] | None = None,
    ) -> int: ...

    @overload
    def add(
        self,
        shape: SceneLike,
        *,
        transform: npt.ArrayLike | None = None,
        color: npt.ArrayLike | None = None,
        material: Material | Sequence[Material] | None = None,
    ) -> tuple[int, ...]: ...

    def add(
        self,
        shape: Shape | MeshLike | SceneLike,
        *,
        name: str = "",
        transform: npt.ArrayLike | None = None,
        color: npt.ArrayLike | None = None,
        material: Material | Sequence[Material] | None = None,
    ) -> int | tuple[int, ...]:
        """Add an object, or all objects of another package's scene.

        Parameters
        ----------
        shape : Shape, or another package's mesh or scene
            A `Mesh`, `Sphere`, ..., which objects may share: nothing is copied. Or anything with
            ``vertices`` and ``faces``, such as a ``trimesh.Trimesh``. Or a ``trimesh.Scene``: each
            of its nodes with a mesh becomes an object with the node's name and transform; nodes
            share their meshes. Colours of trimesh's vertices and faces (which are taken for sRGB),
            a material's colour and its picture come along; what is no mesh is left out with a
            warning. Scenes of other packages do not say which way is up: set `up` if it is not +z;
            trimesh leaves those of glTF files with +y.
        name : str
            Need not be unique. A scene's objects have their own.
        transform : (4, 4) or (3, 4) array_like, optional
            From object space to the world, applied to columns: any affine map that can be undone.
            Of a scene, from its world to this one.
        color : (3,) array_like or str, optional
            Its colour: linear numbers, or sRGB as ``"#rrggbb"`` or a CSS name. A light grey if left
            out, white for a mesh with colours of its own.
        material : Material or sequence of Material, optional
            In place of ``color``: its look, or one for each of a mesh's ``slots``.

        Returns
        -------
        int or tuple of int
            The object's identifier; of a scene those of its objects, in the order of its nodes.

        Raises
        ------
        ValueError
            For a transform that flattens space, for values of a wrong shape or type, and for a name
            with lone surrogates, which no file can hold.
        TypeError
            For something that is no shape, no material, or no name.

        Warns
        -----
        FirsthitWarning
            For what is left out of another package's scene.
        """
        name = text("name", name)
        matrix = None if transform is None else affine(transform)
        if _foreign.is_scene(shape):
            if name:
                raise ValueError(f"name must be left out with a scene, got {name!r}")
            parts = list(_foreign.objects(shape))
        elif isinstance(shape, Shape):
            parts = [_foreign.Part(name, shape)]
        elif hasattr(shape, "vertices") and hasattr(shape, "faces"):
            parts = [_foreign.Part(name, *_foreign.mesh(shape))]
        else:
            raise TypeError(f"shape must be a shape or have vertices and faces, got {shape!r}")
        made = [placed(part, matrix, color, material) for part in parts]
        # One step of the interpreter, without a lock: a signal's handler may come in between.
        self._objects.extend(made)
        if _foreign.is_scene(shape):
            first = self._identifier(made[0]) if made else 0
            return tuple(range(first, first + len(made)))
        return self._identifier(made[0])

    def _identifier(self, made: Object) -> int:
        """Return where an object is that was just added: others may have been added since."""
        return next(k for k in reversed(range(len(self._objects))) if self._objects[k] is made)

    def add_light(self, light: Light) -> None:
        """Add a light; a scene without any is lit from behind the camera's left shoulder.

        Parameters
        ----------
        light : DirectionalLight, PointLight or SpotLight
            The light.

        Raises
        ------
        TypeError
            For something else.
        """
        if not isinstance(light, Light):
            raise TypeError(f"light must be a light, got {light!r}")
        self._lights.append(light)

    @property
    def objects(self) -> tuple[Object, ...]:
        """The objects, in the order of their identifiers."""
        return tuple(self._objects)

    @property
    def lights(self) -> tuple[Light, ...]:
        """The lights."""
        return tuple(self._lights)

    @property
    def cameras(self) -> tuple[NamedCamera, ...]:
        """The cameras of the file that the scene was read from, in its order."""
        return self._cameras

    def camera(
        self, name: str | int = 0, *, columns: int | None = None, rows: int | None = None
    ) -> Camera:
        """Make a camera of the file that the scene was read from.

        Parameters
        ----------
        name : str or int
            Its name, or its number from 0.
        columns, rows : int, optional
            Pixels across and down, which must be given where the file does not.

        Returns
        -------
        Camera
            With square pixels, unless both its size and its pixels are the file's.

        Raises
        ------
        KeyError
            For a camera that is not there.
        """
        return find(self._cameras, name).at(columns=columns, rows=rows)

    @property
    def up(self) -> Vector:
        """Which way is up in the world, where `Camera.framing` and `render` are not told.

        That of the file: as a scene file says, +y for glTF. OBJ, STL and PLY files do not say: it
        is +y for OBJ and +z for STL and PLY, unless the meshes clearly stand on a flat base along
        the other of the two. Of other scenes +z.
        """
        return vector("up", self._native().likely_up(self._up)) if self._up_is_guessed else self._up

    @up.setter
    def up(self, up: npt.ArrayLike) -> None:
        direction = vector("up", up)
        if not (any(direction) and all(map(math.isfinite, direction))):
            raise ValueError(f"up must be a finite direction, not zero, got {direction}")
        self._up, self._up_is_guessed = direction, False

    @property
    def background(self) -> Sky | Vector | str | None:
        """What misses see where `render` is not told: a sky, a linear colour or "transparent"."""
        return self._background

    @background.setter
    def background(self, background: Sky | npt.ArrayLike | None) -> None:
        if background is None or isinstance(background, Sky):
            self._background = background
        elif is_transparent(background):
            self._background = "transparent"
        else:
            self._background = color_of("background", background, others=(TRANSPARENT,))

    @property
    def shading(self) -> Shading:
        """How hits get their colour, where `render` is not told."""
        return self._shading

    @shading.setter
    def shading(self, shading: Shading) -> None:
        if not isinstance(shading, Shading):
            raise TypeError(f"shading must be a Shading, got {shading!r}")
        self._shading = shading

    @property
    def bounds(self) -> npt.NDArray[np.float64]:
        """Low and high corner of the box around all finite objects, (2, 3); NaN without any."""
        bounds = self._native().bounds()
        return np.full((2, 3), np.nan) if bounds is None else np.array(bounds)

    def _native(self) -> _firsthit.Scene:
        """Return what rays are shot at: the objects and lights there are now, built."""
        current = self._current()
        if current is not None:
            return current
        with self._turn.taken():
            # Another thread may have built it while this one waited.
            return self._current() or self._build()

    def _current(self) -> _firsthit.Scene | None:
        """Return what was built last, unless something was added since."""
        built = self._built
        # Nothing is ever taken away: the counts tell whether it is all there.
        counts = len(self._objects), len(self._lights)
        return built.native if built is not None and built.counts == counts else None

    def _build(self) -> _firsthit.Scene:
        objects, lights, built = self._objects[:], self._lights[:], self._built
        native = _firsthit.Scene(
            [made._native() for made in objects],
            [light._native() for light in lights],
            None if built is None else built.native,
        )
        self._built = _Built(native, (len(objects), len(lights)))
        return native

    def _view(self) -> Camera:
        """Return the camera to look through where nobody says."""
        return self._cameras[0].camera if self._has_view else Camera.framing(self)

    def shoot(
        self,
        origins: npt.ArrayLike | Camera,
        directions: npt.ArrayLike | None = None,
        *,
        t_min: npt.ArrayLike = 0.0,
        t_max: npt.ArrayLike = math.inf,
        threads: int | None = None,
        progress: Progress | None = None,
        dtype: npt.DTypeLike | None = None,
    ) -> Hits:
        """Find the first object that each ray meets.

        Parameters
        ----------
        origins, directions : (..., 3) array_like
            World space, any real type; broadcast against each other. Directions of any length:
            ``t`` counts in lengths of a direction. Or a `Camera` alone, for the rays of its pixels.
            Arrays are copied, for the hits to compute from: they may be changed afterwards.
        t_min, t_max : (...) array_like
            Where rays begin and end: what is met has ``t_min < t <= t_max``. With a ``t_min`` of
            zero, a surface that a ray starts on is not met if the origin is exactly on it; a
            rounded one is to one side (see `Hits.position`). With a negative one it is, and so is
            what is behind the origin down to there.
        threads : int, optional
            How many to use, here and for the attributes of the hits; all cores if left out. The
            result is the same for any number.
        progress : bool or callable, optional
            ``True`` shows a bar (by tqdm, where that is installed). A function is called with how
            many rays are done and how many there are, about twenty times a second and at the end,
            in the calling thread; what it raises ends the work.
        dtype : {float64, float32}, optional
            The type of the distances: ``t``, ``range`` and ``z``. float64 if left out, whatever the
            rays' type. Everything is computed in float64 in any case. float32 is the nearest one
            with two exceptions: a hit's distance is finite, and zero only where it is zero; and
            where rounding would leave ``t_min < t <= t_max``, ``t`` is the next float32 that does
            not (where there is none between the two, the one below ``t_max``). Rays that go on
            from a hit need its float64 ``t``: a float32 may lie before the surface.

        Returns
        -------
        Hits
            Of the rays' shape. A ray that is zero, NaN or infinite, or begins where it ends, is a
            miss, alone.

        Raises
        ------
        ValueError
            For arrays whose shapes or types do not fit, with their names, and for another dtype.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> hits = scene.shoot([[0, 0, 3], [0.6, 0, 3]], [0, 0, -1])
        >>> hits.t
        array([2. , 2.2])
        >>> hits.normal[0]
        array([0., 0., 1.])
        """
        use = 0 if threads is None else threads_or_all(threads)
        single = dtype is not None and is_single(dtype)
        if isinstance(origins, Camera):
            if directions is not None:
                raise ValueError("directions must be left out with a camera, which has its own")
            if not (_are_all("t_min", t_min, 0.0) and _are_all("t_max", t_max, math.inf)):
                raise ValueError("t_min and t_max must be left out with a camera")
            with following(progress, origins.rows * origins.columns) as report:
                hits = self._shot_by(self._native(), origins, use, report)
            return hits._rounded(NO_MINIMUM, NO_MAXIMUM) if single else hits
        rays = Rays.of(origins, directions, t_min, t_max)
        limits = rays.arrays[2:]
        if progress is None:
            hits = self._shot(self._native(), rays, use, None)
        else:
            with following(progress, rays.length) as report:
                hits = self._shot(self._native(), rays, use, report)
        return hits._rounded(*limits) if single else hits

    def _shot_by(
        self, native: _firsthit.Scene, camera: Camera, threads: int, report: Report | None
    ) -> Hits:
        """Shoot a camera's rays at what was built."""
        out = hits_arrays(camera.rows * camera.columns)
        _firsthit.shoot_camera(native, camera._native, threads, out, report)
        return Hits._of_camera(self, native, out, camera, threads)

    def _shot(
        self, native: _firsthit.Scene, rays: Rays, threads: int, report: Report | None
    ) -> Hits:
        """Shoot rays at what was built."""
        out = hits_arrays(rays.length)
        # The hits keep the rays, from which they compute what is asked later.
        copies = rays.own()
        parts = rays.parts()
        if len(parts) == 1:
            _firsthit.shoot(native, rays.part(parts[0]), copies, threads, out, report)
        else:
            for part in parts:
                t, identifiers, primitive, barycentric = out
                pieces = t[part], identifiers[part], primitive[part], barycentric[part]
                told = later(report, part.start)
                _firsthit.shoot(native, rays.part(part), copies, threads, pieces, told)
        return Hits._of_rays(self, native, out, rays.keep(copies), threads)

    def occluded(
        self,
        origins: npt.ArrayLike,
        directions: npt.ArrayLike,
        *,
        t_min: npt.ArrayLike = 0.0,
        t_max: npt.ArrayLike = math.inf,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> npt.NDArray[np.bool_]:
        """Tell whether each ray meets anything. Sooner known than what it meets first.

        Parameters
        ----------
        origins, directions, t_min, t_max, threads, progress
            As for `shoot`.

        Returns
        -------
        (...) array of bool
            Whether anything is at ``t_min < t <= t_max``.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> eye, target = (0, 0, 5), (0, 0, 2)
        >>> bool(scene.occluded(eye, [0, 0, -3], t_max=1.0))  # is the target seen?
        False
        """
        use = 0 if threads is None else threads_or_all(threads)
        rays = Rays.of(origins, directions, t_min, t_max)
        found = np.empty(rays.length, np.bool_)
        # Once: what others add meanwhile is for the next call.
        native = self._native()
        with following(progress, rays.length) as report:
            for part in rays.parts():
                told = later(report, part.start)
                _firsthit.occluded(native, rays.part(part), use, found[part], told)
        return found.reshape(rays.shape)

    def __repr__(self) -> str:
        triangles = sum(made.triangles for made in self._objects)
        plural = "" if len(self._objects) == 1 else "s"
        return f"Scene({len(self._objects):,} object{plural}, {triangles:,} triangles)"

    def __getstate__(self) -> dict[str, Any]:
        """Pickle the objects; what is built from them is built again."""
        return {name: self.__dict__[name] for name in _KEPT}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__init__()  # type: ignore[misc]
        self.__dict__.update(state)

    def __copy__(self) -> Scene:
        """Copy: the shapes are shared, the lists are not."""
        other = Scene()
        other.__dict__.update({name: self.__dict__[name] for name in _KEPT})
        # Counted with what it was built from, which is not more than there is.
        other._built = self._built
        other._objects, other._lights = list(self._objects), list(self._lights)
        return other


#: What a scene is, beside what is built from it.
_KEPT = (
    "_objects",
    "_lights",
    "_cameras",
    "_has_view",
    "_background",
    "_shading",
    "_up",
    "_up_is_guessed",
)


def _are_all(name: str, given: npt.ArrayLike, number: float) -> bool:
    return bool(np.all(numbers(name, given) == number))
