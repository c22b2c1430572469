"""The files of annotations of all frames, put together from the frames' records.

It reads a record at a time, as often as a format needs, and writes files that appear whole. So it
can be stopped, and done again, and comes to the same bytes.
"""

from __future__ import annotations

import codecs
import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from firsthit import _firsthit
from firsthit._files.whole import write
from firsthit._parts.digest import canonical
from firsthit._parts.files import link, writing_file
from firsthit._parts.part import name_of, remove_leftovers
from firsthit._parts.records import read
from firsthit.annotations._bop import refuse_sizes
from firsthit.annotations._bop_models import camera_record, models, write_models
from firsthit.annotations._classes import TOLD_OF
from firsthit.annotations._files import as_json, meters
from firsthit.annotations._yolo import data_yaml

from ._frame import depth_scale, picture_name
from ._job import merged_names
from ._sampling import Uniforms
from ._sensors import CameraSensor

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from ._plan import Plan

    #: Gives the records of all frames, in their order; can be called again.
    Records = Callable[[], Iterator[dict[str, Any]]]


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


#: The file that says that everything is there.
DONE = "dataset.json"

#: The stream of the numbers that decide which frames are for validation: behind those of sensors.
_VALIDATION = 1 << 20


def merge(folder: Path, plan: Plan, records: Records, digest: str) -> None:
    """Write what is asked for of all frames, unless it is there already."""
    done = {"plan": plan.digest, "frames": plan.frames, "digest": digest}
    done["merged"] = merged_names(plan)
    if _is_done(folder, done):
        return
    formats = plan._output.merged
    for name in merged_names(plan):
        for below, _, _ in os.walk(folder / name):
            remove_leftovers(Path(below))
    joined = _Joined(folder, plan, records)
    if formats.coco is not None:
        save_coco(folder / "coco.json", joined.pictures, joined.classes)
    if formats.bop is not None:
        joined.save_bop(formats.bop["object_ids"])
    if formats.kitti is not None:
        joined.save_kitti()
    if formats.yolo is not None:
        joined.save_yolo(formats.yolo["validation"])
    if formats.jsonl is not None:
        joined.save_lines()
    write(folder / DONE, json.dumps(done, indent=2).encode() + b"\n")


def _is_done(folder: Path, done: dict[str, Any]) -> bool:
    try:
        said = read(folder / DONE)
    except (OSError, ValueError):
        return False
    return said == done and all((folder / name).exists() for name in done["merged"])


