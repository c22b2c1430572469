"""Annotations from the scene: brute force object by object, closed forms, other programs."""

import math

import firsthit as fh
import numpy as np
import pytest
from firsthit._sensors.project import project
from firsthit.annotations import Keypoints
from support import TESTDATA, ball, things, turned

RNG = np.random.default_rng(11)
ROWS, COLUMNS = 60, 80
PROJECTIONS = ["perspective", "orthographic", "equirectangular"]


def crowd():
    """Things and a ground without an end."""
    scene = things(24, (-4.5, -3, -6), (4.5, 3, 3))
    scene.add(fh.Plane((0, -3.5, 0), (0, 1, 0)), name="ground")
    return scene


def seen_by(projection="perspective", ray_start="eye", position=(0.5, 0.4, 5)):
    aim, up = (-0.1, -0.05, -1), (0.1, 1, 0)
    if projection == "equirectangular":
        return fh.Camera.equirectangular(position, aim, up, ROWS, COLUMNS)
    lengths = (0.6, 0.8, 0.7) if projection == "perspective" else (0.6, 6, 5)
    return fh.Camera(position, aim, up, *lengths, ROWS, COLUMNS, projection, ray_start)


def box_of(mask):
    rows, columns = np.nonzero(mask)
    if len(rows) == 0:
        return None
    left, top = columns.min(), rows.min()
    return left, top, columns.max() + 1 - left, rows.max() + 1 - top


@pytest.mark.parametrize("projection", PROJECTIONS)
@pytest.mark.parametrize("ray_start", ["eye", "viewplane"])
def test_masks_and_boxes_are_those_of_each_object_in_a_scene_of_its_own(projection, ray_start):
    if projection == "equirectangular":
        ray_start = "eye"
    scene, camera = crowd(), seen_by(projection, ray_start)
    found = fh.annotate(scene, camera, unseen=True)
    picture = scene.shoot(camera).object
    assert [one.id for one in found.instances] == list(range(25))
    hidden_somewhere = 0
    for one, made in zip(found.instances, scene.objects, strict=True):
        alone = fh.Scene()
        alone.add(made.shape, transform=made.transform)
        amodal, visible = alone.shoot(camera).object == 0, picture == one.object
        np.testing.assert_array_equal(one.amodal.array, amodal)
        np.testing.assert_array_equal(one.visible.array, visible)
        assert one.amodal_box == box_of(amodal)
        assert one.visible_box == box_of(visible)
        assert (one.visible_pixels, one.amodal_pixels) == (visible.sum(), amodal.sum())
        assert one.parts[0].visible_pixels == visible.sum()
        if amodal.any():
            assert one.visibility == visible.sum() / amodal.sum()
        else:
            assert math.isnan(one.visibility)
        hiding = {o.object: o.pixels for o in found.occlusions if o.behind == one.id}
        objects, counts = np.unique(picture[amodal & ~visible], return_counts=True)
        assert hiding == dict(zip(objects.tolist(), counts.tolist(), strict=True))
        hidden_somewhere += len(hiding) > 0
    assert hidden_somewhere > 8
    np.testing.assert_array_equal(found.instance, picture)
    shown = fh.annotate(scene, camera)
    assert [one.id for one in shown.instances] == np.unique(picture[picture >= 0]).tolist()


@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
@pytest.mark.parametrize("ray_start", ["eye", "viewplane"])
def test_what_the_border_cuts_off_is_that_of_a_larger_picture(projection, ray_start):
    # Of all that reaches the eye's plane there is no end.
    scene, camera = crowd(), seen_by(projection, ray_start, position=(0.5, 0.4, 7))
    more = 300
    larger = fh.Camera(
        camera.position,
        camera.aim,
        camera.up,
        camera.focal_length,
        camera.width * (COLUMNS + 2 * more) / COLUMNS,
        camera.height * (ROWS + 2 * more) / ROWS,
        ROWS + 2 * more,
        COLUMNS + 2 * more,
        projection,
        ray_start,
    )
    cut = 0
    for one in fh.annotate(scene, camera, unseen=True).instances[:-1]:
        whole = scene.shoot(larger, objects=one.object).object >= 0
        assert one.whole_pixels == whole.sum()
        left, top, width, height = box_of(whole)
        assert one.whole_box == (left - more, top - more, width, height)
        assert one.truncated == (whole.sum() - one.amodal_pixels) / whole.sum()
        cut += one.truncated > 0
    assert cut > 3


