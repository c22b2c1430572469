"""Annotations in the forms of other programs, read back by them or by their documented rules."""

import contextlib
import io
import json

import firsthit as fh
import numpy as np
import pytest
from firsthit.annotations import Keypoints, save_coco, to_coco
from test_annotations import COLUMNS, ROWS, of_pycocotools, seen_by, turned

CLASSES = {"car*": "car", "post": "post"}


def street(angle=0.4):
    """Two cars and a post in front of them on a ground, z up; a mat with a hole lies there too."""
    scene = fh.Scene()
    body = fh.Box((-2, -0.8, 0), (2, 0.8, 1.4))
    scene.add(body, name="car 1", transform=turned((0, 0, 1), angle, (1, 9, 0)))
    scene.add(body, name="car 2", transform=turned((0, 0, 1), -1, (-4.5, 12, 0)))
    scene.add(
        fh.Cylinder((0, 0, 0), (0, 0, 3), 0.2),
        name="post",
        transform=turned((0, 0, 1), 0, (0, 6, 0)),
    )
    scene.add(fh.Plane((0, 0, 0), (0, 0, 1)), name="ground")
    return scene


def level(rows=120, columns=160, x=0.3):
    """A camera at a height of 1.5, as on a car's roof."""
    return fh.Camera((x, 0, 1.5), (0, 1, 0), (0, 0, 1), 1, 1.6, 1.2, rows, columns, ray_start="eye")


def pictures(**words):
    """Two pictures of the street, from two places."""
    words = {"classes": CLASSES, **words}
    return {
        "000007.png": fh.annotate(street(), level(), **words),
        "000012.png": fh.annotate(street(-2), level(x=-1), **words),
    }


def loaded(path):
    """What pycocotools reads, which says so on standard output."""
    coco = pytest.importorskip("pycocotools.coco")
    with contextlib.redirect_stdout(io.StringIO()):
        return coco.COCO(str(path))


@of_pycocotools
@pytest.mark.parametrize("masks", ["visible", "amodal"])
@pytest.mark.parametrize("form", ["polygon", "rle"])
def test_pycocotools_reads_masks_boxes_and_areas_back(masks, form, tmp_path):
    given = pictures()
    save_coco(tmp_path / "new" / "all.json", given, masks=masks, form=form)
    read = loaded(tmp_path / "new" / "all.json")
    assert [one["name"] for one in read.loadCats(read.getCatIds())] == ["car", "post"]
    assert [one["file_name"] for one in read.loadImgs(read.getImgIds())] == [*given]
    for number, picture in enumerate(given.values(), 1):
        assert read.imgs[number]["height"] == 120
        assert read.imgs[number]["width"] == 160
        found = read.loadAnns(read.getAnnIds(imgIds=[number], iscrowd=False))
        assert len(found) == len(picture.instances) == 3
        for one, instance in zip(found, picture.instances, strict=True):
            mask = instance.visible if masks == "visible" else instance.amodal
            made = read.annToMask(one)
            np.testing.assert_array_equal(made, mask.array)
            assert one["area"] == made.sum()
            from pycocotools import mask as coco_mask

            assert one["bbox"] == coco_mask.toBbox(read.annToRLE(one)).tolist()
            assert read.cats[one["category_id"]]["name"] == instance.class_name
            assert one["visibility"] == instance.visibility
            assert one["amodal_bbox"] == [*instance.amodal_box]
    # One car is hidden in part, so that there are two kinds of masks.
    assert any(one.visibility < 1 for one in given["000007.png"].instances)


@of_pycocotools
def test_a_mask_with_a_hole_and_parts_comes_back_through_polygons(tmp_path):
    scene, camera = fh.Scene(), seen_by(position=(0, 0, 5))
    scene.add(fh.Box((-2, -2, -1), (2, 2, 0)), name="plate")
    scene.add(fh.Sphere((0, 0, 1), 0.5), name="ball")
    scene.add(fh.Cylinder((-3, 1.2, 1), (3, 1.2, 1), 0.1), name="bar")
    found = fh.annotate(scene, camera)
    found.save_coco(tmp_path / "a.json", "a.png")
    read = loaded(tmp_path / "a.json")
    plate = found.by_name("plate")
    np.testing.assert_array_equal(read.annToMask(read.anns[1]), plate.visible.array)
    # Two parts, of which one has a hole: the mask is not what is within the outlines.
    assert len(read.anns[1]["segmentation"]) == 2
    assert found.to_coco("a.png")["images"] == [
        {"id": 1, "file_name": "a.png", "width": COLUMNS, "height": ROWS}
    ]


