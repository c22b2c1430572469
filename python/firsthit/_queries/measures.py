"""Shared steps of measures: rays in parts, and whether each object is asked about by itself."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit._base.progress import following, later

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy.typing as npt

    from firsthit._objects.traceable import Built
    from firsthit.typing import Progress

    from .rays import Rays


def in_parts(
    ask: Callable[..., npt.NDArray[np.float64]],
    built: Built,
    rays: Rays,
    how: tuple[bool, str],
    threads: int,
    progress: Progress | None,
) -> npt.NDArray[np.float64]:
    """Return what the native half measures along rays, flat."""
    pieces = []
    with following(progress, rays.length) as report:
        for part in rays.parts():
            told, count = later(report, part.start), part.stop - part.start
            pieces.append(ask(built.native, rays.part(part), count, how, threads, told))
    return joined(pieces, np.float64)


def is_by_object(by: str | None) -> bool:
    """Tell whether an answer is wanted for each object, not for all together."""
    if by is not None and by != "object":
        raise ValueError(f"by must be 'object' or None, got {by!r}")
    return by is not None


def joined(pieces: list[npt.NDArray[Any]], dtype: type[np.generic]) -> npt.NDArray[Any]:
    """Return the answers of several parts as one array."""
    if len(pieces) == 1:
        return pieces[0]
    return np.concatenate(pieces) if pieces else np.empty(0, dtype)