def test_what_has_no_end_is_all_beyond_the_border_and_what_is_behind_is_nowhere():
    scene, camera = fh.Scene(), seen_by(position=(0, 0, 5))
    scene.add(fh.Plane((0, -1, 0), (0, 1, 0)), name="ground")
    scene.add(fh.Box((-1, -2, -3), (1, -1.5, 9)), name="past the eye")
    scene.add(fh.Sphere((0, 0, 8), 1), name="behind")
    ground, box, ball = fh.annotate(scene, camera, unseen=True).instances
    assert ground.amodal_pixels > 0
    assert (ground.whole_pixels, ground.truncated, ground.box3d) == (None, 1, None)
    assert box.amodal_pixels > 0
    assert (box.whole_pixels, box.truncated) == (None, 1)
    assert (ball.whole_pixels, ball.whole_box, ball.amodal_box) == (0, None, None)
    assert math.isnan(ball.truncated)


@pytest.mark.filterwarnings("ignore:.*between the eye and the viewplane")
def test_the_viewplane_ends_what_reaches_the_eye_and_hides_what_is_before_it():
    scene, lens = fh.Scene(), (0.5, 1, 1)
    scene.add(fh.Box((-1, -2, -3), (1, -1.5, 9)), name="past the eye")
    scene.add(fh.Box((-0.2, -0.2, 4.6), (0.2, 0.2, 4.7)), name="before the viewplane")
    scene.add(fh.Sphere((0, 0, 0), 0.5), name="ball")
    for projection in ("perspective", "orthographic"):
        aim = (0, 0, 5), (0, 0, -1), (0, 1, 0), *lens
        view, more = fh.Camera(*aim, 40, 40, projection), 400
        wide = 1 + 2 * more / 40
        larger = fh.Camera(*aim[:3], 0.5, wide, wide, 40 + 2 * more, 40 + 2 * more, projection)
        point = Keypoints({"a": (0.15, 0.05, 0.4743)}, tolerance=1e-3)
        found = fh.annotate(scene, view, unseen=True, keypoints={"ball": point})
        for one in found.instances:
            whole = scene.shoot(larger, objects=one.object).object >= 0
            assert one.whole_pixels == whole.sum()
        assert found.instances[0].whole_pixels > 0
        assert found.instances[1].whole_pixels == 0
        # What is before the viewplane is on the way from the eye, but not in the picture.
        assert found.by_name("ball").keypoints[0].visibility == 2


def test_a_huge_silhouette_is_counted_on_a_grid():
    camera = fh.Camera((0, 0, 0), (0, 0, -1), (0, 1, 0), 1, 1, 1, 100, 100, ray_start="eye")
    scene = fh.Scene()
    scene.add(fh.Sphere((0, 0, -1.001), 1))
    (ball,) = fh.annotate(scene, camera).instances
    assert (ball.amodal_pixels, ball.whole_pixels, ball.whole_box) == (10_000, None, None)
    # A circle around the middle of the picture's plane.
    radius = 100 * math.tan(math.asin(1 / 1.001))
    assert 1 - ball.truncated == pytest.approx(10_000 / (math.pi * radius**2), rel=0.05)


def test_the_visible_share_of_boxes_is_that_of_their_faces():
    # Squares of 40 and 20 pixels; the near one covers a quarter of the far one.
    camera = fh.Camera((0, 0, 10), (0, 0, -1), (0, 1, 0), 10, 80, 80, 80, 80, "orthographic", "eye")
    scene = fh.Scene()
    scene.add(fh.Box((-20, -20, -5), (20, 20, -4)), name="far")
    scene.add(fh.Box((0, 0, 0), (20, 20, 1)), name="near")
    found = fh.annotate(scene, camera)
    far, near = found.instances
    assert (far.visibility, near.visibility) == (0.75, 1)
    assert far.amodal_box == far.visible_box == (20, 20, 40, 40)
    assert near.visible_box == (40, 20, 20, 20)
    assert found.occlusions == ((1, 1, 0, 400),)
    assert found.by_name("far") is far
    with pytest.raises(KeyError, match="0 instances have the name 'ball'"):
        found.by_name("ball")


