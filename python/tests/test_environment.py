"""Light from all around: what it shows, what it lights, and how it is kept."""

from __future__ import annotations

import copy
import pickle
from typing import TYPE_CHECKING

import firsthit as fh
import numpy as np
import pytest

if TYPE_CHECKING:
    from collections.abc import Callable
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


def still() -> tuple[fh.Scene, fh.Camera]:
    """A ball, and a camera that looks at it and past it."""
    scene = fh.Scene()
    scene.add(fh.Sphere(center=(0, 0, 0), radius=1), color=(0.5, 0.25, 1.0))
    return scene, fh.Camera.look_at((0, -9, 0), (0, 0, 0), (0, 0, 1), 30, 9, 9)


def assert_same(one: fh.Frame, other: fh.Frame) -> None:
    np.testing.assert_array_equal(one["color"], other["color"])
    assert one.metadata == other.metadata


@pytest.mark.parametrize("objects", [None, "ball"])
def test_a_picture_may_have_its_own_in_place_of_the_scene_s(objects: str | None) -> None:
    scene, camera = still()
    scene.add(fh.Sphere(center=(2, 0, 0), radius=0.5), name="ball")
    own = fh.Environment.from_array(columns(), rotate=20)
    scene.environment = fh.Environment.uniform("red")
    before = fh.render(scene, camera, objects=objects, samples=2)
    made = fh.render(scene, camera, environment=own, objects=objects, samples=2)
    assert_same(fh.render(scene, camera, objects=objects, samples=2), before)
    again = fh.render(scene, camera, environment=own, objects=objects, samples=2)
    scene.environment = own
    expected = fh.render(scene, camera, objects=objects, samples=2)
    assert_same(made, expected)
    assert_same(again, expected)
    assert not np.array_equal(expected["color"], before["color"])


def test_a_picture_s_own_lies_by_the_scene_s_up_and_is_of_moved_objects() -> None:
    scene, camera = still()
    own = fh.Environment.hemispheres("white", "black")
    for up in ((0.0, 0.0, 1.0), UP_Y):
        scene.up = up
        scene.move(0, np.diag([1.0, 1.0, 1.0 + up[2], 1.0]))
        made = fh.render(scene, camera, environment=own)
        lit, _ = still()
        lit.up = up
        lit.move(0, np.diag([1.0, 1.0, 1.0 + up[2], 1.0]))
        lit.environment = own
        np.testing.assert_array_equal(made["color"], fh.render(lit, camera)["color"])


def test_a_picture_s_own_daylight_has_its_sun_beside_the_scene_s_lights() -> None:
    scene, camera = still()
    lamp = fh.PointLight((0, -5, 5), intensity=(3, 3, 3))
    scene.add_light(lamp)
    sky = fh.Environment.daylight(elevation=30, azimuth=200, strength=0.5)
    made = fh.render(scene, camera, environment=sky)
    assert scene.lights == (lamp,)
    scene.environment = sky
    without = fh.render(scene, camera)
    scene.add_light(sky.sun(scene.up))
    assert_same(made, fh.render(scene, camera))
    assert not np.array_equal(made["color"], without["color"])


def test_a_picture_s_own_is_that_of_the_command_line(
    tmp_path: Path, firsthit: Callable[..., tuple[int, str, str]]
) -> None:
    around = hdr(tmp_path / "a.hdr", [[k, 99, 2 * k, 128] for k in range(1, 5)])
    file, out = tmp_path / "ball.toml", tmp_path / "a.npz"
    ball = 'shape = "sphere"\ncenter = [0, 0, 0]\nradius = 1\n'
    rig = '[shading]\nlight = "studio"\n'
    file.write_text(f"up = [0, 1, 0]\n[[objects]]\n{ball}{rig}")
    turned = fh.Environment(around, rotate=30, strength=2.0, seen=False)
    day = fh.Environment.daylight(40, 100)
    for option, more, own in (
        (f"{around}@30", ("--environment-strength", 2, "--environment-hidden"), turned),
        ("daylight:40,100", (), day),
    ):
        size = "--size", "16x12", "--samples", 4, "--channels", "color", "-o", out, "--quiet"
        code, _, said = firsthit("render", file, "--environment", option, *more, *size)
        assert (code, said) == (0, "")
        scene = fh.load(file)
        camera = fh.Camera.framing(scene, rows=12, columns=16)
        made = fh.render(scene, camera, samples=4, environment=own)
        np.testing.assert_array_equal(fh.Frame.load(out)["color"], made["color"])
        assert fh.read_metadata(out)["shading"] == made.metadata["shading"]


def test_a_picture_s_own_that_would_do_nothing_is_refused() -> None:
    scene, camera = still()
    sky = fh.Environment.uniform("white")
    with pytest.raises(ValueError, match="environment and light exclude each other"):
        fh.render(scene, camera, environment=sky, light="studio")
    with pytest.raises(ValueError, match="environment does nothing with a shade of one's own"):
        fh.render(scene, camera, environment=sky, shade=lambda hits: np.zeros((*hits.shape, 3)))
    with pytest.raises(TypeError, match="environment must be an Environment or None"):
        fh.render(scene, camera, environment="a.hdr")  # type: ignore[arg-type]


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
