"""Plans of data sets: which scenes, seen by which sensors, from where, and what is written."""

from __future__ import annotations

import hashlib
import json
import pathlib
from typing import TYPE_CHECKING, Any, NamedTuple

from ._chance import Inside, Sphere
from ._cost import Cost, cost
from ._document import PlanSource
from ._given import Listed, Path
from ._lidars import LidarSensor
from ._output import output
from ._scenes import scenes
from ._sensors import sensors

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

    from ._document import Table
    from ._output import Output
    from ._place import Poses
    from ._scenes import PlannedScene
    from ._sensors import PlannedSensor


def poses(table: Table, folder: pathlib.Path) -> Poses:
    """Return the poses of a plan."""
    match table["kind"]:
        case "sphere":
            return Sphere.read(table)
        case "inside":
            return Inside.read(table)
        case "path":
            return Path.read(table, folder)
    return Listed.read(table, folder)


class Plan:
    """The content of a data set: checked, not yet made.

    A frame is what all sensors see from one pose of the rig in one scene. Frames are numbered from
    0, the poses of the first scene first. ``docs/datasets.md`` has all keys of a plan.

    `load` and `from_dict` make plans. `dataset` makes the frames.

    Examples
    --------
    >>> scene = fh.Scene()
    >>> ball = scene.add(fh.Sphere(center=(0, 0, 0), radius=1), name="ball")
    >>> scene.save("ball.fhs")
    >>> plan = fh.Plan.from_dict({
    ...     "scenes": [{"file": "ball.fhs"}],
    ...     "sensors": [{"kind": "camera", "rows": 48, "columns": 64}],
    ...     "poses": {"kind": "sphere", "count": 5, "radius": [4, 6], "elevation": [10, 60]},
    ...     "output": {"channels": ["color", "z", "object"]},
    ... })
    >>> plan
    Plan(5 frames: 1 scene, sensor camera)
    """

    def __init__(self) -> None:
        raise TypeError("Plans are made by Plan.load and Plan.from_dict")

    _document: PlanSource
    _scenes: tuple[PlannedScene, ...]
    _sensors: tuple[PlannedSensor, ...]
    _poses: Poses
    _seed: int
    _output: Output
    _digest: str

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Plan:
        """Read a plan from a file.

        Scenes are not read yet, but all other files that the plan names are.

        Parameters
        ----------
        path : path-like
            A TOML file in UTF-8. The files that it names are in its folder or below.

        Returns
        -------
        Plan
            The plan.

        Raises
        ------
        FileReadError
            If the system refuses to read it; also an `OSError`.
        FileFormatError
            For a plan that is not as it must be, with the line; also a `ValueError`.
        """
        return cls._of(PlanSource.load(path))

    @classmethod
    def from_dict(cls, data: Mapping[str, Any], folder: str | os.PathLike[str] = ".") -> Plan:
        """Make a plan from plain data.

        Parameters
        ----------
        data : mapping
            The tables and keys of a plan's file.
        folder : path-like
            Where the files are that it names: there or below.

        Returns
        -------
        Plan
            The plan.

        Raises
        ------
        ValueError
            For a plan that is not as it must be.
        """
        return cls._of(PlanSource.of(data, pathlib.Path(folder)))

    @classmethod
    def _of(cls, document: PlanSource) -> Plan:
        plan, table = cls.__new__(cls), document.table()
        plan._document = document
        plan._scenes = scenes(table.tables("scenes"), document.folder)
        plan._sensors = sensors(table.tables("sensors"), document.folder)
        given = table.table("poses")
        plan._poses, plan._seed = poses(given, document.folder), given.get("seed", 0)
        for one in plan._sensors:
            if one.needs_path and not hasattr(plan._poses, "trajectory"):
                why = f'sensor {one.name!r} moves while it sees: `kind` must be "path"'
                raise given.refused("kind", why)
        if isinstance(plan._poses, Path):
            plan._poses.refuse_beyond(given, plan._sensors)
        plan._output = output(table.table("output"), plan._sensors, document.folder)
        plan._digest = plan._digested(table)
        return plan

    def _digested(self, table: Table) -> str:
        """Return the digest of the plan and of the files that it names, but for scenes.

        Scenes have fingerprints, which also tell of the files that they name.
        """
        said = hashlib.sha256(json.dumps(table, sort_keys=True).encode())
        beams = [one.file for one in self._sensors if isinstance(one, LidarSensor)]
        named = (file for file in beams if file is not None)
        for path in (*self._poses.files, *named, *self._output.look.files):
            said.update(hashlib.sha256(path.read_bytes()).digest())
        return said.hexdigest()

    @property
    def scenes(self) -> tuple[str, ...]:
        """The names of the scenes."""
        return tuple(one.name for one in self._scenes)

    @property
    def sensors(self) -> tuple[str, ...]:
        """The names of the sensors."""
        return tuple(one.name for one in self._sensors)

    @property
    def poses_per_scene(self) -> int:
        """The number of the rig's poses in each scene."""
        return self._poses.count

    @property
    def frames(self) -> int:
        """The number of frames."""
        return len(self._scenes) * self._poses.count

    @property
    def digest(self) -> str:
        """The sha256 of the plan and of the files that it names, without scenes, as text."""
        return self._digest

    def cost(self) -> Cost:
        """Return how many rays and bytes the frames come to, before anything is made.

        Returns
        -------
        Cost
            An estimate.
        """
        return cost(self._sensors, self._output, self.frames)

    def scene_of(self, frame: int) -> Numbered:
        """Return which scene a frame is of, and which of its poses it has."""
        return Numbered(*divmod(frame, self._poses.count))

    def __reduce__(self) -> tuple[object, tuple[object, ...]]:
        """Pickle by what it was made from: the files that it names are read again."""
        return Plan._of, (self._document,)

    def __repr__(self) -> str:
        count = len(self._scenes)
        names = ", ".join(self.sensors)
        return (
            f"Plan({self.frames} frame{'s' * (self.frames != 1)}: {count} "
            f"scene{'s' * (count != 1)}, sensor{'s' * (len(self._sensors) != 1)} {names})"
        )


class Numbered(NamedTuple):
    """A frame's scene and pose."""

    #: The number of the scene.
    scene: int
    #: The number of the pose in this scene.
    pose: int