def test_a_ball_behind_a_wall_is_seen_as_far_as_the_cap_of_its_circle():
    camera = fh.Camera((0, 0, 9), (0, 0, -1), (0, 1, 0), 1, 4, 4, 800, 800, "orthographic", "eye")
    scene = ball()
    scene.add(fh.Box((0.5, -2, 2), (2, 2, 3)), name="wall")
    one = fh.annotate(scene, camera, classes={"ball": "ball"}).instances[0]
    cap = math.acos(0.5) - 0.5 * math.sqrt(0.75)
    # Less than a pixel's width around a circle of 200 pixels.
    assert one.visibility == pytest.approx(1 - cap / math.pi, abs=2e-3)
    assert one.amodal_pixels * (4 / 800) ** 2 == pytest.approx(math.pi, abs=5e-3)


def test_boxes_in_space_hold_their_objects_and_touch_them():
    scene, camera = crowd(), seen_by()
    there = fh.annotate(scene, camera, unseen=True).instances
    assert there[-1].box3d is None
    for one, made in zip(there[:-1], scene.objects, strict=False):
        alone = fh.Scene()
        alone.add(made.shape, transform=made.transform)
        box = one.box3d
        np.testing.assert_allclose(box.in_world, alone.bounds, atol=1e-12)
        np.testing.assert_array_equal(box.world_from_object, made.transform)
        own = fh.Scene()
        own.add(made.shape)
        np.testing.assert_allclose(box.in_object, own.bounds, atol=1e-12)
        # OpenCV's axes: z is what the channel says.
        z = (box.corners_in_world - camera.position) @ camera.aim
        np.testing.assert_allclose(box.corners_in_camera[:, 2], z, atol=1e-12)
        edges = box.corners_in_world[[1, 2, 4]] - box.corners_in_world[0]
        np.testing.assert_allclose(np.linalg.norm(edges, axis=1), box.size, rtol=1e-12)


def test_opencv_projects_the_corners_of_boxes_to_their_pixels():
    cv2 = pytest.importorskip("cv2")
    scene, camera = crowd(), seen_by(position=(0.5, 0.4, 9))
    k = np.array(fh.render(scene, camera, channels="z").metadata["camera"]["intrinsics"]["k"])
    k[:2, 2] -= 0.5
    for one in fh.annotate(scene, camera, unseen=True).instances[:-1]:
        box = one.box3d
        pose = box.camera_from_object
        # OpenCV takes rotations only, so the scale goes to the corners.
        scale = np.linalg.norm(pose[:3, :3], axis=0)
        turn, _ = cv2.Rodrigues(pose[:3, :3] / scale)
        pixels, _ = cv2.projectPoints(box.corners_in_object * scale, turn, pose[:3, 3], k, None)
        own = project(camera, box.corners_in_world)
        np.testing.assert_allclose(pixels[:, 0] + 0.5, own, atol=1e-6)
        # The whole silhouette is within.
        left, top, width, height = one.whole_box
        low, high = own.min(axis=0), own.max(axis=0)
        assert (low < (left + 0.5, top + 0.5)).all()
        assert (high > (left + width - 0.5, top + height - 0.5)).all()


def test_pixels_of_positions_are_the_centres_of_pixels():
    scene = crowd()
    for projection in PROJECTIONS:
        for ray_start in ("eye", "viewplane")[: 1 if projection == "equirectangular" else 2]:
            camera = seen_by(projection, ray_start)
            hits = scene.shoot(camera)
            rows, columns = np.nonzero(hits.object >= 0)
            pixels = project(camera, hits.position[rows, columns])
            np.testing.assert_allclose(pixels[:, 0], columns + 0.5, atol=1e-9)
            np.testing.assert_allclose(pixels[:, 1], rows + 0.5, atol=1e-9)
    behind = project(seen_by(), [[0, 0, 9], [np.nan, 0, 0], [0.5, 0.4, 5]])
    assert np.isnan(behind).all()


# Classes, and what is one instance.


