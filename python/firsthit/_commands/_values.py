"""Values of options, as the Rust program reads them."""

from __future__ import annotations

import argparse
import math
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

_UNITS = {"": 0, "K": 10, "M": 20, "G": 30, "T": 40}


def numbers(least: int, most: int | None = None) -> Callable[[str], list[float]]:
    """Return a reader of finite numbers with commas between: from ``least`` to ``most`` many."""
    highest = least if most is None else most
    many = f"{least}" if highest == least else f"{least} to {highest}"
    expected = f"{many} number{'' if highest == 1 else 's, with commas between'}"

    def read(text: str) -> list[float]:
        try:
            found = [float(part) for part in text.split(",")]
        except ValueError:
            found = []
        if not least <= len(found) <= highest or not all(map(math.isfinite, found)):
            raise argparse.ArgumentTypeError(f"must be {expected}, got {text}")
        return found

    return read


def positive(text: str) -> float:
    """Read a finite number above zero."""
    (found,) = numbers(1)(text)
    if not found > 0.0:
        raise argparse.ArgumentTypeError(f"must be above 0, got {text}")
    return found


def whole(least: int) -> Callable[[str], int]:
    """Return a reader of whole numbers that are not below ``least``."""

    def read(text: str) -> int:
        found = int(text) if re.fullmatch(r"\s*[+-]?\d{1,30}\s*", text, re.ASCII) else None
        if found is None or found < least:
            raise argparse.ArgumentTypeError(f"must be a whole number from {least} on, got {text}")
        return found

    return read


def named_number(text: str) -> tuple[str, int]:
    """Read a name and a whole number from 0 on, as ``NAME=N``."""
    name, _, number = text.rpartition("=")
    if not name:
        raise argparse.ArgumentTypeError(f"must be NAME=N, got {text}")
    return name, whole(0)(number)


def memory(text: str) -> int:
    """Read bytes, or with K, M, G or T powers of 1024."""
    found = re.fullmatch(r"(\d{1,18})([KMGT]?)", text.upper(), re.ASCII)
    if found is None:
        expected = "must be a number of bytes, or one with K, M, G or T"
        raise argparse.ArgumentTypeError(f"{expected}, got {text}")
    return int(found[1]) << _UNITS[found[2]]
