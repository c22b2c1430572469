"""The JSON Schema of scene files and their reader refuse the same files."""

import json
import tomllib
from itertools import combinations_with_replacement

import firsthit as fh
import pytest
from support import FEWER, FULL, ROOT, cases, some

jsonschema = pytest.importorskip("jsonschema")

DOCS = ROOT / "docs"
SCHEMA = json.loads((DOCS / "scene.schema.json").read_text())
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)
#: The definition of colours: no table, but a value of several forms.
COLOR = "#/$defs/color"


def as_toml(value) -> str:
    """JSON as an inline value of TOML."""
    if isinstance(value, list):
        return f"[{', '.join(map(as_toml, value))}]"
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{name} = {as_toml(item)}' for name, item in value.items())} }}"
    return json.dumps(value)


def in_scene(kind: str, table: dict) -> dict:
    """Where the kinds of tables stand in a scene file."""
    ball = {"shape": "sphere", "center": [0, 0, 0], "radius": 1}
    match kind:
        case "scene":
            return table
        case "camera":
            return {"cameras": {"front": table}}
        case "object" | "light" | "output":
            return {f"{kind}s": [table]}
        case "rotation":
            return {"objects": [{**ball, "rotate": table}]}
        case "material":
            return {"objects": [{**ball, "material": table}]}
        case "daylight":
            return {"environment": {"daylight": table}}
    return {kind: table}


#: Values that make sense, by table and key; by key alone for all tables.
SAMPLES = {
    ("object", "file"): "t.obj",
    ("output", "file"): "a.png",
    ("environment", "file"): "t.hdr",
    ("colors", "range"): [-2, 3],
    "position": [5, 0.5, 0],
    "look_at": [0, 0, 1],
    "up": [0, 0, 1],
    "aim": [0, 2, 0],
    "low": [-1, -1, -1],
    "bottom": [-1, -1, -1],
    "high": [1, 1, 1],
    "top": [1, 1, 1],
    "pose": [[1, 0, 0, 5], [0, 1, 0, 6], [0, 0, 1, 7]],
    "matrix": [[0, 0, 1, 5], [1, 0, 0, 6], [0, 1, 0, 7]],
    "scale": [1, 2, -3],
    "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0.5]],
    "triangles": [[0, 1, 2]],
    "rotate": {"quaternion": [0, 0, 1, 1]},
    # A cube map has three faces across and two down.
    "columns": 6,
    "rows": 4,
    # The file has none, and to name one that a file has not is an error.
    "variant": None,
}


def sample(kind: str, name: str, form: dict):
    """A value that makes sense under a key; None for a table, and for what has none here."""
    for known in ((kind, name), name):
        if known in SAMPLES:
            return SAMPLES[known]
    if "const" in form:
        return form["const"]
    if "enum" in form:
        return form["enum"][0]
    if "oneOf" in form:
        return sample(kind, name, form["oneOf"][0])
    if "$ref" in form:
        return "tomato" if form["$ref"] == COLOR else None
    match form.get("type"):
        case "boolean":
            return False
        case "number" | "integer":
            return 1
        case "string":
            return "text"
        case "array":
            return [sample(kind, "", form.get("items", {})) for _ in range(form.get("minItems", 1))]
    return {}


def variants() -> list[tuple[str, dict]]:
    """The forms of each kind of table."""
    found = [("scene", SCHEMA)]
    for kind, record in SCHEMA["$defs"].items():
        if not COLOR.endswith(f"/{kind}"):
            found += [(kind, form) for form in record.get("oneOf", [record])]
    assert len(found) > 18
    return found


def properties(kind: str, form: dict) -> dict:
    """The keys of a form of table, but those of tables in it, with a value for each."""
    values = {name: sample(kind, name, each) for name, each in form["properties"].items()}
    return {name: value for name, value in values.items() if value not in (None, [None])}


def least(kind: str, form: dict) -> dict:
    """The least table of a form."""
    required = form.get("required", [])
    table = {name: value for name, value in properties(kind, form).items() if name in required}
    tags = {name: each["const"] for name, each in form["properties"].items() if "const" in each}
    table |= {name: tag for name, tag in list(tags.items())[:1] if isinstance(tag, str)}
    if "daylight" in required:
        table["daylight"] = {"elevation": 30}
    if kind == "rotation":
        table["quaternion"] = [0, 0, 0, 1]
    return table


