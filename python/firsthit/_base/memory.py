"""Memory for results, used again once no result holds it.

The system clears every page of fresh memory, which for a camera's hits would cost a quarter of the
time. So the arrays handed out last are remembered, and one that has no other owner is handed out
again. A view of an array is an owner of it, as is a ``memoryview`` or another library's tensor.
"""

from __future__ import annotations

import gc
import math
import sys
import threading
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from collections.abc import Iterator

#: Bytes that are remembered at most, in use or not: the hits of 1.6 million rays, and the copies
#: of these rays.
KEPT = 1 << 27

#: Arrays below this many bytes are nothing to the system.
SMALL = 1 << 18

_remembered: list[npt.NDArray[Any]] = []
_lock = threading.Lock()


@contextmanager
def uncollected() -> Iterator[None]:
    """Make many objects while the collector of unreachable ones rests.

    All of them are reachable, and it would look at them again and again: of 100,000 objects that
    took a fifth of the time of a load, and half of that of their scene.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


def empty(shape: tuple[int, ...], dtype: type[np.generic]) -> npt.NDArray[Any]:
    """Return an array whose elements are anything, like `numpy.empty`."""
    if math.prod(shape) * np.dtype(dtype).itemsize < SMALL:
        return np.empty(shape, dtype)
    # Whoever comes in between, a signal's handler or a process forked meanwhile, does without.
    if not hasattr(sys, "getrefcount") or not _lock.acquire(blocking=False):
        return np.empty(shape, dtype)
    try:
        # How an array is counted that only a list holds differs between interpreters.
        alone = _references([np.empty(0)], 0)
        # The value used last is in the cache, if any is.
        for k in reversed(range(len(_remembered))):
            if _references(_remembered, k) == alone and _is_like(_remembered[k], shape, dtype):
                array = _remembered.pop(k)
                _remembered.append(array)
                # Hits are read-only for those who had it before.
                array.setflags(write=True)
                return array
        fresh = np.empty(shape, dtype)
        if SMALL <= fresh.nbytes <= KEPT:
            _remembered.append(fresh)
            total = sum(array.nbytes for array in _remembered)
            while total > KEPT:
                total -= _remembered.pop(0).nbytes
        return fresh
    finally:
        _lock.release()


def _references(arrays: list[npt.NDArray[Any]], k: int) -> int:
    array = arrays[k]
    return sys.getrefcount(array)


def _is_like(array: npt.NDArray[Any], shape: tuple[int, ...], dtype: type[np.generic]) -> bool:
    """Tell whether an array is as `numpy.empty` would make it: its owners may have changed it."""
    flags = array.flags
    return array.shape == shape and array.dtype == dtype and flags.c_contiguous and flags.owndata
