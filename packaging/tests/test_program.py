"""The program that pip installs starts, stops and fails as the one that cargo installs."""

import functools
import os
import re
import signal
import subprocess
import sys
import sysconfig
import time
from pathlib import Path

import pytest
from conftest import PROGRAM, ROOT, run

needs_linux = pytest.mark.skipif(
    sys.platform != "linux", reason="reads /proc or limits memory as Linux does"
)
needs_unix = pytest.mark.skipif(os.name != "posix", reason="sends signals")

#: What takes a moment.
SMALL = ["demo", "--size", "64x40", "--samples", "1", "--output", "small.png"]
INTERRUPTED = "firsthit: error: interrupted\n"
#: The render takes hours. The promise is half a second, but a busy machine may be late.
SECONDS = 60


def test_the_package_is_the_installed_one():
    told = run(sys.executable, "-c", "import firsthit; print(firsthit.__file__)")
    assert Path(told.stdout.strip()).is_relative_to(sysconfig.get_path("platlib"))
    assert ROOT / "python" not in Path(told.stdout).parents


def test_the_program_starts_without_numpy_and_the_package():
    told = run(sys.executable, "-X", "importtime", PROGRAM, "--version")
    modules = {line.rpartition("|")[2].strip() for line in told.stderr.splitlines()}
    assert told.stdout.startswith("firsthit ")
    assert "_firsthit_program" in modules
    heavy = {"numpy", "firsthit", "typing", "enum", "pathlib", "subprocess"}
    bare = run(sys.executable, "-X", "importtime", "-c", "import re").stderr
    assert {name for name in modules & heavy if f" {name}\n" not in bare} == set()


@needs_linux
@pytest.mark.parametrize("kilobytes", [65536, 131072])
def test_little_memory_is_enough(kilobytes, tmp_path):
    limited = f'ulimit -v {kilobytes}; exec "$@"'
    told = run("sh", "-c", limited, "sh", PROGRAM, *SMALL, cwd=tmp_path)
    assert (told.returncode, len(told.stderr.splitlines())) == (0, 1), told.stderr
    assert (tmp_path / "small.png").read_bytes().startswith(b"\x89PNG")


def started(command, folder):
    """Return the process once its thread `ctrl-c` is there: the program is at work."""
    words = [str(word) for word in command]
    child = subprocess.Popen(
        words, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    deadline = time.monotonic() + 20
    while all(
        name.read_text() != "ctrl-c\n" for name in Path(f"/proc/{child.pid}/task").glob("*/comm")
    ):
        assert child.poll() is None, child.communicate()
        assert time.monotonic() < deadline, "nothing waits for Ctrl-C"
        time.sleep(0.002)
    return child


def interrupted(child, times):
    """Press Ctrl-C so many times; return the exit code and what was printed."""
    for _ in range(times):
        child.send_signal(signal.SIGINT)
        time.sleep(0.05)
    out, err = child.communicate(timeout=SECONDS)
    return child.returncode, out, err


@needs_linux
@pytest.mark.parametrize("times", [1, 2])
@pytest.mark.parametrize("after", [0.0, 0.3, 1.5])
def test_ctrl_c_ends_a_render_and_leaves_the_old_picture(start, hills, times, after, tmp_path):
    (tmp_path / "big.png").write_text("old")
    arguments = ["render", hills, "--size", "2000x1500", "--samples", "65536", "-o", "big.png"]
    child = started([*start, *arguments], tmp_path)
    time.sleep(after)
    code, out, err = interrupted(child, times)
    assert (code, out) == (130, "")
    # The second one ends the program at once, perhaps before the line is out.
    assert err in ([INTERRUPTED] if times == 1 else [INTERRUPTED, ""])
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"big.png": "old"}


@needs_linux
def test_an_ignored_ctrl_c_stays_ignored(tmp_path):
    arguments = ["demo", "--size", "320x200", "--samples", "16", "--output", "picture.png"]
    ignore = functools.partial(signal.signal, signal.SIGINT, signal.SIG_IGN)
    words = [str(PROGRAM), *arguments]
    child = subprocess.Popen(words, cwd=tmp_path, stderr=subprocess.DEVNULL, preexec_fn=ignore)
    while child.poll() is None:
        child.send_signal(signal.SIGINT)
        time.sleep(0.02)
    assert child.returncode == 0
    assert (tmp_path / "picture.png").is_file()


def with_instruction_set(name):
    return {**os.environ, "FIRSTHIT_ISA": name}


