"""Looks of pictures in a data set: as `render` makes them, or refused."""

import re
import shutil

import firsthit as fh
import numpy as np
import pytest
from dataset_support import PLANS, plan, record

#: A small camera, and colours alone.
EYE = {"name": "eye", "columns": 16, "rows": 12, "fov": 50.0}


def of_look(look, *, sensors=(EYE,), **output):
    """A plan of two frames with a look."""

    def change(made):
        made["sensors"] = list(sensors)
        made["poses"] |= {"count": 2}
        made["output"] = {"pictures": ["color"], "frames": ["npz"], **output, **look}

    return plan(change)


@pytest.fixture
def folder(tmp_path):
    """A plan's folder, with a scene and a picture of all directions."""
    made = tmp_path / "plans"
    made.mkdir()
    shutil.copy(PLANS / "yard.toml", made)
    texels = bytes([9, 99, 199, 128, 99, 9, 199, 129])
    (made / "sky.hdr").write_bytes(b"#?RADIANCE\n\n-Y 1 +X 2\n" + texels)
    return made


def camera_of(folder, out, frame=0):
    """The camera of a frame, as its file has it."""
    return fh.Camera.load(out / "frames" / f"{frame:06d}" / "eye.npz")


def sky(folder):
    return fh.Environment(folder / "sky.hdr", rotate=30, strength=0.5)


@pytest.mark.parametrize(
    ("look", "told"),
    [
        (
            {"shade": {"name": "phong", "shininess": 9, "flat": True, "specular": "red"}},
            {"shade": fh.Shader("phong", shininess=9, flat=True, specular="red")},
        ),
        ({"light": "overcast", "ground": False, "samples": 3}, None),
        ({"ambient": [0.5, 0, 0], "shadows": False, "background": "white"}, None),
        ({"color_by": "height", "color_map": "turbo", "color_range": [0, 2]}, None),
        ({"color_by": list(range(5)), "shade": "unlit"}, None),
        (
            {"color_by": {"by": "object", "map": "blues", "range": [1, 3], "above": "red"}},
            {"color_by": fh.Colors("object", map="blues", range=(1, 3), above="red")},
        ),
        ({"edges": 1.5}, None),
        (
            {"edges": {"kinds": "object", "hidden": [4, 2], "color": [1, 0, 0], "width": 2}},
            {"edges": fh.Edges(2, kinds="object", hidden=(4, 2), color=(1, 0, 0))},
        ),
        (
            {"environment": {"file": "sky.hdr", "rotate": 30, "strength": 0.5}},
            {"environment": sky},
        ),
        (
            {"environment": {"daylight": {"elevation": 20, "azimuth": 50}, "up": [0, 0, 2]}},
            {"environment": fh.Environment.daylight(20, 50, up=(0, 0, 2))},
        ),
        (
            {"environment": {"above": "white", "below": [0, 0, 0], "seen": False}},
            {"environment": fh.Environment.hemispheres("white", "black", seen=False)},
        ),
        (
            {"environment": {"horizon": "white", "zenith": "blue"}},
            {"environment": fh.Environment.gradient("white", "blue")},
        ),
        ({"environment": {"color": "tan"}}, {"environment": fh.Environment.uniform("tan")}),
    ],
)
def test_frames_are_those_of_render(folder, tmp_path, look, told):
    told = look if told is None else told
    told = {name: value(folder) if callable(value) else value for name, value in told.items()}
    made, out = fh.Plan.from_dict(of_look(look), folder), tmp_path / "out"
    fh.dataset(made, out, part=(1, 2))
    frame = fh.render(fh.load(folder / "yard.toml"), camera_of(folder, out), **told)
    kept = fh.Frame.load(out / "frames" / "000000" / "eye.npz")
    np.testing.assert_array_equal(kept["color"], frame["color"])
    plain = fh.render(fh.load(folder / "yard.toml"), camera_of(folder, out))
    assert not np.array_equal(kept["color"], plain["color"])
    assert kept.metadata.get("colors") == frame.metadata.get("colors")


