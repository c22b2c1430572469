"""docs/gallery.md: `make gallery` runs the page's own commands, and each makes its picture."""

import importlib
import re
import sys
from pathlib import Path

import firsthit as fh
import pytest
from support import some

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "gallery.md").read_text()


@pytest.fixture(scope="module")
def make():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(ROOT / "docs" / "gallery")
        patch.setattr(sys, "dont_write_bytecode", True)
        yield importlib.import_module("make")


@pytest.fixture(scope="module")
def folder(make, tmp_path_factory):
    path = tmp_path_factory.mktemp("gallery")
    make.prepare(path)
    return path


def test_make_gallery_runs_each_command_of_the_page_and_no_other(make):
    blocks = re.findall(r"```(\w+)\n(.*?)\n```", PAGE, re.DOTALL)
    assert [(each.language, each.lines) for each in make.pictures(PAGE)] == blocks
    assert "\t$(VENV)/python docs/gallery/make.py $(ONLY)\n" in (ROOT / "Makefile").read_text()


def test_each_picture_of_the_page_is_there_and_is_what_its_command_writes(make):
    shown = re.findall(r"!\[[^]]+\]\(([^)]+)\)", PAGE)
    assert len(shown) == 24
    assert [f"gallery/{each.name}" for each in make.pictures(PAGE)] == shown
    kept = {f"gallery/{path.name}" for path in (ROOT / "docs" / "gallery").glob("*.png")}
    if not kept:
        pytest.skip("a source distribution has no pictures")
    assert kept == set(shown)
    for each in make.pictures(PAGE):
        written = re.findall(r"-o (\S+)|\.save\(\"(.*?)\"\)", each.lines)
        assert ["".join(names) for names in written] == [each.name]


def test_the_first_picture_of_the_readme_is_of_the_gallery(make):
    (first,) = re.findall(r"\A!\[[^]]+\]\(docs/gallery/([^)]+)\)", (ROOT / "README.md").read_text())
    assert first in [each.name for each in make.pictures(PAGE)]


def test_each_command_of_the_page_makes_its_picture(make, folder):
    languages = [
        [each for each in make.pictures(PAGE) if each.language == language]
        for language in ("sh", "python")
    ]
    for each in [each for alike in languages for each in some(alike)]:
        small = re.sub(r" (\\\n +)?--(size|samples) \S+", "", each.lines)
        small = f"{small} --size 180x120 --samples 2 --quiet"
        if each.language == "python":
            small = (
                each.lines.replace("280", "120")
                .replace("420", "180")
                .replace("samples=32", "samples=2")
            )
        each._replace(lines=small).make(folder)
        assert fh.Frame.load(folder / each.name)["color"].shape[:2] == (120, 180)


def test_a_packed_picture_has_the_same_pixels_and_says_the_same(make, folder):
    each = next(each for each in make.pictures(PAGE) if each.name == "shell.png")
    each._replace(lines=re.sub(r"--(size|samples) \S+", "", each.lines) + "--size 64x48").make(
        folder
    )
    path, other = folder / each.name, folder / "packed.png"
    other.write_bytes(make.packed(path))
    assert other.stat().st_size < path.stat().st_size
    assert (fh.Frame.load(path)["color"] == fh.Frame.load(other)["color"]).all()
    assert fh.read_metadata(path) == fh.read_metadata(other)
