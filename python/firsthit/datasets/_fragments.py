"""The parts that one picture's annotations add to the files of all.

A fragment is plain data, which the record of a frame holds. It is made by the functions that write
the formats, from one picture; classes stand in it by their names, since their numbers depend on the
other pictures.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from firsthit.annotations import to_coco
from firsthit.annotations._bop import entries
from firsthit.annotations._files import as_png, class_numbers, meters
from firsthit.annotations._kitti import labels
from firsthit.annotations._yolo import label_lines

if TYPE_CHECKING:
    from pathlib import Path

    from firsthit.annotations import Annotations, Instance

    from ._output import Output


def fragments(
    name: str, picture: Annotations, output: Output, depth_scale: float
) -> dict[str, Any]:
    """Return what a picture adds to each format, and its classes.

    ``name`` is that of the picture's file. ``depth_scale`` is the step of depth pictures in scene
    units, 1 where there are none.
    """
    kinds = output.merged
    numbers = class_numbers({name: picture}, None, 0)
    made: dict[str, Any] = {"classes": [*numbers]}
    if kinds.coco is not None:
        whole = to_coco({name: picture}, **kinds.coco)
        made["coco"] = {key: whole[key] for key in ("images", "categories", "annotations")}
    if kinds.bop is not None:
        made["bop"] = entries(name, picture, 1e3 * meters(kinds.bop["unit"]), depth_scale)
    if kinds.kitti is not None:
        made["kitti"] = labels({name: picture}, **kinds.kitti)[name]
    if kinds.yolo is not None:
        task, masks = kinds.yolo["task"], kinds.yolo["masks"]
        made["yolo"] = label_lines(name, picture, numbers, task, masks)
    return made


def save_masks(folder: Path, sensor: str, picture: Annotations, output: Output) -> None:
    """Write the masks of instances: those that were asked for, and those of BOP.

    ``SENSOR.visible/000.png`` and ``SENSOR.amodal/000.png`` are named by the place of the instance
    among those of the picture.
    """
    kinds = dict.fromkeys(output.masks)
    if output.merged.bop is not None:
        kinds |= dict.fromkeys(("visible", "amodal"))
    for kind in kinds:
        into = folder / f"{sensor}.{kind}"
        into.mkdir()
        for k, instance in enumerate(picture.instances):
            mask = instance.visible if kind == "visible" else instance.amodal
            (into / f"{k:06d}.png").write_bytes(as_png(mask.array))


def instances(picture: Annotations, *, with_boxes: bool) -> list[dict[str, Any]]:
    """Return what is in a picture, in the order of the masks."""
    return [
        {
            "id": one.id,
            "class": one.class_name,
            "name": one.name,
            "object": one.object,
            **(_boxes(one) if with_boxes else {}),
        }
        for one in picture.instances
    ]


def _boxes(one: Instance) -> dict[str, Any]:
    """Return where an instance is in its picture, and how many pixels it has there."""
    return {
        name: {"box": None if mask.box is None else list(mask.box), "pixels": mask.pixels}
        for name, mask in (("visible", one.visible), ("amodal", one.amodal))
    }
