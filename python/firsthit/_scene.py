"""Scenes: objects, lights, and what rays meet in them."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _firsthit
from ._arrays import chunks, flat, is_flat, numbers, threads_or_all, vector
from ._camera import Camera
from ._cameras import NamedCamera, find
from ._hits import Hits, hits_arrays
from ._lights import Light, Sky
from ._material import Material
from ._shading import Shading
from ._shapes import Mesh, Shape, Vector

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt


class Object:
    """A shape somewhere in a scene, as `Scene.add` made it. Read only."""

    def __init__(
        self,
        shape: Shape,
        name: str,
        transform: npt.NDArray[np.float64] | None,
        materials: tuple[Material, ...],
    ) -> None:
        self._shape, self._name, self._transform = shape, name, transform
        self._materials = materials

    @property
    def shape(self) -> Shape:
        """The shape, in object space."""
        return self._shape

    @property
    def name(self) -> str:
        """Its name; may be empty."""
        return self._name

    @property
    def transform(self) -> npt.NDArray[np.float64]:
        """From object space to the world, (4, 4): a copy."""
        return np.eye(4) if self._transform is None else self._transform.copy()

    @property
    def color(self) -> Vector | None:
        """Its linear colour, that of its first material; ``None`` where nobody gave one."""
        return self._materials[0].color if self._materials else None

    @property
    def materials(self) -> tuple[Material, ...]:
        """Its materials, in the order of a mesh's slots; none where nobody gave it a look."""
        return self._materials

    @property
    def triangles(self) -> int:
        """How many triangles it has; 0 for shapes that are no mesh."""
        return self._shape._mesh.counts()[1] if isinstance(self._shape, Mesh) else 0

    def __repr__(self) -> str:
        return f"Object({self._name!r}, {self._shape!r})"

    def _native(
        self,
    ) -> tuple[_firsthit.Shape, str, list[list[float]] | None, list[_firsthit._Material]]:
        rows = None if self._transform is None else self._transform.tolist()
        materials = [material._native() for material in self._materials]
        return self._shape._native(), self._name, rows, materials


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
        self._background: Sky | Vector | None = None
        self._shading = Shading()
        self._up: Vector = (0.0, 0.0, 1.0)
        self._built: _firsthit.Scene | None = None
        self._is_current = False
        self._lock = threading.Lock()

    def add(
        self,
        shape: Shape | Any,
        *,
        name: str = "",
        transform: npt.ArrayLike | None = None,
        color: npt.ArrayLike | None = None,
        material: Material | Sequence[Material] | None = None,
    ) -> int:
        """Add an object.

        Parameters
        ----------
        shape : Shape
            A `Mesh`, `Sphere`, ..., or anything with ``vertices`` and ``faces``. Objects may share
            one: nothing is copied.
        name : str
            Need not be unique.
        transform : (4, 4) or (3, 4) array_like, optional
            From object space to the world, applied to columns: any affine map that can be undone.
        color : (3,) array_like, optional
            Its linear colour; a light grey if left out, white for a mesh with colours of its own.
        material : Material or sequence of Material, optional
            In place of ``color``: its look, or one for each of a mesh's ``slots``.

        Returns
        -------
        int
            The object's identifier.

        Raises
        ------
        ValueError
            For a transform that flattens space, and for values of a wrong shape or type.
        TypeError
            For something that is no shape.
        """
        if not isinstance(shape, Shape):
            if not (hasattr(shape, "vertices") and hasattr(shape, "faces")):
                raise TypeError(f"shape must be a shape or have vertices and faces, got {shape!r}")
            shape = Mesh(shape)
        matrix = None if transform is None else _affine(transform)
        made = Object(shape, str(name), matrix, _materials(shape, color, material))
        with self._lock:
            self._objects.append(made)
            self._is_current = False
            return len(self._objects) - 1

    def add_light(self, light: Light) -> None:
        """Add a light; a scene without any is lit from behind the camera's left shoulder."""
        with self._lock:
            self._lights.append(light)
            self._is_current = False

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
    def background(self) -> Sky | Vector | None:
        """What rays see that meet nothing, where `render` is not told: a sky or a linear colour."""
        return self._background

    @background.setter
    def background(self, background: Sky | npt.ArrayLike | None) -> None:
        if background is None or isinstance(background, Sky):
            self._background = background
        else:
            self._background = vector("background", background)

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
        with self._lock:
            if self._built is None or not self._is_current:
                objects = [made._native() for made in self._objects]
                lights = [light._native() for light in self._lights]
                self._built = _firsthit.Scene(objects, lights, self._built)
                self._is_current = True
            return self._built

    def shoot(
        self,
        origins: npt.ArrayLike | Camera,
        directions: npt.ArrayLike | None = None,
        *,
        t_min: npt.ArrayLike = 0.0,
        t_max: npt.ArrayLike = np.inf,
        threads: int | None = None,
    ) -> Hits:
        """Find the first object that each ray meets.

        Parameters
        ----------
        origins, directions : (..., 3) array_like
            World space, any real type; broadcast against each other. Directions of any length:
            ``t`` counts in lengths of a direction. Or a `Camera` alone, for the rays of its pixels.
        t_min, t_max : (...) array_like
            Where rays begin and end: what is met has ``t_min < t <= t_max``. Below zero,
            ``t_min`` is as good as zero: nothing behind an origin is met.
        threads : int, optional
            How many to use; all cores if left out. The result is the same for any number.

        Returns
        -------
        Hits
            Of the rays' shape. A ray that is zero, NaN or infinite, or begins where it ends, is a
            miss, alone.

        Raises
        ------
        ValueError
            For arrays whose shapes or types do not fit, with their names.

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
        use = threads_or_all(threads)
        if isinstance(origins, Camera):
            if directions is not None:
                raise ValueError("directions must be left out with a camera, which has its own")
            if not (_are_all("t_min", t_min, 0.0) and _are_all("t_max", t_max, np.inf)):
                raise ValueError("t_min and t_max must be left out with a camera")
            out = hits_arrays(origins.rows * origins.columns)
            _firsthit.shoot_camera(self._native(), origins._native, use, out)
            return Hits._of_camera(self, origins, out)
        rays = _rays(origins, directions, t_min, t_max)
        native, length = self._native(), int(np.prod(rays[2].shape))
        out = hits_arrays(length)
        for part in _parts(rays, length):
            t, identifiers, primitive, barycentric = out
            pieces = t[part], identifiers[part], primitive[part], barycentric[part]
            _firsthit.shoot(native, _part(rays, part), use, pieces)
        return Hits._of_rays(self, rays, out)

    def occluded(
        self,
        origins: npt.ArrayLike,
        directions: npt.ArrayLike,
        *,
        t_min: npt.ArrayLike = 0.0,
        t_max: npt.ArrayLike = np.inf,
        threads: int | None = None,
    ) -> npt.NDArray[np.bool_]:
        """Tell whether each ray meets anything. Sooner known than what it meets first.

        Parameters
        ----------
        origins, directions, t_min, t_max, threads
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
        use = threads_or_all(threads)
        rays = _rays(origins, directions, t_min, t_max)
        shape = rays[2].shape
        found = np.empty(int(np.prod(shape)), np.bool_)
        for part in _parts(rays, len(found)):
            found[part] = _firsthit.occluded(self._native(), _part(rays, part), use)
        return found.reshape(shape)

    def __repr__(self) -> str:
        triangles = sum(made.triangles for made in self._objects)
        plural = "" if len(self._objects) == 1 else "s"
        return f"Scene({len(self._objects):,} object{plural}, {triangles:,} triangles)"

    def __getstate__(self) -> dict[str, Any]:
        """Pickle the objects; what is built from them is built again."""
        kept = ("_objects", "_lights", "_cameras", "_background", "_shading", "_up")
        return {name: self.__dict__[name] for name in kept}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__init__()  # type: ignore[misc]
        self.__dict__.update(state)

    def __copy__(self) -> Scene:
        """Copy: the shapes are shared, the lists are not."""
        other = Scene()
        other._objects, other._lights = list(self._objects), list(self._lights)
        other._cameras, other._background = self._cameras, self._background
        other._shading, other._up = self._shading, self._up
        with self._lock:
            other._built, other._is_current = self._built, self._is_current
        return other


