"""Poses that a plan gives: along a path, or one by one."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from firsthit import _firsthit
from firsthit._sensors.conventions import rigid
from firsthit._sensors.trajectory import Trajectory

from ._place import Place

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path as FilePath

    import numpy.typing as npt

    from firsthit._scene.scene import Scene
    from firsthit.typing import BodyName

    from ._document import Table
    from ._sensors import PlannedSensor

#: Which ways the rig's axes point.
RIG: BodyName = "forwards-left-up"

_MOST_FRAMES = 10**9


@dataclass(frozen=True, eq=False)
class Path:
    """The rig follows a trajectory."""

    trajectory: Trajectory
    times: tuple[float, ...] | None
    start: float
    step: float
    number: int
    files: tuple[FilePath, ...]

    @property
    def count(self) -> int:
        """The number of poses in each scene."""
        return self.number

    @classmethod
    def read(cls, table: Table, folder: FilePath) -> Path:
        """Return what a table of a plan asks for."""
        trajectory, files = _trajectory(table.table("trajectory"), folder)
        trajectory = trajectory.in_axes(RIG)
        if "times" in table:
            times = tuple(table.numbers("times"))
            with table.blaming("times"):
                trajectory.at(times)
            return cls(trajectory, times, 0.0, 0.0, len(times), files)
        if "rate" not in table and "count" not in table:
            for key in ("start", "end"):
                if key in table:
                    raise table.refused(key, f"`{key}` needs `rate` or `count` beside it")
            times = tuple(trajectory.times.tolist())
            return cls(trajectory, times, 0.0, 0.0, len(times), files)
        start = table.number("start", trajectory.start)
        end = table.number("end", trajectory.end)
        if end < start:
            raise table.refused("end", f"`end` must not be before `start`, got {start} and {end}")
        with table.blaming():
            trajectory.at([start, end])
        if "rate" in table:
            rate = table.number("rate")
            steps = (end - start) * rate
            if not steps < _MOST_FRAMES:
                raise table.refused("rate", f"`rate` makes more than {_MOST_FRAMES} frames")
            # A whole number of steps is one, however its product was rounded.
            number = math.floor(steps * (1.0 + 2.0**-50)) + 1
            return cls(trajectory, None, start, 1.0 / rate, number, files)
        number = table["count"]
        step = (end - start) / (number - 1) if number > 1 else 0.0
        return cls(trajectory, None, start, step, number, files)

    def place(self, seed: int, frame: int, index: int, scene: Scene) -> Place:
        """Return where the rig is in a frame."""
        time = self.time(index)
        return Place(self.trajectory.at(time).tolist(), time, self.trajectory)

    def time(self, index: int) -> float:
        """Return when a frame is."""
        if self.times is not None:
            return self.times[index]
        time = self.start + index * self.step
        if self.trajectory.extrapolation == "refuse":
            # The last one is at the end, however its product was rounded.
            time = min(time, max(self.trajectory.end, self.start))
        return time

    def places(self, scene: Scene, seconds: float) -> tuple[npt.NDArray[np.float64], float]:
        """Return points whose hull holds the way from the first frame to the last one's end."""
        whole = (self.time(0), self.time(self.count - 1)) if self.times is None else self.times
        first, last = min(whole), max(whole) + seconds
        if self.trajectory.extrapolation == "refuse":
            first, last = np.clip([first, last], self.trajectory.start, self.trajectory.end)
        knots = self.trajectory.times
        ends = np.unique([first, *knots[(first < knots) & (knots < last)], last])
        if len(ends) == 1:
            return self.trajectory.at(ends)[:, :3, 3], 0.0
        # Each stretch by four of its places, a third of its time from one to the next.
        shares = np.arange(4) / 3.0
        times = ends[:-1, None] * (1.0 - shares) + ends[1:, None] * shares
        a, b, c, d = np.moveaxis(self.trajectory.at(times)[..., :3, 3], 1, 0)
        if self.trajectory.interpolation == "se3":
            # A third of a screw turns by pi / 3 at most. Its length is then at most pi / 3 times
            # its chord, and no place on it is farther than half of that from one of its ends.
            chords = np.diff(np.stack((a, b, c, d)), axis=0)
            beside = math.pi / 6.0 * float(np.linalg.norm(chords, axis=-1).max())
            return np.concatenate((a, b, c, d)), beside
        # Straight lines and cubics are within their Bezier control points (Farin, "Curves and
        # Surfaces for CAGD", 2002, chapter 5), which these are.
        inner = (-5.0 * a + 18.0 * b - 9.0 * c + 2.0 * d) / 6.0
        outer = (2.0 * a - 9.0 * b + 18.0 * c - 5.0 * d) / 6.0
        return np.concatenate((a, inner, outer, d)), 0.0

    def refuse_beyond(self, table: Table, sensors: Sequence[PlannedSensor]) -> None:
        """Refuse sensors that would see before or after the trajectory, in any frame."""
        if self.trajectory.extrapolation != "refuse":
            return
        whole = (self.time(0), self.time(self.count - 1)) if self.times is None else self.times
        begin, end = self.trajectory.start, self.trajectory.end
        for sensor in sensors:
            if not sensor.needs_path:
                continue
            first, last = sensor.seeing(min(whole))[0], sensor.seeing(max(whole))[1]
            if begin <= first and last <= end:
                continue
            raise table.refused(
                "trajectory",
                f"sensor {sensor.name!r} sees from {first} to {last}, and the trajectory is from "
                f"{begin} to {end}: let the rig stand beyond it with "
                '`extrapolation = "hold"`, or choose the frames\' times within',
            )


