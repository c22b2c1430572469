"""Sensors on one body."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit._base.arrays import number, text
from firsthit._lidar.lidar import Lidar
from firsthit._sensors.camera import Camera
from firsthit._sensors.conventions import pose4, rigid
from firsthit._sensors.ray_sensor import RaySensor

if TYPE_CHECKING:
    from collections.abc import ItemsView, Iterator, KeysView, Mapping

    import numpy.typing as npt

    from firsthit._files.frame import Frame
    from firsthit._scene.scene import Scene

    #: A sensor that a rig carries.
    Carried = Camera | Lidar | RaySensor


class Rig:
    """Named sensors that are fixed to one body. Immutable.

    ``rig["left"]`` is a sensor as it stands in the world. `at` moves all of them.

    Parameters
    ----------
    sensors : mapping of str to Camera, Lidar or RaySensor
        Each stands in the body's coordinates, whatever the body's axes are.
    pose : (4, 4) or (3, 4) array_like, optional
        The matrix that takes the body's coordinates to the world's, a rotation and a translation;
        the identity if left out.

    Raises
    ------
    ValueError
        For no sensors, and a matrix that is no rigid motion.
    TypeError
        For sensors of another type, such as those that a trajectory moves.

    Examples
    --------
    >>> eye = fh.Camera.look_at((0, 0, 0), (1, 0, 0), (0, 0, 1), 60, rows=30, columns=40)
    >>> rig = fh.Rig.stereo(eye, baseline=0.12)
    >>> rig["right"].position
    array([ 0.  , -0.12,  0.  ])
    >>> rig.at([[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 1]])["right"].position
    array([ 5.  , -0.12,  1.  ])
    """

    def __init__(self, sensors: Mapping[str, Carried], pose: npt.ArrayLike | None = None) -> None:
        if not hasattr(sensors, "items"):
            raise TypeError(f"sensors must be a dict of sensors, got {sensors!r}")
        self._mounted: dict[str, Carried] = {}
        for name, sensor in sensors.items():
            is_moved = isinstance(sensor, Lidar) and sensor.trajectory is not None
            if not isinstance(sensor, Camera | Lidar | RaySensor) or is_moved:
                raise TypeError(
                    f"sensor {name!r} must be a Camera, a RaySensor, or a Lidar without a "
                    f"trajectory, got {sensor!r}"
                )
            self._mounted[text("a name of sensors", name)] = sensor
        if not self._mounted:
            raise ValueError("sensors must be at least one, got none")
        self._pose: npt.NDArray[np.float64] | None = None if pose is None else rigid(pose)

    @classmethod
    def stereo(cls, camera: Camera, baseline: float, pose: npt.ArrayLike | None = None) -> Rig:
        """Make a pair of cameras that look the same way.

        Parameters
        ----------
        camera : Camera
            The left one, in the body's coordinates.
        baseline : float
            How far to the right of it the right one is, in scene units; positive.
        pose : (4, 4) or (3, 4) array_like, optional
            As for `Rig`.

        Returns
        -------
        Rig
            With the sensors ``left`` and ``right``. A point at the depth z is seen ``baseline * f /
            z`` pixels further to the left by the right one, where f is ``intrinsic_matrix[0, 0]``.

        Raises
        ------
        ValueError
            For a baseline that is not positive and finite.
        TypeError
            For a camera of another type.
        """
        if not isinstance(camera, Camera):
            raise TypeError(f"camera must be a Camera, got {camera!r}")
        apart = number("baseline", baseline)
        if not 0.0 < apart < np.inf:
            raise ValueError(f"baseline must be positive and finite, got {apart}")
        moved = np.eye(4)
        moved[:3, 3] = apart * camera.right
        return cls({"left": camera, "right": camera.moved(moved)}, pose)

    @property
    def sensors(self) -> dict[str, Carried]:
        """The sensors in the body's coordinates: a copy."""
        return dict(self._mounted)

    @property
    def pose(self) -> npt.NDArray[np.float64]:
        """The matrix that takes the body's coordinates to the world's, (4, 4) float64: a copy."""
        return np.array(pose4(self._pose))

    def at(self, pose: npt.ArrayLike) -> Rig:
        """Return the same sensors with the body elsewhere.

        Parameters
        ----------
        pose : (4, 4) or (3, 4) array_like
            The matrix that takes the body's coordinates to the world's, in place of `pose`.

        Returns
        -------
        Rig
            With the sensors of this one.

        Raises
        ------
        ValueError
            For a matrix that is no rigid motion.
        """
        return Rig(self._mounted, pose)

    def render(self, scene: Scene, **how: Any) -> dict[str, Frame]:
        """Make a picture of each sensor.

        Parameters
        ----------
        scene : Scene
            The scene.
        **how
            As for `firsthit.render`.

        Returns
        -------
        dict of str to Frame
            By the sensors' names.

        Raises
        ------
        ValueError, TypeError, MemoryError
            As `firsthit.render`.
        """
        # Pictures import scenes, which import cameras.
        from .render import render

        return {name: render(scene, self[name], **how) for name in self._mounted}

    def __getitem__(self, name: str) -> Carried:
        """Return a sensor as it stands in the world; a ``KeyError`` where there is none."""
        if name not in self._mounted:
            raise KeyError(f"no sensor {name!r}; there are {', '.join(self._mounted)}")
        sensor = self._mounted[name]
        return sensor if self._pose is None else sensor.moved(self._pose)

    def keys(self) -> KeysView[str]:
        """Return the sensors' names."""
        return self._mounted.keys()

    def items(self) -> ItemsView[str, Carried]:
        """Return names and sensors, as they stand in the world."""
        return {name: self[name] for name in self._mounted}.items()

    def __iter__(self) -> Iterator[str]:
        return iter(self._mounted)

    def __contains__(self, name: object) -> bool:
        return name in self._mounted

    def __len__(self) -> int:
        return len(self._mounted)

    def __repr__(self) -> str:
        return f"Rig({', '.join(self._mounted)})"
