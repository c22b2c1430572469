"""Measure a driving 64-beam lidar beside Open3D and embreex, which are fed by hand: one core.

    make bench-lidar [ROUNDS=7] [TURNS=5]

A head with 64 lasers from -24.8 to +2 degrees turns ten times a second, 2048 firings to a turn,
1.2 above the terrain of 4 million triangles, and drives at 20 scene units a second. Rows:

``scan``      `Lidar.scan`: rays from the trajectory, first hits, and the columns of a point cloud
``shoot``     `Scene.shoot` with the lidar: rays from the trajectory, and first hits
``array``     `Scene.shoot` with the same rays as arrays
``open3d``    ``RaycastingScene.cast_rays`` with the rays as float32: t, ids, uv and normals
``embreex``   ``EmbreeScene.run`` with the rays as float32: the primitive; ``t`` is the query
              DISTANCE, ``all`` the option ``output=True``: t, ids, uv and normals
``cloud``     what `Lidar.scan` gives, by hand in float32: NumPy makes the rays of each turn, the
              peer casts them, NumPy makes points, incidence, rows, columns, rings and times

Peers get their rays made and converted beforehand, but for ``cloud``: their times are those of the
cast alone. Times are processor time of the whole process, which is bound to one core, for each ray:
the smallest of all rounds, in which the contestants take turns. Answers are compared on the same
float32 rays. Where they differ, rational arithmetic on the float32 numbers says who is right.
"""

from __future__ import annotations

import os

# Before the peers start their threads. They make one for each core that the process may use.
os.environ["OMP_NUM_THREADS"] = "1"
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})

import argparse
import datetime
import platform
import time
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import firsthit as fh
import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from queries import open3d, tensor_scene
from scenes import terrain

if TYPE_CHECKING:
    from collections.abc import Callable

LASERS, COLUMNS, RATE = 64, 2048, 10.0
LOWEST, HIGHEST = -24.8, 2.0
#: Above the ground, and how far in a second, in scene units.
HEIGHT, SPEED = 1.2, 20.0
#: How far apart the ranges of two libraries may be: float32 has 24 bits, and a ray that grazes a
#: triangle at a hundredth of a radian loses two digits.
TOLERANCE = 1e-4


class Rays(NamedTuple):
    """The rays of all turns, (n, 3) each."""

    origins: np.ndarray
    directions: np.ndarray

    def single(self) -> Rays:
        """Return the rays as float32."""
        return Rays(*(np.ascontiguousarray(array, np.float32) for array in self))


def load() -> tuple[np.ndarray, np.ndarray]:
    """Return vertices (n, 3) float32 and faces (m, 3): from target/scenes, or made anew."""
    file = Path("target/scenes/terrain.npz")
    if file.is_file():
        with np.load(file) as arrays:
            return arrays["v"], arrays["f"]
    mesh, _ = terrain()
    return np.ascontiguousarray(mesh.vertices, np.float32), mesh.triangles


def drive(scene: fh.Scene, seconds: float) -> fh.Trajectory:
    """Return a drive along y through the middle of the terrain, level and above the ground."""
    times = np.linspace(0.0, seconds, max(2, round(seconds * 100) + 1))
    along = np.stack([0 * times + 50.0, 40.0 + SPEED * times, 0 * times + 100.0], axis=-1)
    ground = 100.0 - scene.shoot(along, (0.0, 0.0, -1.0)).t
    along[:, 2] = ground + HEIGHT
    forwards = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    return fh.Trajectory(
        times, along, np.broadcast_to(forwards, (len(times), 3, 3)), body="forwards-left-up"
    )


def heads(drive_: fh.Trajectory, turns: int) -> list[fh.Lidar]:
    """Return the lidar in each of its turns."""
    elevations = np.linspace(LOWEST, HIGHEST, LASERS)
    return [
        fh.Lidar.spinning(elevations, COLUMNS, rate=RATE, start=turn / RATE, trajectory=drive_)
        for turn in range(turns)
    ]


