"""Make the scenes that `make bench` measures: python benches/scenes.py target/scenes.

For each scene of one mesh there are three files: ``NAME.ply`` (binary, float32, triangles),
``NAME.npz`` (the same arrays and the camera) and ``NAME.cam``, a text with eye, target, up and
light, then the vertical field of view in degrees, the orthographic camera's height and the reach of
ambient occlusion. A scene of many objects has ``NAME.glb``, or ``NAME.toml`` with a GLB file's
objects and spheres, in place of the first two. The bytes are the same at every run. World space has
z up, in GLB files too.

The models come from the collection alecjacobson/common-3d-test-models. They have mixed research
licences: they are for measuring and are not to be committed. ``terrain``, ``tiles`` and
``assembly`` need none.
"""

from __future__ import annotations

import argparse
import re
import sys
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from glb import Placed, save_objects

MODELS = Path(__file__).resolve().parents[2] / "shared" / "scenes" / "models"
UP = (0.0, 0.0, 1.0)

#: The models that are scenes of their own; the interior has them and all the others.
ALONE = ("bunny", "nefertiti", "ogre", "igea")
OBJECTS = ("beast", "beetle", "cow", "fandisk", "homer", "rocker-arm", "spot", "suzanne", "teapot")
#: The models' files.
FILES = {name: f"{name}.obj" for name in (*ALONE, *OBJECTS)}
FILES |= {"bunny": "stanford-bunny.obj", "igea": "igea.ply"}
#: The models with z up; the others have y up, and are turned.
Z_UP = ("nefertiti", "igea")

#: A unit box: its corners, and its triangles seen from outside.
CORNERS = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
    dtype=np.float64,
)
# fmt: off
SIDES = np.array(
    [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4],
     [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6], [3, 0, 4], [3, 4, 7]],
)
# fmt: on


class Mesh(NamedTuple):
    """Triangles: vertices (n, 3), and the indices (m, 3) of their corners."""

    vertices: np.ndarray
    triangles: np.ndarray


@dataclass
class Look:
    """The camera and the light of a scene, in the order in which files have them."""

    eye: tuple | np.ndarray
    at: tuple | np.ndarray
    up: tuple
    light: tuple | np.ndarray
    fov: float
    ortho: float
    ao: float


def read_obj(path: Path) -> Mesh:
    """Read vertices and faces of an OBJ file; polygons are split into fans."""
    vertices, triangles = [], []
    with path.open(errors="ignore") as lines:
        for line in lines:
            key, *words = line.split() or [""]
            if key == "v":
                vertices.append([float(word) for word in words[:3]])
            elif key == "f":
                numbers = [int(word.split("/")[0]) for word in words]
                first, *rest = (n - 1 if n > 0 else len(vertices) + n for n in numbers)
                triangles += [(first, b, c) for b, c in pairwise(rest)]
    return Mesh(np.array(vertices, np.float32), np.array(triangles, np.uint32))


def read_strips(path: Path) -> Mesh:
    """Read a binary PLY file with three floats to a vertex and one list of triangle strips.

    A strip ends at a negative index. Every second triangle of a strip is turned over.
    """
    content = path.read_bytes()
    start = content.index(b"end_header\n") + len(b"end_header\n")
    count = int(re.search(rb"element vertex (\d+)", content)[1])
    vertices = np.frombuffer(content, "<f4", 3 * count, start).reshape(-1, 3)
    start += vertices.nbytes
    (length,) = np.frombuffer(content, "<i4", 1, start)
    indices = np.frombuffer(content, "<i4", length, start + 4)
    parts = []
    for strip in np.split(indices, np.flatnonzero(indices < 0)):
        corners = strip[strip >= 0]
        part = np.stack([corners[:-2], corners[1:-1], corners[2:]], 1)
        part[1::2] = part[1::2][:, [1, 0, 2]]
        parts.append(part)
    triangles = np.concatenate(parts)
    a, b, c = triangles.T
    proper = (a != b) & (b != c) & (a != c)
    return Mesh(vertices, triangles[proper].astype(np.uint32))


def load(name: str, folder: Path) -> Mesh:
    """Load a model with z up."""
    path = folder / FILES[name]
    mesh = (read_strips if path.suffix == ".ply" else read_obj)(path)
    if name in Z_UP:
        return mesh
    x, y, z = mesh.vertices.T
    return Mesh(np.stack([x, -z, y], 1), mesh.triangles)


