"""Jobs on Ray have the same bytes, and go on after kills of workers and of nodes."""

import contextlib
import os
import signal

import cluster_support
import firsthit as fh
import firsthit.ray
import numpy as np
import psutil
import pytest
import ray
from cluster_support import JOBS, PARTS, Marked, calls, killed, marked, rays, scene, tree
from ray.cluster_utils import Cluster

NODE = {"num_cpus": 1, "node_ip_address": "127.0.0.1", "include_dashboard": False}

#: Ray fills a node before it takes the next one otherwise.
SPREAD = {"scheduling_strategy": "SPREAD"}


@pytest.fixture(scope="module")
def one_node(_workers_import_the_tests, ray_home):
    """A cluster of one node of two CPUs."""
    cluster = Cluster(initialize_head=True, head_node_args={**NODE, "num_cpus": 2})
    ray.init(cluster.address, log_to_driver=False, logging_level="error")
    yield cluster
    ray.shutdown()
    cluster.shutdown()


@pytest.fixture(scope="module")
def three_nodes(one_node):
    """The same cluster, to which two nodes of one CPU have come."""
    while len(one_node.worker_nodes) < 2:
        one_node.add_node(**NODE)
    one_node.wait_for_nodes()
    return one_node


def processes_of(node):
    """The processes of a node: its raylet first, and its workers."""
    (raylet,) = node.all_processes["raylet"]
    parent = psutil.Process(raylet.process.pid)
    return [parent, *parent.children(recursive=True)]


def kill(pid):
    os.kill(pid, signal.SIGKILL)
    cluster_support.wait_for_the_end_of(pid)


def test_an_executor_starts_no_cluster():
    before = psutil.Process().children()
    with pytest.raises(RuntimeError, match=r"call ray\.init before"):
        fh.ray.executor()
    assert not ray.is_initialized()
    assert psutil.Process().children() == before


@pytest.mark.parametrize(
    ("given", "what"),
    [
        ({"cpus": 0}, "cpus must be positive"),
        ({"options": {"max_retries": 3}}, "options must be without max_retries"),
    ],
)
def test_what_is_no_request_is_refused(given, what):
    with pytest.raises(ValueError, match=what):
        fh.ray.executor(**given)


@pytest.mark.parametrize("name", JOBS)
def test_a_job_on_one_node_has_the_same_bytes(name, one_node, plain, tmp_path):
    made = JOBS[name](tmp_path, on=fh.ray.executor(1))
    assert (made.digest, tree(tmp_path)) == plain[name]
    assert made.kept == 0


def test_a_job_goes_on_after_the_kill_of_a_worker(one_node, plain, tmp_path):
    killed(tmp_path, fh.ray.executor(1), kill, plain["marked"])


def test_a_part_that_kills_its_worker_is_tried_three_times(one_node, tmp_path):
    """Ray's own tries are none: there would be four of each of ours."""
    (tmp_path / "marks").mkdir()
    fold = Marked(str(tmp_path / "marks"), deaths=99)
    with pytest.raises(RuntimeError, match="part 0 was lost 3 times with its worker"):
        marked(tmp_path / "job", fold, on=fh.ray.executor(2), part=(1, PARTS))
    assert {part: len(pids) for part, pids in calls(tmp_path / "marks").items()} == {0: 3}


def test_an_error_of_the_work_ends_what_waits(one_node, tmp_path):
    """No task of the window begins once nobody waits for it."""
    (tmp_path / "marks").mkdir()
    fold = Marked(str(tmp_path / "marks"), seconds=0.3)

    def stop(done, total):
        if done == 1:
            raise KeyError(done)

    on = fh.ray.executor(2)
    with pytest.raises(KeyError):
        marked(tmp_path / "job", fold, on=on, progress=stop)
    # A task that is given now comes after all that went before.
    assert on.submit(os.getpid).result(timeout=60) != os.getpid()
    assert len(calls(tmp_path / "marks")) <= 2


