"""What users install, for the tests: the wheel, and the program of `cargo install`.

`make test-installed` builds `dist/`, installs its wheel into an environment that has nothing else
but pytest, and runs these tests there. Nothing here may reach into the clone for the program or the
package.
"""

import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
DIST = ROOT / "dist"
#: The program as pip made it.
PROGRAM = Path(sysconfig.get_path("scripts")) / "firsthit"
#: Where everything is compiled that is not of this workspace: dependencies are compiled once.
OUTSIDE = ROOT / "target" / "outside"
TESTS = Path(__file__).parent
#: Debug information as in the workspace: else every dependency would be compiled once more.
COMPILED_ALIKE = {"CARGO_PROFILE_RELEASE_DEBUG": "line-tables-only"}


def run(*command: object, **options: object) -> subprocess.CompletedProcess[str]:
    """Run a command and return what it said; options are those of `subprocess.run`."""
    words = [str(word) for word in command]
    return subprocess.run(words, capture_output=True, text=True, check=False, **options)


def build(*command: object, **variables: str) -> None:
    """Run a command that compiles: outside the workspace, with its output shown when it fails."""
    env = {**os.environ, **COMPILED_ALIKE, **variables}
    done = run(*command, env=env, cwd=ROOT)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.fixture(scope="session")
def hills(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write a mesh of 80,000 triangles in a file."""
    side = 200
    x, y = np.meshgrid(*2 * [np.linspace(-1, 1, side + 1)], indexing="ij")
    points = np.stack([x, y, 0.1 * np.sin(9 * x) * np.cos(7 * y)], -1).reshape(-1, 3)
    corner = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    across = corner + side + 2
    triangles = [(corner, across - 1, across), (corner, across, corner + 1)]
    lines = [f"v {a:.9g} {b:.9g} {c:.9g}" for a, b, c in points]
    lines += [
        f"f {a} {b} {c}" for abc in triangles for a, b, c in zip(*(1 + k for k in abc), strict=True)
    ]
    path = tmp_path_factory.mktemp("models") / "hills.obj"
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.fixture(scope="session")
def sources(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Unpack the source distribution, for pip and for Cargo."""
    # Cargo knows sources by their place and by their time, and an archive's are always old: it
    # would take what it made of an earlier archive.
    ours = [f"--package=firsthit{name}" for name in ("", "-view", "-cli", "-python")]
    build("cargo", "clean", "--quiet", "--release", *ours, "--target-dir", OUTSIDE)
    (archive,) = DIST.glob("*.tar.gz")
    folder = tmp_path_factory.mktemp("sources")
    shutil.unpack_archive(archive, folder, "gztar")
    (unpacked,) = folder.iterdir()
    return unpacked


@pytest.fixture(scope="session")
def native(sources: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Make the program with `cargo install`, as README.md says."""
    root = tmp_path_factory.mktemp("cargo")
    program = sources / "crates" / "firsthit-cli"
    where = ["--root", root, "--target-dir", OUTSIDE]
    build("cargo", "install", "--quiet", "--locked", "--path", program, *where)
    return root / "bin" / "firsthit"


#: The ways to start the program that pip installs.
STARTS = {"script": [PROGRAM], "module": [sys.executable, "-m", "firsthit"]}


@pytest.fixture(params=STARTS.values(), ids=STARTS.keys())
def start(request: pytest.FixtureRequest) -> list[object]:
    """One of the ways to start the installed program."""
    return request.param
