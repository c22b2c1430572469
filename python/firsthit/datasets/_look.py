"""The look of a plan's pictures: the arguments of `render` that are about colours."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple, cast

from firsthit import _firsthit
from firsthit._looks.colors import Colors
from firsthit._looks.edges import Edges
from firsthit._looks.environment import Environment
from firsthit._looks.shading import Shader, shader_of
from firsthit._parts.digest import of_file

from ._lidars import LidarSensor
from ._sensors import CameraSensor

if TYPE_CHECKING:
    from pathlib import Path

    from firsthit.typing import ShaderName

    from ._document import Table
    from ._sensors import PlannedSensor


def environment(table: Table, folder: Path) -> tuple[Environment | None, tuple[Path, ...]]:
    """Return what a table of a plan asks for, and the files that were read for it."""
    if "environment" not in table:
        return None, ()
    given = table.table("environment")
    common: dict[str, Any] = {
        "strength": given.number("strength", 1.0),
        "seen": given.get("seen", True),
    }
    day = given.table("daylight")
    if not day.pop("sun", True):
        raise day.refused(None, "the sun of a plan's daylight always shines: leave out `sun`")
    with given.blaming():
        if "color" in given:
            return Environment.uniform(given["color"], **common), ()
        common["up"] = tuple(given.numbers("up")) if "up" in given else None
        if "above" in given:
            return Environment.hemispheres(given["above"], given["below"], **common), ()
        if "horizon" in given:
            return Environment.gradient(given["horizon"], given["zenith"], **common), ()
        if "daylight" in given:
            return Environment.daylight(**day, **common), ()
    with given.blaming("file"):
        path = _firsthit.plan_file(folder, given["file"])
    with given.blaming():
        return _read(path, of_file(path), _turn(given), tuple(common.items())), (path,)


@lru_cache(maxsize=2)
def _read(path: Path, sha256: str, turn: Any, common: tuple[tuple[str, Any], ...]) -> Environment:
    """Return that of a file, which is read once by a process: workers get plans again and again."""
    return Environment(path, rotate=turn, **dict(common))


def _turn(table: Table) -> Any:
    """Return degrees, or an axis and degrees."""
    if not isinstance(table.get("rotate"), dict):
        return table.number("rotate", 0.0)
    given = table.table("rotate")
    if "axis" in given:
        return tuple(given.numbers("axis")), given.number("degrees")
    *axis, w = given.numbers("quaternion")
    if not any(axis):
        return 0.0
    return tuple(axis), math.degrees(2.0 * math.atan2(math.hypot(*axis), w))


#: The keys of what is rendered.
LOOK = (
    *("samples", "background", "environment", "light", "ground", "ambient", "shadows", "shade"),
    *("color_by", "color_map", "color_range", "edges"),
)


class Look(NamedTuple):
    """The shading and the display of colours."""

    #: The arguments of `render`, whatever the scene.
    said: dict[str, Any]
    #: How PNGs show colours, as `Frame.save` is told.
    display: dict[str, Any]
    #: The files that were read for it.
    files: tuple[Path, ...]


#: Where no colours are made.
NO_LOOK = Look({}, display={"exposure": None, "tone_map": None}, files=())


def look(
    table: Table,
    channels: list[str],
    sensors: tuple[PlannedSensor, ...],
    folder: Path,
) -> Look:
    """Return what a table of a plan says of colours.

    Keys that would do nothing for its channels and its sensors are refused.
    """
    _refuse_idle(table, channels, sensors)
    around, files = environment(table, folder)
    names = ("samples", "background", "light", "ground", "ambient", "shadows", "color_map")
    given: dict[str, Any] = {name: table[name] for name in names if name in table}
    if around is not None:
        given["environment"] = around
    if "color_range" in table:
        given["color_range"] = tuple(table.numbers("color_range"))
    with table.blaming():
        if "shade" in table:
            given["shade"] = _shade(table)
        if "color_by" in table:
            given["color_by"] = _color_by(table)
        if "edges" in table:
            given["edges"] = _edges(table)
        # Without them the scene says which shader it is.
        if "shade" in given or "ambient" in given:
            settings = {"ambient": given.get("ambient"), "shadows": given.get("shadows")}
            shader_of(given.get("shade"), settings)
    display = {"exposure": table.number("exposure"), "tone_map": table.get("tone_map")}
    return Look(given, display, files)


def _refuse_idle(table: Table, channels: list[str], sensors: tuple[PlannedSensor, ...]) -> None:
    with table.blaming("channels"):
        idle = _firsthit.idle(LOOK, channels)
    for key, needed in idle:
        refuse(table, (key,), f"`channels` has no {needed}")
    moving = [one.name for one in sensors if not isinstance(one, CameraSensor | LidarSensor)]
    if "edges" in table and moving:
        why = f"sensor {moving[0]!r} moves while it sees, and lines are of cameras that do not"
        raise table.refused("edges", f"`edges` must be left out: {why}")


def refuse(table: Table, keys: tuple[str, ...], why: str) -> None:
    """Refuse keys that would do nothing."""
    for key in keys:
        if key in table:
            raise table.refused(key, f"`{key}` does nothing here: {why}")


def _shade(table: Table) -> ShaderName | Shader:
    shade: Any = table["shade"]
    if isinstance(shade, str):
        return cast("ShaderName", shade)
    settings = dict(shade)
    return Shader(settings.pop("name"), **settings)


def _color_by(table: Table) -> Colors:
    if not isinstance(table["color_by"], dict):
        return Colors(table["color_by"])
    settings = dict(table["color_by"])
    return Colors(settings.pop("by"), **settings)


def _edges(table: Table) -> Edges:
    given = table["edges"]
    return Edges(**given) if isinstance(given, dict) else Edges(float(given))
