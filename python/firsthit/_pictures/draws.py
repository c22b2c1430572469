"""Numbers for shaders to draw."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any

from firsthit import _firsthit

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    import numpy.typing as npt


class Draws:
    """Numbers from 0 up to 1 that a shader may draw, evenly spread over the samples of each pixel.

    A function ``shade(hits, draws)`` gets them beside its hits. They depend on the pixel, the
    sample, and how many were drawn before, and on nothing else: pictures are the same on every
    machine, for any number of threads. They are Sobol's sequence with Owen's scrambling (Burley,
    "Practical Hash-based Owen Scrambling", Journal of Computer Graphics Techniques 9(4), 2020).

    Attributes
    ----------
    sample : int
        The number of the sample, from 0.
    """

    sample: int

    def __init__(self, pixels: npt.NDArray[np.int64], sample: int) -> None:
        self.sample = sample
        self._pixels, self._shape, self._set = pixels.reshape(-1), pixels.shape, 0

    def one(self) -> npt.NDArray[np.float64]:
        """Return the next number for each hit, in the shape of the hits."""
        return self._next(1).reshape(self._shape)

    def two(self) -> npt.NDArray[np.float64]:
        """Return the next two numbers for each hit, a point of the unit square: (..., 2)."""
        return self._next(2).reshape(*self._shape, 2)

    def three(self) -> npt.NDArray[np.float64]:
        """Return the next three numbers for each hit: (..., 3)."""
        return self._next(3).reshape(*self._shape, 3)

    def four(self) -> npt.NDArray[np.float64]:
        """Return the next four numbers for each hit: (..., 4)."""
        return self._next(4).reshape(*self._shape, 4)

    def _next(self, count: int) -> npt.NDArray[np.float64]:
        drawn = _firsthit.draws(self._pixels, self.sample, self._set, count)
        self._set += 1
        return drawn


def takes_draws(shade: Callable[..., Any]) -> bool:
    """Tell whether a function takes numbers to draw beside hits: two positional arguments."""
    try:
        parameters = inspect.signature(shade).parameters.values()
    except (TypeError, ValueError):
        return False
    positional = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    needed = [p for p in parameters if p.kind in positional and p.default is p.empty]
    return len(needed) == 2
