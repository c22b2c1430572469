"""Built scenes in files: `Scene.save` and `open`."""

import pickle
import subprocess
import sys

import firsthit as fh
import numpy as np
import pytest
from support import TESTDATA, bumpy_sphere

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
file = "cube.ply"
name = "cube"
translate = [1, 0, 0.25]
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


def rich_scene() -> fh.Scene:
    """Everything that Python can put into a scene, but for cameras."""
    points, triangles = bumpy_sphere(12, 1)
    shared = fh.Mesh(points, triangles, uvs=points[:, :2])
    texels = np.random.default_rng(3).integers(0, 256, (3, 5, 4), dtype=np.uint8)
    leaf = fh.Material(
        color=(0.5, 1, 0.25),
        texture=fh.Texture(texels, wrap="mirror", filter="nearest"),
        alpha_mode="mask",
        cutoff=0.25,
        unlit=True,
    )
    moved = np.diag([1.0, -2.0, 0.5, 1.0])
    moved[:3, 3] = 3, 0.1, -1
    scene = fh.Scene()
    scene.add(shared, name="leaf ☘", material=leaf)
    scene.add(shared, name="moved", transform=moved, color=(0.1, 0.2, 0.3))
    scene.add(fh.Mesh(points + 0.1, triangles, normals=points), transform=moved)
    scene.add(fh.Plane(point=(0, 0, -3), normal=(0, 0, 1)), name="ground")
    scene.add(fh.Cone(bottom=(0, 5, 0), top=(0, 5, 2), radius=1, top_radius=0.25))
    scene.add_light(fh.DirectionalLight((1, 2, -3), color=(0.9, 0.8, 0.7)))
    scene.add_light(fh.SpotLight((0, 0, 9), (0, 0.1, -1), inner_angle=0.2, outer_angle=0.4))
    scene.background = "transparent"
    scene.shading = fh.Shading(ambient=(0.1, 0.2, 0.3), shadows=False, samples=3)
    scene.display = fh.Display(1 / 3, "aces")
    scene.up = (0, 1, 0.5)
    return scene


def parts(made: fh.Object) -> list:
    """Return all that an object is made from."""
    shape = made.shape
    if isinstance(shape, fh.Mesh):
        arrays = (
            shape.vertices,
            shape.triangles,
            shape.normals,
            shape.uvs,
            shape.colors,
            shape.faces,
        )
        shape = [None if array is None else np.asarray(array).tobytes() for array in arrays]
    looks = [
        (look.color, look.alpha, look.alpha_mode, look.cutoff, look.unlit, look.double_sided)
        for look in made.materials
    ]
    textures = [look.texture for look in made.materials if look.texture is not None]
    texels = [(own.texels.tobytes(), own.wrap, own.filter) for own in textures]
    return [made.name, shape, made.transform.tobytes(), looks, texels]


def random_rays(count: int) -> tuple[np.ndarray, np.ndarray]:
    chance = np.random.default_rng(7)
    return chance.normal(0, 4, (count, 3)), chance.normal(0, 1, (count, 3))


def assert_same(one: fh.Scene, other: fh.Scene) -> None:
    assert [parts(made) for made in one.objects] == [parts(made) for made in other.objects]
    assert one.lights == other.lights
    assert one.cameras == other.cameras
    assert (one.background, one.shading, one.up) == (other.background, other.shading, other.up)
    assert one.display == other.display
    assert one.bounds.tobytes() == other.bounds.tobytes()
    rays = random_rays(5000)
    hits, expected = one.shoot(*rays), other.shoot(*rays)
    for name in ("t", "object", "primitive", "barycentric", "normal", "uv", "position"):
        assert getattr(hits, name).tobytes() == getattr(expected, name).tobytes(), name
    assert (hits.object >= 0).any()
    assert (one.occluded(*rays) == other.occluded(*rays)).all()
    assert (one.count(*rays) == other.count(*rays)).all()


def test_what_is_opened_is_what_was_saved(tmp_path):
    scene = rich_scene()
    scene.save(tmp_path / "a.fhs")
    for opened in (
        fh.open(tmp_path / "a.fhs"),
        fh.open(str(tmp_path / "a.fhs"), verify=True),
        fh.load(tmp_path / "a.fhs"),
    ):
        assert_same(opened, scene)
        assert repr(opened) == repr(scene)
    opened.save(tmp_path / "b.fhs")
    assert (tmp_path / "a.fhs").read_bytes() == (tmp_path / "b.fhs").read_bytes()


def test_a_scene_file_survives_with_cameras_and_picture(tmp_path):
    (tmp_path / "cube.ply").write_bytes((TESTDATA / "cube_quads_le.ply").read_bytes())
    (tmp_path / "scene.toml").write_text(SCENE)
    scene = fh.load(tmp_path / "scene.toml")
    scene.save(tmp_path / "a.fhs")
    opened = fh.open(tmp_path / "a.fhs")
    assert_same(opened, scene)
    assert opened.camera("top", columns=3, rows=3) == scene.camera("top", columns=3, rows=3)
    pictures = [fh.render(made, channels=("color", "t", "object")) for made in (scene, opened)]
    for name in ("color", "t", "object"):
        assert pictures[0][name].tobytes() == pictures[1][name].tobytes(), name
    assert pictures[0].metadata == pictures[1].metadata


