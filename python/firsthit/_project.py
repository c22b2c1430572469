"""Points to pixels, and pixels to rays, also beyond the picture's border.

All that annotations and flow know of projections is here.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

    from ._camera import Camera

    Floats = npt.NDArray[np.float64]


class Reach(NamedTuple):
    """A part of the picture's plane in pixels, right and bottom edges excluded.

    It may go beyond the picture; the first pixel has the column 0 and the row 0.
    """

    left: int
    top: int
    right: int
    bottom: int

    @property
    def width(self) -> int:
        """How many columns it has."""
        return max(self.right - self.left, 0)

    @property
    def height(self) -> int:
        """How many rows it has."""
        return max(self.bottom - self.top, 0)

    @property
    def size(self) -> int:
        """How many pixels it has."""
        return self.width * self.height

    def within(self, other: Reach) -> Reach:
        """Return what both have in common; it may be empty."""
        left, top = max(self.left, other.left), max(self.top, other.top)
        right, bottom = min(self.right, other.right), min(self.bottom, other.bottom)
        return Reach(left, top, max(right, left), max(bottom, top))


#: Beyond so many pixels a part of the plane is as good as infinite: indices stay far from 2^63.
_MOST_PIXELS = 2.0**40


def picture(camera: Camera) -> Reach:
    """Return the pixels that the camera has."""
    return Reach(0, 0, camera.columns, camera.rows)


def has_viewplane(camera: Camera) -> bool:
    """Tell whether the picture is flat, so that it can be continued beyond its border."""
    return camera.projection in ("perspective", "orthographic")


def world_from_camera(camera: Camera) -> Floats:
    """Return the pose, (4, 4): from OpenCV's axes (right, down, forwards) to the world."""
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 2] = camera.right, -camera.upwards, camera.aim
    matrix[:3, 3] = camera.position
    return matrix


def camera_from_world(camera: Camera) -> Floats:
    """Return the map from the world to OpenCV's axes (right, down, forwards), (4, 4)."""
    matrix = np.eye(4)
    turn = world_from_camera(camera)[:3, :3].T
    matrix[:3, :3], matrix[:3, 3] = turn, -turn @ camera.position
    return matrix


def in_camera(camera: Camera, points: Floats) -> Floats:
    """Return points of the world in OpenCV's axes of the camera, (..., 3)."""
    # The difference first: far from the origin the rest would be all rounding.
    seen: Floats = (points - camera.position) @ world_from_camera(camera)[:3, :3]
    return seen


def intrinsic_matrix(camera: Camera) -> Floats | None:
    """Return K, (3, 3), with the first pixel's centre at (0.5, 0.5); ``None`` if there is none."""
    if camera.projection != "perspective":
        return None
    across, down = _pixels_per_length(camera)
    focal = _focal_length(camera)
    middle = 0.5 * camera.columns, 0.5 * camera.rows
    return np.array([[focal * across, 0, middle[0]], [0, focal * down, middle[1]], [0, 0, 1]])


def project(camera: Camera, points: npt.ArrayLike) -> Floats:
    """Return where in the picture points of the world are seen.

    Parameters
    ----------
    camera : Camera
        The camera.
    points : (..., 3) array_like
        Points in world space.

    Returns
    -------
    (..., 2) array of float64
        Pixels: columns from the left edge and rows from the upper edge of the picture, also of
        points that are seen beyond them. The centre of the first pixel is (0.5, 0.5). NaN where the
        projection sees no such direction, as behind a pinhole.
    """
    x, y, z = np.moveaxis(in_camera(camera, np.asarray(points, np.float64)), -1, 0)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        if camera.projection == "equirectangular":
            longitude, latitude = np.arctan2(x, z), np.arctan2(-y, np.hypot(x, z))
            u = (longitude / (2.0 * math.pi) + 0.5) * camera.columns
            v = (0.5 - latitude / math.pi) * camera.rows
            is_seen = (x != 0.0) | (y != 0.0) | (z != 0.0)
        else:
            across, down = _pixels_per_length(camera)
            is_seen = np.ones(x.shape, np.bool_)
            if camera.projection == "perspective":
                is_seen = z > 0.0
                x, y = _focal_length(camera) * x / z, _focal_length(camera) * y / z
            u, v = 0.5 * camera.columns + across * x, 0.5 * camera.rows + down * y
    pixels = np.stack((u, v), axis=-1)
    is_seen = is_seen & np.isfinite(pixels).all(axis=-1)
    seen: Floats = np.where(is_seen[..., None], pixels, np.nan)
    return seen


