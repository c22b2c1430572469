"""Optical flow and disparity of a plan's frames."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from firsthit._pictures.flow import check_pair, disparity, optical_flow

from ._sensors import CameraSensor

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np
    import numpy.typing as npt

    from firsthit._scene.scene import Scene

    from ._document import Table
    from ._place import Place
    from ._sensors import PictureSensor, PlannedSensor

    Arrays = dict[str, npt.NDArray[np.generic]]


class Motion(NamedTuple):
    """The outputs of the motion of pixels."""

    #: The formats of the flow to the scene's next frame.
    flow: tuple[str, ...] = ()
    #: The left and the right camera of a stereo pair.
    pair: tuple[CameraSensor, CameraSensor] | None = None
    #: The formats of the left camera's disparity.
    disparity: tuple[str, ...] = ()

    def save(
        self,
        folder: Path,
        sensor: PictureSensor,
        scene: Scene,
        places: tuple[Place, Place | None],
        threads: int | None,
    ) -> Arrays:
        """Write what is asked for of a sensor; return it by name, for the digest."""
        here, there = places
        made: Arrays = {}
        if self.flow and there is not None:
            flow = optical_flow(scene, sensor.at(here), scene, sensor.at(there), threads=threads)
            for form in self.flow:
                flow.save(folder / f"{sensor.name}.flow.{form}")
            made[f"{sensor.name}/flow"] = flow.flow
        if self.pair is not None and sensor is self.pair[0]:
            left, right = (one.at(here) for one in self.pair)
            found = disparity(scene, left, right, threads=threads)
            for form in self.disparity:
                found.save(folder / f"{sensor.name}.disparity.{form}")
            made[f"{sensor.name}/disparity"] = found.disparity
        return made


def motion(table: Table, sensors: tuple[PlannedSensor, ...]) -> Motion:
    """Return what a plan's output asks for."""
    flows = tuple(table.texts("flow"))
    if "disparity" not in table:
        return Motion(flows)
    given = table.table("disparity")
    cameras = {one.name: one for one in sensors if isinstance(one, CameraSensor)}
    for side in ("left", "right"):
        if given[side] not in cameras:
            known, got = ", ".join(cameras), given[side]
            raise given.refused(side, f"`{side}` must be one of {known}, got {got!r}")
    left, right = cameras[given["left"]], cameras[given["right"]]
    formats = given.texts("formats", ["png"])
    if not formats:
        raise given.refused("formats", "`formats` must be one format or several, got none")
    with given.blaming():
        check_pair(left.camera, right.camera)
    return Motion(flows, (left, right), tuple(formats))
