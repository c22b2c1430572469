"""BOP's scenes: poses of rigid objects, how visible they are, and masks as PNGs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from firsthit._base.arrays import count, number
from firsthit._files.whole import write
from firsthit._sensors.project import camera_from_world, intrinsic_matrix

from ._files import (
    as_json,
    as_png,
    class_numbers,
    class_of,
    is_uniform,
    meters,
    named,
    refused,
    rotation_and_scale,
    stems,
    still,
)

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

    from ._annotations import Annotations, BoxInPicture, Instance
    from ._files import Pictures

#: How much the models of one class may differ in size, as a share, and still be one model.
_SAME_SIZE = 1e-6


def save_bop(
    folder: str | os.PathLike[str],
    pictures: Pictures,
    *,
    unit: float | str,
    object_ids: Mapping[str, int] | None = None,
    depth_scale: float = 1.0,
) -> None:
    """Write annotations of pictures as a scene of a BOP dataset.

    Into the folder go ``scene_gt.json``, ``scene_gt_info.json`` and ``scene_camera.json``, and for
    each instance a mask in ``mask`` and one in ``mask_visib``. The camera's frame is OpenCV's (x to
    the right, y down, z forwards), and so is the matrix K: the first pixel's centre is at (0, 0).
    Lengths are in millimetres. The frame of a model is that of the object.

    Parameters
    ----------
    folder : path-like
        The scene's folder, which is made.
    pictures : mapping of str to Annotations, or sequence of Annotations
        The pictures by the names of their files, which are numbers, such as ``000012.png``; of a
        sequence they count from 0.
    unit : float or str
        The length of the scene's unit: in metres, or as ``"mm"``, ``"cm"``, ``"m"``, ``"in"``, ...
    object_ids : mapping of str to int, optional
        The number of each class's model, from 1. If left out, classes count from 1.
    depth_scale : float
        The factor from the numbers of the depth pictures beside it to millimetres.

    Raises
    ------
    ValueError
        For a moving camera, and a projection without a matrix K; an instance without a class or a
        number, with an infinite silhouette, or one whose pixels beyond the border are too many to
        be counted; for a transform that shears, mirrors or scales differently along the axes; for
        models of one class whose sizes in millimetres differ; and for names that are no numbers.
    TypeError
        For pictures that are no annotations.
    FileWriteError
        If the system refuses to write a file; also an `OSError`. Others may be there then.

    Notes
    -----
    As in BOP's own tools, a box is (x, y, width, height) with x and y of the first pixel, and the
    width the difference between the last column and the first; it is -1 where no pixel is visible.
    ``bbox_obj`` and ``px_count_all`` are of the whole silhouette, also beyond the border.

    A model has the object's coordinates times the scale of the transform and the scene's unit in
    millimetres. A mesh in millimetres, placed with a scale of 0.001 in a scene in metres, is its
    own model.
    """
    millimeters = 1e3 * meters(unit)
    scale = number("depth_scale", depth_scale)
    given = named(pictures)
    numbers = class_numbers(given, None, 1) if object_ids is None else _numbers(given, object_ids)
    sizes: dict[str, float] = {}
    truth: dict[str, Any] = {}
    info: dict[str, Any] = {}
    cameras: dict[str, Any] = {}
    masks: list[tuple[str, Annotations]] = []
    for (stem, picture), name in zip(stems(given).items(), given, strict=True):
        if not (stem.isascii() and stem.isdigit()) or str(int(stem)) in truth:
            raise ValueError(f"BOP numbers its pictures: name must be a new number, got {name!r}")
        key = str(int(stem))
        held = entries(name, picture, millimeters, scale)
        refuse_sizes(held, sizes, name)
        cameras[key], info[key] = held["camera"], held["info"]
        truth[key] = [{**one, "obj_id": numbers[one["obj_id"]]} for one in held["truth"]]
        masks.append((key, picture))
    target = Path(folder)
    for key, picture in masks:
        for k, instance in enumerate(picture.instances):
            file = f"{int(key):06d}_{k:06d}.png"
            write(target / "mask" / file, as_png(instance.amodal.array))
            write(target / "mask_visib" / file, as_png(instance.visible.array))
    write(target / "scene_gt.json", as_json(truth))
    write(target / "scene_gt_info.json", as_json(info))
    write(target / "scene_camera.json", as_json(cameras))


def entries(
    name: str, picture: Annotations, millimeters: float, depth_scale: float
) -> dict[str, Any]:
    """Return a picture's entries in BOP's three files; ``obj_id`` is the class's name."""
    camera = _camera(name, picture, millimeters, depth_scale)
    truth, sizes = [], []
    for instance in picture.instances:
        pose, size = _pose(name, instance, millimeters)
        truth.append({**pose, "obj_id": class_of(name, instance)})
        sizes.append(size)
    return {
        "camera": camera,
        "truth": truth,
        "info": [_info(name, instance) for instance in picture.instances],
        "sizes": sizes,
    }


