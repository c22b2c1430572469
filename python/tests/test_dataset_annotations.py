"""Annotations of data sets: what is put together is what `firsthit.annotations` writes at once."""

import contextlib
import io
import json
from pathlib import Path

import firsthit as fh
import numpy as np
import pytest
from dataset_support import PLANS, plan, record, tree
from firsthit.annotations import Keypoints, save_bop, save_coco, save_kitti, save_yolo
from support import of_pycocotools

CLASSES = {"ball": "ball", "box*": "box", "post": "post"}
POINTS = {"post": Keypoints({"top": (0, 0, 1.5)}, tolerance=0.01)}

#: A second camera, level as KITTI wants it, and a second scene, with other classes.
LEVEL = {"kind": "inside", "count": 4, "low": [-3, -1, 0.5], "high": [-2, 1, 0.8], "yaw": [-20, 20]}


def two_scenes(made):
    made["poses"] = LEVEL
    made["scenes"].append(
        {"name": "again", "file": "yard.toml", "classes": {"box far": "crat\u00e9", "ball": "ball"}}
    )
    other = {"name": "other", "columns": 32, "rows": 24, "fov": 70.0, "position": [0, 0.4, 0]}
    made["sensors"].append(other)
    made["output"]["kitti"] = {"unit": "cm", "box": "visible"}
    made["output"]["coco"] = {"form": "rle"}


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    """A data set of two scenes and two cameras, and its pictures annotated one by one."""
    folder = tmp_path_factory.mktemp("both")
    fh.dataset(fh.Plan.from_dict(plan(two_scenes), PLANS), folder)
    scene, found = fh.load(PLANS / "yard.toml"), {}
    tables = [(CLASSES, POINTS), ({"box far": "crat\u00e9", "ball": "ball"}, None)]
    for frame in range(8):
        classes, points = tables[frame // 4]
        for name in ("eye", "other"):
            camera = fh.Camera.load(folder / "frames" / f"{frame:06d}" / f"{name}.npz")
            got = fh.annotate(scene, camera, classes=classes, keypoints=points)
            found[frame, name] = got
    assert sum(len(each) for each in found.values()) > 20
    return folder, found


def test_coco_is_that_of_all_pictures_at_once(both, tmp_path):
    folder, found = both
    named = {f"frames/{k:06d}/{name}.color.png": each for (k, name), each in found.items()}
    save_coco(tmp_path / "coco.json", named, form="rle")
    assert (folder / "coco.json").read_bytes() == (tmp_path / "coco.json").read_bytes()
    said = json.loads((folder / "coco.json").read_text())
    assert [each["name"] for each in said["categories"]] == ["ball", "box", "post", "crat\u00e9"]
    assert all((folder / image["file_name"]).is_file() for image in said["images"])


@of_pycocotools
def test_pycocotools_reads_the_masks_of_the_pictures(both):
    coco_module = pytest.importorskip("pycocotools.coco")
    folder, found = both
    with contextlib.redirect_stdout(io.StringIO()):
        coco = coco_module.COCO(str(folder / "coco.json"))
    assert len(coco.imgs) == len(found)
    count = 0
    for image in coco.imgs.values():
        path = Path(image["file_name"])
        picture = found[int(path.parts[1]), path.name.split(".")[0]]
        annotations = coco.imgToAnns[image["id"]]
        for one, instance in zip(annotations, picture.instances, strict=True):
            np.testing.assert_array_equal(coco.annToMask(one), instance.visible.array)
            assert coco.cats[one["category_id"]]["name"] == instance.class_name
            count += 1
    assert count > 20


def test_bop_is_that_of_each_scene_and_camera(both, tmp_path):
    folder, found = both
    numbers = {"ball": 1, "box": 2, "post": 3, "crat\u00e9": 4}
    for number, (scene, name) in enumerate([(0, "eye"), (0, "other"), (1, "eye"), (1, "other")]):
        pictures = {f"{k:06d}.png": found[4 * scene + k, name] for k in range(4)}
        into = tmp_path / f"{number:06d}"
        save_bop(into, pictures, unit="m", object_ids=numbers, depth_scale=1.0)
        made = tree(folder / "bop" / f"{number:06d}")
        pictures = {key: made.pop(key) for key in [*made] if key.startswith(("rgb", "depth"))}
        assert made == tree(into)
        frame = folder / "frames" / f"{4 * scene + 2:06d}"
        assert pictures["rgb/000002.png"] == (frame / f"{name}.color.png").read_bytes()
        assert pictures["depth/000002.png"] == (frame / f"{name}.z.png").read_bytes()


def test_bop_s_depth_scale_is_the_step_of_depth_pictures_in_millimetres(tmp_path):
    def steps(made):
        made["output"].update(png_scale=0.002, bop={"unit": "cm"})

    fh.dataset(fh.Plan.from_dict(plan(steps), PLANS), tmp_path)
    said = json.loads((tmp_path / "bop" / "000000" / "scene_camera.json").read_text())
    # A step is 0.002 cm.
    assert len(said) == 7
    for each in said.values():
        assert each["depth_scale"] == pytest.approx(0.02, rel=1e-12)


def test_kitti_is_that_of_each_camera(both, tmp_path):
    folder, found = both
    for name in ("eye", "other"):
        pictures = {f"{k:06d}.png": found[k, name] for k in range(8)}
        save_kitti(tmp_path / name, pictures, unit="cm", box="visible")
        made = tree(folder / "kitti" / name)
        colors = {key: made.pop(key) for key in [*made] if key.startswith("image_2")}
        assert made == tree(tmp_path / name)
        wanted = (folder / "frames" / "000005" / f"{name}.color.png").read_bytes()
        assert colors["image_2/000005.png"] == wanted


def test_yolo_is_that_of_pictures_for_training_and_validation(both, tmp_path):
    folder, found = both
    named = {f"{k:06d}-{name}.png": each for (k, name), each in found.items()}
    there = {path.name for path in (folder / "yolo" / "images" / "val").iterdir()}
    assert there
    assert there < named.keys()
    parts = [{key: each for key, each in named.items() if (key in there) == is_val}
             for is_val in (False, True)]  # fmt: skip
    classes = ["ball", "box", "post", "crat\u00e9"]
    save_yolo(tmp_path, parts[0], validation=parts[1], task="segment", classes=classes)
    made = tree(folder / "yolo")
    pictures = {key: made.pop(key) for key in [*made] if key.startswith("images")}
    assert made == tree(tmp_path)
    assert len(pictures) == 16
    # A frame's pictures are in one part, lest a network be tested by what it has seen.
    assert {name.replace("eye", "other") for name in there if "eye" in name} <= there


def test_masks_are_those_of_instances(both):
    folder, found = both
    said = record(folder, 1)["annotations"]["eye"]["instances"]
    assert [one["id"] for one in said] == [one.id for one in found[1, "eye"].instances]
    for k, instance in enumerate(found[1, "eye"].instances):
        path = folder / "frames" / "000001" / "eye.visible" / f"{k:06d}.png"
        mask = fh.Frame.load(path)["array"].reshape(*instance.visible.shape, -1)[..., 0]
        np.testing.assert_array_equal(mask > 0, instance.visible.array)


def test_what_is_put_together_can_be_made_again(both, tmp_path):
    made = fh.Plan.from_dict(plan(two_scenes), PLANS)
    fh.dataset(made, tmp_path)
    before = tree(tmp_path)
    (tmp_path / "coco.json").unlink()
    (tmp_path / "yolo" / "data.yaml").write_text("damaged")
    assert fh.dataset(made, tmp_path).made == 0
    assert tree(tmp_path) == before == tree(both[0])


def test_keypoints_of_a_class_that_differ_between_scenes_are_refused(tmp_path):
    def other(made):
        again = json.loads(json.dumps(made["scenes"][0]))
        again.update(name="again", keypoints={"post": {"points": {"foot": [0, 0, 0]}}})
        made["scenes"].append(again)

    with pytest.raises(ValueError, match="class 'post' has other keypoints"):
        fh.dataset(fh.Plan.from_dict(plan(other), PLANS), tmp_path)


def test_a_class_without_keypoints_in_one_scene_has_unlabelled_ones(tmp_path):
    def only_here(made):
        again = json.loads(json.dumps(made["scenes"][0]))
        del again["keypoints"]
        made["scenes"].append(again | {"name": "again"})

    fh.dataset(fh.Plan.from_dict(plan(only_here), PLANS), tmp_path)
    said = json.loads((tmp_path / "coco.json").read_text())
    posts = [one for one in said["annotations"] if one["category_id"] == 3]
    later = [one for one in posts if one["image_id"] > 7]
    assert later
    assert all(one["keypoints"] == [0, 0, 0] and one["num_keypoints"] == 0 for one in later)
    assert any(one["num_keypoints"] for one in posts)


def test_a_key_of_classes_without_an_object_is_told_once_for_each_scene(tmp_path):
    def change(made):
        (scene,) = made["scenes"]
        scene["classes"]["bal"] = "ball"
        made["scenes"].append(scene | {"name": "again"})

    made = fh.Plan.from_dict(plan(change), PLANS)
    with pytest.warns(fh.FirsthitWarning) as caught:
        assert fh.dataset(made, tmp_path).made == 14
    assert [str(each.message) for each in caught] == [
        f"scene {name!r}: classes: no object has its class by 'bal'; did you mean 'ball'?"
        for name in ("yard.toml", "again")
    ]
    assert {each.filename for each in caught} == {__file__}