def test_pngs_are_shown_as_the_plan_says_and_else_as_the_scene(folder, tmp_path):
    with (folder / "yard.toml").open("a") as file:
        file.write('\n[display]\nexposure = -1\ntone_map = "aces"\n')
    scene = fh.load(folder / "yard.toml")
    for k, shown in enumerate([{}, {"tone_map": "agx"}, {"exposure": 1.5, "tone_map": "none"}]):
        out = tmp_path / f"out {k}"
        fh.dataset(fh.Plan.from_dict(of_look(shown), folder), out, part=(1, 2))
        frame = fh.render(scene, camera_of(folder, out))
        frame.save(tmp_path / "a.png", **shown)
        png = out / "frames" / "000000" / "eye.color.png"
        assert png.read_bytes() == (tmp_path / "a.png").read_bytes()


def test_a_thin_lens_has_colours(folder, tmp_path):
    lens = EYE | {"aperture": 0.3, "focus": 5.0}
    made = fh.dataset(fh.Plan.from_dict(of_look({}, sensors=[lens]), folder), tmp_path / "out")
    assert made.made == 2
    one = fh.Plan.from_dict(of_look({"samples": 1}, sensors=[lens]), folder)
    with pytest.raises(ValueError, match="samples must be at least 2"):
        fh.dataset(one, tmp_path / "one")


def test_samples_are_of_all_channels_that_are_made_of_them(folder, tmp_path):
    look = {"channels": ["ao", "z"], "pictures": [], "samples": 2}
    out = tmp_path / "out"
    fh.dataset(fh.Plan.from_dict(of_look(look), folder), out, part=(1, 2))
    view = camera_of(folder, out)
    frame = fh.render(fh.load(folder / "yard.toml"), view, channels="ao", samples=2)
    kept = fh.Frame.load(out / "frames" / "000000" / "eye.npz")
    np.testing.assert_array_equal(kept["ao"], frame["ao"])


def test_a_picture_of_all_directions_is_part_of_the_plan(folder, tmp_path):
    look = of_look({"environment": {"file": "sky.hdr"}})
    first = fh.Plan.from_dict(look, folder)
    alone, out = fh.dataset(first, tmp_path / "alone"), tmp_path / "out"
    assert fh.dataset(first, out, on=fh.many.processes(1)).digest == alone.digest
    assert record(out, 0)["plan"] == first.digest
    path = folder / "sky.hdr"
    path.write_bytes(path.read_bytes()[:-1] + bytes([130]))
    other = fh.Plan.from_dict(look, folder)
    assert other.digest != first.digest
    assert fh.dataset(other, tmp_path / "other").digest != alone.digest
    with pytest.raises(fh.FileWriteError, match="another job's"):
        fh.dataset(other, out)


def test_lines_of_a_scene_file_are_part_of_a_job(folder, tmp_path):
    made = fh.Plan.from_dict(of_look({}), folder)
    fh.dataset(made, tmp_path / "out", part=(1, 2))
    with (folder / "yard.toml").open("a") as file:
        file.write("\n[edges]\nwidth = 3\n")
    with pytest.raises(fh.FileFormatError, match="not what it was when the job began"):
        fh.dataset(made, tmp_path / "out")


