"""Measure queries beyond the first hit beside Open3D, trimesh and embreex, in turns, one thread.

    make bench-queries [SCENES=bunny,terrain] [ROUNDS=3]

Times are processor time of the whole process for each ray, point or pair, the smallest of all
rounds. ``all hits``: `Scene.shoot_all` beside Open3D's ``list_intersections`` and trimesh's
``intersects_id(multiple_hits=True)`` over embreex. ``nearest``: `Scene.closest_point` beside
Open3D's ``compute_closest_points``, FCPW's ``find_closest_points`` and `trimesh.proximity`, for
points in a box twice as large as the mesh and for points within a thousandth of it. ``visible``:
`Scene.visible` beside embreex' occlusion query. A peer that is not installed has no number. Peers
compute in float32.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import firsthit as fh
import numpy as np
import trimesh

from python import Peers, scenes

sys.path.append(str(Path(__file__).parents[1] / "python" / "compat_tests"))
import libusb

libusb.load()
try:
    import open3d
except ImportError:
    open3d = None
try:
    import fcpw
except ImportError:
    fcpw = None

if TYPE_CHECKING:
    from collections.abc import Callable

    #: Of each query, by peer: how many answers, and what gives them.
    Rows = dict[str, dict[str, tuple[int, Callable[[], object]]]]

#: How many rays, points and pairs; trimesh's nearest points are measured with fewer.
COUNT, FEW = 400_000, 4_000


def tensor_scene(vertices: np.ndarray, faces: np.ndarray) -> object | None:
    """Return the mesh in Open3D, where that is installed."""
    if open3d is None:
        return None
    scene = open3d.t.geometry.RaycastingScene(nthreads=1)
    scene.add_triangles(
        open3d.core.Tensor(vertices.astype(np.float32)),
        open3d.core.Tensor(faces.astype(np.uint32)),
    )
    return scene


def fcpw_query(vertices: np.ndarray, faces: np.ndarray) -> Callable[[np.ndarray], object] | None:
    """Return what finds the nearest points of an array in FCPW, where that is installed."""
    if fcpw is None:
        return None
    scene = fcpw.scene_3D()
    scene.set_object_count(1)
    scene.set_object_vertices(vertices.astype(np.float32), 0)
    scene.set_object_triangles(faces.astype(np.int32), 0)
    scene.build(fcpw.aggregate_type.bvh_surface_area, vectorize=True)

    def ask(points: np.ndarray) -> object:
        found = fcpw.interaction_3D_list()
        scene.find_closest_points(points, np.full(len(points), np.inf, np.float32), found)
        return found

    return ask


def rows(vertices: np.ndarray, faces: np.ndarray) -> Rows:
    """List the queries: how many answers, and who gives them."""
    peers, numbers = Peers(vertices, faces), np.random.default_rng(1)
    scene, tensors = peers.firsthit, tensor_scene(vertices, faces)
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    low, high = scene.bounds
    size, middle = high - low, (low + high) / 2

    def single(array: np.ndarray) -> np.ndarray:
        """Numbers that float32 holds, so that all get the same."""
        return array.astype(np.float32).astype(np.float64)

    starts = single(middle + size * numbers.uniform(-1, 1, (COUNT, 3)))
    ends = single(middle + size * numbers.uniform(-0.5, 0.5, (COUNT, 3)))
    ways = single(ends - starts)
    around = single(middle + size * numbers.uniform(-1, 1, (COUNT, 3)))
    chosen = vertices[faces[numbers.integers(len(faces), size=COUNT)]].mean(axis=1)
    near = single(chosen + 1e-3 * size * numbers.standard_normal((COUNT, 3)))
    rays = np.hstack([starts, ways]).astype(np.float32)
    starts_32, ways_32 = starts.astype(np.float32), ways.astype(np.float32)
    found: Rows = {
        "all hits": {
            "firsthit": (COUNT, lambda: scene.shoot_all(starts, ways, threads=1)),
            "trimesh": (
                COUNT,
                lambda: peers.trimesh.intersects_id(starts, ways, multiple_hits=True),
            ),
        },
        "visible": {
            "firsthit": (COUNT, lambda: scene.visible(starts, ends, threads=1)),
            "embreex": (
                COUNT,
                lambda: peers.embreex.run(
                    starts_32, ways_32, np.ones(COUNT, np.float32), query="OCCLUDED"
                ),
            ),
        },
        "nearest": nearest(scene, mesh, around),
        "near": nearest(scene, mesh, near),
    }
    if tensors is not None:
        lines, *points = (open3d.core.Tensor(a.astype(np.float32)) for a in (rays, around, near))
        found["all hits"]["open3d"] = COUNT, lambda: tensors.list_intersections(lines)
        for name, given in zip(("nearest", "near"), points, strict=True):
            ask = lambda given=given: tensors.compute_closest_points(given)  # noqa: E731
            found[name]["open3d"] = COUNT, ask
    if find := fcpw_query(vertices, faces):
        for name, given in (("nearest", around), ("near", near)):
            points = np.asfortranarray(given, dtype=np.float32)
            found[name]["fcpw"] = COUNT, lambda points=points: find(points)
    return found


def nearest(
    scene: fh.Scene, mesh: trimesh.Trimesh, points: np.ndarray
) -> dict[str, tuple[int, Callable[[], object]]]:
    """List who finds the nearest points."""
    few = points[:FEW]
    return {
        "firsthit": (COUNT, lambda: scene.closest_point(points, threads=1)),
        "trimesh": (FEW, lambda: trimesh.proximity.closest_point(mesh, few)),
    }


def nanoseconds(rounds: int, contestants: dict[str, tuple[int, Callable[[], object]]]) -> dict:
    """Measure processor time for each answer, in turns: the smallest but for the first round."""
    best = dict.fromkeys(contestants, np.inf)
    for number in range(rounds + 1):
        for name, (count, ask) in contestants.items():
            start = time.process_time()
            ask()
            spent = 1e9 * (time.process_time() - start) / count
            if number > 0:
                best[name] = min(best[name], spent)
    return best


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", default="", help="names, with commas")
    parser.add_argument("--rounds", type=int, default=3)
    arguments = parser.parse_args()
    names = [name for name in arguments.scenes.split(",") if name]
    print(f"firsthit {fh.__version__}, ns for each answer, process time, min of {arguments.rounds}")
    for name, (vertices, faces, _) in scenes(names).items():
        for row, contestants in rows(vertices, faces).items():
            times = nanoseconds(arguments.rounds, contestants)
            ours = times["firsthit"]
            cells = "".join(f"  {peer} {t:.0f} ({t / ours:.2f})" for peer, t in times.items())
            print(f"{name:10} {row:8}{cells}", flush=True)


if __name__ == "__main__":
    main()
