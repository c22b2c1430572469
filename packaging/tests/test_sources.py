"""What people build from source: the source distribution, a new Cargo project, `cargo install`."""

import importlib
import os
import shutil
import subprocess
import sys

import pytest
from conftest import COMPILED_ALIKE, DIST, OUTSIDE, ROOT, TESTS, build, run

SMOKE = """
import firsthit as fh
scene = fh.load("hills.obj")
t, o = scene.shoot([[0, 0, 9], [5, 0, 9]], [0, 0, -1])
assert abs(t[0] - 9) < 0.2 and o[0] == 0 and o[1] == -1, (t, o)
"""


def test_the_source_distribution_can_be_installed(sources, hills, tmp_path):
    subprocess.run([sys.executable, "-m", "venv", tmp_path / "venv"], check=True)
    scripts = tmp_path / "venv" / ("Scripts" if os.name == "nt" else "bin")
    build(scripts / "pip", "install", "--quiet", sources, CARGO_TARGET_DIR=str(OUTSIDE))
    shutil.copy(hills, tmp_path)
    told = run(scripts / "python", "-c", SMOKE, cwd=tmp_path)
    assert told.returncode == 0, told.stderr
    told = run(scripts / "firsthit", "render", "hills.obj", "--size", "64x40", cwd=tmp_path)
    assert told.returncode == 0, told.stderr
    assert (tmp_path / "hills.png").read_bytes().startswith(b"\x89PNG")


@pytest.fixture(scope="module")
def crate(tmp_path_factory):
    """Unpack the crate as it would be published, not the workspace's folder."""
    folder = tmp_path_factory.mktemp("rust")
    (archive,) = DIST.glob("firsthit-[0-9]*.crate")
    shutil.unpack_archive(archive, folder, "gztar")
    path = folder / "firsthit" / "crates" / "firsthit"
    path.parent.mkdir(parents=True)
    (folder / archive.stem).rename(path)
    (folder / "firsthit" / "testdata").symlink_to(ROOT / "testdata")
    return path


@pytest.mark.parametrize("profile", ["debug", "release"])
def test_a_new_project_shoots_at_meshes_from_any_thread(profile, crate, tmp_path):
    (tmp_path / "src").mkdir()
    shutil.copy(TESTS / "newcomer.rs", tmp_path / "src" / "main.rs")
    # The versions that everything else is tested with.
    shutil.copy(ROOT / "Cargo.lock", tmp_path)
    (tmp_path / "Cargo.toml").write_text(
        '[package]\nname = "newcomer"\nversion = "0.1.0"\nedition = "2024"\n\n'
        f'[dependencies]\nfirsthit = {{ path = "{crate}" }}\n\n[workspace]\n'
    )
    release = ["--release"] if profile == "release" else []
    manifest = tmp_path / "Cargo.toml"
    build(
        "cargo", "build", "--quiet", *release, "--manifest-path", manifest, "--target-dir", OUTSIDE
    )
    env = {name: value for name, value in os.environ.items() if name != "RUST_MIN_STACK"}
    told = run(OUTSIDE / profile / "newcomer", env=env)
    assert told.returncode == 0, told.stdout + told.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="the lines are for a Unix shell")
def test_the_page_for_rust_makes_a_program_and_its_picture(crate, monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "python" / "tests")
    pages = importlib.import_module("pages")
    folder, page = crate.parents[2], pages.DOCS / "start" / "rust.md"
    for name, value in COMPILED_ALIKE.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setenv("CARGO_TARGET_DIR", str(OUTSIDE))
    pages.run(page, folder, set_up=True)
    (shown,) = pages.pictures(page)
    assert pages.same(folder / "picker" / "rust-first.png", page.parent / shown)


def test_cargo_install_makes_the_program(native, tmp_path):
    told = run(native, "demo", "--size", "64x40", "--samples", "1", cwd=tmp_path)
    assert told.returncode == 0, told.stderr
    assert (tmp_path / "demo.png").read_bytes().startswith(b"\x89PNG")
