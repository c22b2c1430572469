"""The display of colours in pictures to look at."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, get_args

from firsthit._base.arrays import number, one_of, settle
from firsthit.typing import ToneMapName

if TYPE_CHECKING:
    import numpy.typing as npt


@dataclass(frozen=True, init=False)
class Display:
    """The default display of linear colours in PNGs: see `Scene.display`. Immutable.

    ``docs/outputs.md`` says what the tone maps do.

    Parameters
    ----------
    exposure : float
        In stops: colours are multiplied by 2 to its power first.
    tone_map : {"none", "neutral", "agx", "aces"}
        How colours of any brightness are then brought to those from 0 to 1. ``"none"`` shows what
        is above 1 as 1, ``"neutral"`` is Khronos PBR Neutral.

    Raises
    ------
    ValueError
        For an exposure that is no finite number, and an unknown tone map.

    Examples
    --------
    >>> fh.Display(-1, "neutral")
    Display(exposure=-1.0, tone_map='neutral')
    """

    exposure: float
    tone_map: ToneMapName

    def __init__(self, exposure: npt.ArrayLike = 0.0, tone_map: ToneMapName = "none") -> None:
        stops = number("exposure", exposure)
        if not math.isfinite(stops):
            raise ValueError(f"exposure must be finite, got {stops}")
        settle(self, exposure=stops, tone_map=one_of("tone_map", tone_map, get_args(ToneMapName)))

    @property
    def _native(self) -> tuple[float, str]:
        """As the native half takes it."""
        return self.exposure, self.tone_map

    def _but(self, exposure: npt.ArrayLike | None, tone_map: ToneMapName | None) -> Display:
        """Return the same with what is given in its place."""
        stops = self.exposure if exposure is None else exposure
        return Display(stops, self.tone_map if tone_map is None else tone_map)


def as_display(display: Display) -> Display:
    """Return what a user gave, which must be one."""
    if not isinstance(display, Display):
        raise TypeError(f"display must be a Display, got {display!r}")
    return display
