"""The formats of annotations, with their options."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from firsthit.annotations._files import meters

if TYPE_CHECKING:
    from ._document import Table

#: The formats: each is a table of the output.
KINDS = ("coco", "bop", "kitti", "yolo", "jsonl")


class Merged(NamedTuple):
    """The formats that a plan asks for, and what their functions are told.

    A format that is not asked for is ``None``.
    """

    coco: dict[str, Any] | None
    bop: dict[str, Any] | None
    kitti: dict[str, Any] | None
    yolo: dict[str, Any] | None
    jsonl: dict[str, Any] | None

    @property
    def kinds(self) -> tuple[str, ...]:
        """The formats that are asked for."""
        return tuple(name for name in KINDS if getattr(self, name) is not None)

    @property
    def has_classes(self) -> bool:
        """Whether one of the formats needs the class of every instance."""
        return any(name != "jsonl" for name in self.kinds)


def merged(table: Table) -> Merged:
    """Return the formats of annotations in a plan's output."""
    readers = {"coco": _coco, "bop": _bop, "kitti": _kitti, "yolo": _yolo, "jsonl": _jsonl}
    made = {name: read(table.table(name)) for name, read in readers.items() if name in table}
    return Merged(**dict.fromkeys(KINDS) | made)


def _coco(table: Table) -> dict[str, Any]:
    return {"masks": table.get("masks", "visible"), "form": table.get("form", "polygon")}


def _bop(table: Table) -> dict[str, Any]:
    return {"unit": _unit(table), "object_ids": table.get("object_ids")}


def _kitti(table: Table) -> dict[str, Any]:
    forward, up = table.get("forward", "+x"), table.get("up", "+z")
    if forward[1] == up[1]:
        raise table.refused(None, f"`forward` and `up` must be different axes, got {forward}, {up}")
    first, second = table.numbers("occlusion", [0.9, 0.5])
    if not 0.0 <= second <= first <= 1.0:
        got = [first, second]
        why = f"`occlusion` must be two shares, the larger one first, got {got}"
        raise table.refused("occlusion", why)
    return {
        "unit": _unit(table),
        "forward": forward,
        "up": up,
        "box": table.get("box", "amodal"),
        "occlusion": (first, second),
        "tilt_degrees": table.number("tilt_degrees", 1e-3),
    }


def _yolo(table: Table) -> dict[str, Any]:
    return {
        "task": table.get("task", "detect"),
        "masks": table.get("masks", "visible"),
        "validation": table.number("validation", 0.0),
    }


def _jsonl(_: Table) -> dict[str, Any]:
    """Return nothing: the lines are the records of frames, which have no options."""
    return {}


def _unit(table: Table) -> Any:
    unit = table["unit"] if isinstance(table["unit"], str) else table.number("unit")
    with table.blaming("unit"):
        meters(unit)
    return unit
