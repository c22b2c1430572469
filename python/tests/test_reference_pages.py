"""The lines of the reference pages, which need files and names that the reader has, run too.

Other tests run those of README.md, gallery.md, annotations.md, and the other lines of cluster.md
and datasets.md.
"""

import json
import os
import re
import shutil
import sys
import warnings

import firsthit as fh
import numpy as np
import pages
import pytest
from pages import DOCS, ROOT
from support import ball

unix = pytest.mark.skipif(sys.platform == "win32", reason="the lines are for a Unix shell")

TESTDATA, SHAPES = ROOT / "testdata", DOCS / "scenes" / "shapes.toml"

#: A picture of light of one pixel.
STUDIO = b"#?RADIANCE\n\n-Y 1 +X 1\n\x80\x80\x80\x80"


@pytest.fixture
def page(tmp_path, monkeypatch):
    """Run a page, small, with the files that it names and the names that it takes for granted."""
    monkeypatch.chdir(tmp_path)

    def run(name, **told):
        return pages.run(DOCS / name, tmp_path, told=told, edit=lambda text: small(text, tmp_path))

    return run


def small(text, folder):
    """Return a block with few pixels and samples, and its folders below one of ours."""
    text = re.sub(
        r"(firsthit render (?:(?!--size)[^\n\\]|\\\n)*)$", r"\1 --size 64x48", text, flags=re.M
    )
    text = re.sub(r"(--size) \d+x\d+", r"\1 64x48", text)
    text = re.sub(r"(samples[ =])\d+", r"\g<1>2", text)
    text = text.replace("--trajectory drive.csv", "--trajectory drive.csv --turns 2")
    text = text.replace("fh.render(scene, color", "fh.render(scene, camera, color")
    return text.replace("/shared", str(folder / "shared"))


def copies(folder, **files):
    """Copy files of testdata by other names; their ends are those of the originals."""
    for name, original in files.items():
        source = TESTDATA / original
        shutil.copy(source, folder / f"{name}{source.suffix}")


@unix
def test_measuring_and_nearest_points(page, tmp_path):
    scene = ball()
    told = {"fh": fh, "np": np, "scene": scene}
    rays = {"origins": np.tile((0, 0, 9.0), (5, 1)), "directions": np.array((0, 0, -1.0))}
    camera = fh.Camera.look_at((0, -5, 1), (0, 0, 0), (0, 0, 1), 40, rows=6, columns=8)
    points = np.random.default_rng(1).normal(size=(7, 3))
    found = page("measuring.md", **told, **rays, camera=camera, to_light=(0, 0, 9.0), points=points)
    assert found["met"].counts.tolist() == [2] * 5
    assert found["near"].shape == (5, 3)
    assert found["shadow"].shape == (6, 8)
    assert found["held"].shape == (7, 1)


@unix
def test_nearest_points(page, tmp_path):
    copies(tmp_path, part="cube_binary.stl")
    scene, points = fh.load("part.stl"), np.random.default_rng(1).normal(size=(7, 3))
    np.save("points.npy", points)
    np.savetxt("points.csv", points, delimiter=",")
    found = page("nearest.md", scene=scene, points=points)
    assert found["near"].distance.shape == (7, 4)
    assert found["distance"].shape == (7,)
    with np.load("nearest.npz") as stored:
        assert len(stored["distance"]) == 7


@unix
def test_cameras(page, tmp_path):
    copies(
        tmp_path, scan="cube_quads_le.ply", other="cube_quads_be.ply", dense="cube_quads_ascii.ply"
    )
    model = tmp_path / "sparse" / "0"
    model.mkdir(parents=True)
    (model / "cameras.txt").write_text("1 PINHOLE 64 48 60 60 32 24\n")
    (model / "images.txt").write_text("1 1 0 0 0 0 0 9 1 frames/0001.jpg\n\n")
    frame = {"file_path": "1.png", "transform_matrix": np.eye(4).tolist()}
    said = {"w": 64, "h": 48, "camera_angle_x": 0.9, "frames": [frame]}
    (tmp_path / "transforms.json").write_text(json.dumps(said))
    np.savetxt("pose.txt", np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 9]]))
    scene = fh.load("scan.ply")
    camera = fh.Camera.framing(scene, rows=48, columns=64)
    fh.render(scene, camera, channels="z").save("depth.exr")
    k = np.array([[600, 0, 319.5], [0, 600, 239.5], [0, 0, 1]])
    told = {"K": k, "distortion": [-0.2, 0.05, 0, 0], "rvec": (0, 0, 0), "tvec": (0, 0, 9)}
    told |= {"matrix": np.eye(4), "P": k @ np.eye(3, 4), "scene": scene, "fh": fh}
    found = page("cameras.md", **told)
    assert list(found["cameras"]) == ["frames/0001.jpg"]
    assert fh.Camera.load("same_view.png").to_convention("opencv")[1][2, 3] == 9
    assert fh.read_metadata("blurred.png")["camera"]["parameters"]["aperture"] == 0.05


