"""One word for each thing: docs/reference/words.md, asked of every surface."""

import inspect
import json
import re
import subprocess
import sys
from functools import cache
from typing import get_args

import firsthit as fh
import firsthit.typing
import pytest
from firsthit import _firsthit
from firsthit.typing import FisheyeName
from support import ROOT, ball

TABLE = (ROOT / "docs/reference/words.md").read_text(encoding="utf-8")
#: Words for what has another name here.
OTHERS = {
    *("fov_degrees", "fov_deg", "vertical_fov_degrees", "vfov", "hfov", "yfov", "field_of_view"),
    *("closed", "clean", "divergence_mrad", "divergence_degrees", "resolution", "n_rows", "n_cols"),
    *("cols", "nrows", "ncols", "width_px", "height_px", "lookat", "spp", "tonemap", "cam"),
}
COMMANDS = ("render", "shoot", "probe", "inside", "section", "lint", "info", "scan", "dataset")


def words(column):
    """The words of a column, each with its thing."""
    rows = [line.split("|")[1:-1] for line in TABLE.splitlines() if line.startswith("|")][2:]
    found = [(row[0].strip(), word) for row in rows for word in re.findall(r"`(.+?)`", row[column])]
    assert len(found) > 15 or column == 5
    return found


def signature(named):
    """The arguments of a function, or of what makes an object."""
    return inspect.signature(named).parameters


def public():
    """Every function and class of the package, and every method of its classes, by name."""
    for name in fh.__all__:
        value = getattr(fh, name)
        if inspect.isclass(value):
            # An exception may have the signature of its C base, which says nothing.
            if not issubclass(value, Exception):
                yield name, value
            for own, method in vars(value).items():
                made = method.__func__ if isinstance(method, classmethod) else method
                if not own.startswith("_") and inspect.isfunction(made):
                    yield f"{name}.{own}", made
        elif inspect.isfunction(value):
            yield name, value


@cache
def help_of(command):
    """The help of a command of the program, with what options take."""
    run = [sys.executable, "-m", "firsthit", command, "--help"]
    return subprocess.run(run, capture_output=True, text=True, check=True).stdout


def options(command):
    """The options of a command, and what each takes."""
    return dict(re.findall(r"^ +(?:-\w, )?--([\w-]+)(?:[ =]<?([^\s>]+))?", help_of(command), re.M))


def keys(schema):
    """The keys of every table of a schema, with their table."""
    found = {("", key) for key in schema.get("properties", ())}
    for table, record in schema["$defs"].items():
        variants = record.get("oneOf") or record.get("anyOf") or [record]
        each = [record, *variants]
        found |= {(table, key) for one in each for key in one.get("properties", ())}
    return found


def nested(schema, path=()):
    """The paths of all keys of a schema without variants."""
    for key, value in schema.get("properties", {}).items():
        yield (*path, key)
        yield from nested(value, (*path, key))
        yield from nested(value.get("items", {}), (*path, key))


def scene_schema():
    return json.loads((ROOT / "docs/scene.schema.json").read_text(encoding="utf-8"))


def metadata_schema():
    schema = json.loads((ROOT / "docs/output-metadata.schema.json").read_text(encoding="utf-8"))
    schema["properties"]["camera"] = schema["$defs"]["camera"]
    return schema


@pytest.mark.parametrize(("thing", "word"), words(1))
def test_rust_has_the_word(thing, word):
    sources = "\n".join(
        path.read_text(encoding="utf-8") for path in (ROOT / "crates").glob("*/src/**/*.rs")
    )
    *_, name = word.split("::")
    declared = (
        rf"pub (?:const )?(?:fn|struct|enum|trait|type) {name}\b|pub enum {name},|pub {name}:"
    )
    settings = rf"^\s+{name}: f64, Domain"
    assert re.search(f"{declared}|{settings}", sources, re.M), (thing, word)


@pytest.mark.parametrize(("thing", "word"), words(2))
def test_python_has_the_word(thing, word):
    path, _, argument = word.rstrip(")").partition("(")
    value = fh
    for name in path.split("."):
        # A field without a default value is an annotation.
        value = getattr(value, name, None) or value.__annotations__[name]
    assert not argument or argument in signature(value), (thing, word)


@pytest.mark.parametrize(("thing", "word"), words(3))
def test_the_program_has_the_word(thing, word):
    command, _, option = word.partition(" --")
    assert not option or option in options(command), (thing, word)
    assert help_of(command)


@pytest.mark.parametrize(("thing", "word"), words(4))
def test_scene_files_have_the_word(thing, word):
    table, _, key = word.rpartition(".")
    assert (table, key) in keys(scene_schema()), (thing, word)


@pytest.mark.parametrize(("thing", "word"), words(5))
def test_metadata_have_the_word(thing, word):
    assert tuple(word.split(".")) in set(nested(metadata_schema())), (thing, word)


def test_metadata_of_a_picture_are_as_their_schema_says(tmp_path):
    camera = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 40, 6, 8)
    fh.render(ball(), camera, samples=1).save(tmp_path / "a.npz")
    metadata = fh.read_metadata(tmp_path / "a.npz")
    paths = set(nested(metadata_schema()))
    assert {(key,) for key in metadata} <= paths
    assert {("camera", key) for key in metadata["camera"]} <= paths
    assert (metadata["camera"]["rows"], metadata["camera"]["columns"]) == (6, 8)


def test_no_surface_has_another_word():
    python = {(name, one) for name, made in public() for one in signature(made)}
    python |= {(name, name.rpartition(".")[2]) for name, _ in public()}
    program = {(command, one.replace("-", "_")) for command in COMMANDS for one in options(command)}
    files = keys(scene_schema()) | {
        (".".join(path), path[-1]) for path in nested(metadata_schema())
    }
    assert min(map(len, (python, program, files))) > 100
    assert [one for one in sorted(python | program | files) if one[1] in OTHERS] == []


def test_rows_are_before_columns_and_sizes_are_columns_by_rows():
    asked = [(name, list(signature(made))) for name, made in public()]
    both = [(name, order) for name, order in asked if {"rows", "columns"} <= {*order}]
    assert len(both) > 3
    for name, order in both:
        assert order.index("rows") < order.index("columns"), name
    for command in ("render", "probe"):
        assert options(command)["size"] == "COLUMNSxROWS"
    assert options("probe")["pixel"] == "ROW,COLUMN"


def test_numbers_of_shaders_and_lenses_have_one_name_everywhere(tmp_path):
    known = keys(scene_schema())
    for shader in get_args(fh.typing.ShaderName):
        for name, _ in _firsthit.shader_settings(shader):
            assert ("shading", name) in known, (shader, name)
    ahead = (0, 0, 5), (0, 0, -1), (0, 1, 0)
    cameras = [fh.Camera.fisheye(*ahead, 120, 4, 6, kind) for kind in get_args(FisheyeName)]
    cameras.append(fh.Camera.equirectangular(*ahead, 4, 8, horizontal_fov=90))
    for camera in cameras:
        fh.render(ball(), camera, channels=["t"]).save(tmp_path / "a.npz")
        written = fh.read_metadata(tmp_path / "a.npz")["camera"]["parameters"]
        assert {*written} == {*camera.parameters} != set(), camera.projection
        assert {("camera", name) for name in written} <= known, camera.projection
