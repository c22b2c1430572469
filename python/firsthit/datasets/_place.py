"""Places of the rig, and the sources of its poses."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Protocol

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np
    import numpy.typing as npt

    from firsthit._scene.scene import Scene
    from firsthit._sensors.trajectory import Trajectory


class Place(NamedTuple):
    """The pose of the rig, and its time.

    Attributes
    ----------
    pose : (4, 4) array_like
        The matrix that takes the rig's coordinates to the world's.
    time : float
        Seconds; 0 where there is no path.
    trajectory : Trajectory or None
        How the rig moves, its axes forwards, left, up.
    """

    pose: npt.ArrayLike
    time: float = 0.0
    trajectory: Trajectory | None = None


class Poses(Protocol):
    """A source of the rig's poses in the frames of a scene."""

    @property
    def count(self) -> int:
        """The number of poses in each scene."""

    @property
    def files(self) -> tuple[Path, ...]:
        """The files that they were read from."""

    def place(self, seed: int, frame: int, index: int, scene: Scene) -> Place:
        """Return where the rig is.

        ``frame`` counts the frames of all scenes, ``index`` those of one. A ``ValueError`` where
        there is no such place.
        """

    def places(self, scene: Scene, seconds: float) -> tuple[npt.NDArray[np.float64], float]:
        """Return where the origin of the rig may be in the frames of a scene.

        It is never farther from the hull of the points, (n, 3), than the length that is returned.
        Sensors see for some seconds after the time of a frame.
        """