def starts_towards(camera: Camera, points: Floats) -> Floats:
    """Return where the rays of the projection that go through points start, (..., 3).

    They are NaN for points before the start, which no ray meets.
    """
    if camera.ray_start == "eye" and camera.projection != "orthographic":
        return np.broadcast_to(camera.position, points.shape)
    z = in_camera(camera, points)[..., 2:]
    near = _nearest_z(camera)
    with np.errstate(divide="ignore", invalid="ignore"):
        if camera.projection == "orthographic":
            starts = points - (z - near) * camera.aim
        else:
            starts = camera.position + (points - camera.position) * (near / z)
    return np.where(z > near, starts, np.nan)


def rays_at(camera: Camera, pixels: Floats) -> tuple[Floats, Floats]:
    """Return the rays through points of the picture's plane, which go on beyond its border.

    Only for cameras with a viewplane. Within the picture the camera's own rays are exact; these are
    the same but for rounding.
    """
    across, down = _pixels_per_length(camera)
    x = (pixels[..., :1] - 0.5 * camera.columns) / across
    y = (pixels[..., 1:] - 0.5 * camera.rows) / down
    beside = x * camera.right - y * camera.upwards
    ahead = np.broadcast_to(camera.aim, beside.shape)
    place = camera.position
    if camera.projection == "orthographic":
        return place + beside + _nearest_z(camera) * ahead, ahead
    way = beside + _focal_length(camera) * ahead
    start = place if camera.ray_start == "eye" else place + way
    return (
        np.broadcast_to(start, way.shape),
        way / np.linalg.norm(way, axis=-1, keepdims=True),
    )


def reach(camera: Camera, box: Floats) -> Reach | None:
    """Return pixels outside which no ray of the continued picture meets what is in a box.

    Parameters
    ----------
    camera : Camera
        The camera.
    box : (2, 3) array of float64
        Its low and high corner in OpenCV's axes of the camera.

    Returns
    -------
    Reach or None
        ``None`` where there is no end to it: for a box that reaches the eye's plane, for an
        infinite one, and for projections that are not flat.
    """
    if not has_viewplane(camera):
        return None
    near = _nearest_z(camera)
    (left, top, closest), (right, bottom, farthest) = box
    if farthest <= near:
        return Reach(0, 0, 0, 0)
    if camera.projection == "perspective":
        closest = max(closest, near)
        if closest <= 0.0:
            return None
        focal = _focal_length(camera)
        ends = focal / closest, focal / farthest
        # Of an infinite box numbers may come out as NaN, which is no end either.
        with np.errstate(invalid="ignore"):
            left, right = min(left * end for end in ends), max(right * end for end in ends)
            top, bottom = min(top * end for end in ends), max(bottom * end for end in ends)
    across, down = _pixels_per_length(camera)
    edges = np.array([left * across, top * down, right * across, bottom * down])
    edges += 0.5 * np.array([camera.columns, camera.rows] * 2)
    if not (np.abs(edges) < _MOST_PIXELS).all():
        return None
    # A pixel more on each side than rounding could ask for.
    first, last = np.floor(edges[:2]).astype(int) - 1, np.ceil(edges[2:]).astype(int) + 1
    return Reach(int(first[0]), int(first[1]), int(last[0]), int(last[1]))


def _focal_length(camera: Camera) -> float:
    """Return the distance to the viewplane, which there is."""
    assert camera.focal_length is not None
    return camera.focal_length


def _pixels_per_length(camera: Camera) -> tuple[float, float]:
    """Return columns and rows for each unit of length on the viewplane."""
    assert camera.width is not None
    assert camera.height is not None
    return camera.columns / camera.width, camera.rows / camera.height


def _nearest_z(camera: Camera) -> float:
    """Return the ``z`` at which rays start."""
    return 0.0 if camera.ray_start == "eye" else _focal_length(camera)
