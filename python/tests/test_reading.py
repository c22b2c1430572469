"""How files are read: units, folders that are allowed, and what is wrong in them."""

import copy
import gc
import json
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import firsthit as fh
import numpy as np
import pytest
from support import ball

PART = "v 0 0 0\nv 1000 0 0\nv 0 1000 0\nf 1 2 3\n"


def test_units_become_metres_and_a_scale_multiplies(tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    path.write_text(PART)
    for given, size in [
        ({"units": "mm"}, 1),
        ({"scale": 2}, 2000),
        ({"units": "mm", "scale": 2}, 2),
    ]:
        scene = fh.load(path, **given)
        assert scene.shoot((size * 0.4, size * 0.4, 5), (0, 0, -1)).t == 5
        assert np.isinf(scene.shoot((size * 0.6, size * 0.6, 5), (0, 0, -1)).t)
    with pytest.raises(ValueError, match=r"units must be one of um, mm, .*, got 'inch'"):
        fh.load(path, units="inch")  # type: ignore[arg-type]
    for scale in (0, -1, float("nan"), float("inf")):
        with pytest.raises(ValueError, match="scale must be positive and finite"):
            fh.load(path, scale=scale)
    scene_file = tmp_path / "s.toml"
    scene_file.write_text('[[objects]]\nfile = "a.obj"\nunits = "mm"\n')
    assert fh.load(scene_file).shoot((0.25, 0.25, 5), (0, 0, -1)).t == 5
    with pytest.raises(ValueError, match="1 but for mesh files"):
        fh.load(scene_file, units="mm")


def test_textures_of_a_folder_that_is_allowed_are_read(tmp_path: Path) -> None:
    (tmp_path / "model").mkdir()
    (tmp_path / "textures").mkdir()
    lines = ["mtllib a.mtl", *PART.splitlines()[:3], "vt 0 0", "usemtl m", "f 1/1 2/1 3/1", ""]
    (tmp_path / "model/a.obj").write_text("\n".join(lines))
    (tmp_path / "model/a.mtl").write_text("newmtl m\nmap_Kd ..\\textures\\t.png\n")
    camera = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 40, 2, 2)
    fh.render(fh.Scene(), camera, channels=["color"]).save(tmp_path / "textures/t.png")
    with pytest.warns(fh.FirsthitWarning, match="resources="):
        scene = fh.load(tmp_path / "model/a.obj")
    assert scene.objects[0].materials[0].name == "m"
    for folders in (tmp_path / "textures", [str(tmp_path / "textures")]):
        scene = fh.load(tmp_path / "model/a.obj", resources=folders)
        assert scene.objects[0].materials[0].texture is not None


def test_names_from_python_are_escaped_in_warnings() -> None:
    scene = fh.Scene()
    scene.add(fh.Box((0, 0, 0), (1, 1, 1)), name="a\x1b[2J\u202eb\n")
    scene.add(fh.Mesh(np.eye(3), [[0, 1, 2]]))
    with pytest.warns(fh.FirsthitWarning, match="left out of the section") as said:
        scene.section((0, 0, 0.5), (0, 0, 1))
    text = str(said[0].message)
    assert text.isprintable()
    assert r"a\u{1b}[2J\u{202e}b\u{a}" in text
    assert repr(scene.objects[0]).isprintable()


def test_a_file_that_is_not_there_is_a_file_not_found_error(tmp_path):
    readers = (fh.load, fh.open, fh.lint, fh.info, fh.Frame.load, fh.read_points, fh.read_metadata)
    for read in readers:
        missing = tmp_path / f"none.{'npz' if read == fh.Frame.load else 'ply'}"
        with pytest.raises(FileNotFoundError, match="none") as raised:
            read(missing)
        assert isinstance(raised.value, fh.FileReadError)
        again = pickle.loads(pickle.dumps(raised.value))
        assert (type(again), again.path) == (type(raised.value), str(missing))
    with pytest.raises(fh.FileReadError) as raised:
        fh.info(tmp_path)
    assert not isinstance(raised.value, FileNotFoundError)


