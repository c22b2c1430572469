"""Pictures of a job in parts are those of `render`."""

import firsthit as fh
import numpy as np
import pytest
from many_support import cameras, red, scene

pytestmark = pytest.mark.usefixtures("workers_find_the_tests")


def test_pictures_are_those_of_render(tmp_path):
    views = cameras(3)
    made = fh.render_many(
        scene(), views, tmp_path, channels=["z", "object"], save=[".npz", ".png", ".exr"]
    )
    for k, view in enumerate(views):
        frame = fh.render(scene(), view, channels=["z", "object"])
        folder = tmp_path / "parts" / f"{k:06d}"
        for name in ("z", "object"):
            npz, exr = (fh.Frame.load(folder / f"{k:06d}{end}")[name] for end in (".npz", ".exr"))
            np.testing.assert_array_equal(npz, frame[name])
            np.testing.assert_array_equal(exr, frame[name].astype(np.float32))
        names = {path.name for path in folder.iterdir()}
        assert names == {
            "part.json",
            *(f"{k:06d}{end}" for end in (".npz", ".exr", ".z.png", ".object.png")),
        }
    assert fh.parts(tmp_path).digest == made.digest


def test_cameras_by_name_and_looks_are_those_of_render(tmp_path):
    (view,) = cameras(1)
    look = {"samples": 2, "shade": red, "objects": ["ball"]}
    fh.render_many(scene(), {"front": view}, tmp_path, on=fh.many.processes(1), **look)
    read = fh.Frame.load(tmp_path / "parts" / "000000" / "front.npz")
    np.testing.assert_array_equal(read["color"], fh.render(scene(), view, **look)["color"])
    with pytest.raises(fh.FileWriteError, match="the folder is another job's"):
        fh.render_many(scene(), {"back": view}, tmp_path, **look)
    with pytest.raises(fh.FileWriteError, match="another job's: its look"):
        fh.render_many(scene(), {"front": view}, tmp_path, **{**look, "samples": 1})


LOOKS = {
    "samples": 2,
    "shade": fh.Shader("phong", shininess=9),
    "edges": fh.Edges(1.5, kinds="silhouette"),
    "ground": True,
    "color_by": np.array([3.0, 1.0]),
    "color_map": "turbo",
    "color_range": (0, np.float64(4)),
}


@pytest.mark.parametrize(
    "look",
    [LOOKS | {"light": "studio"}, LOOKS | {"environment": fh.Environment.daylight(20, 70)}],
    ids=["light", "environment"],
)
def test_all_looks_are_those_of_render(look, tmp_path):
    on, views = fh.many.processes(1), cameras(2)
    made = fh.render_many(scene(), views, tmp_path, on=on, **look)
    for k, view in enumerate(views):
        path = tmp_path / "parts" / f"{k:06d}" / f"{k:06d}.npz"
        expected = fh.render(scene(), view, **look)
        np.testing.assert_array_equal(fh.Frame.load(path)["color"], expected["color"])
        said = fh.read_metadata(path)
        for name in ("scene", "shading", "colors"):
            assert said[name] == expected.metadata[name]
    again = fh.render_many(scene(), views, tmp_path, **look)
    assert (again.kept, again.digest) == (2, made.digest)
    for name, value in {"edges": 1.0, "ground": False, "color_by": [3.0, 2.0]}.items():
        with pytest.raises(fh.FileWriteError, match="another job's: its look"):
            fh.render_many(scene(), views, tmp_path, **{**look, name: value})
    if "environment" in look:
        other = {**look, "environment": fh.Environment.daylight(21, 70)}
        with pytest.raises(fh.FileWriteError, match="another job's"):
            fh.render_many(scene(), views, tmp_path, **other)


def test_an_environment_goes_with_the_file_of_a_scene(tmp_path):
    lit = scene()
    lit.shading = fh.Shading(light="studio")
    lit.save(tmp_path / "a.fhs")
    (view,), sky = cameras(1), fh.Environment.gradient("white", "blue")
    how = {"on": fh.many.processes(1), "environment": sky, "samples": 2}
    fh.render_many(tmp_path / "a.fhs", {"a": view}, tmp_path / "out", **how)
    read = fh.Frame.load(tmp_path / "out" / "parts" / "000000" / "a.npz")
    expected = fh.render(fh.open(tmp_path / "a.fhs"), view, environment=sky, samples=2)
    np.testing.assert_array_equal(read["color"], expected["color"])
    assert fh.open(tmp_path / "a.fhs").environment is None


def test_lines_of_the_scene_are_part_of_a_job(tmp_path):
    drawn = scene()
    fh.render_many(drawn, cameras(1), tmp_path)
    drawn.edges = fh.Edges(2)
    with pytest.raises(fh.FileWriteError, match="another job's"):
        fh.render_many(drawn, cameras(1), tmp_path)