def looking_at(mesh: Mesh) -> Look:
    """Look at all of a mesh from the front, a little from the right and from above."""
    low, high = mesh.vertices.min(0).astype(np.float64), mesh.vertices.max(0).astype(np.float64)
    centre, diagonal = (low + high) / 2, np.linalg.norm(high - low)
    towards = np.array([0.35, -1, 0.35])
    towards /= np.linalg.norm(towards)
    return Look(
        eye=centre + towards * diagonal * 1.05,
        at=centre,
        up=UP,
        light=centre + np.array([-0.8, -1.2, 1.5]) * diagonal,
        fov=40,
        ortho=diagonal * 0.75,
        ao=0.1 * diagonal,
    )


def noise(side: int, frequency: int, source: np.random.Generator) -> np.ndarray:
    """Make smooth value noise (side, side): random values on a grid, joined by quintic curves."""
    values = source.standard_normal((frequency + 3, frequency + 3))
    place = np.linspace(0, frequency, side, endpoint=False)
    cell = place.astype(int)
    t = place - cell
    t = t * t * t * (t * (6 * t - 15) + 10)
    rows = values[cell] * (1 - t)[:, None] + values[cell + 1] * t[:, None]
    return rows[:, cell] * (1 - t)[None] + rows[:, cell + 1] * t[None]


def terrain() -> tuple[Mesh, Look]:
    """Make a height field of 4.0 million triangles: eight octaves of noise, the low ones ridged."""
    source = np.random.default_rng(7)
    side = 1415
    heights = np.zeros((side, side))
    amplitude = 1.0
    for frequency in (3, 7, 15, 31, 63, 127, 255, 511):
        octave = noise(side, frequency, source)
        heights += amplitude * (octave if frequency > 15 else -2 * np.abs(octave))
        amplitude *= 0.48
    heights = (heights - heights.min()) / (heights.max() - heights.min()) * 14
    along = np.linspace(0, 100, side)
    x, y = np.meshgrid(along, along, indexing="ij")
    vertices = np.stack([x, y, heights], -1).reshape(-1, 3)
    grid = np.arange(side * side).reshape(side, side)
    a, b, c, d = (
        corner.ravel() for corner in (grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:])
    )
    pairs = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)], 1)
    middle = side // 2
    above = heights[middle - 60 : middle + 60, :120].max() + 3.5
    look = Look(
        eye=(50, 2.0, above + 1),
        at=(50, 55, 5),
        up=UP,
        light=(-30, 120, 60),
        fov=60,
        ortho=70,
        ao=2.0,
    )
    return Mesh(vertices, pairs.reshape(-1, 3)), look


#: Tiles along an edge of the terrain.
TILES = 64


def tiles(mesh: Mesh) -> list[Mesh]:
    """Cut the terrain into ``TILES`` x ``TILES`` meshes, each with vertices of its own."""
    places = mesh.vertices[:, :2][mesh.triangles].mean(1) / 100 * TILES
    column, row = np.clip(places.astype(int), 0, TILES - 1).T
    tile = column * TILES + row
    order = np.argsort(tile, kind="stable")
    parts = np.split(mesh.triangles[order], np.searchsorted(tile[order], np.arange(1, TILES**2)))
    used = [np.unique(part, return_inverse=True) for part in parts]
    return [Mesh(mesh.vertices[vertices], local.reshape(-1, 3)) for vertices, local in used]


def turned(source: np.random.Generator, place: np.ndarray) -> np.ndarray:
    """Make the matrix of a random rotation and a move."""
    w, x, y, z = (q := source.standard_normal(4)) / np.linalg.norm(q)
    matrix = np.eye(4, dtype=np.float32)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, 3] = place
    return matrix


def forest(bunny: Mesh) -> tuple[Mesh, list[Placed], Look]:
    """Turn 10,000 instances of a bunny of size one, a little closer than side by side in a cube."""
    source = np.random.default_rng(2)
    count = 10_000
    half = 0.6 * count ** (1 / 3)
    tree = standing(bunny)
    tree = Mesh(tree.vertices - tree.vertices.mean(0), tree.triangles)
    placed = [Placed(0, turned(source, source.uniform(-half, half, 3))) for _ in range(count)]
    look = looking_at(Mesh(np.array([[-half] * 3, [half] * 3]), np.empty((0, 3), int)))
    look.ao = 1.0
    return tree, placed, look