def test_tasks_have_a_node_of_their_own(three_nodes):
    with fh.ray.executor() as on:
        assert (on._cpus, on._max_workers) == (1, 4)
    with fh.ray.executor(2) as on:
        assert on._max_workers == 1
        assert on.submit(divmod, 7, 2).result() == (3, 1)
        assert isinstance(on.submit(divmod, 7, 0).exception(), ZeroDivisionError)
    with pytest.raises(RuntimeError, match="after shutdown"):
        on.submit(divmod, 7, 2)
    assert ray.is_initialized()


@pytest.mark.parametrize("name", JOBS)
def test_a_job_on_three_nodes_has_the_same_bytes(name, three_nodes, plain, tmp_path):
    made = JOBS[name](tmp_path, on=lambda: fh.ray.executor(options=SPREAD))
    assert (made.digest, tree(tmp_path)) == plain[name]
    assert made.kept == 0


def test_hits_of_a_dataset_are_those_of_shoot(three_nodes, tmp_path):
    origins, directions = rays(3_000)
    columns = dict(
        zip(("ox", "oy", "oz", "dx", "dy", "dz"), (*origins.T, *directions.T), strict=True)
    )
    t_max = np.linspace(4.0, 8.0, 3_000)
    scene().save(tmp_path / "scene.fhs")
    given = {"ray": np.arange(3_000), **columns, "t_max": t_max}
    dataset = ray.data.from_numpy(np.arange(3_000)).map_batches(
        lambda batch: {name: column[batch["data"]] for name, column in given.items()}
    )
    found = dataset.repartition(4).map_batches(
        fh.ray.Shooter,
        fn_constructor_args=[tmp_path / "scene.fhs"],
        fn_constructor_kwargs={"channels": ["t", "object", "normal"], "threads": 1},
        batch_size=500,
        num_cpus=1,
        compute=ray.data.ActorPoolStrategy(size=2),
    )
    table = found.to_pandas().sort_values("ray")
    expected = scene().shoot(origins, directions, t_max=t_max)
    assert (expected.object >= 0).sum() > 100
    for name, column in {**given, **expected.to_dict(["t", "object", "normal"])}.items():
        np.testing.assert_array_equal(table[name].to_numpy(), column)


def test_columns_that_are_no_rays_are_refused(tmp_path):
    scene().save(tmp_path / "scene.fhs")
    shooter = fh.ray.Shooter(tmp_path / "scene.fhs", channels="t")
    rays = {name: np.zeros(3) for name in ("ox", "oy", "oz", "dx", "dy", "dz")}
    with pytest.raises(ValueError, match="rays must have the columns oz, dx"):
        shooter({name: rays[name] for name in ("ox", "oy", "dy", "dz")})
    with pytest.raises(ValueError, match="rays must not have the columns of their hits, t"):
        shooter({**rays, "t": np.zeros(3)})
    with pytest.raises(ValueError, match="channels must be among"):
        fh.ray.Shooter(tmp_path / "scene.fhs", channels="tea")


def test_a_job_goes_on_after_the_kill_of_a_node(three_nodes, plain, tmp_path):
    """The node of the driver is not killed: with it goes the driver."""

    def kill_node(pid):
        for node in list(three_nodes.worker_nodes):
            processes = processes_of(node)
            if pid not in [each.pid for each in processes]:
                continue
            for each in processes:
                with contextlib.suppress(psutil.NoSuchProcess):
                    each.kill()
            three_nodes.remove_node(node, allow_graceful=False)
            for each in processes:
                cluster_support.wait_for_the_end_of(each.pid)
            return True
        return False

    on = fh.ray.executor(options=SPREAD)
    killed(tmp_path, on, kill_node, plain["marked"])
    assert len(three_nodes.worker_nodes) == 1


def test_an_executor_whose_cluster_is_gone_starts_none(one_node):
    """Ray's own functions would start a cluster of this machine. It is the last: Ray is gone."""
    on = fh.ray.executor(1)
    ray.shutdown()
    with pytest.raises(RuntimeError, match=r"call ray\.init before"):
        on.submit(divmod, 7, 2)
    assert not ray.is_initialized()
