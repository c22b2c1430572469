"""Cameras that move while they see."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import cast, number, numbers, text

from .camera import Camera
from .sensor import OtherSensor
from .trajectory import checked

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit.typing import Readout

    from .trajectory import Trajectory


class _Moving(OtherSensor):
    """A camera on a body that moves."""

    _arguments: tuple[Camera, Trajectory, *tuple[Any, ...]]

    @property
    def camera(self) -> Camera:
        """The camera, in the body's coordinates."""
        return self._arguments[0]

    @property
    def trajectory(self) -> Trajectory:
        """The trajectory of the body."""
        return self._arguments[1]


class RollingShutter(_Moving):
    """A camera whose lines are read out one after the other while it moves. Immutable.

    With n lines (rows, or columns where it is read out sideways), the line that is read out as
    number k, from 0, is seen at the time ``start + (k + 0.5) / n * readout``, all of it at once.
    ``range`` and ``z`` are from where the camera is at that time, along its aim at that time.

    Parameters
    ----------
    camera : Camera
        Its position, aim and up are in the coordinates of the body that moves.
    trajectory : Trajectory
        How the body moves.
    start : float
        When the first line begins, in seconds of the trajectory.
    readout : float
        How long all lines take together, in seconds; 0 for a camera that sees all at once.
    direction : {"top_down", "bottom_up", "left_right", "right_left"}
        Which line is read out first, and which way it goes on.

    Raises
    ------
    ValueError
        For numbers that are not finite, a negative readout, times that the trajectory refuses, and
        another direction.
    TypeError
        For a camera or a trajectory of another type.

    Examples
    --------
    >>> drive = fh.Trajectory([0, 1], [(0, 0, 0), (8, 0, 0)])
    >>> camera = fh.Camera.look_at((0, 0, 0), (0, 0, -1), (0, 1, 0), 60, rows=4, columns=6)
    >>> sensor = fh.RollingShutter(camera, drive, start=0, readout=1)
    >>> sensor.times
    array([0.125, 0.375, 0.625, 0.875])
    >>> sensor.rays()[0][:, 0, 0]
    array([1., 3., 5., 7.])
    """

    _arguments: tuple[Camera, Trajectory, float, float, Readout]

    def __init__(
        self,
        camera: Camera,
        trajectory: Trajectory,
        *,
        start: float,
        readout: float,
        direction: Readout = "top_down",
    ) -> None:
        if not isinstance(camera, Camera):
            raise TypeError(f"camera must be a Camera, got {camera!r}")
        begin, lasting = number("start", start), number("readout", readout)
        way = text("direction", direction)
        self._arguments = camera, checked(trajectory), begin, lasting, way
        self._native = _firsthit.Sensor.rolling_shutter(
            camera._native, trajectory._native, begin, lasting, way
        )

    @property
    def times(self) -> npt.NDArray[np.float64]:
        """The time of each line, (rows,) or of columns (columns,) float64, in seconds."""
        times = self._times()
        return np.ascontiguousarray(times[:, 0] if self.reads_rows else times[0])

    @property
    def direction(self) -> Readout:
        """The order in which the lines are read."""
        return self._arguments[4]

    @property
    def reads_rows(self) -> bool:
        """Whether its lines are rows, not columns."""
        return self.direction in ("top_down", "bottom_up")

    def __repr__(self) -> str:
        _, trajectory, start, readout, direction = self._arguments
        return (
            f"RollingShutter({self.columns} x {self.rows} pixels, start={start}, "
            f"readout={readout}, direction={direction!r}, {trajectory!r})"
        )

    def __reduce__(self) -> tuple[object, tuple[object, ...]]:
        """Pickle by what it was made from."""
        camera, trajectory, start, readout, direction = self._arguments
        how: dict[str, Any] = {"start": start, "readout": readout, "direction": direction}
        return partial(RollingShutter, **how), (camera, trajectory)


class Pushbroom(_Moving):
    """A camera of one row of pixels that moves, and sees a row at each of some times. Immutable.

    It is a line scanner, or the camera of a satellite. Row k of the picture is what the camera sees
    at ``times[k]``, all of it at once. ``range`` and ``z`` are from where it is at that time.

    Parameters
    ----------
    camera : Camera
        A camera of one row. Its position, aim and up are in the coordinates of the body that moves.
    trajectory : Trajectory
        How the body moves.
    times : (rows,) array_like
        Seconds of the trajectory, in any order.

    Raises
    ------
    ValueError
        For a camera of several rows, no times, and those that the trajectory refuses.
    TypeError
        For a camera or a trajectory of another type.

    Examples
    --------
    >>> flight = fh.Trajectory([0, 10], [(0, 0, 500), (0, 700, 500)])
    >>> line = fh.Camera.look_at((0, 0, 0), (0, 0, -1), (0, 1, 0), 1, rows=1, columns=50)
    >>> fh.Pushbroom(line, flight, np.linspace(0, 10, 200)).shape
    (200, 50)
    """

    _arguments: tuple[Camera, Trajectory, npt.NDArray[np.float64]]

    def __init__(self, camera: Camera, trajectory: Trajectory, times: npt.ArrayLike) -> None:
        if not isinstance(camera, Camera):
            raise TypeError(f"camera must be a Camera, got {camera!r}")
        seconds = numbers("times", times)
        if seconds.ndim != 1:
            raise ValueError(f"times must have the shape (rows,), got {seconds.shape}")
        seconds = np.array(cast(seconds, np.float64))
        self._arguments = camera, checked(trajectory), seconds
        self._native = _firsthit.Sensor.pushbroom(camera._native, trajectory._native, seconds)

    @property
    def times(self) -> npt.NDArray[np.float64]:
        """The time of each row, (rows,) float64, in seconds: a copy."""
        return self._arguments[2].copy()

    def __repr__(self) -> str:
        return f"Pushbroom({self.columns} x {self.rows} pixels, {self._arguments[1]!r})"

    def __reduce__(self) -> tuple[object, tuple[object, ...]]:
        """Pickle by what it was made from."""
        return Pushbroom, self._arguments
