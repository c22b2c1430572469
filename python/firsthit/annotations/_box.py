"""Boxes in space."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ._extent import extent

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from firsthit._objects.object import Object

    from ._extent import Corners

    Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Box3D:
    """The boxes around an instance, and its pose. Lengths are in scene units.

    The object's frame is that of the instance's first object: what its shape's numbers are in. The
    camera's frame here has OpenCV's axes: x to the right, y down, z forwards.

    Attributes
    ----------
    in_world : (2, 3) array of float64
        The low and the high corner of the least box along the world's axes.
    in_object : (2, 3) array of float64
        The same along the axes of the object's frame, in its units: the oriented box.
    world_from_object : (4, 4) array of float64
        The object's transform, for columns; it may scale.
    camera_from_object : (4, 4) array of float64
        The same to the camera's frame; of a moving camera as it is when its middle line is seen,
        number ``lines // 2``.
    """

    in_world: Floats
    in_object: Floats
    world_from_object: Floats
    camera_from_object: Floats

    @property
    def corners_in_object(self) -> Floats:
        """The oriented box's corners in the object's frame, (8, 3) float64.

        Corner k is at the high end of x, y and z where bits 0, 1 and 2 of k are set.
        """
        ends = (np.arange(8)[:, None] >> np.arange(3)) & 1
        corners: Floats = np.where(ends == 1, self.in_object[1], self.in_object[0])
        return corners

    @property
    def corners_in_world(self) -> Floats:
        """The oriented box's corners in the world, (8, 3) float64, in the same order."""
        return _moved(self.world_from_object, self.corners_in_object)

    @property
    def corners_in_camera(self) -> Floats:
        """The oriented box's corners in OpenCV's axes of the camera, (8, 3) float64."""
        return _moved(self.camera_from_object, self.corners_in_object)

    @property
    def size(self) -> Floats:
        """The lengths of the oriented box's edges along the object's axes, (3,) float64.

        They are lengths in the world: a scale of the transform counts.
        """
        scale = np.linalg.norm(self.world_from_object[:3, :3], axis=0)
        lengths: Floats = scale * (self.in_object[1] - self.in_object[0])
        return lengths


def boxes(
    objects: Sequence[Object], poses: tuple[Floats, Floats], corners: Corners
) -> tuple[Box3D | None, Floats]:
    """Return the boxes of an instance, ``None`` for an infinite one or one of nothing.

    ``poses`` are those from the camera and to it, (4, 4). The second is the box in OpenCV's axes of
    the camera, (2, 3), infinite where the instance is.
    """
    world_from_object = objects[0].transform
    pose, to_camera = poses
    back = np.linalg.inv(world_from_object) if len(objects) > 1 else np.eye(4)
    found = []
    for made in objects:
        transform = made.transform
        # Rows of a map are the directions along which its results are measured.
        own = np.eye(4) if made is objects[0] else back @ transform
        seen = pose[:3, :3].T @ transform[:3, :3]
        rows = np.vstack((transform[:3, :3], own[:3, :3], seen))
        offset = np.concatenate(
            (
                transform[:3, 3],
                own[:3, 3],
                # The difference first: far from the origin the rest would be all rounding.
                pose[:3, :3].T @ (transform[:3, 3] - pose[:3, 3]),
            )
        )
        found.append(extent(made.shape, rows, corners) + offset)
    low = np.min([one[0] for one in found], axis=0)
    high = np.max([one[1] for one in found], axis=0)
    both = np.stack((low, high))
    in_camera = both[:, 6:]
    if not np.isfinite(both).all() or (low > high).any():
        return None, in_camera
    seen = to_camera @ world_from_object
    return Box3D(both[:, :3], both[:, 3:6], world_from_object, seen), in_camera


def _moved(matrix: Floats, points: Floats) -> Floats:
    moved: Floats = points @ matrix[:3, :3].T + matrix[:3, 3]
    return moved