def cloud(
    cast: Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]],
    along: np.ndarray,
    seconds: np.ndarray,
    turn: int,
) -> dict[str, np.ndarray]:
    """Make the point cloud of a turn by hand; ``cast`` returns t and normals of any length."""
    columns = np.arange(COLUMNS)
    time_ = turn / RATE + columns / COLUMNS / RATE
    azimuth = np.radians(180.0 - 360.0 * columns / COLUMNS)
    elevation = np.radians(np.linspace(HIGHEST, LOWEST, LASERS))[:, None]
    x, y = np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth)
    own = np.stack([x, y, np.broadcast_to(np.sin(elevation), x.shape)], axis=-1, dtype=np.float32)
    # The body looks along y.
    directions = np.stack([-own[..., 1], own[..., 0], own[..., 2]], axis=-1).reshape(-1, 3)
    at = np.stack([np.interp(time_, seconds, axis) for axis in along.T], axis=-1, dtype=np.float32)
    origins = np.broadcast_to(at, (LASERS, COLUMNS, 3)).reshape(-1, 3)
    t, normals = cast(origins, directions)
    beam = np.flatnonzero(np.isfinite(t))
    far, ways, normals = t[beam, None], directions[beam], normals[beam]
    cosine = np.abs((ways * normals).sum(axis=1)) / np.linalg.norm(normals, axis=1)
    row, column = np.divmod(beam.astype(np.int32), COLUMNS)
    return {
        "point": origins[beam] + far * ways,
        "sensor_point": far * own.reshape(-1, 3)[beam],
        "range": t[beam],
        "incidence": np.arccos(np.minimum(cosine, 1.0)),
        "ring": LASERS - 1 - row,
        "row": row,
        "column": column,
        "time": time_[column],
    }


