"""Laser scanners as plans have them, in the rig's coordinates."""

from __future__ import annotations

from inspect import signature
from typing import TYPE_CHECKING, Any, NamedTuple

from firsthit import _firsthit
from firsthit._lidar.lidar import Lidar
from firsthit._lidar.scan import settings_of

from ._cameras import matrix

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from firsthit._lidar.lidar_scan import LidarScan
    from firsthit._scene.scene import Scene

    from ._document import Table
    from ._place import Place


class LidarSensor(NamedTuple):
    """A scanner on the rig."""

    name: str
    #: Makes the scanner whose first beam has a time, on a trajectory or at a pose of the rig.
    make: Callable[[float, dict[str, Any]], Lidar]
    pose: list[list[float]]
    is_moving: bool
    scan_options: dict[str, Any]
    beams: tuple[int, int]
    file: Path | None

    @property
    def needs_path(self) -> bool:
        """Whether it moves while it scans."""
        return self.is_moving

    def seeing(self, time: float) -> tuple[float, float]:
        """Return the times of the first and the last beam in a frame of a time."""
        times = self.make(time, {"pose": self.pose}).time
        return float(times.min()), float(times.max())

    def at(self, place: Place) -> Lidar:
        """Return the scanner at a place of the rig."""
        if self.is_moving:
            moved = {"pose": self.pose, "trajectory": place.trajectory}
            return self.make(place.time, moved)
        return self.make(place.time, {"pose": self.pose}).moved(place.pose)

    def scan(self, scene: Scene, place: Place, seed: int, threads: int | None) -> LidarScan:
        """Scan a scene; the seed is for noise and drop-out, if these are asked for."""
        return self.at(place).scan(scene, **self.scan_options, seed=seed, threads=threads)


def lidar(table: Table, name: str, folder: Path) -> LidarSensor:
    """Return the scanner of a table."""
    options = _scan_options(table)
    pose = matrix(table) if "pose" in table else _at(table)
    file = None
    if "model" in table:
        make = _named(table)
    elif "file" in table:
        with table.blaming("file"):
            file = _firsthit.plan_file(folder, table["file"])
        make = _table_of(file)
    else:
        make = _of_pattern(table)
    with table.blaming():
        # Errors in it are told before anything is made.
        beams = make(0.0, {"pose": pose}).shape
        Lidar([0.0], [0.0]).moved(pose)
    return LidarSensor(name, make, pose, table.get("moving", False), options, beams, file)


def _at(table: Table) -> list[list[float]]:
    x, y, z = table.numbers("position", [0.0, 0.0, 0.0])
    return [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z], [0.0, 0.0, 0.0, 1.0]]


def _scan_options(table: Table) -> dict[str, Any]:
    """Return what `Lidar.scan` takes, checked."""
    known = (*signature(settings_of).parameters, "classes")
    made = {key: table[key] for key in known if key in table}
    with table.blaming():
        given = {name: value for name, value in made.items() if name != "classes"}
        settings_of(**given, seed=0)
    return made


def _named(table: Table) -> Callable[[float, dict[str, Any]], Lidar]:
    model, rate, columns = table["model"], table.number("rate", 10.0), table.get("columns")
    return lambda start, where: Lidar.named(model, rate, columns, start=start, **where)


def _table_of(file: Path) -> Callable[[float, dict[str, Any]], Lidar]:
    beams = Lidar.from_csv(file)
    # Its times are its own.
    return lambda _, where: beams.moved(where["pose"])


def _of_pattern(table: Table) -> Callable[[float, dict[str, Any]], Lidar]:
    """Return the maker of a pattern, whose numbers the plan calls as the function does."""
    make: Callable[..., Lidar] = getattr(Lidar, table["pattern"])
    known = signature(make).parameters.keys() - {"position", "pose"}
    options = {key: table[key] for key in known if key in table}
    return lambda start, where: make(**options, start=start, **where)