def test_an_opened_scene_is_not_built_again(tmp_path):
    scene = rich_scene()
    scene.save(tmp_path / "a.fhs")
    opened = fh.open(tmp_path / "a.fhs")
    built = opened._last
    opened.shoot((0, 0, 9), (0, 0, -1))
    assert opened._last is built


def test_an_opened_scene_goes_on_living(tmp_path):
    scenes = [rich_scene()]
    scenes[0].save(tmp_path / "a.fhs")
    scenes.append(fh.open(tmp_path / "a.fhs"))
    place = np.eye(4)
    place[:3, 3] = 0.5, 0.25, 1
    for scene in scenes:
        scene.move(1, place)
    assert_same(scenes[1], scenes[0])
    for scene in scenes:
        scene.add(fh.Sphere(center=(0, 0, 5), radius=2), name="late")
    assert_same(scenes[1], scenes[0])
    # The old file is replaced while it is open.
    scenes[1].save(tmp_path / "a.fhs")
    assert_same(scenes[1], scenes[0])
    assert_same(fh.open(tmp_path / "a.fhs"), scenes[0])
    assert_same(pickle.loads(pickle.dumps(scenes[1])), scenes[0])


def test_what_was_removed_stays_removed_when_it_is_saved_and_opened(tmp_path):
    first = rich_scene()
    first.remove(2)
    first.hide(3)
    first.save(tmp_path / "a.fhs")
    second = fh.open(tmp_path / "a.fhs")
    second.save(tmp_path / "b.fhs")
    for scene in (first, second, fh.open(tmp_path / "b.fhs")):
        assert [made.removed for made in scene.objects] == [False, False, True, False, False]
        with pytest.raises(IndexError, match="object 2 was removed"):
            scene.show(2)
        scene.show(3)
        scene.hide(3)
        assert [made.hidden for made in scene.objects] == [False, False, True, True, False]


def test_other_processes_open_it_too(tmp_path):
    scene = rich_scene()
    scene.save(tmp_path / "a.fhs")
    script = (
        "import sys, firsthit as fh\n"
        "print(float(fh.open(sys.argv[1]).shoot((0.1, 0.2, 9), (0, 0, -1)).t).hex())"
    )
    command = [sys.executable, "-c", script, tmp_path / "a.fhs"]
    children = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for _ in range(3)]
    expected = float(scene.shoot((0.1, 0.2, 9), (0, 0, -1)).t).hex()
    assert [child.communicate()[0].strip() for child in children] == [expected] * 3


def test_an_empty_scene_is_one(tmp_path):
    fh.Scene().save(tmp_path / "a.fhs")
    opened = fh.open(tmp_path / "a.fhs", verify=True)
    assert opened.objects == ()
    assert np.isinf(opened.shoot((0, 0, 1), (0, 0, -1)).t)


def test_what_is_no_built_scene_is_refused(tmp_path):
    path = tmp_path / "a.fhs"
    rich_scene().save(path)
    content = path.read_bytes()
    path.write_bytes(content[:-1])
    with pytest.raises(fh.FileFormatError, match="truncated"):
        fh.open(path)
    path.write_bytes(b"solid a")
    with pytest.raises(fh.FileFormatError, match="no built scene"):
        fh.open(path)
    with pytest.raises(fh.FileReadError):
        fh.open(tmp_path / "missing.fhs")
    with pytest.raises(TypeError, match="verify"):
        fh.open(path, verify=1)
    with pytest.raises(fh.FileWriteError):
        fh.Scene().save(tmp_path / "missing" / "a.fhs")
    many = fh.Scene()
    many.shading = fh.Shading(samples=1 << 20)
    with pytest.raises(ValueError, match="samples"):
        many.save(path)


def test_a_scene_is_not_saved_over_a_file_of_another_format(tmp_path):
    path = tmp_path / "part.stl"
    path.write_bytes(b"solid")
    with pytest.raises(ValueError, match=r"path must end in \.fhs, got .*part\.stl"):
        fh.Scene().save(path)
    assert path.read_bytes() == b"solid"


def test_damage_is_found_when_it_is_asked_for(tmp_path):
    path = tmp_path / "a.fhs"
    scene = fh.Scene()
    scene.add(fh.Mesh(*bumpy_sphere(20, 2)))
    scene.save(path)
    content = bytearray(path.read_bytes())
    at = content.rindex(scene.objects[0].shape.vertices.astype(np.float32)[5].tobytes())
    content[at] ^= 1
    path.write_bytes(content)
    assert parts(fh.open(path).objects[0]) != parts(scene.objects[0])
    with pytest.raises(fh.FileFormatError, match="damaged"):
        fh.open(path, verify=True)
