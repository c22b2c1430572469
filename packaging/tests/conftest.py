"""What users install, for the tests: the wheel, and the program of `cargo install`.

`make test-installed` builds `dist/`, installs its wheel into an environment that has nothing else
but pytest, and runs these tests there. Nothing here may reach into the clone for the program or the
package.

Compiling takes longest, so `make test-installed` compiles nothing twice. pip finds the source
distribution compiled, because the clone has the same sources. The crates are one workspace, without
optimisation. `make test-release` compiles each anew, as its user would.
"""

import os
import re
import shutil
import signal
import subprocess
import sys
import sysconfig
from pathlib import Path

import numpy as np
import pytest

# As in python/conftest.py.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

ROOT = Path(__file__).parents[2]
DIST = ROOT / "dist"
#: The program as pip made it.
PROGRAM = Path(sysconfig.get_path("scripts")) / "firsthit"
#: Where everything is compiled that is not of this workspace.
OUTSIDE = ROOT / "target" / "outside"
TESTS = Path(__file__).parent
#: Whether these are the packages of a release, and all is compiled as its user would.
IS_RELEASE = os.environ.get("WHEEL_PROFILE") == "dist"
#: Debug information takes time and space, and no test looks at it.
LEAN = {"CARGO_PROFILE_DEV_DEBUG": "false", "CARGO_PROFILE_RELEASE_DEBUG": "false"}


def run(*command: object, **options: object) -> subprocess.CompletedProcess[str]:
    """Run a command and return what it said; options are those of `subprocess.run`."""
    words = [str(word) for word in command]
    return subprocess.run(words, capture_output=True, text=True, check=False, **options)


def build(*command: object, **variables: str) -> None:
    """Run a command that compiles, with its output shown when it fails."""
    done = run(*command, env={**os.environ, **variables}, cwd=ROOT)
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
    """Unpack the source distribution."""
    if IS_RELEASE:
        # See `crates`.
        for name in ("sources", "install"):
            shutil.rmtree(OUTSIDE / name, ignore_errors=True)
    (archive,) = DIST.glob("*.tar.gz")
    folder = tmp_path_factory.mktemp("sources")
    shutil.unpack_archive(archive, folder, "gztar")
    (unpacked,) = folder.iterdir()
    return unpacked


@pytest.fixture(scope="session")
def crates(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Unpack the crates as an index would hand them out, and return the workspace of a newcomer.

    The crates find each other there, and the newcomer's program is `newcomer`.
    """
    # Cargo knows sources by their place and by their time, and an archive's are always old: it
    # would take what it made of an earlier archive.
    shutil.rmtree(OUTSIDE / "crates", ignore_errors=True)
    folder = tmp_path_factory.mktemp("rust")
    patches = []
    for archive in sorted(DIST.glob("*.crate")):
        shutil.unpack_archive(archive, folder, "gztar")
        name = re.sub(r"-[0-9.]+$", "", archive.stem)
        path = folder / "firsthit" / "crates" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        (folder / archive.stem).rename(path)
        patches.append(f'{name} = {{ path = "firsthit/crates/{name}" }}\n')
    assert len(patches) == 15
    (folder / "firsthit" / "testdata").symlink_to(ROOT / "testdata")
    # The versions that everything else is tested with.
    shutil.copy(ROOT / "Cargo.lock", folder)
    (folder / "Cargo.toml").write_text(
        '[workspace]\nresolver = "3"\nmembers = ["firsthit/crates/*", "newcomer"]\n\n'
        f"[patch.crates-io]\n{''.join(patches)}"
    )
    (folder / "newcomer" / "src").mkdir(parents=True)
    shutil.copy(TESTS / "newcomer.rs", folder / "newcomer" / "src" / "main.rs")
    (folder / "newcomer" / "Cargo.toml").write_text(
        '[package]\nname = "newcomer"\nversion = "0.1.0"\nedition = "2024"\n\n'
        '[dependencies]\nfirsthit = "*"\n'
    )
    return folder


def compile_crates(crates: Path, *programs: str, release: bool = False) -> Path:
    """Compile programs of the newcomer's workspace, and return the folder that they are in.

    Unless this is a release, the program of firsthit comes with them: alone they would have other
    features of some dependency, and all would be compiled once more.
    """
    together = programs if IS_RELEASE else (*programs, "firsthit-cli")
    packages = [f"--package={name}" for name in together]
    where = ["--manifest-path", crates / "Cargo.toml", "--target-dir", OUTSIDE / "crates"]
    profile = ["--release"] if release else []
    build("cargo", "build", "--quiet", *profile, *packages, *where, **LEAN)
    return OUTSIDE / "crates" / ("release" if release else "debug")


@pytest.fixture(scope="session")
def native(crates: Path, sources: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Make the program with `cargo install`, without optimisation unless this is a release."""
    root = tmp_path_factory.mktemp("cargo")
    folder = sources if IS_RELEASE else crates / "firsthit"
    where = ["--root", root, "--target-dir", OUTSIDE / ("install" if IS_RELEASE else "crates")]
    profile = [] if IS_RELEASE else ["--debug"]
    program = folder / "crates" / "firsthit-cli"
    build("cargo", "install", "--quiet", "--locked", *profile, "--path", program, *where, **LEAN)
    return root / "bin" / "firsthit"


#: The ways to start the program that pip installs.
STARTS = {"script": [PROGRAM], "module": [sys.executable, "-m", "firsthit"]}


@pytest.fixture(params=STARTS.values(), ids=STARTS.keys())
def start(request: pytest.FixtureRequest) -> list[object]:
    """One of the ways to start the installed program."""
    return request.param