def refuse_sizes(held: Mapping[str, Any], sizes: dict[str, float], where: str) -> None:
    """Refuse models of one class that differ in size from those before."""
    for k, (one, size) in enumerate(zip(held["truth"], held["sizes"], strict=True)):
        name = one["obj_id"]
        if abs(size - sizes.setdefault(name, size)) > _SAME_SIZE * size:
            why = f"a unit of the model {name!r} is {sizes[name]} mm elsewhere, and here {size}"
            raise ValueError(f"{where}: instance {k} cannot be written: {why}")


def _numbers(pictures: Mapping[str, Annotations], object_ids: Mapping[str, int]) -> dict[str, int]:
    class_numbers(pictures, [*object_ids], 1)
    return {name: count(f"object_ids[{name!r}]", k, 1) for name, k in object_ids.items()}


def _camera(name: str, picture: Annotations, millimeters: float, scale: float) -> dict[str, Any]:
    camera = still(name, picture, "BOP")
    matrix = intrinsic_matrix(camera)
    if matrix is None:
        raise ValueError(f"{name}: a {camera.projection} camera has no matrix K for BOP")
    matrix[:2, 2] -= 0.5
    pose = camera_from_world(camera)
    return {
        "cam_K": matrix.reshape(-1).tolist(),
        "depth_scale": scale,
        "cam_R_w2c": pose[:3, :3].reshape(-1).tolist(),
        "cam_t_w2c": (millimeters * pose[:3, 3]).tolist(),
    }


def _pose(name: str, instance: Instance, millimeters: float) -> tuple[dict[str, Any], float]:
    """Return a pose, and how many millimetres the unit of the object's frame is."""
    if instance.box3d is None:
        raise refused(name, instance, "it is infinite, and BOP's objects have models")
    pose = instance.box3d.camera_from_object
    apart = rotation_and_scale(pose)
    if isinstance(apart, str):
        raise refused(name, instance, f"{apart}, and BOP's poses are rigid")
    rotation, scale = apart
    if not is_uniform(scale):
        why = f"its transform scales by {scale.tolist()}, and BOP's poses are rigid"
        raise refused(name, instance, why)
    made = {
        "cam_R_m2c": rotation.reshape(-1).tolist(),
        "cam_t_m2c": (millimeters * pose[:3, 3]).tolist(),
    }
    return made, millimeters * float(scale.mean())


def _info(name: str, instance: Instance) -> dict[str, Any]:
    whole, shown = instance.whole_pixels, instance.visible_pixels
    if whole is None:
        why = "it has no end, or too many pixels, beyond the border, which BOP counts"
        raise refused(name, instance, why)
    return {
        "bbox_obj": _box(instance.whole_box if shown else None),
        "bbox_visib": _box(instance.visible_box),
        "px_count_all": whole,
        # Every pixel of a silhouette has a depth: of the object, or of what hides it.
        "px_count_valid": instance.amodal_pixels,
        "px_count_visib": shown,
        "visib_fract": shown / whole if whole else 0.0,
    }


def _box(box: BoxInPicture | None) -> list[int]:
    if box is None:
        return [-1, -1, -1, -1]
    left, top, width, height = box
    return [left, top, width - 1, height - 1]
