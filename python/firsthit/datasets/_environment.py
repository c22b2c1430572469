"""The light from all around that a plan asks for, in the words of scene files."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any

from firsthit._looks.environment import Environment
from firsthit._parts.digest import of_file

from ._paths import inside

if TYPE_CHECKING:
    from pathlib import Path

    from ._table import Table

#: What there may be, by the key that says it.
_KINDS = ("file", "color", "above", "horizon", "daylight")


def environment(table: Table, folder: Path) -> tuple[Environment | None, tuple[Path, ...]]:
    """Return what a table of a plan asks for, and the files that were read for it."""
    given = table.table("environment", None)
    if given is None:
        return None, ()
    kinds = [key for key in _KINDS if key in given]
    if len(kinds) != 1:
        wanted = ", ".join(f"`{key}`" for key in _KINDS)
        got = " and ".join(f"`{key}`" for key in kinds) or "none"
        raise given.refused(None, f"there must be one of {wanted}, got {got}")
    (kind,) = kinds
    common: dict[str, Any] = {
        "strength": given.number("strength", 1.0, least=0.0),
        "seen": given.flag("seen", default=True),
    }
    if kind != "color":
        up = given.numbers("up", None)
        common["up"] = None if up is None else tuple(up)
    if kind == "file":
        with given.blaming("file"):
            path = inside(folder, given.text("file"))
        turn = _turn(given)
        given.finish()
        with given.blaming():
            return _read(path, of_file(path), turn, tuple(common.items())), (path,)
    if kind == "daylight":
        made = _daylight(given.table("daylight"), common)
    else:
        made = _of_colors(given, kind, common)
    given.finish()
    return made, ()


@lru_cache(maxsize=2)
def _read(path: Path, sha256: str, turn: Any, common: tuple[tuple[str, Any], ...]) -> Environment:
    """Return that of a file, which is read once by a process: workers get plans again and again."""
    return Environment(path, rotate=turn, **dict(common))


def _turn(table: Table) -> Any:
    """Return degrees, or an axis and degrees."""
    if not table.is_table("rotate"):
        return table.number("rotate", 0.0)
    given = table.table("rotate")
    turn = tuple(given.numbers("axis")), given.number("degrees")
    given.finish()
    return turn


def _of_colors(table: Table, kind: str, common: dict[str, Any]) -> Environment:
    def color(key: str) -> Any:
        return table.text(key) if table.is_text(key) else table.numbers(key)

    if kind == "color":
        light = color("color")
        with table.blaming():
            return Environment.uniform(light, **common)
    if kind == "above":
        above, below = color("above"), color("below")
        with table.blaming():
            return Environment.hemispheres(above, below, **common)
    horizon, zenith = color("horizon"), color("zenith")
    with table.blaming():
        return Environment.gradient(horizon, zenith, **common)


def _daylight(table: Table, common: dict[str, Any]) -> Environment:
    elevation = table.number("elevation")
    angles: dict[str, Any] = {"azimuth": table.number("azimuth", 0.0)}
    angles["turbidity"] = table.number("turbidity", 3.0)
    if "ground" in table:
        is_text = table.is_text("ground")
        angles["ground"] = table.text("ground") if is_text else table.numbers("ground")
    table.finish()
    with table.blaming():
        return Environment.daylight(elevation, **angles, **common)