def _trajectory(table: Table, folder: FilePath) -> tuple[Trajectory, tuple[FilePath, ...]]:
    names = ("body", "interpolation", "extrapolation")
    how = {name: table[name] for name in names if name in table}
    if "file" in table:
        files = []
        with table.blaming("file"):
            files.append(_firsthit.plan_file(folder, table["file"]))
        form = table.get("format", "csv")
        if "times_file" in table:
            with table.blaming("times_file"):
                files.append(_firsthit.plan_file(folder, table["times_file"]))
        with table.blaming():
            times = files[1] if len(files) > 1 else None
            return Trajectory.load(files[0], form, times=times, **how), tuple(files)
    given = (table.numbers(name) for name in ("times", "positions", "rotations"))
    with table.blaming():
        return Trajectory(*given, **how), ()


@dataclass(frozen=True, eq=False)
class Listed:
    """The rig is where matrices say."""

    matrices: npt.NDArray[np.float64]
    files: tuple[FilePath, ...]

    @property
    def count(self) -> int:
        """The number of poses in each scene."""
        return len(self.matrices)

    @classmethod
    def read(cls, table: Table, folder: FilePath) -> Listed:
        """Return what a table of a plan asks for."""
        body = table["body"]
        files: tuple[FilePath, ...] = ()
        if "file" in table:
            with table.blaming("file"):
                files = (_firsthit.plan_file(folder, table["file"]),)
                given = _array(files[0])
        else:
            given = np.array([rows[:3] for rows in table.numbers("matrices")])
        key = "file" if files else "matrices"
        with table.blaming(key):
            if given.ndim != 3 or given.shape[1:] not in ((4, 4), (3, 4)) or not len(given):
                raise ValueError(f"poses must have the shape (n, 4, 4), got {given.shape}")
            rows = np.array([_in_rig(pose, body, k) for k, pose in enumerate(given)])
        return cls(rows, files)

    def place(self, seed: int, frame: int, index: int, scene: Scene) -> Place:
        """Return where the rig is in a frame."""
        return Place(self.matrices[index].tolist())

    def places(self, scene: Scene, seconds: float) -> tuple[npt.NDArray[np.float64], float]:
        """Return where the matrices have it."""
        places: npt.NDArray[np.float64] = self.matrices[:, :3, 3]
        return places, 0.0


def _array(path: FilePath) -> npt.NDArray[np.float64]:
    try:
        array = np.load(path, allow_pickle=False)
    except (OSError, ValueError, EOFError) as error:
        raise ValueError(f"not an array of NumPy (.npy): {error}") from None
    _firsthit.note_input(path)
    if not isinstance(array, np.ndarray) or array.dtype.kind not in "fiu":
        raise ValueError("must be one array of real numbers (.npy)")
    return array.astype(np.float64)


def _in_rig(pose: npt.NDArray[np.float64], body: BodyName, number: int) -> npt.NDArray[np.float64]:
    """Return a pose of the rig's axes; other axes are a permutation, which does not round."""
    try:
        given = rigid(pose)
    except ValueError as error:
        raise ValueError(f"pose {number}: {error}") from None
    turned = Trajectory.from_matrices([0.0], np.eye(4)[None], body=body).in_axes(RIG).at(0.0)
    return given @ np.round(turned)