class _Joined:
    def __init__(self, folder: Path, plan: Plan, records: Records) -> None:
        self._folder, self._plan, self._records = folder, plan, records
        self.classes: list[str] = []
        if plan._output.merged.has_classes:
            found = (name for picture in self.pictures() for name in picture["classes"])
            self.classes = [*dict.fromkeys(found)]

    def pictures(self) -> Iterator[dict[str, Any]]:
        """Yield the fragments of all pictures, by frame and then by sensor."""
        for record in self._records():
            yield from record["annotations"].values()

    def save_bop(self, object_ids: dict[str, int] | None) -> None:
        """Write a folder ``bop/NUMBER`` for each scene and camera, numbered by scene and camera."""
        numbers = object_ids or {name: k for k, name in enumerate(self.classes, 1)}
        for name in self.classes:
            if name not in numbers:
                there = ", ".join(numbers)
                raise ValueError(
                    f"output.bop: `object_ids` must have all classes, not only {there}"
                )
        sizes: dict[str, float] = {}
        scenes: dict[int, list[dict[str, Any]]] = {}
        last = -1
        for record in self._records():
            scene = self._plan.scenes.index(record["scene"])
            if scene != last:
                self._write_bop(scenes)
                scenes, last = {}, scene
            for k, (sensor, picture) in enumerate(record["annotations"].items()):
                refuse_sizes(picture["bop"], sizes, "output.bop")
                number = scene * len(record["annotations"]) + k
                kept = scenes.setdefault(number, [{}, {}, {}])
                self._add_bop(kept, number, record, sensor, numbers)
        self._write_bop(scenes)
        self._write_models(numbers)

    def _write_models(self, numbers: dict[str, int]) -> None:
        """Write ``bop/models`` and ``bop/camera.json``, of the first camera."""
        plan, output = self._plan, self._plan._output
        bop = output.merged.bop
        assert bop is not None
        millimeters = 1e3 * meters(bop["unit"])
        # Told by the check of the scenes.
        telling = TOLD_OF.set(None)
        try:
            planned = ((one.load(), one.classes, one.by) for one in plan._scenes)
            found = models(planned, millimeters, self.classes)
        finally:
            TOLD_OF.reset(telling)
        write_models(self._folder / "bop", found, numbers)
        scale = depth_scale(output)
        camera = next(one.camera for one in plan._sensors if isinstance(one, CameraSensor))
        write(self._folder / "bop" / "camera.json", as_json(camera_record(camera, scale)))

    def _add_bop(
        self,
        kept: list[dict[str, Any]],
        number: int,
        record: dict[str, Any],
        sensor: str,
        numbers: dict[str, int],
    ) -> None:
        held, index = record["annotations"][sensor]["bop"], record["pose_index"]
        truth = [{**one, "obj_id": numbers[one["obj_id"]]} for one in held["truth"]]
        parts = truth, held["info"], held["camera"]
        for table, part in zip(kept, parts, strict=True):
            table[str(index)] = part
        into, frame = self._folder / "bop" / f"{number:06d}", self._frame(record)
        for kind, name in (("amodal", "mask"), ("visible", "mask_visib")):
            (into / name).mkdir(parents=True, exist_ok=True)
            for k in range(len(truth)):
                mask = frame / f"{sensor}.{kind}" / f"{k:06d}.png"
                link(mask, into / name / f"{index:06d}_{k:06d}.png")
        for channel, name in (("color", "rgb"), ("z", "depth")):
            if channel in self._plan._output.pictures:
                picture = frame / picture_name(sensor, channel)
                link(picture, into / name / f"{index:06d}.png")

    def _write_bop(self, scenes: dict[int, list[dict[str, Any]]]) -> None:
        names = "scene_gt.json", "scene_gt_info.json", "scene_camera.json"
        for number, tables in scenes.items():
            for name, table in zip(names, tables, strict=True):
                write(self._folder / "bop" / f"{number:06d}" / name, as_json(table))

    def save_kitti(self) -> None:
        """Write ``kitti/SENSOR/label_2`` and, where colours have pictures, ``image_2``."""
        for record in self._records():
            for sensor, picture in record["annotations"].items():
                into, name = self._folder / "kitti" / sensor, self._name(record)
                write(into / "label_2" / f"{name}.txt", picture["kitti"].encode())
                self._link_colors(record, sensor, into / "image_2" / f"{name}.png")

    def save_yolo(self, validation: float) -> None:
        """Write ``yolo``: labels, pictures where colours have them, and ``data.yaml``."""
        numbers = {name: k for k, name in enumerate(self.classes)}
        into = self._folder / "yolo"
        for record in self._records():
            share = Uniforms(self._plan._seed, record["frame"], _VALIDATION).next()
            part = "val" if share < validation else "train"
            for sensor, picture in record["annotations"].items():
                name, text = f"{self._name(record)}-{sensor}", ""
                for line in picture["yolo"].splitlines():
                    number, rest = line.split(" ", 1)
                    text += f"{numbers[picture['classes'][int(number)]]} {rest}\n"
                write(into / "labels" / part / f"{name}.txt", text.encode())
                self._link_colors(record, sensor, into / "images" / part / f"{name}.png")
        content = data_yaml(self.classes, has_validation=validation > 0.0)
        write(into / "data.yaml", content.encode())

    def save_lines(self) -> None:
        """Write ``annotations.jsonl``: the record of each frame, but for its files."""
        with writing_file(self._folder / "annotations.jsonl") as file:
            for record in self._records():
                said = {key: value for key, value in record.items() if key != "files"}
                file.write(canonical(said) + b"\n")

    def _link_colors(self, record: dict[str, Any], sensor: str, path: Path) -> None:
        if "color" in self._plan._output.pictures:
            link(self._frame(record) / picture_name(sensor, "color"), path)

    def _name(self, record: dict[str, Any]) -> str:
        return name_of(record["frame"], self._plan.frames)

    def _frame(self, record: dict[str, Any]) -> Path:
        return self._folder / "frames" / self._name(record)
