"""Jobs on Dask have the same bytes, and go on after kills."""

import os
import signal

import cluster_support
import dask
import pytest
from cluster_support import JOBS, PARTS, Marked, calls, killed, marked, tree
from distributed import Client, LocalCluster


@pytest.fixture(scope="module", params=[0, 3], ids=["ours", "dask's"])
def client(request, _workers_import_the_tests):
    """Clusters where a lost task is tried again by us, and by Dask, as it is by default."""
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": request.param}),
        LocalCluster(
            n_workers=2,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",
        ) as cluster,
        Client(cluster) as client,
    ):
        yield client


@pytest.mark.parametrize("name", JOBS)
def test_a_job_has_the_same_bytes(name, client, plain, tmp_path):
    made = JOBS[name](tmp_path, on=client.get_executor())
    assert (made.digest, tree(tmp_path)) == plain[name]
    assert made.kept == 0


def kill(pid):
    os.kill(pid, signal.SIGKILL)
    cluster_support.wait_for_the_end_of(pid)


def test_a_job_goes_on_after_the_kill_of_a_worker(client, plain, tmp_path):
    killed(tmp_path, client.get_executor(), kill, plain["marked"])


def test_a_part_that_kills_its_worker_twice_is_made(client, tmp_path):
    """Dask remembers what became of a call: a second try must be another one to it."""
    (tmp_path / "marks").mkdir()
    fold = Marked(str(tmp_path / "marks"), deaths=2)
    made = marked(tmp_path / "job", fold, on=client.get_executor(), part=(1, PARTS))
    assert (made.made, made.missing) == (1, PARTS - 1)
    assert len(calls(tmp_path / "marks")[0]) == 3