@unix
def test_the_peers_interfaces(page):
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.creation.box()
    told = {"vertices": np.array(mesh.vertices, "f4"), "triangles": np.array(mesh.faces, "u4")}
    rays = np.array([[0.1, 0.2, 9, 0, 0, -1]], "f4")
    found = page("compat.md", mesh=mesh, points=np.zeros((2, 3)), rays=rays, **told)
    assert found["scene"].cast_rays(rays)["t_hit"] == 8.5


@unix
def test_built_scenes(page, tmp_path):
    copies(tmp_path, city="torus_meshopt.glb")
    assert len(page("fhs.md")["scene"].objects) == 6


@unix
def test_outputs(page, tmp_path):
    for module in ("OpenEXR", "trimesh", "cv2", "PIL"):
        pytest.importorskip(module)
    copies(tmp_path, part="cube_binary.stl")
    scene = fh.load("part.stl")
    fh.render(scene, channels=("z", "object")).save("out.exr")
    fh.render(scene, channels=("position", "color", "object"), samples=1).save("room.ply")
    fh.render(scene, channels="z").save("depth.png", png_scale=0.001)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = page("outputs.md")
    found["shoot"].stdin.close()
    found["shoot"].stdout.close()
    assert found["shoot"].wait(60) == 0
    assert found["names"] == "t,object,primitive\n"
    assert len(found["answer"].split(",")) == 3
    assert found["camera"]["projection"] == "perspective"
    assert len(found["object"]) == len(found["points"])
    whole = fh.Frame.load("out.exr")
    assert (np.isinf(found["z"]) == np.isinf(whole["z"])).all()
    texts = [block.text for block in pages.blocks(DOCS / "outputs.md", "json")]
    for text in texts:
        json.loads(text if text.startswith("{") else f"{{{text}}}")


@unix
def test_scene_files(page, tmp_path):
    (tmp_path / "studio.hdr").write_bytes(STUDIO)
    texts = [block.text for block in pages.blocks(DOCS / "scene.md", "toml")]
    for at, text in enumerate(texts):
        path = tmp_path / f"scene{at}.toml"
        path.write_text(text)
        fh.load(path)
    shutil.copy(SHAPES, tmp_path / "scene.toml")
    found = page("scene.md")
    assert found["frame"].shape == (220, 480)
    assert len(found["scene"].lights) == 2


@unix
def test_shading(page, tmp_path):
    scene = fh.Scene()
    mesh = fh.load(TESTDATA / "cube_binary.stl").objects[0].shape
    quality = {"quality": np.linspace(-1, 1, len(mesh.vertices))}
    scene.add(fh.Mesh(mesh.vertices, mesh.triangles, vertex_properties=quality))
    for x in (3, 6):
        scene.add(fh.Sphere((x, 0, 0), 1))
    camera = fh.Camera.framing(scene, rows=120, columns=160)
    page("shading.md", scene=scene, camera=camera, fh=fh)
    (text,) = (block.text for block in pages.blocks(DOCS / "shading.md", "toml"))
    (tmp_path / "colors.toml").write_text(text)
    assert fh.load(tmp_path / "colors.toml").shading.colors.by == "attribute:quality"


@unix
def test_sensors(page, tmp_path):
    pytest.importorskip("laspy")
    copies(tmp_path, city="torus_meshopt.glb", wood="cube_bom_crlf.obj")
    for name in ("city", "hall", "yard"):
        copies(tmp_path, **{name: "cube_quads_le.ply"})
    found = page("sensors.md")
    assert found["image"].shape == (16, 1808)
    assert found["depth"].shape == (90, 120)
    made = {path.name for path in tmp_path.iterdir()}
    assert {
        "drive.csv",
        "scan.las",
        "edges.npz",
        "city.ply",
        "drive.las",
        "wood.laz",
        "hall.npz",
        "yard.pcd",
    } <= made


@unix
@pytest.mark.parametrize("name", ["cluster.md", "datasets.md"])
def test_the_commands_of_an_array_of_jobs(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SLURM_ARRAY_TASK_ID", "1")
    monkeypatch.setenv("PATH", f"{pages.commands(tmp_path)}{os.pathsep}{os.environ['PATH']}")
    for plan in (DOCS / "datasets").glob("*.toml"):
        shutil.copy(plan, tmp_path)
    shutil.copy(tmp_path / "turntable.toml", tmp_path / "plan.toml")
    (block,) = pages.blocks(DOCS / name, "sh")
    # The one task of an array of one.
    lines = re.sub(r"/(16|64)$", "/1", small(block.text, tmp_path), flags=re.M)
    pages.shell(lines, tmp_path, name)
    assert fh.parts(tmp_path / "shared" / "out").missing == ()