def contestants(
    scene: fh.Scene, lidars: list[fh.Lidar], rays: Rays, mesh: tuple[np.ndarray, np.ndarray]
) -> dict[str, Callable[[], object]]:
    """List who casts the rays of all turns, by name."""
    embree = EmbreeScene()
    TriangleMesh(embree, mesh[0], mesh[1].astype(np.int32))
    single = rays.single()
    way = lidars[0].trajectory
    along, seconds = way.at(way.times)[:, :3, 3], way.times
    turns = range(len(lidars))

    def by_embreex(origins: np.ndarray, directions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        found = embree.run(np.ascontiguousarray(origins), directions, output=True)
        return np.where(found["primID"] >= 0, found["tfar"], np.inf), found["Ng"]

    who: dict[str, Callable[[], object]] = {
        "scan": lambda: [lidar.scan(scene, threads=1) for lidar in lidars],
        "shoot": lambda: [scene.shoot(lidar, threads=1) for lidar in lidars],
        "array": lambda: scene.shoot(*rays, threads=1),
        "embreex": lambda: embree.run(*single),
        "embreex t": lambda: embree.run(*single, query="DISTANCE"),
        "embreex all": lambda: embree.run(*single, output=True),
        "embreex cloud": lambda: [cloud(by_embreex, along, seconds, turn) for turn in turns],
    }
    if open3d is not None:
        tensors = tensor_scene(*mesh)
        table = open3d.core.Tensor(np.hstack(single))

        def by_open3d(origins: np.ndarray, directions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            lines = open3d.core.Tensor(np.hstack([origins, directions]))
            found = tensors.cast_rays(lines)
            return found["t_hit"].numpy(), found["primitive_normals"].numpy()

        who["open3d"] = lambda: tensors.cast_rays(table)
        who["open3d cloud"] = lambda: [cloud(by_open3d, along, seconds, turn) for turn in turns]
    return who


def nanoseconds(rounds: int, who: dict[str, Callable[[], object]], rays: int) -> dict[str, float]:
    """Measure processor time for each ray, in turns: the smallest but for the first round."""
    best = dict.fromkeys(who, np.inf)
    for number in range(rounds + 1):
        for name, cast in who.items():
            start = time.process_time()
            cast()
            spent = 1e9 * (time.process_time() - start) / rays
            if number > 0:
                best[name] = min(best[name], spent)
    return best


def crosses(corners: np.ndarray, origin: np.ndarray, direction: np.ndarray) -> Fraction | None:
    """Return where a ray crosses a triangle, edges included, without rounding; None if not."""

    def exact(vector: np.ndarray) -> list[Fraction]:
        return [Fraction(float(x)) for x in vector]

    def minus(a: list[Fraction], b: list[Fraction]) -> list[Fraction]:
        return [x - y for x, y in zip(a, b, strict=True)]

    def triple(a: list[Fraction], b: list[Fraction], c: list[Fraction]) -> Fraction:
        return (
            a[0] * (b[1] * c[2] - b[2] * c[1])
            - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
        )

    start, along = exact(origin), exact(direction)
    a, b, c = (minus(exact(corner), start) for corner in corners)
    sides = [triple(along, *pair) for pair in ((b, c), (c, a), (a, b))]
    total = sum(sides, Fraction(0))
    if total == 0 or not (all(s >= 0 for s in sides) or all(s <= 0 for s in sides)):
        return None
    t = triple(a, b, c) / total
    return t if t > 0 else None


def judged(
    mesh: tuple[np.ndarray, np.ndarray], rays: Rays, ours: fh.Hits, theirs: tuple, name: str
) -> str:
    """Say how many answers of a peer differ from ours, and who is right about them."""
    vertices, faces = mesh
    t, primitive = theirs
    hit, met = ours.object >= 0, np.isfinite(t)
    both = hit & met
    with np.errstate(invalid="ignore"):
        apart = np.abs(ours.t - t) / np.maximum(ours.t, 1.0)
    one_sided = hit != met
    far = both & (apart > TOLERANCE)
    other = both & (ours.primitive != primitive)
    wrong = {"firsthit": 0, name: 0}
    for ray in np.flatnonzero(one_sided | far):
        claims = {
            "firsthit": (int(ours.primitive[ray]) if hit[ray] else None, ours.t[ray]),
            name: (int(primitive[ray]) if met[ray] else None, t[ray]),
        }
        true = {
            who: None
            if face is None
            else crosses(vertices[faces[face]], rays.origins[ray], rays.directions[ray])
            for who, (face, _) in claims.items()
        }
        nearest = min((at for at in true.values() if at is not None), default=None)
        for who, (face, at) in claims.items():
            if nearest is None:
                is_wrong = face is not None
            else:
                is_wrong = face is None or abs(float(nearest) - at) > TOLERANCE * max(1.0, at)
            wrong[who] += is_wrong
    same = both & ~other
    return (
        f"{name}: {int(one_sided.sum())} hit by one side alone, {int(far.sum())} more than "
        f"{TOLERANCE:g} apart, {int(other.sum())} another triangle; largest difference in the same "
        f"triangle {apart[same].max():.1e}; wrong by rational arithmetic: "
        + ", ".join(f"{who} {count}" for who, count in wrong.items())
    )


def compare(mesh: tuple[np.ndarray, np.ndarray], scene: fh.Scene, rays: Rays) -> list[str]:
    """Compare the answers of all on the same float32 rays."""
    single = rays.single()
    ours = scene.shoot(*single, threads=1)
    embree = EmbreeScene()
    TriangleMesh(embree, mesh[0], mesh[1].astype(np.int32))
    found = embree.run(*single, output=True)
    t = np.where(found["primID"] >= 0, found["tfar"], np.inf)
    lines = [judged(mesh, single, ours, (t, found["primID"]), "embreex")]
    if open3d is not None:
        cast = tensor_scene(*mesh).cast_rays(open3d.core.Tensor(np.hstack(single)))
        answers = cast["t_hit"].numpy(), cast["primitive_ids"].numpy().astype(np.int64)
        lines.append(judged(mesh, single, ours, answers, "open3d"))
    return lines


def machine() -> str:
    """Return the processor's name."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    return next((line.split(":")[1].strip() for line in lines if "model name" in line), "")


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--turns", type=int, default=5)
    arguments = parser.parse_args()
    mesh = load()
    scene = fh.Scene()
    scene.add(fh.Mesh(*mesh))
    lidars = heads(drive(scene, arguments.turns / RATE), arguments.turns)
    parts = [lidar.rays() for lidar in lidars]
    rays = Rays(*(np.concatenate([p[k].reshape(-1, 3) for p in parts]) for k in (0, 1)))
    count = len(rays.origins)
    found = int((scene.shoot(*rays).object >= 0).sum())
    today = datetime.datetime.now(tz=datetime.UTC).date()
    print(f"firsthit {fh.__version__}, {machine()}, {today}, load {os.getloadavg()[0]:.1f}")
    print(
        f"terrain, {len(mesh[1]):,} triangles; {count:,} rays in {arguments.turns} turns, "
        f"{found / count:.0%} hit; process time on one core, min of {arguments.rounds}"
    )
    times = nanoseconds(arguments.rounds, contestants(scene, lidars, rays, mesh), count)
    print(f"{'':14}{'ns a ray':>10}{'M rays/s':>10}{'/ scan':>8}{'/ shoot':>8}{'/ array':>8}")
    for name, spent in times.items():
        shares = "".join(f"{spent / times[row]:8.2f}" for row in ("scan", "shoot", "array"))
        print(f"{name:14}{spent:10.1f}{1e3 / spent:10.2f}{shares}", flush=True)
    print("\n".join(compare(mesh, scene, rays)))


if __name__ == "__main__":
    main()
