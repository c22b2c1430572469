"""Distances as float32, for those who ask for it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

_LARGEST = np.finfo(np.float32).max
_SMALLEST = np.finfo(np.float32).smallest_subnormal


def is_single(dtype: npt.DTypeLike | None) -> bool:
    """Tell whether a dtype is float32; raise a ``ValueError`` if it is not float64 either."""
    if dtype is None or dtype is np.float64:
        return False
    try:
        asked = np.dtype(dtype)
    except (TypeError, ValueError):
        asked = None
    if asked not in (np.float32, np.float64):
        raise ValueError(f"dtype must be float32 or float64, got {dtype!r}")
    return asked == np.float32


def singles(values: npt.NDArray[np.float64]) -> npt.NDArray[np.float32]:
    """Return the nearest float32, ties to even, but finite for what is finite, zero for zero only.

    Infinity stays a miss and nothing else becomes one.
    """
    with np.errstate(over="ignore", under="ignore"):
        made = values.astype(np.float32)
    overflowed = np.isinf(made) & np.isfinite(values)
    made[overflowed] = np.copysign(_LARGEST, made[overflowed])
    vanished = (made == 0) & (values != 0)
    made[vanished] = np.copysign(_SMALLEST, made[vanished])
    return made


def singles_within(
    t: npt.NDArray[np.float64], t_min: npt.NDArray[Any], t_max: npt.NDArray[Any]
) -> npt.NDArray[np.float32]:
    """Return `singles` of ``t``, moved by one float32 where rounding left ``t_min < t <= t_max``.

    Where no float32 lies between the two limits, it is the one below ``t_max``, if that is
    neither zero nor infinite. The limits broadcast against ``t``.
    """
    made = singles(t)
    with np.errstate(under="ignore", over="ignore", invalid="ignore"):
        # A miss is within every limit.
        below = (made <= t_min) & (t > t_min)
        above = np.nextafter(made, np.float32(np.inf))
        fits = (above != 0) & (above <= np.minimum(t_max, _LARGEST))
        made = np.where(below & fits, above, made)
        beyond = (made > t_max) & (t <= t_max)
        under = np.nextafter(made, np.float32(-np.inf))
        return np.where(beyond & (under != 0) & np.isfinite(under), under, made)
