"""README.md's example in Python runs as it stands."""

import re
import shutil
from pathlib import Path

import firsthit as fh
import pytest

ROOT = Path(__file__).parents[2]


def test_the_readme_s_example_runs(tmp_path, monkeypatch):
    pytest.importorskip("pandas")
    monkeypatch.chdir(tmp_path)
    shutil.copy(ROOT / "testdata" / "torus_meshopt.glb", "part.glb")
    (example,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    told = {}
    exec(example, told)
    assert told["hits"].shape == told["hits"].object.shape == (720, 1280)
    assert told["hits"].normal.shape == (720, 1280, 3)
    assert told["blocked"]
    assert told["layers"] > 0
    assert told["scene"].objects[told["ball"]].transform[2, 3] == 2
    part, whole = told["part"], fh.render(told["scene"], told["camera"])
    assert (part["color"] == whole["color"][100:200, 300:500]).all()
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {"part.glb", "part.png", "out.exr", "out.png", "cloud.ply", "panorama.png"}
