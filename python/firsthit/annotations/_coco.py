"""COCO's JSON: classes, pictures, and instances with boxes, masks and keypoints."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, get_args

from firsthit import _firsthit
from firsthit._base.arrays import one_of
from firsthit._files.whole import write

from ._files import MaskKind, as_json, class_numbers, class_of, named, refused, shown_mask

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping, Sequence

    from ._annotations import Annotations, Instance
    from ._files import Pictures
    from ._keypoints import Keypoints
    from ._mask import Mask

#: How a mask is written.
MaskForm = Literal["polygon", "rle"]


def to_coco(
    pictures: Pictures,
    *,
    masks: MaskKind = "visible",
    form: MaskForm = "polygon",
    classes: Sequence[str] | None = None,
) -> dict[str, Any]:
    """Return annotations of pictures in COCO's form.

    Parameters
    ----------
    pictures : mapping of str to Annotations, or sequence of Annotations
        The pictures by the names of their files; of a sequence they are ``000000.png`` and so on.
    masks : {"visible", "amodal"}
        Which masks are meant, for ``segmentation``, ``area`` and ``bbox``.
    form : {"polygon", "rle"}
        How masks are written: as polygons along the edges of pixels, or as compressed run lengths.
        pycocotools makes exactly the mask of either. A hole is joined to its surroundings by a slit
        without a width.
    classes : sequence of str, optional
        The classes in the order of their numbers, from 1. If left out, those of the pictures.

    Returns
    -------
    dict
        ``info``, ``licenses``, ``images``, ``categories`` and ``annotations``. Beside what COCO
        names, annotations have ``amodal_bbox``, ``visibility``, ``truncated`` (null where the
        lens leaves it open), ``instance`` and
        ``objects``.

    Raises
    ------
    ValueError
        For an instance without a class or without a pixel of that mask, a class that is not among
        ``classes``, and a class whose instances have different keypoints or skeletons.
    TypeError
        For pictures that are no annotations.

    Examples
    --------
    >>> scene = fh.Scene()
    >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1), name="ball")
    0
    >>> camera = fh.Camera.framing(scene, rows=30, columns=40)
    >>> coco = fh.annotations.to_coco({"ball.png": fh.annotate(scene, camera)})
    >>> coco["categories"], coco["annotations"][0]["bbox"]
    ([{'id': 1, 'name': 'ball'}], [6.0, 1.0, 28.0, 28.0])
    """
    one_of("masks", masks, get_args(MaskKind))
    one_of("form", form, get_args(MaskForm))
    given = named(pictures)
    numbers = class_numbers(given, classes, 1)
    points = _keypoints(given)
    images: list[dict[str, Any]] = []
    made: list[dict[str, Any]] = []
    for number, (name, picture) in enumerate(given.items(), 1):
        rows, columns = picture.shape
        images.append({"id": number, "file_name": name, "width": columns, "height": rows})
        for instance in picture.instances:
            mask, box = shown_mask(name, instance, masks)
            class_name = class_of(name, instance)
            record: dict[str, Any] = {
                "id": len(made) + 1,
                "image_id": number,
                "category_id": numbers[class_name],
                "iscrowd": 0,
                "segmentation": _segmentation(mask, form),
                "area": float(mask.pixels),
                "bbox": [float(edge) for edge in box],
                "amodal_bbox": [float(edge) for edge in instance.amodal_box or ()],
                "visibility": instance.visibility,
                # JSON has no NaN, which a lens with distortion has here.
                "truncated": None if math.isnan(instance.truncated) else instance.truncated,
                "instance": instance.id,
                "objects": [part.object for part in instance.parts],
            }
            if class_name in points:
                record |= _labelled(instance, points[class_name])
            made.append(record)
    return {
        "info": {"description": f"annotations of scenes by firsthit {_firsthit.version()}"},
        "licenses": [],
        "images": images,
        "categories": [_category(name, k, points.get(name)) for name, k in numbers.items()],
        "annotations": made,
    }


def save_coco(
    path: str | os.PathLike[str],
    pictures: Pictures,
    *,
    masks: MaskKind = "visible",
    form: MaskForm = "polygon",
    classes: Sequence[str] | None = None,
) -> None:
    """Write annotations of pictures to a JSON file in COCO's form, whole or not at all.

    Parameters
    ----------
    path : path-like
        The file; folders above it are made.
    pictures, masks, form, classes
        As for `to_coco`.

    Raises
    ------
    ValueError, TypeError
        As `to_coco`; nothing is written then.
    FileWriteError
        If the system refuses to write it; also an `OSError`.
    """
    content = as_json(to_coco(pictures, masks=masks, form=form, classes=classes))
    write(Path(path), content)


def _segmentation(mask: Mask, form: MaskForm) -> Any:
    if form == "rle":
        return mask.rle()
    return [polygon.reshape(-1).tolist() for polygon in mask.polygons()]


def _keypoints(pictures: Mapping[str, Annotations]) -> dict[str, Keypoints]:
    """Return the keypoints of each class that has any, which must be alike in all its instances."""
    found: dict[str, Keypoints] = {}
    for name, picture in pictures.items():
        for instance in picture.instances:
            given = picture.keypoints_of(instance)
            if given is None:
                continue
            class_name = class_of(name, instance)
            first = found.setdefault(class_name, given)
            if [*first.points] != [*given.points] or first.skeleton != given.skeleton:
                why = f"another instance of class {class_name!r} has other keypoints"
                raise refused(name, instance, why)
    return found


def _category(name: str, number: int, points: Keypoints | None) -> dict[str, Any]:
    category: dict[str, Any] = {"id": number, "name": name}
    if points is not None:
        names = [*points.points]
        category["keypoints"] = names
        # Counted from 1.
        category["skeleton"] = [[names.index(end) + 1 for end in line] for line in points.skeleton]
    return category


def _labelled(instance: Instance, points: Keypoints) -> dict[str, Any]:
    """Return the keypoints of an instance; all are unlabelled where it has none."""
    numbers: list[float] = []
    for point in instance.keypoints:
        if point.visibility == 0:
            numbers += [0, 0, 0]
        else:
            # COCO counts the middle of the first pixel as 0.
            numbers += [point.pixel[0] - 0.5, point.pixel[1] - 0.5, point.visibility]
    if not instance.keypoints:
        numbers = [0, 0, 0] * len(points.points)
    labelled = sum(point.visibility > 0 for point in instance.keypoints)
    return {"keypoints": numbers, "num_keypoints": labelled}
