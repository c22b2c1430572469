"""Scene files: what they say is what the scene has."""

import base64
import json
import pickle
from pathlib import Path

import firsthit as fh
import numpy as np
import pytest
from support import FULL

SCENES = Path(__file__).parents[2] / "docs" / "scenes"

SCENE = """
up = [0, 0, 1]
[camera]
position = [0, -6, 3]
look_at = [0, 0, 0.5]
fov = 30
columns = 32
rows = 24
[cameras.top]
position = [0, 0, 9]
aim = [0, 0, -1]
up = [0, 1, 0]
[[objects]]
shape = "sphere"
center = [0, 0, 0.5]
radius = 0.5
color = [0.5, 0.25, 0.125]
[[objects]]
shape = "box"
low = [-1, -1, -1]
high = [1, 1, 0]
name = "floor"
translate = [0, 0, 0.25]
[[lights]]
kind = "point"
position = [0, -3, 4]
intensity = [9, 9, 9]
[sky]
horizon = [1, 1, 1]
zenith = [0, 0, 1]
[shading]
ambient = [0.125, 0.125, 0.125]
shadows = false
samples = 2
"""


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    return path


def test_a_scene_file_gives_all_that_it_says(path):
    scene = fh.load(path)
    assert [made.name for made in scene.objects] == ["sphere", "floor"]
    assert scene.objects[0].shape == fh.Sphere((0, 0, 0.5), 0.5)
    assert scene.objects[0].color == (0.5, 0.25, 0.125)
    np.testing.assert_array_equal(scene.objects[1].transform[:3, 3], [0, 0, 0.25])
    assert scene.lights == (fh.PointLight((0, -3, 4), (9, 9, 9)),)
    assert scene.background == fh.Sky((1, 1, 1), (0, 0, 1), (0, 0, 1))
    assert scene.shading == fh.Shading("lambert", ambient=(0.125,) * 3, shadows=False, samples=2)
    assert [camera.name for camera in scene.cameras] == ["camera", "top"]
    camera = fh.Camera.look_at((0, -6, 3), (0, 0, 0.5), (0, 0, 1), 30, rows=24, columns=32)
    np.testing.assert_allclose(scene.camera().rays(), camera.rays(), rtol=0, atol=1e-15)
    top = scene.camera("top", columns=4, rows=2)
    assert (top.columns, top.rows, top.ray_start) == (4, 2, "eye")
    assert scene.shoot((0, 0, 9), (0, 0, -1)).t == 8
    assert pickle.loads(pickle.dumps(scene)).shading == scene.shading


def test_a_scene_s_shading_is_the_default_of_render(path):
    scene = fh.load(path)
    camera = scene.camera()
    told = {"shade": "lambert", "ambient": (0.125,) * 3, "shadows": False, "samples": 2}
    plain = fh.load(path)
    plain.shading = fh.Shading()
    ours = fh.render(scene, camera)["color"]
    np.testing.assert_array_equal(ours, fh.render(plain, camera, **told)["color"])
    assert not np.array_equal(ours, fh.render(plain, camera)["color"])


def test_mistakes_name_file_line_column_and_the_right_word(path):
    path.write_text(SCENE.replace("position = [0, -6", "  postion = [0, -6"))
    with pytest.raises(fh.FileFormatError) as caught:
        fh.load(path)
    said = f"{path}:4:3: unknown key `postion`, did you mean `position`?"
    assert str(caught.value) == said
    assert caught.value.place == "line 4, column 3"


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: fh.Shading("toon"), "shade must be one of direct, .*, normal, got 'toon'"),
        (lambda: fh.Shading("ao", gloss=1), "gloss is no setting of the shader; there are reach"),
        (
            lambda: fh.Shading("ao", reach=-1),
            "reach must be a positive number, or infinity, got -1",
        ),
        (lambda: fh.Shading(light="lamp"), "light must be one of auto, .*, got 'lamp'"),
        (lambda: fh.Shading(samples=0), "samples must be from 1 to 4294967295, got 0"),
        (lambda: fh.Shading(ambient=(1, 2)), "ambient must be three numbers"),
    ],
)
def test_shading_that_makes_no_sense_is_refused(make, words):
    with pytest.raises(ValueError, match=words):
        make()


