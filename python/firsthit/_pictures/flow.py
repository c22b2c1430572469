"""Optical flow, scene flow and disparity: where a pixel's point is in another picture."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from firsthit._objects.mesh import Mesh
from firsthit._objects.traceable import Traceable
from firsthit._sensors.camera import Camera
from firsthit._sensors.lines import PictureSensor, sight, sight_at
from firsthit._sensors.moving import RollingShutter

from .flow_file import save_disparity, save_flow

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence

    import numpy.typing as npt

    from firsthit._objects.object import Object
    from firsthit._queries.hits import Hits
    from firsthit._scene.scene import Scene
    from firsthit._sensors.lines import Projected

    Floats = npt.NDArray[np.float64]
    Bools = npt.NDArray[np.bool_]

#: By how much the cameras of a stereo pair may differ, as a share, and still be parallel.
_ROUNDING = 1e-9


class Flow(NamedTuple):
    """The motion of the point that each pixel of a picture shows, as `optical_flow` finds it.

    Attributes
    ----------
    flow : (rows, columns, 2) array of float64
        From the pixel's centre to where the same point is in the second picture: columns to the
        right, then rows down. NaN for a miss, for what is gone, and where the second projection
        does not see the point, as behind it, or in no line of a moving camera. A point that crosses
        the seam of a panorama flows nearly its whole width.
    occluded : (rows, columns) array of bool
        Whether something in the second scene is before the point, or it is gone there. False for a
        miss.
    outside : (rows, columns) array of bool
        Whether the point is beyond the second picture's border, behind the camera, in no line of a
        moving one, or before the start of its rays. False for a miss and for what is gone.
    scene_flow : (rows, columns, 3) array of float64
        How the point moved, in world space and scene units. NaN for a miss and what is gone.
    """

    flow: Floats
    occluded: Bools
    outside: Bools
    scene_flow: Floats

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the flow to a file, whole or not at all; pixels without one are unknown there.

        Parameters
        ----------
        path : path-like
            ``.flo``, Middlebury's format: float32, and 1e10 where it is unknown. Or ``.png``, as
            KITTI 2015 has it: 16 bits, ``64 u + 2^15``, ``64 v + 2^15``, and 1 where it is known.

        Raises
        ------
        ValueError
            For another extension, and for a flow that the format cannot hold: 512 pixels in a PNG.
        FileWriteError
            If the system refuses to write it; an old file is as it was. Also an `OSError`.
        """
        save_flow(path, self.flow)


