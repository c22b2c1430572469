"""These tests start clusters, so they run where there is no network but the machine's own loop.

Ray listens on the machine's address, whatever it is told. So pytest starts itself again in a
network namespace that has nothing but ``lo``. No process outlives it there, either.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import cluster_support
import pytest

#: Set where the tests run by themselves.
ALONE = "FIRSTHIT_TESTS_ALONE"

#: The shell stays, to be the parent of processes whose own has ended.
NAMESPACE = [
    *("unshare", "--user", "--map-root-user", "--net", "--pid", "--fork", "--kill-child"),
    *("--mount-proc", "sh", "-c", 'ip link set lo up && "$@"; exit $?', "sh"),
]


def pytest_configure(config):
    """The warnings of Ray and of Dask are their own."""
    config.addinivalue_line("filterwarnings", "default")


@pytest.hookimpl(tryfirst=True)
def pytest_cmdline_main(config):
    """Run pytest again in the namespace, and return what it returned."""
    if ALONE in os.environ or shutil.which("unshare") is None or shutil.which("ip") is None:
        return None
    if subprocess.run([*NAMESPACE, "true"], capture_output=True, check=False).returncode != 0:
        return None
    given = config.invocation_params
    command = [*NAMESPACE, sys.executable, "-m", "pytest", *given.args]
    env = {**os.environ, ALONE: "1"}
    return subprocess.run(command, cwd=given.dir, env=env, check=False).returncode


@pytest.fixture(scope="session", autouse=True)
def _workers_import_the_tests():
    """Workers inherit the environment."""
    here = Path(__file__).parent
    path = [str(here), str(here.parent / "tests"), os.environ.get("PYTHONPATH", "")]
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", os.pathsep.join(filter(None, path)))
        yield


@pytest.fixture(scope="session")
def ray_home():
    """Keep Ray's files apart from other runs', and have it tell nobody that it runs."""
    if ALONE not in os.environ:
        pytest.skip("no network namespace can be made, and Ray would listen to the network")
    # Its sockets have paths of at most 107 bytes.
    with (
        tempfile.TemporaryDirectory(prefix="fh", ignore_cleanup_errors=True) as home,
        pytest.MonkeyPatch.context() as patch,
    ):
        patch.setenv("RAY_TMPDIR", home)
        patch.setenv("RAY_USAGE_STATS_ENABLED", "0")
        patch.setenv("RAY_enable_metrics_collection", "0")
        yield home


@pytest.fixture(scope="session")
def plain(tmp_path_factory):
    """What the jobs come to in this process alone: digests and files, by name."""
    made = {}
    for name, job in cluster_support.JOBS.items():
        out = tmp_path_factory.mktemp(name)
        made[name] = job(out).digest, cluster_support.tree(out)
    return made
