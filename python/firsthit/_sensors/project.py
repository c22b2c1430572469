"""Points to pixels, and pixels to rays, also beyond the picture's border.

The projections of one pose, for annotations and flow, are here; `lines.py` has that of
cameras that move.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

    from .camera import Camera
    from .sensor import Sensor

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
        """The number of columns."""
        return max(self.right - self.left, 0)

    @property
    def height(self) -> int:
        """The number of rows."""
        return max(self.bottom - self.top, 0)

    @property
    def size(self) -> int:
        """The number of pixels."""
        return self.width * self.height

    def within(self, other: Reach) -> Reach:
        """Return what both have in common; it may be empty."""
        left, top = max(self.left, other.left), max(self.top, other.top)
        right, bottom = min(self.right, other.right), min(self.bottom, other.bottom)
        return Reach(left, top, max(right, left), max(bottom, top))


#: Beyond so many pixels a part of the plane is as good as infinite: indices stay far from 2^63.
_MOST_PIXELS = 2.0**40


def picture(camera: Sensor) -> Reach:
    """Return the pixels that a sensor has."""
    return Reach(0, 0, camera.columns, camera.rows)


class Plane(NamedTuple):
    """The plane of a flat picture, beyond its border too.

    With x to the right and y down, in the camera's frame and for a perspective camera divided by z,
    the pixel is ``(fx * x + skew * y + cx, fy * y + cy)``.
    """

    fx: float
    fy: float
    cx: float
    cy: float
    skew: float


def plane(camera: Camera) -> Plane | None:
    """Return the plane of a picture; ``None`` for one that is not flat."""
    k = intrinsic_matrix(camera)
    if k is not None:
        return Plane(k[0, 0], k[1, 1], k[0, 2], k[1, 2], k[0, 1])
    given = camera.parameters
    if camera.projection != "orthographic" or given["skew"] != 0.0:
        return None
    across, down = camera.columns / given["width"], camera.rows / given["height"]
    middle = 0.5 * camera.columns, 0.5 * camera.rows
    left, up = given["shift_x"] * across, given["shift_y"] * down
    return Plane(across, down, middle[0] - left, middle[1] + up, 0.0)


def sees_everything(camera: Camera) -> bool:
    """Tell whether all directions are in the picture, which then has no border."""
    if camera.projection == "equirectangular":
        given = camera.parameters
        return given["horizontal_fov"] >= 360.0 and given["vertical_fov"] >= 180.0
    return camera.projection in ("cube_map", "octahedral")


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
    """Return K, (3, 3), with the first pixel's centre at (0.5, 0.5); ``None`` if it is not all."""
    # Other projections have one, too, but a distortion comes before it.
    return camera.intrinsic_matrix if camera.projection == "perspective" else None


def project(camera: Camera, points: Floats) -> Floats:
    """Return where in the picture points of the world are seen, as `Camera.project`."""
    return camera.project(points)


def starts_towards(camera: Camera, points: Floats) -> Floats:
    """Return where the rays of the projection that go through points start, (..., 3).

    They are NaN for points before the start, which no ray meets.
    """
    if camera.ray_start == "eye" and camera.projection != "orthographic":
        return np.broadcast_to(camera.position, points.shape)
    if _is_tilted(camera):
        return _starts_on_tilted(camera, points)
    z = in_camera(camera, points)[..., 2:]
    near = _nearest_z(camera)
    with np.errstate(divide="ignore", invalid="ignore"):
        if camera.projection == "orthographic":
            starts = points - (z - near) * camera.aim
        else:
            starts = camera.position + (points - camera.position) * (near / z)
    return np.where(z > near, starts, np.nan)


def rays_at(camera: Camera, flat: Plane, pixels: Floats) -> tuple[Floats, Floats]:
    """Return the rays through points of a flat picture's plane, (..., 2), beyond its border too.

    Within the picture the camera's own rays are exact; these are the same but for rounding.
    """
    y = (pixels[..., 1:] - flat.cy) / flat.fy
    x = (pixels[..., :1] - flat.cx - flat.skew * y) / flat.fx
    beside = x * camera.right - y * camera.upwards
    ahead = np.broadcast_to(camera.aim, beside.shape)
    near, place = _nearest_z(camera), camera.position
    if camera.projection == "orthographic":
        return place + beside + near * ahead, ahead
    way = beside + ahead
    return place + near * way, way / np.linalg.norm(way, axis=-1, keepdims=True)


def reach(camera: Camera, flat: Plane, box: Floats) -> Reach | None:
    """Return pixels outside which no ray of a flat picture's plane meets what is in a box.

    The box is its low and high corner in OpenCV's axes of the camera, (2, 3). ``None`` where there
    is no end to it: for a box that reaches the eye's plane, and for an infinite one.
    """
    near = _nearest_z(camera)
    closest, farthest = max(box[0, 2], near), box[1, 2]
    if farthest <= near:
        return Reach(0, 0, 0, 0)
    sides = np.array([[x, y] for x in box[:, 0] for y in box[:, 1]])
    if camera.projection == "perspective":
        if closest <= 0.0:
            return None
        # Of an infinite box numbers may come out as NaN, which is no end either.
        with np.errstate(invalid="ignore"):
            sides = np.concatenate((sides / closest, sides / farthest))
    with np.errstate(invalid="ignore"):
        u = flat.fx * sides[:, 0] + flat.skew * sides[:, 1] + flat.cx
        v = flat.fy * sides[:, 1] + flat.cy
    edges = np.array([u.min(), v.min(), u.max(), v.max()])
    if not (np.abs(edges) < _MOST_PIXELS).all():
        return None
    # A pixel more on each side than rounding could ask for.
    left, top = (np.floor(edges[:2]).astype(int) - 1).tolist()
    right, bottom = (np.ceil(edges[2:]).astype(int) + 1).tolist()
    return Reach(left, top, right, bottom)


def _focal_length(camera: Camera) -> float:
    """Return the distance to the viewplane, which there is."""
    assert camera.focal_length is not None
    return camera.focal_length


def _is_tilted(camera: Camera) -> bool:
    given = camera.parameters
    return given.get("tilt_x", 0.0) != 0.0 or given.get("tilt_y", 0.0) != 0.0


def _starts_on_tilted(camera: Camera, points: Floats) -> Floats:
    """Return where rays to points pass a viewplane that is not at a right angle to the aim."""
    # Three points of it, by the rays of a camera of 2 x 2 pixels.
    corners, _ = camera.resize(2, 2).rays()
    normal = np.cross(corners[0, 1] - corners[0, 0], corners[1, 0] - corners[0, 0])
    ways = points - camera.position
    with np.errstate(divide="ignore", invalid="ignore"):
        share = ((corners[0, 0] - camera.position) @ normal) / (ways @ normal)[..., None]
        starts: Floats = np.where(
            (share > 0.0) & (share < 1.0), camera.position + share * ways, np.nan
        )
    return starts


def _nearest_z(camera: Camera) -> float:
    """Return the ``z`` at which rays start."""
    return 0.0 if camera.ray_start == "eye" else _focal_length(camera)