def lathe(source: np.random.Generator) -> Mesh:
    """Turn a random profile around an axis of random direction: prisms, cones, bolts, rings."""
    sides, rings = int(source.integers(3, 40)), int(source.integers(2, 9))
    radii, heights = source.uniform(0.1, 1.0, rings), np.sort(source.uniform(-1, 1, rings))
    if source.random() < 0.7:
        radii[[0, -1]] = 0  # closed
    heights *= np.exp(source.uniform(-2, 1.5))
    angle = np.arange(sides) * 2 * np.pi / sides
    round_ = np.stack([np.cos(angle), np.sin(angle)], -1)
    flat = radii[:, None, None] * round_
    vertices = np.concatenate(
        [flat, np.broadcast_to(heights[:, None, None], (*flat.shape[:2], 1))], 2
    )
    a = np.arange((rings - 1) * sides).reshape(-1, sides)
    b = np.roll(a, -1, 1)
    quads = np.stack([a, b, b + sides, a, b + sides, a + sides], -1)
    spin = turned(source, np.zeros(3))[:3, :3]
    return Mesh(vertices.reshape(-1, 3) @ spin.T, quads.reshape(-1, 3))


def assembly() -> tuple[list[Mesh], list[Placed], np.ndarray, Look]:
    """Heap up 5,000 different things: every tenth a sphere, half of the others moved by a matrix.

    Also returns the spheres (n, 4): centre and radius. No other shape is the same in Embree.
    """
    source = np.random.default_rng(11)
    meshes, placed, spheres = [], [], []
    size = np.array([12.0, 10.0, 4.0])
    for k in range(5000):
        place, scale = source.random(3) * size, 0.04 * np.exp(source.uniform(0, 2))
        if k % 10 == 9:
            spheres.append([*place, scale])
            continue
        part = lathe(source)
        is_moved = k % 2 == 1
        placed.append(Placed(len(meshes), turned(source, place) if is_moved else None))
        meshes.append(Mesh(part.vertices * scale + (0 if is_moved else place), part.triangles))
    look = Look(eye=(-4, -7, 6), at=size / 2, up=UP, light=(-6, -8, 14), fov=50, ortho=11.0, ao=0.5)
    return meshes, placed, np.array(spheres, np.float32), look


@dataclass
class Room:
    """A mesh put together from boxes and from models, each turned by a random angle."""

    models: dict[str, Mesh]
    source: np.random.Generator
    parts: list[Mesh] = field(default_factory=list)
    count: int = 0

    def add(self, vertices: np.ndarray, triangles: np.ndarray) -> None:
        """Add triangles with vertices of their own."""
        indices = (np.asarray(triangles, np.int64) + self.count).astype(np.uint32)
        self.parts.append(Mesh(np.asarray(vertices, np.float32), indices))
        self.count += len(vertices)

    def box(self, low: list[float], high: list[float]) -> None:
        """Add a box between two corners."""
        low, high = np.array(low), np.array(high)
        self.add(low + CORNERS * (high - low), SIDES)

    def table(self, x: float, y: float) -> None:
        """Add a table, 2.4 x 1.2 x 0.8, with its first corner at x and y."""
        width, depth, height = 2.4, 1.2, 0.8
        self.box([x, y, height - 0.05], [x + width, y + depth, height])
        for b in (y + 0.03, y + depth - 0.11):
            for a in (x + 0.03, x + width - 0.11):
                self.box([a, b, 0], [a + 0.08, b + 0.08, height - 0.05])

    def put(self, name: str, size: float, x: float, y: float, z: float = 0.0) -> None:
        """Add a model, its largest side scaled to a size."""
        vertices, triangles = self.models[name]
        angle = self.source.uniform(0, 6.28)
        cosine, sine = np.cos(angle), np.sin(angle)
        turn = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
        self.add(vertices @ turn.T * size + np.array([x, y, z]), triangles)

    def mesh(self) -> Mesh:
        """Return all of it."""
        return Mesh(*(np.concatenate(arrays) for arrays in zip(*self.parts, strict=True)))


def standing(mesh: Mesh) -> Mesh:
    """Move a mesh onto the middle of the ground and scale its largest side to one."""
    vertices = mesh.vertices.astype(np.float64)
    low, high = vertices.min(0), vertices.max(0)
    middle = (low + high) / 2
    foot = np.array([middle[0], middle[1], low[2]])
    return Mesh((vertices - foot) / (high - low).max(), mesh.triangles)