def test_a_wrong_instruction_set_is_one_line_that_names_those_of_this_machine(start, tmp_path):
    def tried(name):
        return run(*start, *SMALL, cwd=tmp_path, env=with_instruction_set(name))

    known = ["portable", "neon", "avx2", "avx512"]
    here = [name for name in known if tried(name).returncode == 0]
    assert "portable" in here
    assert tried("").returncode == 0
    for name in [*(set(known) - set(here)), "sse"]:
        told = tried(name)
        assert (told.returncode, told.stdout, told.stderr.count("\n")) == (2, "", 1), told.stderr
        offered, got = told.stderr.split("got")
        assert "FIRSTHIT_ISA" in offered
        assert got.strip().strip("\"'") == name
        assert [word for word in known if re.search(rf"\b{word}\b", offered)] == here


@needs_linux
def test_only_instruction_sets_of_this_machine_are_offered(tmp_path):
    machine = Path("/proc/cpuinfo").read_text()
    flags = re.search(r"^(?:flags|Features)\s*:(.*)$", machine, re.MULTILINE)
    flags = set(flags[1].split()) if flags else set()
    told = run(PROGRAM, *SMALL, cwd=tmp_path, env=with_instruction_set("none"))
    for name, flag in {"neon": "asimd", "avx2": "avx2", "avx512": "avx512f"}.items():
        assert flag in flags or name not in told.stderr


def test_a_wrong_instruction_set_lets_the_package_be_imported():
    script = """
import firsthit as fh
scene = fh.Scene()
scene.add(fh.Sphere((0, 0, 0), 1))
try:
    scene.shoot((0, 0, 5), (0, 0, -1))
except ValueError as error:
    print(error)
"""
    told = run(sys.executable, "-c", script, env=with_instruction_set("sse"))
    assert (told.returncode, told.stderr) == (0, "")
    assert "sse" in told.stdout
    assert run(PROGRAM, "--version", env=with_instruction_set("sse")).returncode == 0


#: Commands, each with its exit code.
COMMANDS = {
    "--version": 0,
    "--help": 0,
    "render --help": 0,
    "schema": 0,
    "completions bash": 0,
    "info hills.obj": 0,
    "info hills.obj --json": 0,
    "diff a.npz a.npz": 0,
    "diff a.npz b.npz": 1,
    "section hills.obj --quiet": 0,
    "lint hills.obj": 1,
    "": 2,
    "--nonsense": 2,
    "render hills.obj --size 0x0": 2,
    "render none.ply": 3,
    "info broken.ply": 3,
    "demo --size 8x5 --samples 1 -o no/such/folder.png": 4,
    "render hills.obj --max-memory 1K": 5,
    "shoot hills.obj rays.csv": 0,
}


def told_by(program, command, folder):
    """Return the exit code and what was said, without the time that it took."""
    told = run(program, *command.split(), cwd=folder)
    return told.returncode, told.stdout, re.sub(r"\d+\.\d+ s$", "", told.stderr, flags=re.M)


@pytest.fixture
def lab(native, hills, tmp_path):
    (tmp_path / "hills.obj").write_bytes(hills.read_bytes())
    (tmp_path / "broken.ply").write_text("ply\nformat")
    (tmp_path / "rays.csv").write_text("0,0,9,0,0,-1\n9,9,9,0,0,-1\n")
    for name, x in {"a": "0", "b": "0.5"}.items():
        picture = [
            "render",
            "hills.obj",
            "--size",
            "8x5",
            "--look-at",
            "0,0,0",
            "--position",
            f"{x},1,3",
        ]
        assert run(native, *picture, "-o", f"{name}.npz", cwd=tmp_path).returncode == 0
    return tmp_path


@pytest.mark.parametrize("command", COMMANDS)
def test_exit_codes_and_words_are_the_native_programs(command, native, lab):
    code, out, err = told_by(PROGRAM, command, lab)
    assert code == COMMANDS[command], (out, err)
    assert (code, out, err) == told_by(native, command, lab)
    assert "Traceback" not in err


@needs_unix
@pytest.mark.parametrize(
    "command", ["schema", "--help", "shoot hills.obj rays.csv", "completions bash"]
)
def test_a_broken_pipe_is_silent(command, native, lab):
    def ended(program):
        reading, writing = os.pipe()
        os.close(reading)
        words = [str(program), *command.split()]
        done = subprocess.run(words, cwd=lab, stdout=writing, stderr=subprocess.PIPE, check=False)
        os.close(writing)
        return done.returncode, done.stderr

    assert ended(PROGRAM) == ended(native)
    assert ended(PROGRAM)[1] == b""
