"""KITTI's labels of objects: boxes in pictures and upright boxes in the camera's frame."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

from firsthit._base.arrays import number, one_of
from firsthit._files.whole import write

from ._files import MaskKind, class_of, meters, named, refused, rotation_and_scale, stems, still

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

    import numpy.typing as npt

    from ._annotations import Annotations, BoxInPicture, Instance
    from ._files import Pictures

    Floats = npt.NDArray[np.float64]

#: An axis of an object's frame.
Axis = Literal["+x", "-x", "+y", "-y", "+z", "-z"]


def save_kitti(
    folder: str | os.PathLike[str],
    pictures: Pictures,
    *,
    unit: float | str,
    forward: Axis = "+x",
    up: Axis = "+z",
    box: MaskKind = "amodal",
    occlusion: tuple[float, float] = (0.9, 0.5),
    tilt_degrees: float = 1e-3,
    score: float | None = None,
) -> None:
    """Write annotations of pictures as KITTI's labels of objects: a text file for each.

    Into the folder goes ``label_2`` with a file for each picture, and in it a line for each
    instance. The frame is that of the camera: x to the right, y down, z forwards.

    Parameters
    ----------
    folder : path-like
        The folder of the dataset's part, which is made.
    pictures : mapping of str to Annotations, or sequence of Annotations
        The pictures by the names of their files; of a sequence they count from ``000000``.
    unit : float or str
        The length of the scene's unit: in metres, or as ``"mm"``, ``"cm"``, ``"m"``, ``"in"``, ...
    forward, up : {"+x", "-x", "+y", "-y", "+z", "-z"}
        The axes of objects' frames along which they have their length and their height.
    box : {"amodal", "visible"}
        Which box in the picture is written: of all of the object that is in the picture, as in
        KITTI, or of what is visible.
    occlusion : pair of float
        From which visibility on an object is fully visible (0), and from which on it is partly
        occluded (1). It is largely occluded (2) below, and unknown (3) where no pixel is visible.
    tilt_degrees : float
        By how much an object's ``up`` may lean away from the camera's. KITTI's boxes stand
        upright: what leans more is refused, and what leans less is written as if it did not.
    score : float, optional
        A 16th column, as results have it.

    Raises
    ------
    ValueError
        For a moving camera, and a projection other than perspective; an instance without a class or
        with a space in it, without a pixel of that box, with an infinite box, or one that leans;
        for a transform that shears or mirrors; for axes that are not at a right angle, and
        thresholds that are not in order.
    TypeError
        For pictures that are no annotations.
    FileWriteError
        If the system refuses to write a file; also an `OSError`. Others may be there then.

    Notes
    -----
    The columns: class, truncated (the share of the silhouette beyond the border), occluded, alpha,
    the box (left, top, right, bottom: the numbers of the first and last column and row), height,
    width and length in metres, the middle of the box's bottom (x, y, z) in metres, rotation_y, and
    the score. Rotation_y is 0 where ``forward`` is along the camera's x, and -pi/2 where it is
    along z: ``atan2(-z, x)`` of it. Alpha is rotation_y less the direction of the object,
    ``atan2(x, z)`` of its place. Angles are from -pi to pi.
    """
    how = {name: value for name, value in locals().items() if name not in ("folder", "pictures")}
    given = named(pictures)
    paths = [Path(folder, "label_2", f"{stem}.txt") for stem in stems(given)]
    texts = labels(given, **how)
    for path, text in zip(paths, texts.values(), strict=True):
        write(path, text.encode())


def labels(
    pictures: Mapping[str, Annotations],
    *,
    unit: float | str,
    forward: Axis,
    up: Axis,
    box: MaskKind,
    occlusion: tuple[float, float],
    tilt_degrees: float,
    score: float | None = None,
) -> dict[str, str]:
    """Return the text of each picture's labels, as `save_kitti` writes them."""
    length, level = meters(unit), _Upright(forward, up, number("tilt_degrees", tilt_degrees))
    one_of("box", box, get_args(MaskKind))
    full, partly = (number("occlusion", each) for each in occlusion)
    if not 0.0 <= partly <= full <= 1.0:
        raise ValueError(f"occlusion must be two shares, the larger one first, got {occlusion!r}")
    last = "" if score is None else f" {number('score', score):.4f}"
    texts = {}
    for name, picture in pictures.items():
        camera = still(name, picture, "KITTI")
        if camera.projection != "perspective":
            got = f"one of the projection {camera.projection}"
            raise ValueError(f"{name}: KITTI's cameras are perspective, got {got}")
        lines = []
        for instance in picture.instances:
            edges = instance.amodal_box if box == "amodal" else instance.visible_box
            if edges is None:
                raise refused(name, instance, f"its {box} box has no pixels")
            state = _occluded(instance, full, partly)
            if math.isnan(instance.truncated):
                raise ValueError(
                    f"{name}: KITTI says how much of an object is beyond the border: of a tilted "
                    f"viewplane that is not known: object {instance.id}"
                )
            words = _class(name, instance), f"{instance.truncated:.4f}", str(state)
            place, size, turn = level.place(name, instance, length)
            alpha = _wrapped(turn - math.atan2(place[0], place[2]))
            numbers = [alpha, *_ends(edges), *size, *place, turn]
            lines.append(" ".join((*words, *(f"{each:.6f}" for each in numbers))) + last + "\n")
        texts[name] = "".join(lines)
    return texts