class Judges:
    """Asks both."""

    def __init__(self, folder):
        (folder / "t.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        picture = b"#?RADIANCE\n\n-Y 1 +X 2\n\x01\x02\x03\x80\x01\x02\x03\x80"
        (folder / "t.hdr").write_bytes(picture)
        self.path = folder / "scene.toml"
        self.asked = self.refused = 0

    def accept(self, kind: str, table: dict) -> bool:
        """Whether both accept; fails where they do not agree."""
        scene = in_scene(kind, table)
        text = "".join(f"{name} = {as_toml(value)}\n" for name, value in scene.items())
        self.path.write_text(text)
        try:
            fh.load(self.path)
            mistake = None
        except ValueError as error:
            mistake = error
        is_valid = VALIDATOR.is_valid(scene)
        assert (mistake is None) == is_valid, f"{text}\n{mistake}"
        self.asked += 1
        self.refused += not is_valid
        return is_valid


@pytest.fixture
def judges(tmp_path):
    return Judges(tmp_path)


def test_the_schema_is_one():
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


@pytest.mark.parametrize(("kind", "key"), [("background", "color"), ("shading", "ambient")])
def test_colours_are_refused_or_taken_by_both(kind, key, judges):
    for color, is_one in [
        ("tomato", True),
        ("Tomato", False),
        ("#FF6347", True),
        ("#ff634", False),
        ("reddish", False),
        ([1, 0, 2.5], True),
        ([1, -1, 0], False),
        ([1, 0], False),
        (1, False),
        ("transparent", kind == "background"),
    ]:
        assert judges.accept(kind, {key: color}) == is_one, color


def test_every_example_is_valid():
    paths = list((DOCS / "scenes").glob("*.toml"))
    assert len(paths) >= 8
    for path in paths:
        VALIDATOR.validate(tomllib.loads(path.read_text()))


def test_every_key_is_taken_alone_and_with_every_other_as_the_schema_says(judges):
    for kind, form in variants():
        table = least(kind, form)
        assert judges.accept(kind, table), (kind, table)
        pairs = combinations_with_replacement(properties(kind, form).items(), 2)
        for one, other in some(list(pairs)):
            judges.accept(kind, table | dict([one, other]))
    assert judges.asked > cases(400)
    assert judges.refused > cases(40)


def is_known_to_the_reader_alone(name: str, wrong) -> bool:
    """Return whether no schema can say that a value is wrong.

    The middle of an empty scene, which the camera looks at; the names of files; that not both ends
    of a cone are points; that triangles index vertices.
    """
    values = {"position": [0, 0, 0], "bottom_radius": 0, "vertices": []}
    return values.get(name) == wrong or (name == "file" and isinstance(wrong, str))


#: Values that most keys do not take.
WRONG = [True, "?", -7.5, [], [[1]], {"a": 1}, 0, [0, 0, 0]]


def test_misspelt_missing_and_mistyped_keys_are_refused_by_both(judges):
    for kind, form in variants():
        table = least(kind, form)
        for k, (name, value) in enumerate(properties(kind, form).items()):
            assert not judges.accept(kind, {**table, f"{name}x": value}), f"{kind}: {name}x"
            # Of each key other ones.
            for wrong in WRONG if FULL else WRONG[k % FEWER :: FEWER]:
                if not is_known_to_the_reader_alone(name, wrong):
                    judges.accept(kind, {**table, name: wrong})
        for name in table:
            judges.accept(kind, {key: value for key, value in table.items() if key != name})
    assert judges.asked > cases(800)
    assert judges.refused > cases(600)


def test_the_documentation_says_of_every_key_what_the_schema_says():
    text = (DOCS / "scene.md").read_text()
    for kind, form in variants():
        for name, each in form["properties"].items():
            if "description" in each:
                row = f"\n| `{name}` | {each['description']} |\n"
            else:
                row = f'"{each["const"]}"`'
            assert row in text, (kind, name)


def test_every_example_is_in_the_documentation_with_its_pictures():
    text = (DOCS / "scene.md").read_text()
    for path in (DOCS / "scenes").iterdir():
        assert path.suffix == ".obj" or f"(scenes/{path.name})" in text
