"""The scenes of a plan, and what their objects are called in annotations."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from firsthit import _firsthit
from firsthit._parts.scene_store import read
from firsthit.annotations import Keypoints

if TYPE_CHECKING:
    from pathlib import Path

    from firsthit._scene.scene import Scene

    from ._document import Table


class PlannedScene(NamedTuple):
    """A scene of a plan, not yet read."""

    name: str
    path: Path
    classes: dict[str, str | None] | None
    by: Literal["object", "node"]
    keypoints: dict[str | int, Keypoints]
    up: list[float] | None

    def load(self) -> Scene:
        """Read it."""
        return read(self.path, self.up)

    @property
    def annotate_options(self) -> dict[str, Any]:
        """The options of `annotate` for the scene."""
        return {"classes": self.classes, "by": self.by, "keypoints": self.keypoints or None}


def scenes(tables: list[Table], folder: Path) -> tuple[PlannedScene, ...]:
    """Return the scenes of a plan."""
    made: dict[str, PlannedScene] = {}
    for table in tables:
        with table.blaming("file"):
            path = _firsthit.plan_file(folder, table["file"])
        name = table.get("name", table["file"])
        if name in made:
            raise table.refused("name", f"two scenes have the name {name!r}; give them others")
        up, by = table.numbers("up"), table.get("by", "object")
        made[name] = PlannedScene(name, path, _classes(table), by, _keypoints(table), up)
    return tuple(made.values())


def _classes(table: Table) -> dict[str, str | None] | None:
    if "classes" not in table:
        return None
    given = table.table("classes")
    for key, name in given.items():
        if name is True:
            raise given.refused(key, f"`{key}` must be a class, or false for no class, got true")
    if not any(given.values()):
        raise table.refused("classes", "`classes` must name a class, got none")
    return {key: name or None for key, name in given.items()}


def _keypoints(table: Table) -> dict[str | int, Keypoints]:
    made: dict[str | int, Keypoints] = {}
    given = table.table("keypoints")
    for key in given:
        one = given.table(key)
        points, skeleton = one.table("points"), map(tuple, one.get("skeleton", ()))
        options = {"frame": one.get("frame", "object"), "tolerance": one.number("tolerance", 0.0)}
        with one.blaming():
            places = {name: points.numbers(name) for name in points}
            made[key] = Keypoints(places, skeleton=list(skeleton), **options)
    return made
