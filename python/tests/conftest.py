"""Fixtures of several commands and jobs."""

import os
import shutil
import sys
from pathlib import Path

import pytest
from _firsthit_program import main as program
from dataset_support import LONG, PLANS


@pytest.fixture
def firsthit(monkeypatch, capsys):
    """The program: it returns the exit code, what it printed, and what it said of errors."""

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["firsthit", *map(str, arguments)])
        code = program()
        said = capsys.readouterr()
        return code, said.out, said.err

    return run


@pytest.fixture
def without(monkeypatch):
    """Make a package impossible to import, with the parts that other tests have imported."""

    def hide(package):
        parts = [name for name in sys.modules if name.startswith(f"{package}.")]
        for name in (package, *parts):
            monkeypatch.setitem(sys.modules, name, None)

    return hide


@pytest.fixture
def workers_find_the_tests(monkeypatch):
    """Processes that are started anew import `many_support`."""
    path = os.environ.get("PYTHONPATH")
    own = str(Path(__file__).parent)
    monkeypatch.setenv("PYTHONPATH", own if path is None else f"{own}{os.pathsep}{path}")


@pytest.fixture
def long_plan(tmp_path):
    """A plan of many frames, in a file."""
    text = (PLANS / "turntable.toml").read_text()
    text = text.replace("count = 6", f"count = {LONG}").replace("columns = 96", "columns = 240")
    folder = tmp_path / "plan"
    folder.mkdir()
    (folder / "plan.toml").write_text(text)
    shutil.copy(PLANS / "yard.toml", folder)
    return folder / "plan.toml"
