"""The job of a folder: which plan its frames are of, of which scenes, by which version."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, cast

from firsthit import _firsthit
from firsthit._base.errors import FileFormatError
from firsthit._base.optional import optional
from firsthit._parts.job import JOB, begin_job, job_in, refuse_other
from firsthit._parts.part import FRAMES
from firsthit._parts.scene_store import Mark, keep, mark_of
from firsthit._pictures.render import render
from firsthit._sensors.camera import Camera
from firsthit.annotations import annotate
from firsthit.annotations._classes import TOLD_OF

from ._depth import warn_of_distances
from ._frame import FrameMaker
from ._lidars import LidarSensor
from ._output import KINDS

if TYPE_CHECKING:
    from pathlib import Path

    from firsthit._scene.scene import Scene
    from firsthit.typing import Vector

    from ._plan import Plan
    from ._scenes import PlannedScene

#: Counts up when the same plan makes other frames.
ANSWER = 2


def job_of(plan: Plan, marks: list[Mark]) -> dict[str, Any]:
    """Return what is in the file."""
    scenes = [
        {"name": name, **mark._asdict()} for name, mark in zip(plan.scenes, marks, strict=True)
    ]
    return {
        "answer": ANSWER,
        "firsthit": _firsthit.version(),
        "plan": plan.digest,
        "frames": plan.frames,
        "sensors": list(plan.sensors),
        "channels": list(plan._output.channels),
        "scenes": scenes,
    }


def claim(run: str, folder: Path, plan: Plan, threads: int | None) -> list[Mark]:
    """Make a folder that of a plan, or find that it is; return the scenes' marks.

    All scenes are read, and checked against the plan, by the first that comes alone. So nothing is
    made before everything is known to fit. A `FileWriteError` if the folder is another job's.
    """
    path = folder / JOB
    known = job_in(folder, FRAMES.folder)
    if known is None:
        check_packages(plan)
        marks = []
        for number, planned in enumerate(plan._scenes):
            scene = planned.load()
            marks.append(check(plan, number, scene, threads))
            keep(run, planned.path, marks[number], scene)
        known = begin_job(path, job_of(plan, marks))
    marks = _marks(path, known)
    is_alike = len(marks) == len(plan.scenes)
    wanted = job_of(plan, marks) if is_alike else {"plan": plan.digest, "scenes": plan.scenes}
    refuse_other(path, known, wanted)
    return marks


def _marks(path: Path, known: dict[str, Any]) -> list[Mark]:
    try:
        marks = [Mark(scene["fingerprint"], scene["setting"]) for scene in known["scenes"]]
        if not all(isinstance(part, str) for mark in marks for part in mark):
            raise TypeError("a fingerprint is no text")
    except (KeyError, TypeError) as error:
        raise FileFormatError._of(path, f"no job of firsthit: {error}") from None
    return marks


def check_packages(plan: Plan) -> None:
    """Refuse formats whose packages are missing, as the first file of the format would."""
    if "parquet" in plan._output.clouds:
        optional("pyarrow.parquet", "a .parquet")


def check(plan: Plan, number: int, scene: Scene, threads: int | None) -> Mark:
    """Try what the plan asks of a scene; return its mark.

    The sensors are built at the first pose, a pixel of each picture is made, and classes and
    keypoints are looked up. A warning tells of distances that may not fit into PNGs.
    """
    planned = plan._scenes[number]
    first = number * plan.poses_per_scene
    output = plan._output
    try:
        place = FrameMaker(plan, threads).place(first, scene)
        for sensor in plan._sensors:
            made = sensor.at(place)
            if isinstance(sensor, LidarSensor):
                continue
            corner = slice(0, 1), slice(0, 1)
            look, channels = output.look.said, cast("Any", output.channels)
            # As many as tell whether a lens has enough.
            few = {"samples": min(look.get("samples", 2), 2)}
            render(scene, made, channels=channels, region=corner, threads=1, **{**look, **few})
        if output.annotates:
            if not scene.objects:
                raise ValueError("it has no objects to annotate")
            eye = Camera((0, 0, 0), (1, 0, 0), (0, 0, 1), 1, 1, 1, 1, 1)
            telling = TOLD_OF.set(f"scene {planned.name!r}: ")
            try:
                annotate(scene, eye, threads=1, **planned.annotate_options)
            finally:
                TOLD_OF.reset(telling)
    except (ValueError, IndexError, TypeError) as error:
        raise ValueError(f"scene {planned.name!r}: {error}") from None
    warn_of_distances(plan, number, scene)
    return mark_of(scene)


def merged_names(plan: Plan) -> list[str]:
    """Return the names, in the folder, of what is put together at the end."""
    names = {"coco": "coco.json", "jsonl": "annotations.jsonl"}
    return [names.get(kind, kind) for kind in KINDS if kind in plan._output.merged.kinds]


class Checked(NamedTuple):
    """The facts that a check found about a scene."""

    mark: Mark
    #: Which way is up in it.
    up: Vector
    #: Who says so, in the words of ``firsthit info``.
    up_source: str


def checked(plan: Plan, threads: int | None) -> list[Checked]:
    """Read all scenes, try what the plan asks of them, and return what is known of each."""
    check_packages(plan)
    found = []
    for number, planned in enumerate(plan._scenes):
        scene = planned.load()
        mark = check(plan, number, scene, threads)
        found.append(Checked(mark, scene.up, _up_source(planned, scene)))
    return found


def _up_source(planned: PlannedScene, scene: Scene) -> str:
    if planned.up is not None:
        return "as the plan says"
    if not scene._up_is_guessed:
        return "as the file says"
    if scene.up == scene._up:
        return "by the format's convention"
    return "guessed from a flat base"
