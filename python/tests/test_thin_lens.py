"""Cameras with an aperture."""

import pickle

import firsthit as fh
import numpy as np
import pytest
from support import FULL


def camera(rows=40, columns=50):
    return fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 45, rows, columns)


def dots():
    """Small white balls at three distances."""
    scene = fh.Scene()
    for x, z in ((-1, 0), (0, 2), (0.7, -6)):
        scene.add(fh.Sphere(center=(x, 0, z), radius=0.06 - 0.01 * z), color=(1, 1, 1))
    return scene


def test_arguments_and_attributes_say_the_same():
    plain = camera()
    assert (plain.aperture, plain.focus) == (0.0, None)
    lens = plain.thin_lens(0.5, 4.0)
    assert (lens.aperture, lens.focus) == (0.5, 4.0)
    lengths = plain.focal_length, plain.width, plain.height
    where = plain.position, plain.aim, plain.up
    same = fh.Camera(*where, *lengths, 40, 50, ray_start="eye", aperture=0.5, focus=4)
    assert same == lens
    assert same != plain
    assert plain.thin_lens(0.5, (3, 2, 1)) == lens
    assert pickle.loads(pickle.dumps(lens)) == lens
    assert eval(repr(same), {"Camera": fh.Camera}) == same
    assert (plain.rays()[1] == lens.rays()[1]).all()


def test_a_picture_says_which_lens_made_it(tmp_path):
    lens = camera().thin_lens(0.5, 4.0)
    frame = fh.render(dots(), lens, samples=2)
    frame.save(tmp_path / "a.exr")
    assert fh.Camera.load(tmp_path / "a.exr") == lens
    assert frame.metadata["camera"]["parameters"]["aperture"] == 0.5


def test_colours_of_ones_own_come_through_the_lens():
    lens = camera().thin_lens(0.5, 4.0)

    def shade(hits):
        return np.repeat(np.isfinite(hits.t)[..., None], 3, axis=-1)

    own = fh.render(dots(), lens, shade=shade, samples=16)["color"]
    ours = fh.render(dots(), lens, background="transparent", samples=16, ground=False)["color"]
    np.testing.assert_allclose(own[..., 0], ours[..., 3], atol=1e-6)
    with pytest.raises(ValueError, match="samples must be at least 2"):
        fh.render(dots(), lens, shade=shade, samples=1)


def test_a_ball_out_of_focus_is_as_wide_as_its_circle_of_confusion():
    rows = columns = 200
    lens = camera(rows, columns).thin_lens(0.6, 5.0)
    scene = fh.Scene()
    scene.add(fh.Sphere(center=(0, 0, -5), radius=0.05))
    covered = fh.render(scene, lens, channels="alpha", samples=1024, ground=False)["alpha"]
    pixels = rows / 2 / np.tan(np.radians(22.5))
    blur = 0.6 * abs(10 - 5) / (10 * 5) / 2 * pixels
    own = 0.05 / 10 * pixels
    u = np.arange(columns) + 0.5 - columns / 2
    measured = (covered * u**2).sum() / covered.sum()
    # Each of the 1024 samples sees four or five pixels of the ball, and so counts more or less.
    assert measured == pytest.approx((blur**2 + own**2) / 4 + 1 / 12, rel=0.03)
    lit = np.nonzero(covered.any(axis=0))[0]
    assert (lit[-1] - lit[0] + 1) / 2 == pytest.approx(blur + own, abs=1.5)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"aperture": 0.1}, "focus must be given with an aperture"),
        ({"aperture": -1, "focus": 2}, "aperture must be zero or a positive"),
        ({"aperture": 1, "focus": 0}, "focus must be a positive distance, got 0"),
        ({"aperture": 1, "focus": 2, "projection": "orthographic"}, "only perspective cameras"),
        ({"parameters": {"aperture": 1}}, "aperture is an argument of its own"),
        (
            {"aperture": 1, "focus": 2, "parameters": {"tilt_x": 3}},
            "aperture must be zero for a tilted viewplane",
        ),
    ],
)
def test_what_is_no_lens_is_refused(given, message):
    with pytest.raises(ValueError, match=message):
        fh.Camera((0, 0, 0), (0, 0, -1), (0, 1, 0), 1, 1, 1, 10, 10, **given)


@pytest.mark.parametrize(
    ("projection", "parameters"),
    [("opencv", {"k1": -0.2, "p1": 0.01}), ("fov", {"omega": 0.9})],
)
def test_distorted_cameras_have_a_lens(tmp_path, projection, parameters):
    pinhole = fh.Camera.from_intrinsics(
        [40, 42, 24, 21],
        rows=40,
        columns=50,
        convention="colmap",
        pose=[[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 5]],
        projection=projection,
        parameters=parameters,
    )
    lens = pinhole.thin_lens(0.5, (3, 2, 1))
    assert (lens.aperture, lens.focus) == (0.5, 4.0)
    assert pickle.loads(pickle.dumps(lens)) == lens
    assert eval(repr(lens), {"Camera": fh.Camera}) == lens
    assert np.array_equal(pinhole.rays()[1], lens.rays()[1], equal_nan=True)
    assert lens.to_colmap().params == pinhole.to_colmap().params
    if projection == "opencv":
        assert np.array_equal(lens.to_opencv().distortion, pinhole.to_opencv().distortion)
    own, sharp = (fh.render(dots(), each, samples=16) for each in (lens, pinhole))
    assert not np.array_equal(own["color"], sharp["color"])
    own.save(tmp_path / "a.exr")
    assert fh.Camera.load(tmp_path / "a.exr") == lens


def test_a_ball_out_of_focus_is_distorted_as_all_else():
    # The circle of confusion is one of the undistorted image, around the axis the same all around.
    rows = columns = 200
    camera = fh.Camera.from_intrinsics(
        [150, 150, 100, 100],
        rows=rows,
        columns=columns,
        convention="gltf",
        projection="opencv",
        parameters={"k1": -0.3},
    )
    lens = camera.thin_lens(1.5, 2.0)
    scene = fh.Scene()
    scene.add(fh.Sphere(center=(0, 0, -20), radius=0.02))
    samples = 1024 if FULL else 200
    frame = fh.render(scene, lens, background="transparent", samples=samples)
    covered = frame["color"][..., 3]
    blur = 1.5 * (20 - 2) / (20 * 2) / 2
    edge = 150 * blur * (1 - 0.3 * blur**2)
    assert edge < 0.97 * 150 * blur
    v, u = np.nonzero(covered)
    farthest = np.hypot(u + 0.5 - 100, v + 0.5 - 100).max()
    assert farthest == pytest.approx(edge, abs=1.5)


def test_other_projections_have_none():
    panorama = fh.Camera.equirectangular((0, 0, 0), (0, 1, 0), (0, 0, 1), 10, 20)
    with pytest.raises(ValueError, match="opencv and fov have a thin lens, got equirec"):
        panorama.thin_lens(0.1, 2)
    with pytest.raises(ValueError, match="focus must be positive and finite, got -1"):
        camera().thin_lens(0.1, (0, 0, 6))
