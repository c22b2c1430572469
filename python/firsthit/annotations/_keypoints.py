"""Keypoints: named points of objects, and whether a camera sees them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple, get_args

import numpy as np

from firsthit._base.arrays import index, number, one_of, settle, text, vector
from firsthit._sensors.lines import sight
from firsthit._sensors.project import picture

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from firsthit._scene.scene import Scene
    from firsthit._sensors.lines import PictureSensor
    from firsthit.typing import Vector

    from ._annotations import Part

    Floats = npt.NDArray[np.float64]

#: In whose frame points are: that of an instance's first object, or the world's.
PointsFrame = Literal["object", "world"]


@dataclass(frozen=True, init=False)
class Keypoints:
    """Named points that an instance, or each of a class, has.

    Parameters
    ----------
    points : mapping of str to (3,) array_like
        The points by name, in the order in which they are written. One that has NaN is not
        labelled.
    frame : {"object", "world"}
        The space of the points: the frame of the instance's first object, as `Object.transform`
        takes it to the world, or the world.
    skeleton : sequence of pair of str
        The names of points between which lines are drawn.
    tolerance : float
        How far the instance's own surfaces may be before a point and still not hide it, in scene
        units. With 0 a point is on the surface but for rounding, as `Scene.visible` takes it; give
        more where points were rounded. With ``math.inf`` points are inside the instance, such as
        joints, and only what else there is hides them.

    Raises
    ------
    ValueError
        For an unknown frame, lines between points that are not there, a tolerance that is negative
        or no number, and a point that is not three numbers.
    TypeError
        For points that are no mapping of names.

    Examples
    --------
    >>> from firsthit.annotations import Keypoints
    >>> nose = Keypoints({"tip": (0, 0, 1), "root": (0, 0, 0.5)}, skeleton=[("tip", "root")])
    """

    points: Mapping[str, Vector]
    frame: PointsFrame
    skeleton: tuple[tuple[str, str], ...]
    tolerance: float

    def __init__(
        self,
        points: Mapping[str, npt.ArrayLike],
        *,
        frame: PointsFrame = "object",
        skeleton: Sequence[tuple[str, str]] = (),
        tolerance: float = 0.0,
    ) -> None:
        if not isinstance(points, Mapping):
            raise TypeError(f"points must be a dict of points by name, got {points!r}")
        one_of("frame", frame, get_args(PointsFrame))
        made = {
            text("the name of a keypoint", name): vector(f"keypoint {name!r}", point)
            for name, point in points.items()
        }
        lines = tuple((start, end) for start, end in skeleton)
        for name in (name for line in lines for name in line):
            if name not in made:
                raise ValueError(f"skeleton must join points among {', '.join(made)}, got {name!r}")
        far = number("tolerance", tolerance)
        if not far >= 0.0:
            raise ValueError(f"tolerance must be zero or more, got {far}")
        settle(self, points=made, frame=frame, skeleton=lines, tolerance=far)


class Keypoint(NamedTuple):
    """A point of an instance, as a camera sees it.

    Attributes
    ----------
    name : str
        Its name.
    position : (3,) tuple of float
        Where it is, in world space; NaN if it is not labelled.
    pixel : (2,) tuple of float
        Where it is in the picture, columns from the left edge and rows from the upper edge, also
        beyond them; NaN where the projection, or no line of a moving camera, does not see it.
    z : float
        Its distance from the camera's position along its aim, in scene units; of a moving camera as
        it is at the time of the line that sees the point, NaN if none does.
    visibility : int
        2: it is in the picture and seen. 1: it is in the picture, and something hides it. 0: it is
        not labelled, not in the picture, or before the start of rays.
    """

    name: str
    position: Vector
    pixel: tuple[float, float]
    z: float
    visibility: int


#: Keypoints by the class of an instance, or by one of its objects, which comes first.
Given = Mapping[str | int, Keypoints | Mapping[str, "npt.ArrayLike"]]


def settled(keypoints: Given | None) -> dict[str | int, Keypoints]:
    """Check what a user gave."""
    if keypoints is None:
        return {}
    if not isinstance(keypoints, Mapping):
        raise TypeError(f"keypoints must be a dict by class or object, got {keypoints!r}")
    return {
        key if isinstance(key, str) else index("a key of keypoints", key): (
            points if isinstance(points, Keypoints) else Keypoints(points)
        )
        for key, points in keypoints.items()
    }


def points_of(
    points: Mapping[str | int, Keypoints], objects: Sequence[int], class_name: str | None
) -> Keypoints | None:
    """Return the points of an instance of some objects and a class; ``None`` if it has none."""
    keys: list[str | int] = [*objects]
    keys += [] if class_name is None else [class_name]
    return next((points[key] for key in keys if key in points), None)


def seen(
    given: Keypoints,
    world_from_object: Floats,
    scene: Scene,
    camera: PictureSensor,
    parts: Sequence[Part],
    there: Sequence[int],
    threads: int | None,
) -> tuple[Keypoint, ...]:
    """Return the points of an instance, and whether the objects that are there hide them."""
    points = np.array([*given.points.values()], np.float64).reshape(-1, 3)
    if given.frame == "object":
        points = points @ world_from_object[:3, :3].T + world_from_object[:3, 3]
    pixels, starts, z = sight(camera, points)
    whole = picture(camera)
    with np.errstate(invalid="ignore"):
        is_in = (pixels >= 0.0).all(axis=1) & (pixels < (whole.right, whole.bottom)).all(axis=1)
    is_in &= np.isfinite(starts).all(axis=1)
    is_seen = np.zeros(len(points), np.bool_)
    a, b = starts[is_in], points[is_in]
    if given.tolerance == 0.0:
        clear = scene.visible(a, b, objects=there, threads=threads)
    else:
        own = [part.object for part in parts]
        others = [k for k in there if k not in own]
        clear = scene.visible(a, b, objects=others, threads=threads)
        if math.isfinite(given.tolerance):
            ways = b - a
            length = np.linalg.norm(ways, axis=1)
            with np.errstate(divide="ignore"):
                end = np.maximum(1.0 - given.tolerance / length, 0.0)
            clear &= ~scene.occluded(a, ways, t_max=end, objects=own, threads=threads)
    is_seen[is_in] = clear
    visibility = np.where(is_seen, 2, np.where(is_in, 1, 0)).tolist()
    made = zip(given.points, points.tolist(), pixels.tolist(), z.tolist(), visibility, strict=True)
    return tuple(
        Keypoint(name, (x, y, far), (u, v), depth, state)
        for name, (x, y, far), (u, v), depth, state in made
    )
