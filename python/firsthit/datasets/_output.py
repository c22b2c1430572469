"""The outputs that a plan asks for."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, get_args

from firsthit import _firsthit
from firsthit._base.channel_hints import hint
from firsthit._base.types import Far, IdentifierName
from firsthit._files.channels import DISTANCES, attribute_of, in_path
from firsthit._lidar.lidar_scan import LidarScan
from firsthit._sensors.project import plane

from ._lidars import LidarSensor
from ._look import LOOK, NO_LOOK, Look, look, refuse
from ._motion import Motion, motion
from ._output_formats import KINDS, Merged, merged
from ._sensors import CameraSensor

if TYPE_CHECKING:
    from pathlib import Path

    from ._sensors import PictureSensor, PlannedSensor
    from ._table import Table

#: The formats of a picture's channels, and of a scan's returns.
FRAMES = ("npz", "exr")
CLOUDS = tuple(extension.removeprefix(".") for extension in LidarScan.EXTENSIONS)

#: How files hold numbers.
_STORED = ("far", "png_labels", "dtype", "compress")


class Output(NamedTuple):
    """The outputs of each frame, and at the end.

    Attributes
    ----------
    channels : tuple of str
        The channels of pictures.
    frames : tuple of str
        The formats of files with all channels.
    pictures : tuple of str
        The channels that have a PNG each.
    png_scale : float or None
        The step of the numbers in PNGs of distances, in scene units.
    far : str or None
        What those have in place of distances beyond the last step.
    png_labels : bool
        Whether PNGs of identifiers hold their numbers, plus one.
    dtype : str
        The type of numbers that are computed as float64.
    compress : bool
        Whether NPZ files are packed.
    look : Look
        How colours are made and shown.
    clouds : tuple of str
        The formats of scans.
    masks : tuple of str
        Which masks of instances have a PNG each.
    merged : Merged
        The formats of annotations that are put together at the end.
    motion : Motion
        What is written of how pixels move.
    """

    channels: tuple[str, ...]
    frames: tuple[str, ...]
    pictures: tuple[str, ...]
    png_scale: float | None
    far: Far | None
    png_labels: bool
    dtype: str
    compress: bool
    look: Look
    clouds: tuple[str, ...]
    masks: tuple[str, ...]
    merged: Merged
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
        "png_scale",
        *_STORED,
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
        _refuse_idle(table, frames, pictures)
        shown = look(table, channels, pictures, sensors, folder)
        moved = motion(table, sensors)
    if not lidars:
        refuse(table, ("clouds",), "no sensor is a lidar")
    clouds = table.texts("clouds", ["npz"], CLOUDS) if lidars else []
    if lidars and not clouds:
        raise table.refused("clouds", "`clouds` must be one format or several, got none")
    if not _annotated(sensors):
        why = 'annotations are of sensors with kind = "camera", or with `annotate = true`'
        refuse(table, ("masks", *KINDS), why)
    masks = table.texts("masks", [], ("visible", "amodal"))
    joined = merged(table)
    if joined.kinds and not (pictures or frames):
        raise table.refused(None, "annotations need `pictures` or `frames` that they are of")
    _refuse_lenses(table, sensors, joined)
    made = Output(
        tuple(channels),
        tuple(frames),
        tuple(pictures),
        scale,
        table.text("far", None, get_args(Far)),
        table.flag("png_labels", default=False),
        table.text("dtype", "float64", ("float32", "float64")),
        table.flag("compress", default=False),
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
    table.finish()
    return made


def _refuse_idle(table: Table, frames: list[str], pictures: list[str]) -> None:
    """Refuse keys about how files hold numbers where no file does."""
    if not any(name in DISTANCES for name in pictures):
        refuse(table, ("far",), "`pictures` has no distance (t, range or z)")
    if not any(name in get_args(IdentifierName) for name in pictures):
        refuse(table, ("png_labels",), "`pictures` has no identifier, such as object")
    if "npz" not in frames:
        refuse(table, ("compress",), "`frames` has no npz")


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
    known = [name for name, _ in _firsthit.channel_names()]
    pictures = _channels(table, "pictures", [], known)
    frames = table.texts("frames", ["npz"], FRAMES)
    channels = _channels(table, "channels", pictures or ["color"], known)
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
    needs_scale = any(name in DISTANCES for name in pictures)
    if needs_scale and "png_scale" not in table:
        raise table.refused("pictures", "pictures of distances need `png_scale`, their step")
    if not needs_scale:
        refuse(table, ("png_scale",), "`pictures` has no distance (t, range or z)")
    return channels, frames, pictures, table.number("png_scale", None, above=0.0)


def _channels(table: Table, key: str, default: list[str], known: list[str]) -> list[str]:
    names: list[str] = table.texts(key, default)
    for name in names:
        if name not in known and attribute_of(name) is None:
            there = f"{', '.join(known)}, attribute:NAME"
            meant = hint(name, known)
            raise table.refused(key, f"`{key}` must be among {there}, got {name!r}{meant}")
    return names