def test_classes_come_from_names_patterns_paths_and_functions():
    scene, camera = crowd(), seen_by(position=(0, 0, 12))
    table = {"thing 1?": "tens", "thing 11": "eleven", "thing *": "thing"}
    hiding = next(one.object for one in fh.annotate(scene, camera).occlusions)
    table |= dict.fromkeys(("ground", f"thing {hiding}"))
    found = fh.annotate(scene, camera, classes=table, unseen=True)
    assert found.classes == ("tens", "eleven", "thing")
    named = {one.name: one.class_name for one in found.instances}
    assert {"ground", f"thing {hiding}"} & named.keys() == set()
    assert (named["thing 10"], named["thing 11"], named["thing 3"]) == ("tens", "eleven", "thing")
    # What has no class still hides others, and has no instance.
    assert {one.object for one in found.occlusions if one.front is None} == {hiding}
    same = fh.annotate(
        scene,
        camera,
        classes=lambda made: "solid" if isinstance(made.shape, fh.Sphere) else None,
        unseen=True,
    )
    assert [one.object for one in same.instances] == [1, 7, 13, 19]
    assert [one.id for one in same.instances] == [0, 1, 2, 3]
    assert same.classes == ("solid",)


def test_a_key_of_classes_that_no_object_has_is_told():
    scene = fh.Scene()
    scene.add(fh.Sphere((0, 0, -4), 1), name="cone")
    camera = fh.Camera.look_at((0, 0, 0), (0, 0, -1), (0, 1, 0), 45, rows=8, columns=8)
    with pytest.warns(fh.FirsthitWarning, match="by 'conee'; did you mean 'cone'"):
        found = fh.annotate(scene, camera, classes={"conee": "solid"})
    assert found.instances == ()
    fh.annotate(scene, camera, classes={"con*": "solid"})
    # What is hidden is not mistyped.
    scene.hide("cone")
    fh.annotate(scene, camera, classes={"cone": "solid"})


@pytest.mark.filterwarnings("ignore:classes. no object has its class by 'truck.'")
def test_a_class_may_be_that_of_a_node_s_path():
    leaf = fh.load(TESTDATA / "torus_meshopt.glb").objects[0]
    scene = fh.Scene()
    scene.add(leaf.shape, name="wheel")
    scene.add(leaf.shape, name="wheel", transform=turned((0, 0, 1), 0, (3, 0, 0)))
    for k, path in enumerate(("truck/wheel", "car/wheel")):
        scene._change(k, _labels=((k, path), None))
    view = fh.Camera.framing(scene, 20, 30)
    for table, expected in [
        ({"truck/*": "truck", "*": "rest"}, ["truck", "rest"]),
        ({"truck*": "truck", "wheel": "rest"}, ["rest", "rest"]),
        ({"car/wheel": "car"}, ["car"]),
    ]:
        found = fh.annotate(scene, view, classes=table).instances
        assert [one.class_name for one in found] == expected


def test_objects_of_one_node_can_be_one_instance():
    gltf = fh.load(TESTDATA / "torus_meshopt.glb")
    view = fh.Camera.framing(gltf, 60, 80)
    paths = {"node 0": "one", "*node [12]": "other"}
    tori = fh.annotate(gltf, view, by="node", classes=paths, unseen=True).instances
    assert [[part.node for part in one.parts] for one in tori] == [
        ["node 0"],
        ["node 1"],
        ["node 2"] * 4,
    ]
    assert [one.class_name for one in tori] == ["one", "other", "other"]
    assert tori[2].parts[3].mesh_name == gltf.objects[5].mesh_name == ""
    assert sum(part.visible_pixels for part in tori[2].parts) == tori[2].visible_pixels > 0

    scene, camera = crowd(), seen_by(position=(0, 0, 12))
    single = fh.annotate(scene, camera, unseen=True)
    pairs = fh.annotate(
        scene,
        camera,
        classes={"thing *": "pair"},
        by=lambda made: int(made.name.split()[1]) % 12,
        unseen=True,
    )
    assert len(pairs.instances) == 12
    for one, (a, b) in zip(
        pairs.instances,
        zip(single.instances[:12], single.instances[12:-1], strict=True),
        strict=True,
    ):
        assert [part.object for part in one.parts] == [a.object, b.object]
        np.testing.assert_array_equal(one.visible.array, a.visible.array | b.visible.array)
        np.testing.assert_array_equal(one.amodal.array, a.amodal.array | b.amodal.array)
        both = np.stack([a.box3d.in_world, b.box3d.in_world])
        np.testing.assert_allclose(one.box3d.in_world[0], both[:, 0].min(axis=0))
        np.testing.assert_allclose(one.box3d.in_world[1], both[:, 1].max(axis=0))
        np.testing.assert_array_equal(one.box3d.world_from_object, a.box3d.world_from_object)
        # The oriented box holds the corners of the other object's own.
        back = np.linalg.inv(a.box3d.world_from_object)
        points = scene.objects[b.object].transform
        if isinstance(scene.objects[b.object].shape, fh.Mesh):
            vertices = scene.objects[b.object].shape.vertices
            inner = (vertices @ points[:3, :3].T + points[:3, 3]) @ back[:3, :3].T + back[:3, 3]
            assert (inner > one.box3d.in_object[0] - 1e-12).all()
            assert (inner < one.box3d.in_object[1] + 1e-12).all()