#: The things on the tables, 0.8 high, and on the floor: name, size, x, y.
ON_TABLES = [
    ("igea", 0.9, 4.2, 3.6), ("teapot", 0.4, 3.4, 3.4), ("teapot", 0.3, 5.1, 3.3),
    ("bunny", 0.6, 8.2, 5.6), ("suzanne", 0.4, 7.4, 5.4), ("spot", 0.4, 9, 5.7),
    ("nefertiti", 0.9, 3.2, 7.6), ("cow", 0.6, 2.5, 7.4), ("fandisk", 0.4, 4.1, 7.5),
]  # fmt: skip
ON_FLOOR = [
    ("ogre", 1.8, 10.5, 8.5), ("beast", 1.6, 1.2, 1.6), ("beast", 1.2, 10.8, 2.0),
    ("beast", 1.4, 6, 8.8), ("homer", 1.6, 6.6, 2.2), ("homer", 1.4, 8.8, 8.0),
    ("bunny", 1.0, 5.5, 6.2), ("bunny", 0.7, 9.5, 3.5), ("rocker-arm", 0.8, 1.0, 5.0),
    ("rocker-arm", 0.7, 11.2, 5.5), ("spot", 0.9, 7.8, 3.6), ("cow", 1.2, 4.6, 9.0),
    ("beetle", 2.0, 9.0, 1.2),
]  # fmt: skip
ON_SHELVES = ("teapot", "suzanne", "spot", "fandisk", "cow", "homer")


def interior(models: dict[str, Mesh]) -> tuple[Mesh, Look]:
    """Make a closed room, 12 x 10 x 4, full of models: 1.8 million triangles, seen from inside."""
    room = Room({name: standing(mesh) for name, mesh in models.items()}, np.random.default_rng(5))
    room.box([-0.2, -0.2, -0.2], [12.2, 10.2, 0])
    room.box([-0.2, -0.2, 4], [12.2, 10.2, 4.2])
    room.box([-0.2, -0.2, 0], [0, 10.2, 4])
    room.box([12, -0.2, 0], [12.2, 10.2, 4])
    room.box([0, -0.2, 0], [12, 0, 4])
    room.box([0, 10, 0], [12, 10.2, 4])
    for x, y in ((3, 3), (7, 5), (2, 7)):
        room.table(x, y)
    for model in ON_TABLES:
        room.put(*model, 0.8)
    for model in ON_FLOOR:
        room.put(*model)
    for shelf in range(5):
        z = 0.4 + 0.65 * shelf
        room.box([0, 9.5, z - 0.04], [12, 10, z])
        for place in range(22):
            name = ON_SHELVES[int(room.source.integers(0, len(ON_SHELVES)))]
            room.put(name, 0.4, 0.4 + 0.52 * place, 9.74, z)
    for slat in range(40):
        room.box([0.3 * slat, 9.97, 0], [0.3 * slat + 0.02, 10, 3.4])
    look = Look(
        eye=(5.6, 0.35, 1.7), at=(6.2, 6, 1.1), up=UP, light=(6, 5, 3.7), fov=75, ortho=9.0, ao=0.6
    )
    return room.mesh(), look


#: A storey's rooms along the corridor, on each side of it; their width, depth and height.
ALONG, WIDTH, DEPTH, HEIGHT = 20, 4.0, 5.0, 3.0
#: Half of the corridor's width and of a wall's thickness.
HALF, THIN = 1.0, 0.08


