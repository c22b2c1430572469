"""Laser scanners."""

from __future__ import annotations

import math
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import cast, count, flag, number, numbers, text, vector
from firsthit._base.log import timed
from firsthit._sensors.conventions import pose4, rigid
from firsthit._sensors.sensor import OtherSensor
from firsthit._sensors.trajectory import checked

from .scan import scanned, settings_of

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

    import numpy.typing as npt

    from firsthit._scene.scene import Scene
    from firsthit._sensors.trajectory import Trajectory
    from firsthit.typing import ObjectKey, Progress, Returns, Rings, Turn

    from .lidar_scan import LidarScan


class Lidar(OtherSensor):
    """A laser scanner: beams, each at a time of its own, at a place or on a body that moves.

    Its own frame is that of ROS (REP 103): x forwards, y to the left, z upwards. Azimuths are in
    degrees from forwards to the left, counter-clockwise seen from above; elevations in degrees
    upwards from level. All beams start at its origin. Immutable.

    `spinning`, `named`, `raster`, `rosette`, `lissajous` and `from_csv` make scanners; this makes
    one of a table of beams, whose picture has one row. ``docs/sensors.md`` has the formulas, and
    the sources of the models.

    Parameters
    ----------
    azimuths, elevations : (n,) array_like
        Degrees.
    times : (n,) array_like, optional
        Seconds; all 0 if left out.
    rings : (n,) array_like of int, optional
        The numbers of the lasers; all 0 if left out.
    position : (3,) array_like, optional
        Where the scanner is in the world, not turned; the origin if left out.
    pose : (4, 4) or (3, 4) array_like, optional
        Instead of a position: the matrix that takes the scanner's coordinates to the world's. With
        a trajectory, to the body's; the scanner then looks along the body's forwards if it is left
        out.
    trajectory : Trajectory, optional
        How the body moves that carries the scanner. Each beam starts where the scanner is at the
        time of the beam.

    Raises
    ------
    ValueError
        For numbers that are not finite, arrays of other lengths, a matrix that is no rigid motion,
        both a position and a pose, and times that the trajectory refuses.
    TypeError
        For a trajectory of another type.

    Examples
    --------
    >>> scene = fh.Scene()
    >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=5))
    0
    >>> lidar = fh.Lidar([0, 90, 180], [0, 0, 0], position=(1, 0, 0))
    >>> scene.shoot(lidar).range.round(9)
    array([[4.        , 4.89897949, 6.        ]])
    """

    def __init__(
        self,
        azimuths: npt.ArrayLike,
        elevations: npt.ArrayLike,
        times: npt.ArrayLike | None = None,
        rings: npt.ArrayLike | None = None,
        *,
        position: npt.ArrayLike | None = None,
        pose: npt.ArrayLike | None = None,
        trajectory: Trajectory | None = None,
    ) -> None:
        given = {"azimuths": azimuths, "elevations": elevations, "times": times}
        arrays = [
            np.empty(0) if each is None else np.array(cast(numbers(name, each), np.float64))
            for name, each in given.items()
        ]
        lasers = np.empty(0, np.int32) if rings is None else _rings(rings)
        for name, array in zip((*given, "rings"), (*arrays, lasers), strict=True):
            if array.ndim != 1:
                raise ValueError(f"{name} must have the shape (n,), got {array.shape}")
        self._stand(("table", (*arrays, lasers)), position, pose, trajectory)

    #: The function of the native half that makes the pattern, and its arguments.
    _made: tuple[str, tuple[Any, ...]]
    _pattern: _firsthit.Pattern
    _pose: list[list[float]]
    _trajectory: Trajectory | None

    def _stand(
        self,
        made: tuple[str, tuple[Any, ...]],
        position: npt.ArrayLike | None,
        pose: npt.ArrayLike | None,
        trajectory: Trajectory | None,
    ) -> None:
        """Become the scanner of a pattern at a place."""
        how, arguments = made
        self._take(
            made,
            getattr(_firsthit.Pattern, how)(*arguments),
            _placed(position, pose, trajectory),
            trajectory,
        )

    def _take(
        self,
        made: tuple[str, tuple[Any, ...]],
        pattern: _firsthit.Pattern,
        pose: list[list[float]],
        trajectory: Trajectory | None,
    ) -> None:
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
    ) -> Lidar:
        lidar = cls.__new__(cls)
        lidar._stand(made, position, pose, trajectory)
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
    ) -> Lidar:
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
    ) -> Lidar:
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
        model = text("name", name).lower()
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
    ) -> Lidar:
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
    ) -> Lidar:
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
    ) -> Lidar:
        """Make a scanner of a mirror that swings about two axes.

        Point k has the time ``T = start + k / point_rate``, the azimuth ``H / 2 sin(2 pi f1 T)``
        and the elevation ``V / 2 sin(2 pi f2 T + phase)``.

        Parameters
        ----------
        horizontal_fov, vertical_fov : float
            H and V in degrees: up to 360 and 180.
        frequencies : pair of float
            f1 and f2, swings in a second.
        points : int
            How many points there are.
        point_rate : float
            Points in a second.
        phase : float
            Degrees.
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
    ) -> Lidar:
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
        pattern = _firsthit.Pattern.read_csv(Path(path))
        azimuths, elevations, _, times, rings = pattern.beams()
        lidar = cls.__new__(cls)
        made = "table", (azimuths, elevations, times, rings)
        lidar._take(made, pattern, _placed(position, pose, trajectory), trajectory)
        return lidar

    def moved(self, pose: npt.ArrayLike) -> Lidar:
        """Return the same scanner, carried by a body that stands still.

        Parameters
        ----------
        pose : (4, 4) or (3, 4) array_like
            The matrix that takes the coordinates in which this scanner stands to others, such as
            those of the world; a rotation and a translation.

        Returns
        -------
        Lidar
            With the same beams.

        Raises
        ------
        ValueError
            For a matrix that is no rigid motion, and for a scanner that a trajectory moves.
        """
        if self._trajectory is not None:
            raise ValueError("moved is for a Lidar without a trajectory, which says where it is")
        placed = (rigid(pose) @ np.array(self._pose)).tolist()
        lidar = Lidar.__new__(Lidar)
        lidar._take(self._made, self._pattern, placed, None)
        return lidar

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

    def scan(
        self,
        scene: Scene,
        *,
        returns: Returns = "first",
        divergence: float | None = None,
        subrays: int = 16,
        range_gate: float = 0.0,
        max_returns: int | None = None,
        min_range: float = 0.0,
        max_range: float = math.inf,
        intensity: bool = False,
        noise: float | tuple[float, float] | None = None,
        dropout: float | None = None,
        seed: int | None = None,
        rings: Rings = "maker",
        classes: Mapping[ObjectKey, int] | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> LidarScan:
        """Scan a scene: a list of returns.

        A beam is a line, whose returns are what the line crosses: the first as `Scene.shoot` finds
        it; with other ``returns`` all crossings, as if surfaces let some of the light through
        (`Scene.shoot_all`). With a ``divergence`` it is a cone of lines instead, each of which ends
        at its first hit: so a beam at an edge has several returns.

        Parameters
        ----------
        scene : Scene
            The scene.
        returns : {"first", "last", "strongest", "all"}
            Which returns of a beam are kept. The strongest is that with the largest sum of
            luminance times the cosine of incidence over the squared range.
        divergence : float, optional
            The full angle of the cone in radians; a line if left out.
        subrays : int
            How many lines fill a cone, at most 65,536: the first is its middle, the others lie on a
            spiral of equal areas, the same for all beams.
        range_gate : float
            Hits up to this far behind the nearest one of a return belong to that return, whose
            range is their mean: the resolution in scene units of a receiver that cannot tell them
            apart.
        max_returns : int, optional
            With all returns: how many of a beam are told at most, the nearest. Then
            ``number_of_returns`` is no larger.
        min_range, max_range : float
            Ranges are beyond ``min_range`` and up to ``max_range``, in scene units. What is nearer
            blocks its line, whatever ``returns`` says: the scanner sees neither that nor what is
            behind.
        intensity : bool
            Whether each return has an intensity: the mean over the beam's lines of the luminance
            (Rec. 709) of the surface's ``base_color`` times the cosine of incidence. It does not
            fall off with the range, like a calibrated reflectivity.
        noise : float or pair of float, optional
            The standard deviation of a range, in scene units: a, or ``a + b * range``. The noise is
            normal, and along the beam. A return that it takes out of the limits of ranges, or to
            zero or below, is lost, as makers have it: a range of zero is no return.
        dropout : float, optional
            The probability, from 0 to 1, that a return is lost.
        seed : int, optional
            Must be given with ``noise`` or ``dropout``, from 0 on and below 2^63. The random
            numbers of a beam's return are hashes of the seed, the beam and the return's number, so
            they depend on nothing else.
        rings : {"maker", "lowest-first"}
            How ``ring`` counts: the makers' numbers, as `ring` has them; or from 0 for the laser
            whose lowest beam is the lowest, as drivers of ROS for Velodynes count.
        classes : dict of int or str to int, optional
            The classes of objects, by their identifiers or names, from 0 to 255: LAS has 2 for
            ground, 5 for high vegetation, 6 for buildings and so on. The scan then has a
            ``classification``, of 0 for all other objects.
        threads, progress
            As for `Scene.shoot`.

        Returns
        -------
        LidarScan
            The returns, beam by beam in the order of the picture's rows, and each beam's by range.

        Raises
        ------
        ValueError
            For values out of range, noise or dropout without a seed, and a name in ``classes`` that
            no object has.
        IndexError
            For an identifier in ``classes`` that no object has.
        TypeError
            For what is no scene.
        MemoryError
            If the returns do not fit into memory.

        Warns
        -----
        FirsthitWarning
            For cones without a ``range_gate`` whose further returns or intensities are asked for:
            each of their lines is a return of its own.

        Examples
        --------
        >>> scene = fh.Scene()
        >>> scene.add(fh.Box((-4, -3, -1), (4, 3, 2)))
        0
        >>> scan = fh.Lidar.named("vlp-16", columns=360).scan(scene)
        >>> scan
        LidarScan(5760 returns of 16 x 360 beams)
        >>> round(float(scan.range.min()), 3)
        3.0
        """
        given = locals()
        settings = settings_of(**{name: given[name] for name in signature(settings_of).parameters})
        with timed("scanned %d x %d beams", self.rows, self.columns):
            return scanned(self, scene, settings, classes, threads, progress)

    def __repr__(self) -> str:
        moves = "" if self._trajectory is None else f", {self._trajectory!r}"
        return f"Lidar({self.name!r}, {self.rows} x {self.columns} beams{moves})"

    def __reduce__(self) -> tuple[object, tuple[object, ...]]:
        """Pickle by what it was made from."""
        return Lidar._standing, (self._made, None, self._pose, self._trajectory)


def _placed(
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


def _rings(given: npt.ArrayLike) -> npt.NDArray[np.int32]:
    array = numbers("rings", given)
    if array.dtype.kind not in "iu" or (array.size and not 0 <= array.min() <= array.max() < 2**31):
        raise ValueError("rings must be whole numbers from 0 on, below 2^31")
    return array.astype(np.int32)
