"""Cameras of ROS, Kalibr and nerfstudio against what these programs do with their numbers."""

import json
import math
import os

import firsthit as fh
import numpy as np
import pytest

yaml = pytest.importorskip("yaml", reason="PyYAML reads YAML files")
cv2 = pytest.importorskip("cv2")

#: A file of camera_calibration, as it writes it.
ROS = """\
image_width: 128
image_height: 96
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [100.5, 0., 63.25, 0., 101.5, 47.75, 0., 0., 1.]
distortion_model: {model}
distortion_coefficients:
  rows: 1
  cols: {count}
  data: [{data}]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1., 0., 0., 0., 1., 0., 0., 0., 1.]
projection_matrix:
  rows: 3
  cols: 4
  data: [95., 0., 60., 0., 0., 96., 47., 0., 0., 0., 1., 0.]
"""
K = np.array([[100.5, 0, 63.25], [0, 101.5, 47.75], [0, 0, 1]])
POINTS = np.array([[0.3, -0.2, 1.0], [-0.4, 0.1, 1.5], [0.1, 0.3, 0.9], [0.0, 0.0, 2.0]])

#: Kalibr's focal lengths and principal point.
FOUR = [460, 461, 370, 250]
#: A camchain of two cameras and an IMU.
KALIBR = """\
cam0:
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.29, 0.08, 1e-05, -0.0002]
  distortion_model: radtan
  intrinsics: [461.6, 460.3, 362.6, 248.1]
  resolution: [752, 480]
  rostopic: /cam0/image_raw
  T_cam_imu:
  - [0.0, 1.0, 0.0, 0.1]
  - [-1.0, 0.0, 0.0, 0.2]
  - [0.0, 0.0, 1.0, 0.3]
  - [0.0, 0.0, 0.0, 1.0]
  timeshift_cam_imu: 0.001
cam1:
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, -0.11]
  - [0.0, 1.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: [0]
  camera_model: {model}
  distortion_coeffs: [{coeffs}]
  distortion_model: {distortion}
  intrinsics: [{intrinsics}]
  resolution: [752, 480]
  rostopic: /cam1/image_raw
"""


def saved(tmp_path, text, name="file.yaml"):
    path = tmp_path / name
    path.write_text(text)
    return path


def ros_file(tmp_path, model, given):
    data = ", ".join(map(repr, given))
    return saved(tmp_path, ROS.format(model=model, count=len(given), data=data))


def seen_by_opencv(points, distortion, *, is_fisheye=False):
    zero = np.zeros(3)
    if is_fisheye:
        flat, _ = cv2.fisheye.projectPoints(points[None], zero, zero, K, np.array(distortion))
    else:
        flat, _ = cv2.projectPoints(points, zero, zero, K, np.array(distortion))
    # OpenCV puts the first pixel's centre at (0, 0).
    return flat.reshape(-1, 2) + 0.5


@pytest.mark.parametrize(
    ("model", "given"),
    [
        ("plumb_bob", [-0.28, 0.07, 0.001, -0.0005, 0.01]),
        ("rational_polynomial", [0.18, 0.09, -0.001, 0.0012, 0.003, 0.27, -0.22, -0.016]),
        ("equidistant", [-0.02, 0.005, -0.001, 0.0002]),
    ],
)
def test_a_camera_info_sees_what_opencv_projects(tmp_path, model, given):
    camera = fh.Camera.from_ros(ros_file(tmp_path, model, given))
    assert (camera.rows, camera.columns) == (96, 128)
    expected = seen_by_opencv(POINTS, given, is_fisheye=model == "equidistant")
    np.testing.assert_allclose(camera.project(POINTS), expected, atol=1e-9)


def test_a_message_of_camera_info_is_read_with_its_region_and_binning(tmp_path):
    message = """\
header:
  seq: 1
  frame_id: camera
height: 96
width: 128
distortion_model: "plumb_bob"
d: [0.0, 0.0, 0.0, 0.0, 0.0]
k: [100.5, 0.0, 63.25, 0.0, 101.5, 47.75, 0.0, 0.0, 1.0]
r: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
p: [95.0, 0.0, 60.0, 0.0, 0.0, 96.0, 47.0, 0.0, 0.0, 0.0, 1.0, 0.0]
binning_x: 2
binning_y: 2
roi:
  x_offset: 20
  y_offset: 10
  height: 40
  width: 60
  do_rectify: false
---
height: 1
"""
    camera = fh.Camera.from_ros(saved(tmp_path, message))
    assert (camera.rows, camera.columns) == (20, 30)
    whole = seen_by_opencv(POINTS, np.zeros(5))
    np.testing.assert_allclose(camera.project(POINTS), (whole - (20, 10)) / 2, atol=1e-9)


