"""Rays that leave surfaces."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit._base.arrays import vectors
from firsthit._objects.filters import Filters
from firsthit._sensors.sensor import Sensor

from .rays import NO_MAXIMUM, NO_MINIMUM, Rays

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit import _firsthit


class LeavingRays:
    """Rays that start on surfaces and do not meet what they leave, as `Hits.leave` makes them.

    `Scene.shoot` and its like take them in place of origins and directions. Their shape is written
    (...) below. They know the objects by their identifiers: use them only with the scene that was
    shot, before it changes.
    """

    def __init__(self) -> None:
        raise TypeError("LeavingRays are made by Hits.leave")

    _rays: Rays

    @property
    def shape(self) -> tuple[int, ...]:
        """The rays' shape."""
        return self._rays.shape

    @property
    def origin(self) -> npt.NDArray[np.float64]:
        """The starts, in world space, rounded to float64, (..., 3); NaN for a miss."""
        return self._rays.origins()

    @property
    def direction(self) -> npt.NDArray[np.float64]:
        """The directions, in world space, (..., 3) float64."""
        return self._rays.directions()

    def __len__(self) -> int:
        """Return the number of rays along the first axis, as for an array."""
        if not self.shape:
            raise TypeError("one ray has no length")
        return self.shape[0]

    def __bool__(self) -> bool:
        """Return True, also if there are no rays: the length must not decide."""
        return True

    def __repr__(self) -> str:
        return f"LeavingRays(shape={self.shape})"


def leaving(
    positions: npt.NDArray[np.float64], places: _firsthit._Places, directions: npt.ArrayLike
) -> LeavingRays:
    """Return rays from places on surfaces."""
    # Ours, as everything that is not float64 would be.
    ways = np.array(vectors("directions", directions), np.float64)
    try:
        shape = np.broadcast_shapes(positions.shape[:-1], ways.shape[:-1])
    except ValueError:
        raise ValueError(
            f"directions {ways.shape} must broadcast against the hits {positions.shape[:-1]}"
        ) from None
    made = LeavingRays.__new__(LeavingRays)
    arrays = positions, ways, NO_MINIMUM, NO_MAXIMUM
    made._rays = Rays(arrays, shape, filters=Filters(left=places))
    return made


def rays_of(
    origins: Any,
    directions: Any,
    t_min: Any = 0.0,
    t_max: Any = math.inf,
    masks: Any = None,
    cull: Any = None,
    skip: Any = None,
) -> Rays:
    """Check what a user gave: arrays, a camera, or rays that leave surfaces."""
    if isinstance(origins, Sensor):
        if directions is not None:
            raise ValueError("directions must be left out with a camera, which has its own")
        filters = Filters.of(masks, cull, skip)
        rays = Rays.of(*origins.rays(), t_min, t_max, filters=filters, are_own=True)
        if rays.shape != (origins.rows, origins.columns):
            raise ValueError(f"the rays of a camera have no shape {rays.shape}")
        return rays
    if not isinstance(origins, LeavingRays):
        return Rays.of(origins, directions, t_min, t_max, filters=Filters.of(masks, cull, skip))
    if directions is not None:
        raise ValueError("directions must be left out with LeavingRays, which have their own")
    rays = origins._rays
    left = None if rays.filters is None else rays.filters.left
    starts, ways, *_ = rays.arrays
    filters = Filters.of(masks, cull, skip, left)
    return Rays.of(starts, ways, t_min, t_max, filters=filters, are_own=True)
