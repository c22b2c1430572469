"""Whether a data set's distances fit into PNGs: what a check says, and what a run comes to."""

import warnings

import firsthit as fh
import numpy as np
import pytest
from dataset_support import PLANS, plan

SCENE = """
[[objects]]
name = "room"
shape = "box"
low = [-4, -3, -1]
high = [4, 3, 2]
"""
#: The farthest corner of the room from a place in it, at most.
DIAGONAL = np.linalg.norm([8, 6, 3])

CAMERA = {"columns": 30, "rows": 20, "fov": 90.0}
DRIVE = {
    "body": "forwards-left-up",
    "times": [0, 1, 2],
    "positions": [[-3, 0, 0], [0, 1, 0], [3, 0, 0]],
}
POSES = {
    "sphere": {"kind": "sphere", "count": 5, "center": [0, 0, 0.5], "radius": [1, 2]},
    "inside": {"kind": "inside", "count": 5, "pitch": [-30, 30]},
    "path": {"kind": "path", "rate": 4, "trajectory": DRIVE},
    "list": {
        "kind": "list",
        "body": "forwards-left-up",
        "matrices": [[[1, 0, 0, x], [0, 1, 0, 0], [0, 0, 1, 0]] for x in (-3, 1.5)],
    },
}
#: The farthest from the rig's origin that a corner of the room is, worked out by hand.
FARTHEST = {
    "sphere": np.linalg.norm([4, 3, 1.5]) + 2,
    "inside": DIAGONAL,
    "path": np.linalg.norm([7, 3, 2]),
    "list": np.linalg.norm([7, 3, 2]),
}


def told(folder, poses, scale, scene=SCENE, sensors=(CAMERA,), channels=("z",)):
    """Return the warnings of a check, by its first run."""
    (folder / "room.toml").write_text(scene)
    made = fh.Plan.from_dict(
        {
            "scenes": [{"file": "room.toml"}],
            "sensors": list(sensors),
            "poses": poses,
            "output": {"pictures": list(channels), "png_scale": scale, "frames": []},
        },
        folder,
    )
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        fh.dataset(made, folder / f"out {scale}", part=(1, 10**6))
    return [str(each.message) for each in caught]


@pytest.mark.parametrize("kind", POSES)
def test_a_scale_is_told_of_that_the_farthest_corner_does_not_fit(tmp_path, kind):
    scale = FARTHEST[kind] / 65535
    assert told(tmp_path, POSES[kind], scale * 1.001) == []
    (said,) = told(tmp_path, POSES[kind], scale * 0.999)
    assert said.startswith("scene 'room.toml': PNGs of z end at ")
    assert f"a surface may be {FARTHEST[kind]:.4g} from sensor 'camera'" in said
    # The scale that it names is enough.
    enough = float(said.split("a scale of ")[1].split()[0])
    assert scale <= enough < 1.01 * scale
    assert told(tmp_path, POSES[kind], enough) == []


@pytest.mark.parametrize("kind", POSES)
def test_no_picture_of_a_scale_without_a_warning_overflows(tmp_path, kind):
    """Pictures to all sides, from all frames, by distances of all kinds."""
    panorama = {"columns": 60, "rows": 30, "projection": "equirectangular"}
    (tmp_path / "room.toml").write_text(SCENE)
    output = {"pictures": ["range", "t"], "png_scale": FARTHEST[kind] / 65535 * 1.001}
    made = fh.Plan.from_dict(
        {
            "scenes": [{"file": "room.toml"}],
            "sensors": [panorama],
            "poses": POSES[kind],
            "output": output | {"channels": ["range", "t"]},
        },
        tmp_path,
    )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert fh.dataset(made, tmp_path / "out").missing == 0
    far = max(
        np.load(file)["range"].max() for file in (tmp_path / "out" / "frames").glob("*/*.npz")
    )
    assert far > 0.6 * FARTHEST[kind]


def test_the_farthest_sensor_counts_with_its_place_on_the_rig(tmp_path):
    ahead = CAMERA | {"name": "ahead", "position": [0, 0, 5]}
    poses, scale = POSES["sphere"], (FARTHEST["sphere"] + 4) / 65535
    (said,) = told(tmp_path, poses, scale, sensors=[CAMERA | {"name": "eye"}, ahead])
    assert f"{FARTHEST['sphere'] + 5:.4g} from sensor 'ahead'" in said
    assert told(tmp_path, poses, (FARTHEST["sphere"] + 5.1) / 65535, sensors=[ahead]) == []


def test_what_a_moving_camera_drives_to_after_the_last_frame_counts(tmp_path):
    poses = POSES["path"] | {"rate": 1, "end": 1, "start": 1}
    still = np.linalg.norm([4, 4, 2]) / 65535 * 1.01
    assert told(tmp_path, poses, still) == []
    rolling = CAMERA | {"kind": "rolling_shutter", "readout": 1.0, "name": "camera"}
    (said,) = told(tmp_path, poses, still * 1.0001, sensors=[rolling])
    assert "from sensor 'camera'" in said