def test_numbers_that_json_has_not_are_part_of_a_job(tmp_path):
    endless = scene()
    endless.shading = fh.Shading("direct", colors=fh.Colors([np.nan, 2.0], missing="red"))
    assert endless.shading.shade["reach"] == np.inf
    look = {"shade": fh.Shader("lambert", depth_far=np.inf)}
    for kept in (0, 1):
        assert fh.render_many(endless, cameras(1), tmp_path, **look).kept == kept
    endless.shading = fh.Shading("direct", reach=3.0, colors=endless.shading.colors)
    with pytest.raises(fh.FileWriteError, match="another job's"):
        fh.render_many(endless, cameras(1), tmp_path, **look)


def test_far_and_dtype_are_those_of_save_and_render(tmp_path):
    (view,) = cameras(1)
    how = {"channels": ["z"], "save": [".png", ".npz"], "png_scale": 1e-4}
    fh.render_many(scene(), {"a": view}, tmp_path / "out", **how, far="zero", dtype=np.float32)
    frame = fh.render(scene(), view, channels="z", dtype="float32")
    frame.save(tmp_path / "a.png", png_scale=1e-4, far="zero")
    made = tmp_path / "out" / "parts" / "000000"
    assert (made / "a.png").read_bytes() == (tmp_path / "a.png").read_bytes()
    with np.load(made / "a.npz") as file:
        assert file["z"].dtype == np.float32
        np.testing.assert_array_equal(file["z"], frame["z"])
    for other in ({"far": "saturate", "dtype": "float32"}, {"far": "zero"}):
        with pytest.raises(fh.FileWriteError, match="another job's"):
            fh.render_many(scene(), {"a": view}, tmp_path / "out", **how, **other)
    with pytest.raises(ValueError, match="far needs png_scale"):
        fh.render_many(scene(), [view], tmp_path / "b", channels="z", far="zero")


def test_exposure_and_tone_map_are_those_of_save(tmp_path):
    (view,), how = cameras(1), {"exposure": -1, "tone_map": "agx"}
    fh.render_many(scene(), {"a": view}, tmp_path / "out", save=[".png", ".npz"], **how)
    frame = fh.render(scene(), view)
    frame.save(tmp_path / "a.png", **how)
    made = tmp_path / "out" / "parts" / "000000"
    assert (made / "a.png").read_bytes() == (tmp_path / "a.png").read_bytes()
    np.testing.assert_array_equal(fh.Frame.load(made / "a.npz")["color"], frame["color"])
    other = {**how, "exposure": -2}
    with pytest.raises(fh.FileWriteError, match="another job's: its exposure"):
        fh.render_many(scene(), {"a": view}, tmp_path / "out", save=[".png", ".npz"], **other)


def test_depths_are_in_png_by_steps(tmp_path):
    cv2 = pytest.importorskip("cv2")
    (view,) = cameras(1)
    how = {"channels": ["z", "object"], "save": ".png", "png_scale": 0.001}
    fh.render_many(scene(), {"a": view}, tmp_path, **how)
    read = cv2.imread(str(tmp_path / "parts" / "000000" / "a.z.png"), cv2.IMREAD_UNCHANGED)
    z = fh.render(scene(), view, channels="z")["z"]
    assert read.dtype == np.uint16
    np.testing.assert_allclose(read[np.isfinite(z)] * 0.001, z[np.isfinite(z)], atol=0.0005 + 1e-9)
    with pytest.raises(fh.FileWriteError, match="png_scale"):
        fh.render_many(scene(), {"a": view}, tmp_path, **{**how, "png_scale": 0.002})


@pytest.mark.parametrize("background", ["red", (1, 0, 0), np.zeros(3), "transparent"])
def test_colours_and_numpy_s_numbers_are_part_of_a_job(background, tmp_path):
    how = {"background": background, "samples": np.int64(2), "shadows": False}
    for kept in (0, 1):
        made = fh.render_many(scene(), cameras(1), tmp_path, **how)
        assert (made.made, made.kept) == (1 - kept, kept)


def test_cameras_are_drawn_as_they_are_needed(tmp_path):
    """A sequence of one's own makes a camera at a time."""
    asked = []

    class Turning:
        def __len__(self):
            return 40

        def __getitem__(self, k):
            if not 0 <= k < 40:
                raise IndexError(k)
            asked.append(k)
            return cameras(40)[k]

    from collections.abc import Sequence

    Sequence.register(Turning)
    made = fh.render_many(scene(), Turning(), tmp_path, channels="z", part=(4, 8))
    assert made.made == 5
    # Each once for the digest, the first for a try, and then those of the part.
    assert asked == [*range(40), 0, *range(15, 20)]
