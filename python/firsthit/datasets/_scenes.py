"""The scenes of a plan, and what their objects are called in annotations."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from firsthit._parts.scene_store import read
from firsthit.annotations import Keypoints

from ._paths import inside

if TYPE_CHECKING:
    from pathlib import Path

    from firsthit._scene.scene import Scene

    from ._table import Table


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
            path = inside(folder, table.text("file"))
        name = table.text("name", table.text("file"))
        if name in made:
            raise table.refused("name", f"two scenes have the name {name!r}; give them others")
        by = table.text("by", "object", ("object", "node"))
        made[name] = PlannedScene(name, path, _classes(table), by, _keypoints(table), _up(table))
        table.finish()
    return tuple(made.values())


def _up(table: Table) -> list[float] | None:
    """Return which way is up, where the plan says it."""
    given: list[float] | None = table.numbers("up", None)
    if given is not None and not any(given):
        raise table.refused("up", "`up` must not be zero")
    return given


def _classes(table: Table) -> dict[str, str | None] | None:
    given = table.table("classes", None)
    if given is None:
        return None
    made: dict[str, str | None] = {}
    for key in given.keys():  # noqa: SIM118 - a Table is no mapping
        name = None if given.is_false(key) else given.text(key)
        if name == "":
            raise given.refused(key, "a class must have a name; false is for no class")
        made[key] = name
    if not any(made.values()):
        raise table.refused("classes", "`classes` must name a class, got none")
    return made


def _keypoints(table: Table) -> dict[str | int, Keypoints]:
    given, made = table.table("keypoints", None), {}
    for key in [] if given is None else given.keys():
        one = given.table(key)
        listed = one.table("points")
        points = {name: listed.numbers(name) for name in listed.keys()}  # noqa: SIM118
        frame = one.text("frame", "object", ("object", "world"))
        tolerance = one.number("tolerance", 0.0, least=0.0)
        skeleton = one.pairs("skeleton")
        with one.blaming():
            made[key] = Keypoints(points, frame=frame, skeleton=skeleton, tolerance=tolerance)
        one.finish()
    return made
