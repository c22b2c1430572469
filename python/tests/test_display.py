"""Exposure and tone maps: of PNGs alone, by the frame's own display unless told otherwise."""

import io
import json
import pickle
import subprocess
import sys

import firsthit as fh
import numpy as np
import pytest
from support import ROOT, ball

SCENE = """
[camera]
position = [0, -6, 3]
look_at = [0, 0, 0.5]
columns = 32
rows = 24
[[objects]]
shape = "sphere"
center = [0, 0, 0.5]
radius = 0.5
[[lights]]
kind = "point"
position = [0, -3, 4]
intensity = [90, 60, 30]
[display]
exposure = -1.5
tone_map = "agx"
"""
COLORS = np.array([[[0.0, 0.25, 0.5], [1.0, 2.0, 40.0]]], np.float32)


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    return path


def pixels(source):
    from PIL import Image

    source = io.BytesIO(source) if isinstance(source, bytes) else source
    with Image.open(source) as picture:
        return np.asarray(picture)


def bytes_of(linear):
    linear = np.clip(np.asarray(linear, float), 0, 1)
    curve = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.floor(255 * curve + 0.5)


def test_a_frame_of_a_scene_file_is_saved_as_the_program_shows_it(path, tmp_path):
    fh.render(fh.load(path)).save(tmp_path / "ours.png")
    command = [sys.executable, "-m", "firsthit", "render", path, "-o", tmp_path / "theirs.png"]
    subprocess.run(command, check=True, capture_output=True)
    assert (tmp_path / "ours.png").read_bytes() == (tmp_path / "theirs.png").read_bytes()
    (channel,) = fh.read_metadata(tmp_path / "ours.png")["channels"]
    assert channel["stored"]["exposure"] == -1.5
    assert channel["stored"]["tone_map"] == "agx"


def test_a_frame_stays_linear(path, tmp_path):
    scene = fh.load(path)
    shown = fh.render(scene)
    scene.display = fh.Display()
    plain = fh.render(scene)
    np.testing.assert_array_equal(shown["color"], plain["color"])
    assert (shown.display, plain.display) == (fh.Display(-1.5, "agx"), fh.Display())
    for extension in ("exr", "npz", "npy"):
        for name, frame in (("a", shown), ("b", plain)):
            frame.save(tmp_path / f"{name}.{extension}")
        files = [(tmp_path / f"{name}.{extension}").read_bytes() for name in "ab"]
        assert files[0] == files[1]


def test_exposure_and_tone_map_are_arguments_of_save(tmp_path):
    frame = fh.Frame((1, 2), {"color": COLORS})
    frame.save(tmp_path / "a.png", exposure=-2)
    np.testing.assert_array_equal(pixels(tmp_path / "a.png"), bytes_of(COLORS / 4))
    frame.save(tmp_path / "b.png", tone_map="neutral")
    assert (pixels(tmp_path / "b.png")[0, 1, :2] < 255).all()
    frame.display = fh.Display(-2, "neutral")
    frame.save(tmp_path / "c.png", tone_map="none")
    assert (tmp_path / "c.png").read_bytes() == (tmp_path / "a.png").read_bytes()
    frame.save(tmp_path / "d.png", exposure=0)
    assert (tmp_path / "d.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_other_channels_are_shown_as_before(tmp_path):
    camera = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 45, rows=6, columns=8)
    frame = fh.render(ball(), camera, channels=("t", "normal", "object"))
    frame.save(tmp_path / "{channel}.png")
    before = {name: (tmp_path / f"{name}.png").read_bytes() for name in frame}
    frame.save(tmp_path / "{channel}.png", exposure=3, tone_map="aces")
    assert before == {name: (tmp_path / f"{name}.png").read_bytes() for name in frame}


def test_a_notebook_shows_a_frame_by_its_display():
    frame = fh.Frame((1, 2), {"color": COLORS})
    np.testing.assert_array_equal(pixels(frame._png()), bytes_of(COLORS))
    frame.display = fh.Display(exposure=-1)
    np.testing.assert_array_equal(pixels(frame._png()), bytes_of(COLORS / 2))


def test_edges_of_a_transparent_picture_have_the_colour_of_the_inside(tmp_path):
    color = np.array([4.0, 1.0, 0.25])
    alpha = np.array([1.0, 0.5, 0.125])[None, :, None]
    frame = fh.Frame((1, 3), {"color": np.concatenate([color * alpha, alpha], axis=-1)})
    frame.save(tmp_path / "a.png", exposure=0.5, tone_map="aces")
    read = pixels(tmp_path / "a.png")
    np.testing.assert_array_equal(read[0, :, 3], [255, 128, 32])
    np.testing.assert_array_equal(read[0, 1:, :3], read[0, [0, 0], :3])


def test_a_scene_keeps_its_display(path, tmp_path):
    scene = fh.load(path)
    assert scene.display == fh.Display(-1.5, "agx")
    assert pickle.loads(pickle.dumps(scene)).display == scene.display
    scene.save(tmp_path / "scene.fhs")
    assert fh.open(tmp_path / "scene.fhs").display == scene.display
    assert fh.Scene().display == fh.Display() == fh.Display(0, "none")
    frame = fh.render(scene)
    assert pickle.loads(pickle.dumps(frame)).display == scene.display


def test_pictures_of_many_are_shown_by_the_scene_s_display(path, tmp_path):
    scene = fh.load(path)
    fh.render_many(scene, [scene.camera()], tmp_path / "out", save=".png")
    fh.render(scene).save(tmp_path / "one.png")
    (made,) = (tmp_path / "out" / "parts").glob("*/*.png")
    assert made.read_bytes() == (tmp_path / "one.png").read_bytes()
    scene.display = fh.Display()
    with pytest.raises(fh.FileWriteError):
        fh.render_many(scene, [scene.camera()], tmp_path / "out", save=".png")


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: fh.Display(np.nan), "exposure must be finite, got nan"),
        (lambda: fh.Display("1"), "exposure must be a number, got '1'"),
        (
            lambda: fh.Display(tone_map="filmic"),
            "tone_map must be one of none, neutral, agx, aces, got 'filmic'",
        ),
        (
            lambda: fh.Frame((1, 2), {"color": COLORS}).save("never.png", exposure=np.inf),
            "exposure must be finite, got inf",
        ),
    ],
)
def test_what_makes_no_sense_is_refused(make, words):
    with pytest.raises(ValueError, match=words):
        make()
    for thing in (fh.Scene(), fh.Frame((1, 2), {"color": COLORS})):
        with pytest.raises(TypeError, match="display must be a Display, got 'agx'"):
            thing.display = "agx"


def test_the_metadata_of_a_shown_picture_follow_the_schema(tmp_path):
    jsonschema = pytest.importorskip("jsonschema")
    schema = json.loads((ROOT / "docs" / "output-metadata.schema.json").read_text())
    camera = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 45, rows=6, columns=8)
    fh.render(ball(), camera).save(tmp_path / "a.png", exposure=-1, tone_map="neutral")
    jsonschema.Draft202012Validator(schema).validate(fh.read_metadata(tmp_path / "a.png"))
    assert fh.Frame.load(tmp_path / "a.png").shape == (6, 8)
