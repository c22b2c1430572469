"""The rays of Open3D's pinhole cameras."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from firsthit._base.arrays import count, number, numbers, vector

if TYPE_CHECKING:
    import numpy.typing as npt

    Floats = npt.NDArray[np.float64]


def rays_of_matrices(
    intrinsic_matrix: npt.ArrayLike,
    extrinsic_matrix: npt.ArrayLike,
    width_px: int,
    height_px: int,
) -> Floats:
    """Return the rays of a camera that is given by its two matrices, (height, width, 6)."""
    pixel_from_camera = _matrix("intrinsic_matrix", intrinsic_matrix, 3)
    camera_from_world = _matrix("extrinsic_matrix", extrinsic_matrix, 4)
    rotation = camera_from_world[:3, :3]
    try:
        world_from_pixel = rotation.T @ np.linalg.inv(pixel_from_camera)
    except np.linalg.LinAlgError:
        raise ValueError("intrinsic_matrix must be invertible") from None
    rows, columns = count("height_px", height_px), count("width_px", width_px)
    y, x = np.meshgrid(np.arange(rows) + 0.5, np.arange(columns) + 0.5, indexing="ij")
    rays = np.empty((rows, columns, 6))
    rays[..., :3] = -rotation.T @ camera_from_world[:3, 3]
    rays[..., 3:] = np.stack((x, y, np.ones_like(x)), axis=-1) @ world_from_pixel.T
    return rays


def rays_of_view(
    fov_deg: float,
    center: npt.ArrayLike,
    eye: npt.ArrayLike,
    up: npt.ArrayLike,
    width_px: int,
    height_px: int,
) -> Floats:
    """Return the rays of a camera that looks at a point, (height, width, 6)."""
    angle = number("fov_deg", fov_deg)
    if not 0.0 < angle < 180.0:
        raise ValueError(f"fov_deg must be between 0 and 180, got {angle}")
    width = count("width_px", width_px)
    # A picture without pixels has no focal length, and needs none.
    focal = 0.5 * max(width, 1) / math.tan(math.radians(angle) / 2.0)
    middle = 0.5 * width, 0.5 * count("height_px", height_px)
    place = np.array(vector("eye", eye))
    ahead = _unit("center", np.array(vector("center", center)) - place)
    # Open3D's axes, in its order: x is to the left of the view, and y is up.
    aside = _unit("up", np.cross(vector("up", up), ahead))
    rotation = np.array((aside, np.cross(ahead, aside), ahead))
    extrinsic = np.eye(4)
    extrinsic[:3, :3], extrinsic[:3, 3] = rotation, -rotation @ place
    intrinsic = [[focal, 0.0, middle[0]], [0.0, focal, middle[1]], [0.0, 0.0, 1.0]]
    return rays_of_matrices(intrinsic, extrinsic, width_px, height_px)


def _matrix(name: str, value: npt.ArrayLike, size: int) -> Floats:
    array = numbers(name, value)
    if array.shape != (size, size):
        raise ValueError(f"{name} must have the shape ({size}, {size}), got {array.shape}")
    return np.asarray(array, np.float64)


def _unit(name: str, direction: Floats) -> Floats:
    """Return a direction with length one."""
    length = float(np.linalg.norm(direction))
    if not 0.0 < length < math.inf:
        wanted = "away from the eye" if name == "center" else "across the view"
        raise ValueError(f"{name} must be {wanted}")
    return direction / length
