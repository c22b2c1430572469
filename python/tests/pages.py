"""The pages of the documentation: their code blocks, which run as a reader would run them.

A page of docs/start or docs/tasks is run from the clone's root, block after block:

- ``python`` blocks share their names, ``sh`` blocks are commands of a Unix shell;
- a ``text`` block is what the block before it prints, ``...`` standing for anything;
- a block that begins with a comment that is a file's name (``# plan.toml``) is that file;
- a picture that the page shows is one that its blocks write, by that name.

Run as a program, it makes the pictures of the pages that are named, packed, beside those of the
other pages: ``.venv/bin/python python/tests/pages.py docs/start/vision.md``.
"""

from __future__ import annotations

import contextlib
import doctest
import io
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple
from unittest import mock

import firsthit as fh
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"

#: What sets firsthit up. `make test-installed` does it; it takes minutes.
SETTING_UP = re.compile(r"pip install \S+|python -m venv \S+|\. \S+/activate|cargo .*|cd \S+")

#: Languages that are read, not run.
DATA = ("toml", "json")


class Block(NamedTuple):
    """A block of code of a page."""

    language: str
    text: str
    #: The line of its first line, from 1.
    line: int

    @property
    def file(self) -> str | None:
        """The name of the file that the block is."""
        found = re.match(r"(?:#|//) (\S+\.\w+)\n", self.text)
        return found[1] if found else None

    @property
    def sets_up(self) -> bool:
        """Whether it sets firsthit up, and does nothing else."""
        lines = self.text.splitlines()
        return self.language == "sh" and all(SETTING_UP.fullmatch(line) for line in lines)


def blocks(page: Path | str, language: str | None = None) -> list[Block]:
    """Return the code blocks of a page, or of a page's text, in their order."""
    text = page if isinstance(page, str) else page.read_text(encoding="utf-8")
    found = re.finditer(r"^```([^\n]*)\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)
    every = [Block(each[1], each[2], text.count("\n", 0, each.start()) + 2) for each in found]
    return [each for each in every if language in (None, each.language)]


def pictures(page: Path | str) -> list[str]:
    """Return the pictures that a page shows, as it names them."""
    text = page if isinstance(page, str) else page.read_text(encoding="utf-8")
    return re.findall(r"!\[[^]]+\]\(([^)\s]+)\)", text)


def run(
    page: Path,
    folder: Path,
    *,
    set_up: bool = False,
    told: dict[str, Any] | None = None,
    edit: Callable[[str], str] = lambda text: text,
) -> dict[str, Any]:
    """Run a page's blocks in a folder, which is also the working directory, and return the names.

    The folder gets links to what the root has. What sets firsthit up is left out, with what it
    prints, unless it is asked for. ``told`` are names that the first block finds, and ``edit``
    changes a block before it runs.
    """
    for name in ("docs", "testdata"):
        (folder / name).symlink_to(ROOT / name, target_is_directory=True)
    path = f"{commands(folder)}{os.pathsep}{os.environ['PATH']}"
    told = {} if told is None else told
    printed: str | None = None
    here = folder
    with mock.patch.dict(os.environ, PATH=path):
        for block in blocks(page):
            place, text = f"{page.relative_to(ROOT)}:{block.line}", edit(block.text)
            if block.language == "text":
                if printed is not None:
                    _compare(text, printed, place)
            elif block.file is not None:
                (here / block.file).parent.mkdir(parents=True, exist_ok=True)
                (here / block.file).write_text(text, encoding="utf-8")
            elif block.sets_up and not set_up:
                printed = None
            elif block.language == "python":
                said = io.StringIO()
                # Lines of their own, so that a traceback has those of the page.
                code = compile("\n" * (block.line - 1) + text, str(page), "exec")
                with contextlib.redirect_stdout(said):
                    exec(code, told)
                printed = said.getvalue()
            elif block.language in ("sh", "console"):
                printed = shell(f'{text}pwd > "{folder}/bin/here"', here, place)
                here = Path((folder / "bin" / "here").read_text().strip())
            elif block.language not in DATA:
                raise AssertionError(f"{place}: a block of {block.language or 'no language'}")
    return told


def shell(lines: str, here: Path, place: str) -> str:
    """Run lines of a shell in a folder, and return what a reader would see."""
    done = subprocess.run(
        ["/bin/sh", "-ec", lines],
        cwd=here,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    if done.returncode:
        raise AssertionError(f"{place}: exit code {done.returncode}\n{done.stdout}")
    return done.stdout


def commands(folder: Path) -> Path:
    """Make the commands be those that run the tests; return where they are.

    A new project of Cargo gets the versions that everything else is tested with.
    """
    place = folder / "bin"
    place.mkdir()
    lock = f"[ ! -f Cargo.toml ] || [ -f Cargo.lock ] || cp '{ROOT}/Cargo.lock' ."
    cargo = shutil.which("cargo") or "cargo"
    commands = {
        "firsthit": f'exec "{sys.executable}" -m firsthit "$@"',
        "python": f'exec "{sys.executable}" -B "$@"',
        "cargo": f'{lock}\nexec "{cargo}" "$@"',
    }
    for name, lines in commands.items():
        (place / name).write_text(f"#!/bin/sh\n{lines}\n")
        (place / name).chmod(0o755)
    return place


def _compare(expected: str, printed: str, place: str) -> None:
    checker, options = doctest.OutputChecker(), doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
    if not checker.check_output(expected, printed, options):
        raise AssertionError(f"{place}: printed\n{printed}\nin place of\n{expected}")


def same(one: Path, other: Path) -> bool:
    """Tell whether two pictures are the same, however they are packed."""
    if one.suffix == ".svg":
        return one.read_bytes() == other.read_bytes()
    one_frame, other_frame = fh.Frame.load(one), fh.Frame.load(other)
    return list(one_frame) == list(other_frame) and all(
        np.array_equal(one_frame[name], other_frame[name]) for name in one_frame
    )


def main() -> None:
    """Make the pictures of pages."""
    sys.path.insert(0, str(DOCS / "gallery"))
    sys.dont_write_bytecode = True
    from make import packed

    for name in sys.argv[1:]:
        page = (ROOT / name).resolve()
        with tempfile.TemporaryDirectory() as temporary:
            folder = Path(temporary)
            os.chdir(folder)
            run(page, folder)
            for shown in pictures(page):
                made, kept = folder / Path(shown).name, page.parent / shown
                if not made.exists():
                    print(f"{shown}: the page does not write it here")
                    continue
                if not kept.exists() or not same(made, kept):
                    has_color = kept.suffix == ".png" and "color" in fh.Frame.load(made)
                    kept.write_bytes(packed(made) if has_color else made.read_bytes())
                print(f"{kept.relative_to(ROOT)}: {kept.stat().st_size / 1024:.0f} KB")
            os.chdir(ROOT)


if __name__ == "__main__":
    main()
