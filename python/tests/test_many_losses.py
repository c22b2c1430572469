"""Jobs whose workers and drivers are killed or interrupted."""

import os
import random
import signal
import subprocess
import sys
import time
from concurrent.futures import Future

import firsthit as fh
import pytest
from many_support import Slow, Suicide, of_processes, rays, scene, tree
from support import cases

POSIX = pytest.mark.skipif(sys.platform == "win32", reason="signals are those of Unix")
pytestmark = pytest.mark.usefixtures("workers_find_the_tests")


class Forgetful:
    """Does each task, and loses its first result with its worker."""

    def submit(self, tried, work, task):
        future, outcome = Future(), tried(work, task)
        if task.losses == 0:
            future.set_exception(RuntimeError("the worker is lost"))
        else:
            future.set_result(outcome)
        return future


@POSIX
def test_a_part_whose_worker_is_killed_is_tried_again(tmp_path):
    (tmp_path / "marks").mkdir()
    fold = Suicide(str(tmp_path / "marks"))
    made = fh.shoot_many(
        scene(), rays(), tmp_path / "out", fold=fold, part_size=2_500, on=fh.many.processes(2)
    )
    assert made.made == 4
    assert made.result["hits"] == (scene().shoot(*rays()).object >= 0).sum()


def test_a_part_that_was_whole_when_its_worker_was_lost_counts_as_made(tmp_path):
    made = fh.shoot_many(scene(), rays(), tmp_path, part_size=2_500, on=Forgetful())
    assert (made.parts, made.made, made.kept, made.missing) == (4, 4, 0, 0)


@POSIX
def test_a_part_that_kills_its_worker_three_times_is_an_error(tmp_path):
    (tmp_path / "marks").mkdir()
    fold = Suicide(str(tmp_path / "marks"), only=rays()[0][2_000])
    with pytest.raises(RuntimeError, match=r"part 2 was lost 3 times with its worker"):
        fh.shoot_many(
            scene(), rays(), tmp_path / "out", fold=fold, part_size=1_000, on=fh.many.processes(3)
        )
    # The others are not blamed for it, and go on until it is.
    assert fh.parts(tmp_path / "out").done >= 2


@POSIX
def test_a_given_pool_that_breaks_is_an_error(tmp_path):
    (tmp_path / "marks").mkdir()
    fold = Suicide(str(tmp_path / "marks"), is_always=True)
    with (
        of_processes(1, "spawn")() as pool,
        pytest.raises(RuntimeError, match="the pool is broken"),
    ):
        fh.shoot_many(scene(), rays(), tmp_path / "out", fold=fold, part_size=5_000, on=pool)


#: A driver of fifty parts that take their time.
SLOWLY = "import many_support, sys; many_support.slowly(*sys.argv[1:])"


@POSIX
@pytest.mark.parametrize("workers", [0, 2])
def test_a_driver_that_is_killed_at_any_time_goes_on(workers, tmp_path):
    """Finished parts are kept, and nobody works on for a driver that is dead."""
    out = tmp_path / "out"
    program = [sys.executable, "-c", SLOWLY, str(out), str(workers)]
    chance = random.Random(workers)
    stamps = {}
    for _ in range(max(2, cases(4))):
        running = subprocess.Popen(program, start_new_session=True)
        end, before = time.monotonic() + 60, len(stamps)
        while len(list(out.glob("parts/[0-9]*/part.json"))) <= before:
            assert running.poll() is None
            assert time.monotonic() < end
            time.sleep(0.02)
        time.sleep(chance.uniform(0.0, 0.4))
        running.kill()
        running.wait()
        for part in out.glob("parts/[0-9]*/part.json"):
            assert stamps.setdefault(part, part.stat().st_mtime_ns) == part.stat().st_mtime_ns
        _wait_for_the_end_of_session(running.pid)
    made = fh.shoot_many(scene(), rays(), out, fold=Slow(), part_size=200)
    assert made.kept >= len(stamps) > 0
    assert made.kept + made.made == 50
    whole = fh.shoot_many(scene(), rays(), tmp_path / "whole", fold=Slow(), part_size=200)
    assert made.digest == whole.digest
    assert tree(out).keys() - tree(tmp_path / "whole").keys() == _left(out)


