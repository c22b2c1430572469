"""COCO's file of all frames, written as it is read: it need not fit into memory."""

from __future__ import annotations

import codecs
import json
from typing import TYPE_CHECKING, Any

from firsthit import _firsthit
from firsthit._parts.files import writing_file

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from pathlib import Path


def save_coco(
    path: Path, pictures: Callable[[], Iterator[dict[str, Any]]], classes: list[str]
) -> None:
    """Write what `firsthit.annotations.save_coco` writes of all pictures at once.

    ``pictures`` gives their fragments, as often as it is called.
    """
    numbers = {name: k for k, name in enumerate(classes, 1)}
    categories = _categories(pictures(), numbers)
    about = f"annotations of scenes by firsthit {_firsthit.version()}"
    with writing_file(path) as bytes_of_it:
        file = codecs.getwriter("utf-8")(bytes_of_it)
        file.write(f'{{"info": {_text({"description": about})}, "licenses": [], "images": ')
        _write(file, _images(pictures()))
        file.write(f', "categories": {_text(categories)}, "annotations": ')
        _write(file, _annotations(pictures(), numbers, categories))
        file.write("}\n")


def _categories(pictures: Iterable[dict[str, Any]], numbers: dict[str, int]) -> list[Any]:
    """Return all classes; those with keypoints have them from the first picture that has them."""
    known: dict[str, dict[str, Any]] = {}
    for picture in pictures:
        for one in picture["coco"]["categories"]:
            if "keypoints" not in one:
                continue
            plain = {key: value for key, value in one.items() if key != "id"}
            if known.setdefault(one["name"], plain) != plain:
                raise ValueError(f"class {one['name']!r} has other keypoints in another scene")
    return [{"id": k, **known.get(name, {"name": name})} for name, k in numbers.items()]


def _images(pictures: Iterable[dict[str, Any]]) -> Iterator[Any]:
    for number, picture in enumerate(pictures, 1):
        (image,) = picture["coco"]["images"]
        yield {**image, "id": number}


def _annotations(
    pictures: Iterable[dict[str, Any]], numbers: dict[str, int], categories: list[Any]
) -> Iterator[Any]:
    count = 0
    for number, picture in enumerate(pictures, 1):
        named = {one["id"]: one["name"] for one in picture["coco"]["categories"]}
        for one in picture["coco"]["annotations"]:
            count += 1
            k = numbers[named[one["category_id"]]]
            made = {**one, "id": count, "image_id": number, "category_id": k}
            points = categories[k - 1].get("keypoints")
            if points is not None and "keypoints" not in made:
                # The class has them elsewhere: here all are unlabelled.
                made |= {"keypoints": [0, 0, 0] * len(points), "num_keypoints": 0}
            yield made


def _write(file: codecs.StreamWriter, values: Iterable[Any]) -> None:
    file.write("[")
    for k, value in enumerate(values):
        file.write((", " if k else "") + _text(value))
    file.write("]")


def _text(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)
