"""The floors of the package: which folder may import which (see ARCHITECTURE.md)."""

import ast
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest
from support import ROOT

PACKAGE = ROOT / "python" / "firsthit"
#: The last floor of what a raycaster's user needs. What stands above are programs over it.
TOP = "_scene"
#: What is no folder: the native half, which all may import, and the names that the package has.
NATIVE, NAMES = "_firsthit", "firsthit"


class Import(NamedTuple):
    """A folder that a file imports from, and whether that is for type checkers alone."""

    path: Path
    line: int
    name: str
    is_for_types: bool


def floors() -> dict[str, list[str]]:
    """Each folder of the table in ARCHITECTURE.md from the lowest on, and what it may import."""
    text = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    _, table = text.split("| folder | job | imports |\n|---|---|---|\n")
    rows = (row.strip("|").split("|") for row in table.split("\n\n")[0].splitlines())
    return {
        name.strip(" `"): [one.strip() for one in imports.split(",") if one.strip() != "-"]
        for name, _, imports in rows
    }


FLOORS = floors()
CORE = list(FLOORS)[: list(FLOORS).index(TOP) + 1]


def imported(node: ast.AST, path: Path) -> Iterator[str]:
    """Yield what an import names right below `firsthit`."""
    if isinstance(node, ast.ImportFrom):
        here = [NAMES, *path.relative_to(PACKAGE).parent.parts]
        above = ".".join(here[: len(here) - node.level + 1]) if node.level else None
        first, *rest = ".".join(filter(None, (above, node.module))).split(".")
        if first == NAMES:
            names = rest[:1] or [alias.name for alias in node.names]
            yield from (name if name in (NATIVE, *FLOORS) else NAMES for name in names)
    elif isinstance(node, ast.Import):
        for alias in node.names:
            first, *rest = alias.name.split(".")
            if first == NAMES:
                yield rest[0] if rest else NAMES


def is_for_checkers(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"


def imports(folder: str) -> list[Import]:
    """Return the imports of a folder's files from others, also within functions."""
    paths = sorted((PACKAGE / folder).rglob("*.py")) or [PACKAGE / f"{folder}.py"]
    found = []
    for path in paths:
        tree = ast.parse(path.read_text(encoding="utf-8"))
        of_types = {
            id(node)
            for block in ast.walk(tree)
            if is_for_checkers(block)
            for node in ast.walk(block)
        }
        for node in ast.walk(tree):
            for name in imported(node, path):
                if name not in (NATIVE, folder):
                    found.append(Import(path, node.lineno, name, id(node) in of_types))
    return found


def test_each_folder_is_a_floor_of_the_table():
    there = {path.parent.name for path in PACKAGE.glob("*/*.py")}
    there |= {path.stem for path in PACKAGE.glob("*.py")} - {"__init__", "__main__"}
    assert set(FLOORS) == there


@pytest.mark.parametrize("folder", FLOORS)
def test_a_folder_imports_what_its_row_says_and_all_of_that(folder):
    used = [one for one in imports(folder) if not one.is_for_types]
    wrong = [one for one in used if one.name not in FLOORS[folder]]
    assert not wrong, wrong
    assert {one.name for one in used} == set(FLOORS[folder])


def test_imports_go_down():
    lower = [NAMES]
    for folder, names in FLOORS.items():
        assert set(names) <= set(lower), folder
        lower.append(folder)


@pytest.mark.parametrize("folder", CORE)
def test_the_core_does_not_know_what_stands_on_it_even_by_types(folder):
    above = set(FLOORS) - set(CORE) | {NAMES}
    wrong = [one for one in imports(folder) if one.name in above]
    assert not wrong, wrong
