"""Suggestions for a name that nothing has."""

from __future__ import annotations

from difflib import get_close_matches
from itertools import islice
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

#: The most names that are compared: more would take long.
_MOST = 10_000
#: Depth, as others call it, is one of two lengths.
_DEPTHS = {
    "z": "z, the distance along the camera's aim",
    "range": "range, the distance from the sensor",
}


def hint(name: object, known: Iterable[str]) -> str:
    """Return what an error says behind the names that there are; empty if nothing is near.

    Examples
    --------
    >>> from firsthit._base.hints import hint
    >>> hint("WALL", ["Wall 1", "floor"])
    "; did you mean 'Wall 1'?"
    """
    return _meant(_nearest(name, known))


def channel_hint(name: object, channels: Iterable[str]) -> str:
    """Return a hint about channels, which tells what depth is called.

    Examples
    --------
    >>> from firsthit._base.hints import channel_hint
    >>> channel_hint("Depth", ["color", "z"])
    "; depth is called z, the distance along the camera's aim"
    """
    there = list(channels)
    lengths = [words for length, words in _DEPTHS.items() if length in there]
    if not lengths and "t" in there:
        lengths = ["t, the length along the ray in units of its direction"]
    near = _nearest(name, [*there, *(["depth"] if lengths else [])])
    if near == "depth" and near not in there:
        return f"; depth is called {', or '.join(lengths)}"
    return _meant(near)


def _nearest(name: object, known: Iterable[str]) -> str | None:
    lowered = {each.lower(): each for each in islice(known, _MOST)}
    close = get_close_matches(name.lower(), lowered, 1) if isinstance(name, str) else []
    return lowered[close[0]] if close else None


def _meant(near: str | None) -> str:
    return "" if near is None else f"; did you mean {near!r}?"
