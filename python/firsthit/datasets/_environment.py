"""The light from all around that a plan asks for, in the words of scene files."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from firsthit._looks.environment import Environment
from firsthit._parts.digest import of_file

from ._paths import inside

if TYPE_CHECKING:
    from pathlib import Path

    from ._document import Table


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
        path = inside(folder, given["file"])
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
