"""What tests of several commands and jobs share."""

import os
import sys
from pathlib import Path

import pytest
from _firsthit_program import main as program


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
def workers_find_the_tests(monkeypatch):
    """Processes that are started anew import `many_support`."""
    path = os.environ.get("PYTHONPATH")
    own = str(Path(__file__).parent)
    monkeypatch.setenv("PYTHONPATH", own if path is None else f"{own}{os.pathsep}{path}")
