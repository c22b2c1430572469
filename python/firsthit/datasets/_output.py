"""The outputs that a plan asks for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from firsthit import _firsthit
from firsthit._files.channels import DISTANCES, in_path
from firsthit._sensors.project import plane
from firsthit.annotations._files import meters

from ._lidars import LidarSensor
from ._look import LOOK, NO_LOOK, Look, look, refuse
from ._motion import Motion, motion
from ._sensors import CameraSensor

if TYPE_CHECKING:
    from pathlib import Path

    from firsthit.typing import Far

    from ._document import Table
    from ._sensors import PictureSensor, PlannedSensor

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


#: How files hold numbers.
_STORED = ("png_scale", "far", "png_labels", "compress", "exposure", "tone_map")


class Output(NamedTuple):
    """The outputs of each frame, and at the end."""

    #: The channels of pictures.
    channels: tuple[str, ...]
    #: The formats of files with all channels.
    frames: tuple[str, ...]
    #: The channels that have a PNG each.
    pictures: tuple[str, ...]
    #: The step of the numbers in PNGs of distances, in scene units.
    png_scale: float | None
    #: The numbers of PNGs in place of distances beyond the last step.
    far: Far | None
    #: Whether PNGs of identifiers hold their numbers, plus one.
    png_labels: bool
    #: The type of numbers that are computed as float64.
    dtype: str
    #: Whether NPZ files are packed.
    compress: bool
    #: How colours are made and shown.
    look: Look
    #: The formats of scans.
    clouds: tuple[str, ...]
    #: Which masks of instances have a PNG each.
    masks: tuple[str, ...]
    #: The formats of annotations that are put together at the end.
    merged: Merged
    #: The files of how pixels move.
    motion: Motion

    @property
    def annotates(self) -> bool:
        """Whether pictures are annotated."""
        return bool(self.masks) or bool(self.merged.kinds)


def output(table: Table, sensors: tuple[PlannedSensor, ...], folder: Path) -> Output:
    """Return what a table of a plan asks for; files that it names are in a folder or below."""
    lidars = [one for one in sensors if isinstance(one, LidarSensor)]
    of_cameras = (
        "channels",
        "frames",
        "pictures",
        *_STORED,
        "dtype",
        "flow",
        "disparity",
        *LOOK,
    )
    if len(lidars) == len(sensors):
        refuse(table, of_cameras, "no sensor makes pictures")
        moved = Motion()
        channels: list[str] = []
        frames: list[str] = []
        pictures: list[str] = []
        scale, shown = None, NO_LOOK
    else:
        channels, frames, pictures, scale = _pictures(table, sensors)
        files = [("png", name) for name in pictures]
        files += [(form, name) for form in frames for name in channels]
        for key, needed in _firsthit.idle_in_files(_STORED, files):
            refuse(table, (key,), f"there is not {needed}")
        shown = look(table, channels, sensors, folder)
        moved = motion(table, sensors)
    if not lidars:
        refuse(table, ("clouds",), "no sensor is a lidar")
    clouds = table.texts("clouds", ["npz"]) if lidars else []
    if lidars and not clouds:
        raise table.refused("clouds", "`clouds` must be one format or several, got none")
    if not _annotated(sensors):
        why = 'annotations are of sensors with kind = "camera", or with `annotate = true`'
        refuse(table, ("masks", *KINDS), why)
    masks = table.texts("masks")
    joined = merged(table)
    if joined.kinds and not (pictures or frames):
        raise table.refused(None, "annotations need `pictures` or `frames` that they are of")
    _refuse_lenses(table, sensors, joined)
    made = Output(
        tuple(channels),
        tuple(frames),
        tuple(pictures),
        scale,
        table.get("far"),
        table.get("png_labels", False),
        table.get("dtype", "float64"),
        table.get("compress", False),
        shown,
        tuple(clouds),
        tuple(masks),
        joined,
        moved,
    )
    for one in sensors:
        if not (isinstance(one, LidarSensor) or one.annotate is None or made.annotates):
            why = f"`annotate` of sensor {one.name!r} does nothing here: no annotations are written"
            raise table.refused(None, why)
    return made


def _annotated(sensors: tuple[PlannedSensor, ...]) -> list[PictureSensor]:
    """Return the sensors whose pictures are annotated, where any are."""
    pictured = (one for one in sensors if not isinstance(one, LidarSensor))
    return [one for one in pictured if one.is_annotated]


def _refuse_lenses(table: Table, sensors: tuple[PlannedSensor, ...], joined: Merged) -> None:
    """Refuse formats that cannot hold what a camera sees, whatever it is."""
    for kind in ("bop", "kitti"):
        if getattr(joined, kind) is None:
            continue
        for one in _annotated(sensors):
            if not isinstance(one, CameraSensor):
                why = "has one pose for a picture, and this sensor moves while it sees"
            elif one.camera.projection != "perspective":
                why = f"takes perspective cameras, and its projection is {one.camera.projection}"
            elif plane(one.camera) is None:
                why = "needs what is beyond the border, which a tilted viewplane does not tell"
            else:
                continue
            raise table.refused(kind, f"`{kind}` of sensor {one.name!r}: it {why}")


def _pictures(
    table: Table, sensors: tuple[PlannedSensor, ...]
) -> tuple[list[str], list[str], list[str], float | None]:
    pictures, frames = table.texts("pictures"), table.texts("frames", ["npz"])
    channels = table.texts("channels", pictures or ["color"])
    if not frames and not pictures:
        raise table.refused("frames", "`frames` or `pictures` must name something to write")
    if not channels:
        raise table.refused("channels", "`channels` must be one or more, got none")
    for name in pictures:
        if name not in channels:
            raise table.refused("pictures", f"{name!r} is not among `channels`")
    if len({in_path(name) for name in pictures}) < len(pictures):
        raise table.refused("pictures", "two of `pictures` would have the same file")
    unseen = [name for name in channels if name not in pictures]
    if not frames and unseen:
        raise table.refused("channels", f"nothing is written of {unseen[0]!r}: `frames` is empty")
    if "z" in channels:
        for one in sensors:
            if isinstance(one, CameraSensor) and not one.camera.has_aim:
                raise table.refused("channels", f"z: sensor {one.name!r} has no aim")
    if any(name in DISTANCES for name in pictures) and "png_scale" not in table:
        raise table.refused("pictures", "pictures of distances need `png_scale`, their step")
    return channels, frames, pictures, table.number("png_scale")
