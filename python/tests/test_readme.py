"""README.md's example in Python and the lines of docs/guide.md and others run as they stand."""

import shutil
import subprocess
import sys
from pathlib import Path

import firsthit as fh
import numpy as np
import pages
import pytest
from pages import ROOT


def test_the_readme_s_example_runs(tmp_path, monkeypatch):
    pytest.importorskip("pandas")
    monkeypatch.chdir(tmp_path)
    shutil.copy(ROOT / "testdata" / "torus_meshopt.glb", "part.glb")
    (example,) = pages.blocks(ROOT / "README.md", "python")
    told = {}
    exec(example.text, told)
    assert told["hits"].shape == told["hits"].object.shape == (720, 1280)
    assert told["hits"].normal.shape == (720, 1280, 3)
    assert told["blocked"]
    assert told["layers"] > 0
    assert told["scene"].objects[told["ball"]].transform[2, 3] == 2
    part, whole = told["part"], fh.render(told["scene"], told["camera"])
    assert (part["color"] == whole["color"][100:200, 300:500]).all()
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {"part.glb", "part.png", "out.exr", "out.png", "cloud.ply", "panorama.png"}


def test_the_guide_s_lines_run_and_write_its_pictures(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shutil.copy(ROOT / "docs" / "scenes" / "shapes.toml", tmp_path)
    guide = ROOT / "docs" / "guide.md"
    blocks = pages.blocks(guide, "python")
    told = {}
    for block in blocks:
        exec(block.text, told)
    assert max(len(block.text.splitlines()) for block in blocks[1:]) <= 5
    assert told["z"].shape == told["cone"].shape == told["thick"].shape == (220, 480)
    assert told["cone"].any()
    assert told["pairs"].shape == (5, 2)
    assert told["around"]["valid"].mean() == pytest.approx(np.pi / 4, abs=1e-3)
    assert (tmp_path / "scan.ply").is_file()
    assert float(told["there"]) > 0.9
    pictures = pages.pictures(guide)
    assert len(pictures) == 8
    for shown in pictures:
        assert pages.same(tmp_path / Path(shown).name, guide.parent / shown), shown


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


@pytest.mark.skipif(sys.platform == "win32", reason="the lines are for a Unix shell")
def test_the_guide_s_commands_run(tmp_path):
    shutil.copy(ROOT / "docs" / "scenes" / "shapes.toml", tmp_path)
    commands = pages.blocks(ROOT / "docs" / "guide.md", "sh")
    assert len(commands) == 8
    answers = []
    for command in commands:
        line = command.text.replace("firsthit ", f"{sys.executable} -m firsthit ")
        done = subprocess.run(
            line, shell=True, cwd=tmp_path, capture_output=True, text=True, check=True
        )
        answers.append(done.stdout.split())
    assert [answer[0] for answer in answers[2:5]] == ["visible", "thickness", "inside"]
    assert [float(answer[1]) for answer in answers[2:5]] == [0.0, pytest.approx(1, abs=0.1), 1.0]
    scene = fh.load(tmp_path / "shapes.toml")
    lidar = fh.Lidar.spinning(np.linspace(-25, 15, 64), columns=1024, position=(0, -2.2, 1.0))
    lidar.scan(scene).save(tmp_path / "expected.ply")
    assert (tmp_path / "scan.ply").read_bytes() == (tmp_path / "expected.ply").read_bytes()
