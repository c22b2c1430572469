"""Lights and skies."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ._arrays import number, vector

if TYPE_CHECKING:
    import numpy.typing as npt

    from ._shapes import Vector

    LightTuple = tuple[str, Vector, Vector, tuple[Vector, tuple[float, float]] | None]


@dataclass(frozen=True)
class DirectionalLight:
    """Parallel light from infinitely far away.

    Parameters
    ----------
    direction : (3,) array_like
        Where the light goes, of any length but zero.
    color : (3,) array_like
        The linear colour that a white surface facing the light takes.
    """

    direction: Vector
    color: Vector = (1.0, 1.0, 1.0)

    def __post_init__(self) -> None:
        direction = vector("direction", self.direction)
        if not any(direction):
            raise ValueError(f"direction must be a direction, not zero, got {direction}")
        object.__setattr__(self, "direction", direction)
        object.__setattr__(self, "color", vector("color", self.color))

    def _native(self) -> LightTuple:
        return "directional", self.direction, self.color, None


@dataclass(frozen=True)
class PointLight:
    """Light from one point, falling off with the square of the distance.

    Parameters
    ----------
    position : (3,) array_like
        Where it is.
    intensity : (3,) array_like
        The linear colour that a white surface facing the light takes at distance one.
    """

    position: Vector
    intensity: Vector = (1.0, 1.0, 1.0)

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", vector("position", self.position))
        object.__setattr__(self, "intensity", vector("intensity", self.intensity))

    def _native(self) -> LightTuple:
        return "point", self.position, self.intensity, None


@dataclass(frozen=True)
class SpotLight:
    """Light from one point within a cone, falling off with the square of the distance.

    Parameters
    ----------
    position : (3,) array_like
        Where it is.
    direction : (3,) array_like
        Where the middle of the cone goes, of any length but zero.
    intensity : (3,) array_like
        The linear colour that a white surface facing the light takes at distance one.
    inner_angle, outer_angle : float
        Radians between the middle and the end of full light, and the end of all light: from 0 to a
        quarter turn, the inner one less.

    Raises
    ------
    ValueError
        For values that make no sense, with their name.
    """

    position: Vector
    direction: Vector
    intensity: Vector = (1.0, 1.0, 1.0)
    inner_angle: float = 0.0
    outer_angle: float = math.pi / 4

    def __post_init__(self) -> None:
        for name in ("position", "direction", "intensity"):
            object.__setattr__(self, name, vector(name, getattr(self, name)))
        for name in ("inner_angle", "outer_angle"):
            object.__setattr__(self, name, number(name, getattr(self, name)))
        if not any(self.direction):
            raise ValueError(f"direction must be a direction, not zero, got {self.direction}")
        if not 0 <= self.inner_angle < self.outer_angle <= math.pi / 2:
            raise ValueError(
                "inner_angle must be from 0 to below outer_angle, and that at most a quarter turn, "
                f"got {self.inner_angle} and {self.outer_angle}"
            )

    def _native(self) -> LightTuple:
        cone = (self.direction, (self.inner_angle, self.outer_angle))
        return "spot", self.position, self.intensity, cone


@dataclass(frozen=True)
class Sky:
    """What rays see that meet nothing: from one colour to another by height.

    Parameters
    ----------
    horizon, zenith : (3,) array_like
        Linear colours where the direction is level (and below), and straight up.
    up : (3,) array_like
        Which way is up, of any length but zero.
    """

    horizon: Vector
    zenith: Vector
    up: Vector = (0.0, 0.0, 1.0)

    def __post_init__(self) -> None:
        for name in ("horizon", "zenith", "up"):
            object.__setattr__(self, name, vector(name, getattr(self, name)))
        if not any(self.up):
            raise ValueError(f"up must be a direction, not zero, got {self.up}")


Light = DirectionalLight | PointLight | SpotLight


def background_native(background: Sky | npt.ArrayLike) -> list[Vector]:
    """Return one colour, or horizon, zenith and up."""
    if isinstance(background, Sky):
        return [background.horizon, background.zenith, background.up]
    return [vector("background", background)]
