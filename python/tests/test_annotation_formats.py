"""Annotations in the forms of other programs, read back by them or by their documented rules."""

import contextlib
import io
import json
import math
import re

import firsthit as fh
import numpy as np
import pytest
from firsthit._sensors.project import in_camera, project
from firsthit.annotations import Keypoints, save_bop, save_coco, save_kitti, save_yolo, to_coco
from support import of_pycocotools, turned

CLASSES = {"car*": "car", "post": "post"}


def street(angle=0.4):
    """Two cars and a post in front of them on a ground, z up; a mat with a hole lies there too."""
    scene = fh.Scene()
    body = fh.Box((-2, -0.8, 0), (2, 0.8, 1.4))
    scene.add(body, name="car 1", transform=turned((0, 0, 1), angle, (1, 9, 0)))
    scene.add(body, name="car 2", transform=turned((0, 0, 1), -1, (-6.8, 10, 0)))
    scene.add(
        fh.Cylinder((0, 0, 0), (0, 0, 3), 0.2),
        name="post",
        transform=turned((0, 0, 1), 0, (0, 6, 0)),
    )
    scene.add(fh.Plane((0, 0, 0), (0, 0, 1)), name="ground")
    return scene


def plate():
    """A plate in two parts with a hole in one, behind a ball and a bar."""
    scene = fh.Scene()
    scene.add(fh.Box((-2, -2, -1), (2, 2, 0)), name="plate")
    scene.add(fh.Sphere((0, 0, 1), 0.5), name="ball")
    scene.add(fh.Cylinder((-3, 1.2, 1), (3, 1.2, 1), 0.1), name="bar")
    return fh.annotate(scene, fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 60, 60, 80))


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
    """Return the annotations as pycocotools reads them, which prints on standard output."""
    coco = pytest.importorskip("pycocotools.coco")
    with contextlib.redirect_stdout(io.StringIO()):
        return coco.COCO(str(path))


@of_pycocotools
@pytest.mark.parametrize("masks", ["visible", "amodal"])
@pytest.mark.parametrize("form", ["polygon", "rle"])
def test_pycocotools_reads_masks_boxes_and_areas_back(masks, form, tmp_path):
    coco, given = pytest.importorskip("pycocotools.mask"), pictures()
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
            assert one["bbox"] == coco.toBbox(read.annToRLE(one)).tolist()
            assert read.cats[one["category_id"]]["name"] == instance.class_name
            assert one["visibility"] == instance.visibility
            assert one["amodal_bbox"] == [*instance.amodal_box]
    # One car is hidden in part, so that there are two kinds of masks.
    assert any(one.visibility < 1 for one in given["000007.png"].instances)


@of_pycocotools
def test_a_mask_with_a_hole_and_parts_comes_back_through_polygons(tmp_path):
    found = plate()
    found.save_coco(tmp_path / "a.json", "a.png")
    read = loaded(tmp_path / "a.json")
    mask = found.by_name("plate").visible
    np.testing.assert_array_equal(read.annToMask(read.anns[1]), mask.array)
    # Two parts, of which one has a hole: the mask is not what is within the outlines.
    assert len(read.anns[1]["segmentation"]) == 2
    assert found.to_coco("a.png")["images"] == [
        {"id": 1, "file_name": "a.png", "width": 80, "height": 60}
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
        (pictures(), {"masks": "all"}, ValueError, "masks must be one of visible, amodal"),
        (pictures(), {"form": "png"}, ValueError, "form must be one of polygon, rle"),
        ({"a.png": 1}, {}, TypeError, "picture 'a.png' must be Annotations, got 1"),
        ("a.png", {}, TypeError, "pictures must be Annotations by file name"),
    ]:
        with pytest.raises(error, match=match):
            save_coco(tmp_path / "a.json", given, **words)
    assert not list(tmp_path.iterdir())


def test_a_file_is_replaced_whole_or_not_at_all(tmp_path):
    (tmp_path / "b.json").write_text("old and longer" * 10_000)
    (tmp_path / "b.json").chmod(0o604)
    save_coco(tmp_path / "b.json", pictures())
    assert at(tmp_path / "b.json") == to_coco(pictures())
    assert (tmp_path / "b.json").stat().st_mode & 0o777 == 0o604
    (tmp_path / "b.json").unlink()
    (tmp_path / "a.json").mkdir()
    with pytest.raises(fh.FileWriteError, match=r"a\.json"):
        save_coco(tmp_path / "a.json", pictures())
    assert [path.name for path in tmp_path.iterdir()] == ["a.json"]


