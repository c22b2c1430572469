"""Laser scanners."""

from __future__ import annotations

import math
from inspect import signature
from typing import TYPE_CHECKING

import numpy as np

from firsthit._base.arrays import cast, numbers
from firsthit._base.errors import name_methods
from firsthit._base.log import timed
from firsthit._sensors.conventions import rigid

from .patterns import PatternSensor, placed, rings_of
from .scan import scanned, settings_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy.typing as npt

    from firsthit._scene.scene import Scene
    from firsthit._sensors.trajectory import Trajectory
    from firsthit.typing import ObjectKey, Progress, Returns, Rings

    from .lidar_scan import LidarScan


class Lidar(PatternSensor):
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
        lasers = np.empty(0, np.int32) if rings is None else rings_of("rings", rings)
        for name, array in zip((*given, "rings"), (*arrays, lasers), strict=True):
            if array.ndim != 1:
                raise ValueError(f"{name} must have the shape (n,), got {array.shape}")
        self._take(("table", (*arrays, lasers)), placed(position, pose, trajectory), trajectory)

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
        lidar = Lidar.__new__(Lidar)
        there = (rigid(pose) @ np.array(self._pose)).tolist()
        lidar._take(self._made, there, None, self._pattern)
        return lidar

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
            Ranges are beyond ``min_range`` and up to ``max_range``, in scene units. A nearer
            surface blocks its line, whatever ``returns`` says: the scanner sees neither that nor
            what is behind.
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


name_methods(Lidar, PatternSensor)
