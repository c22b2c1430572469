"""Default cameras: a picture is the program's."""

import pickle
import subprocess
import sys

import firsthit as fh
import numpy as np
import pytest
from support import FULL, ROOT, TESTDATA, ball, some

MESHES = [
    TESTDATA / "torus_draco.glb",
    TESTDATA / "cube_quads_ascii.ply",
    TESTDATA / "cube_bom_crlf.obj",
    TESTDATA / "cube_binary.stl",
]
SCENES = sorted((ROOT / "docs" / "scenes").glob("*.toml"))


def program(*arguments):
    command = [sys.executable, "-m", "firsthit", *map(str, arguments)]
    subprocess.run(command, check=True, capture_output=True)


@pytest.mark.parametrize("path", [*MESHES, *some(SCENES)], ids=lambda path: path.name)
@pytest.mark.filterwarnings("ignore::firsthit.FirsthitWarning")
def test_a_scene_alone_gives_the_program_s_picture_to_the_byte(path, tmp_path):
    scene, size, camera = fh.load(path), [], None
    if not FULL and path in MESHES[1:]:
        size, camera = ["--size", "160x90"], fh.Camera.framing(scene, 90, 160)
    fh.render(scene, camera).save(tmp_path / "ours.png")
    program("render", path, *size, "-o", tmp_path / "programs.png")
    assert (tmp_path / "ours.png").read_bytes() == (tmp_path / "programs.png").read_bytes()


#: Stands on its base, with z up: against the custom of OBJ.
PYRAMID = """
v -1 -1 0
v 1 -1 0
v 1 1 0
v -1 1 0
v 0.1 0.2 3
f 4 3 2 1
f 1 2 5
f 2 3 5
f 3 4 5
f 4 1 5
"""


def test_what_stands_on_a_foot_is_upright_as_in_the_program_until_somebody_says(tmp_path):
    path = tmp_path / "pyramid.obj"
    path.write_text(PYRAMID)
    scene = fh.load(path)
    assert scene.up == (0, 0, 1)
    assert pickle.loads(pickle.dumps(scene)).up == (0, 0, 1)
    fh.render(scene, fh.Camera.framing(scene, 30, 40)).save(tmp_path / "ours.png")
    program("render", path, "--size", "40x30", "-o", tmp_path / "programs.png")
    assert (tmp_path / "ours.png").read_bytes() == (tmp_path / "programs.png").read_bytes()
    scene.up = (0, 1, 0)
    assert scene.up == (0, 1, 0)
    assert fh.Camera.framing(scene).upwards @ [0, 1, 0] > 0.5


@pytest.mark.parametrize("view", ["iso", "front", "back", "left", "right", "top", "bottom"])
def test_a_view_is_the_program_s(view, tmp_path):
    path = TESTDATA / "torus_draco.glb"
    scene = fh.load(path)
    camera = fh.Camera.framing(scene, rows=30, columns=44, view=view)
    fh.render(scene, camera).save(tmp_path / "ours.png")
    program("render", path, "--view", view, "--size", "44x30", "-o", tmp_path / "programs.png")
    assert (tmp_path / "ours.png").read_bytes() == (tmp_path / "programs.png").read_bytes()


def test_a_framed_model_is_whole_and_fills_the_picture():
    scene = fh.Scene()
    scene.add(fh.Box((-5, 2, 1), (1, 3, 9)))
    for up in ((0, 0, 1), (0, 1, 0), (1, 2, -3)):
        for view in ("iso", "front", "back", "left", "right", "top", "bottom"):
            camera = fh.Camera.framing(scene, rows=90, columns=120, view=view, up=up)
            met = scene.shoot(camera).object >= 0
            rows, columns = np.nonzero(met)
            border = [*met[0], *met[-1], *met[:, 0], *met[:, -1]]
            assert not any(border)
            assert max(np.ptp(rows) / 90, np.ptp(columns) / 120) > 0.9
            if view in ("top", "bottom"):
                assert abs(camera.upwards @ np.asarray(up)) < 1e-12
            else:
                assert camera.upwards @ np.asarray(up) > 0


def test_sizes_that_are_left_out_are_the_usual_ones():
    sizes = [
        (camera.rows, camera.columns)
        for camera in (
            fh.Camera.framing(ball()),
            fh.Camera.framing(ball(), rows=300),
            fh.Camera.framing(ball(), columns=300),
            fh.Camera.framing(fh.Scene(), 9, 7),
        )
    ]
    assert sizes == [(768, 1024), (300, 400), (225, 300), (9, 7)]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            {"view": "side"},
            "view must be one of iso, front, back, left, right, top, bottom, got 'side'",
        ),
        ({"up": (0, 0, 0)}, "up must be a finite direction, not zero"),
        ({"up": (0, 0)}, "up must be three numbers"),
        ({"rows": 0}, "rows must be at least 1"),
        ({"rows": 1.5}, "rows must be a whole number"),
    ],
)
def test_framing_that_makes_no_sense_is_refused_by_name(change, words):
    with pytest.raises(ValueError, match=words):
        fh.Camera.framing(ball(), **change)