class Disparity(NamedTuple):
    """The distance of points to the left in the right picture, as `disparity` finds it.

    Attributes
    ----------
    disparity : (rows, columns) array of float64
        Columns in the left picture less columns in the right one, of each pixel of the left one:
        not negative. NaN for a miss.
    occluded : (rows, columns) array of bool
        Whether something hides the point from the right camera. False for a miss.
    outside : (rows, columns) array of bool
        Whether the point is beyond the right picture's border. False for a miss.
    """

    disparity: Floats
    occluded: Bools
    outside: Bools

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the disparity to a file, whole or not at all; pixels without one are unknown there.

        Parameters
        ----------
        path : path-like
            ``.png``, as KITTI 2015 has it: 16 bits, 256 times the disparity, at least 1; 0 is
            unknown. Or ``.pfm``, Middlebury's format: float32, and infinity where it is unknown.

        Raises
        ------
        ValueError
            For another extension, and for a disparity of 256 pixels or more in a PNG.
        FileWriteError
            If the system refuses to write it; an old file is as it was. Also an `OSError`.
        """
        save_disparity(path, self.disparity)


def optical_flow(
    scene0: Scene,
    camera0: PictureSensor,
    scene1: Scene,
    camera1: PictureSensor,
    *,
    threads: int | None = None,
) -> Flow:
    """Find where what each pixel shows has moved to, when objects and the camera move.

    The point that the ray through a pixel's centre meets stays where it is on its object: on a
    mesh by its triangle and weights, so that vertices may move too, on other shapes by its place in
    the object's frame. The camera looks for that point in the second scene, and a line of sight
    tells whether it is seen; the surface that it is on does not hide it.

    Parameters
    ----------
    scene0, scene1 : Scene
        The scene at both times; the same if only the camera moves. Objects are the same by their
        identifiers. ``copy.copy`` of a scene, and `Scene.move` or `Scene.update_vertices` of the
        copy, make the second one.
    camera0, camera1 : Camera, RollingShutter or Pushbroom
        The camera at both times, of any projections and sizes.
    threads : int, optional
        The number of threads; all cores if left out. The result is the same for any number.

    Returns
    -------
    Flow
        For the pixels of the first picture.

    Raises
    ------
    ValueError
        For an object that has another name, shape or triangles in the second scene, and for a
        second camera that is a `Pushbroom` whose times neither increase nor decrease.
    TypeError
        For scenes and cameras of another type.
    MemoryError
        If the result does not fit into memory.

    Notes
    -----
    Objects stand still while a moving camera sees its picture; they move between the pictures. The
    second picture of a moving camera shows a point at a place s of its lines, counted from 0 in the
    order of time, at which the camera, as it is at the time of s, sees the point in the line s
    itself. Line k has its time at s = k + 0.5; between two lines time goes on evenly. A fast camera
    may see a point several times: the first place in the picture, in time, is taken. Beyond the
    border a rolling shutter stands as at its nearest line, and a pushbroom sees nothing.

    The place is bracketed between two lines, and found to 1e-10 of a line by false position. Where
    a point does not draw near its line all the time, as 17 lines and those beside the poses of the
    trajectory tell, all lines are tried. A point that passes a line to and fro between two middles
    is not seen to pass.

    Examples
    --------
    >>> import copy
    >>> before = fh.Scene()
    >>> card = before.add(fh.Box((-1, -1, -1), (1, 1, 0)))
    >>> camera = fh.Camera.look_at((0, 0, 4), (0, 0, 0), (0, 1, 0), 90, rows=4, columns=4)
    >>> after, right = copy.copy(before), np.eye(4)
    >>> right[0, 3] = 0.5
    >>> after.move(card, right)
    >>> found = fh.optical_flow(before, camera, after, camera)
    >>> found.flow[1, 1].round(12), found.scene_flow[1, 1]
    (array([0.25, 0.  ]), array([0.5, 0. , 0. ]))
    """
    _check((scene0, scene1), (camera0, camera1))
    hits = scene0.shoot(camera0, threads=threads)
    objects = scene1._ready().objects
    points, moved = _carried(hits, hits._built.objects, objects)
    seen = sight(camera1, points)
    occluded, outside = _sighted(scene1, camera1, seen, points, hits, threads)
    # A removed object has no place to be seen at.
    occluded |= (hits.object >= 0) & ~np.isfinite(points).all(axis=-1)
    return Flow(seen.pixels - _centres(camera0), occluded, outside, moved)


def disparity(
    scene: Scene, left: PictureSensor, right: PictureSensor, *, threads: int | None = None
) -> Disparity:
    """Find how far to the left each point of a picture is in that of a second, parallel camera.

    It is the difference of two projections of the point that is hit, without matching: for a
    focal length of ``f`` columns and a baseline ``b`` it is ``f * b / z``.

    Parameters
    ----------
    scene : Scene
        The scene.
    left, right : Camera, RollingShutter or Pushbroom
        The cameras of a rectified pair: perspective, with the same directions, viewplane and
        pixels, the second one to the right of the first. Moving ones see the same rows at the same
        times from one trajectory, so that a point is in the same row of both; ``z`` is then from
        where they are at the row's time.
    threads : int, optional
        The number of threads; all cores if left out. The result is the same for any number.

    Returns
    -------
    Disparity
        For the pixels of the left picture.

    Raises
    ------
    ValueError
        For cameras that are no rectified pair, with what differs.
    TypeError
        For a scene and cameras of another type.
    MemoryError
        If the result does not fit into memory.

    Examples
    --------
    >>> scene = fh.Scene()
    >>> scene.add(fh.Plane(point=(0, 0, 0), normal=(0, 0, 1)))
    0
    >>> left, right = (
    ...     fh.Camera.look_at((x, 0, 4), (x, 0, 0), (0, 1, 0), 90, rows=2, columns=2)
    ...     for x in (0, 0.5))
    >>> fh.disparity(scene, left, right).disparity
    array([[0.125, 0.125],
           [0.125, 0.125]])
    """
    _check((scene,), (left, right))
    if isinstance(left, Camera) and isinstance(right, Camera):
        check_pair(left, right)
    else:
        _check_moving_pair(left, right)
    hits = scene.shoot(left, threads=threads)
    points = hits.position
    if isinstance(right, Camera):
        seen = sight(right, points)
    else:
        # Both see a row at one time: no line has to be looked for.
        seen = sight_at(right, points, right._times())
    occluded, outside = _sighted(scene, right, seen, points, hits, threads)
    return Disparity(_centres(left)[..., 0] - seen.pixels[..., 0], occluded, outside)


def _check(scenes: Sequence[Scene], cameras: Sequence[PictureSensor]) -> None:
    for scene in scenes:
        if not isinstance(scene, Traceable):
            raise TypeError(f"a scene must be a Scene, got {scene!r}")
    for camera in cameras:
        if not isinstance(camera, PictureSensor):
            raise TypeError(
                f"a camera must be a Camera, a RollingShutter or a Pushbroom, got {camera!r}"
            )


def check_pair(left: Camera, right: Camera) -> None:
    """Refuse cameras whose rows do not show the same points."""
    for name in ("projection", "rows", "columns", "parameters", "ray_start"):
        a, b = getattr(left, name), getattr(right, name)
        if a != b:
            raise ValueError(f"left and right must have the same {name}, got {a} and {b}")
    if left.projection != "perspective":
        raise ValueError(f"left and right must be perspective, got {left.projection}")
    for name in ("aim", "upwards"):
        a, b = getattr(left, name), getattr(right, name)
        if np.abs(a - b).max() > _ROUNDING:
            raise ValueError(f"left and right must have the same {name}, got {a} and {b}")
    way = right.position - left.position
    along, beside = float(way @ left.right), np.cross(way, left.right)
    if along <= 0.0 or np.abs(beside).max() > _ROUNDING * along:
        raise ValueError(
            f"right must be to the right of left alone, got {right.position} and {left.position}"
        )


def _check_moving_pair(left: PictureSensor, right: PictureSensor) -> None:
    """Refuse moving cameras whose rows do not show the same points."""
    if isinstance(left, Camera) or isinstance(right, Camera) or type(left) is not type(right):
        raise ValueError(
            "left and right must be of the same type, got "
            f"{type(left).__name__} and {type(right).__name__}"
        )
    for one in (left, right):
        if isinstance(one, RollingShutter) and not one.reads_rows:
            raise ValueError(
                "left and right must be read out by rows: a column of the one is seen at another "
                f"time than the column of the other that shows the same; got {one.direction}"
            )
    if not np.array_equal(left.times, right.times):
        raise ValueError("left and right must see their rows at the same times")
    ways = [each.trajectory._native.parts() for each in (left, right)]
    if not all(map(np.array_equal, *ways)):
        raise ValueError("left and right must have the same trajectory")
    check_pair(left.camera, right.camera)


def _centres(camera: PictureSensor) -> Floats:
    """Return the centres of a camera's pixels, (rows, columns, 2)."""
    u, v = np.arange(camera.columns) + 0.5, np.arange(camera.rows) + 0.5
    return np.stack(np.meshgrid(u, v), axis=-1)