Rays = tuple["npt.NDArray[Any]", "npt.NDArray[Any]", "npt.NDArray[Any]", "npt.NDArray[Any]"]


def _rays(origins: Any, directions: Any, t_min: npt.ArrayLike, t_max: npt.ArrayLike) -> Rays:
    """Origins, directions and both limits, as views of one leading shape."""
    if directions is None:
        raise ValueError("directions must be given, except with a camera")
    starts, ways = numbers("origins", origins), numbers("directions", directions)
    for name, array in (("origins", starts), ("directions", ways)):
        if array.ndim == 0 or array.shape[-1] != 3:
            raise ValueError(f"{name} must have the shape (..., 3), got {array.shape}")
    begins, ends = numbers("t_min", t_min), numbers("t_max", t_max)
    leading = starts.shape[:-1], ways.shape[:-1], begins.shape, ends.shape
    try:
        shape = np.broadcast_shapes(*leading)
    except ValueError:
        raise ValueError(
            f"origins {starts.shape}, directions {ways.shape}, t_min {begins.shape} and "
            f"t_max {ends.shape} must broadcast against each other"
        ) from None
    to = (*shape, 3)
    begins, ends = np.broadcast_to(begins, shape), np.broadcast_to(ends, shape)
    return np.broadcast_to(starts, to), np.broadcast_to(ways, to), begins, ends


