"""Shared parts of the formats: pictures by name, classes by number, rigid poses."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from firsthit._base.arrays import number, text
from firsthit._files import png
from firsthit._sensors.camera import Camera

from ._annotations import Annotations

if TYPE_CHECKING:
    import numpy.typing as npt

    from ._annotations import BoxInPicture, Instance
    from ._mask import Mask

    Floats = npt.NDArray[np.float64]


#: Pictures by the names of their files, or in an order that numbers them; or one.
Pictures = Mapping[str, Annotations] | Sequence[Annotations] | Annotations

#: Which of an instance's masks is meant.
MaskKind = Literal["visible", "amodal"]

#: Units by name, in metres.
_UNITS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "km": 1e3, "in": 0.0254, "ft": 0.3048}


def named(pictures: Pictures) -> dict[str, Annotations]:
    """Return pictures by the names of their files: ``000000.png`` and so on if they have none."""
    if isinstance(pictures, Annotations):
        pictures = [pictures]
    if isinstance(pictures, Mapping):
        made = {text("the name of a picture", name): one for name, one in pictures.items()}
    elif isinstance(pictures, Sequence) and not isinstance(pictures, str | bytes):
        made = {f"{k:06d}.png": one for k, one in enumerate(pictures)}
    else:
        raise TypeError(f"pictures must be Annotations by file name, got {pictures!r}")
    for name, one in made.items():
        if not isinstance(one, Annotations):
            raise TypeError(f"picture {name!r} must be Annotations, got {one!r}")
    return made


def stems(pictures: Mapping[str, Annotations]) -> dict[str, Annotations]:
    """Return pictures by the names of the files of their labels, without extension."""
    made: dict[str, Annotations] = {}
    for name, one in pictures.items():
        path = Path(name)
        if len(path.parts) != 1 or not path.stem:
            raise ValueError(f"the name of a picture must be that of a file, got {name!r}")
        if path.stem in made:
            raise ValueError(f"two pictures would have their labels in {path.stem!r}")
        made[path.stem] = one
    return made


def class_numbers(
    pictures: Mapping[str, Annotations], classes: Sequence[str] | None, first: int
) -> dict[str, int]:
    """Return the number of each class, from ``first`` on.

    Without ``classes`` they are in the order in which the pictures have them.
    """
    if classes is None:
        found = dict.fromkeys(name for one in pictures.values() for name in one.classes)
    else:
        found = dict.fromkeys(text("the name of a class", name) for name in classes)
        if len(found) != len(classes):
            raise ValueError(f"classes must be different names, got {list(classes)}")
    for name, one in pictures.items():
        for instance in one.instances:
            class_of(name, instance)
            if instance.class_name not in found:
                there = ", ".join(found)
                raise refused(name, instance, f"its class is {instance.class_name!r}, not {there}")
    return {name: first + k for k, name in enumerate(found)}


def class_of(picture: str, instance: Instance) -> str:
    """Return the class of an instance, which every format wants."""
    if instance.class_name is None:
        raise refused(picture, instance, "it has no class: annotate with classes=")
    return instance.class_name


def refused(picture: str, instance: Instance, why: str) -> ValueError:
    """Return the error for an instance that a format cannot hold."""
    what = f"instance {instance.id}" + (f" ({instance.name!r})" if instance.name else "")
    return ValueError(f"{picture}: {what} cannot be written: {why}")


def shown_mask(picture: str, instance: Instance, kind: MaskKind) -> tuple[Mask, BoxInPicture]:
    """Return a mask of an instance and its box, which formats want."""
    mask = instance.visible if kind == "visible" else instance.amodal
    if mask.box is None:
        raise refused(picture, instance, f"its {kind} mask has no pixels")
    return mask, mask.box


def still(picture: str, annotations: Annotations, form: str) -> Camera:
    """Return the camera of a picture, for formats that have one pose for all of it."""
    if not isinstance(annotations.camera, Camera):
        kind = type(annotations.camera).__name__
        raise ValueError(f"{picture}: {form} has one pose for a picture, and a {kind} many")
    return annotations.camera


def meters(unit: float | str) -> float:
    """Return how many metres the scene's unit is."""
    if isinstance(unit, str):
        if unit not in _UNITS:
            raise ValueError(f"unit must be metres or one of {', '.join(_UNITS)}, got {unit!r}")
        return _UNITS[unit]
    length = number("unit", unit)
    if not 0.0 < length < float("inf"):
        raise ValueError(f"unit must be a length in metres, positive, got {length}")
    return length


def as_json(value: Any) -> bytes:
    """Return a value as JSON, which has no NaN."""
    return json.dumps(value, ensure_ascii=False, allow_nan=False).encode() + b"\n"


def as_png(mask: npt.NDArray[np.bool_]) -> bytes:
    """Return a mask as a PNG of one channel of 8 bits: 255 where it is true."""
    return png.as_png(mask.astype(np.uint8) * np.uint8(255))


#: By how much axes may be off a right angle, or lengths differ, and still be rounding.
_ROUNDING = 1e-9


def rotation_and_scale(pose: Floats) -> tuple[Floats, Floats] | str:
    """Take a pose apart: a rotation, (3, 3), after a scale along the object's axes, (3,).

    Return why that cannot be, where it cannot.
    """
    scale = np.linalg.norm(pose[:3, :3], axis=0)
    rotation = pose[:3, :3] / scale
    if np.abs(rotation.T @ rotation - np.eye(3)).max() > _ROUNDING:
        return "its transform shears"
    if np.linalg.det(rotation) < 0.0:
        return "its transform mirrors"
    return rotation, scale


def is_uniform(scale: Floats) -> bool:
    """Tell whether a scale is the same along all axes."""
    return bool(scale.max() - scale.min() <= _ROUNDING * scale.max())