@pytest.mark.parametrize("path", sorted(SCENES.glob("*.toml")), ids=lambda path: path.stem)
def test_the_examples_of_the_documentation_load_and_render(path):
    scene = fh.load(path)
    seen = scene.camera()
    size = (seen.rows, seen.columns) if FULL else (90, 160)
    frame = fh.render(scene, seen.resize(*size), channels=("color", "object"))
    assert len(np.unique(frame["object"])) >= 2
    assert frame["color"].std() > 0.05


def test_a_pose_of_three_decimals_is_taken_with_a_warning_as_in_python(tmp_path):
    turned = "[[0.867, 0.5, 0, 1], [-0.5, 0.867, 0, 2], [0, 0, 1, 9]]"
    camera = f'convention = "opengl"\npose = {turned}\nfov = 30\ncolumns = 4\nrows = 3\n'
    (tmp_path / "a.toml").write_text(f"[camera]\n{camera}")
    with pytest.warns(fh.FirsthitWarning, match=r"a\.toml:3:8: the rotation is rounded, .* by up"):
        read = fh.load(tmp_path / "a.toml").camera()
    with pytest.warns(fh.FirsthitWarning, match="the rotation is rounded"):
        same = fh.Camera.from_intrinsics(
            (10, 10, 2, 1.5), pose=json.loads(turned), convention="opengl", rows=3, columns=4
        )
    for name in ("position", "aim", "up"):
        np.testing.assert_allclose(getattr(read, name), getattr(same, name), atol=1e-15)
    (tmp_path / "a.toml").write_text(f"[camera]\n{camera.replace('0.867', '0.870')}")
    off = r"a\.toml:3:8: .* up to 3\.0e-3 off the nearest rotation, .* up to 1e-3 is mended"
    with pytest.raises(fh.FileFormatError, match=off):
        fh.load(tmp_path / "a.toml")


def test_files_in_a_scene_file_show_the_variants_that_it_names(tmp_path):
    names = ["red", "blue"]
    data = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "<f4").tobytes()
    mappings = [{"material": k, "variants": [k]} for k in (0, 1)]
    primitive = {"attributes": {"POSITION": 0}, "material": 2}
    primitive["extensions"] = {"KHR_materials_variants": {"mappings": mappings}}
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    model = {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_materials_variants"],
        "extensions": {"KHR_materials_variants": {"variants": [{"name": n} for n in names]}},
        "materials": [{"name": name} for name in (*names, "plain")],
        "buffers": [{"byteLength": len(data), "uri": uri}],
        "bufferViews": [{"buffer": 0, "byteLength": len(data)}],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": 5126,
                "count": 3,
                "type": "VEC3",
                "min": [0, 0, 0],
                "max": [1, 1, 0],
            }
        ],
        "meshes": [{"primitives": [primitive]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
    }
    (tmp_path / "a.gltf").write_text(json.dumps(model))
    wanted = ["", 'variant = "red"', 'variant = "blue"', 'variant = "red"']
    text = "".join(f'[[objects]]\nfile = "a.gltf"\n{variant}\n' for variant in wanted)
    (tmp_path / "a.toml").write_text(text)

    def materials(**how):
        scene = fh.load(tmp_path / "a.toml", **how)
        return [each.materials[0].name for each in scene.objects]

    assert materials() == ["plain", "red", "blue", "red"]
    assert materials(variant="blue") == ["blue", "red", "blue", "red"]
    (tmp_path / "a.toml").write_text(text + '[[objects]]\nfile = "a.gltf"\nvariant = "re\\u202e"')
    there = r'there are "red", "blue"'
    unknown = r"a\.toml:15:11: 'a.gltf' has no variant \"re\\u\{202e\}\"; " + there
    with pytest.raises(fh.FileFormatError, match=unknown):
        fh.load(tmp_path / "a.toml")
    for name in ("a.toml", "a.gltf"):
        (tmp_path / "a.toml").write_text(text)
        with pytest.raises(ValueError, match=f'variant must be one of .*, got "green"; {there}'):
            fh.load(tmp_path / name, variant="green")
