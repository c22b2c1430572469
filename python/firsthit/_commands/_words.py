"""Numbers and directions in what commands say, and values of their options."""

from __future__ import annotations

import argparse
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence


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


_AXES = {(1.0, 0.0, 0.0): "+x", (0.0, 1.0, 0.0): "+y", (0.0, 0.0, 1.0): "+z"}


def triple(vector: Iterable[float]) -> str:
    """Return three numbers as options take them, such as ``0,1.8,0``."""
    return ",".join(f"{number:g}" for number in vector)


def direction(vector: Sequence[float]) -> str:
    """Return a direction in words, an axis by its name, as the Rust program has it."""
    x, y, z = vector
    return _AXES.get((x, y, z), triple(vector))


def whole(least: int) -> Callable[[str], int]:
    """Return a reader of whole numbers that are not below ``least``."""

    def read(text: str) -> int:
        found = int(text) if re.fullmatch(r"\s*[+-]?\d{1,30}\s*", text, re.ASCII) else None
        if found is None or found < least:
            raise argparse.ArgumentTypeError(f"must be a whole number from {least} on, got {text}")
        return found

    return read