def _sighted(
    scene: Scene,
    camera: PictureSensor,
    seen: Projected,
    points: Floats,
    hits: Hits,
    threads: int | None,
) -> tuple[Bools, Bools]:
    """Return which points of hits are hidden from a camera, and which it cannot see."""
    pixels, starts = seen.pixels, seen.starts
    is_there = np.isfinite(points).all(axis=-1)
    has_line = is_there & np.isfinite(starts).all(axis=-1) & np.isfinite(pixels).all(axis=-1)
    with np.errstate(invalid="ignore"):
        is_in = (pixels >= 0.0).all(axis=-1) & (pixels < (camera.columns, camera.rows)).all(axis=-1)
    own = hits.object[has_line], hits.primitive[has_line]
    occluded = np.zeros(hits.shape, np.bool_)
    occluded[has_line] = ~scene.visible(
        starts[has_line], points[has_line], skip_b=own, threads=threads
    )
    outside: Bools = np.asarray(is_there & ~(has_line & is_in))
    return occluded, outside


def _carried(
    hits: Hits, before: Sequence[Object], after: Sequence[Object]
) -> tuple[Floats, Floats]:
    """Return where the points of hits are when objects have moved, and by how much they moved."""
    identifiers = hits.object.reshape(-1)
    points = hits.position.reshape(-1, 3).copy()
    moved = np.where(identifiers[:, None] < 0, np.nan, np.zeros_like(points))
    order = np.argsort(identifiers, kind="stable")
    there, firsts = np.unique(identifiers[order], return_index=True)
    for made, pixels in zip(there.tolist(), np.split(order, firsts[1:]), strict=True):
        if made < 0:
            continue
        old, new = before[made], after[made] if made < len(after) else None
        if new is None or new.removed or new.hidden:
            points[pixels] = moved[pixels] = np.nan
        elif new is not old:
            _check_same(made, old, new)
            weights, primitive = hits.barycentric.reshape(-1, 3), hits.primitive.reshape(-1)
            a, b = _places(old, new, points[pixels], weights[pixels], primitive[pixels])
            points[pixels], moved[pixels] = b, b - a
    shape = (*hits.shape, 3)
    return points.reshape(shape), moved.reshape(shape)


