"""Directions and places in what commands say."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

_AXES = {(1.0, 0.0, 0.0): "+x", (0.0, 1.0, 0.0): "+y", (0.0, 0.0, 1.0): "+z"}


def triple(vector: Iterable[float]) -> str:
    """Return three numbers as options take them, such as ``0,1.8,0``."""
    return ",".join(f"{number:g}" for number in vector)


def direction(vector: Sequence[float]) -> str:
    """Return a direction in words, an axis by its name, as the Rust program has it."""
    x, y, z = vector
    return _AXES.get((x, y, z), triple(vector))
