"""Annotations: instances, and the pictures that they are in."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from ._keypoints import points_of

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

    import numpy as np
    import numpy.typing as npt

    from firsthit._sensors.lines import PictureSensor

    from ._box import Box3D
    from ._coco import MaskForm
    from ._files import MaskKind
    from ._keypoints import Keypoint, Keypoints
    from ._mask import Mask

    BoxInPicture = tuple[int, int, int, int]


class Part(NamedTuple):
    """An object of an instance.

    Attributes
    ----------
    object : int
        Its identifier in the scene.
    name : str
        Its name; may be empty.
    node : str or None
        The path of the file's node that it comes from, as `Object.node`.
    mesh_name : str or None
        The name of the file's mesh that it is, or is a part of, as `Object.mesh_name`.
    visible_pixels : int
        The number of pixels that show it.
    """

    object: int
    name: str
    node: str | None
    mesh_name: str | None
    visible_pixels: int


class Occlusion(NamedTuple):
    """The occlusion of an instance by another object.

    Attributes
    ----------
    object : int
        The object that is seen in the instance's place.
    front : int or None
        The instance that it belongs to; ``None`` if it is of none.
    behind : int
        The instance that would be seen if it were alone.
    pixels : int
        The number of pixels where that is so.
    """

    object: int
    front: int | None
    behind: int
    pixels: int


@dataclass(frozen=True, eq=False)
class Instance:
    """One thing in a picture, of one object or several.

    Attributes
    ----------
    id : int
        Its number among all instances of the scene, seen or not, from 0. It is the same in other
        pictures of the scene with the same classes.
    class_name : str or None
        Its class; ``None`` where no classes are given and its first object has no name.
    parts : tuple of Part
        Its objects, in the order of their identifiers.
    visible : Mask
        The pixels that show it.
    amodal : Mask
        The pixels that would show it if nothing else were in the scene.
    whole_pixels : int or None
        As many as the amodal mask would have if the picture went on beyond its border. ``None``
        where there is no end to them, and where they are too many to be asked for one by one.
    whole_box : tuple of int, or None
        The least box around these, as `amodal_box`; it may be beyond the picture.
    truncated : float
        The share of these that are beyond the border, from 0 to 1. It is 1 where there is no end to
        them, as for what reaches the plane of the eye, and NaN where there are none. Where more
        than a million pixels would have to be asked, it is that of a regular grid of them. NaN also
        for a moving camera, which has no lines beyond the border.
    box3d : Box3D or None
        The boxes in space, with the pose; ``None`` for what is infinite.
    keypoints : tuple of Keypoint
        Its points, in the order in which they were given.
    """

    id: int
    class_name: str | None
    parts: tuple[Part, ...]
    visible: Mask
    amodal: Mask
    whole_pixels: int | None
    whole_box: BoxInPicture | None
    truncated: float
    box3d: Box3D | None
    keypoints: tuple[Keypoint, ...]

    @property
    def object(self) -> int:
        """The identifier of its first object."""
        return self.parts[0].object

    @property
    def name(self) -> str:
        """The name of its first object; may be empty."""
        return self.parts[0].name

    @property
    def visible_box(self) -> BoxInPicture | None:
        """The least box around the pixels that show it; ``None`` if none does.

        Left and upper edge, width and height, in columns from the picture's left edge and rows from
        its upper edge.
        """
        return self.visible.box

    @property
    def amodal_box(self) -> BoxInPicture | None:
        """The least box around the pixels that would show it alone, as `visible_box`."""
        return self.amodal.box

    @property
    def visible_pixels(self) -> int:
        """The number of pixels that show it."""
        return self.visible.pixels

    @property
    def amodal_pixels(self) -> int:
        """The number of pixels that would show it alone."""
        return self.amodal.pixels

    @property
    def visibility(self) -> float:
        """The share of its amodal pixels that show it; NaN if there are none."""
        return self.visible_pixels / self.amodal_pixels if self.amodal_pixels else math.nan

    def __repr__(self) -> str:
        return (
            f"Instance({self.id}, {self.name!r}, class {self.class_name!r}, "
            f"{self.visible_pixels:,} of {self.amodal_pixels:,} pixels visible)"
        )


class Annotations:
    """The instances in one picture of a scene, as `annotate` finds them.

    Attributes
    ----------
    camera : Camera, RollingShutter or Pushbroom
        The camera.
    shape : pair of int
        Rows and columns.
    instances : tuple of Instance
        In the order of their first objects.
    occlusions : tuple of Occlusion
        The objects that hide these, in the order of what is behind, then of the objects in front.
    classes : tuple of str
        All classes: those of the table in its order, or else those of the scene's instances.
    instance : (rows, columns) array of int32
        The instance that each pixel shows, by its ``id``; -1 where there is none. Read-only.
    keypoints : dict
        The points that were asked for, by class or object.
    """

    camera: PictureSensor
    shape: tuple[int, int]
    instances: tuple[Instance, ...]
    occlusions: tuple[Occlusion, ...]
    classes: tuple[str, ...]
    instance: npt.NDArray[np.int32]
    keypoints: Mapping[str | int, Keypoints]

    def __init__(self) -> None:
        raise TypeError("Annotations are made by annotate")

    @classmethod
    def _of(
        cls,
        camera: PictureSensor,
        instances: tuple[Instance, ...],
        occlusions: tuple[Occlusion, ...],
        classes: tuple[str, ...],
        instance: npt.NDArray[np.int32],
        keypoints: Mapping[str | int, Keypoints],
    ) -> Annotations:
        made = cls.__new__(cls)
        made.camera, made.shape = camera, (camera.rows, camera.columns)
        made.instances, made.occlusions = instances, occlusions
        made.classes, made.instance, made.keypoints = classes, instance, keypoints
        instance.flags.writeable = False
        return made

    def by_name(self, name: str) -> Instance:
        """Return the instance whose first object has a name.

        Parameters
        ----------
        name : str
            The name.

        Returns
        -------
        Instance
            The only one.

        Raises
        ------
        KeyError
            If none has that name, or several.
        """
        found = [one for one in self.instances if one.name == name]
        if len(found) != 1:
            there = ", ".join(dict.fromkeys(repr(one.name) for one in self.instances))
            raise KeyError(f"{len(found)} instances have the name {name!r}; there are {there}")
        return found[0]

    def keypoints_of(self, instance: Instance) -> Keypoints | None:
        """Return what was given as the points of an instance; ``None`` if nothing was."""
        objects = [part.object for part in instance.parts]
        return points_of(self.keypoints, objects, instance.class_name)

    def to_coco(
        self,
        file_name: str = "000000.png",
        *,
        masks: MaskKind = "visible",
        form: MaskForm = "polygon",
    ) -> dict[str, Any]:
        """Return the annotations in COCO's form, as `to_coco` does for several pictures.

        Parameters
        ----------
        file_name : str
            The picture's file.
        masks, form
            As for `to_coco`.

        Returns
        -------
        dict
            The content of COCO's JSON.

        Raises
        ------
        ValueError
            As `to_coco`.
        """
        from ._coco import to_coco

        return to_coco({file_name: self}, masks=masks, form=form)

    def save_coco(
        self,
        path: str | os.PathLike[str],
        file_name: str = "000000.png",
        *,
        masks: MaskKind = "visible",
        form: MaskForm = "polygon",
    ) -> None:
        """Write the annotations in COCO's form, as `save_coco` does for several pictures.

        Parameters
        ----------
        path : path-like
            The JSON file.
        file_name, masks, form
            As for `to_coco`.

        Raises
        ------
        ValueError, FileWriteError
            As `save_coco`.
        """
        from ._coco import save_coco

        save_coco(path, {file_name: self}, masks=masks, form=form)

    def __len__(self) -> int:
        return len(self.instances)

    def __repr__(self) -> str:
        rows, columns = self.shape
        return f"Annotations({columns} x {rows} pixels, {len(self.instances)} instances)"
