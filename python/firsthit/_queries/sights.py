"""Ends of lines of sight, and rays that measure how thick objects are."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import elements, flat, plain, vectors
from firsthit._objects.filters import Filters, surfaces

from .hits import Hits
from .leaving import rays_of
from .rays import Rays
from .source import Source

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit._objects.traceable import Built

    #: A point's place, and the object and primitive on which it lies.
    Pair = tuple[npt.ArrayLike, npt.ArrayLike]


def rays_through(hits: Hits, directions: npt.NDArray[np.float64]) -> Rays:
    """Return rays that leave surfaces and meet the object that they leave, and no other."""
    leaving = rays_of(hits.leave(directions), None)
    assert leaving.filters is not None
    assert leaving.filters.left is not None
    where, primitive, weights, sides = leaving.filters.left
    # From no side: at edges too they go through.
    left = where, primitive, weights, np.zeros_like(sides)
    return Rays(leaving.arrays, leaving.shape, filters=Filters(left=left, only=hits.object))


def of_length_one(directions: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return directions with the length one; NaN for those of length zero."""
    ways = np.array(vectors("directions", directions), np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        # Squares of very long and very short ones leave the range of float64.
        ways /= np.abs(ways).max(axis=-1, keepdims=True)
        ways /= np.linalg.norm(ways, axis=-1, keepdims=True)
    return ways


def surface_points(built: Built, points: npt.ArrayLike, threads: int) -> Hits:
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


def end(
    name: str, given: Any, skip: Pair | None
) -> tuple[npt.NDArray[Any], _firsthit._Surfaces | None]:
    """Return points and the surfaces that they lie on."""
    if isinstance(given, Hits):
        if skip is not None:
            raise ValueError(f"skip_{name} must be left out with Hits, which know their surfaces")
        return given.position, (given.object, given.primitive)
    array = vectors(name, given)
    return array, None if skip is None else surfaces(f"skip_{name}", skip)


def end_part(
    points: npt.NDArray[Any], skip: _firsthit._Surfaces | None, shape: tuple[int, ...], part: slice
) -> _firsthit._Ends:
    """Return some of the ends as the native half takes them."""
    if points.size == 3:
        flat_points = plain(points.reshape(1, 3))
    else:
        flat_points = flat(np.broadcast_to(points, (*shape, 3)), part, 1).reshape(-1, 3)
    if skip is None:
        return flat_points, None
    return flat_points, (elements(skip[0], shape, part), elements(skip[1], shape, part))
