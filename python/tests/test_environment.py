"""Light from all around: what it shows, what it lights, and how it is kept."""

from __future__ import annotations

import copy
import pickle
from typing import TYPE_CHECKING

import firsthit as fh
import numpy as np
import pytest

if TYPE_CHECKING:
    from pathlib import Path

UP_Y = (0.0, 1.0, 0.0)


def hdr(path: Path, texels: list[list[int]]) -> Path:
    """Write a Radiance picture of one row."""
    head = f"#?RADIANCE\n\n-Y 1 +X {len(texels)}\n"
    path.write_bytes(head.encode() + bytes(byte for texel in texels for byte in texel))
    return path


def columns() -> np.ndarray:
    """Four columns, of which the middle is between the second and the third."""
    return np.repeat(np.arange(1.0, 5.0, dtype=np.float32)[None, :, None], 3, axis=2)


def test_a_file_shows_its_numbers_and_turns(tmp_path: Path) -> None:
    path = hdr(tmp_path / "a.hdr", [[k, 0, 2 * k, 136] for k in range(1, 5)])
    around = fh.Environment(path, strength=2.0)
    np.testing.assert_allclose(around.radiance((1, 0, 0)), [5.0, 0.0, 10.0])
    # +z is to the right where y is up, -y where z is.
    np.testing.assert_allclose(around.radiance((0, 0, 1), up=UP_Y)[0], 7.0)
    np.testing.assert_allclose(around.radiance((0, -1, 0))[0], 7.0)
    turned = fh.Environment(path, rotate=90, up=UP_Y)
    np.testing.assert_allclose(turned.radiance((1, 0, 0))[0], 3.5)
    about = fh.Environment(path, rotate=((0, -2, 0), 90), up=UP_Y)
    np.testing.assert_allclose(about.radiance((1, 0, 0))[0], 1.5)


def test_a_picture_is_lit_and_filled_by_it() -> None:
    scene = fh.Scene()
    scene.add(fh.Sphere(center=(0, 0, 0), radius=1), color=(0.5, 0.25, 1.0))
    scene.environment = fh.Environment.uniform((0.8, 0.8, 0.4))
    camera = fh.Camera.look_at((0, -9, 0), (0, 0, 0), (0, 0, 1), 30, 9, 9)
    color = fh.render(scene, camera, ground=False)["color"]
    np.testing.assert_allclose(color[0, 0], [0.8, 0.8, 0.4], rtol=1e-6)
    np.testing.assert_allclose(color[4, 4], [0.4, 0.2, 0.4], rtol=1e-6)
    scene.environment = fh.Environment.uniform((0.8, 0.8, 0.4), seen=False)
    hidden = fh.render(scene, camera, ground=False, background=(0, 0, 0))["color"]
    np.testing.assert_allclose(hidden[0, 0], 0.0)
    np.testing.assert_allclose(hidden[4, 4], color[4, 4])
    scene.environment = None
    dark = fh.render(scene, camera, ground=False, background=(0, 0, 0))["color"]
    assert not np.allclose(dark[4, 4], color[4, 4])


def test_up_is_the_scene_s_unless_the_environment_says_it() -> None:
    scene = fh.Scene()
    scene.environment = fh.Environment.hemispheres((1, 1, 1), (0, 0, 0))
    camera = fh.Camera.look_at((0, 0, 0), (0, 9, -1), (1, 0, 0), 1, 1, 1)
    assert fh.render(scene, camera)["color"].max() == 0
    scene.up = UP_Y
    assert fh.render(scene, camera)["color"].min() == 1
    scene.environment = fh.Environment.hemispheres((1, 1, 1), (0, 0, 0), up=(0, -1, 0))
    assert fh.render(scene, camera)["color"].max() == 0


def test_it_stays_when_objects_change() -> None:
    scene = fh.Scene()
    ball = scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
    scene.environment = around = fh.Environment.uniform("white")
    scene.bounds  # noqa: B018 - builds it
    scene.move(ball, np.diag([1.0, 1.0, 2.0, 1.0]))
    scene.add(fh.Sphere(center=(5, 0, 0), radius=1))
    camera = fh.Camera.look_at((0, -90, 0), (0, 0, 0), (0, 0, 1), 60, 3, 3)
    assert fh.render(scene, camera, ground=False)["color"][0, 0, 0] == 1.0
    assert copy.copy(scene).environment is around


