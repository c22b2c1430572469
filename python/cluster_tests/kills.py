"""Kill workers and drivers of a job at random moments, as often as is asked for.

    python kills.py workers 100
    python kills.py drivers 100

The job must come to the digest of an undisturbed one. No part may be made twice once it is
finished, and no worker may outlive its driver.
"""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import firsthit as fh

TESTS = Path(__file__).resolve().parent.parent / "tests"
sys.path.insert(0, str(TESTS))
from many_support import Slow, rays, scene  # noqa: E402

RAYS, PART = 60_000, 100


def job(out: Path, on: object = None) -> fh.many.JobResult:
    """Make a job of 600 parts of 50 ms, or what is missing of it."""
    return fh.shoot_many(scene(), rays(RAYS), out, fold=Slow(), part_size=PART, on=on)


def whole(out: Path) -> dict[str, int]:
    """Return when each finished part was finished."""
    return {
        path.parent.name: path.stat().st_mtime_ns for path in out.glob("parts/[0-9]*/part.json")
    }


def children() -> list[int]:
    """Return this process's workers."""
    mine = Path(f"/proc/{os.getpid()}/task").glob("*/children")
    found = [int(pid) for path in mine for pid in path.read_text().split()]
    return [pid for pid in found if is_worker(pid)]


def is_worker(pid: int) -> bool:
    """Tell whether a process is a worker, not what multiprocessing keeps beside them."""
    try:
        return b"spawn_main" in Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:
        return False  # It has ended meanwhile.


def kill_workers(out: Path, kills: int, chance: random.Random) -> int:
    """Run jobs until so many workers were killed in their midst; return how many there were."""
    done = 0
    while done < kills:
        shutil.rmtree(out, ignore_errors=True)
        ended = threading.Event()
        counts = []

        def attack(
            ended: threading.Event = ended, counts: list[int] = counts, most: int = kills - done
        ) -> None:
            last = 0
            while not ended.wait(chance.uniform(0.05, 0.3)):
                there = len(whole(out))
                # A part may be lost twice. Some are finished before the next kill.
                if there < last + 4 or len(counts) >= most:
                    continue
                there_are = children()
                if not there_are:
                    continue
                pid = chance.choice(there_are)
                try:
                    os.kill(pid, signal.SIGKILL)
                except ProcessLookupError:
                    continue
                counts.append(pid)
                last = there

        killer = threading.Thread(target=attack)
        killer.start()
        try:
            made = job(out, fh.many.processes(2))
        finally:
            ended.set()
            killer.join()
        done += len(counts)
        check(out, made)
        print(f"{done} workers killed", flush=True)
    return done


def kill_drivers(out: Path, kills: int, chance: random.Random) -> int:
    """Kill drivers with and without workers; return how many were killed before their end."""
    code = (
        "import sys; sys.path[:0] = sys.argv[1:3]\n"
        "import kills, firsthit as fh, pathlib\n"
        "kills.job(pathlib.Path(sys.argv[3]), fh.many.processes(2) if int(sys.argv[4]) else None)\n"
    )
    done, finished = 0, {}
    shutil.rmtree(out, ignore_errors=True)
    while done < kills:
        program = [sys.executable, "-c", code, str(Path(__file__).parent), str(TESTS), str(out)]
        driver = subprocess.Popen([*program, str(done % 2)], start_new_session=True)
        time.sleep(chance.uniform(0.3, 1.8))
        ended = driver.poll() is not None
        driver.kill()
        driver.wait()
        wait_for_the_end_of(driver.pid)
        now = whole(out)
        for part, stamp in finished.items():
            assert now.get(part) == stamp, f"part {part} was made again"
        finished = now
        if ended:
            assert len(finished) == RAYS // PART, "a driver failed"
            check(out, job(out))
            finished = {}
            shutil.rmtree(out)
            continue
        done += 1
        if done % 10 == 0:
            print(f"{done} drivers killed, {len(finished)} parts finished", flush=True)
    check(out, job(out))
    return done


def wait_for_the_end_of(session: int) -> None:
    """Wait until all processes of a session have ended."""
    end = time.monotonic() + 20.0
    while time.monotonic() < end:
        try:
            os.killpg(session, 0)
        except ProcessLookupError:
            return
        time.sleep(0.05)
    raise AssertionError("a worker outlives its driver")


def check(out: Path, made: fh.many.JobResult) -> None:
    """Compare with an undisturbed job."""
    assert made.missing == 0
    assert made.digest == DIGEST, f"{made.digest} instead of {DIGEST}"
    assert made.result["hits"] == (scene().shoot(*rays(RAYS)).object >= 0).sum()
    assert fh.parts(out, verify=True).digest == DIGEST


def digest() -> str:
    """Return the digest of the job, made here at once."""
    with tempfile.TemporaryDirectory() as folder:
        made = fh.shoot_many(scene(), rays(RAYS), folder, fold=Slow(0.0), part_size=PART)
    assert made.digest is not None
    return made.digest


if __name__ == "__main__":
    DIGEST = digest()
    how = {"workers": kill_workers, "drivers": kill_drivers}[sys.argv[1]]
    with tempfile.TemporaryDirectory() as folder:
        # Workers that are started anew import the fold.
        os.environ["PYTHONPATH"] = os.pathsep.join(
            [str(TESTS), *filter(None, [os.environ.get("PYTHONPATH")])]
        )
        count = how(Path(folder) / "out", int(sys.argv[2]), random.Random(1))
    print(f"{count} {sys.argv[1]} killed: the same digest")
