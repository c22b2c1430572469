"""The logger ``firsthit``: silent by default, and beside warnings."""

import logging
import pathlib
import subprocess
import sys
import warnings

import firsthit as fh
import pytest
from support import ball

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl none\nf 1 2 3\n"


def work(folder):
    (folder / "a.obj").write_text(TRIANGLE)
    scene = fh.load(folder / "a.obj")
    camera = fh.Camera.framing(scene, rows=4, columns=5)
    fh.render(scene, camera, samples=1).save(folder / "a.png")
    scene.save(folder / "a.fhs")
    fh.open(folder / "a.fhs").shoot((0.2, 0.2, 5), (0, 0, -1)).save(folder / "a.npz")
    scene.objects[0].shape.save(folder / "a.ply")
    fh.Lidar([0, 90], [0, 0]).scan(scene).save(folder / "a.csv")


def test_files_pictures_scans_and_builds_are_logged_with_their_seconds(tmp_path, caplog):
    with caplog.at_level(logging.DEBUG, "firsthit"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        work(tmp_path)
    told = [record.getMessage() for record in caplog.records]
    for wanted in (
        f"read {tmp_path / 'a.obj'} in ",
        "built 1 objects in ",
        "rendered 5 x 4 pixels in ",
        *(f"wrote {tmp_path / name} in " for name in ("a.png", "a.fhs", "a.npz", "a.ply", "a.csv")),
        f"opened {tmp_path / 'a.fhs'} in ",
        "scanned 1 x 2 beams in ",
    ):
        assert any(line.startswith(wanted) for line in told), wanted
    assert {record.name for record in caplog.records} == {"firsthit"}


def test_it_is_silent_unless_a_program_asks_and_warnings_are_as_ever(tmp_path):
    here = str(pathlib.Path(__file__).parent)
    script = f"import sys; sys.path.insert(0, {here!r}); import test_logging, pathlib; "
    script += f"test_logging.work(pathlib.Path({str(tmp_path)!r}))"
    made = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        check=True,
    )
    assert made.stdout == ""
    lines = made.stderr.splitlines()
    assert [line for line in lines if "FirsthitWarning" in line]
    assert not [line for line in lines if " in 0." in line]


def test_what_fails_is_not_logged_as_done(tmp_path, caplog):
    with caplog.at_level(logging.INFO, "firsthit"):
        with pytest.raises(fh.FileReadError):
            fh.load(tmp_path / "none.obj")
        ball().shoot((0, 0, 5), (0, 0, -1))
    assert not caplog.records
