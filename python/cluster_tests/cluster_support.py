"""Jobs for clusters, and what kills their workers."""

import os
import signal
import sys
import time
import uuid
from pathlib import Path

import firsthit as fh
import numpy as np

# conftest.py has it in the workers' path.
sys.path.append(str(Path(__file__).parents[1] / "tests"))

from many_support import cameras, rays, scene

#: How many rays a job of folds has, how many are a part, and how many parts that is.
RAYS, SIZE, PARTS = 6_000, 200, 30


class Marked:
    """A fold that takes its time, and leaves a mark for each call.

    Parameters
    ----------
    marks : path-like, optional
        The folder of the marks.
    seconds : float
        How long it takes.
    deaths : int
        How often a part kills its worker before it is made.
    """

    def __init__(self, marks=None, seconds=0.0, deaths=0):
        self.marks, self.seconds, self.deaths = marks, seconds, deaths

    def __call__(self, hits):
        if self.marks is not None:
            part = f"{hits.origin[0, 0]:.17g}"
            Path(self.marks, f"{part} {os.getpid()} {uuid.uuid4().hex}").touch()
            if len(list(Path(self.marks).glob(f"{part} *"))) <= self.deaths:
                os.kill(os.getpid(), signal.SIGKILL)
        time.sleep(self.seconds)
        return {"hits": np.array((hits.object >= 0).sum())}

    def merge(self, first, second):
        return {"hits": first["hits"] + second["hits"]}

    def __repr__(self):
        return "Marked"  # Of the job's file: the answer depends on no argument.


def marked(out, fold=None, **how):
    return fh.shoot_many(
        scene(), rays(RAYS), out, fold=Marked() if fold is None else fold, part_size=SIZE, **how
    )


def hits(out, **how):
    return fh.shoot_many(scene(), rays(), out, channels=["t", "normal"], part_size=900, **how)


def pictures(out, **how):
    return fh.render_many(scene(), cameras(), out, channels=["z", "color"], part_size=2, **how)


JOBS = {"marked": marked, "hits": hits, "pictures": pictures}


def tree(out):
    """What is in the files of the parts that have their names."""
    files = sorted(path for path in Path(out).glob("parts/[0-9]*/**/*") if path.is_file())
    return {str(path.relative_to(out)): path.read_bytes() for path in files}


def calls(marks):
    """The processes that were called for each part, the first one first."""
    numbers = {f"{x:.17g}": k for k, x in enumerate(rays(RAYS)[0][::SIZE, 0])}
    called = {}
    for mark in sorted(Path(marks).iterdir(), key=lambda path: path.stat().st_mtime_ns):
        part, pid, _ = mark.name.split()
        called.setdefault(numbers[part], []).append(int(pid))
    return called


class Killing:
    """A job's progress, which kills who makes a part when some are done.

    Parameters
    ----------
    out, marks : Path
        The folders of the job and of its marks.
    kill : callable
        Is called with the identifier of a process that makes a part. It returns when that one is
        dead, or ``False`` if it must not be killed.
    """

    def __init__(self, out, marks, kill):
        self.out, self.marks, self.kill = out, marks, kill
        #: When each part was made that was there before.
        self.stamps = {}
        #: The parts that were lost.
        self.lost = []

    def __call__(self, done, total):
        if self.lost or done < 6:
            return
        end = time.monotonic() + 20
        while not self.lost and time.monotonic() < end:
            self.stamps = self._stamps()
            for part, (*_, pid) in calls(self.marks).items():
                if part in self.stamps or self.kill(pid) is False:
                    continue
                # It may have been made between the look and the kill.
                if part not in self._stamps():
                    self.lost.append(part)
                break
            time.sleep(0.01)
        assert self.lost, "nobody could be killed who made a part"
        assert self._stamps().keys() != set(range(total)), "nothing was missing when it was killed"

    def _stamps(self):
        made = {}
        for path in self.out.glob("parts/[0-9]*/part.json"):
            made[int(path.parent.name)] = path.stat().st_mtime_ns
        return made

    def check(self, made, plain):
        """Check that a job came to the same after the kill, and that nothing was made twice."""
        assert len(self.lost) == 1
        assert (made.made, made.kept, made.missing) == (PARTS, 0, 0)
        digest, files = plain
        assert made.digest == digest
        assert tree(self.out) == files
        assert len(self.stamps) >= 6
        assert self.stamps.items() <= self._stamps().items()
        called = calls(self.marks)
        assert len(called[self.lost[0]]) >= 2
        again = marked(self.out, verify=True)
        assert (again.made, again.kept) == (0, PARTS)


def killed(out, on, kill, plain):
    """Make a job whose worker is killed, and check what it comes to."""
    marks = out / "marks"
    marks.mkdir()
    killing = Killing(out / "job", marks, kill)
    made = marked(out / "job", Marked(str(marks), seconds=0.15), on=on, progress=killing)
    killing.check(made, plain)


def wait_for_the_end_of(pid):
    """Wait until a process is dead, which somebody else's child may be."""
    end = time.monotonic() + 20
    while time.monotonic() < end:
        try:
            state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
        except OSError:
            return
        if state in "ZX":
            return
        time.sleep(0.01)
    raise AssertionError(f"process {pid} does not end")