def test_cameras_that_were_framed_are_kept_to_the_last_bit():
    """Their aims are of length one only to working precision."""
    scene = fh.Scene()
    for k in range(60):
        scene.add(fh.Sphere((k, 7 * k % 11, 3 * k % 7), 0.5))
        camera = fh.Camera.framing(scene, 30, 40, up=(0.1 * k, 1, 0.3))
        again = pickle.loads(pickle.dumps(camera))
        assert again == camera
        assert hash(again) == hash(camera)
        np.testing.assert_array_equal(again.aim, camera.aim)
        np.testing.assert_array_equal(again.rays(), camera.rays())


def test_up_is_the_file_s_until_it_is_set_and_comes_along(tmp_path):
    assert fh.Scene().up == (0, 0, 1)
    assert fh.load(TESTDATA / "cube_binary.stl").up == (0, 0, 1)
    assert fh.load(TESTDATA / "torus_draco.glb").up == (0, 1, 0)
    (tmp_path / "scene.toml").write_text(
        'up = [1, 0, 0]\n[[objects]]\nshape = "sphere"\ncenter = [0, 0, 0]\nradius = 1\n'
    )
    scene = fh.load(tmp_path / "scene.toml")
    assert scene.up == (1, 0, 0)
    before = fh.render(scene, fh.Camera.framing(scene, 9, 12)).metadata["camera"]["up"]
    assert before == [1, 0, 0]
    scene.up = [0, 2, 0]
    assert pickle.loads(pickle.dumps(scene)).up == (0, 2, 0)
    assert fh.Camera.framing(scene).upwards @ [0, 1, 0] > 0.5
    for up in ((0, 0, 0), (0, np.nan, 1), (1, 2)):
        with pytest.raises(ValueError, match="up must be"):
            scene.up = up
    assert scene.up == (0, 2, 0)


def test_samples_and_background_are_the_program_s_where_nobody_says():
    scene, camera = ball(), fh.Camera.framing(ball(), 30, 40)
    assert fh.Shading().samples is None
    assert fh.render(scene, camera, shade="unlit").metadata["samples"] == 4
    frame = fh.render(scene, camera)
    assert frame.metadata["samples"] == 16
    assert frame.metadata["shading"]["shader"] == "direct"
    given = {"samples": 16, "shade": "direct", "light": "auto", "ground": True}
    np.testing.assert_array_equal(frame["color"], fh.render(scene, camera, **given)["color"])
    assert 0 < frame["color"][0, 0].min() < frame["color"][0, 0].max() < 1
    calls = []
    fh.render(scene, camera, shade=lambda hits: (calls.append(1), np.zeros((*hits.shape, 3)))[1])
    assert len(calls) == 4
    scene.background = (1, 1, 1)
    assert (fh.render(scene, camera)["color"][0, 0] == 1).all()


def far_viewplane(ray_start="viewplane", focal_length=1500):
    """A camera whose focal length is in pixels, at three balls."""
    scene = fh.Scene()
    for x in (-3, 0, 3):
        scene.add(fh.Sphere((x, 0, 0), 1))
    lengths = focal_length, focal_length * 0.8, focal_length * 0.6
    camera = fh.Camera((0, -9, 0), (0, 1, 0), (0, 0, 1), *lengths, 60, 80, ray_start=ray_start)
    return scene, camera


def test_a_viewplane_beyond_the_scene_is_warned_of():
    scene, camera = far_viewplane()
    expected = "3 objects are between the eye and the viewplane"
    with pytest.warns(fh.FirsthitWarning, match=expected):
        frame = fh.render(scene, camera, channels="object")
    assert (frame["object"] == -1).all()
    with pytest.warns(fh.FirsthitWarning, match=expected):
        scene.shoot(camera)
    with pytest.warns(fh.FirsthitWarning, match=expected):
        next(iter(fh.render_progressively(scene, camera, samples=2)))


@pytest.mark.filterwarnings("error")
def test_a_viewplane_before_the_scene_or_an_empty_picture_is_not_warned_of():
    for ray_start, focal_length in (("eye", 1500), ("viewplane", 1), ("viewplane", 8.5)):
        scene, camera = far_viewplane(ray_start, focal_length)
        fh.render(scene, camera, channels="object")
        scene.shoot(camera)
    past = camera.moved([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 50]])
    fh.render(scene, past, channels="object")
    scene.shoot(past)
    fh.render(fh.Scene(), past, channels="object")
