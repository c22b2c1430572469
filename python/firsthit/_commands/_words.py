"""Numbers in what commands say."""

from __future__ import annotations


def count(number: int, noun: str) -> str:
    """Return how many of something there are."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def size(bytes: int) -> str:  # noqa: A002 - it is what is counted
    """Return a number of bytes in the unit in which people say it."""
    left, units = float(bytes), ["bytes", "KB", "MB", "GB", "TB", "PB"]
    while left >= 1000.0 and len(units) > 1:
        left /= 1000.0
        del units[0]
    return f"{left:.3g} {units[0]}"
