"""The installed package and program do what README.md promises, without the workspace."""

import json
import os
import re
import shutil
import subprocess
import sys

import firsthit as fh
import numpy as np
import pytest
from conftest import PROGRAM, ROOT, run

CONSUMER = ROOT / "python" / "tests" / "typed" / "consumer.py"

TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
STL = (
    "solid a\n"
    + "facet normal 0 0 1\nouter loop\n"
    + "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
    + "endsolid a\n"
)


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "a.obj"
    path.write_text(TETRAHEDRON)
    return path


def test_a_users_script_runs_and_has_types(tmp_path):
    script = shutil.copy(CONSUMER, tmp_path)
    told = run(sys.executable, script, cwd=tmp_path)
    assert told.returncode == 0, told.stderr
    told = run(sys.executable, "-m", "mypy", "--strict", script, cwd=tmp_path)
    assert told.returncode == 0, told.stdout


@pytest.mark.parametrize("view", ["iso", "front", "top"])
def test_a_scene_alone_is_the_programs_picture(view, model):
    told = run(PROGRAM, "render", model, "--view", view, "--size", "64x48", cwd=model.parent)
    assert told.returncode == 0
    assert "guessed: up +y (--up)" in told.stderr
    scene = fh.load(model)
    camera = fh.Camera.framing(scene, rows=48, columns=64, view=view)
    fh.render(scene, camera).save(model.parent / "b.png")
    assert (model.parent / "b.png").read_bytes() == (model.parent / "a.png").read_bytes()


def test_hits_are_tables(model):
    hits = fh.load(model).shoot([[0.1, 0.1, 5.0], [9.0, 9.0, 5.0]], [0.0, 0.0, -1.0])
    table = hits[hits.object >= 0].to_dict()
    assert table["object"].tolist() == [0]
    assert len(hits) == 2
    assert hits.t[1] == np.inf


def test_progress_needs_no_other_package(model):
    told = []
    fh.render(fh.load(model), progress=lambda done, total: told.append((done, total)))
    assert told[-1][0] == told[-1][1] > 0
    script = "import sys, firsthit as fh; fh.render(fh.load(sys.argv[1]), progress=True)"
    shown = run(sys.executable, "-c", script, model)
    assert shown.returncode == 0
    assert "100 %" in shown.stderr


def test_a_truncated_file_is_a_warning_and_strictly_an_error(tmp_path):
    path = tmp_path / "a.stl"
    path.write_text(STL[: STL.index("endsolid")])
    with pytest.warns(fh.FirsthitWarning, match="truncated"):
        fh.load(path)
    with pytest.raises(fh.FileFormatError, match="truncated"):
        fh.load(path, strict=True)
    told = run(PROGRAM, "info", path)
    assert (told.returncode, "truncated" in told.stderr) == (0, True)
    assert run(PROGRAM, "info", path, "--strict").returncode == 3


def test_each_line_of_rays_is_answered_before_the_next_is_sent(model):
    child = subprocess.Popen(
        [PROGRAM, "shoot", model, "-", "--channels", "t,object"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        bufsize=1,
    )
    for line, answer in [("0.1,0.1,5,0,0,-1", "4.2,0"), ("9,9,5,0,0,-1", "inf,-1")]:
        child.stdin.write(line + "\n")
        if answer.startswith("4"):
            assert child.stdout.readline() == "t,object\n"
        assert child.stdout.readline() == answer + "\n"
    rest, said = child.communicate()
    assert (child.returncode, rest) == (0, ""), said


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        ("a.obj", 2, "did you mean firsthit render a.obj?"),
        ("render .", 3, "a folder, not a file"),
        ("render a.obj --channels normals", 2, "did you mean normal?"),
        ("render a.obj --color tomatoe", 2, "did you mean tomato?"),
        ("render a.obj --view side", 2, "possible values: iso, front"),
    ],
)
def test_a_mistake_is_one_line_with_what_was_meant(arguments, code, message, model):
    told = run(PROGRAM, *arguments.split(), cwd=model.parent)
    assert (told.returncode, told.stderr.count("\n")) == (code, 1)
    assert message in told.stderr


def test_a_run_is_reported_as_json_and_objects_have_a_legend(model):
    arguments = "render a.obj --size 8x6 --channels object -o o.png --legend o.csv --json"
    told = run(PROGRAM, *arguments.split(), cwd=model.parent)
    report = json.loads(told.stdout)
    assert (report["columns"], report["rows"], report["legend_file"]) == (8, 6, "o.csv")
    assert (model.parent / "o.csv").read_text().startswith("object,name,color,pixels\n-1,,#000000,")


def test_a_transparent_background_is_alpha(model):
    arguments = ["--background", "transparent", "--color", "steelblue", "--size", "16x12"]
    told = run(PROGRAM, "render", model, *arguments, "-o", "a.npy", cwd=model.parent)
    assert told.returncode == 0, told.stderr
    color = np.load(model.parent / "a.npy")
    assert color.shape == (12, 16, 4)
    assert (color[0, 0] == 0).all()
    assert color[..., 3].max() == 1


def test_adding_meanwhile_does_not_change_a_running_call(model):
    script = f"""
import threading
import firsthit as fh, numpy as np
scene = fh.load({os.fspath(model)!r})
rays = np.zeros((2_000_000, 3)) + (0.1, 0.1, 5)
def add():
    for k in range(50):
        scene.add(fh.Sphere((0, 0, 50 + k), 1))
thread = threading.Thread(target=add)
thread.start()
found = scene.occluded(rays.astype(np.float32), (0, 0, 1))
thread.join()
assert found.all() or not found.any()
"""
    told = run(sys.executable, "-c", script)
    assert told.returncode == 0, told.stderr


def test_a_page_is_one_file_with_the_scene_inside(model, tmp_path):
    told = run(PROGRAM, "view", model, "-o", "page.html", cwd=tmp_path)
    assert told.returncode == 0, told.stderr
    page = (tmp_path / "page.html").read_text()
    assert len(page) > 3_000_000
    assert 'id="report-scene"' in page
    # Nothing of it comes from elsewhere.
    assert not re.findall(r"""(?:src|href)=["'](?!data:)""", page)
    # And for a notebook.
    scene = fh.load(model)
    scene.view(title="a.obj").save(tmp_path / "again.html")
    assert 'id="report-scene"' in (tmp_path / "again.html").read_text()
