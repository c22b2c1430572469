"""Runs the peers' own tests with firsthit in the place of their classes.

Usage: run.py FOLDER [--trimesh CLONE] [--open3d CLONE]

It runs in an environment that has firsthit and the packages of requirements.txt (`make
test-compat`). trimesh's tests are those of the source distribution of the version that is
installed, which pip downloads into FOLDER. A clone of trimesh's repository has the models beside
them, without which some are skipped. Open3D has no source distribution: its test is run if there is
a clone of its repository.
"""

import argparse
import importlib.metadata
import os
import shutil
import subprocess
import sys
import tarfile
from pathlib import Path

HERE = Path(__file__).parent

#: trimesh's files with tests that ask for rays, contained points or nearest points.
TRIMESH = [
    "test_ray.py",
    "test_ray_upstream.py",
    "test_proximity.py",
    "test_thickness.py",
    "test_sample.py",
]

#: The same for those files that say little without the models.
TRIMESH_WITH_MODELS = [
    *TRIMESH,
    "test_extrude.py",
    "test_interval.py",
    "test_mesh.py",
    "test_primitives.py",
    "test_registration.py",
    "test_remesh.py",
    "test_voxel.py",
]

OPEN3D = Path("python/test/t/geometry/test_raycasting_scene.py")


def main() -> int:
    """Run the tests of both, and return 1 if any fails."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--trimesh", type=Path, help="a clone of trimesh's repository")
    parser.add_argument("--open3d", type=Path, help="a clone of Open3D's repository")
    options = parser.parse_args()
    shutil.rmtree(options.folder, ignore_errors=True)
    tests = trimesh_tests(options.folder, options.trimesh)
    files = TRIMESH_WITH_MODELS if options.trimesh else TRIMESH
    passed = run("trimesh", tests, files)
    if options.open3d:
        source = options.open3d / OPEN3D
        passed &= run("open3d", source.parent, [source.name])
    else:
        print("Open3D's own test: skipped: `make test-compat OPEN3D=` a clone of its repository")
    return 0 if passed else 1


def trimesh_tests(folder: Path, clone: Path | None) -> Path:
    """Return the folder with trimesh's tests, and the module and the models that they need."""
    version = importlib.metadata.version("trimesh")
    download = [sys.executable, "-m", "pip", "download", "--quiet", "--no-binary", ":all:"]
    command = [*download, "--no-deps", "--dest", str(folder), f"trimesh=={version}"]
    subprocess.run(command, check=True)
    (packed,) = folder.glob("trimesh-*.tar.gz")
    with tarfile.open(packed) as archive:
        archive.extractall(folder, filter="data")
    # Away from the package beside them, lest that be tested in place of the one installed.
    tests = folder / "trimesh" / "tests"
    tests.parent.mkdir()
    (folder / f"trimesh-{version}" / "tests").rename(tests)
    if clone is None:
        # The tests then import the stand-in beside this file.
        return tests
    for name in ("generic.py", "__init__.py", "data"):
        source = clone / "tests" / name
        if source.is_dir():
            shutil.copytree(source, tests / name)
        elif source.exists():
            shutil.copy(source, tests)
    shutil.copytree(clone / "models", tests.parent / "models")
    return tests


def run(peer: str, folder: Path, files: list[str]) -> bool:
    """Run some files' tests with ours in the place of a peer's classes."""
    print(f"== {peer}'s own tests, with firsthit's classes", flush=True)
    # No settings of ours, nor of theirs.
    options = ["-q", "-rs", "-p", "swap", "-p", "no:cacheprovider", "-c", os.devnull]
    command = [sys.executable, "-m", "pytest", *options, "--rootdir", ".", *files]
    environment = {**os.environ, "PYTHONPATH": str(HERE.resolve()), "FIRSTHIT_SWAP": peer}
    return subprocess.run(command, cwd=folder, env=environment, check=False).returncode == 0


if __name__ == "__main__":
    sys.exit(main())
