"""The poses of the rig: where it is in which frame."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ._chance import Inside, Sphere
from ._given import Listed, Path

if TYPE_CHECKING:
    from pathlib import Path as FilePath

    from ._place import Poses
    from ._table import Table

#: The kinds of poses.
KINDS = ("sphere", "inside", "path", "list")


def poses(table: Table, folder: FilePath) -> tuple[Poses, int]:
    """Return the poses of a plan, and the seed."""
    kind = table.text("kind", among=KINDS)
    seed = table.whole("seed", 0, most=2**63 - 1)
    made: Poses
    if kind == "sphere":
        made = Sphere.read(table)
    elif kind == "inside":
        made = Inside.read(table)
    elif kind == "path":
        made = Path.read(table, folder)
    else:
        made = Listed.read(table, folder)
    table.finish()
    return made, seed