def test_hidden_removed_and_left_out_objects_are_no_instances():
    scene, camera = crowd(), seen_by(position=(0, 0, 12))
    scene.hide("thing 3")
    scene.remove("thing 5")
    found = fh.annotate(scene, camera, unseen=True)
    assert {3, 5} & {one.object for one in found.instances} == set()
    few = fh.annotate(scene, camera, objects=["thing 1", "thing 2"], unseen=True)
    assert [one.object for one in few.instances] == [1, 2]
    picture = scene.shoot(camera, objects=[1, 2]).object
    assert [one.visible_pixels for one in few.instances] == [(picture == k).sum() for k in (1, 2)]


def test_a_frame_is_taken_if_it_is_that_picture(tmp_path):
    scene, camera = crowd(), seen_by()
    frame = fh.render(scene, camera, channels=("object", "z"))
    expected = fh.annotate(scene, camera)
    frame.save(tmp_path / "a.exr")
    own = fh.Frame(frame.shape, {"object": frame["object"].astype(np.int64)})
    for given in (frame, fh.Frame.load(tmp_path / "a.exr"), own):
        found = fh.annotate(scene, camera, frame=given)
        np.testing.assert_array_equal(found.instance, expected.instance)
    moved = seen_by(position=(0.5, 0.4, 5.1))
    with pytest.raises(ValueError, match="metadata name another camera"):
        fh.annotate(scene, moved, frame=frame)
    with pytest.raises(ValueError, match="where no ray meets that"):
        fh.annotate(scene, moved, frame=own)
    with pytest.raises(ValueError, match="must have the channel object, got z"):
        fh.annotate(scene, camera, frame=fh.render(scene, camera, channels="z"))
    with pytest.raises(ValueError, match=r"it is \(10, 80\), and the camera \(60, 80\)"):
        fh.annotate(
            scene, camera, frame=fh.render(scene, camera, channels="object", region=np.s_[:10, :])
        )
    with pytest.raises(ValueError, match="its objects are 99 to 99"):
        fh.annotate(scene, camera, frame=fh.Frame((60, 80), {"object": np.full((60, 80), 99)}))
    scene.move(0, None)
    with pytest.raises(ValueError, match="metadata name another scene"):
        fh.annotate(scene, camera, frame=frame)


def test_vertices_of_no_triangle_are_in_no_box():
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [9, 9, 9]]
    scene = fh.Scene()
    scene.add(fh.Mesh(corners, [[0, 1, 2]]))
    (one,) = fh.annotate(scene, fh.Camera.framing(scene, 10, 10)).instances
    np.testing.assert_array_equal(one.box3d.in_object, [[0, 0, 0], [1, 1, 0]])
    assert one.whole_pixels == one.amodal_pixels


def test_wrong_arguments_are_refused_by_name():
    scene, camera = crowd(), seen_by()
    for words, error, match in [
        ({"classes": ["thing"]}, TypeError, "classes must be a dict or a function"),
        ({"classes": {"thing *": ""}}, ValueError, "the name of a class must not be empty"),
        ({"by": "mesh"}, ValueError, "by must be 'object', 'node' or a function, got 'mesh'"),
        ({"keypoints": {"car": {}}}, ValueError, "keypoints must be of a class among thing 0"),
        ({"keypoints": {99: {}}}, ValueError, "keypoints must be of objects of an instance"),
        ({"keypoints": [1]}, TypeError, "keypoints must be a dict by class or object"),
        ({"frame": 1}, TypeError, "frame must be a Frame"),
        ({"unseen": 1}, TypeError, "unseen must be True or False"),
        ({"objects": "car"}, ValueError, "there is no object with the name 'car'"),
        (
            {"classes": lambda made: made.name, "by": lambda _: 0},
            ValueError,
            "objects of one instance must have one class, got 'thing 0' for object 0",
        ),
    ]:
        with pytest.raises(error, match=match):
            fh.annotate(scene, camera, **words)
