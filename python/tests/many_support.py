"""Jobs for tests: what workers run must be in a module that they can import."""

import json
import multiprocessing
import os
import signal
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import firsthit as fh
import numpy as np
from firsthit._parts.digest import of_json


def scene():
    made = fh.Scene()
    made.add(fh.Sphere(center=(0, 0, 0), radius=1), name="ball")
    made.add(fh.Box((-4, -4, -2), (4, 4, -1.5)), name="floor")
    return made


def cameras(count=12):
    angles = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return [
        fh.Camera.look_at(
            (5 * np.cos(a), 5 * np.sin(a), 2), (0, 0, 0), (0, 0, 1), 45, rows=20, columns=30
        )
        for a in angles
    ]


def rays(count=10_000, seed=3):
    rng = np.random.default_rng(seed)
    origins = rng.normal(size=(count, 3))
    origins *= 6 / np.linalg.norm(origins, axis=-1, keepdims=True)
    return origins, rng.normal(size=(count, 3)) - origins


def batches(fail):
    """Four batches of rays, of which one fails or none."""
    for k in range(4):
        if k == fail:
            raise KeyError("no more")
        yield rays(10, seed=k)


def of_processes(workers, method):
    context = multiprocessing.get_context(method)
    return lambda: ProcessPoolExecutor(workers, mp_context=context)


def tree(folder):
    """Return the content of the files of the parts."""
    files = sorted(path for path in Path(folder, "parts").rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def forge(path, change):
    """Change a record, or the file of a job, as somebody would who knows what its check is."""
    said = json.loads(path.read_text())
    del said["check"]
    change(said)
    path.write_text(json.dumps({**said, "check": of_json(said)}))


class Counting:
    """A fold of the number of hits."""

    def __call__(self, hits):
        return {"hits": np.array((hits.object >= 0).sum())}

    def merge(self, first, second):
        return {"hits": first["hits"] + second["hits"]}

    def __repr__(self):
        return type(self).__name__


class Suicide(Counting):
    """A fold that kills its worker: at the first try of each part, always, or in one part."""

    def __init__(self, marks, *, is_always=False, only=None):
        self.marks, self.is_always, self.only = marks, is_always, only

    def __call__(self, hits):
        mark = Path(self.marks) / f"{hits.origin[0, 0]:.17g}"
        if self.only is not None:
            kills = (hits.origin[0] == self.only).all()
        else:
            kills = self.is_always or not mark.exists()
        if kills:
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return super().__call__(hits)


class Slow(Counting):
    """A fold that takes its time; what it comes to does not depend on that."""

    def __init__(self, seconds=0.05):
        self.seconds = seconds

    def __call__(self, hits):
        time.sleep(self.seconds)
        return super().__call__(hits)


class Wrong:
    """A fold that fails."""

    def __repr__(self):
        return "Wrong"

    def __call__(self, hits):
        raise ValueError("this fold is wrong")

    def merge(self, first, second):
        return first


class Reading(Wrong):
    """A fold that reads a file of its own."""

    def __init__(self, path):
        self.path = path

    def __call__(self, hits):
        return {"bytes": np.array(len(Path(self.path).read_bytes()))}


def red(hits):
    """A shader of one's own."""
    return np.broadcast_to(np.float32([1, 0, 0]), (*hits.shape, 3))


def slowly(out, workers):
    on = fh.many.processes(int(workers)) if int(workers) else None
    fh.shoot_many(scene(), rays(), out, fold=Slow(), part_size=200, on=on)


def all_hits(folder, name="t"):
    parts = sorted(Path(folder, "parts").iterdir())
    return np.concatenate([np.load(part / "hits.npz")[name] for part in parts])
