"""The nearest points of a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import count, flag, number, plain, threads_or_all, vectors
from firsthit._base.progress import following

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit._base.types import FillRule, Progress
    from firsthit._objects.traceable import Built


class ClosestPoints(NamedTuple):
    """The nearest points of a scene, as arrays.

    Their shape is that of the points, and with ``k`` they have one more axis of that length, the
    nearest first. Where there is none, the distance is ``inf``, the identifiers are ``-1``, and the
    rest is ``nan``.

    Attributes
    ----------
    point : (..., 3) array of float
        Where the nearest points are, in world space.
    distance : (...) array of float
        How far away they are.
    object, primitive : (...) array of int32
        The object, and which part of it: a mesh's triangle, a box's face, ...
    barycentric : (..., 3) array of float
        The weights of a triangle's corners 0, 1 and 2; ``nan`` on other shapes.
    """

    point: npt.NDArray[np.float64]
    distance: npt.NDArray[np.float64]
    object: npt.NDArray[np.int32]
    primitive: npt.NDArray[np.int32]
    barycentric: npt.NDArray[np.float64]


def closest_points(
    built: Built,
    points: npt.ArrayLike,
    k: int | None,
    radius: float,
    threads: int | None,
    progress: Progress | None,
) -> ClosestPoints:
    """Find the points of a scene that are nearest to points."""
    shape, flat = _flat(points)
    use = threads_or_all(threads)
    many = 1 if k is None else count("k", k, 1, 2**31 - 1)
    within = number("radius", radius)
    if not within >= 0:
        raise ValueError(f"radius must be zero or positive, got {radius!r}")
    with following(progress, len(flat)) as report:
        distance, identifiers, primitive, point, weights = _firsthit.closest_points(
            built.native,
            flat,
            (many, within),
            use,
            report,
        )
    shape = shape if k is None else (*shape, many)
    second, third = weights.reshape(-1, 2).T
    barycentric = np.column_stack((1.0 - second - third, second, third))
    return ClosestPoints(
        point.reshape(*shape, 3),
        distance.reshape(shape)[()],
        identifiers.reshape(shape)[()],
        primitive.reshape(shape)[()],
        barycentric.reshape(*shape, 3),
    )


def signed_distances(
    built: Built,
    points: npt.ArrayLike,
    rule: FillRule,
    allow_open: bool,  # noqa: FBT001 - given by name where users say it
    threads: int | None,
    progress: Progress | None,
) -> npt.NDArray[np.float64]:
    """Measure how far points are from the nearest surface, negative inside."""
    shape, flat = _flat(points)
    use, how = threads_or_all(threads), (rule, flag("allow_open", allow_open))
    with following(progress, len(flat)) as report:
        signed = _firsthit.signed_distances(built.native, flat, how, use, report)
    return signed.reshape(shape)[()]


def _flat(points: npt.ArrayLike) -> tuple[tuple[int, ...], npt.NDArray[np.float64]]:
    """Return the points' shape, and them as C-contiguous float64 of shape (n, 3)."""
    array = vectors("points", points)
    return array.shape[:-1], plain(array.reshape(-1, 3))
