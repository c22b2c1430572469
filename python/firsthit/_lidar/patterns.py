"""The patterns in which laser scanners send their beams, and where scanners stand."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import cast, count, flag, number, numbers, one_of, text, vector
from firsthit._sensors.conventions import pose4
from firsthit._sensors.sensor import OtherSensor
from firsthit._sensors.trajectory import checked

if TYPE_CHECKING:
    import os
    from typing import Self

    import numpy.typing as npt

    from firsthit._sensors.trajectory import Trajectory
    from firsthit.typing import Turn


class PatternSensor(OtherSensor):
    """A pattern of beams at a place, and the patterns that there are."""

    #: The function of the native half that makes the pattern, and its arguments.
    _made: tuple[str, tuple[Any, ...]]
    _pattern: _firsthit.Pattern
    _pose: list[list[float]]
    _trajectory: Trajectory | None

    def _take(
        self,
        made: tuple[str, tuple[Any, ...]],
        pose: list[list[float]],
        trajectory: Trajectory | None,
        pattern: _firsthit.Pattern | None = None,
    ) -> None:
        """Become the scanner of a pattern at a place; a pattern that is there is not made anew."""
        how, arguments = made
        if pattern is None:
            pattern = getattr(_firsthit.Pattern, how)(*arguments)
        self._made, self._pattern, self._pose, self._trajectory = made, pattern, pose, trajectory
        body = None if trajectory is None else trajectory._native
        self._native = _firsthit.Sensor.lidar(pattern, pose, body)

    @classmethod
    def _standing(
        cls,
        made: tuple[str, tuple[Any, ...]],
        position: npt.ArrayLike | None,
        pose: npt.ArrayLike | None,
        trajectory: Trajectory | None,
    ) -> Self:
        """Return the scanner of a pattern at a place."""
        lidar = cls.__new__(cls)
        lidar._take(made, placed(position, pose, trajectory), trajectory)
        return lidar

    @classmethod
    def spinning(
        cls,
        elevations: npt.ArrayLike,
        columns: int = 1024,
        *,
        azimuth_start: float = 180.0,
        azimuth_end: float = -180.0,
        direction: Turn = "clockwise",
        rate: float | None = 10.0,
        start: float = 0.0,
        azimuth_offsets: npt.ArrayLike | None = None,
        firing_offsets: npt.ArrayLike | None = None,
        position: npt.ArrayLike | None = None,
        pose: npt.ArrayLike | None = None,
        trajectory: Trajectory | None = None,
    ) -> Self:
        """Make a scanner of lasers above one another on a head that turns.

        Rows of its picture are lasers, the highest first; columns are firings, in the order of
        time. By default the picture is as one sees it: forwards in the middle, left on the left.

        Parameters
        ----------
        elevations : (lasers,) array_like
            Degrees; the number of a laser, its ring, is its place here.
        columns : int
            How often each laser fires.
        azimuth_start, azimuth_end : float
            From where the head turns, and to where, in degrees. Where these are the same
            direction, it turns once around. With a turn of s degrees, column k of n is at
            ``azimuth_start + s k / n``, or minus that: the last is one step before the end.
        direction : {"clockwise", "counterclockwise"}
            Which way it turns, seen from above.
        rate : float, optional
            Turns in a second: column k is at the time ``start + s / 360 / rate * k / n``. With
            ``None`` all columns are at ``start``.
        start : float
            The time of the first column, in seconds.
        azimuth_offsets : (lasers,) array_like, optional
            How far to the left of the column each laser points, in degrees.
        firing_offsets : (lasers,) array_like, optional
            How long after the column each laser fires, in seconds. It points to where the head then
            is.
        position, pose, trajectory
            As for `Lidar`.

        Returns
        -------
        Lidar
            Of the shape (lasers, columns).

        Raises
        ------
        ValueError, TypeError
            As `Lidar`; also for no lasers, elevations beyond 90 degrees and a negative rate.

        Examples
        --------
        >>> lidar = fh.Lidar.spinning([-10, 0, 10], columns=4)
        >>> lidar.ring[:, 0], lidar.azimuth[0], lidar.time[0]
        (array([2, 1, 0], dtype=int32), array([180.,  90.,   0., -90.]),
        array([0.   , 0.025, 0.05 , 0.075]))
        """
        arguments = (
            _list("elevations", elevations),
            count("columns", columns, 1),
            (number("azimuth_start", azimuth_start), number("azimuth_end", azimuth_end)),
            text("direction", direction),
            (0.0 if rate is None else number("rate", rate), number("start", start)),
            (
                _list("azimuth_offsets", azimuth_offsets),
                _list("firing_offsets", firing_offsets),
            ),
        )
        return cls._standing(("spinning", arguments), position, pose, trajectory)

    @classmethod
    def named(
        cls,
        name: str,
        rate: float = 10.0,
        columns: int | None = None,
        *,
        start: float = 0.0,
        position: npt.ArrayLike | None = None,
        pose: npt.ArrayLike | None = None,
        trajectory: Trajectory | None = None,
    ) -> Self:
        """Make a scanner by its maker's name, with the maker's angles and times.

        One turn, clockwise from behind. Angles are nominal: those of one device are in its own
        calibration, and `spinning` takes them. Rings are the maker's numbers of the lasers.

        Parameters
        ----------
        name : str
            ``vlp-16``, ``vlp-16-hi-res``, ``hdl-32e``, ``vlp-32c``, ``os0-32``, ``os0-64``,
            ``os0-128``, and the same with ``os1`` and ``os2``, ``os1-64-gen1``, ``pandar40p`` and
            ``pandar64``, in any case.
        rate : float
            Turns in a second.
        columns : int, optional
            How often each laser fires, evenly over the turn. If left out, a Velodyne or a Pandar
            fires by its clock, so that its last column is up to one firing short of a whole turn,
            and an Ouster 1024 times.
        start : float
            The time of the first firing, in seconds.
        position, pose, trajectory
            As for `Lidar`.

        Returns
        -------
        Lidar
            Of the shape (lasers, columns), the highest laser first.

        Raises
        ------
        ValueError, TypeError
            As `Lidar`; also for an unknown name, and a rate that is not positive.

        Examples
        --------
        >>> fh.Lidar.named("vlp-16")
        Lidar('vlp-16', 16 x 1808 beams)
        """
        across = None if columns is None else count("columns", columns, 1)
        model = one_of("lidar model", text("name", name).lower(), _firsthit.Pattern.models())
        arguments = model, number("rate", rate), across, number("start", start)
        return cls._standing(("named", arguments), position, pose, trajectory)

    @classmethod
    def raster(
        cls,
        horizontal_fov: float,
        vertical_fov: float,
        rows: int,
        columns: int,
        *,
        rate: float | None = 10.0,
        serpentine: bool = False,
        start: float = 0.0,
        position: npt.ArrayLike | None = None,
        pose: npt.ArrayLike | None = None,
        trajectory: Trajectory | None = None,
    ) -> Self:
        """Make a scanner of rows and columns of equal angles ahead, as of a mirror or a flash.

        Row r of M and column c of N have the azimuth ``H (1/2 - (c + 1/2) / N)`` and the elevation
        ``V (1/2 - (r + 1/2) / M)``. Point k of all, row by row from the top, has the time
        ``start + k / (M N) / rate``.

        Parameters
        ----------
        horizontal_fov, vertical_fov : float
            H and V in degrees: up to 360 and 180.
        rows, columns : int
            M and N.
        rate : float, optional
            Pictures in a second; with ``None`` all points are at ``start``.
        serpentine : bool
            Whether every other row is scanned from the right.
        start : float
            The time of the first point, in seconds.
        position, pose, trajectory
            As for `Lidar`.

        Returns
        -------
        Lidar
            Of the shape (rows, columns); a row is a ring.

        Raises
        ------
        ValueError, TypeError
            As `Lidar`; also for fields of view out of range.
        """
        fov = number("horizontal_fov", horizontal_fov), number("vertical_fov", vertical_fov)
        size = count("rows", rows, 1), count("columns", columns, 1)
        time = 0.0 if rate is None else number("rate", rate), number("start", start)
        arguments = fov, size, flag("serpentine", serpentine), time
        return cls._standing(("raster", arguments), position, pose, trajectory)

    @classmethod
    def rosette(
        cls,
        fov: float,
        frequencies: tuple[float, float],
        points: int,
        point_rate: float,
        *,
        share: float = 0.5,
        start: float = 0.0,
        position: npt.ArrayLike | None = None,
        pose: npt.ArrayLike | None = None,
        trajectory: Trajectory | None = None,
    ) -> Self:
        """Make a scanner of two prisms that turn, whose beam draws a rose.

        Point k has the time ``T = start + k / point_rate``. The beam is off forwards by
        ``a (cos 2 pi f1 T, sin 2 pi f1 T) + b (cos 2 pi f2 T, sin 2 pi f2 T)`` degrees to the left
        and upwards, with ``a = fov / 2 * share`` and ``b = fov / 2 * (1 - share)``.

        Parameters
        ----------
        fov : float
            The diameter of the circular field of view in degrees, up to 180.
        frequencies : pair of float
            f1 and f2, turns in a second; of opposite signs they make a rose.
        points : int
            How many points there are.
        point_rate : float
            Points in a second.
        share : float
            The first prism's share of the deflection, from 0 to 1.
        start : float
            The time of the first point, in seconds.
        position, pose, trajectory
            As for `Lidar`.

        Returns
        -------
        Lidar
            Of the shape (1, points).

        Raises
        ------
        ValueError, TypeError
            As `Lidar`; also for numbers out of range.
        """
        arguments = (
            number("fov", fov),
            _pair("frequencies", frequencies),
            number("share", share),
            count("points", points, 1),
            (number("point_rate", point_rate), number("start", start)),
        )
        return cls._standing(("rosette", arguments), position, pose, trajectory)

    @classmethod
    def lissajous(
        cls,
        horizontal_fov: float,
        vertical_fov: float,
        frequencies: tuple[float, float],
        points: int,
        point_rate: float,
        *,
        phase: float = 90.0,
        start: float = 0.0,
        position: npt.ArrayLike | None = None,
        pose: npt.ArrayLike | None = None,
        trajectory: Trajectory | None = None,
    ) -> Self:
        """Make a scanner of a mirror that swings about two axes.

        Point k has the time ``T = start + k / point_rate``, the azimuth ``H / 2 sin(2 pi f1 T)``
        and the elevation ``V / 2 sin(2 pi f2 T + phase)``.

        Parameters
        ----------
        horizontal_fov, vertical_fov : float
            H and V in degrees: up to 360 and 180.
        frequencies : pair of float
            f1 and f2, swings in a second.
        phase : float
            Degrees.
        points, point_rate, start, position, pose, trajectory
            As for `rosette`.

        Returns
        -------
        Lidar
            Of the shape (1, points).

        Raises
        ------
        ValueError, TypeError
            As `rosette`.
        """
        arguments = (
            (number("horizontal_fov", horizontal_fov), number("vertical_fov", vertical_fov)),
            _pair("frequencies", frequencies),
            number("phase", phase),
            count("points", points, 1),
            (number("point_rate", point_rate), number("start", start)),
        )
        return cls._standing(("lissajous", arguments), position, pose, trajectory)

    @classmethod
    def from_csv(
        cls,
        path: str | os.PathLike[str],
        *,
        position: npt.ArrayLike | None = None,
        pose: npt.ArrayLike | None = None,
        trajectory: Trajectory | None = None,
    ) -> Self:
        """Read a table of beams.

        Parameters
        ----------
        path : path-like
            CSV with a header: the columns ``azimuth`` and ``elevation`` in degrees and, where there
            are some, ``time`` in seconds and ``ring``, by their names.
        position, pose, trajectory
            As for `Lidar`.

        Returns
        -------
        Lidar
            Of the shape (1, beams), in the order of the file.

        Raises
        ------
        FileReadError
            If the system refuses to read it; also an `OSError`.
        FileFormatError
            If the content is wrong, with its line; also a `ValueError`.
        ValueError, TypeError
            As `Lidar`.
        """
        azimuths, elevations, _, times, rings = _firsthit.Pattern.read_csv(Path(path)).beams()
        return cls._standing(
            ("table", (azimuths, elevations, times, rings)), position, pose, trajectory
        )

    @property
    def name(self) -> str:
        """The model, or the kind of pattern."""
        return self._pattern.name()

    @property
    def pose(self) -> npt.NDArray[np.float64]:
        """The pose, (4, 4) float64: to the world, or with a trajectory to the body."""
        return np.array(self._pose)

    @property
    def trajectory(self) -> Trajectory | None:
        """The trajectory of the body that carries it."""
        return self._trajectory

    @property
    def azimuth(self) -> npt.NDArray[np.float64]:
        """The azimuth of each beam in degrees, (rows, columns) float64."""
        return self._pattern.beams()[0].reshape(self.shape)

    @property
    def elevation(self) -> npt.NDArray[np.float64]:
        """The elevation of each beam in degrees, (rows, columns) float64."""
        return self._pattern.beams()[1].reshape(self.shape)

    @property
    def direction(self) -> npt.NDArray[np.float64]:
        """The direction of each beam in its own frame, (rows, columns, 3), of length one."""
        return self._pattern.beams()[2].reshape(*self.shape, 3)

    @property
    def time(self) -> npt.NDArray[np.float64]:
        """The time of each beam in seconds, (rows, columns) float64."""
        return self._pattern.beams()[3].reshape(self.shape)

    @property
    def ring(self) -> npt.NDArray[np.int32]:
        """The number of each beam's laser, (rows, columns) int32."""
        return self._pattern.beams()[4].reshape(self.shape)

    def poses(self) -> npt.NDArray[np.float64]:
        """Return the pose of the scanner at the time of each beam.

        Returns
        -------
        (rows, columns, 4, 4) array of float64
            The matrices that take its coordinates to the world's.
        """
        flat = self._native.poses(np.arange(self.rows * self.columns))
        return flat.reshape(*self.shape, 4, 4)


