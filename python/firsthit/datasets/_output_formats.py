"""The formats of annotations, with their options."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, get_args

from firsthit.annotations._coco import MaskForm, MaskKind
from firsthit.annotations._files import meters
from firsthit.annotations._kitti import Axis
from firsthit.annotations._yolo import Task

if TYPE_CHECKING:
    from ._table import Table

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
    made: dict[str, dict[str, Any] | None] = {}
    for name, read in readers.items():
        given = table.table(name, None)
        made[name] = None if given is None else read(given)
        if given is not None:
            given.finish()
    return Merged(**made)


def _coco(table: Table) -> dict[str, Any]:
    return {
        "masks": table.text("masks", "visible", get_args(MaskKind)),
        "form": table.text("form", "polygon", get_args(MaskForm)),
    }


def _bop(table: Table) -> dict[str, Any]:
    given = table.table("object_ids", None)
    numbers = None if given is None else {key: given.whole(key, least=1) for key in given.keys()}  # noqa: SIM118
    return {"unit": _unit(table), "object_ids": numbers}


def _kitti(table: Table) -> dict[str, Any]:
    forward = table.text("forward", "+x", get_args(Axis))
    up = table.text("up", "+z", get_args(Axis))
    if forward[1] == up[1]:
        raise table.refused(None, f"`forward` and `up` must be different axes, got {forward}, {up}")
    occlusion = table.numbers("occlusion", [0.9, 0.5], shape=(2,))
    if not 0.0 <= occlusion[1] <= occlusion[0] <= 1.0:
        why = f"`occlusion` must be two shares, the larger one first, got {occlusion}"
        raise table.refused("occlusion", why)
    return {
        "unit": _unit(table),
        "forward": forward,
        "up": up,
        "box": table.text("box", "amodal", get_args(MaskKind)),
        "occlusion": (occlusion[0], occlusion[1]),
        "tilt_degrees": table.number("tilt_degrees", 1e-3, least=0.0),
    }


def _yolo(table: Table) -> dict[str, Any]:
    return {
        "task": table.text("task", "detect", get_args(Task)),
        "masks": table.text("masks", "visible", get_args(MaskKind)),
        "validation": table.number("validation", 0.0, least=0.0, most=1.0),
    }


def _jsonl(_: Table) -> dict[str, Any]:
    """Return nothing: the lines are the records of frames, which have no options."""
    return {}


def _unit(table: Table) -> Any:
    unit = table.text("unit") if table.is_text("unit") else table.number("unit", above=0.0)
    with table.blaming("unit"):
        meters(unit)
    return unit
