"""Colours by numbers: the legend, per-object numbers, and what is refused."""

import pickle

import firsthit as fh
import numpy as np
import pytest


@pytest.fixture
def scene():
    scene = fh.Scene()
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    heat = np.array([0.0, 4.0, 4.0, 0.0])
    mesh = fh.Mesh(points, [[0, 1, 2], [0, 2, 3]], vertex_properties={"heat": heat})
    scene.add(mesh)
    scene.add(fh.Sphere(center=(3, 0.5, 0), radius=0.5))
    return scene


@pytest.fixture
def camera():
    return fh.Camera.look_at((1.5, 0.5, 9), (1.5, 0.5, 0), (0, 1, 0), 30, rows=90, columns=160)


def test_an_attribute_colours_surfaces_and_the_frame_has_the_legend(scene, camera):
    look = {"shade": "unlit", "samples": 1}
    frame = fh.render(scene, camera, color_by="heat", color_map="grey", **look)
    legend = frame.metadata["colors"]
    assert legend["by"] == "attribute:heat"
    assert legend["range"] == [0, 4]
    hits = scene.shoot(camera)
    heat = hits["heat"]
    known = np.isfinite(heat)
    assert known.sum() > 100
    srgb = np.round(heat[known] / 4 * 255) / 255
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    np.testing.assert_allclose(frame["color"][known], linear[:, None].repeat(3, 1), atol=1e-6)
    # The ball has no heat, and so its own colour.
    ball = hits.object == 1
    np.testing.assert_allclose(frame["color"][ball], 0.6, atol=1e-6)


def test_a_number_for_each_object_and_the_scene_s_own_colors(scene, camera):
    by = fh.Colors([5.0, 7.0], range=(0, 10), above="red", map="turbo")
    frame = fh.render(scene, camera, color_by=by)
    assert frame.metadata["colors"]["by"] == "values"
    again = fh.render(scene, camera, color_by=np.array([5, 7]), color_range=(0, 10))
    assert again.metadata["colors"]["range"] == [0, 10]
    scene.shading = fh.Shading("lambert", colors=by)
    assert fh.render(scene, camera).metadata["colors"]["map"] == "turbo"
    assert fh.render(scene, camera, color_map="magma").metadata["colors"]["map"] == "magma"
    assert pickle.loads(pickle.dumps(scene.shading)) == scene.shading


def test_colours_of_a_file_are_those_of_its_scene(tmp_path, scene, camera):
    path = tmp_path / "scene.fhs"
    scene.shading = fh.Shading("lambert", colors=fh.Colors("object", map="blues"))
    scene.save(path)
    assert fh.open(path).shading.colors == scene.shading.colors
    text = '[[objects]]\nshape = "sphere"\ncenter = [0, 0, 0]\nradius = 1\n'
    text += '[colors]\nby = "height"\nmissing = "red"\n'
    (tmp_path / "scene.toml").write_text(text)
    assert fh.load(tmp_path / "scene.toml").shading.colors == fh.Colors("height", missing="red")


def test_what_makes_no_sense_is_refused(scene, camera):
    with pytest.raises(ValueError, match="there are heat"):
        fh.render(scene, camera, color_by="cold")
    with pytest.raises(ValueError, match="1 for 2 objects"):
        fh.render(scene, camera, color_by=[1.0])
    with pytest.raises(ValueError, match="color_map needs color_by"):
        fh.render(scene, camera, color_map="turbo")
    with pytest.raises(ValueError, match="one's own"):
        fh.render(scene, camera, color_by="heat", shade=lambda hits: np.zeros((*hits.shape, 3)))
    for wrong in [{"map": "jet"}, {"range": (1, 1)}, {"range": 3}, {"above": "red"}]:
        with pytest.raises(ValueError, match=r"must|need"):
            fh.Colors("heat", **wrong)
    with pytest.raises(ValueError, match=r"shape|number for each"):
        fh.Colors([[1.0]])
    with pytest.raises(ValueError, match="by must be an array of real numbers"):
        fh.Colors(["heat"])