# BOP.


def at(path):
    return json.loads(path.read_text())


def test_bop_s_poses_take_models_in_millimetres_to_their_pixels(tmp_path):
    cv2 = pytest.importorskip("cv2")
    given = pictures()
    save_bop(tmp_path, given, unit="m", depth_scale=0.1)
    truth, cameras = at(tmp_path / "scene_gt.json"), at(tmp_path / "scene_camera.json")
    assert [*truth] == [*cameras] == ["7", "12"]
    for key, picture in zip(truth, given.values(), strict=True):
        said, camera = cameras[key], picture.camera
        assert said["depth_scale"] == 0.1
        k = np.reshape(said["cam_K"], (3, 3))
        # The middle of 160 columns is between the numbers 79 and 80.
        assert (k[0, 2], k[1, 2]) == (79.5, 59.5)
        world = np.reshape(said["cam_R_w2c"], (3, 3)), np.array(said["cam_t_w2c"])
        point = np.array([0.3, 7, 2])
        seen = world[0] @ (1000 * point) + world[1]
        np.testing.assert_allclose(seen, 1000 * in_camera(camera, point))
        for one, instance in zip(truth[key], picture.instances, strict=True):
            assert one["obj_id"] == {"car": 1, "post": 2}[instance.class_name]
            turn, _ = cv2.Rodrigues(np.reshape(one["cam_R_m2c"], (3, 3)))
            model = 1000 * instance.box3d.corners_in_object
            place = np.array(one["cam_t_m2c"])
            pixels, _ = cv2.projectPoints(model, turn, place, k, None)
            expected = project(camera, instance.box3d.corners_in_world)
            np.testing.assert_allclose(pixels[:, 0] + 0.5, expected, atol=1e-6)


def test_bop_s_counts_and_boxes_are_those_of_a_larger_picture(tmp_path):
    cv2 = pytest.importorskip("cv2")
    given = pictures(unseen=True)
    save_bop(tmp_path, given, unit="m")
    found = at(tmp_path / "scene_gt_info.json")
    cut = 0
    for (key, held), picture, angle in zip(found.items(), given.values(), (0.4, -2), strict=True):
        scene, camera = street(angle), picture.camera
        larger = fh.Camera(
            camera.position, camera.aim, camera.up, 1, 3 * 1.6, 3 * 1.2, 360, 480, ray_start="eye"
        )
        for k, (one, instance) in enumerate(zip(held, picture.instances, strict=True)):
            whole = scene.shoot(larger, objects=instance.object).object >= 0
            inside = whole[120:240, 160:320]
            shown = scene.shoot(camera).object == instance.object
            name = f"{int(key):06d}_{k:06d}.png"
            for folder, expected in (("mask", inside), ("mask_visib", shown)):
                mask = cv2.imread(str(tmp_path / folder / name), cv2.IMREAD_UNCHANGED)
                assert mask.dtype == np.uint8
                np.testing.assert_array_equal(mask, np.where(expected, 255, 0))
            # As BOP's own tools count and measure.
            counts = whole.sum(), inside.sum(), shown.sum()
            assert (one["px_count_all"], one["px_count_valid"], one["px_count_visib"]) == counts
            assert one["visib_fract"] == shown.sum() / whole.sum()
            for box, mask, corner in (
                ("bbox_obj", whole, (160, 120)),
                ("bbox_visib", shown, (0, 0)),
            ):
                ys, xs = np.nonzero(mask)
                sides = [xs.max() - xs.min(), ys.max() - ys.min()]
                assert one[box] == [xs.min() - corner[0], ys.min() - corner[1], *sides]
            cut += inside.sum() < whole.sum()
    assert cut > 0
    assert len(list((tmp_path / "mask").iterdir())) == 6