def _parts(rays: Rays, length: int) -> list[slice]:
    """Return what goes to the native half at a time: all, where nothing of it is copied."""
    origins, directions, *limits = rays
    one_go = is_flat(origins) and is_flat(directions)
    one_go = one_go and all(is_flat(limit) or _is_one(limit) for limit in limits)
    return [slice(0, length)] if one_go else list(chunks(length))


def _is_one(limits: npt.NDArray[Any]) -> bool:
    """Tell whether all limits are one number."""
    return limits.strides == (0,) * limits.ndim and limits.size > 0


def _part(rays: Rays, part: slice) -> tuple[npt.NDArray[np.float64], ...]:
    origins, directions, t_min, t_max = rays
    return (
        flat(origins, part, 1),
        flat(directions, part, 1),
        _limit(t_min, part),
        _limit(t_max, part),
    )


def _limit(limits: npt.NDArray[Any], part: slice) -> npt.NDArray[np.float64]:
    if _is_one(limits):
        return limits.reshape(-1)[:1].astype(np.float64)
    return flat(limits, part, 0)


def _are_all(name: str, given: npt.ArrayLike, number: float) -> bool:
    return bool(np.all(numbers(name, given) == number))


def _affine(transform: npt.ArrayLike) -> npt.NDArray[np.float64]:
    matrix = numbers("transform", transform).astype(np.float64)
    if matrix.shape == (3, 4):
        matrix = np.vstack([matrix, [0.0, 0.0, 0.0, 1.0]])
    if matrix.shape != (4, 4):
        raise ValueError(f"transform must have the shape (4, 4) or (3, 4), got {matrix.shape}")
    if not np.array_equal(matrix[3], [0, 0, 0, 1]):
        raise ValueError(f"transform must have the last row 0, 0, 0, 1, got {matrix[3]}")
    # Refused here, not at the first shot.
    _firsthit.check_transform(matrix.tolist())
    return matrix


def _materials(
    shape: Shape, color: npt.ArrayLike | None, material: Material | Sequence[Material] | None
) -> tuple[Material, ...]:
    if material is not None:
        if color is not None:
            raise ValueError("color must be left out with a material, which has its own")
        made = (material,) if isinstance(material, Material) else tuple(material)
        for each in made:
            if not isinstance(each, Material):
                raise TypeError(f"material must be a Material or several, got {each!r}")
        return made
    if color is None:
        painted = isinstance(shape, Mesh) and shape.colors is not None
        return (Material(),) if painted else ()
    return (Material(vector("color", color)),)
