"""What people build from source: the source distribution, a new Cargo project, `cargo install`."""

import importlib
import os
import re
import shutil
import subprocess
import sys

import pytest
from conftest import IS_RELEASE, LEAN, OUTSIDE, ROOT, build, compile_crates, run

SMOKE = """
import firsthit as fh
scene = fh.load("hills.obj")
t, o = scene.shoot([[0, 0, 9], [5, 0, 9]], [0, 0, -1])
assert abs(t[0] - 9) < 0.2 and o[0] == 0 and o[1] == -1, (t, o)
"""


#: The sources that are compiled or packed.
COMPILED = re.compile(
    r"(crates|python)/.*\.(rs|toml|pyi?|js|mjs|html|css)|Cargo\.(toml|lock)|pyproject\.toml"
)


def test_the_source_distribution_has_the_clones_sources(sources):
    listed = run("git", "ls-files", cwd=ROOT).stdout.splitlines()
    names = [name for name in listed if COMPILED.fullmatch(name)]
    assert len(names) > 900
    for name in names:
        assert (sources / name).read_bytes() == (ROOT / name).read_bytes(), name


def test_the_source_distribution_can_be_installed(sources, hills, tmp_path):
    # Cargo takes what it has compiled of the same sources, which the test above compares.
    target = OUTSIDE / "sources" if IS_RELEASE else ROOT / "target"
    subprocess.run([sys.executable, "-m", "venv", tmp_path / "venv"], check=True)
    scripts = tmp_path / "venv" / ("Scripts" if os.name == "nt" else "bin")
    build(scripts / "pip", "install", "--quiet", sources, CARGO_TARGET_DIR=str(target))
    shutil.copy(hills, tmp_path)
    told = run(scripts / "python", "-c", SMOKE, cwd=tmp_path)
    assert told.returncode == 0, told.stderr
    told = run(scripts / "firsthit", "render", "hills.obj", "--size", "64x40", cwd=tmp_path)
    assert told.returncode == 0, told.stderr
    assert (tmp_path / "hills.png").read_bytes().startswith(b"\x89PNG")


# Without optimisation, stack frames are largest. A newcomer's first build is such a one.
@pytest.mark.parametrize("profile", ["debug", "release"] if IS_RELEASE else ["debug"])
def test_a_new_project_shoots_at_meshes_from_any_thread(profile, crates):
    folder = compile_crates(crates, "newcomer", release=profile == "release")
    env = {name: value for name, value in os.environ.items() if name != "RUST_MIN_STACK"}
    told = run(folder / "newcomer", env=env)
    assert told.returncode == 0, told.stdout + told.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="the lines are for a Unix shell")
def test_the_page_for_rust_makes_a_program_and_its_picture(crates, monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "python" / "tests")
    pages = importlib.import_module("pages")
    page = pages.DOCS / "start" / "rust.md"
    for name, value in LEAN.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setenv("CARGO_TARGET_DIR", str(OUTSIDE / "crates"))
    run_by = "cargo run --release"
    assert run_by in page.read_text()
    # Unless this is a release, as `compile_crates` compiles: then it is compiled already.
    plain = f"cargo build -p picker -p firsthit-cli\n{OUTSIDE}/crates/debug/picker"
    edit = {} if IS_RELEASE else {"edit": lambda text: text.replace(run_by, plain)}
    pages.run(page, crates, set_up=True, **edit)
    (shown,) = pages.pictures(page)
    assert pages.same(crates / "picker" / "rust-first.png", page.parent / shown)


def test_cargo_install_makes_the_program(native, tmp_path):
    told = run(native, "demo", "--size", "64x40", "--samples", "1", cwd=tmp_path)
    assert told.returncode == 0, told.stderr
    assert (tmp_path / "demo.png").read_bytes().startswith(b"\x89PNG")
