"""Lights and skies."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ._arrays import color_of, number, settle, vector

if TYPE_CHECKING:
    import numpy.typing as npt

    from ._types import Vector

    LightTuple = tuple[str, Vector, Vector, tuple[Vector, tuple[float, float]] | None]


@dataclass(frozen=True, init=False)
class DirectionalLight:
    """Parallel light from infinitely far away.

    Parameters
    ----------
    direction : (3,) array_like
        Where the light goes, of any length but zero.
    color : (3,) array_like or str
        The linear colour that a white surface facing the light takes.
    """

    direction: Vector
    color: Vector

    def __init__(self, direction: npt.ArrayLike, color: npt.ArrayLike = (1.0, 1.0, 1.0)) -> None:
        settle(
            self,
            direction=_direction("direction", direction),
            color=color_of("color", color, is_light=True),
        )

    def _native(self) -> LightTuple:
        return "directional", self.direction, self.color, None


@dataclass(frozen=True, init=False)
class PointLight:
    """Light from one point, falling off with the square of the distance.

    Parameters
    ----------
    position : (3,) array_like
        Where it is.
    intensity : (3,) array_like or str
        The linear colour that a white surface facing the light takes at distance one.
    """

    position: Vector
    intensity: Vector

    def __init__(self, position: npt.ArrayLike, intensity: npt.ArrayLike = (1.0, 1.0, 1.0)) -> None:
        settle(self, position=vector("position", position))
        settle(self, intensity=color_of("intensity", intensity, is_light=True))

    def _native(self) -> LightTuple:
        return "point", self.position, self.intensity, None


@dataclass(frozen=True, init=False)
class SpotLight:
    """Light from one point within a cone, falling off with the square of the distance.

    Parameters
    ----------
    position : (3,) array_like
        Where it is.
    direction : (3,) array_like
        Where the middle of the cone goes, of any length but zero.
    intensity : (3,) array_like or str
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
    intensity: Vector
    inner_angle: float
    outer_angle: float

    def __init__(
        self,
        position: npt.ArrayLike,
        direction: npt.ArrayLike,
        intensity: npt.ArrayLike = (1.0, 1.0, 1.0),
        inner_angle: float = 0.0,
        outer_angle: float = math.pi / 4,
    ) -> None:
        settle(self, position=vector("position", position))
        settle(self, direction=_direction("direction", direction))
        settle(self, intensity=color_of("intensity", intensity, is_light=True))
        settle(self, inner_angle=number("inner_angle", inner_angle))
        settle(self, outer_angle=number("outer_angle", outer_angle))
        if not 0 <= self.inner_angle < self.outer_angle <= math.pi / 2:
            raise ValueError(
                "inner_angle must be from 0 to below outer_angle, and that at most a quarter turn, "
                f"got {self.inner_angle} and {self.outer_angle}"
            )

    def _native(self) -> LightTuple:
        cone = (self.direction, (self.inner_angle, self.outer_angle))
        return "spot", self.position, self.intensity, cone


@dataclass(frozen=True, init=False)
class Sky:
    """What rays see that meet nothing: from one colour to another by height.

    Parameters
    ----------
    horizon, zenith : (3,) array_like or str
        Colours where the direction is level (and below), and straight up.
    up : (3,) array_like
        Which way is up, of any length but zero.
    """

    horizon: Vector
    zenith: Vector
    up: Vector

    def __init__(
        self,
        horizon: npt.ArrayLike,
        zenith: npt.ArrayLike,
        up: npt.ArrayLike = (0.0, 0.0, 1.0),
    ) -> None:
        settle(self, horizon=color_of("horizon", horizon), zenith=color_of("zenith", zenith))
        settle(self, up=_direction("up", up))


def _direction(name: str, value: npt.ArrayLike) -> Vector:
    direction = vector(name, value)
    if not any(direction):
        raise ValueError(f"{name} must be a direction, not zero, got {direction}")
    return direction


Light = DirectionalLight | PointLight | SpotLight


#: The background of pictures with alpha.
TRANSPARENT = "transparent"


def is_transparent(background: Sky | npt.ArrayLike) -> bool:
    """Tell whether a background is transparent."""
    return isinstance(background, str) and background.strip().lower() == TRANSPARENT


def background_native(background: Sky | npt.ArrayLike) -> list[Vector]:
    """Return one colour, or horizon, zenith and up; an empty list for a transparent one."""
    if is_transparent(background):
        return []
    if isinstance(background, Sky):
        return [background.horizon, background.zenith, background.up]
    return [color_of("background", background, others=(TRANSPARENT,))]
