"""Suggestions of channels for a name that none has."""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

#: Depth, as others call it, is one of two lengths.
_DEPTHS = {
    "z": "z, the distance along the camera's aim",
    "range": "range, the distance from the sensor",
}


def hint(name: object, known: Iterable[str]) -> str:
    """Return what an error says behind the channels that there are; empty if nothing is near.

    Examples
    --------
    >>> from firsthit._base.channel_hints import hint
    >>> hint("normals", ["color", "normal"])
    "; did you mean 'normal'?"
    """
    there = list(known)
    if not isinstance(name, str):
        return ""
    if name.lower() == "depth":
        lengths = [words for length, words in _DEPTHS.items() if length in there]
        if not lengths and "t" in there:
            lengths = ["t, the length along the ray in units of its direction"]
        return f"; depth is called {', or '.join(lengths)}" if lengths else ""
    close = get_close_matches(name.lower(), there, 1)
    return f"; did you mean {close[0]!r}?" if close else ""