def _left(out):
    """The files of what a killed run left behind; a day later they are removed."""
    return {str(p.relative_to(out)) for p in out.glob("parts/.*/*") if p.is_file()}


def _wait_for_the_end_of_session(leader):
    """Wait until no process of a session is there."""
    end = time.monotonic() + 20
    while time.monotonic() < end:
        try:
            os.killpg(leader, 0)
        except ProcessLookupError:
            return
        time.sleep(0.1)
    raise AssertionError("a worker outlives its driver")


@POSIX
def test_ctrl_c_keeps_what_is_finished(tmp_path):
    program = [sys.executable, "-c", SLOWLY, str(tmp_path), "2"]
    running = subprocess.Popen(program, stderr=subprocess.PIPE, start_new_session=True, text=True)
    end = time.monotonic() + 60
    while len(list(tmp_path.glob("parts/[0-9]*"))) < 4:
        assert running.poll() is None
        assert time.monotonic() < end
        time.sleep(0.05)
    os.killpg(running.pid, signal.SIGINT)
    _, said = running.communicate(timeout=30)
    assert running.returncode != 0
    assert said.count("Traceback") == 1
    state = fh.parts(tmp_path)
    assert 4 <= state.done < 50
    assert list(tmp_path.glob("parts/.*")) == []


#: Presses Ctrl-C where a pool makes a semaphore, or where it starts a worker; and says when.
PRESSED = """
import signal, sys
from concurrent.futures import process
from multiprocessing import resource_tracker
import firsthit as fh
makers = {"made": (resource_tracker, "register"), "started": (process, "_ExecutorManagerThread")}
owner, name = makers[sys.argv[1]]
def pressed(*given, instead=getattr(owner, name)):
    done = instead(*given)
    print("pressed", flush=True)
    signal.raise_signal(signal.SIGINT)
    return done
setattr(owner, name, pressed)
with fh.many.processes(2)() as pool:
    pool.submit(print)
"""


@POSIX
@pytest.mark.parametrize("when", ["made", "started"])
def test_ctrl_c_while_a_pool_is_made_leaves_no_semaphore_and_no_worker(when):
    program = [sys.executable, "-c", PRESSED, when]
    ran = subprocess.run(program, capture_output=True, text=True, timeout=60, check=False)
    assert ran.returncode == -signal.SIGINT
    assert ran.stdout.startswith("pressed")
    assert ran.stderr.splitlines()[-1] == "KeyboardInterrupt"
    assert "leaked" not in ran.stderr


@POSIX
def test_a_second_ctrl_c_ends_it_at_once(tmp_path):
    program = [sys.executable, "-c", ENDLESSLY, str(tmp_path)]
    running = subprocess.Popen(program, stderr=subprocess.DEVNULL, start_new_session=True)
    end = time.monotonic() + 60
    while not list(tmp_path.glob("parts/.*")):
        assert running.poll() is None
        assert time.monotonic() < end
        time.sleep(0.05)
    os.killpg(running.pid, signal.SIGINT)
    time.sleep(0.5)
    assert running.poll() is None
    os.killpg(running.pid, signal.SIGINT)
    assert running.wait(20) != 0
    _wait_for_the_end_of_session(running.pid)


#: A driver of parts that take minutes.
ENDLESSLY = (
    "import many_support as m, firsthit as fh, sys\n"
    "how = {'fold': m.Slow(300.0), 'part_size': 5000, 'on': fh.many.processes(2)}\n"
    "fh.shoot_many(m.scene(), m.rays(), sys.argv[1], **how)\n"
)
