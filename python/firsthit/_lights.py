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
        The direction in which the light goes, in world space, of any length but zero.
    color : (3,) array_like or str
        The linear colour of a white surface that faces the light; any finite numbers, or sRGB as
        ``"#rrggbb"`` or a CSS name.

    Raises
    ------
    ValueError
        For values that make no sense, with their name.
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
        Where the light is, in world space.
    intensity : (3,) array_like or str
        The linear colour of a white surface that faces the light at a distance of one scene unit;
        any finite numbers, or sRGB as ``"#rrggbb"`` or a CSS name.

    Raises
    ------
    ValueError
        For values that make no sense, with their name.
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
        Where the light is, in world space.
    direction : (3,) array_like
        The direction of the cone's axis, in world space, of any length but zero.
    intensity : (3,) array_like or str
        The linear colour of a white surface on the axis that faces the light at a distance of one
        scene unit; any finite numbers, or sRGB as ``"#rrggbb"`` or a CSS name.
    inner_angle, outer_angle : float
        Radians from the axis. Up to the inner angle there is full light, from the outer angle on
        there is none. ``0 <= inner_angle < outer_angle <= pi / 2``.

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
    """A background that goes from one colour at the horizon to another at the zenith.

    Parameters
    ----------
    horizon, zenith : (3,) array_like or str
        The colours of rays that are level or go down, and of those that go straight up: linear
        numbers, not negative, or sRGB as ``"#rrggbb"`` or a CSS name.
    up : (3,) array_like
        The direction of the zenith, in world space, of any length but zero.

    Raises
    ------
    ValueError
        For values that make no sense, with their name.
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
