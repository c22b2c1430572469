"""``firsthit dataset``: its words, its report and its exit codes."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time

import firsthit as fh
import pages
import pytest
from dataset_support import LONG, PLANS, plan, record, tree
from support import FULL

PLAN = str(PLANS / "turntable.toml")
POSIX = pytest.mark.skipif(sys.platform == "win32", reason="signals are those of Unix")


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
        ([PLAN, "--check", "--workers", "2"], 2, "--check makes nothing: leave out --workers"),
        ([PLAN, "-o", "x", "--workers", "0"], 2, "is not a number from 1 to 1024"),
        (["none.toml", "-o", "x"], 3, "none.toml: No such file or directory"),
        ([str(PLANS / "yard.toml"), "--check"], 3, "unknown key `objects`; this table takes "),
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
    line = "scene 'yard.toml': classes: no object has its class by 'bal'; did you mean 'ball'?"
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
    path.write_text(text.replace("columns = 96", f"columns = {2**28}"))
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
    page = PLANS.parent / "datasets.md"
    for path in PLANS.glob("*.toml"):
        shutil.copy(path, tmp_path)
    monkeypatch.chdir(tmp_path)
    (script,) = pages.blocks(page, "python")
    told = {}
    exec(script.text, told)
    assert told["made"].missing == 0
    short, look = (block.text for block in pages.blocks(page, "toml"))
    (tmp_path / "short.toml").write_text(short)
    assert fh.Plan.load("short.toml").frames == 1000
    assert fh.dataset("short.toml", "short", part=(1, 500)).made == 2
    assert look.startswith("[output]\n")
    (tmp_path / "look.toml").write_text(short.split("[output]")[0] + look)
    (tmp_path / "studio.hdr").write_bytes(b"#?RADIANCE\n\n-Y 1 +X 1\n\x80\x80\x80\x80")
    said = fh.Plan.load("look.toml")._output.look.said
    assert (said["samples"], said["shade"]["depth"]) == (64, 4.0)
    assert not said["environment"].seen
    # The line that the document shows is that of such a mistake.
    wrong = (PLANS / "robot.toml").read_text().replace("columns = 160", "colums = 160", 1)
    (tmp_path / "robot.toml").write_text(wrong)
    with pytest.raises(fh.FileFormatError) as caught:
        fh.Plan.load("robot.toml")
    assert f"    {caught.value}\n" in page.read_text()


@pytest.fixture
def in_workers():
    """Start the command with two workers, in a session of its own."""
    begun = []

    def start(*arguments, **options):
        line = [sys.executable, "-m", "firsthit", "dataset", *map(str, arguments)]
        options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True} | options
        options["start_new_session"] = sys.platform != "win32"
        begun.append(subprocess.Popen([*line, "--workers", "2"], **options))
        return begun[-1]

    yield start
    for each in begun:
        # Only where a test has failed.
        if each.poll() is None:
            each.kill()
            each.communicate()


def wait_for_frames(running, out, count):
    end = time.monotonic() + 60
    while len(list(out.glob("frames/[0-9]*"))) < count:
        assert running.poll() is None
        assert time.monotonic() < end
        time.sleep(0.01)


def test_workers_come_to_the_bytes_of_one_process(in_workers, tmp_path):
    fh.dataset(PLANS / "robot.toml", tmp_path / "one")
    out = tmp_path / "two"
    running = in_workers(PLANS / "robot.toml", "-o", out)
    said, err = running.communicate(timeout=120)
    assert (running.returncode, err) == (0, "")
    assert said.startswith(f"{out}: 11 frames made, 0 kept, all 11 there\ndigest ")
    assert tree(tmp_path / "one") == tree(out)


@pytest.mark.parametrize(
    ("options", "workers", "threads"),
    [
        ([], None, None),
        (["--workers", 3], "processes(3)", 2),
        (["--workers", 7], "processes(7)", 1),
        (["--workers", 64], "processes(64)", 1),
        (["--workers", 3, "--threads", 5], "processes(3)", 5),
        (["--threads", 5], None, 5),
    ],
)
def test_workers_share_the_cores(firsthit, monkeypatch, options, workers, threads):
    told = []

    def instead(*_, on, threads, **__):
        told.append((None if on is None else repr(on), threads))
        raise KeyboardInterrupt

    from firsthit._commands import dataset as command

    class Machine:
        all_threads = staticmethod(lambda: 7)

    monkeypatch.setattr(command, "dataset", instead)
    monkeypatch.setattr(command, "_firsthit", Machine)
    assert firsthit("dataset", PLAN, "-o", "x", *options)[0] == 130
    assert told == [(workers, threads)]


@POSIX
def test_workers_have_a_line_of_progress_on_a_terminal(in_workers, tmp_path):
    reader, writer = os.openpty()
    running = in_workers(PLAN, "-o", tmp_path, stderr=writer)
    os.close(writer)
    running.communicate(timeout=120)
    said = os.read(reader, 1 << 16).decode()
    os.close(reader)
    assert running.returncode == 0
    assert "0 of 6 frames, 0 %" in said
    assert "6 of 6 frames, 100 %" in said
    # The line is gone at the end.
    assert said.rsplit("\r", 2)[1].strip() == ""


@POSIX
def test_ctrl_c_with_workers_keeps_frames_and_is_a_line(in_workers, long_plan, tmp_path):
    """The terminal sends it to all processes of the group."""
    out = tmp_path / "out"
    running = in_workers(long_plan, "-o", out)
    wait_for_frames(running, out, 3)
    os.killpg(running.pid, signal.SIGINT)
    said, err = running.communicate(timeout=60)
    assert (running.returncode, said, err) == (130, "", "firsthit: error: interrupted\n")
    assert list(out.glob("frames/.*")) == []
    kept = len(list(out.glob("frames/[0-9]*")))
    assert 3 <= kept < LONG
    assert fh.dataset(long_plan, out).kept == kept


@POSIX
def test_ctrl_c_while_workers_start_is_a_line(in_workers, long_plan, tmp_path):
    for after in (0.0, 0.05, 0.1, 0.2) if FULL else (0.1,):
        out = tmp_path / str(after)
        running = in_workers(long_plan, "-o", out)
        while not (out / "frames").is_dir():
            assert running.poll() is None
            time.sleep(0.001)
        time.sleep(after)
        os.killpg(running.pid, signal.SIGINT)
        _, err = running.communicate(timeout=60)
        assert (running.returncode, err) == (130, "firsthit: error: interrupted\n")


def workers_of(pid):
    """The processes that a driver has started to work."""
    line = ["ps", "-Aww", "-o", "pid=,ppid=,args="]
    listed = subprocess.run(line, capture_output=True, text=True, check=True).stdout
    rows = [row.split(None, 2) for row in listed.splitlines()]
    return [int(row[0]) for row in rows if row[1] == str(pid) and "spawn_main" in row[2]]


@POSIX
@pytest.mark.skipif(shutil.which("ps") is None, reason="ps lists the workers")
def test_a_worker_that_is_killed_is_replaced(in_workers, long_plan, tmp_path):
    out = tmp_path / "out"
    running = in_workers(long_plan, "-o", out)
    wait_for_frames(running, out, 3)
    workers = workers_of(running.pid)
    assert len(workers) == 2
    os.kill(workers[0], signal.SIGKILL)
    said, err = running.communicate(timeout=120)
    assert (running.returncode, err) == (0, "")
    assert f"digest {fh.dataset(long_plan, tmp_path / 'one').digest}\n" in said
    assert tree(tmp_path / "one") == {
        name: content for name, content in tree(out).items() if not name.startswith("frames/.")
    }


def test_what_workers_are_warned_of_is_said_as_ever(tmp_path):
    """A run that goes on leaves reading of scenes to its workers."""
    mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 nan\nf 1 2 3\nf 1 2 4\n"
    (tmp_path / "bad.obj").write_text(mesh)
    path = tmp_path / "plan.toml"
    path.write_text(
        '[[scenes]]\nfile = "bad.obj"\n[[sensors]]\ncolumns = 8\nrows = 6\n'
        '[poses]\nkind = "sphere"\ncount = 6\nradius = 9\n'
    )
    line = [sys.executable, "-m", "firsthit", "dataset", str(path), "-o"]
    told = []
    for out, options in (("one", []), ("two", ["--workers", "2"])):
        for part in ("1/2", "1/1"):
            run = [*line, str(tmp_path / out), "--part", part, *options]
            ended = subprocess.run(run, capture_output=True, text=True, check=True)
            told.append(ended.stderr)
    assert told[0].startswith("firsthit: warning: ")
    assert told[0].count("\n") == 1
    assert set(told) == {told[0]}


def with_lines(**more):
    def change(made):
        made["output"] = {"pictures": ["color"], "jsonl": {}, **more}

    return fh.Plan.from_dict(plan(change), PLANS)


def lines_of(folder):
    return [json.loads(line) for line in (folder / "annotations.jsonl").read_text().splitlines()]


def test_lines_are_the_records_of_all_frames(tmp_path):
    made = fh.Plan.from_dict(plan(lambda made: made["output"].update(jsonl={})), PLANS)
    assert fh.dataset(made, tmp_path, part=(1, 2)).missing
    assert not (tmp_path / "annotations.jsonl").exists()
    fh.dataset(made, tmp_path)
    records = [record(tmp_path, k) for k in range(7)]
    for one in records:
        assert one.pop("files")
        assert one.pop("check")
    assert lines_of(tmp_path) == records
    assert [one["frame"] for one in records] == list(range(7))
    assert {"scene", "pose_index", "time", "world_from_rig"} <= records[0].keys()
    assert records[0]["annotations"]["eye"].keys() == {"classes", "coco", "bop", "yolo"} | {
        "instances"
    }
    assert json.loads((tmp_path / "dataset.json").read_text())["merged"][-1] == "annotations.jsonl"


def test_instances_of_lines_are_those_of_annotate(tmp_path):
    """Lines alone need no classes."""

    def change(made):
        made["output"] = {"pictures": ["color"], "jsonl": {}}
        del made["scenes"][0]["classes"]
        del made["scenes"][0]["keypoints"]

    fh.dataset(fh.Plan.from_dict(plan(change), PLANS), tmp_path)
    scene, count = fh.load(PLANS / "yard.toml"), 0
    for k, line in enumerate(lines_of(tmp_path)):
        camera = fh.Camera.load(tmp_path / "frames" / f"{k:06d}" / "eye.npz")
        instances = fh.annotate(scene, camera).instances
        assert line["annotations"].keys() == {"eye"}
        for said, one in zip(line["annotations"]["eye"]["instances"], instances, strict=True):
            assert said == {
                "id": one.id,
                "class": one.class_name,
                "name": one.name,
                "object": one.object,
                "visible": {"box": as_list(one.visible_box), "pixels": one.visible.pixels},
                "amodal": {"box": as_list(one.amodal_box), "pixels": one.amodal.pixels},
            }
            count += 1
    assert count > 10


def as_list(box):
    return None if box is None else list(box)


def test_lines_are_whole_or_not_there(tmp_path, monkeypatch):
    made = with_lines()
    fh.dataset(made, tmp_path / "whole")
    module, read = fh.datasets._merge, fh.datasets._merge.canonical

    def ending(said):
        if said["frame"] == 4:
            raise KeyboardInterrupt
        return read(said)

    with monkeypatch.context() as patched:
        patched.setattr(module, "canonical", ending)
        with pytest.raises(KeyboardInterrupt):
            fh.dataset(made, tmp_path / "out")
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["frames", "job.json"]
    assert fh.dataset(made, tmp_path / "out").made == 0
    assert tree(tmp_path / "out") == tree(tmp_path / "whole")
    # Removed, they are written again.
    (tmp_path / "out" / "annotations.jsonl").unlink()
    fh.dataset(made, tmp_path / "out")
    assert tree(tmp_path / "out") == tree(tmp_path / "whole")


def test_lines_are_written_a_record_at_a_time(tmp_path, monkeypatch):
    """Between two records that are read, the one before is written."""
    module, order = fh.datasets._merge, []
    write, read = module.canonical, fh._parts.folder.Parts.record

    def writing(said):
        order.append(("write", said["frame"]))
        return write(said)

    def reading(self, number, **how):
        order.append(("read", number))
        return read(self, number, **how)

    monkeypatch.setattr(module, "canonical", writing)
    monkeypatch.setattr(fh._parts.folder.Parts, "record", reading)
    fh.dataset(with_lines(), tmp_path)
    assert order[-14:] == [(what, k) for k in range(7) for what in ("read", "write")]


def test_options_of_lines_and_plans_without_pictures_are_refused():
    with pytest.raises(ValueError, match=r"output\.jsonl: unknown key `x`"):
        with_lines(jsonl={"x": 1})
    with pytest.raises(ValueError, match="`jsonl` does nothing here"):
        fh.Plan.from_dict(
            plan(lambda made: made.update(sensors=made["sensors"][1:], output={"jsonl": {}})), PLANS
        )
