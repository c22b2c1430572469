"""The look of a plan's pictures: the arguments of `render` that are about colours."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, get_args

from firsthit import _firsthit
from firsthit._base.types import ColorMapName, EdgeKind, LightName, ShaderName, ToneMapName
from firsthit._looks.colors import Colors
from firsthit._looks.edges import Edges
from firsthit._looks.lights import background_native
from firsthit._looks.shading import Shader, shader_of

from ._environment import environment
from ._lidars import LidarSensor
from ._sensors import CameraSensor

if TYPE_CHECKING:
    from pathlib import Path

    from ._sensors import PlannedSensor
    from ._table import Table

#: What is about how PNGs show colours.
_DISPLAY = ("exposure", "tone_map")

#: All keys.
LOOK = (
    *("samples", "background", "environment", "light", "ground", "ambient", "shadows", "shade"),
    *("color_by", "color_map", "color_range", "edges", *_DISPLAY),
)


class Look(NamedTuple):
    """The shading and the display of colours.

    Attributes
    ----------
    said : dict
        What `render` is told, whatever the scene.
    display : dict
        How PNGs show colours, as `Frame.save` is told.
    files : tuple of Path
        The files that were read for it.
    """

    said: dict[str, Any]
    display: dict[str, Any]
    files: tuple[Path, ...]


#: Where no colours are made.
NO_LOOK = Look({}, display={"exposure": None, "tone_map": None}, files=())


def look(
    table: Table,
    channels: list[str],
    pictures: list[str],
    sensors: tuple[PlannedSensor, ...],
    folder: Path,
) -> Look:
    """Return what a table of a plan says of colours.

    Keys that would do nothing for its channels, its pictures and its sensors are refused.
    """
    _refuse_idle(table, channels, pictures, sensors)
    around, files = environment(table, folder)
    made: dict[str, Any] = {
        "samples": table.whole("samples", None, least=1, most=65_536),
        "shade": _shade(table),
        "background": _color(table, "background"),
        "environment": around,
        "light": table.text("light", None, get_args(LightName)),
        "ground": table.flag("ground", None),
        "ambient": _color(table, "ambient"),
        "shadows": table.flag("shadows", None),
        "edges": _edges(table),
        "color_by": _color_by(table),
        "color_map": table.text("color_map", None, get_args(ColorMapName)),
        "color_range": _range(table, "color_range"),
    }
    if around is not None and made["light"] is not None:
        raise table.refused("light", "`environment` and `light` exclude each other")
    with table.blaming():
        if made["background"] is not None:
            background_native(made["background"])
        # Without them the scene says which shader it is.
        if made["shade"] is not None or made["ambient"] is not None:
            settings = {"ambient": made["ambient"], "shadows": made["shadows"]}
            shader_of(made["shade"], settings)
    display = {
        "exposure": table.number("exposure", None),
        "tone_map": table.text("tone_map", None, get_args(ToneMapName)),
    }
    given = {name: value for name, value in made.items() if value is not None}
    return Look(given, display, files)


def _refuse_idle(
    table: Table, channels: list[str], pictures: list[str], sensors: tuple[PlannedSensor, ...]
) -> None:
    with table.blaming("channels"):
        idle = _firsthit.idle(LOOK, channels)
    for key, needed in idle:
        refuse(table, (key,), f"`channels` has no {needed}")
    if "color" not in pictures:
        refuse(table, _DISPLAY, "`pictures` has no color")
    moving = [one.name for one in sensors if not isinstance(one, CameraSensor | LidarSensor)]
    if "edges" in table and moving:
        why = f"sensor {moving[0]!r} moves while it sees, and lines are of cameras that do not"
        raise table.refused("edges", f"`edges` must be left out: {why}")


def refuse(table: Table, keys: tuple[str, ...], why: str) -> None:
    """Refuse keys that would do nothing."""
    for key in keys:
        if key in table:
            raise table.refused(key, f"`{key}` does nothing here: {why}")


def _shade(table: Table) -> ShaderName | Shader | None:
    if not table.is_table("shade"):
        named: ShaderName | None = table.text("shade", None, get_args(ShaderName))
        return named
    given = table.table("shade")
    name = given.text("name", among=get_args(ShaderName))
    settings = {}
    for setting, domain in _firsthit.shader_settings(name):
        if setting not in given:
            continue
        if domain == "flag":
            settings[setting] = given.flag(setting)
        elif domain == "number":
            settings[setting] = given.number(setting)
        else:
            settings[setting] = _color(given, setting)
    given.finish()
    with given.blaming():
        return Shader(name, **settings)


def _color_by(table: Table) -> Colors | None:
    if not table.is_table("color_by"):
        if "color_by" not in table:
            return None
        given = _by(table, "color_by")
        with table.blaming("color_by"):
            return Colors(given)
    settings = table.table("color_by")
    by, ends = _by(settings, "by"), _range(settings, "range")
    colors = {name: _color(settings, name) for name in ("below", "above", "missing")}
    name = settings.text("map", "viridis", get_args(ColorMapName))
    settings.finish()
    with settings.blaming():
        return Colors(by, map=name, range=ends, **colors)


def _by(table: Table, key: str) -> Any:
    return table.text(key) if table.is_text(key) else table.numbers(key, shape=(None,))


def _range(table: Table, key: str) -> tuple[float, float] | None:
    ends = table.numbers(key, None, shape=(2,))
    if ends is not None and not ends[0] < ends[1]:
        raise table.refused(key, f"`{key}` must be two numbers that rise, got {ends}")
    return None if ends is None else (ends[0], ends[1])


def _edges(table: Table) -> Edges | None:
    if not table.is_table("edges"):
        width = table.number("edges", None)
        with table.blaming("edges"):
            return Edges._of(width)
    given = table.table("edges")
    settings = {"width": given.number("width", None), "angle": given.number("angle", None)}
    settings |= {"kinds": given.texts("kinds", None, get_args(EdgeKind))}
    settings |= {"color": _color(given, "color")}
    if given.is_flag("hidden"):
        settings["hidden"] = given.flag("hidden")
    else:
        settings["hidden"] = given.numbers("hidden", None, shape=(2,))
    given.finish()
    with given.blaming():
        return Edges(**{name: value for name, value in settings.items() if value is not None})


def _color(table: Table, key: str) -> Any:
    return table.text(key, None) if table.is_text(key) else table.numbers(key, None)
