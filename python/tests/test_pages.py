"""The pages of docs/start and docs/tasks run as they stand, and write the pictures they show."""

import re
import sys

import firsthit as fh
import numpy as np
import pages
import pytest
from pages import DOCS, ROOT
from support import some

PAGES = sorted([*(DOCS / "start").glob("*.md"), *(DOCS / "tasks").glob("*.md")])

#: Only `make test-installed` runs this one: it compiles the crate.
COMPILED = DOCS / "start" / "rust.md"

#: The one page that follows a whole chapter.
CHAPTER = DOCS / "start" / "chapter.md"


def name(page):
    return str(page.relative_to(DOCS))


@pytest.mark.skipif(sys.platform == "win32", reason="the lines are for a Unix shell")
@pytest.mark.parametrize("page", some([page for page in PAGES if page != COMPILED]), ids=name)
def test_each_block_runs_and_the_pictures_are_those_it_writes(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    pages.run(page, tmp_path)
    for shown in pages.pictures(page):
        kept = page.parent / shown
        assert pages.same(tmp_path / kept.name, kept), f"python/tests/pages.py {name(page)}"


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_a_page_has_code_and_says_where_to_go_next(page):
    text = page.read_text(encoding="utf-8")
    assert pages.blocks(text, "sh")
    assert "\n## Where to go next\n" in text
    assert len(text.splitlines()) <= (190 if page == CHAPTER else 130)
    for shown in pages.pictures(text):
        assert (page.parent / shown).stat().st_size < 60_000, shown


def test_each_task_has_a_picture_that_it_makes_a_command_and_python():
    for page in (DOCS / "tasks").glob("*.md"):
        assert pages.pictures(page), page
        assert {"sh", "python"} <= {block.language for block in pages.blocks(page)}, page


def test_the_chapter_has_the_camera_of_its_scene(monkeypatch):
    monkeypatch.chdir(ROOT)
    letters = {}
    exec(pages.blocks(CHAPTER, "python")[0].text, letters)
    sizes = {"rows": letters["M"], "columns": letters["N"]}
    numbers = (letters[name] for name in ("x_c", "u_c", "v_up", "z_p", "w", "h"))
    own = letters["scene"].camera(**sizes)
    of_page = fh.Camera(*numbers, **sizes, ray_start=own.ray_start)
    for one, other in zip(own.rays(), of_page.rays(), strict=True):
        np.testing.assert_array_equal(one, other)


def test_only_what_sets_up_is_left_out():
    left = {block.text for page in PAGES for block in pages.blocks(page) if block.sets_up}
    pip = "python -m venv .venv\n. .venv/bin/activate\npip install .\n"
    assert left - {pip} == {block.text for block in pages.blocks(COMPILED, "sh")}


def test_a_wrong_output_and_an_unknown_language_are_told(tmp_path, monkeypatch):
    monkeypatch.setattr(pages, "ROOT", tmp_path)
    page = tmp_path / "page.md"
    for at, (text, told) in enumerate(
        {
            "```python\nprint(1)\n```\n```text\n2\n```\n": r"page\.md:5: printed\s+1",
            "```sh\nfalse\n```\n": r"page\.md:2: exit code 1",
            "```ruby\n```\n": r"page\.md:2: a block of ruby",
        }.items()
    ):
        page.write_text(text)
        (folder := tmp_path / str(at)).mkdir()
        with pytest.raises(AssertionError, match=told):
            pages.run(page, folder)


@pytest.mark.parametrize("module", [fh, fh.annotations, fh.datasets, fh.many])
def test_the_reference_has_each_public_name_once(module):
    told = "".join(page.read_text() for page in (DOCS / "reference" / "python").glob("*.md"))
    documented = re.findall(r"^::: (\S+)$", told, re.MULTILINE)
    assert len(documented) == len(set(documented))
    public = {f"{module.__name__}.{each}" for each in module.__all__}
    elsewhere = {each for each in public if each.removeprefix(module.__name__ + ".") in fh.__all__}
    if module is fh:
        # Modules have pages of their own.
        elsewhere = {f"firsthit.{each}" for each in ("annotations", "datasets", "many")}
        public.add("firsthit.open")
    assert public - elsewhere <= set(documented)


def test_all_pages_are_in_the_site_s_contents():
    config = (ROOT / "mkdocs.yml").read_text()
    listed = re.findall(r"(\S+\.md)$", config.split("\nnav:\n")[1], re.MULTILINE)
    written = {str(page.relative_to(DOCS)) for page in DOCS.rglob("*.md")}
    made = {"index.md", "architecture.md", "contributing.md", "changelog.md"}
    made.add("reference/program.md")
    assert len(listed) == len(set(listed))
    assert set(listed) == written | made