def test_the_pose_of_a_camera_info_is_the_optical_frames(tmp_path):
    path = ros_file(tmp_path, "plumb_bob", [0.0] * 5)
    pose = [[0, 0, 1, 1], [-1, 0, 0, 2], [0, -1, 0, 3]]
    camera = fh.Camera.from_ros(path, pose=pose)
    assert camera.position.tolist() == [1, 2, 3]
    assert camera.aim.tolist() == [1, 0, 0]


@pytest.mark.parametrize(
    ("model", "intrinsics", "distortion", "coeffs", "projection"),
    [
        (
            "pinhole",
            [460, 461, 370, 250],
            "equidistant",
            [-0.01, 0.02, -0.03, 0.01],
            "opencv_fisheye",
        ),
        ("pinhole", [460, 461, 370, 250], "fov", [0.9], "fov"),
        ("pinhole", [460, 461, 370, 250], "none", [], "perspective"),
        ("omni", [1.4, 860, 861, 370, 250], "radtan", [-0.2, 0.1, 1e-3, 2e-3], "mei"),
        ("ds", [-0.2, 0.6, 300, 301, 370, 250], "none", [], "double_sphere"),
        ("eucm", [0.6, 1.1, 300, 301, 370, 250], "none", [], "eucm"),
    ],
)
def test_a_camchain_says_models_and_poses(
    tmp_path, model, intrinsics, distortion, coeffs, projection
):
    words = {"model": model, "distortion": distortion}
    lists = {"intrinsics": intrinsics, "coeffs": coeffs}
    listed = {name: ", ".join(map(str, each)) for name, each in lists.items()}
    path = saved(tmp_path, KALIBR.format(**words, **listed))
    cameras = fh.Camera.from_kalibr(path)
    assert list(cameras) == ["cam0", "cam1"]
    assert cameras["cam0"].projection == "opencv"
    assert cameras["cam0"].parameters["p1"] == 1e-5  # A word to YAML 1.1.
    one = cameras["cam1"]
    assert one.projection == projection
    assert (one.rows, one.columns) == (480, 752)
    np.testing.assert_allclose(one.position, (0.11, 0, 0), atol=1e-15)
    # The principal point, half a pixel on.
    np.testing.assert_allclose(one.project(one.position + one.aim), (370.5, 250.5), atol=1e-9)
    in_imu = fh.Camera.from_kalibr(path, frame="imu")
    to_imu = np.linalg.inv([[0, 1, 0, 0.1], [-1, 0, 0, 0.2], [0, 0, 1, 0.3], [0, 0, 0, 1]])
    for name, camera in cameras.items():
        point = np.array([0.2, -0.1, 2.0])
        moved = to_imu[:3, :3] @ point + to_imu[:3, 3]
        np.testing.assert_allclose(in_imu[name].project(moved), camera.project(point), atol=1e-9)


def transforms(**others):
    frame = {"file_path": "images/1.png", "transform_matrix": np.eye(4).tolist()}
    return {"w": 128, "h": 96, "fl_x": 100.0, "frames": [frame], **others}


def of_transforms(tmp_path, said, **given):
    return fh.Camera.from_nerfstudio(saved(tmp_path, json.dumps(said), "transforms.json"), **given)


def test_transforms_say_intrinsics_of_all_and_of_one(tmp_path):
    pose = [[1, 0, 0, 1], [0, 0, -1, 2], [0, 1, 0, 3], [0, 0, 0, 1]]
    other = {"file_path": "images/2.png", "transform_matrix": pose, "fl_x": 80.0, "fl_y": 81.0}
    said = transforms(camera_model="OPENCV", cx=60.0, cy=50.0, k1=-0.1, p2=0.001)
    said["frames"].append(other)
    cameras = of_transforms(tmp_path, said)
    assert list(cameras) == ["images/1.png", "images/2.png"]
    first, second = cameras.values()
    assert first.intrinsic_matrix.tolist() == [[100, 0, 60], [0, 100, 50], [0, 0, 1]]
    assert first.parameters["k1"] == -0.1
    assert second.intrinsic_matrix[1, 1] == 81
    assert second.position.tolist() == [1, 2, 3]
    np.testing.assert_allclose(second.aim, (0, 1, 0), atol=1e-15)


