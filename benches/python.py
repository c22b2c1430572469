"""Measure the Python package beside embreex and trimesh: the same rays, in turns, one thread.

    make bench-python [SCENES=bunny,terrain] [ROUNDS=5]

Times are processor time of the whole process for each ray, the smallest of all rounds. firsthit
gives t, object, primitive and barycentric coordinates in float64; embreex' ``run`` the primitive
alone, or with ``output=True`` what firsthit gives, in float32; trimesh's ``intersects_first`` the
primitive. Rays are given to each in the type it takes without a conversion.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import TYPE_CHECKING

import firsthit as fh

if TYPE_CHECKING:
    from collections.abc import Callable
import numpy as np
import trimesh
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from trimesh.ray.ray_pyembree import RayMeshIntersector

SIDE = 1024
COLUMNS = ("firsthit", "embreex", "embreex all", "trimesh")


class Peers:
    """A mesh in every library."""

    def __init__(self, vertices: np.ndarray, faces: np.ndarray) -> None:
        self.firsthit = fh.Scene()
        self.firsthit.add(fh.Mesh(vertices, faces))
        self.embreex = EmbreeScene()
        TriangleMesh(self.embreex, vertices.astype(np.float32), faces.astype(np.int32))
        mesh = trimesh.Trimesh(vertices, faces, process=False)
        self.trimesh = RayMeshIntersector(mesh)

    def contestants(
        self, origins: np.ndarray, directions: np.ndarray, camera: fh.Camera | None
    ) -> list[Callable[[], np.ndarray]]:
        """List functions that find the first primitive of each ray, -1 for none."""
        single = [np.ascontiguousarray(a, dtype=np.float32) for a in (origins, directions)]
        shoot = self.firsthit.shoot
        return [
            lambda: (
                shoot(camera, threads=1) if camera else shoot(origins, directions, threads=1)
            ).primitive.reshape(-1),
            lambda: self.embreex.run(*single),
            lambda: self.embreex.run(*single, output=True)["primID"],
            lambda: self.trimesh.intersects_first(origins, directions),
        ]


def in_turns(rounds: int, contestants: list[Callable[[], np.ndarray]]) -> list[float]:
    """Measure seconds of processor time: the smallest of all rounds but the first."""
    best = [np.inf] * len(contestants)
    for number in range(rounds + 1):
        for k, contestant in enumerate(contestants):
            start = time.process_time()
            contestant()
            seconds = time.process_time() - start
            if number > 0:
                best[k] = min(best[k], seconds)
    return best


def rows(peers: Peers, look: dict[str, np.ndarray]) -> dict[str, tuple]:
    """Make rays by name: origins and directions (n, 3), and the camera where one is given."""
    height = 2.0 * np.tan(np.radians(float(look["fov"])) / 2.0)
    camera = fh.Camera(
        position=look["eye"],
        aim=look["at"] - look["eye"],
        up=look["up"],
        focal_length=1.0,
        width=height,
        height=height,
        rows=SIDE,
        columns=SIDE,
        ray_start="eye",
    )
    origins, directions = (np.ascontiguousarray(a.reshape(-1, 3)) for a in camera.rays())
    hits = peers.firsthit.shoot(camera)
    at, normal = hits.position.reshape(-1, 3), hits.normal.reshape(-1, 3)
    seen = np.isfinite(normal).all(axis=1)
    at, normal = at[seen], normal[seen]
    facing = np.sum(normal * directions[seen], axis=1) < 0
    normal = np.where(facing[:, None], normal, -normal)
    scatter = np.random.default_rng(1).standard_normal(normal.shape)
    scatter = normal + scatter / np.linalg.norm(scatter, axis=1, keepdims=True)
    # Float32 numbers, so that all get the same rays.
    off = 1e-5 * np.linalg.norm(np.ptp(peers.firsthit.bounds, axis=0))
    bounce = [a.astype(np.float32).astype(np.float64) for a in (at + off * normal, scatter)]
    return {
        "camera": (origins, directions, camera),
        "arrays": (origins, directions, None),
        "bounce": (*bounce, None),
    }


def scenes(names: list[str]) -> dict[str, tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]]:
    """Load vertices, faces and camera by name from target/scenes; without files, make a sphere."""
    folder = Path("target/scenes")
    files = sorted(folder.glob("*.npz"), key=lambda file: file.stat().st_size)
    found = {file.stem: file for file in files if not names or file.stem in names}
    if missing := [name for name in names if name not in found]:
        raise SystemExit(f"no scene {', '.join(missing)} in {folder}")
    if found:
        return {name: (d["v"], d["f"], dict(d)) for name, f in found.items() for d in [np.load(f)]}
    ball = trimesh.creation.icosphere(subdivisions=6)
    look = {"eye": (0.0, -3.0, 1.0), "at": (0.0, 0.0, 0.0), "up": (0.0, 0.0, 1.0), "fov": 40.0}
    look = {name: np.array(value) for name, value in look.items()}
    return {"ball": (ball.vertices.astype(np.float32), ball.faces, look)}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", default="", help="names, with commas")
    parser.add_argument("--rounds", type=int, default=5)
    arguments = parser.parse_args()
    names = [name for name in arguments.scenes.split(",") if name]
    print(f"firsthit {fh.__version__}, ns for each ray, process time, min of {arguments.rounds}")
    heads = "".join(f"{name:>12}" for name in COLUMNS)
    print(f"{'scene':10} {'rays':8}{heads} | x embreex  x all x trimesh | other id")
    ratios: dict[str, list[np.ndarray]] = {}
    for name, (vertices, faces, look) in scenes(names).items():
        peers = Peers(vertices, faces)
        for row, (origins, directions, camera) in rows(peers, look).items():
            contestants = peers.contestants(origins, directions, camera)
            times = 1e9 * np.array(in_turns(arguments.rounds, contestants)) / len(origins)
            ours, theirs = contestants[0](), contestants[1]()
            other = int(np.count_nonzero(ours != np.asarray(theirs).reshape(-1)))
            ratio = times[1:] / times[0]
            ratios.setdefault(row, []).append(ratio)
            cells = "".join(f"{t:12.1f}" for t in times)
            shares = f"{ratio[0]:9.2f} {ratio[1]:6.2f} {ratio[2]:9.2f}"
            print(f"{name:10} {row:8}{cells} | {shares} | {other}", flush=True)
    for row, all_of in ratios.items():
        embreex, with_all, by_trimesh = np.exp(np.mean(np.log(all_of), axis=0))
        shares = f"x embreex {embreex:.2f}, x all {with_all:.2f}, x trimesh {by_trimesh:.2f}"
        print(f"geometric mean, {row:8}: {shares}")


if __name__ == "__main__":
    main()