class _Upright:
    """The upright poses of objects, by their axes."""

    def __init__(self, forward: Axis, up: Axis, tilt_degrees: float) -> None:
        for name, axis in (("forward", forward), ("up", up)):
            one_of(name, axis, get_args(Axis))
        if forward[1] == up[1]:
            raise ValueError(f"forward and up must be different axes, got {forward} and {up}")
        if not tilt_degrees >= 0.0:
            raise ValueError(f"tilt_degrees must be zero or more, got {tilt_degrees}")
        self._forward, self._up, self._tilt = _unit(forward), _unit(up), tilt_degrees

    def place(
        self, name: str, instance: Instance, meters_each: float
    ) -> tuple[Floats, Floats, float]:
        """Return the middle of the bottom, (height, width, length), and rotation_y."""
        held = instance.box3d
        if held is None:
            raise refused(name, instance, "it is infinite, and KITTI's objects have boxes")
        pose = held.camera_from_object
        apart = rotation_and_scale(pose)
        if isinstance(apart, str):
            raise refused(name, instance, f"{apart}, and KITTI's boxes have right angles")
        rotation, _ = apart
        upwards, ahead = rotation @ self._up, rotation @ self._forward
        # The camera's y is down. By the arc tangent, which is exact at small angles.
        lean = math.degrees(math.atan2(math.hypot(upwards[0], upwards[2]), -upwards[1]))
        if lean > self._tilt:
            raise refused(
                name,
                instance,
                f"its up leans {lean:.6g} degrees away from the camera's, and KITTI's boxes stand "
                "upright: level the camera, or allow it by tilt_degrees",
            )
        across = np.abs(np.cross(self._up, self._forward))
        axes = np.stack((np.abs(self._up), across, np.abs(self._forward)))
        # In the object's frame, the middle of the box and from there down to its bottom.
        middle, half = held.in_object.mean(axis=0), 0.5 * (held.in_object[1] - held.in_object[0])
        bottom = middle - self._up * half
        place = pose[:3, :3] @ bottom + pose[:3, 3]
        turn = math.atan2(-ahead[2], ahead[0])
        return meters_each * place, meters_each * (axes @ held.size), turn


def _unit(axis: str) -> Floats:
    unit = np.zeros(3)
    unit["xyz".index(axis[1])] = 1.0 if axis[0] == "+" else -1.0
    return unit


def _class(name: str, instance: Instance) -> str:
    class_name = class_of(name, instance)
    if any(character.isspace() for character in class_name):
        raise refused(
            name, instance, f"its class {class_name!r} has a space, and columns end there"
        )
    return class_name


def _occluded(instance: Instance, full: float, partly: float) -> int:
    if instance.visible_pixels == 0:
        return 3
    share = instance.visibility
    return 0 if share >= full else 1 if share >= partly else 2


def _ends(box: BoxInPicture) -> list[int]:
    left, top, width, height = box
    return [left, top, left + width - 1, top + height - 1]


def _wrapped(angle: float) -> float:
    return math.remainder(angle, 2.0 * math.pi)