def test_an_object_without_an_end_may_be_beyond_any_scale(tmp_path):
    plane = (
        '[[objects]]\nname = "ground"\nshape = "plane"\npoint = [0, 0, -1]\nnormal = [0, 0, 1]\n'
    )
    (said,) = told(tmp_path, POSES["sphere"], 1.0, SCENE + plane, channels=("z", "range"))
    assert said == (
        "scene 'room.toml': PNGs of z, range end at 65535, 65535 steps of `png_scale`, and object "
        "'ground' has no end: a pixel may show it beyond"
    )


def test_plans_without_pictures_of_distances_are_not_told_of_any(tmp_path):
    made = plan(lambda made: made["output"].update(pictures=["color"]))
    del made["output"]["png_scale"]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        fh.dataset(fh.Plan.from_dict(made, PLANS), tmp_path, part=(1, 10**6))


@pytest.mark.parametrize("interpolation", ["linear", "spline", "se3"])
@pytest.mark.parametrize("seed", range(20))
def test_no_place_of_a_path_is_beside_what_its_bound_holds(interpolation, seed):
    """Also between frames, and where a spline goes beyond its poses."""
    rng = np.random.default_rng(seed)
    turns = rng.normal(size=(5, 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    poses = {
        "kind": "path",
        "count": 3,
        "trajectory": {
            "body": "forwards-left-up",
            "times": np.cumsum(rng.uniform(0.1, 2.0, 5)).tolist(),
            "positions": rng.normal(size=(5, 3)).tolist(),
            "rotations": turns.tolist(),
            "interpolation": interpolation,
        },
    }
    made = fh.Plan.from_dict(
        {
            "scenes": [{"file": "yard.toml"}],
            "sensors": [CAMERA],
            "poses": poses,
        },
        PLANS,
    )
    path = made._poses
    places, beside = path.places(None, 0.0)
    times = np.linspace(path.trajectory.start, path.trajectory.end, 3000)
    way = path.trajectory.at(times)[:, :3, 3]
    # In every direction the way ends before the hull and what may be beside it.
    directions = rng.normal(size=(200, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    reach = (places @ directions.T).max(axis=0) + beside
    assert ((way @ directions.T).max(axis=0) <= reach + 1e-9).all()
    # And the bound is none that always holds.
    assert ((way @ directions.T).max(axis=0) > reach - 2.0).mean() > 0.5


def test_a_drive_that_is_farthest_between_its_frames_is_warned_of(tmp_path):
    drive = {
        "body": "forwards-left-up",
        "times": [0, 1, 2],
        "positions": [[0, 0, 0], [3, 2, 1], [0, 0, 0]],
    }
    shutter = {**CAMERA, "kind": "rolling_shutter", "readout": 2.0}
    poses = {"kind": "path", "times": [0], "trajectory": drive}
    scale = np.linalg.norm([4, 3, 2]) / 65535
    (said,) = told(tmp_path, poses, 1.001 * scale, sensors=[shutter])
    assert f"a surface may be {np.linalg.norm([7, 5, 2]):.4g} from sensor" in said


def made_with(folder, **output):
    (folder / "room.toml").write_text(SCENE)
    made = {
        "scenes": [{"file": "room.toml"}],
        "sensors": [CAMERA],
        "poses": {**POSES["inside"], "count": 1},
        "output": {"pictures": ["z", "object"], "png_scale": 1e-5, **output},
    }
    return fh.Plan.from_dict(made, folder)


def test_a_plan_saturates_writes_labels_float32_and_packed_files_as_asked(tmp_path):
    asked = {"far": "saturate", "png_labels": True, "dtype": "float32", "compress": True}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        made = fh.dataset(made_with(tmp_path, **asked), tmp_path / "out")
    assert made is not None
    (npz,) = (tmp_path / "out").rglob("*.npz")
    folder = npz.parent
    (steps,), (labels,) = folder.glob("*.z.png"), folder.glob("*.object.png")
    with np.load(npz) as arrays:
        z, identifiers = arrays["z"], arrays["object"]
    assert z.dtype == np.float32
    np.testing.assert_allclose(fh.Frame.load(steps)["z"], np.minimum(z, 0.65535), atol=1e-5)
    np.testing.assert_array_equal(fh.Frame.load(labels)["object"], identifiers)
    assert fh.read_metadata(labels)["channels"][0]["stored"]["encoding"] == "labels"


@pytest.mark.parametrize(
    ("output", "words"),
    [
        ({"pictures": ["object"], "far": "zero"}, "far"),
        ({"pictures": ["z"], "png_scale": 1.0, "png_labels": True}, "png_labels"),
        ({"frames": ["exr"], "pictures": ["z"], "png_scale": 1.0, "compress": True}, "compress"),
        ({"pictures": ["z"], "png_scale": 1.0, "far": "clip"}, "saturate"),
        ({"pictures": [], "dtype": "float16"}, "float32"),
    ],
)
def test_a_plan_refuses_how_files_hold_numbers_that_no_file_holds(output, words, tmp_path):
    (tmp_path / "room.toml").write_text(SCENE)
    made = {"scenes": [{"file": "room.toml"}], "sensors": [CAMERA], "poses": POSES["inside"]}
    with pytest.raises(ValueError, match=words):
        fh.Plan.from_dict({**made, "output": output}, tmp_path)