def test_daylight_and_its_sun_light_a_white_ground_by_one() -> None:
    sky = fh.Environment.daylight(elevation=40, azimuth=30)
    scene = fh.Scene()
    scene.add(fh.Plane(point=(0, 0, 0), normal=(0, 0, 1)), color="white")
    scene.environment = sky
    scene.add_light(sky.sun())
    camera = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 40, 8, 8)
    color = fh.render(scene, camera, samples=64, ground=False)["color"].mean((0, 1))
    assert abs(color @ [0.2126, 0.7152, 0.0722] - 1.0) < 0.01
    assert sky.sun().direction[2] < 0 < sky.radiance(np.negative(sky.sun().direction)).min()
    with pytest.raises(ValueError, match="only daylight"):
        fh.Environment.uniform("white").sun()


@pytest.mark.parametrize(
    "around",
    [
        fh.Environment.uniform((1, 2, 3), strength=0.5),
        fh.Environment.hemispheres("white", "black", up=UP_Y),
        fh.Environment.gradient("white", "blue", seen=False),
        fh.Environment.from_array(columns(), rotate=((1, 2, 3), 20)),
        fh.Environment.daylight(turbidity=5, ground="#808080"),
    ],
    ids=repr,
)
def test_it_is_pickled_saved_and_opened(around: fh.Environment, tmp_path: Path) -> None:
    directions = np.random.default_rng(1).normal(size=(20, 3))
    expected = around.radiance(directions)
    again = pickle.loads(pickle.dumps(around))
    np.testing.assert_array_equal(again.radiance(directions), expected)
    scene = fh.Scene()
    scene.environment = around
    scene.save(tmp_path / "a.fhs")
    opened = fh.open(tmp_path / "a.fhs").environment
    assert opened is not None
    np.testing.assert_array_equal(opened.radiance(directions), expected)
    assert (opened.strength, opened.seen) == (around.strength, around.seen)


def test_scene_files_have_one(tmp_path: Path) -> None:
    hdr(tmp_path / "a.hdr", [[128, 64, 32, 129]])
    text = '[environment]\nfile = "a.hdr"\nstrength = 3\nseen = false\n'
    (tmp_path / "a.toml").write_text(text)
    around = fh.load(tmp_path / "a.toml").environment
    assert around is not None
    np.testing.assert_array_equal(around.radiance((1, 2, 3)), [3.0, 1.5, 0.75])
    assert not around.seen


def test_doubtful_texels_are_a_warning_and_wrong_ones_an_error(tmp_path: Path) -> None:
    path = tmp_path / "a.hdr"
    path.write_bytes(b"#?RADIANCE\nEXPOSURE=3\n\n-Y 1 +X 1\n\x02\x01\x01\x80")
    with pytest.warns(fh.FirsthitWarning, match="EXPOSURE=3"):
        fh.Environment(path)
    path.write_bytes(path.read_bytes()[:-1])
    with pytest.raises(fh.FileFormatError, match="too early"):
        fh.Environment(path)
    with pytest.raises(fh.FileReadError):
        fh.Environment(tmp_path / "gone.hdr")
    for wrong in (np.nan, -1.0, np.inf):
        with pytest.raises(ValueError, match="texels"):
            fh.Environment.from_array(np.full((2, 2, 3), wrong))
    for texels in (np.zeros((2, 2)), np.zeros((2, 2, 4)), np.zeros((2, 2, 3), np.uint8)):
        with pytest.raises(ValueError, match="texels"):
            fh.Environment.from_array(texels)


def test_values_that_make_no_sense_are_refused_by_name() -> None:
    for make, name in (
        (lambda: fh.Environment.uniform((1, -1, 1)), "color"),
        (lambda: fh.Environment.uniform("white", strength=-1), "strength"),
        (lambda: fh.Environment.gradient("white", "blue", up=(0, 0, 0)), "up"),
        (lambda: fh.Environment.daylight(elevation=91), "elevation"),
        (lambda: fh.Environment.daylight(turbidity=1), "turbidity"),
        (lambda: fh.Environment.daylight(ground=(2, 0, 0)), "ground"),
        (lambda: fh.Environment.from_array(columns(), rotate=np.inf), "rotate"),
        (lambda: fh.Environment.from_array(columns(), rotate=((0, 0, 0), 1)), "rotate"),
    ):
        with pytest.raises(ValueError, match=name):
            make()
    with pytest.raises(TypeError, match="seen"):
        fh.Environment.uniform("white", seen=1)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="environment"):
        fh.Scene().environment = "sky.hdr"  # type: ignore[assignment]
    with pytest.raises(AttributeError, match="strength"):
        fh.Environment.uniform("white").strength = 2.0
