"""Lights and skies."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import color_of, direction, settle, settle_numbers

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit.typing import Vector


@dataclass(frozen=True, init=False)
class DirectionalLight:
    """Parallel light from infinitely far away.

    Parameters
    ----------
    direction : (3,) array_like
        The direction in which the light goes, in world space, of any length but zero.
    color : (3,) array_like or str
        The linear colour of a white surface that faces the light; numbers that are not negative,
        or sRGB as ``"#rrggbb"`` or a CSS name.
    angle_degrees : float
        The diameter of a round sun, in degrees, from 0 to 180; above 0 its shadows are soft. That
        of Earth's sun is 0.53.

    Raises
    ------
    ValueError
        For values that make no sense, with their name.
    """

    direction: Vector
    color: Vector
    angle_degrees: float

    def __init__(
        self,
        direction: npt.ArrayLike,
        color: npt.ArrayLike = (1.0, 1.0, 1.0),
        angle_degrees: float = 0.0,
    ) -> None:
        _settle(self, direction=direction, color=color, angle_degrees=angle_degrees)


@dataclass(frozen=True, init=False)
class PointLight:
    """Light from one point, falling off with the square of the distance.

    Parameters
    ----------
    position : (3,) array_like
        Where the light is, in world space.
    intensity : (3,) array_like or str
        The linear colour of a white surface that faces the light at a distance of one scene unit;
        numbers that are not negative, or sRGB as ``"#rrggbb"`` or a CSS name.

    Raises
    ------
    ValueError
        For values that make no sense, with their name.
    """

    position: Vector
    intensity: Vector

    def __init__(self, position: npt.ArrayLike, intensity: npt.ArrayLike = (1.0, 1.0, 1.0)) -> None:
        _settle(self, position=position, intensity=intensity)


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
        scene unit; numbers that are not negative, or sRGB as ``"#rrggbb"`` or a CSS name.
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
        given = {"inner_angle": inner_angle, "outer_angle": outer_angle}
        _settle(self, position=position, direction=direction, intensity=intensity, **given)
        if not 0 <= self.inner_angle < self.outer_angle <= math.pi / 2:
            raise ValueError(
                "inner_angle must be from 0 to below outer_angle, and that at most a quarter turn, "
                f"got {self.inner_angle} and {self.outer_angle}"
            )


@dataclass(frozen=True, init=False)
class SphereLight:
    """A sphere that shines, outwards and evenly; its shadows are soft.

    Parameters
    ----------
    center : (3,) array_like
        Its middle, in world space.
    radius : float
        Its radius, in scene units.
    emission : (3,) array_like or str
        Its linear radiance, the colour that it has itself; numbers that are not negative,
        or sRGB as ``"#rrggbb"`` or a CSS name. No picture shows it, but surfaces reflect it.

    Raises
    ------
    ValueError
        For values that make no sense, with their name.
    """

    center: Vector
    radius: float
    emission: Vector

    def __init__(
        self,
        center: npt.ArrayLike,
        radius: float = 1.0,
        emission: npt.ArrayLike = (1.0, 1.0, 1.0),
    ) -> None:
        _settle(self, center=center, radius=radius, emission=emission)


@dataclass(frozen=True, init=False)
class DiscLight:
    """A disc that shines on one side, evenly; its shadows are soft.

    Parameters
    ----------
    center : (3,) array_like
        Its middle, in world space.
    normal : (3,) array_like
        The side that shines, in world space, of any length but zero.
    radius : float
        Its radius, in scene units.
    emission : (3,) array_like or str
        As that of a `SphereLight`.

    Raises
    ------
    ValueError
        For values that make no sense, with their name.
    """

    center: Vector
    normal: Vector
    radius: float
    emission: Vector

    def __init__(
        self,
        center: npt.ArrayLike,
        normal: npt.ArrayLike,
        radius: float = 1.0,
        emission: npt.ArrayLike = (1.0, 1.0, 1.0),
    ) -> None:
        _settle(self, center=center, normal=normal, radius=radius, emission=emission)


@dataclass(frozen=True, init=False)
class RectangleLight:
    """A rectangle, or another parallelogram, that shines on one side; its shadows are soft.

    Parameters
    ----------
    center : (3,) array_like
        Its middle, in world space.
    edge_u, edge_v : (3,) array_like
        From one edge to the opposite one, in world space. The side shines from which the turn from
        ``edge_u`` to ``edge_v`` is counter-clockwise.
    emission : (3,) array_like or str
        As that of a `SphereLight`.

    Raises
    ------
    ValueError
        For values that make no sense, with their name, and for parallel edges.
    """

    center: Vector
    edge_u: Vector
    edge_v: Vector
    emission: Vector

    def __init__(
        self,
        center: npt.ArrayLike,
        edge_u: npt.ArrayLike,
        edge_v: npt.ArrayLike,
        emission: npt.ArrayLike = (1.0, 1.0, 1.0),
    ) -> None:
        _settle(self, center=center, edge_u=edge_u, edge_v=edge_v, emission=emission)
        if not np.any(np.cross(self.edge_u, self.edge_v)):
            raise ValueError(f"edge_v must not be parallel to edge_u, got {self.edge_v}")


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
        settle(self, up=direction("up", up))


Light = DirectionalLight | PointLight | SpotLight | SphereLight | DiscLight | RectangleLight

_KINDS: dict[str, type[Light]] = {
    "directional": DirectionalLight,
    "point": PointLight,
    "spot": SpotLight,
    "sphere": SphereLight,
    "disc": DiscLight,
    "rectangle": RectangleLight,
}


def _settle(light: Light, **given: npt.ArrayLike) -> None:
    """Give a light its settings, which the native half checks."""
    for name, value in given.items():
        if name in ("color", "intensity", "emission"):
            settle(light, **{name: color_of(name, value, is_light=True)})
        else:
            settle_numbers(light, **{name: value})
    _firsthit.check_light(light_native(light))


def light_native(light: Light) -> _firsthit._Light:
    """Return the kind of a light, and its settings."""
    kind = next(name for name, made in _KINDS.items() if isinstance(light, made))
    return kind, [(field.name, getattr(light, field.name)) for field in fields(light)]


def light_of(kind: str, settings: list[tuple[str, float | Vector]]) -> Light:
    """Return the light of a file, whose colours are its own affair, however bright."""
    light = object.__new__(_KINDS[kind])
    settle(light, **dict(settings))
    return light


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
