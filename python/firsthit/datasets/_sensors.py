"""The sensors of a plan: all of them are fixed to one body, the rig."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from firsthit._sensors.moving import Pushbroom, RollingShutter

from ._cameras import camera
from ._lidars import LidarSensor, lidar

if TYPE_CHECKING:
    from pathlib import Path

    from firsthit._sensors.camera import Camera
    from firsthit.typing import Readout

    from ._document import Table
    from ._place import Place

#: Names of sensors are parts of names of files.
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_-]{0,63}")


@dataclass(frozen=True, eq=False)
class _OnRig:
    """A camera on the rig."""

    name: str
    camera: Camera
    annotate: bool | None

    needs_path: ClassVar[bool] = True

    @property
    def is_annotated(self) -> bool:
        """Whether its pictures are, where any are: if the plan says so."""
        return self.annotate is True

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, columns) of its picture."""
        return self.camera.shape


@dataclass(frozen=True, eq=False)
class CameraSensor(_OnRig):
    """A camera on the rig that sees all of its picture at once."""

    needs_path: ClassVar[bool] = False

    @property
    def is_annotated(self) -> bool:
        """Whether its pictures are, where any are: unless the plan says otherwise."""
        return self.annotate is not False

    def seeing(self, time: float) -> tuple[float, float]:
        """Return when it begins and ends to see in a frame of a time."""
        return time, time

    def at(self, place: Place) -> Camera:
        """Return the camera at a place of the rig."""
        return self.camera.moved(place.pose)


@dataclass(frozen=True, eq=False)
class RollingSensor(_OnRig):
    """A camera on the rig whose first line begins at the frame's time."""

    readout: float
    direction: Readout

    def seeing(self, time: float) -> tuple[float, float]:
        """Return the times of the lines that are read out first and last."""
        by_rows = self.direction in ("top_down", "bottom_up")
        count = self.camera.rows if by_rows else self.camera.columns
        first, last = (time + (k + 0.5) / count * self.readout for k in (0, count - 1))
        return first, last

    def at(self, place: Place) -> RollingShutter:
        """Return the camera as it moves from a place on."""
        assert place.trajectory is not None  # the plan has a path
        return RollingShutter(
            self.camera,
            place.trajectory,
            start=place.time,
            readout=self.readout,
            direction=self.direction,
        )


@dataclass(frozen=True, eq=False)
class PushbroomSensor(_OnRig):
    """A camera of one row on the rig, whose first row is seen at the frame's time."""

    lines: int
    line_rate: float

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, columns) of its picture."""
        return self.lines, self.camera.columns

    def seeing(self, time: float) -> tuple[float, float]:
        """Return the times of the first and the last row."""
        return time, time + (self.lines - 1) / self.line_rate

    def at(self, place: Place) -> Pushbroom:
        """Return the camera as it moves from a place on."""
        assert place.trajectory is not None  # the plan has a path
        times = place.time + np.arange(self.lines) / self.line_rate
        return Pushbroom(self.camera, place.trajectory, times)


#: A sensor whose frames are pictures.
PictureSensor = CameraSensor | RollingSensor | PushbroomSensor
PlannedSensor = PictureSensor | LidarSensor


def sensors(tables: list[Table], folder: Path) -> tuple[PlannedSensor, ...]:
    """Return the sensors of a plan."""
    made: dict[str, PlannedSensor] = {}
    for table in tables:
        one = _sensor(table, folder)
        if one.name in made:
            raise table.refused("name", f"two sensors have the name {one.name!r}")
        made[one.name] = one
    return tuple(made.values())


def _sensor(table: Table, folder: Path) -> PlannedSensor:
    kind = table.get("kind", "camera")
    name = table.get("name", kind)
    if not _NAME.fullmatch(name):
        why = f"`name` must be letters, digits, _ and -, up to 64, got {name!r}"
        raise table.refused("name", why)
    if kind == "lidar":
        return lidar(table, name, folder)
    common = name, camera(table), table.get("annotate")
    if kind == "camera":
        return CameraSensor(*common)
    if kind == "rolling_shutter":
        return RollingSensor(*common, table.number("readout"), table.get("direction", "top_down"))
    return PushbroomSensor(*common, table["lines"], table.number("line_rate"))
