"""The job of a folder: which plan its frames are of, of which scenes, by which version."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any

from firsthit import _firsthit
from firsthit._camera import Camera
from firsthit._errors import FileFormatError, FileReadError, FileWriteError
from firsthit._lidar_scan import lacking
from firsthit._render import render
from firsthit.annotations import annotate
from firsthit.annotations._classes import TOLD_OF
from firsthit.annotations._files import write

from ._depth import warn_of_distances
from ._frame import FrameMaker
from ._lidars import LidarSensor
from ._mark import Mark, mark_of
from ._output_formats import KINDS
from ._records import read

if TYPE_CHECKING:
    from pathlib import Path

    from ._plan import Plan
    from ._scenes import Loaded

#: The file in the folder.
JOB = "job.json"

#: Counts up when the same plan makes other frames.
ANSWER = 1


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


def claim(folder: Path, plan: Plan, loaded: Loaded, threads: int | None) -> list[Mark]:
    """Make a folder that of a plan, or find that it is; return the scenes' marks.

    All scenes are read, and checked against the plan, by the first that comes alone. So nothing is
    made before everything is known to fit.

    Raises
    ------
    FileWriteError
        If the folder is another job's, or cannot be written to.
    """
    path = folder / JOB
    known = _known(path)
    if known is None:
        if folder.exists() and not folder.is_dir():
            raise FileWriteError(f"{folder}: a file, not a folder", os.fspath(folder))
        if (folder / "frames").exists():
            why = f"there are frames without a {JOB}, of which nobody knows the plan"
            raise FileWriteError(f"{folder}: {why}; take another folder", os.fspath(folder))
        check_packages(plan)
        marks = [check(plan, k, loaded, threads) for k in range(len(plan.scenes))]
        content = json.dumps(job_of(plan, marks), indent=2) + "\n"
        write(path, content.encode())
        known = _known(path)
        assert known is not None  # it was just written
    marks = [Mark(scene["fingerprint"], scene["setting"]) for scene in known["scenes"]]
    is_alike = len(marks) == len(plan.scenes)
    wanted = job_of(plan, marks) if is_alike else {"plan": plan.digest, "scenes": plan.scenes}
    for key, value in wanted.items():
        if known.get(key) != value:
            why = f"the folder is another job's: its {key} is {known.get(key)}, this one's {value}"
            raise FileWriteError(f"{path}: {why}; take another folder", os.fspath(path))
    return marks


def _known(path: Path) -> dict[str, Any] | None:
    name = os.fspath(path)
    try:
        said = read(path)
        for each in said["scenes"]:
            if not isinstance(each["fingerprint"] + each["setting"], str):
                raise TypeError("a fingerprint is no text")
    except FileNotFoundError:
        return None
    except NotADirectoryError:
        return None
    except OSError as error:
        raise FileReadError(f"{name}: {error.strerror or error}", name) from error
    except (ValueError, KeyError, TypeError) as error:
        raise FileFormatError(f"{name}: no job of firsthit: {error}", name) from None
    return dict(said)


def check_packages(plan: Plan) -> None:
    """Refuse formats whose packages are missing, as the first file of the format would."""
    for form in plan._output.clouds:
        if why := lacking(f".{form}"):
            raise ImportError(why)


def check(plan: Plan, number: int, loaded: Loaded, threads: int | None) -> Mark:
    """Read a scene and try what the plan asks of it; return its mark.

    The sensors are built at the first pose, a pixel of each picture is made, and classes and
    keypoints are looked up. A warning tells of distances that may not fit into PNGs.
    """
    scene, planned = loaded.scene(number), plan._scenes[number]
    first = number * plan.poses_per_scene
    output = plan._output
    try:
        place = FrameMaker(plan, threads).place(first, scene)
        for sensor in plan._sensors:
            made = sensor.at(place)
            if isinstance(sensor, LidarSensor):
                continue
            corner = slice(0, 1), slice(0, 1)
            look = {**output.look, "samples": 1} if "color" in output.channels else {}
            channels: Any = output.channels
            render(scene, made, channels=channels, region=corner, threads=1, **look)
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
    names = {"coco": "coco.json", "bop": "bop", "kitti": "kitti", "yolo": "yolo"}
    return [names[kind] for kind in KINDS if kind in plan._output.merged.kinds]
