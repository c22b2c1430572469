"""Shapes, in object space. They are immutable, and many objects can share one."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, ClassVar

from firsthit import _firsthit
from firsthit._base.arrays import settle_numbers

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy.typing as npt

    from firsthit.typing import Vector


class Shape:
    """Any shape. Its coordinates and lengths are in object space."""

    #: The function of the native half that makes it of its numbers, in their order.
    _make: ClassVar[Callable[..., _firsthit.Shape]]

    def _settle(self, **given: npt.ArrayLike) -> None:
        """Take the numbers, which the native half checks."""
        settle_numbers(self, **given)
        self._native()

    def _native(self) -> _firsthit.Shape:
        numbers_: Any = fields(self)  # type: ignore[arg-type] # all but a mesh are dataclasses
        return self._make(*(getattr(self, field.name) for field in numbers_))


@dataclass(frozen=True, init=False)
class Sphere(Shape):
    """A sphere, in object space.

    Parameters
    ----------
    center : (3,) array_like
        Its centre.
    radius : float
        Its radius, positive.

    Raises
    ------
    ValueError
        For values that make no sense, with their name.

    Examples
    --------
    >>> fh.Sphere(center=(0, 1, 0), radius=1)
    Sphere(center=(0.0, 1.0, 0.0), radius=1.0)
    """

    _make = _firsthit.Shape.sphere
    center: Vector
    radius: float

    def __init__(self, center: npt.ArrayLike, radius: float) -> None:
        self._settle(center=center, radius=radius)


@dataclass(frozen=True, init=False)
class Plane(Shape):
    """An infinite plane, in object space.

    Parameters
    ----------
    point : (3,) array_like
        A point of it.
    normal : (3,) array_like
        The direction that its front faces, of any length but zero.

    Raises
    ------
    ValueError
        For values that make no sense, with their name.
    """

    _make = _firsthit.Shape.plane
    point: Vector
    normal: Vector

    def __init__(self, point: npt.ArrayLike, normal: npt.ArrayLike) -> None:
        self._settle(point=point, normal=normal)


@dataclass(frozen=True, init=False)
class Disc(Shape):
    """A flat round disc, in object space.

    Parameters
    ----------
    center : (3,) array_like
        Its centre.
    normal : (3,) array_like
        The direction that its front faces, of any length but zero.
    radius : float
        Its radius, positive.

    Raises
    ------
    ValueError
        For values that make no sense, with their name.
    """

    _make = _firsthit.Shape.disc
    center: Vector
    normal: Vector
    radius: float

    def __init__(self, center: npt.ArrayLike, normal: npt.ArrayLike, radius: float) -> None:
        self._settle(center=center, normal=normal, radius=radius)


@dataclass(frozen=True, init=False)
class Box(Shape):
    """A box with its sides along the axes of object space.

    Primitives 0 to 5 are its faces -x, +x, -y, +y, -z, +z.

    Parameters
    ----------
    low, high : (3,) array_like
        Two corners, ``low`` below ``high`` along every axis.

    Raises
    ------
    ValueError
        For values that make no sense, with their name.
    """

    _make = _firsthit.Shape.box
    low: Vector
    high: Vector

    def __init__(self, low: npt.ArrayLike, high: npt.ArrayLike) -> None:
        self._settle(low=low, high=high)


@dataclass(frozen=True, init=False)
class Cylinder(Shape):
    """A cylinder with both caps, in object space.

    Primitives: 0 the side, 1 the bottom, 2 the top.

    Parameters
    ----------
    bottom, top : (3,) array_like
        The ends of its axis, two different points.
    radius : float
        Its radius, positive.

    Raises
    ------
    ValueError
        For values that make no sense, with their name.
    """

    _make = _firsthit.Shape.cylinder
    bottom: Vector
    top: Vector
    radius: float

    def __init__(self, bottom: npt.ArrayLike, top: npt.ArrayLike, radius: float) -> None:
        self._settle(bottom=bottom, top=top, radius=radius)


@dataclass(frozen=True, init=False)
class Cone(Shape):
    """A cone, or with a ``top_radius`` a truncated cone, with its caps, in object space.

    Primitives: 0 the side, 1 the bottom, 2 the top.

    Parameters
    ----------
    bottom, top : (3,) array_like
        The ends of its axis, two different points.
    radius : float
        The radius at the bottom, zero or positive.
    top_radius : float
        The radius at the top, zero or positive; not both are zero.

    Raises
    ------
    ValueError
        For values that make no sense, with their name.
    """

    _make = _firsthit.Shape.cone
    bottom: Vector
    top: Vector
    radius: float
    top_radius: float

    def __init__(
        self, bottom: npt.ArrayLike, top: npt.ArrayLike, radius: float, top_radius: float = 0.0
    ) -> None:
        self._settle(bottom=bottom, top=top, radius=radius, top_radius=top_radius)
