"""Lines of sight, and the thickness of objects."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import chunks, elements, flat, number, plain, threads_or_all, vectors
from firsthit._base.progress import following, later
from firsthit._objects.filters import Filters, surfaces
from firsthit._objects.traceable import Traceable

from .hits import Hits
from .leaving import rays_of
from .rays import Rays
from .source import Source

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit._base.types import FillRule, Progress, Selection
    from firsthit._objects.filters import Surfaces
    from firsthit._objects.traceable import Built

    Pair = tuple[npt.ArrayLike, npt.ArrayLike]


class Sights(Traceable):
    """The part of `Scene` that looks along lines of sight."""

    def visible(
        self,
        a: npt.ArrayLike | Hits,
        b: npt.ArrayLike | Hits,
        *,
        skip_a: Pair | None = None,
        skip_b: Pair | None = None,
        tolerance: float = 0.0,
        objects: Selection | None = None,
        blend_below: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> npt.NDArray[np.bool_]:
        """Tell whether points see each other: whether nothing is on the line between them.

        The answer does not depend on which of the two comes first, to the bit. What is at an end
        hides nothing, for points of a surface are rounded to one side of it or the other: what is
        nearer to an end than 2^-40 of the ends' largest coordinate, some 1e-12 of it, and the
        surfaces of ends that are `Hits`. So two points of a solid's surface see each other through
        the solid, and the far side of a surface sees a lamp; whether an end faces the other is
        another question: ``((lamp - hits.position) * hits.normal).sum(-1) > 0``.

        Parameters
        ----------
        a, b : (..., 3) array_like, or Hits
            The points, in world space; they broadcast against each other. All pairs of two lists
            are ``visible(a[:, None], b)``, worked off in blocks. Of `Hits` they are the positions,
            and the surfaces there do not hide them; a miss sees nothing.
        skip_a, skip_b : pair of (...) array_like of int, optional
            The object and primitive on which each point of an array lies, -1 where there is none.
            It hides nothing, also where the line is nearly along it.
        tolerance : float
            What is nearer to either end than this hides nothing, in scene units: the error of
            points that are rounded, as to float32.
        objects : int, str, or sequence of them, optional
            What may be in the way, by identifiers or names: no other object hides anything.
        blend_below : float, optional
            As for `shoot`.
        threads, progress
            As for `shoot`; pairs are counted.

        Returns
        -------
        (...) array of bool
            Whether they see each other. A point sees itself. One that is not finite sees nothing.

        Raises
        ------
        ValueError
            For arrays whose shapes or types do not fit, with their names, and for a tolerance that
            is negative or not finite.
        ValueError, IndexError, TypeError
            For ``objects``, as `shoot`.
        MemoryError
            If the answers do not fit into memory.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> scene.visible([[0, 0, 5], [0, 2, 0]], [0, 0, -5])
        array([False,  True])
        >>> hits = scene.shoot((0, 0, 5), (0, 0, -1))
        >>> bool(scene.visible(hits, (0, 3, 5)))
        True
        """
        ends = _end("a", a, skip_a), _end("b", b, skip_b)
        try:
            shape = np.broadcast_shapes(*(array.shape[:-1] for array, _ in ends), *_shapes(ends))
        except ValueError:
            raise ValueError(
                f"a {ends[0][0].shape} and b {ends[1][0].shape} must broadcast against each other, "
                "and so must skip_a and skip_b"
            ) from None
        use, native = (
            threads_or_all(threads),
            self._seen(self._ready(), None, objects, blend_below).native,
        )
        near = number("tolerance", tolerance)
        length = math.prod(shape)
        seen = np.empty(length, np.bool_)
        with following(progress, length) as report:
            for part in chunks(length):
                told, count = later(report, part.start), part.stop - part.start
                both = _part(*ends[0], shape, part), _part(*ends[1], shape, part)
                seen[part] = _firsthit.visible(native, both, (count, near), use, told)
        return seen.reshape(shape)[()]

    def thickness(
        self,
        points: npt.ArrayLike | Hits,
        directions: npt.ArrayLike | None = None,
        *,
        rule: FillRule = "nonzero",
        objects: Selection | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> npt.NDArray[np.float64]:
        """Measure how thick objects are at points of their surfaces.

        It is the distance along a ray from the surface to where the ray comes out of the same
        object, or if it starts outside, into it. What is inside is as for `inside`; of an open mesh
        it is where the ray next meets it. The ray leaves the surface exactly, as `Hits.leave` has
        it. Other objects do not count.

        Parameters
        ----------
        points : (..., 3) array_like, or Hits
            Points in world space, each in place of the surface point nearest to it; or hits of this
            scene, before it changes.
        directions : (..., 3) array_like, optional
            The directions to measure along, of any length; they broadcast against the points. If
            left out, inwards: against the geometric normal, or along it in a mesh that is turned
            inside out.
        rule : {"nonzero", "parity"}
            What is inside of closed meshes, see `inside`.
        objects : int, str, or sequence of them, optional
            The only objects that are there, by identifiers or names; all by default. Points are
            brought to their surfaces, and hits on other objects have the thickness ``inf``.
        threads, progress
            As for `shoot`.

        Returns
        -------
        (...) array of float64
            Lengths in scene units. ``inf`` where the ray does not meet the object again; without
            ``directions`` 0 where neither side of a closed mesh is inside. NaN for a miss, for a
            direction that is zero or not finite, inwards from a triangle without an area, and for a
            point that is not finite or has no surface to be near to.

        Raises
        ------
        ValueError
            For arrays whose shapes or types do not fit, and another ``rule``.
        ValueError, IndexError, TypeError
            For ``objects``, as `shoot`.
        MemoryError
            If the lengths do not fit into memory.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Box(low=(0, 0, 0), high=(4, 4, 0.5)))
        0
        >>> scene.thickness([[1, 1, 0.5], [0, 2, 0.25]])
        array([0.5, 4. ])
        """
        use, built = threads_or_all(threads), self._seen(self._ready(), None, objects)
        hits = points if isinstance(points, Hits) else _nearest(built, points, use)
        ways = -hits.normal if directions is None else _of_length_one(directions)
        leaving = rays_of(hits.leave(ways), None)
        assert leaving.filters is not None
        assert leaving.filters.left is not None
        where, primitive, weights, sides = leaving.filters.left
        # From no side: at edges too they go through.
        left = where, primitive, weights, np.zeros_like(sides)
        filters = Filters(left=left, only=hits.object)
        rays = Rays(leaving.arrays, leaving.shape, filters=filters)
        how, pieces = (directions is None, rule), []
        with following(progress, rays.length) as report:
            for part in rays.parts():
                told, some, count = (
                    later(report, part.start),
                    rays.part(part),
                    part.stop - part.start,
                )
                pieces.append(_firsthit.thickness(built.native, some, count, how, use, told))
        found = np.concatenate(pieces) if pieces else np.empty(0)
        found = found.reshape(rays.shape)
        own = np.broadcast_to(hits.object, rays.shape)
        has_way = np.broadcast_to(np.isfinite(ways).all(axis=-1), rays.shape)
        thick: npt.NDArray[np.float64] = np.where((own < 0) | ~has_way, np.nan, found)
        return thick[()]  # of one point, a number


def _of_length_one(directions: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return directions with the length one; NaN for those of length zero."""
    ways = np.array(vectors("directions", directions), np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        # Squares of very long and very short ones leave the range of float64.
        ways /= np.abs(ways).max(axis=-1, keepdims=True)
        ways /= np.linalg.norm(ways, axis=-1, keepdims=True)
    return ways


def _nearest(built: Built, points: npt.ArrayLike, threads: int) -> Hits:
    """Return the surface points that are nearest to points, as if they were hit."""
    array = vectors("points", points)
    shape = array.shape[:-1]
    wanted = plain(array.reshape(-1, 3)), (1, math.inf), threads, None
    _, identifiers, primitive, places, weights = _firsthit.closest_points(built.native, *wanted)
    length = len(identifiers)
    t = np.where(identifiers < 0, np.inf, 0.0)
    arrays = t, identifiers, primitive, weights.reshape(length, 2)
    ways = np.array([0.0, 0.0, 1.0])
    rays = Rays.of(places.reshape(*shape, 3), ways, are_own=True)
    return Hits._of(built, arrays, Source(None, None, rays), shape, threads)


def _end(name: str, given: Any, skip: Pair | None) -> tuple[npt.NDArray[Any], Surfaces | None]:
    """Return points and the surfaces that they lie on."""
    if isinstance(given, Hits):
        if skip is not None:
            raise ValueError(f"skip_{name} must be left out with Hits, which know their surfaces")
        return given.position, (given.object, given.primitive)
    array = vectors(name, given)
    return array, None if skip is None else surfaces(f"skip_{name}", skip)


def _shapes(ends: Any) -> list[tuple[int, ...]]:
    return [array.shape for _, skip in ends if skip is not None for array in skip]


def _part(
    points: npt.NDArray[Any], skip: Surfaces | None, shape: tuple[int, ...], part: slice
) -> _firsthit._Ends:
    """Return some of the ends as the native half takes them."""
    if points.size == 3:
        flat_points = plain(points.reshape(1, 3))
    else:
        flat_points = flat(np.broadcast_to(points, (*shape, 3)), part, 1).reshape(-1, 3)
    if skip is None:
        return flat_points, None
    return flat_points, (elements(skip[0], shape, part), elements(skip[1], shape, part))
