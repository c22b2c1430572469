"""Measures of the inside of a scene's objects."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import chunks, flag, flat, is_flat, threads_or_all, vectors
from firsthit._base.progress import following, later

from .leaving import LeavingRays, rays_of

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit._base.types import FillRule, Progress, Rule
    from firsthit._objects.traceable import Built


def inside(
    built: Built,
    points: npt.ArrayLike,
    by: str | None,
    rule: FillRule,
    return_rules: bool,  # noqa: FBT001 - given by name where users say it
    threads: int | None,
    progress: Progress | None,
) -> npt.NDArray[np.bool_] | tuple[npt.NDArray[np.bool_], tuple[Rule, ...]]:
    """Tell which points are inside the objects, and how that is known if it is asked."""
    array = vectors("points", points)
    is_by_object, with_rules = _is_by_object(by), flag("return_rules", return_rules)
    use, native, how = threads_or_all(threads), built.native, (is_by_object, rule)
    leading = array.shape[:-1]
    length = math.prod(leading)
    pieces = []
    with following(progress, length) as report:
        for part in [slice(0, length)] if is_flat(array) else chunks(length):
            told, some = later(report, part.start), flat(array, part, 1)
            pieces.append(_firsthit.inside(native, some, how, use, told))
    shape = (*leading, len(built.objects)) if is_by_object else leading
    found = _joined(pieces, np.bool_).reshape(shape)[()]
    if not with_rules:
        return found
    rules: Any = _firsthit.rules(native, rule)
    return found, tuple(rules)


def path_length(
    built: Built,
    given: tuple[Any, ...],
    by: str | None,
    rule: FillRule,
    threads: int | None,
    progress: Progress | None,
) -> npt.NDArray[np.float64]:
    """Measure how much of each ray is inside the objects; ``given`` is as `rays_of` has it."""
    is_by_object = _is_by_object(by)
    if isinstance(given[0], LeavingRays):
        raise ValueError("origins must not be LeavingRays: give their origin and direction")
    rays = rays_of(*given)
    use, native, how = threads_or_all(threads), built.native, (is_by_object, rule)
    pieces = []
    with following(progress, rays.length) as report:
        for part in rays.parts():
            told, count = later(report, part.start), part.stop - part.start
            some = rays.part(part)
            pieces.append(_firsthit.path_lengths(native, some, count, how, use, told))
    shape = (*rays.shape, len(built.objects)) if is_by_object else rays.shape
    return _joined(pieces, np.float64).reshape(shape)[()]


def _is_by_object(by: str | None) -> bool:
    if by is not None and by != "object":
        raise ValueError(f"by must be 'object' or None, got {by!r}")
    return by is not None


def _joined(pieces: list[npt.NDArray[Any]], dtype: type[np.generic]) -> npt.NDArray[Any]:
    if len(pieces) == 1:
        return pieces[0]
    return np.concatenate(pieces) if pieces else np.empty(0, dtype)
