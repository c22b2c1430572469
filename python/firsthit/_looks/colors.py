"""Colours by numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import color_of, number, numbers, one_of, settle

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit.typing import ColorMapName, Vector

#: Sources of numbers beside attributes; names of colour maps.
WORDS, MAPS = _firsthit.color_names()

_ATTRIBUTE = "attribute:"


@dataclass(frozen=True, init=False)
class Colors:
    """Colours of surfaces by numbers, in place of their own colours. Immutable.

    Every shader lights these colours as it lights others. `render` takes one as ``color_by``, and
    `Shading` as ``colors``. The legend is ``frame.metadata["colors"]``.

    Parameters
    ----------
    by : str or (n,) array_like of float
        The source of the numbers: the name of an attribute of the meshes, ``"NAME"`` or
        ``"attribute:NAME"``, of several numbers the length of their vector; ``"object"``,
        ``"face"``, ``"height"`` or ``"incidence"``; or a number for each object of the scene.
    map : str, optional
        The colour map: ``"viridis"``, ``"cividis"``, ``"plasma"``, ``"inferno"``, ``"magma"``,
        ``"turbo"``, ``"coolwarm"``, ``"spectral"``, ``"blues"`` or ``"grey"``.
    range : (float, float), optional
        The numbers of the first and the last colour. If left out, the least and the largest that
        the scene has, seen or not.
    below, above : (3,) array_like or str, optional
        The colours of numbers outside a given range. If left out, the first and the last of the
        map.
    missing : (3,) array_like or str, optional
        The colour where there is no number, or NaN. If left out, the surface's own.

    Raises
    ------
    ValueError
        For an unknown map, numbers of another shape, a range whose numbers do not rise, and
        ``below`` or ``above`` without a range.

    Examples
    --------
    >>> fh.Colors("attribute:heat", map="coolwarm", range=(-1, 1)).by
    'attribute:heat'
    """

    by: str | tuple[float, ...]
    map: ColorMapName
    range: tuple[float, float] | None
    below: Vector | None
    above: Vector | None
    missing: Vector | None

    def __init__(
        self,
        by: str | npt.ArrayLike,
        *,
        map: ColorMapName = "viridis",  # noqa: A002 - the field's word
        range: tuple[float, float] | None = None,  # noqa: A002 - the field's word
        below: npt.ArrayLike | None = None,
        above: npt.ArrayLike | None = None,
        missing: npt.ArrayLike | None = None,
    ) -> None:
        ends = None if range is None else _range(range)
        if ends is None and (below is not None or above is not None):
            raise ValueError("below and above need a range: of all numbers none is outside")
        settle(
            self,
            by=_by(by),
            map=one_of("map", map, MAPS),
            range=ends,
            below=None if below is None else color_of("below", below),
            above=None if above is None else color_of("above", above),
            missing=None if missing is None else color_of("missing", missing),
        )

    def _native(self) -> _firsthit._Colors:
        by = self.by if isinstance(self.by, str) else None
        values = [] if isinstance(self.by, str) else list(self.by)
        outside = (self.below, self.above, self.missing)
        return by, values, self.map, self.range, outside


def colors_of(base: Colors | None, by: Any, **changes: Any) -> Colors | None:
    """Return what `render` is asked for: `base` with another source, and with other settings."""
    base = by if isinstance(by, Colors) else base if by is None else Colors(by)
    given = {name: value for name, value in changes.items() if value is not None}
    if base is None and given:
        raise ValueError(f"color_{next(iter(given))} needs color_by")
    return base if base is None or not given else replace(base, **given)


def from_native(colors: _firsthit._Colors) -> Colors:
    """Return what a file says."""
    by, values, name, ends, (below, above, missing) = colors
    what: Any = values if by is None else by
    more = {"below": below, "above": above, "missing": missing}
    return Colors(what, map=name, range=ends, **more)


def _by(by: object) -> str | tuple[float, ...]:
    if isinstance(by, str):
        if not by or by == _ATTRIBUTE:
            raise ValueError("by must be the name of an attribute, which is not empty")
        return by if by in WORDS or by.startswith(_ATTRIBUTE) else _ATTRIBUTE + by
    values = np.asarray(numbers("by", by), np.float64)
    if values.ndim != 1:
        raise ValueError(f"by must be a name, or a number for each object, got {values.shape}")
    return tuple(values.tolist())


def _range(given: Any) -> tuple[float, float]:
    try:
        first, last = given
    except (TypeError, ValueError):
        raise ValueError(f"range must be two numbers that rise, got {given!r}") from None
    low, high = number("range", first), number("range", last)
    if not (low < high and math.isfinite(high - low)):
        raise ValueError(f"range must be two numbers that rise, got {given!r}")
    return low, high