@of_pycocotools
def test_pycocotools_evaluates_our_masks_as_their_own(tmp_path):
    evaluation = pytest.importorskip("pycocotools.cocoeval")
    save_coco(tmp_path / "all.json", pictures(), form="rle")
    read = loaded(tmp_path / "all.json")
    results = [
        {k: one[k] for k in ("image_id", "category_id", "segmentation", "bbox")} | {"score": 0.9}
        for one in read.anns.values()
    ]
    with contextlib.redirect_stdout(io.StringIO()):
        done = evaluation.COCOeval(read, read.loadRes(results), "segm")
        done.evaluate()
        done.accumulate()
        done.summarize()
    assert done.stats[0] == pytest.approx(1)


def test_keypoints_are_written_for_all_instances_of_their_class(tmp_path):
    car = Keypoints(
        {"front": (2, 0, 0.7), "back": (-2, 0, 0.7), "roof": (0, 0, 1.4), "lost": [np.nan] * 3},
        skeleton=[("front", "roof"), ("roof", "back")],
    )
    given = pictures(keypoints={"car": car})
    save_coco(tmp_path / "all.json", given)
    read = loaded(tmp_path / "all.json")
    category, post = read.loadCats([1, 2])
    assert category["keypoints"] == ["front", "back", "roof", "lost"]
    assert category["skeleton"] == [[1, 3], [3, 2]]
    assert "keypoints" not in post
    states = []
    for number, picture in enumerate(given.values(), 1):
        found = read.loadAnns(read.getAnnIds(imgIds=[number]))
        for one, instance in zip(found, picture.instances, strict=True):
            if instance.class_name == "post":
                assert "keypoints" not in one
                continue
            numbers = np.array(one["keypoints"]).reshape(-1, 3)
            assert one["num_keypoints"] == (numbers[:, 2] > 0).sum()
            for (x, y, state), point in zip(numbers, instance.keypoints, strict=True):
                states.append(state)
                assert state == point.visibility
                if state == 0:
                    assert (x, y) == (0, 0)
                else:
                    # COCO counts the middle of the first pixel as 0.
                    np.testing.assert_allclose((x + 0.5, y + 0.5), point.pixel)
    assert {0, 1, 2} == set(states)


def test_classes_keep_the_numbers_that_are_asked_for():
    asked = to_coco(pictures(), classes=["post", "tree", "car"])
    assert [(one["id"], one["name"]) for one in asked["categories"]] == [
        (1, "post"),
        (2, "tree"),
        (3, "car"),
    ]
    assert [one["category_id"] for one in asked["annotations"]] == [3, 3, 1] * 2
    json.dumps(asked, allow_nan=False)


def test_what_coco_cannot_hold_is_refused(tmp_path):
    scene, camera = street(), level()
    scene.add(fh.Sphere((0, -9, 0), 1), name="post")
    behind = fh.annotate(scene, camera, classes=CLASSES, unseen=True)
    nameless = fh.Scene()
    nameless.add(fh.Sphere((0, 9, 0), 1))
    mixed = {0: {"a": (0, 0, 0)}, 1: {"b": (0, 0, 0)}}
    for given, words, error, match in [
        (behind, {}, ValueError, r"instance 3 \('post'\) cannot be written: its visible mask has"),
        (behind, {"masks": "amodal"}, ValueError, "its amodal mask has no pixels"),
        (fh.annotate(nameless, camera), {}, ValueError, "instance 0 cannot .* it has no class"),
        (pictures(), {"classes": ["car"]}, ValueError, "its class is 'post', not car"),
        (pictures(), {"classes": ["car", "car"]}, ValueError, "must be different names"),
        (pictures(keypoints=mixed), {}, ValueError, "another instance of class 'car' has other"),
        (pictures(), {"masks": "all"}, ValueError, "masks must be 'visible' or 'amodal'"),
        (pictures(), {"form": "png"}, ValueError, "form must be 'polygon' or 'rle'"),
        ({"a.png": 1}, {}, TypeError, "picture 'a.png' must be Annotations, got 1"),
        ("a.png", {}, TypeError, "pictures must be Annotations by file name"),
    ]:
        with pytest.raises(error, match=match):
            save_coco(tmp_path / "a.json", given, **words)
    assert not list(tmp_path.iterdir())


def test_a_file_that_cannot_be_written_leaves_the_old_one(tmp_path):
    (tmp_path / "a.json").mkdir()
    with pytest.raises(fh.FileWriteError, match=r"a\.json"):
        save_coco(tmp_path / "a.json", pictures())
    assert [path.name for path in tmp_path.iterdir()] == ["a.json"]