def placed(
    position: npt.ArrayLike | None, pose: npt.ArrayLike | None, trajectory: Trajectory | None
) -> list[list[float]]:
    """Return the matrix of a place that a user gave."""
    body = None if trajectory is None else checked(trajectory).body
    if pose is not None:
        if position is not None:
            raise ValueError("position must be left out with a pose, which has its own")
        return pose4(pose)
    matrix = np.eye(4)
    if body is not None:
        matrix = np.array(_firsthit.axes_from(body, "forwards-left-up"))
    if position is not None:
        matrix[:3, 3] = vector("position", position)
    made: list[list[float]] = matrix.tolist()
    return made


def _list(name: str, given: npt.ArrayLike | None) -> list[float]:
    if given is None:
        return []
    array = numbers(name, given)
    if array.ndim != 1:
        raise ValueError(f"{name} must have the shape (lasers,), got {array.shape}")
    made: list[float] = cast(array, np.float64).tolist()
    return made


def _pair(name: str, given: tuple[float, float]) -> tuple[float, float]:
    array = numbers(name, given)
    if array.shape != (2,):
        raise ValueError(f"{name} must be two numbers, got an array of shape {array.shape}")
    return float(array[0]), float(array[1])


def rings_of(name: str, given: npt.ArrayLike) -> npt.NDArray[np.int32]:
    """Return the numbers of lasers."""
    array = numbers(name, given)
    if array.dtype.kind not in "iu" or (array.size and not 0 <= array.min() <= array.max() < 2**31):
        raise ValueError(f"{name} must be whole numbers from 0 on, below 2^31")
    return array.astype(np.int32)
