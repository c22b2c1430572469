"""Files of optical flow and disparity, read by OpenCV and from what their formats say."""

import copy

import firsthit as fh
import numpy as np
import pytest

cv2 = pytest.importorskip("cv2")

#: Not in the middle: a picture upside down is another one.
BALL = {"center": (0.1, 0, 0.2), "radius": 1}
EYE = fh.Camera.look_at((0, -5, 0.5), (0, 0, 0), (0, 0, 1), 40, rows=30, columns=50)


def flow():
    before = fh.Scene()
    before.add(fh.Sphere(**BALL))
    after = copy.copy(before)
    place = np.eye(4)
    place[:3, 3] = 0.3, 0, 0.2
    after.move(0, place)
    return fh.optical_flow(before, EYE, after, EYE)


def pair():
    scene = fh.Scene()
    scene.add(fh.Sphere(**BALL))
    rig = fh.Rig.stereo(EYE, baseline=0.2)
    return fh.disparity(scene, rig["left"], rig["right"])


def test_a_flo_is_read_by_opencv(tmp_path):
    moved = flow()
    moved.save(tmp_path / "a.flo")
    read = cv2.readOpticalFlow(str(tmp_path / "a.flo"))
    known = np.isfinite(moved.flow).all(axis=-1)
    assert 0 < known.sum() < known.size
    np.testing.assert_array_equal(read[known], moved.flow[known].astype(np.float32))
    assert (read[~known] > 1e9).all()


def test_a_png_of_a_flow_is_kitti_s(tmp_path):
    moved = flow()
    moved.save(tmp_path / "a.png")
    # OpenCV has blue first.
    valid, v, u = np.moveaxis(cv2.imread(str(tmp_path / "a.png"), cv2.IMREAD_UNCHANGED), -1, 0)
    known = np.isfinite(moved.flow).all(axis=-1)
    assert u.dtype == np.uint16
    np.testing.assert_array_equal(valid, known)
    for k, steps in enumerate((u, v)):
        read = (steps[known].astype(float) - 2**15) / 64
        np.testing.assert_allclose(read, moved.flow[known][:, k], atol=0.5 / 64)
        assert (steps[~known] == 0).all()


def test_files_of_disparities_are_kitti_s_and_middlebury_s(tmp_path):
    found = pair()
    found.save(tmp_path / "a.png")
    found.save(tmp_path / "a.pfm")
    known = np.isfinite(found.disparity)
    steps = cv2.imread(str(tmp_path / "a.png"), cv2.IMREAD_UNCHANGED)
    assert steps.dtype == np.uint16
    np.testing.assert_array_equal(steps > 0, known)
    np.testing.assert_allclose(steps[known] / 256, found.disparity[known], atol=0.5 / 256)
    read = cv2.imread(str(tmp_path / "a.pfm"), cv2.IMREAD_UNCHANGED)
    np.testing.assert_array_equal(read[known], found.disparity[known].astype(np.float32))
    assert np.isinf(read[~known]).all()


def test_what_a_png_cannot_hold_is_refused_with_its_place(tmp_path):
    moved, found = flow(), pair()
    row, column = np.argwhere(np.isfinite(moved.flow[..., 0]))[0]
    moved.flow[row, column] = 513, 0
    with pytest.raises(ValueError, match=rf"512 to .* at row {row}, column {column}"):
        moved.save(tmp_path / "a.png")
    moved.save(tmp_path / "a.flo")
    found.disparity[row, column] = 256
    with pytest.raises(ValueError, match=r"0 to 255\.99 pixels, got 256"):
        found.save(tmp_path / "a.png")
    # Far away there is a disparity, too small for a step.
    found.disparity[row, column] = 1e-9
    found.save(tmp_path / "b.png")
    assert cv2.imread(str(tmp_path / "b.png"), cv2.IMREAD_UNCHANGED)[row, column] == 1
    for one, known in ((moved, r"\.flo or \.png"), (found, r"\.pfm or \.png")):
        with pytest.raises(ValueError, match=f"path must end in {known}"):
            one.save(tmp_path / "a.exr")


def plan(**output):
    eyes = [
        {"kind": "camera", "name": name, "rows": 12, "columns": 16, "position": [0, y, 0]}
        for name, y in (("left", 0.1), ("right", -0.1))
    ]
    return {
        "scenes": [{"file": "a.fhs"}, {"file": "b.fhs"}],
        "sensors": eyes,
        "poses": {"kind": "sphere", "count": 3, "radius": 5, "elevation": 30},
        "output": {"channels": ["z"], **output},
    }


def test_a_plan_has_the_flow_to_the_next_frame_and_the_disparity_of_a_pair(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scenes = []
    for k, name in enumerate("ab"):
        scene = fh.Scene()
        scene.add(fh.Sphere((0, 0, 0.1 * k), 1))
        scene.save(f"{name}.fhs")
        scenes.append(scene)
    disparity = {"left": "left", "right": "right", "formats": ["png", "pfm"]}
    made = fh.Plan.from_dict(plan(flow=["flo"], disparity=disparity))
    fh.dataset(made, "out")
    frames = [path.parent for path in sorted((tmp_path / "out").rglob("frame.json"))]
    assert len(frames) == 6
    for k, frame in enumerate(frames):
        names = {path.name for path in frame.iterdir()}
        # The last of each scene has no next one.
        assert ("left.flow.flo" in names, "right.flow.flo" in names) == ((k % 3 < 2),) * 2
        assert {"left.disparity.png", "left.disparity.pfm"} <= names
        assert not any(name.startswith("right.disparity") for name in names)
    poses = [made._poses.place(made._seed, k, k % 3, scenes[k // 3]) for k in range(6)]
    left, right = made._sensors
    wanted = fh.optical_flow(scenes[1], left.at(poses[3]), scenes[1], left.at(poses[4]))
    read = cv2.readOpticalFlow(str(frames[3] / "left.flow.flo"))
    known = np.isfinite(wanted.flow).all(axis=-1)
    np.testing.assert_array_equal(read[known], wanted.flow[known].astype(np.float32))
    apart = fh.disparity(scenes[1], left.at(poses[5]), right.at(poses[5])).disparity
    steps = cv2.imread(str(frames[5] / "left.disparity.png"), cv2.IMREAD_UNCHANGED)
    np.testing.assert_allclose(steps[steps > 0] / 256, apart[np.isfinite(apart)], atol=0.5 / 256)


@pytest.mark.parametrize(
    ("output", "message"),
    [
        ({"flow": ["exr"]}, "flow"),
        ({"disparity": {"left": "left"}}, "this table needs `right`"),
        ({"disparity": {"left": "left", "right": "none"}}, "right"),
        ({"disparity": {"left": "right", "right": "left"}}, "right must be to the right of left"),
        ({"disparity": {"left": "left", "right": "right", "formats": []}}, "one format or several"),
    ],
)
def test_plans_whose_flow_or_disparity_makes_no_sense_are_refused(
    output, message, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    for name in "ab":
        fh.Scene().save(f"{name}.fhs")
    with pytest.raises(ValueError, match=message):
        fh.Plan.from_dict(plan(**output))
