"""Laser scanners as plans have them, in the rig's coordinates."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, get_args

from firsthit._base.types import Returns, Rings, Turn
from firsthit._lidar.lidar import MODELS, Lidar
from firsthit._lidar.scan import ScanSettings

from ._cameras import matrix
from ._paths import inside

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from firsthit._lidar.lidar_scan import LidarScan
    from firsthit._scene.scene import Scene

    from ._place import Place
    from ._table import Table

#: What `kind = "lidar"` takes one of.
_PATTERNS = ("spinning", "raster", "rosette", "lissajous")


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
    moving = table.flag("moving", default=False)
    pose = matrix(table, "pose") if "pose" in table else _at(table)
    if "pose" in table and "position" in table:
        raise table.refused("position", "`position` and `pose` exclude each other")
    ways = [key for key in ("model", "pattern", "file") if key in table]
    if len(ways) != 1:
        raise table.refused(None, "a lidar has one of `model`, `pattern` and `file`")
    file = None
    if ways == ["model"]:
        make = _named(table)
    elif ways == ["file"]:
        with table.blaming("file"):
            file = inside(folder, table.text("file"))
        if moving:
            why = "`moving` is for patterns: a table of beams has times of its own"
            raise table.refused("moving", why)
        make = _table_of(file)
    else:
        kinds = {"spinning": _spinning, "raster": _raster}
        kind = table.text("pattern", among=_PATTERNS)
        make = kinds[kind](table) if kind in kinds else _points(table, kind)
    with table.blaming():
        # What is wrong with it is said before anything is made.
        beams = make(0.0, {"pose": pose}).shape
        Lidar([0.0], [0.0]).moved(pose)
    return LidarSensor(name, make, pose, moving, options, beams, file)


def _at(table: Table) -> list[list[float]]:
    x, y, z = table.numbers("position", [0.0, 0.0, 0.0])
    return [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z], [0.0, 0.0, 0.0, 1.0]]


def _scan_options(table: Table) -> dict[str, Any]:
    """Return what `Lidar.scan` takes, checked."""
    made: dict[str, Any] = {}
    if "returns" in table:
        made["returns"] = table.text("returns", among=get_args(Returns))
    for key in ("divergence", "range_gate", "min_range", "max_range", "dropout"):
        if key in table:
            made[key] = table.number(key)
    for key in ("subrays", "max_returns"):
        if key in table:
            made[key] = table.whole(key, least=1)
    if "rings" in table:
        made["rings"] = table.text("rings", among=get_args(Rings))
    if "classes" in table:
        given = table.table("classes")
        made["classes"] = {name: given.whole(name, least=0, most=255) for name in given.keys()}  # noqa: SIM118
        given.finish()
    if "intensity" in table:
        made["intensity"] = table.flag("intensity")
    if "noise" in table:
        try:
            made["noise"] = table.number("noise")
        except ValueError:
            made["noise"] = tuple(table.numbers("noise", shape=(2,)))
    with table.blaming():
        ScanSettings.of(
            returns=made.get("returns", "first"),
            divergence=made.get("divergence"),
            subrays=made.get("subrays", 16),
            range_gate=made.get("range_gate", 0.0),
            max_returns=made.get("max_returns"),
            limits=(made.get("min_range", 0.0), made.get("max_range", float("inf"))),
            intensity=made.get("intensity", False),
            noise=made.get("noise"),
            dropout=made.get("dropout"),
            seed=0,
        )
    return made


def _named(table: Table) -> Callable[[float, dict[str, Any]], Lidar]:
    model = table.text("model", among=MODELS, in_any_case=True)
    rate = table.number("rate", 10.0, above=0.0)
    columns = table.whole("columns", None, least=1)
    return lambda start, where: Lidar.named(model, rate, columns, start=start, **where)


def _table_of(file: Path) -> Callable[[float, dict[str, Any]], Lidar]:
    beams = Lidar.from_csv(file)
    # Its times are its own.
    return lambda _, where: beams.moved(where["pose"])


def _spinning(table: Table) -> Callable[[float, dict[str, Any]], Lidar]:
    elevations = table.numbers("elevations", shape=(None,))
    options: dict[str, Any] = {
        "columns": table.whole("columns", 1024, least=1),
        "azimuth_start": table.number("azimuth_start", 180.0),
        "azimuth_end": table.number("azimuth_end", -180.0),
        "direction": table.text("direction", "clockwise", get_args(Turn)),
        "rate": table.number("rate", 10.0, above=0.0),
        "azimuth_offsets": table.numbers("azimuth_offsets", None, shape=(None,)),
        "firing_offsets": table.numbers("firing_offsets", None, shape=(None,)),
    }
    return lambda start, where: Lidar.spinning(elevations, **options, start=start, **where)


def _raster(table: Table) -> Callable[[float, dict[str, Any]], Lidar]:
    options = {
        "horizontal_fov": table.number("horizontal_fov"),
        "vertical_fov": table.number("vertical_fov"),
        "rows": table.whole("rows", least=1),
        "columns": table.whole("columns", least=1),
        "rate": table.number("rate", 10.0, above=0.0),
        "serpentine": table.flag("serpentine", default=False),
    }
    return lambda start, where: Lidar.raster(**options, start=start, **where)


def _points(table: Table, kind: str) -> Callable[[float, dict[str, Any]], Lidar]:
    options: dict[str, Any] = {
        "frequencies": tuple(table.numbers("frequencies", shape=(2,))),
        "points": table.whole("points", least=1),
        "point_rate": table.number("point_rate", above=0.0),
    }
    if kind == "rosette":
        options |= {"fov": table.number("fov"), "share": table.number("share", 0.5)}
        return lambda start, where: Lidar.rosette(**options, start=start, **where)
    options |= {
        "horizontal_fov": table.number("horizontal_fov"),
        "vertical_fov": table.number("vertical_fov"),
        "phase": table.number("phase", 90.0),
    }
    return lambda start, where: Lidar.lissajous(**options, start=start, **where)