def _check_same(identifier: int, old: Object, new: Object) -> None:
    """Refuse objects of which no one can say where their points have gone."""
    if old.name != new.name:
        raise ValueError(
            f"object {identifier} must be the same in both scenes, got the names {old.name!r} and "
            f"{new.name!r}"
        )
    if old.shape is new.shape:
        return
    if isinstance(old.shape, Mesh) and isinstance(new.shape, Mesh):
        is_same = np.array_equal(old.shape.triangles, new.shape.triangles)
    else:
        is_same = old.shape == new.shape
    if not is_same:
        raise ValueError(
            f"object {identifier} must have the same triangles or the same shape in both scenes, "
            f"got {old.shape!r} and {new.shape!r}"
        )


def _places(
    old: Object, new: Object, points: Floats, weights: Floats, primitive: npt.NDArray[np.int32]
) -> tuple[Floats, Floats]:
    """Return where points of an object are, before and after; as exactly alike if nothing moved."""
    if isinstance(old.shape, Mesh) and isinstance(new.shape, Mesh):
        corners = old.shape.triangles[primitive]
        a = (old.shape.vertices[corners] * weights[:, :, None]).sum(axis=1)
        b = a
        if new.shape is not old.shape:
            b = (new.shape.vertices[corners] * weights[:, :, None]).sum(axis=1)
        return _moved(old.transform, a), _moved(new.transform, b)
    if np.array_equal(old.transform, new.transform):
        return points, points
    back = np.linalg.inv(old.transform)
    return points, _moved(new.transform @ back, points)


def _moved(matrix: Floats, points: Floats) -> Floats:
    moved: Floats = points @ matrix[:3, :3].T + matrix[:3, 3]
    return moved