@pytest.mark.parametrize(
    ("look", "words"),
    [
        ({"color_by": {"map": "turbo"}}, "output.color_by: this table needs `by`: a text"),
        ({"color_by": ""}, "`color_by` must be a text, not empty, or an array"),
        ({"color_by": True}, "each item a finite number, or a table, got true"),
        ({"color_map": "jet"}, '`color_map` must be one of "viridis"'),
        (
            {"color_range": [2, 1]},
            "`color_range` must be two finite numbers that rise, [low, high], got [2",
        ),
        ({"shade": {"name": "phong", "shinyness": 3}}, "`shinyness`, did you mean `shininess`?"),
        ({"shade": {"name": "phong", "flat": 1}}, "output.shade: `flat` must be true or false"),
        ({"shade": {"shininess": 3}}, "output.shade: this shade needs `name`"),
        ({"shade": {"name": "phong", "shininess": -3}}, "output.shade: `shininess` must be"),
        ({"shade": "unlit", "ambient": "red"}, "ambient is no setting of the shader"),
        ({"light": "neon"}, '`light` must be one of "auto", "studio"'),
        ({"ground": "yes"}, "`ground` must be true or false"),
        ({"edges": -1}, "`edges` must be a number above 0 and up to 1000, or a table"),
        (
            {"edges": "thin"},
            '`edges` must be a number above 0 and up to 1000, or a table, got "thin"',
        ),
        ({"edges": {"kinds": ["fold"]}}, 'output.edges: `kinds` must be one of "silhouette"'),
        ({"edges": {"colour": "red"}}, "output.edges: unknown key `colour`, did you mean `color`?"),
        ({"environment": {"strength": 2}}, "this environment needs `file` or `color`"),
        (
            {"environment": {"color": "red", "horizon": "red"}},
            "unknown key `horizon`; this table takes color",
        ),
        ({"environment": {"color": "red", "up": [0, 0, 1]}}, "unknown key `up`"),
        ({"environment": {"color": "red", "rotate": 3}}, "unknown key `rotate`"),
        ({"environment": {"above": "red"}}, "output.environment: this table needs `below`"),
        (
            {"environment": {"color": [1, -1, 1]}},
            "output.environment: `color` must be linear [red, green, blue], none of them negative",
        ),
        ({"environment": {"daylight": {"elevation": 95}}}, "output.environment.daylight: `elevat"),
        (
            {"environment": {"daylight": {"elevation": 5, "sun": False}}},
            "the sun of a plan's daylight always",
        ),
        ({"environment": {"file": "../sky.hdr"}}, "the path has .."),
        ({"environment": {"file": "sky.hdr", "rotate": {"axis": [0, 0, 1]}}}, "`axis` needs `deg"),
        ({"environment": {"file": "sky.hdr"}, "light": "sun"}, "exclude each other"),
        ({"environment": "sky.hdr"}, "output: `environment` must be a table"),
        ({"exposure": float("inf")}, "`exposure` must be a finite number"),
        ({"tone_map": "film"}, '`tone_map` must be one of "none", "neutral", "agx", "aces"'),
        ({"pictures": [], "exposure": 1}, "`exposure` does nothing here: there is not color"),
        ({"pictures": [], "channels": ["z"], "light": "sun"}, "`light` does nothing here"),
        ({"pictures": [], "channels": ["z"], "color_by": "face"}, "`color_by` does nothing here"),
        ({"pictures": [], "channels": ["z"], "edges": 1}, "`edges` does nothing here"),
        ({"pictures": [], "channels": ["z"], "samples": 2}, "`samples` does nothing here"),
    ],
)
def test_what_makes_no_sense_is_refused_when_the_plan_is_read(folder, look, words):
    with pytest.raises(ValueError, match=re.escape(words)):
        fh.Plan.from_dict(of_look(look), folder)


def test_a_file_that_is_no_picture_is_refused_when_the_plan_is_read(folder):
    (folder / "sky.hdr").write_bytes(b"#?RADIANCE\n\n-Y 1 +X 2\n")
    with pytest.raises(fh.FileFormatError, match=r"sky\.hdr"):
        fh.Plan.from_dict(of_look({"environment": {"file": "sky.hdr"}}), folder)


def test_lines_are_refused_of_sensors_that_move_while_they_see(folder):
    drive = {"body": "forwards-left-up", "times": [0, 9], "positions": [[0, 0, 0], [1, 0, 0]]}
    rolling = EYE | {"kind": "rolling_shutter", "readout": 0.1}

    def change(made):
        made["poses"] = {"kind": "path", "trajectory": drive, "rate": 1, "end": 2}

    given = of_look({"edges": 1}, sensors=[rolling])
    change(given)
    with pytest.raises(ValueError, match="`edges` must be left out: sensor 'eye' moves"):
        fh.Plan.from_dict(given, folder)


@pytest.mark.parametrize(
    ("look", "words"),
    [
        ({"color_by": "heat"}, "heat"),
        ({"color_by": [1, 2]}, "2 for 5 objects"),
        ({"color_map": "turbo"}, "color_map needs color_by"),
    ],
)
def test_what_does_not_fit_a_scene_is_told_before_anything_is_made(folder, tmp_path, look, words):
    with pytest.raises(ValueError, match=rf"scene 'yard\.toml': .*{words}"):
        fh.dataset(fh.Plan.from_dict(of_look(look), folder), tmp_path / "out")
    assert not (tmp_path / "out").exists()
