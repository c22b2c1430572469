"""One frame: what all sensors see from one pose, and its files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit._files.channels import DISTANCES, in_path, stored
from firsthit._parts.digest import canonical, of_arrays
from firsthit._parts.part import name_of
from firsthit._pictures.render import render
from firsthit.annotations import annotate
from firsthit.annotations._classes import TOLD_OF
from firsthit.annotations._files import meters

from ._fragments import fragments, instances, save_masks
from ._lidars import LidarSensor
from ._sampling import POSES, Uniforms

if TYPE_CHECKING:
    from pathlib import Path

    import numpy.typing as npt

    from firsthit._files.frame import Frame
    from firsthit._parts.scene_store import Mark
    from firsthit._scene.scene import Scene
    from firsthit._sensors.camera import Camera
    from firsthit._sensors.moving import Pushbroom, RollingShutter

    from ._output import Output
    from ._place import Place
    from ._plan import Plan
    from ._sensors import PictureSensor

    Arrays = dict[str, npt.NDArray[Any]]


class FrameMaker:
    """Makes a frame of a plan in a folder that is there.

    The files depend on the plan, the scene and the frame's number, and on nothing else.
    """

    def __init__(self, plan: Plan, threads: int | None) -> None:
        self._plan, self._threads = plan, threads

    def place(self, frame: int, scene: Scene) -> Place:
        """Return where the rig is in a frame."""
        plan = self._plan
        return plan._poses.place(plan._seed, frame, plan.scene_of(frame).pose, scene)

    def make(self, folder: Path, frame: int, scene: Scene, mark: Mark) -> dict[str, Any]:
        """Write all files of a frame; return its record."""
        plan = self._plan
        number, place = plan.scene_of(frame), self.place(frame, scene)
        has_next = plan._output.motion.flow and number.pose + 1 < plan.poses_per_scene
        places = place, self.place(frame + 1, scene) if has_next else None
        pose = np.array(place.pose, np.float64)
        arrays: Arrays = {"pose": pose, "time": np.array(place.time)}
        annotations: dict[str, Any] = {}
        for stream, sensor in enumerate(plan._sensors):
            if isinstance(sensor, LidarSensor):
                seed = Uniforms(plan._seed, frame, POSES + 1 + stream).raw() >> 1
                scan = sensor.scan(scene, place, seed, self._threads)
                for form in plan._output.clouds:
                    scan.save(folder / f"{sensor.name}.{form}")
                arrays |= {f"{sensor.name}/{name}": scan[name] for name in scan.keys()}  # noqa: SIM118
                continue
            picture = self._picture(folder, sensor, scene, place)
            arrays |= {f"{sensor.name}/{name}": array for name, array in picture.items()}
            arrays |= plan._output.motion.save(folder, sensor, scene, places, self._threads)
            if sensor.is_annotated and plan._output.annotates:
                made = self._annotated(folder, sensor, frame, scene, sensor.at(place), picture)
                text = np.frombuffer(canonical(made), np.uint8)
                arrays[f"{sensor.name}/annotations"] = text
                annotations[sensor.name] = made
        return {
            "plan": plan.digest,
            "frame": frame,
            "scene": plan.scenes[number.scene],
            "pose_index": number.pose,
            **mark._asdict(),
            "time": place.time,
            "world_from_rig": pose.tolist(),
            "digest": of_arrays(arrays),
            "annotations": annotations,
        }

    def _picture(self, folder: Path, sensor: PictureSensor, scene: Scene, place: Place) -> Frame:
        output = self._plan._output
        made = render(
            scene,
            sensor.at(place),
            channels=output.channels,  # type: ignore[arg-type] # checked by the plan
            threads=self._threads,
            dtype=output.dtype,
            **output.look.said,
        )
        made.display = made.display._but(**output.look.display)
        for form in output.frames:
            made.save(folder / f"{sensor.name}.{form}", compress=output.compress)
        for channel in output.pictures:
            path = folder / picture_name(sensor.name, channel)
            is_distance = channel in DISTANCES
            scale, far = (output.png_scale, output.far) if is_distance else (None, None)
            made._write(path, [channel], stored(scale, far, output.png_labels))
        return made

    def _annotated(
        self,
        folder: Path,
        sensor: PictureSensor,
        frame: int,
        scene: Scene,
        camera: Camera | RollingShutter | Pushbroom,
        picture: Frame,
    ) -> dict[str, Any]:
        plan = self._plan
        output, planned = plan._output, plan._scenes[plan.scene_of(frame).scene]
        # Told by the check of the scene.
        telling = TOLD_OF.set(None)
        try:
            found = annotate(
                scene,
                camera,
                frame=picture if "object" in picture else None,
                threads=self._threads,
                **planned.annotate_options,
            )
        finally:
            TOLD_OF.reset(telling)
        save_masks(folder, sensor.name, found, output)
        made: dict[str, Any] = {}
        if output.merged.has_classes:
            name = file_name(plan, sensor.name, frame)
            made = fragments(name, found, output, depth_scale(output))
        if output.masks or output.merged.jsonl is not None:
            made["instances"] = instances(found, with_boxes=output.merged.jsonl is not None)
        return made


def depth_scale(output: Output) -> float:
    """Return how many millimetres a step of pictures of depth is, for BOP; 1 without these."""
    bop = output.merged.bop
    if bop is None or output.png_scale is None or "z" not in output.pictures:
        return 1.0
    return output.png_scale * 1e3 * meters(bop["unit"])


def picture_name(sensor: str, channel: str) -> str:
    """Return the name of a channel's PNG in a frame's folder."""
    return f"{sensor}.{in_path(channel)}.png"


def file_name(plan: Plan, sensor: str, frame: int) -> str:
    """Return the path of the file that annotations of a picture name.

    It is the picture of colours, or the first that there is, or the file with all channels.
    """
    output = plan._output
    folder = f"frames/{name_of(frame, plan.frames)}"
    if output.pictures:
        channel = "color" if "color" in output.pictures else output.pictures[0]
        return f"{folder}/{picture_name(sensor, channel)}"
    return f"{folder}/{sensor}.{output.frames[0]}"
