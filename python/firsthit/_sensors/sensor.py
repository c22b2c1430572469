"""Sensors: they make rays."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from firsthit import _firsthit
from firsthit._base.region import check_pixels

if TYPE_CHECKING:
    import numpy.typing as npt


class Sensor:
    """A sensor: it makes a ray for every pixel of a picture.

    It is a `Camera`, a `RaySensor`, a `RollingShutter`, a `Pushbroom` or a `Lidar`. `render` and
    `Scene.shoot` take any of them. ``docs/sensors.md`` compares them.
    """

    _native: _firsthit.Camera | _firsthit.Sensor

    @property
    def rows(self) -> int:
        """Pixels down."""
        raise NotImplementedError

    @property
    def columns(self) -> int:
        """Pixels across."""
        raise NotImplementedError

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, columns)."""
        return self.rows, self.columns

    @property
    def has_aim(self) -> bool:
        """Whether it has an aim, along which ``z`` is measured."""
        return True

    def rays(self) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """Make the rays through the pixels' centres.

        Returns
        -------
        origins, directions : (rows, columns, 3) array of float64
            In world space; directions of length one, but for a `RaySensor`. Row 0 is the top row.
        """
        check_pixels(*self.shape)
        origins, directions = _firsthit.rays_of_rows(self._native, (0, self.rows), 0)
        shape = (self.rows, self.columns, 3)
        return origins.reshape(shape), directions.reshape(shape)


class OtherSensor(Sensor):
    """The base of sensors that are no cameras."""

    _native: _firsthit.Sensor

    @property
    def rows(self) -> int:
        """Pixels down."""
        return self._native.shape()[0]

    @property
    def columns(self) -> int:
        """Pixels across."""
        return self._native.shape()[1]

    @property
    def has_aim(self) -> bool:
        """Whether it has an aim, along which ``z`` is measured."""
        return self._native.has_aim()

    def _times(self) -> npt.NDArray[np.float64]:
        """Return the time of each pixel's ray in seconds, (rows, columns)."""
        times = self._native.times(np.arange(self.rows * self.columns))
        if times is None:
            raise ValueError("this sensor does not know of time")
        return times.reshape(self.shape)