def test_scenes_of_nerf_have_an_angle_and_a_size_of_the_users(tmp_path):
    said = {"camera_angle_x": 0.5 * math.pi, "frames": transforms()["frames"]}
    (camera,) = of_transforms(tmp_path, said, rows=60, columns=80).values()
    assert camera.projection == "perspective"
    np.testing.assert_allclose(camera.intrinsic_matrix, [[40, 0, 40], [0, 40, 30], [0, 0, 1]])
    with pytest.raises(fh.FileFormatError, match=r"frames\[0\].h is missing"):
        of_transforms(tmp_path, said)


def test_fisheyes_and_panoramas_of_nerfstudio_are_read(tmp_path):
    said = transforms(camera_model="OPENCV_FISHEYE", k1=0.01, k4=0.002)
    (camera,) = of_transforms(tmp_path, said).values()
    assert (camera.projection, camera.parameters["k4"]) == ("opencv_fisheye", 0.002)
    (panorama,) = of_transforms(tmp_path, transforms(camera_model="EQUIRECTANGULAR")).values()
    assert panorama.projection == "equirectangular"
    assert panorama.aim.tolist() == [0, 0, -1]


def test_a_fourth_radial_coefficient_is_not_taken_for_opencvs(tmp_path):
    with pytest.raises(fh.FileFormatError, match="OPENCV with k4 is not supported"):
        of_transforms(tmp_path, transforms(k1=0.1, k4=0.01))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "must be a table, got None"),
        ("- 1\n", "must be a table"),
        ("a: [", "while parsing"),
        ("image_height: 96\n", "image_width is missing"),
        (ROS.format(model="plumb_bob", count=2, data="1, 2"), "4 or 5 coefficients, got 2"),
        (ROS.format(model="odd", count=4, data="1, 2, 3, 4"), "distortion_model must be one of"),
        (ROS.format(model="plumb_bob", count=4, data="1, x, 3, 4"), "must be a number, got 'x'"),
        (ROS.format(model="plumb_bob", count=4, data=".nan, 1, 3, 4"), "must be finite"),
        (ROS.replace("100.5, 0.", "0, 0.").format(model="", count=0, data=""), "fx must be"),
        ("[" * 100_000, "nested too deeply"),
        ("!!python/object/apply:os.system ['true']", "could not determine a constructor"),
    ],
)
def test_a_wrong_camera_info_says_what_is_wrong_with_it(tmp_path, text, expected):
    path = saved(tmp_path, text)
    with pytest.raises(fh.FileFormatError, match=expected) as raised:
        fh.Camera.from_ros(path)
    assert raised.value.path == os.fspath(path)


def test_wrong_camchains_and_transforms_say_what_is_wrong(tmp_path):
    chain = KALIBR.format(model="ds", distortion="radtan", intrinsics="1", coeffs="")
    with pytest.raises(fh.FileFormatError, match="cam1: expected pinhole with none"):
        fh.Camera.from_kalibr(saved(tmp_path, chain))
    chain = KALIBR.replace("T_cn_cnm1", "T_other").format(
        model="pinhole", distortion="none", intrinsics="1, 1, 0, 0", coeffs=""
    )
    with pytest.raises(fh.FileFormatError, match=r"cam1\.T_cn_cnm1 is missing"):
        fh.Camera.from_kalibr(saved(tmp_path, chain))
    twice = transforms()
    twice["frames"] *= 2
    with pytest.raises(fh.FileFormatError, match="there twice"):
        of_transforms(tmp_path, twice)
    for wrong in ("[]", "{", '{"frames": 1}', "[" * 100_000):
        with pytest.raises(fh.FileFormatError):
            fh.Camera.from_nerfstudio(saved(tmp_path, wrong))
    with pytest.raises(fh.FileReadError):
        fh.Camera.from_nerfstudio(tmp_path / "none.json")


def test_what_an_alias_repeats_takes_no_memory(tmp_path):
    lines = ["a0: &a0 [1, 2, 3, 4, 5, 6, 7, 8, 9]"]
    lines += [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]" for k in range(1, 30)]
    with pytest.raises(fh.FileFormatError, match="is missing"):
        fh.Camera.from_ros(saved(tmp_path, "\n".join(lines)))
