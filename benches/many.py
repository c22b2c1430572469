"""Jobs in parts beside a plain loop: what the driver costs, and what workers take.

    .venv-bench/bin/python benches/many.py target/scenes/terrain.ply

Processor time is of all processes. Rays are shot by one thread each time, so that two workers are
two cores.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import firsthit as fh
import numpy as np

PARTS = 8


def rays(scene: fh.Scene, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return rays from around a scene to points in its box."""
    rng = np.random.default_rng(7)
    low, high = scene.bounds
    origins = rng.normal(size=(count, 3))
    origins /= np.linalg.norm(origins, axis=1, keepdims=True)
    origins = (low + high) / 2 + origins * np.linalg.norm(high - low)
    return origins, rng.uniform(low, high, (count, 3)) - origins


def plain(scene: fh.Scene, some: tuple[np.ndarray, np.ndarray], out: Path, size: int) -> None:
    """Do what a user's own loop does: shoot, save, sync."""
    out.mkdir()
    for k in range(PARTS):
        part = slice(k * size, (k + 1) * size)
        hits = scene.shoot(some[0][part], some[1][part], threads=1)
        with (out / f"{k:06d}.npz").open("wb") as file:
            np.savez(file, t=hits.t, object=hits.object, primitive=hits.primitive)
            file.flush()
            os.fsync(file.fileno())


def cameras(scene: fh.Scene) -> list[fh.Camera]:
    """Return cameras around a scene."""
    low, high = scene.bounds
    middle, size = (low + high) / 2, float(np.linalg.norm(high - low))
    around = np.linspace(0.0, 2.0 * np.pi, PARTS, endpoint=False)
    return [
        fh.Camera.look_at(
            middle + size * np.array([np.cos(a), 0.5, np.sin(a)]), middle, (0, 1, 0), 45,
            rows=768, columns=1024,
        )
        for a in around
    ]  # fmt: skip


#: Channels and samples of the pictures.
LOOK: dict[str, Any] = {"channels": ["color", "z", "object"], "samples": 16}


def plain_pictures(scene: fh.Scene, views: list[fh.Camera], out: Path) -> None:
    """Do what a user's own loop does: render, save, sync."""
    out.mkdir()
    for k, view in enumerate(views):
        path = out / f"{k:06d}.npz"
        fh.render(scene, view, threads=1, **LOOK).save(path)
        with path.open("rb") as file:
            os.fsync(file.fileno())


def timed(work: object) -> tuple[float, float]:
    """Return wall and processor seconds, those of children that have ended included."""
    began, cpu = time.perf_counter(), sum(os.times()[:4])
    work()  # type: ignore[operator]
    return time.perf_counter() - began, sum(os.times()[:4]) - cpu


#: The first step of a worker. It is timed from the start of its work, imports aside.
FIRST = """
import json, sys, time
import numpy as np, firsthit as fh
def own():
    lines = open("/proc/self/smaps_rollup").read().splitlines()
    return sum(int(line.split()[1]) for line in lines if line.startswith("Private")) / 1024
before, began = own(), time.perf_counter()
scene = fh.open(sys.argv[1])
low, high = scene.bounds
scene.shoot((low + high) / 2 + (high - low), (low - high), threads=1)
first = time.perf_counter() - began
origins, directions = np.load(sys.argv[2]), np.load(sys.argv[3])
scene.shoot(origins, directions, threads=1)
size = origins.nbytes * 2 / 2**20
print(json.dumps({"first_ms": 1e3 * first, "own_mb": own() - before - size}))
sys.stdin.readline()
"""


def table(title: str, runs: dict[str, list[tuple[float, float]]]) -> None:
    """Print medians, and processor time beside that of the plain loop."""
    print(title)
    base = np.median([cpu for _, cpu in runs["plain loop"]])
    for name, took in runs.items():
        wall, cpu = np.median(took, axis=0)
        print(f"  {name:18} {wall:6.2f} s wall  {cpu:6.2f} s of processor  {cpu / base:5.3f}")


def main() -> None:
    """Measure, and print tables."""
    parser = argparse.ArgumentParser()
    parser.add_argument("scene")
    parser.add_argument("--rays", type=int, default=1_500_000, help="of a part")
    parser.add_argument("--rounds", type=int, default=3)
    given = parser.parse_args()
    scene, size = fh.load(given.scene), given.rays
    some = rays(scene, PARTS * size)
    scene.shoot(some[0][:1000], some[1][:1000])
    views = cameras(scene)
    runs: dict[str, list[tuple[float, float]]] = {}
    seen: dict[str, list[tuple[float, float]]] = {}
    engines = (
        ("plain loop", None),
        ("here", None),
        ("processes(1)", fh.many.processes(1)),
        ("processes(2)", fh.many.processes(2)),
    )
    with tempfile.TemporaryDirectory() as folder:
        for number in range(given.rounds):
            for name, on in engines:
                out = Path(folder) / f"{number} {name}"
                if name == "plain loop":
                    took = timed(lambda out=out: plain(scene, some, out, size))
                else:
                    took = timed(
                        lambda out=out, on=on: fh.shoot_many(
                            scene, some, out, part_size=size, threads=1, on=on
                        )
                    )
                runs.setdefault(name, []).append(took)
                out = Path(folder) / f"{number} {name} pictures"
                if name == "plain loop":
                    took = timed(lambda out=out: plain_pictures(scene, views, out))
                else:
                    took = timed(
                        lambda out=out, on=on: fh.render_many(
                            scene, views, out, threads=1, on=on, **LOOK
                        )
                    )
                seen.setdefault(name, []).append(took)
        print(f"{given.scene}, {PARTS} parts, medians of {given.rounds}")
        table(f"pictures, 1024 x 768, {LOOK['samples']} samples", seen)
        table(f"{size:,} rays", runs)
        scene.save(Path(folder) / "s.fhs")
        for name, array in zip("od", some, strict=True):
            np.save(Path(folder) / f"{name}.npy", array[:200_000])
        workers = []
        for _ in range(2):
            files = [str(Path(folder) / name) for name in ("s.fhs", "o.npy", "d.npy")]
            worker = subprocess.Popen(
                [sys.executable, "-c", FIRST, *files],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
            )
            assert worker.stdout is not None
            workers.append((worker, json.loads(worker.stdout.readline())))
        for worker, _ in workers:
            worker.communicate("\n")
        said = workers[1][1]
        first, own = said["first_ms"], said["own_mb"]
        print(f"  second worker: {first:.0f} ms to its first ray, {own:.0f} MB of its own")


if __name__ == "__main__":
    main()
