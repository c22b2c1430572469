"""``firsthit dataset``: its words, its report and its exit codes."""

import json
import re
import shutil
import subprocess
import sys

import firsthit as fh
import pytest
from _firsthit_program import main as program
from dataset_support import PLANS, tree

PLAN = str(PLANS / "turntable.toml")


def run(monkeypatch, capsys, *arguments):
    monkeypatch.setattr(sys, "argv", ["firsthit", *map(str, arguments)])
    code = program()
    said = capsys.readouterr()
    return code, said.out, said.err


@pytest.fixture
def firsthit(monkeypatch, capsys):
    return lambda *arguments: run(monkeypatch, capsys, *arguments)


def test_it_makes_what_the_function_makes(firsthit, tmp_path):
    made = fh.dataset(PLAN, tmp_path / "one")
    code, out, err = firsthit("dataset", PLAN, "-o", tmp_path / "two", "--threads", 2)
    assert (code, err) == (0, "")
    assert out == f"{tmp_path / 'two'}: 6 frames made, 0 kept, all 6 there\ndigest {made.digest}\n"
    assert tree(tmp_path / "one") == tree(tmp_path / "two")


def test_parts_say_what_is_missing(firsthit, tmp_path):
    code, out, _ = firsthit("dataset", PLAN, "-o", tmp_path, "--part", "2/3")
    assert (code, out) == (0, f"{tmp_path}: 2 frames made, 0 kept, 4 missing\n")
    _, out, _ = firsthit("dataset", PLAN, "-o", tmp_path, "--part", "1/1", "--json")
    said = json.loads(out)
    assert 0 < said.pop("seconds") < 60
    assert said.pop("digest") == fh.dataset(PLAN, tmp_path).digest
    assert said == {"output": str(tmp_path), "frames": 6, "made": 4, "kept": 2, "missing": 0} | {
        "warnings": []
    }
    assert firsthit("dataset", PLAN, "-o", tmp_path, "-q", "--verify") == (0, "", "")


def test_a_check_makes_nothing_and_says_what_frames_come_to(firsthit, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, out, err = firsthit("dataset", PLAN, "--check")
    assert (code, err) == (0, "")
    assert out.splitlines()[:2] == ["6 frames: 1 scene, 6 poses each", "sensors: camera"]
    assert out.splitlines()[2:] == [
        "rays: 41472",
        "bytes: at most about 124 KB without annotations",
        "up: +z (as the file says)",
    ]
    said = json.loads(firsthit("dataset", PLAN, "--check", "--json")[1])
    assert (said["frames"], said["rays"], said["bytes"]) == (6, 41472, 3 * 41472)
    assert said["plan"] == fh.Plan.load(PLAN).digest
    assert said["scenes"][0]["fingerprint"].startswith("blake3:")
    assert list(tmp_path.iterdir()) == []


def test_a_check_says_which_way_is_up_in_each_scene(firsthit, tmp_path):
    """A pyramid that stands on its base along z, which is not the convention of OBJ."""
    corners = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv 0 0 2\n"
    faces = "f 1 3 2\nf 1 4 3\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n"
    (tmp_path / "tent.obj").write_text(corners + faces)
    (tmp_path / "leaf.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    (tmp_path / "yard.toml").write_text((PLANS / "yard.toml").read_text())
    path = tmp_path / "plan.toml"
    poses = '[[sensors]]\ncolumns = 8\nrows = 6\n[poses]\nkind = "sphere"\ncount = 1\nradius = 9\n'
    scenes = [
        ('file = "tent.obj"', "+z", "guessed from a flat base"),
        ('file = "leaf.obj"', "+y", "by the format's convention"),
        ('file = "leaf.obj"\nname = "leaf"\nup = [0, -2, 0]', "0,-2,0", "as the plan says"),
        ('file = "yard.toml"', "+z", "as the file says"),
    ]
    path.write_text("".join(f"[[scenes]]\n{keys}\n" for keys, _, _ in scenes) + poses)
    names = fh.Plan.load(path).scenes
    expected = [
        f"up in {name}: {up} ({source})"
        for name, (_, up, source) in zip(names, scenes, strict=True)
    ]
    assert firsthit("dataset", path, "--check")[1].splitlines()[4:] == expected
    said = json.loads(firsthit("dataset", path, "--check", "--json")[1])["scenes"]
    assert [one["up"] for one in said] == [[0, 0, 1], [0, 1, 0], [0, -2, 0], [0, 0, 1]]
    assert [one["up_source"] for one in said] == [source for _, _, source in scenes]


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        ([], 2, "the following arguments are required: PLAN; see firsthit dataset --help"),
        ([PLAN], 2, "--output must be given"),
        ([PLAN, "-o", "x", "--part", "4/3"], 2, "'4/3' is not K/N with K from 1 to N"),
        ([PLAN, "-o", "x", "--part", "0/3"], 2, "is not K/N"),
        ([PLAN, "-o", "x", "--threads", "0"], 2, "is not a number from 1 to 1024"),
        (
            [PLAN, "-o", "x", "--thread", "1"],
            2,
            "tip: a similar argument exists: '--threads'; see",
        ),
        ([PLAN, "--check", "-o", "x"], 2, "--check makes nothing: leave out --output"),
        (["none.toml", "-o", "x"], 3, "none.toml: No such file or directory"),
        ([str(PLANS / "yard.toml"), "--check"], 3, "missing key `scenes`"),
        ([PLAN, "-o", PLAN], 4, "a file, not a folder"),
    ],
)
def test_failures_are_one_line_with_an_exit_code(
    firsthit, tmp_path, monkeypatch, arguments, code, words
):
    monkeypatch.chdir(tmp_path)
    got, out, err = firsthit("dataset", *arguments)
    assert (got, out) == (code, "")
    assert err.startswith("firsthit: error: ")
    assert words in err
    assert err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
    got, out, _ = firsthit("dataset", *arguments, "--json")
    said = json.loads(out)
    assert (got, said["exit_code"]) == (code, code)
    assert words in said["error"]


