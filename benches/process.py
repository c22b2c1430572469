"""Measure whole processes: a .ply file to a shaded 1024 x 1024 PNG, start to end, files included.

    make bench-python [SCENES=bunny,terrain] [ROUNDS=5]

``firsthit render`` beside the shortest program with trimesh and embreex that makes the same kind of
picture (``--peer``, which is how this file calls itself). Processor time counts all threads.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SIDE = 1024
#: One sample per pixel, as the peer takes.
RENDER = f"target/release/firsthit render --quiet --size {SIDE}x{SIDE} --samples 1".split()


def peer(mesh: str, picture: str) -> None:
    """Shade by the angle between ray and face, from where all is in view."""
    import numpy as np
    import trimesh
    from PIL import Image

    loaded = trimesh.load(mesh, process=False)
    centre, size = loaded.bounds.mean(axis=0), np.linalg.norm(np.ptp(loaded.bounds, axis=0))
    x = (np.arange(SIDE) + 0.5) / SIDE - 0.5
    across, down = np.meshgrid(x, x)
    directions = np.stack([across, np.ones_like(across), -down], -1).reshape(-1, 3)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    origins = np.broadcast_to(centre - [0.0, 1.2 * size, 0.0], directions.shape)
    triangles = loaded.ray.intersects_first(origins, directions)
    hit = triangles >= 0
    shade = np.zeros(len(directions))
    shade[hit] = np.abs(np.sum(loaded.face_normals[triangles[hit]] * directions[hit], axis=1))
    pixels = (255.0 * shade).astype(np.uint8).reshape(SIDE, SIDE)
    Image.fromarray(pixels).save(picture)


def run(command: list[str]) -> tuple[float, float, float]:
    """Run it; return seconds of processor time, seconds by the clock, and MiB at most."""
    start = time.perf_counter()
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(child.pid, 0)
    seconds = time.perf_counter() - start
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode != 0:
        raise SystemExit(f"{command[0]} ended with {child.returncode}")
    return used.ru_utime + used.ru_stime, seconds, used.ru_maxrss / 1024.0


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--scenes", default="bunny,terrain", help="names in target/scenes, with commas"
    )
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--peer", nargs=2, metavar=("MESH", "PNG"), help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.peer:
        return peer(*arguments.peer)
    print(f"whole process, mesh file to {SIDE} x {SIDE} PNG, min of {arguments.rounds}")
    print(f"{'scene':10} {'program':16} {'CPU s':>7} {'wall s':>7} {'peak MiB':>9}")
    for scene in arguments.scenes.split(","):
        mesh = Path("target/scenes") / f"{scene}.ply"
        if not mesh.is_file():
            print(f"{scene:10} no {mesh}: not measured")
            continue
        with tempfile.TemporaryDirectory() as folder:
            picture = str(Path(folder) / "picture.png")
            commands = {
                "firsthit render": [*RENDER, str(mesh), "--output", picture],
                "trimesh+embreex": [sys.executable, __file__, "--peer", str(mesh), picture],
            }
            best = {name: (float("inf"),) * 3 for name in commands}
            for _ in range(arguments.rounds):
                for name, command in commands.items():
                    best[name] = tuple(map(min, best[name], run(command)))
        for name, (cpu, wall, peak) in best.items():
            print(f"{scene:10} {name:16} {cpu:7.2f} {wall:7.2f} {peak:9.0f}", flush=True)
        ratio = best["trimesh+embreex"][0] / best["firsthit render"][0]
        print(f"{scene:10} processor time of trimesh+embreex divided by firsthit's: {ratio:.2f}")
    return None


if __name__ == "__main__":
    main()
