"""README.md's lines and those of docs/annotations.md run as they stand."""

import re
import shutil
import subprocess
import sys
import webbrowser

import firsthit as fh
import numpy as np
import pages
import pytest
from pages import DOCS, ROOT

README = ROOT / "README.md"


def test_the_readme_s_three_lines_make_the_picture_beside_them(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "docs" / "scenes").mkdir(parents=True)
    shutil.copy(DOCS / "scenes" / "shapes.toml", tmp_path / "docs" / "scenes")
    (example,) = pages.blocks(README, "python")
    assert len(example.text.splitlines()) == 3
    exec(example.text, {})
    (beside,) = re.findall(r'<img [^>]*src="(\S+)"', README.read_text(encoding="utf-8"))
    assert pages.same(tmp_path / "shapes.png", ROOT / beside)


def jobs():
    """The commands of the README's jobs, and beside each its Python."""
    part = README.read_text(encoding="utf-8").split("\n## Five jobs\n")[1].split("\n## ")[0]
    rows = [line.split("|")[2:4] for line in part.splitlines() if "`firsthit " in line]
    found = [[re.search(r"`(.+?)`", cell)[1] for cell in row] for row in rows if len(row) == 2]
    assert len(found) == 5
    return found


@pytest.fixture
def part(tmp_path, monkeypatch):
    """A part beside the rays that meet it, in a folder of their own."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(ROOT / "testdata" / "cube_binary.stl", "part.stl")
    np.save("rays.npy", [[0.1, 0.1, 9.0, 0.0, 0.0, -1.0]])
    return tmp_path


@pytest.mark.skipif(sys.platform == "win32", reason="the lines are for a Unix shell")
def test_the_readme_s_commands_run(part):
    for command, _ in jobs():
        line = command.replace("firsthit ", f"{sys.executable} -m firsthit ")
        # A page is served until someone ends it.
        line += " -o part.html" if " view " in line else ""
        subprocess.run(line, shell=True, cwd=part, check=True, capture_output=True)
    written = {path.suffix for path in part.iterdir()}
    assert written == {".stl", ".npy", ".png", ".npz", ".ply", ".html"}


def test_the_readme_s_python_runs_and_gives_what_the_commands_give(part, monkeypatch):
    opened = []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    told = {"fh": fh, "scene": fh.load("part.stl")}
    for _, python in jobs():
        exec(python, told)
    told["page"].stop()
    assert opened == [told["page"].address]
    assert told["z"].shape == (480, 640)
    assert told["t"].shape == told["o"].shape == (2,)
    assert (part / "part.png").is_file()
    assert (part / "scan.ply").is_file()


def test_the_readme_is_short():
    assert len(README.read_text(encoding="utf-8").splitlines()) <= 120


def test_the_lines_about_annotations_run_and_write_their_files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shutil.copy(ROOT / "docs" / "scenes" / "shapes.toml", tmp_path)
    told = {}
    for block in pages.blocks(ROOT / "docs" / "annotations.md", "python"):
        exec(block.text, told)
    assert told["cone"].visible_pixels > 0
    assert [point.visibility for point in told["marked"].by_name("cone").keypoints] == [2, 2]
    assert told["moved"].occluded.any()
    assert told["pair"].occluded.any()
    names = {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file()}
    assert {"coco.json", "bop/000000/scene_gt.json", "yolo/labels/train/000000.txt"} < names
    assert {"bop/000000/mask_visib/000000_000000.png", "yolo/data.yaml"} < names
    assert "kitti/training/label_2/000000.txt" in names
