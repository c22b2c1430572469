"""Annotations from the scene itself."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import flag, threads_or_all
from firsthit._files.frame import Frame
from firsthit._objects.object import chosen
from firsthit._queries.shoot import shoot_camera
from firsthit._scene.scene import Scene
from firsthit._sensors.camera import Camera
from firsthit._sensors.lines import PictureSensor, at_middle_line
from firsthit._sensors.project import camera_from_world, world_from_camera

from ._annotations import Annotations, Instance, Occlusion, Part
from ._box import boxes
from ._classes import grouped
from ._extent import Corners
from ._keypoints import points_of, seen, settled
from ._mask import Mask
from ._silhouette import silhouette, silhouette_by_lines

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import numpy.typing as npt

    from firsthit._objects.traceable import Built
    from firsthit.typing import Selection

    from ._box import Box3D
    from ._classes import By, Classes, Group
    from ._keypoints import Given, Keypoints
    from ._silhouette import Silhouette

    Floats = npt.NDArray[np.float64]
    Identifiers = npt.NDArray[np.int32]


def annotate(
    scene: Scene,
    camera: PictureSensor,
    *,
    frame: Frame | None = None,
    classes: Classes | None = None,
    by: By = "object",
    keypoints: Given | None = None,
    unseen: bool = False,
    objects: Selection | None = None,
    threads: int | None = None,
) -> Annotations:
    """Annotate a picture of a scene with what is in it, exactly.

    Every pixel is what the ray through its centre meets, as in `render` and `Scene.shoot`. The view
    of an instance alone is found by rays too, not by projecting its vertices.
    ``docs/annotations.md`` says what each number means, and what formats make of it.

    Parameters
    ----------
    scene : Scene
        The scene.
    camera : Camera, RollingShutter or Pushbroom
        The camera. A number that a moving one has not is NaN or ``None``, and its boxes in space
        are of the pose at its middle line.
    frame : Frame, optional
        The same picture with the channel ``object``, if there is one already.
    classes : mapping of str to str or None, or callable, optional
        The classes of objects. Of a mapping the keys are names of objects or their nodes, or
        patterns such as ``"car*"``; names come before patterns, and of these the first that fits
        counts. A key with a slash is compared with the paths of nodes, too. A function gets the
        `Object`. An object without a class (``None``, or no key) is no instance, but hides others.
        If left out, every object is an instance, whose class is its name.
    by : {"object", "node"} or callable
        The meaning of an instance: each object, or all objects of a node of a file. Or the objects
        for which a function of the `Object` returns the same; those for which it returns ``None``
        are of no instance.
    keypoints : mapping of str or int to Keypoints or mapping, optional
        The points of the instances of a class, by its name, or of the instance that has an object,
        by its identifier. A mapping of names to points stands for `Keypoints` in the frame of the
        object.
    unseen : bool
        Whether instances are listed that no pixel shows: what is behind others or beyond the
        border. Objects hidden by `Scene.hide` are not there at all.
    objects : int, str, or sequence of them, optional
        The objects that are there, by identifiers or names, as for `render`.
    threads : int, optional
        The number of threads; all cores if left out. The result is the same for any number.

    Returns
    -------
    Annotations
        The instances with masks, boxes, poses and keypoints, and what hides them.

    Raises
    ------
    ValueError
        For a frame of another picture or scene, or without ``object``; objects of one instance with
        different classes; keypoints of a class or an object that is of no instance.
    ValueError, IndexError, TypeError
        For ``objects``, as `Scene.shoot`.
    TypeError
        For a scene, a camera or a frame of another type.

    Examples
    --------
    >>> scene = fh.Scene()
    >>> for name, z in (("near", 1), ("far", -1)):
    ...     ball = scene.add(fh.Box((-1, -1, z), (1, 1, z + 0.5)), name=name)
    >>> camera = fh.Camera.look_at((0, 0, 6), (0, 0, 0), (0, 1, 0), 45, rows=48, columns=64)
    >>> found = fh.annotate(scene, camera, classes={"near": "box", "far": "box"}, unseen=True)
    >>> found.instances
    (Instance(0, 'near', class 'box', 676 of 676 pixels visible),
     Instance(1, 'far', class 'box', 0 of 324 pixels visible))
    >>> found.occlusions
    (Occlusion(object=0, front=0, behind=1, pixels=324),)
    """
    if not isinstance(scene, Scene) or not isinstance(camera, PictureSensor):
        raise TypeError(
            "annotate takes a Scene, and a Camera, a RollingShutter or a Pushbroom, got "
            f"{scene!r} and {camera!r}"
        )
    flag("unseen", unseen)
    whole = scene._ready()
    if objects is None:
        only = tuple(k for k, made in enumerate(whole.objects) if not made.removed)
    else:
        only = chosen(whole.objects, objects)
    built = whole.seen(None, objects)
    groups, names = grouped([(k, built.objects[k]) for k in only], classes, by)
    points = settled(keypoints)
    _check_keys(points, groups, names)
    picture = _Picture.of(built, camera, frame, groups, threads)
    corners, instances, occlusions, stands = Corners(), [], [], at_middle_line(camera)
    poses = world_from_camera(stands), camera_from_world(stands)
    for number, group in enumerate(groups):
        if not unseen and not picture.pixels[list(group.objects)].any():
            continue
        own = [built.objects[k] for k in group.objects]
        box, in_camera = boxes(own, poses, corners)
        alone = picture.alone(group, box, in_camera)
        visible, hiding = picture.visible(number, group, alone.mask)
        occlusions += hiding
        parts = tuple(
            Part(k, made.name, made.node, made.mesh_name, int(picture.pixels[k]))
            for k, made in zip(group.objects, own, strict=True)
        )
        place = own[0].transform
        wanted = points_of(points, group.objects, group.class_name)
        marks = () if wanted is None else seen(wanted, place, scene, camera, parts, only, threads)
        instances.append(
            Instance(
                number,
                group.class_name,
                parts,
                visible,
                alone.mask,
                alone.whole_pixels,
                alone.whole_box,
                alone.truncated,
                box,
                marks,
            )
        )
    made = tuple(instances), tuple(occlusions)
    return Annotations._of(camera, *made, names, picture.shown(), points)


class _Picture(NamedTuple):
    """The objects that a picture shows, and the instances that they are of."""

    built: Built
    camera: PictureSensor
    threads: int | None
    #: The object at each pixel.
    identifiers: Identifiers
    #: The instance of each object. The last place is that of a miss, which is -1.
    instance_of: Identifiers
    #: The number of pixels of each object.
    pixels: npt.NDArray[np.intp]

    @classmethod
    def of(
        cls,
        built: Built,
        camera: PictureSensor,
        frame: Frame | None,
        groups: Sequence[Group],
        threads: int | None,
    ) -> _Picture:
        """Take the objects from a frame, or shoot them."""
        if frame is None:
            identifiers = shoot_camera(built, camera, threads_or_all(threads), None).object
        else:
            identifiers = _identifiers(frame, built, camera)
        count = len(built.objects) + 1
        instance_of = np.full(count, -1, np.int32)
        for number, group in enumerate(groups):
            instance_of[list(group.objects)] = number
        pixels = np.bincount(identifiers.reshape(-1) + 1, minlength=count)[1:]
        return cls(built, camera, threads, identifiers, instance_of, pixels)

    def shown(self) -> Identifiers:
        """Return the instance at each pixel."""
        return self.instance_of[self.identifiers]

    def alone(self, group: Group, box: Box3D | None, in_camera: Floats) -> Silhouette:
        """Return the silhouette of an instance as if nothing hid it."""
        if isinstance(self.camera, Camera):
            return silhouette(self.built, self.camera, group.objects, in_camera, self.threads)
        return silhouette_by_lines(self.built, self.camera, group.objects, box, self.threads)

    def visible(self, number: int, group: Group, amodal: Mask) -> tuple[Mask, list[Occlusion]]:
        """Return the part of a silhouette that is seen, and what hides the rest."""
        identifiers = self.identifiers[amodal.part]
        visible = self.instance_of[identifiers] == number
        if np.count_nonzero(visible) != self.pixels[list(group.objects)].sum():
            raise _other(f"it shows object {group.objects[0]} where no ray meets that")
        hiding = _occlusions(number, identifiers[amodal.crop & ~visible], self.instance_of)
        mask = Mask.of(visible, shape=amodal.shape, row=amodal.row, column=amodal.column)
        return mask, hiding


def _identifiers(frame: Frame, built: Built, camera: PictureSensor) -> Identifiers:
    """Return the objects in a picture that a user gave, if it is that of the scene."""
    if not isinstance(frame, Frame):
        raise TypeError(f"frame must be a Frame, got {frame!r}")
    if frame.shape != (camera.rows, camera.columns):
        raise _other(f"it is {frame.shape}, and the camera {(camera.rows, camera.columns)}")
    if "object" not in frame:
        raise ValueError(f"frame must have the channel object, got {', '.join(frame.channels)}")
    said = frame.metadata
    if said:
        wanted = json.loads(_firsthit.origin(built.native, camera._native, ["object"]))
        for what in ("scene", "camera", "sensor"):
            if said.get(what) != wanted.get(what):
                raise _other(f"its metadata name another {what}")
    identifiers: Identifiers = frame["object"]
    if identifiers.dtype.kind not in "iu" or identifiers.ndim != 2:
        raise ValueError(f"channel object must be one integer a pixel, got {identifiers.dtype}")
    low, high = int(identifiers.min()), int(identifiers.max())
    if low < -1 or high >= len(built.objects):
        raise _other(f"its objects are {low} to {high}, and there are {len(built.objects)}")
    return identifiers.astype(np.int32, copy=False)


def _other(why: str) -> ValueError:
    return ValueError(f"frame must be a picture of this scene by this camera: {why}")


def _occlusions(behind: int, hiding: Identifiers, instance_of: Identifiers) -> list[Occlusion]:
    """Return what hides an instance; ``hiding`` are the objects in front, one for each pixel."""
    there, counts = np.unique(hiding, return_counts=True)
    found = []
    for made, pixels in zip(there.tolist(), counts.tolist(), strict=True):
        front = int(instance_of[made])
        found.append(Occlusion(made, None if front < 0 else front, behind, pixels))
    return found


def _check_keys(
    points: Mapping[str | int, Keypoints], groups: Sequence[Group], names: Sequence[str]
) -> None:
    """Refuse points that would go nowhere."""
    held = {k for group in groups for k in group.objects}
    for key in points:
        if isinstance(key, str) and key not in names:
            raise ValueError(f"keypoints must be of a class among {', '.join(names)}, got {key!r}")
        if isinstance(key, int) and key not in held:
            raise ValueError(f"keypoints must be of objects of an instance, got object {key}")