def test_info_of_a_file_is_what_the_program_says(tmp_path):
    ball().save(tmp_path / "ball.fhs")
    ball().shoot([0, 0, 5], [0, 0, -1]).save(tmp_path / "hit.npz")
    (tmp_path / "bad.ply").write_text("ply\nno")
    for name in ("ball.fhs", "hit.npz"):
        run = [sys.executable, "-m", "firsthit", "info", "--json", str(tmp_path / name)]
        said = json.loads(subprocess.run(run, capture_output=True, check=True).stdout)
        assert fh.info(tmp_path / name) == fh.info(str(tmp_path / name)) == said
    with pytest.raises(fh.FileFormatError, match=r"bad\.ply") as raised:
        fh.info(tmp_path / "bad.ply")
    assert raised.value.path == str(tmp_path / "bad.ply")
    (tmp_path / "a.txt").write_text("x")
    with pytest.raises(ValueError, match=r"a\.txt"):
        fh.info(tmp_path / "a.txt")


def test_the_collector_is_as_it_was_after_a_load(tmp_path: Path) -> None:
    (tmp_path / "broken.ply").write_text("ply\n")
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    was = gc.isenabled()
    try:
        for is_enabled in (False, True):
            (gc.enable if is_enabled else gc.disable)()
            scene = fh.load(tmp_path / "a.obj")
            assert scene.shoot((0.2, 0.2, 1), (0, 0, -1)).t == 1
            with pytest.raises(fh.FileError):
                fh.load(tmp_path / "broken.ply")
            assert gc.isenabled() == is_enabled
    finally:
        (gc.enable if was else gc.disable)()


@pytest.mark.parametrize(
    "make", [lambda x: x, copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))]
)
def test_what_a_file_holds_changes_as_what_was_added_does(tmp_path: Path, make: Any) -> None:
    steps = [f"v 0 0 {k}\nv 1 0 {k}\nv 0 1 {k}\no {k}\nf -3 -2 -1\n" for k in range(4)]
    (tmp_path / "steps.obj").write_text("".join(steps))
    read = make(fh.load(tmp_path / "steps.obj"))
    added = fh.Scene()
    for each in fh.load(tmp_path / "steps.obj").objects:
        added.add(each.shape, name=each.name)
    above = np.array([0.2, 0.2, 9.0]), (0, 0, -1)
    sideways = np.eye(4)
    sideways[0, 3] = 5
    for change in (
        lambda scene: None,
        lambda scene: scene.move(3, sideways),
        lambda scene: scene.hide("2"),
        lambda scene: scene.move([0, 3], [sideways, np.eye(4)]),
        lambda scene: scene.remove(3),
        lambda scene: scene.add(fh.Sphere((0.2, 0.2, 0), 0.5), name="ball"),
        lambda scene: scene.replace(1, fh.Sphere((0.2, 0.2, 6), 0.5)),
    ):
        for scene in (read, added):
            change(scene)
        for name in ("t", "object", "primitive"):
            told = (getattr(scene.shoot(*above), name) for scene in (read, added))
            assert next(told) == next(told)
        assert [each.name for each in read.objects] == [each.name for each in added.objects]
        assert repr(read) == repr(added)


def test_objects_of_a_file_are_made_in_python_when_they_are_asked_for(tmp_path: Path) -> None:
    many = "".join(f"v 0 0 {k}\nv 1 0 {k}\nv 0 1 {k}\no {k}\nf -3 -2 -1\n" for k in range(2000))
    (tmp_path / "many.obj").write_text(many)
    kind = type(ball().objects[0])

    def count() -> int:
        gc.collect()
        return sum(isinstance(each, kind) for each in gc.get_objects())

    before = count()
    scene = fh.load(tmp_path / "many.obj")
    assert scene.shoot((0.2, 0.2, 1e4), (0, 0, -1)).object == 1999
    scene.move(7, np.eye(4))
    copied = copy.copy(scene)
    assert count() <= before + 2
    copied.hide(1999)
    assert copied.shoot((0.2, 0.2, 1e4), (0, 0, -1)).object == 1998
    assert count() <= before + 4
    assert (scene.objects[7].name, count() >= before + 2000) == ("7", True)


def test_objects_are_listed_anew_after_changes_alone() -> None:
    scene = ball()
    listed = scene.objects
    assert scene.objects is listed
    scene.move(0, np.eye(4))
    moved = scene.objects
    assert moved is not listed
    assert moved[0] is not listed[0]
    scene.add(listed[0].shape)
    assert len(scene.objects) == len(listed) + 1
