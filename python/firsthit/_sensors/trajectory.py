"""Poses over time."""

from __future__ import annotations

import copyreg
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import cast, numbers, one_of, text, vectors
from firsthit.typing import BodyName, Extrapolation, Interpolation, TrajectoryFormat

if TYPE_CHECKING:
    import os

    import numpy.typing as npt


class Trajectory:
    """The poses of a moving body, also between the times at which they are given. Immutable.

    At the time of a pose it is that pose, bit for bit. The same trajectory and time give the same
    bits on every machine.

    Parameters
    ----------
    times : (n,) array_like
        Seconds, strictly increasing.
    positions : (n, 3) array_like
        Where the body's origin is in the world, in scene units.
    rotations : (n, 4) or (n, 3, 3) array_like, optional
        How the body's axes are turned in the world: quaternions (x, y, z, w) of length one, within
        0.001, or matrices, which take its coordinates to the world's. Not turned if left out.
    interpolation : {"linear", "spline", "se3"}
        The way between two poses. ``linear``: straight lines, and rotations by slerp. ``spline``:
        natural cubic splines, whose velocity is continuous. ``se3``: screw motions, as of a body
        that turns and drives at constant rates.
    extrapolation : {"refuse", "hold"}
        The answer before the first and after the last pose: an error, or that pose.
    body : {"right-up-backwards", "right-down-forwards", "forwards-left-up"}
        Which ways the body's x, y and z point: those of this package's, OpenGL's and Blender's
        cameras; those of OpenCV's, COLMAP's, TUM's and KITTI's cameras; those of ROS (REP 103).

    Raises
    ------
    ValueError
        For numbers that are not finite, times that do not increase, what is no rotation, arrays of
        other shapes, and other words.

    Examples
    --------
    >>> drive = fh.Trajectory([0, 2], [(0, 0, 1), (4, 0, 1)], body="forwards-left-up")
    >>> drive.at(0.5)
    array([[1., 0., 0., 1.],
           [0., 1., 0., 0.],
           [0., 0., 1., 1.],
           [0., 0., 0., 1.]])
    """

    _native: _firsthit.Trajectory
    _body: BodyName

    def __init__(
        self,
        times: npt.ArrayLike,
        positions: npt.ArrayLike,
        rotations: npt.ArrayLike | None = None,
        *,
        interpolation: Interpolation = "linear",
        extrapolation: Extrapolation = "refuse",
        body: BodyName = "right-up-backwards",
    ) -> None:
        at, places = numbers("times", times), vectors("positions", positions)
        if at.ndim != 1 or places.shape != (len(at), 3):
            raise ValueError(
                f"times and positions must have the shapes (n,) and (n, 3), got {at.shape} and "
                f"{places.shape}"
            )
        turns = np.tile((0.0, 0.0, 0.0, 1.0), (len(at), 1))
        if rotations is not None:
            turns = numbers("rotations", rotations)
            if turns.shape == (len(at), 3, 3):
                matrices = np.concatenate([turns, np.zeros((len(at), 3, 1))], axis=2)
                turns = _firsthit.Trajectory.rotations(_flat(matrices)).reshape(-1, 4)
            if turns.shape != (len(at), 4):
                raise ValueError(
                    f"rotations must have the shape (n, 4) or (n, 3, 3), got {turns.shape}"
                )
        self._body = one_of("body", body, get_args(BodyName))
        self._native = _firsthit.Trajectory(
            _flat(at),
            _flat(places),
            _flat(turns),
            text("interpolation", interpolation),
            text("extrapolation", extrapolation),
        )

    @classmethod
    def _of(cls, native: _firsthit.Trajectory, body: BodyName) -> Trajectory:
        made = cls.__new__(cls)
        made._native, made._body = native, body
        return made

    @classmethod
    def from_matrices(
        cls,
        times: npt.ArrayLike,
        matrices: npt.ArrayLike,
        *,
        interpolation: Interpolation = "linear",
        extrapolation: Extrapolation = "refuse",
        body: BodyName = "right-up-backwards",
    ) -> Trajectory:
        """Make a trajectory from matrices.

        Parameters
        ----------
        times : (n,) array_like
            Seconds, strictly increasing.
        matrices : (n, 4, 4) or (n, 3, 4) array_like
            They take the body's coordinates to the world's: rotations and translations, within
            0.0001, of which the nearest are taken.
        interpolation, extrapolation, body
            As for `Trajectory`.

        Returns
        -------
        Trajectory
            Through these poses.

        Raises
        ------
        ValueError
            For what is no rigid motion, with its index, and as `Trajectory`.
        """
        given = numbers("matrices", matrices)
        if given.ndim != 3 or given.shape[1:] not in ((4, 4), (3, 4)):
            raise ValueError(
                f"matrices must have the shape (n, 4, 4) or (n, 3, 4), got {given.shape}"
            )
        turns = _firsthit.Trajectory.rotations(_flat(given[:, :3])).reshape(-1, 4)
        return cls(
            times,
            given[:, :3, 3],
            turns,
            interpolation=interpolation,
            extrapolation=extrapolation,
            body=body,
        )

    @classmethod
    def load(
        cls,
        path: str | os.PathLike[str],
        format: TrajectoryFormat = "csv",  # noqa: A002 - as files have it
        *,
        body: BodyName,
        times: str | os.PathLike[str] | None = None,
        interpolation: Interpolation = "linear",
        extrapolation: Extrapolation = "refuse",
    ) -> Trajectory:
        """Read a trajectory from a text file.

        Parameters
        ----------
        path : path-like
            A regular file of at most 1 GiB.
        format : {"csv", "tum", "kitti", "ros"}
            ``csv``: columns ``time,x,y,z,qx,qy,qz,qw``, by their names; times may be in ``time_ms``
            and so on. ``tum``: ``timestamp tx ty tz qx qy qz qw``. ``kitti``: rows of a 3 x 4
            matrix, at ten poses a second unless ``times`` are given. ``ros``: a topic as
            ``rostopic echo -p`` prints it. An extension does not tell them apart.
        body : str
            Which ways the axes of the body in the file point, as for `Trajectory`: it is never
            guessed. TUM's and KITTI's are ``"right-down-forwards"``.
        times : path-like, optional
            KITTI's ``times.txt``.
        interpolation, extrapolation
            As for `Trajectory`.

        Returns
        -------
        Trajectory
            With the file's poses.

        Raises
        ------
        FileReadError
            If the system refuses to read it; also an `OSError`.
        FileFormatError
            If the content is wrong, with its line; also a `ValueError`.
        ValueError
            For other words, and ``times`` with another format.
        """
        native = _firsthit.Trajectory.read(
            Path(path),
            text("format", format),
            None if times is None else Path(times),
            text("interpolation", interpolation),
            text("extrapolation", extrapolation),
        )
        return cls._of(native, one_of("body", body, get_args(BodyName)))

    def save(
        self,
        path: str | os.PathLike[str],
        format: TrajectoryFormat = "csv",  # noqa: A002 - as files have it
    ) -> None:
        """Write the poses to a text file, whole or not at all; `load` reads the same bits.

        Parameters
        ----------
        path : path-like
            The file.
        format : {"csv", "tum"}
            As for `load`.

        Raises
        ------
        ValueError
            For another format.
        FileWriteError
            If the system refuses to write it; also an `OSError`.
        """
        self._native.write(Path(path), text("format", format))

    def at(self, times: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """Say where the body is.

        Parameters
        ----------
        times : (...) array_like
            Seconds.

        Returns
        -------
        (..., 4, 4) array of float64
            The matrices that take the body's coordinates to the world's.

        Raises
        ------
        ValueError
            For times that are no numbers, and for those beyond the poses unless ``extrapolation``
            is ``hold``.
        """
        given = numbers("times", times)
        return self._native.at(_flat(given)).reshape(*given.shape, 4, 4)

    def in_axes(self, body: BodyName) -> Trajectory:
        """Return the same motion with other axes of the body.

        Parameters
        ----------
        body : str
            Which ways they are to point, as for `Trajectory`.

        Returns
        -------
        Trajectory
            The body's origin stays.

        Raises
        ------
        ValueError
            For other words.

        Examples
        --------
        >>> camera = fh.Trajectory([0], [(0, 0, 0)], body="right-down-forwards")
        >>> camera.in_axes("forwards-left-up").at(0)[:3, 0]  # Forwards, in the world.
        array([0., 0., 1.])
        """
        wanted = one_of("body", body, get_args(BodyName))
        return self._of(self._native.in_axes(self._body, wanted), wanted)

    @property
    def times(self) -> npt.NDArray[np.float64]:
        """The times of the poses in seconds, (n,) float64: a copy."""
        return self._native.parts()[0]

    @property
    def positions(self) -> npt.NDArray[np.float64]:
        """The positions at those times, (n, 3) float64: a copy."""
        return self._native.parts()[1].reshape(-1, 3)

    @property
    def rotations(self) -> npt.NDArray[np.float64]:
        """The rotations, quaternions (x, y, z, w), (n, 4) float64: a copy."""
        return self._native.parts()[2].reshape(-1, 4)

    @property
    def start(self) -> float:
        """The time of the first pose."""
        return float(self.times[0])

    @property
    def end(self) -> float:
        """The time of the last pose."""
        return float(self.times[-1])

    @property
    def interpolation(self) -> Interpolation:
        """The interpolation between poses."""
        return self._native.parts()[3][0]

    @property
    def extrapolation(self) -> Extrapolation:
        """The extrapolation beyond the poses."""
        return self._native.parts()[3][1]

    @property
    def body(self) -> BodyName:
        """The directions of the body's axes."""
        return self._body

    def __len__(self) -> int:
        """Return the number of poses."""
        return len(self.times)

    def __repr__(self) -> str:
        return (
            f"Trajectory({len(self)} poses from {self.start:g} to {self.end:g} s, "
            f"{self.interpolation}, {self._body})"
        )


def _reduced(native: _firsthit.Trajectory) -> tuple[Any, ...]:
    times, positions, rotations, words = native.parts()
    return _firsthit.Trajectory, (times, positions, rotations, *words)


copyreg.pickle(_firsthit.Trajectory, _reduced)


def _flat(array: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    return cast(array, np.float64).reshape(-1)


def checked(value: object) -> Trajectory:
    """Refuse what is no trajectory."""
    if not isinstance(value, Trajectory):
        raise TypeError(f"trajectory must be a Trajectory, got {value!r}")
    return value