def test_a_model_in_millimetres_may_be_scaled_to_a_scene_in_metres(tmp_path):
    scene = fh.Scene()
    mesh = fh.Box((-500, -300, 0), (500, 300, 400))
    place = turned((0, 0, 1), 0.4, (0.2, 5, 0), scale=1e-3)
    scene.add(mesh, name="car", transform=place)
    save_bop(tmp_path, fh.annotate(scene, level()), unit="m", object_ids={"car": 21})
    (one,) = at(tmp_path / "scene_gt.json")["0"]
    assert one["obj_id"] == 21
    corner = np.array([500, -300, 400])
    seen = np.reshape(one["cam_R_m2c"], (3, 3)) @ corner + one["cam_t_m2c"]
    expected = in_camera(level(), place[:3, :3] @ corner + place[:3, 3])
    np.testing.assert_allclose(seen, 1000 * expected)
    # An object that no pixel shows has no boxes.
    scene.add(fh.Box((-3, 2, 0), (3, 2.1, 3)), name="wall")
    hidden = fh.annotate(scene, level(), classes={"car": "car"}, unseen=True)
    save_bop(tmp_path, hidden, unit="m")
    (one,) = at(tmp_path / "scene_gt_info.json")["0"]
    assert one["bbox_obj"] == one["bbox_visib"] == [-1] * 4
    assert one["px_count_all"] > one["px_count_visib"] == one["visib_fract"] == 0


def one_thing(matrix, shape=None, camera=None):
    scene = fh.Scene()
    scene.add(shape or fh.Box((-1, -1, 0), (1, 1, 1)), name="thing", transform=matrix)
    return fh.annotate(scene, camera or level())


def test_what_bop_cannot_hold_is_refused_and_nothing_is_written(tmp_path):
    there = turned((0, 0, 1), 0.3, (0, 6, 0))
    sheared, mirrored, stretched = there.copy(), there.copy(), there.copy()
    sheared[0, 2] += 0.1
    mirrored[:3, 0] *= -1
    stretched[:3, 0] *= 2
    two = {"1.png": one_thing(there), "2.png": one_thing(turned((0, 0, 1), 0, (0, 6, 0), 2))}
    flat = fh.Plane((0, 0, 0), (0, 0, 1))
    near = turned((0, 0, 1), 0, (0, 0.5, 0))
    parallel = fh.Camera((0, 0, 1), (0, 1, 0), (0, 0, 1), 1, 8, 6, 12, 16, "orthographic", "eye")
    for given, words, match in [
        (one_thing(sheared), {}, "its transform shears"),
        (one_thing(mirrored), {}, "its transform mirrors"),
        (one_thing(stretched), {}, "its transform scales by"),
        (two, {}, "2.png: instance 0 .* 'thing' is 1000.0 mm elsewhere, and here 2000.0"),
        (one_thing(None, flat), {}, "it is infinite"),
        (one_thing(near), {}, "it has no end, or too many pixels, beyond the border"),
        (one_thing(there, camera=parallel), {}, "an orthographic camera has no matrix K|has no"),
        ({"a.png": one_thing(there)}, {}, "name must be a new number, got 'a.png'"),
        ({"1.png": one_thing(there), "01.png": one_thing(there)}, {}, "a new number, got '01.png'"),
        ({"b/1.png": one_thing(there)}, {}, "must be that of a file, got 'b/1.png'"),
        (one_thing(there), {"object_ids": {"car": 1}}, "its class is 'thing', not car"),
        (
            one_thing(there),
            {"object_ids": {"thing": 0}},
            r"object_ids\['thing'\] must be 1 or more",
        ),
        (one_thing(there), {"unit": "yd"}, "unit must be metres or one of mm, cm, m"),
        (one_thing(there), {"unit": 0}, "unit must be a length in metres, positive"),
    ]:
        with pytest.raises(ValueError, match=match):
            save_bop(tmp_path, given, **{"unit": "m", **words})
    assert not list(tmp_path.iterdir())


# KITTI.


def rows(path):
    return [line.split() for line in path.read_text().splitlines()]


def devkit_corners(words):
    """The box's corners in the camera's frame, as KITTI's development kit has them."""
    h, w, length = map(float, words[8:11])
    turn = float(words[14])
    x = np.array([1, 1, -1, -1, 1, 1, -1, -1]) * length / 2
    y = np.array([0, 0, 0, 0, -1, -1, -1, -1]) * h
    z = np.array([1, -1, -1, 1, 1, -1, -1, 1]) * w / 2
    c, s = math.cos(turn), math.sin(turn)
    about_y = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    return (about_y @ [x, y, z]).T + np.array(words[11:14], float)


