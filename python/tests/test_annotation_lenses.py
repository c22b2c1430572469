"""Annotations and flow with every projection, and with viewplanes that are not in the middle."""

import json
import math

import firsthit as fh
import numpy as np
import pytest
from firsthit.annotations import Keypoints, save_bop, save_kitti
from support import ball, things

ROWS, COLUMNS = 48, 72
POSE = (0.5, 0.4, 6), (-0.1, -0.05, -1), (0.1, 1, 0)
K = {"fx": 60, "fy": 55, "cx": 30, "cy": 26, "skew": 0}
FLAT = {
    "shifted": ("perspective", {"shift_x": 0.3, "shift_y": -0.2}),
    "skewed": ("perspective", {"skew": 0.2, "shift_x": 0.1}),
    "shifted parallel": ("orthographic", {"shift_x": 1.5, "shift_y": -1}),
}
OTHERS = {
    "tilted": ("perspective", {"tilt_x": 12, "tilt_y": -9}),
    "skewed parallel": ("orthographic", {"skew": 0.2}),
    "opencv": ("opencv", {**K, "k1": -0.1, "p1": 0.01}),
    "opencv_fisheye": ("opencv_fisheye", {**K, "k1": 0.01}),
    "fov": ("fov", {**K, "omega": 0.9}),
    "thin_prism_fisheye": ("thin_prism_fisheye", {**K, "k1": 0.01, "sx1": 0.01}),
    "equidistant": ("equidistant", {**K, "fov": 120}),
    "cylindrical": ("cylindrical", {"horizontal_fov": 150, "vertical_fov": 60}),
    "part of a panorama": ("equirectangular", {"horizontal_fov": 180, "vertical_fov": 90}),
    "octahedral": ("octahedral", {}),
}


def camera(name, ray_start="eye", rows=ROWS, columns=COLUMNS, grown=1.0):
    projection, parameters = {**FLAT, **OTHERS}[name]
    if projection == "perspective":
        lengths = 0.8, 1.2 * grown, 0.8 * grown
    elif projection == "orthographic":
        lengths = 0.8, 6 * grown, 4 * grown
    else:
        lengths, ray_start = (None, None, None), "eye"
    if projection == "octahedral":
        columns = rows
    return fh.Camera(*POSE, *lengths, rows, columns, projection, ray_start, parameters)


@pytest.mark.parametrize("ray_start", ["eye", "viewplane"])
@pytest.mark.parametrize("name", [*FLAT, *OTHERS])
def test_masks_are_those_of_each_object_alone_and_nothing_flows(name, ray_start):
    scene, view = things(18, (-4, -3, -6), (4, 3, 3)), camera(name, ray_start)
    picture = scene.shoot(view).object
    assert (picture >= 0).sum() > 30
    for one in fh.annotate(scene, view, unseen=True).instances:
        amodal = scene.shoot(view, objects=one.object).object >= 0
        np.testing.assert_array_equal(one.amodal.array, amodal)
        np.testing.assert_array_equal(one.visible.array, picture == one.object)
        if name == "octahedral":
            assert one.whole_pixels == amodal.sum()
        elif name in OTHERS:
            assert one.whole_pixels is None
            assert math.isnan(one.truncated)
    found = fh.optical_flow(scene, view, scene, view)
    np.testing.assert_allclose(found.flow[picture >= 0], 0, atol=1e-6)
    assert not found.occluded.any()
    assert not found.outside.any()


@pytest.mark.parametrize("ray_start", ["eye", "viewplane"])
@pytest.mark.parametrize("name", FLAT)
def test_what_the_border_cuts_off_is_that_of_a_larger_picture(name, ray_start):
    scene, view = things(18, (-4, -3, -6), (4, 3, 3)), camera(name, ray_start)
    more = 5
    larger = camera(name, ray_start, more * ROWS, more * COLUMNS, more)
    top, left = (more - 1) * ROWS // 2, (more - 1) * COLUMNS // 2
    cut = 0
    for one in fh.annotate(scene, view, unseen=True).instances:
        whole = scene.shoot(larger, objects=one.object).object >= 0
        assert one.whole_pixels == whole.sum()
        cut += one.whole_pixels > one.amodal_pixels
        if whole.any():
            ys, xs = np.nonzero(whole)
            assert one.whole_box[:2] == (xs.min() - left, ys.min() - top)
    assert cut > 2


@pytest.mark.parametrize("name", ["shifted", "tilted"])
def test_lines_of_sight_begin_on_the_viewplane(name):
    view = camera(name, "viewplane")
    origins, directions = view.rays()
    start, way = origins[20, 30], directions[20, 30]
    scene = fh.Scene()
    scene.add(fh.Sphere(start + 3 * way, 0.5), name="ball")
    # Between the eye and the viewplane, and just behind that.
    scene.add(fh.Sphere(start - 0.2 * way, 0.05), name="fly")
    point = {"ball": Keypoints({"a": start + 2.5 * way}, tolerance=1e-6)}
    (ball,) = fh.annotate(scene, view, classes={"ball": "ball"}, keypoints=point).instances
    assert ball.keypoints[0].visibility == 2
    scene.add(fh.Sphere(start + 0.1 * way, 0.05), name="wasp")
    found = fh.annotate(scene, view, classes={"ball": "ball"}, keypoints=point, unseen=True)
    assert found.instances[0].keypoints[0].visibility == 1


def test_bop_has_k_of_a_shifted_viewplane_and_refuses_distortions(tmp_path):
    scene = ball()
    for name in ("tilted", "opencv", "skewed parallel"):
        with pytest.raises(ValueError, match="camera has no matrix K for BOP"):
            save_bop(tmp_path, fh.annotate(scene, camera(name)), unit="m")
    view = camera("shifted")
    save_bop(tmp_path, fh.annotate(scene, view), unit="m")
    assert (
        str(view.to_convention("opencv")[0][0, 2])[:8]
        in (tmp_path / "scene_camera.json").read_text()
    )


def test_what_a_lens_leaves_open_is_null_in_json_and_refused_by_kitti(tmp_path):
    seen = fh.annotate(things(18, (-4, -3, -6), (4, 3, 3)), camera("opencv"))
    assert all(math.isnan(instance.truncated) for instance in seen.instances)
    seen.save_coco(tmp_path / "coco.json")
    said = json.loads((tmp_path / "coco.json").read_text())
    assert said["annotations"]
    assert all(each["truncated"] is None for each in said["annotations"])
    with pytest.raises(ValueError, match="cameras are perspective"):
        save_kitti(tmp_path / "kitti", seen, unit="m")
    tilted = fh.annotate(things(18, (-4, -3, -6), (4, 3, 3)), camera("tilted"))
    with pytest.raises(ValueError, match="of a tilted viewplane that is not known"):
        save_kitti(tmp_path / "kitti", tilted, unit="m")