def test_a_key_of_classes_without_an_object_is_a_line(firsthit, tmp_path):
    text = (PLANS / "turntable.toml").read_text()
    (tmp_path / "yard.toml").write_text((PLANS / "yard.toml").read_text())
    path = tmp_path / "plan.toml"
    path.write_text(text.replace('ball = "ball"', 'bal = "ball"'))
    line = "scene 'yard.toml': classes: no object has its class by 'bal', did you mean 'ball'?"
    for rest in (["--check"], ["-o", tmp_path / "out"]):
        code, _, err = firsthit("dataset", path, *rest)
        assert (code, err) == (0, f"firsthit: warning: {line}\n")
    said = json.loads(firsthit("dataset", path, "--check", "--json")[1])
    assert said["warnings"] == [line]


def test_names_in_files_cannot_write_to_the_terminal(firsthit, tmp_path):
    path = tmp_path / "plan.toml"
    (tmp_path / "yard.toml").write_text((PLANS / "yard.toml").read_text())
    path.write_text('"\\u001b[31m\\u202e" = 1\n' + (PLANS / "turntable.toml").read_text())
    code, _, err = firsthit("dataset", path, "--check")
    assert code == 3
    assert "unknown key `\\u{1b}[31m\\u{202e}`" in err


def test_a_picture_that_does_not_fit_into_memory_is_a_limit(firsthit, tmp_path):
    text = (PLANS / "turntable.toml").read_text()
    (tmp_path / "yard.toml").write_text((PLANS / "yard.toml").read_text())
    path = tmp_path / "plan.toml"
    path.write_text(text.replace("columns = 96", f"columns = {2**30}"))
    assert firsthit("dataset", path, "-o", tmp_path / "out")[0] == 5


def test_help_and_version_are_those_of_the_other_commands(firsthit):
    code, text, err = firsthit("dataset", "--help")
    assert (code, err) == (0, "")
    assert text.startswith("usage: firsthit dataset")
    assert "Examples:\n  firsthit dataset plan.toml" in text
    assert max(map(len, text.splitlines())) <= 80
    assert firsthit("help", "dataset") == (0, text, "")
    assert firsthit("dataset", "-V") == (0, f"firsthit {fh.__version__}\n", "")


def test_the_other_commands_do_not_load_the_package():
    script = "import sys\nfrom _firsthit_program import main\nmain()\n"
    script += "assert 'firsthit' not in sys.modules and 'numpy' not in sys.modules"
    command = [sys.executable, "-c", script, "schema"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr


@pytest.mark.parametrize("name", ["robot", "turntable"])
def test_the_plans_of_the_document_can_be_made(firsthit, tmp_path, name):
    code, out, err = firsthit("dataset", PLANS / f"{name}.toml", "-o", tmp_path)
    assert (code, err) == (0, "")
    assert "frames made" in out


def test_the_lines_of_the_document_run(tmp_path, monkeypatch):
    text = (PLANS.parent / "datasets.md").read_text()
    for path in PLANS.glob("*.toml"):
        shutil.copy(path, tmp_path)
    monkeypatch.chdir(tmp_path)
    (script,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    told = {}
    exec(script, told)
    assert told["made"].missing == 0
    (short,) = re.findall(r"```toml\n(.*?)```", text, re.DOTALL)
    (tmp_path / "short.toml").write_text(short)
    assert fh.Plan.load("short.toml").frames == 1000
    assert fh.dataset("short.toml", "short", part=(1, 500)).made == 2
    # The line that the document shows is that of such a mistake.
    wrong = (PLANS / "robot.toml").read_text().replace("columns = 160", "colums = 160", 1)
    (tmp_path / "robot.toml").write_text(wrong)
    with pytest.raises(fh.FileFormatError) as caught:
        fh.Plan.load("robot.toml")
    assert f"    {caught.value}\n" in text