def test_kitti_s_boxes_have_the_corners_of_ours(tmp_path):
    given = pictures()
    save_kitti(tmp_path, given, unit="m", score=0.75)
    cut = 0
    for name, picture in given.items():
        lines = rows(tmp_path / "label_2" / name.replace("png", "txt"))
        for words, instance in zip(lines, picture.instances, strict=True):
            assert (len(words), words[0], words[15]) == (16, instance.class_name, "0.7500")
            assert float(words[1]) == pytest.approx(instance.truncated, abs=1e-4)
            cut += instance.truncated > 0
            corners, own = devkit_corners(words), instance.box3d.corners_in_camera
            apart = np.linalg.norm(corners[:, None] - own, axis=-1)
            assert (apart.min(axis=1) < 1e-5).all()
            assert sorted(apart.argmin(axis=1)) == [*range(8)]
            # The first of the devkit's edges points forwards: from the back to the front.
            ahead = instance.box3d.camera_from_object[:3, 0]
            edge = corners[0] - corners[3]
            np.testing.assert_allclose(edge / np.linalg.norm(edge), ahead, atol=1e-5)
            x, _, z = map(float, words[11:14])
            alpha, turn = float(words[3]), float(words[14])
            assert -math.pi <= alpha <= math.pi
            wound = math.remainder(turn - math.atan2(x, z) - alpha, 2 * math.pi)
            assert wound == pytest.approx(0, abs=1e-5)
            ys, xs = np.nonzero(instance.amodal.array)
            ends = [xs.min(), ys.min(), xs.max(), ys.max()]
            assert [float(word) for word in words[4:8]] == ends
    assert cut > 0


def test_kitti_s_axes_units_and_boxes_are_those_that_are_asked_for(tmp_path):
    # An object with y up, whose front is -z, in millimetres.
    scene = fh.Scene()
    stand = turned((1, 0, 0), math.pi / 2, (0, 7000, 0))
    scene.add(fh.Box((-700, 0, -2000), (700, 1500, 1000)), name="Car", transform=stand)
    camera = fh.Camera((0, 0, 1500), (0, 1, 0), (0, 0, 1), 1, 1, 1, 100, 100, ray_start="eye")
    scene.add(fh.Box((0, 3000, 0), (900, 3100, 9000)), name="wall")
    found = fh.annotate(scene, camera, classes={"Car": "Car"})
    save_kitti(tmp_path, found, unit="mm", up="+y", forward="-z", box="visible")
    ((*words,),) = rows(tmp_path / "label_2" / "000000.txt")
    assert len(words) == 15
    h, w, length, x, y, z, turn = map(float, words[8:])
    assert (h, w, length) == (1.5, 1.4, 3)
    # The object's -z is the world's y: away from the camera.
    assert turn == pytest.approx(-math.pi / 2)
    assert (x, y, z) == pytest.approx((0, 1.5, 7.5))
    ys, xs = np.nonzero(found.instances[0].visible.array)
    assert [float(word) for word in words[4:8]] == [xs.min(), ys.min(), xs.max(), ys.max()]


def test_kitti_s_levels_of_occlusion_follow_the_visible_share(tmp_path):
    scene = fh.Scene()
    scene.add(fh.Box((-1, 6, 0), (1, 6.5, 1)), name="car")
    states, shares = [], []
    for x in (2, 0.9, 0.5, -0.9, -2):
        scene.remove([k for k, made in enumerate(scene.objects) if made.name == "wall"])
        scene.add(fh.Box((x, 5.9, 0), (3, 5.95, 3)), name="wall")
        found = fh.annotate(scene, level(x=0), classes={"car": "car"}, unseen=True)
        save_kitti(tmp_path, found, unit="m")
        states.append(rows(tmp_path / "label_2" / "000000.txt")[0][2])
        shares.append(found.instances[0].visibility)
    assert [share >= 0.9 for share in shares] == [True, True, False, False, False]
    assert [share >= 0.5 for share in shares] == [True, True, True, False, False]
    assert states == ["0", "0", "1", "2", "3"]


