"""Memory for results, used again once nobody holds it.

The system clears every page of fresh memory, which for a camera's hits would cost a quarter of the
time. So the arrays handed out last are remembered, and one that has no other owner is handed out
again. A view of an array is an owner of it, as is a ``memoryview`` or another library's tensor.
"""

from __future__ import annotations

import sys
import threading
from typing import Any

import numpy as np
import numpy.typing as npt

#: Bytes that are remembered at most, in use or not.
KEPT = 1 << 26

#: Arrays below this many bytes are nothing to the system.
SMALL = 1 << 18

_remembered: list[npt.NDArray[Any]] = []
_lock = threading.Lock()


def empty(shape: tuple[int, ...], dtype: type[np.generic]) -> npt.NDArray[Any]:
    """Return an array whose elements are anything, like `numpy.empty`."""
    with _lock:
        # What was used last is in the cache, if anything is.
        for k in reversed(range(len(_remembered))):
            array = _remembered[k]
            # The list, the variable and the call: three references.
            if array.shape == shape and array.dtype == dtype and sys.getrefcount(array) == 3:
                _remembered.append(_remembered.pop(k))
                return array
    fresh = np.empty(shape, dtype)
    if SMALL <= fresh.nbytes <= KEPT:
        with _lock:
            _remembered.append(fresh)
            total = sum(array.nbytes for array in _remembered)
            while total > KEPT:
                total -= _remembered.pop(0).nbytes
    return fresh