def furnish(room: Room, x: float, y: float) -> None:
    """Put a table, a shelf and small things into the room whose first corner is at x and y."""
    room.table(x + 0.5, y + 1.2)
    for name, size in (("teapot", 0.3), ("suzanne", 0.3), ("fandisk", 0.2)):
        room.put(
            name, size, x + room.source.uniform(0.8, 2.6), y + room.source.uniform(1.4, 2.2), 0.8
        )
    for k in range(4):
        a, b = x + 0.6 + 0.8 * (k % 2), y + 0.6 + 2.0 * (k // 2)
        room.box([a, b, 0.42], [a + 0.42, b + 0.42, 0.46])
        room.box([a, b, 0.46], [a + 0.42, b + 0.03, 0.95])
        for c, d in ((0, 0), (0.39, 0), (0, 0.39), (0.39, 0.39)):
            room.box([a + c, b + d, 0], [a + c + 0.03, b + d + 0.03, 0.42])
    for shelf in range(4):
        z = 0.4 + 0.6 * shelf
        room.box([x + 3.5, y + 0.6, z - 0.03], [x + 3.85, y + 4.4, z])
        for k in range(40):
            b = y + 0.65 + 0.09 * k
            high, deep = room.source.uniform(0.2, 0.5), room.source.uniform(0.15, 0.3)
            room.box([x + 3.5, b, z], [x + 3.5 + deep, b + 0.06, z + high])
    room.put("spot", 0.7, x + 2.0, y + 3.9)


def floor(models: dict[str, Mesh]) -> tuple[Mesh, Look]:
    """Make a storey of 40 rooms with furniture along a corridor, as one mesh, seen from a room."""
    room = Room({name: standing(mesh) for name, mesh in models.items()}, np.random.default_rng(6))
    length, edge = ALONG * WIDTH, HALF + DEPTH
    room.box([-THIN, -edge - THIN, -0.3], [length + THIN, edge + THIN, 0])
    room.box([-THIN, -edge - THIN, HEIGHT], [length + THIN, edge + THIN, HEIGHT + 0.3])
    for x in (0, length):
        room.box([x - THIN, -edge, 0], [x + THIN, edge, HEIGHT])
    for side in (-1, 1):
        wall, outside = side * HALF, side * edge
        room.box([0, outside - THIN, 0], [length, outside + THIN, HEIGHT])
        inner, outer = sorted((wall, outside))
        for k in range(ALONG):
            x = k * WIDTH
            if k > 0:
                room.box([x - THIN, inner, 0], [x + THIN, outer, HEIGHT])
            # A door, one wide and two high.
            for a, b, z in ((0, 2.2, 0), (2.2, 3.2, 2.0), (3.2, WIDTH, 0)):
                room.box([x + a, wall - THIN, z], [x + b, wall + THIN, HEIGHT])
            furnish(room, x, inner)
    return room.mesh(), Look(
        eye=(41.0, 5.6, 1.7),
        at=(43.2, 0, 1.0),
        up=UP,
        light=(42, 3, 2.8),
        fov=75,
        ortho=6.0,
        ao=0.6,
    )


def save_look(folder: Path, name: str, look: Look, what: str) -> None:
    """Write where a scene is looked at from, and say that it is ready."""
    rows = [look.eye, look.at, look.up, look.light, (look.fov, look.ortho, look.ao)]
    text = "".join(" ".join(f"{x:.9g}" for x in row) + "\n" for row in rows)
    (folder / f"{name}.cam").write_text(text)
    print(f"{name}: {what}", flush=True)


def save_assembly(folder: Path) -> None:
    """Write the files of the assembly: its meshes, and the scene with the spheres beside them."""
    meshes, placed, spheres, look = assembly()
    save_objects(folder / "assembly-meshes.glb", meshes, placed)
    objects = ['[[objects]]\nfile = "assembly-meshes.glb"\n']
    for x, y, z, radius in spheres.tolist():
        objects.append(
            f'[[objects]]\nshape = "sphere"\ncenter = [{x}, {y}, {z}]\nradius = {radius}\n'
        )
    (folder / "assembly.toml").write_text("\n".join(objects))
    save_look(folder, "assembly", look, f"{len(placed)} meshes, {len(spheres)} spheres")


def save(folder: Path, name: str, mesh: Mesh, look: Look) -> None:
    """Write the three files of a scene of one mesh."""
    vertices = np.ascontiguousarray(mesh.vertices, np.float32)
    triangles = np.ascontiguousarray(mesh.triangles, np.uint32)
    camera = {key: np.array(value, np.float64) for key, value in vars(look).items()}
    np.savez(folder / f"{name}.npz", v=vertices, f=triangles, **camera)

    faces = np.empty(len(triangles), np.dtype([("count", "u1"), ("indices", "<u4", 3)]))
    faces["count"], faces["indices"] = 3, triangles
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}"]
    header += [f"property float {axis}" for axis in "xyz"]
    header += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    with (folder / f"{name}.ply").open("wb") as file:
        file.write("".join(f"{line}\n" for line in header).encode())
        vertices.tofile(file)
        faces.tofile(file)

    save_look(folder, name, look, f"{len(triangles):,} triangles")


def main() -> int:
    """Make all scenes; return 1 if only those without models could be made."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="where the scenes go")
    parser.add_argument("--models", type=Path, default=MODELS, help="the folder with the models")
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    ground, look = terrain()
    save(given.folder, "terrain", ground, look)
    parts = tiles(ground)
    save_objects(given.folder / "tiles.glb", parts, [Placed(k) for k in range(len(parts))])
    save_look(given.folder, "tiles", look, f"the terrain in {len(parts):,} objects")
    save_assembly(given.folder)
    missing = [file for file in FILES.values() if not (given.models / file).is_file()]
    if missing:
        print(f"The other scenes need these files in {given.models}: {', '.join(missing)}")
        print("They are from alecjacobson/common-3d-test-models: mixed research licences.")
        return 1
    models = {name: load(name, given.models) for name in FILES}
    for name in ALONE:
        save(given.folder, name, models[name], looking_at(models[name]))
    save(given.folder, "interior", *interior(models))
    save(given.folder, "floor", *floor(models))
    bunny, placed, look = forest(models["bunny"])
    save_objects(given.folder / "forest.glb", [bunny], placed)
    save_look(given.folder, "forest", look, f"{len(placed):,} instances of the bunny")
    return 0


if __name__ == "__main__":
    sys.exit(main())
