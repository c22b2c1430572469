"""Lines of sight, and the thickness of objects."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import chunks, elements, flat, number, plain, threads_or_all, vectors
from firsthit._base.progress import following, later
from firsthit._objects.filters import Filters, surfaces

from .hits import Hits
from .leaving import rays_of
from .rays import Rays
from .source import Source

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit._base.types import FillRule, Progress
    from firsthit._objects.filters import Surfaces
    from firsthit._objects.traceable import Built

    #: A point's place, and the object and primitive on which it lies.
    Pair = tuple[npt.ArrayLike, npt.ArrayLike]
    Point = tuple[npt.ArrayLike | Hits, Pair | None]


def visible(
    built: Built,
    a: Point,
    b: Point,
    tolerance: float,
    threads: int | None,
    progress: Progress | None,
) -> npt.NDArray[np.bool_]:
    """Tell whether points see each other, each given with the surface that it lies on."""
    ends = _end("a", *a), _end("b", *b)
    try:
        shape = np.broadcast_shapes(*(array.shape[:-1] for array, _ in ends), *_shapes(ends))
    except ValueError:
        raise ValueError(
            f"a {ends[0][0].shape} and b {ends[1][0].shape} must broadcast against each other, "
            "and so must skip_a and skip_b"
        ) from None
    use, near = threads_or_all(threads), number("tolerance", tolerance)
    length = math.prod(shape)
    seen = np.empty(length, np.bool_)
    with following(progress, length) as report:
        for part in chunks(length):
            told, count = later(report, part.start), part.stop - part.start
            both = _part(*ends[0], shape, part), _part(*ends[1], shape, part)
            seen[part] = _firsthit.visible(built.native, both, (count, near), use, told)
    return seen.reshape(shape)[()]


def thickness(
    built: Built,
    points: npt.ArrayLike | Hits,
    directions: npt.ArrayLike | None,
    rule: FillRule,
    threads: int | None,
    progress: Progress | None,
) -> npt.NDArray[np.float64]:
    """Measure how thick objects are at points of their surfaces."""
    use = threads_or_all(threads)
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
