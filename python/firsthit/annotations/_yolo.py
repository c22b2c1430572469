"""YOLO's labels: a text file for each picture, in shares of its width and height."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Literal, get_args

from firsthit._base.arrays import one_of
from firsthit._files.whole import write

from ._files import MaskKind, class_numbers, class_of, named, shown_mask, stems

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping, Sequence

    from ._annotations import Annotations, BoxInPicture
    from ._files import Pictures
    from ._mask import Mask

#: The thing to learn: boxes, or outlines.
Task = Literal["detect", "segment"]


def save_yolo(
    folder: str | os.PathLike[str],
    pictures: Pictures,
    *,
    validation: Pictures | None = None,
    task: Task = "detect",
    masks: MaskKind = "visible",
    classes: Sequence[str] | None = None,
) -> None:
    """Write annotations of pictures as YOLO's labels, with ``data.yaml``.

    Into the folder go ``labels/train`` with a text file for each picture, ``labels/val`` where
    there are pictures for validation, and ``data.yaml``, which names the classes and expects the
    pictures in ``images/train`` and ``images/val``. A line is the class's number, from 0, and the
    middle, width and height of the box, or the corners of the outline: all in shares of the
    picture's width and height, from its left and upper edge.

    Parameters
    ----------
    folder : path-like
        The dataset's folder, which is made.
    pictures : mapping of str to Annotations, or sequence of Annotations
        The pictures by the names of their files; of a sequence they are ``000000.png`` and so on.
    validation : mapping of str to Annotations, or sequence of Annotations, optional
        Those for validation; ``data.yaml`` names the others if left out, and says so.
    task : {"detect", "segment"}
        Whether boxes or outlines are written.
    masks : {"visible", "amodal"}
        Of which mask.
    classes : sequence of str, optional
        The classes in the order of their numbers, from 0. If left out, those of the pictures.

    Raises
    ------
    ValueError
        For an instance without a class or without a pixel of that mask, a class that is not among
        ``classes``, and names of pictures that are not those of files.
    TypeError
        For pictures that are no annotations.
    FileWriteError
        If the system refuses to write a file; also an `OSError`. Others may be there then.

    Notes
    -----
    YOLO has one outline for each instance. Holes, and parts that do not touch, are joined to it by
    slits without a width: the pixels' centres inside are those of the mask, by the even-odd rule.
    """
    one_of("task", task, get_args(Task))
    one_of("masks", masks, get_args(MaskKind))
    parts = {"train": named(pictures)}
    if validation is not None:
        parts["val"] = named(validation)
    everything = {
        f"{part}/{name}": one for part, held in parts.items() for name, one in held.items()
    }
    numbers = class_numbers(everything, classes, 0)
    contents = []
    for part, held in parts.items():
        for (stem, picture), name in zip(stems(held).items(), held, strict=True):
            text = label_lines(name, picture, numbers, task, masks)
            contents.append((Path(folder, "labels", part, f"{stem}.txt"), text))
    content = data_yaml([*numbers], has_validation="val" in parts)
    contents.append((Path(folder, "data.yaml"), content))
    for path, text in contents:
        write(path, text.encode())


def label_lines(
    name: str, picture: Annotations, numbers: Mapping[str, int], task: Task, masks: MaskKind
) -> str:
    """Return the labels of a picture, a line for each instance."""
    lines = []
    for instance in picture.instances:
        mask, box = shown_mask(name, instance, masks)
        shares = _box(mask, box) if task == "detect" else _outline(mask)
        numbered = numbers[class_of(name, instance)]
        lines.append(" ".join((str(numbered), *(f"{share:.9g}" for share in shares))) + "\n")
    return "".join(lines)


def _box(mask: Mask, box: BoxInPicture) -> list[float]:
    (rows, columns), (left, top, width, height) = mask.shape, box
    middle = (left + 0.5 * width) / columns, (top + 0.5 * height) / rows
    return [*middle, width / columns, height / rows]


def _outline(mask: Mask) -> list[float]:
    rows, columns = mask.shape
    (outline,) = mask.polygons(join=True)
    shares: list[float] = (outline / (columns, rows)).reshape(-1).tolist()
    return shares


def data_yaml(classes: list[str], *, has_validation: bool) -> str:
    """Return the file that says where the pictures are, and which classes there are."""
    lines = ["train: images/train"]
    if has_validation:
        lines.append("val: images/val")
    else:
        lines.append("val: images/train  # no other pictures were given for validation")
    # A text of JSON is one of YAML.
    lines += ["names:", *(f"  {k}: {json.dumps(name)}" for k, name in enumerate(classes))]
    return "\n".join(lines) + "\n"
