"""How hits get their colour."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ._arrays import count, vector

if TYPE_CHECKING:
    from ._shapes import Vector

_SHADERS = ("lambert", "unlit", "normal")


@dataclass(frozen=True)
class Shading:
    """How hits get their colour, where `render` is not told.

    Parameters
    ----------
    shade : {"lambert", "unlit", "normal"}
        The shader.
    ambient : (3,) array_like, optional
        Lambert's light from everywhere.
    shadows : bool
        Whether Lambert's lights are blocked by things.
    samples : int
        Points of each pixel whose mean is its colour.
    """

    shade: str = "lambert"
    ambient: Vector | None = None
    shadows: bool = True
    samples: int = 1

    def __post_init__(self) -> None:
        if self.shade not in _SHADERS:
            raise ValueError(f"shade must be one of {', '.join(_SHADERS)}, got {self.shade!r}")
        if self.ambient is not None:
            object.__setattr__(self, "ambient", vector("ambient", self.ambient))
        if count("samples", self.samples) < 1:
            raise ValueError(f"samples must be at least 1, got {self.samples}")
