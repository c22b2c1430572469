"""Suggestions for a name that nothing has."""

from __future__ import annotations

from difflib import get_close_matches
from itertools import islice
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

#: So many names are compared; more would take long.
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
    >>> from firsthit._base.channel_hints import hint
    >>> hint("normals", ["color", "normal"])
    "; did you mean 'normal'?"
    """
    there = list(islice(known, _MOST))
    if not isinstance(name, str):
        return ""
    lengths = [words for length, words in _DEPTHS.items() if length in there]
    if not lengths and "t" in there:
        lengths = ["t, the length along the ray in units of its direction"]
    close = get_close_matches(name.lower(), [*there, *(["depth"] if lengths else [])], 1)
    if close == ["depth"] and lengths:
        return f"; depth is called {', or '.join(lengths)}"
    return f"; did you mean {close[0]!r}?" if close else ""