def test_what_kitti_cannot_hold_is_refused(tmp_path):
    there = turned((0, 0, 1), 0.3, (0, 6, 0))
    sheared = there.copy()
    sheared[0, 2] += 0.1
    leaning = turned((1, 0, 0), math.radians(2), (0, 6, 0))
    spaced = fh.Scene()
    spaced.add(fh.Box((-1, 5, 0), (1, 6, 1)), name="my car")
    parallel = fh.Camera((0, 0, 1), (0, 1, 0), (0, 0, 1), 1, 8, 6, 12, 16, "orthographic", "eye")
    flat = fh.Plane((0, 0, 0), (0, 0, 1))
    for given, words, match in [
        (one_thing(leaning), {}, "its up leans 2 degrees away from the camera's"),
        (one_thing(there), {"up": "-z"}, "its up leans 180 degrees"),
        (one_thing(sheared), {}, "its transform shears"),
        (one_thing(None, flat), {}, "it is infinite"),
        (fh.annotate(spaced, level()), {}, "its class 'my car' has a space"),
        (one_thing(there, camera=parallel), {}, "KITTI's cameras are perspective"),
        (one_thing(there), {"up": "z"}, "up must be one of"),
        (one_thing(there), {"up": "+x"}, "forward and up must be different axes"),
        (one_thing(there), {"box": "3d"}, "box must be one of visible, amodal"),
        (one_thing(there), {"occlusion": (0.2, 0.8)}, "occlusion must be two shares"),
        ({"a.png": one_thing(there), "a.jpg": one_thing(there)}, {}, "have their labels in 'a'"),
    ]:
        with pytest.raises(ValueError, match=match):
            save_kitti(tmp_path, given, **{"unit": "m", **words})
    assert not list(tmp_path.iterdir())
    save_kitti(tmp_path, one_thing(leaning), unit="m", tilt_degrees=5)
    assert len(rows(tmp_path / "label_2" / "000000.txt")) == 1


# YOLO.


@pytest.mark.parametrize("masks", ["visible", "amodal"])
def test_yolo_s_boxes_are_shares_of_the_picture(masks, tmp_path):
    given = pictures()
    save_yolo(tmp_path, given, masks=masks, classes=["post", "tree", "car"])
    for name, picture in given.items():
        lines = rows(tmp_path / "labels" / "train" / name.replace("png", "txt"))
        for words, instance in zip(lines, picture.instances, strict=True):
            assert words[0] == {"post": "0", "car": "2"}[instance.class_name]
            x, y, width, height = (float(word) for word in words[1:])
            box = [160 * (x - width / 2), 120 * (y - height / 2), 160 * width, 120 * height]
            mask = instance.visible if masks == "visible" else instance.amodal
            np.testing.assert_allclose(box, mask.box, atol=1e-6)


@of_pycocotools
def test_yolo_s_outlines_hold_exactly_the_mask(tmp_path):
    coco = pytest.importorskip("pycocotools.mask")
    found = plate()
    save_yolo(tmp_path, {"a.jpg": found}, validation={"a.jpg": found}, task="segment")
    for part in ("train", "val"):
        lines = rows(tmp_path / "labels" / part / "a.txt")
        for words, instance in zip(lines, found.instances, strict=True):
            outline = np.array(words[1:], float).reshape(-1, 2) * (80, 60)
            made = coco.decode(coco.frPyObjects([outline.reshape(-1).tolist()], 60, 80))
            np.testing.assert_array_equal(made[..., 0], instance.visible.array)
    said = (tmp_path / "data.yaml").read_text()
    assert said.splitlines()[:2] == ["train: images/train", "val: images/val"]
    names = re.findall(r"^  (\d): (.*)$", said, re.MULTILINE)
    assert names == [("0", '"plate"'), ("1", '"ball"'), ("2", '"bar"')]


def test_a_picture_of_nothing_has_an_empty_file_and_yolo_refuses_the_rest(tmp_path):
    empty = fh.annotate(fh.Scene(), level())
    save_yolo(tmp_path, {"a.png": empty})
    assert (tmp_path / "labels" / "train" / "a.txt").read_text() == ""
    assert "val: images/train  # no other" in (tmp_path / "data.yaml").read_text()
    (tmp_path / "new").mkdir()
    behind = street()
    behind.add(fh.Sphere((0, -9, 0), 1), name="post")
    for given, words, match in [
        (pictures(), {"task": "pose"}, "task must be one of detect, segment"),
        (pictures(), {"masks": "all"}, "masks must be one of visible, amodal"),
        (pictures(), {"classes": ["car"]}, "train/000007.png: instance 2 .* its class is 'post'"),
        (fh.annotate(behind, level(), classes=CLASSES, unseen=True), {}, "its visible mask has no"),
    ]:
        with pytest.raises(ValueError, match=match):
            save_yolo(tmp_path / "new", given, **words)
    assert not list((tmp_path / "new").iterdir())
