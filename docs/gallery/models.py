"""Make the models of docs/gallery.md and other pages: `python models.py FOLDER [flange.stl ...]`.

All of them are formulas: gears, vessels, a shell, mountains, a city, and a studio as a picture
of light. World space has z up; a glTF file turns itself to y up.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from files import Glb, write_ply, write_stl

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

TURN = 2 * np.pi


@dataclass
class Mesh:
    """Triangles or quadrilaterals, and what their vertices have."""

    vertices: np.ndarray
    faces: np.ndarray
    normals: np.ndarray | None = None
    uvs: np.ndarray | None = None
    colors: np.ndarray | None = None

    def triangles(self) -> np.ndarray:
        """Return the faces as triangles, without those that a pole has made a line."""
        fan = [self.faces[:, [0, k, k + 1]] for k in range(1, self.faces.shape[1] - 1)]
        corners = np.concatenate(fan, 1).reshape(-1, 3)
        a, b, c = (self.vertices[corners[:, k]] for k in range(3))
        return corners[np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-12]

    def moved(self, offset: tuple, degrees: float = 0.0) -> Mesh:
        """Return the mesh turned about z, then moved."""
        s, c = np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
        turn = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
        normals = None if self.normals is None else self.normals @ turn
        return Mesh(self.vertices @ turn + offset, self.faces, normals, self.uvs, self.colors)


def joined(meshes: list[Mesh]) -> Mesh:
    """Return one mesh of triangles of several, with their normals if all have some."""
    starts = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    faces = [mesh.triangles() + start for mesh, start in zip(meshes, starts, strict=False)]
    parts = [mesh.normals for mesh in meshes]
    normals = None if any(part is None for part in parts) else np.concatenate(parts)
    return Mesh(np.concatenate([mesh.vertices for mesh in meshes]), np.concatenate(faces), normals)


def smoothed(mesh: Mesh, degrees: float = 30.0) -> Mesh:
    """Return the mesh with normals that are smooth but where faces meet at a larger angle."""
    corners = mesh.triangles()
    places, same = np.unique(np.round(mesh.vertices, 9), axis=0, return_inverse=True)
    a, b, c = (mesh.vertices[corners[:, k]] for k in range(3))
    area = np.cross(b - a, c - a)
    flat = area / np.linalg.norm(area, axis=1, keepdims=True)
    around = [[] for _ in places]
    for face, three in enumerate(same.reshape(-1)[corners]):
        for place in three:
            around[place].append(face)
    normals = np.empty((len(corners), 3, 3))
    for face, three in enumerate(same.reshape(-1)[corners]):
        for k, place in enumerate(three):
            beside = around[place]
            near = flat[beside] @ flat[face] > np.cos(np.radians(degrees))
            normals[face, k] = (area[beside] * near[:, None]).sum(0)
    normals = normals.reshape(-1, 3)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    vertices = mesh.vertices[corners].reshape(-1, 3)
    both, inverse = np.unique(
        np.round(np.hstack([vertices, normals]), 6), axis=0, return_inverse=True
    )
    first = np.zeros(len(both), int)
    first[inverse.reshape(-1)[::-1]] = np.arange(len(vertices))[::-1]
    return Mesh(vertices[first], inverse.reshape(-1, 3), normals[first])


def sheet(points: np.ndarray, *, across: bool = False, along: bool = False) -> Mesh:
    """Return the quadrilaterals of a grid of points, closed `along` its rows and `across` them."""
    rows, columns = points.shape[:2]
    index = np.arange(rows * columns).reshape(rows, columns)
    if across:
        index = np.vstack([index, index[:1]])
    if along:
        index = np.hstack([index, index[:, :1]])
    faces = np.stack([index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]], -1)
    # Normals by central differences, which pass over the seams of closed grids.
    u = np.gradient(np.pad(points, ((0, 0), (1, 1), (0, 0)), "wrap"), axis=1)[:, 1:-1]
    v = np.gradient(np.pad(points, ((1, 1), (0, 0), (0, 0)), "wrap"), axis=0)[1:-1]
    u = u if along else np.gradient(points, axis=1)
    v = v if across else np.gradient(points, axis=0)
    normals = np.cross(u, v).reshape(-1, 3)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return Mesh(points.reshape(-1, 3), faces.reshape(-1, 4), normals / np.where(length, length, 1))


def curve(points: list, steps: int = 12) -> np.ndarray:
    """Return a smooth curve through points (Catmull and Rom 1974)."""
    p = np.array(points, float)
    p = np.vstack([2 * p[0] - p[1], p, 2 * p[-1] - p[-2]])
    t = np.linspace(0, 1, steps, endpoint=False)[:, None]
    powers = np.concatenate([t**0, t, t**2, t**3], 1)
    spline = np.array([[0, 2, 0, 0], [-1, 0, 1, 0], [2, -5, 4, -1], [-1, 3, -3, 1]]) / 2
    parts = [powers @ spline @ p[k : k + 4] for k in range(len(p) - 3)]
    return np.vstack([*parts, p[-2:-1]])


def arc(center: tuple, radius: float, start: float, end: float, steps: int = 16) -> np.ndarray:
    """Return a circle's part in the plane of radius and height, by degrees from outwards."""
    t = np.radians(np.linspace(start, end, steps + 1))
    return np.stack([center[0] + radius * np.cos(t), center[1] + radius * np.sin(t)], -1)


def circle(angles: np.ndarray, radius: float) -> np.ndarray:
    """Return a circle's points at angles."""
    return radius * np.stack([np.cos(angles), np.sin(angles)], -1)


def revolved(profile: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Return the points (n, m, 3) of a profile, (radius, z), at angles."""
    z = np.broadcast_to(profile[:, None, 1:], (len(profile), len(angle), 1))
    return np.concatenate([profile[:, None, :1] * circle(angle, 1), z], -1)


def lathe(profile: list, around: int = 96) -> Mesh:
    """Return the surface that smooth parts of a profile, (radius, z) from below upwards, make."""
    angle, parts, last = np.arange(around) * TURN / around, [], None
    for each in profile:
        part = np.array(each, float)
        part[np.abs(part) < 1e-9] = 0
        # Parts meet exactly, so that nothing is open.
        part[0] = part[0] if last is None else last
        last = part[-1]
        mesh = sheet(revolved(part, angle), along=True)
        # The profile's own normals are right at poles too.
        slope = np.gradient(part, axis=0)
        slope /= np.linalg.norm(slope, axis=1, keepdims=True)
        mesh.normals = revolved(slope[:, ::-1] * [1, -1], angle).reshape(-1, 3)
        parts.append(mesh)
    return joined(parts)


def lines(*points: tuple) -> list:
    """Return the straight parts of a profile."""
    return [list(pair) for pair in pairwise(points)]


def boxes_of(ends: list) -> Mesh:
    """Return boxes, each by its lowest and its highest corner."""
    unit = np.array([[k & 1, k >> 1 & 1, k >> 2] for k in range(8)])
    faces = np.array(
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    )
    low, high = np.split(np.array(ends)[:, None], 2, axis=-1)
    faces = faces + 8 * np.arange(len(low))[:, None, None]
    return Mesh((low + unit * (high - low)).reshape(-1, 3), faces.reshape(-1, 4))


# --- Plates: regions of a plane, each with its own thickness ---


@dataclass
class Plate:
    """Triangles of the plane with heights: a solid between them and their mirror image, or 0."""

    strips: list = field(default_factory=list)

    def strip(self, inner: np.ndarray, outer: np.ndarray, height: float) -> None:
        """Add what is between two closed lines of as many points, counter-clockwise."""
        a, b = np.roll(inner, -1, 0), np.roll(outer, -1, 0)
        halves = np.stack([inner, outer, b], 1), np.stack([inner, b, a], 1)
        self.strips.append((np.concatenate(halves), height))

    def ring_with_holes(
        self, inner: np.ndarray, outer: np.ndarray, height: float, count: int, at: float, r: float
    ) -> None:
        """Add what is between two closed lines, with holes of radius `r` at so many angles."""
        n, side = len(inner) // count, np.linspace(0, 1, 9)[1:-1, None]
        for k in range(count):
            indices = (np.arange(n + 1) - n // 2 + k * n) % len(inner)
            low, high = inner[indices], outer[indices]
            ends = high[-1] + (low[-1] - high[-1]) * side, low[0] + (high[0] - low[0]) * side
            border = np.vstack([high, ends[0], low[::-1], ends[1]])
            center = circle(np.array(TURN * k / count), at)
            away = border - center
            self.strip(
                center + r * away / np.linalg.norm(away, axis=1, keepdims=True), border, height
            )

    def solid(self, floor: float | None = None) -> Mesh:
        """Return the closed surface: from the heights' mirror image, or a level floor."""
        corners, heights, numbers = [], [], {}
        for triangles, height in self.strips:
            for triangle in triangles:
                three = [
                    numbers.setdefault(tuple(np.round(point, 7)), len(numbers))
                    for point in triangle
                ]
                if len(set(three)) == 3:
                    corners.append(three)
                    heights.append(height)
        points = np.array(list(numbers))
        sides = {}
        for three, height in zip(corners, heights, strict=True):
            for a, b in zip(three, [*three[1:], three[0]], strict=True):
                sides.setdefault((a, b), []).append(height)
        vertices, faces = {}, []

        def at(point: int, z: float) -> int:
            return vertices.setdefault((*points[point], z), len(vertices))

        def low(height: float) -> float:
            return -height if floor is None else floor

        for (a, b, c), height in zip(corners, heights, strict=True):
            faces.append([at(a, height), at(b, height), at(c, height)])
            faces.append([at(a, low(height)), at(c, low(height)), at(b, low(height))])
        for (a, b), (height,) in sides.items():
            other = sides.get((b, a))
            walls = [(low(height), height)] if other is None else []
            if other and height > other[0]:
                walls = [(other[0], height), (low(height), low(other[0]))]
            for bottom, top in walls:
                if bottom != top:
                    quad = [at(a, bottom), at(b, bottom), at(b, top), at(a, top)]
                    faces += [quad[:3], [quad[0], quad[2], quad[3]]]
        return Mesh(np.array(list(vertices)), np.array(faces))


def involute(teeth: int, module: float, tip: float, root: float, shrink: float = 0.0) -> np.ndarray:
    """Return the outline of a gear, its first tooth at angle 0, by the involute of 20 degrees."""
    pitch = teeth * module / 2
    base = pitch * np.cos(np.radians(20))
    radii = np.linspace(max(root, base), tip, 7)
    flank = np.arccos(np.minimum(1, base / radii))
    half = TURN / 4 / teeth - shrink + np.tan(np.radians(20)) - np.radians(20)
    half = half - (np.tan(flank) - flank)
    radii, half = np.append(root, radii), np.append(half[0] + 0.02 * TURN / teeth, half)
    tooth = np.concatenate([-half, np.linspace(-half[-1], half[-1], 4)[1:-1], half[::-1]])
    height = np.concatenate([radii, [tip] * 2, radii[::-1]])
    gap = np.linspace(half[0], TURN / teeth - half[0], 4)[1:-1]
    tooth, height = np.append(tooth, gap), np.append(height, [root] * 2)
    angles = (tooth + np.arange(teeth)[:, None] * TURN / teeth).reshape(-1)
    return np.stack([np.tile(height, teeth), angles], -1)


def gear(teeth: int, module: float, thickness: float, bore: float) -> Mesh:
    """Return a gear with a hub, a thinner web and a rim."""
    pitch = teeth * module / 2
    radius, angle = involute(teeth, module, pitch + module, pitch - 1.25 * module, shrink=0.002).T
    plate, rim, hub = Plate(), pitch - 2.6 * module, bore * 1.7
    plate.strip(circle(angle, rim), radius[:, None] * circle(angle, 1), thickness / 2)
    plate.strip(circle(angle, hub), circle(angle, rim), thickness * 0.3)
    plate.strip(circle(angle, bore), circle(angle, hub), thickness * 0.62)
    return plate.solid()


def flange() -> Mesh:
    """Return a round plate with a boss, a groove, and bolt holes in two circles."""
    angle = np.arange(288) * TURN / 288
    plate = Plate()
    plate.strip(circle(angle, 14), circle(angle, 22), 34)
    plate.strip(circle(angle, 22), circle(angle, 26), 20)
    plate.ring_with_holes(circle(angle, 26), circle(angle, 38), 20, 12, 32, 3.2)
    plate.strip(circle(angle, 38), circle(angle, 43), 9)
    wavy = 66 + 7 * np.cos(6 * angle) ** 3 * (np.cos(6 * angle) > 0)
    plate.ring_with_holes(circle(angle, 43), wavy[:, None] * circle(angle, 1), 14, 6, 58.5, 5.5)
    return plate.solid(floor=0)


# --- Things ---


def knot(p: int = 2, q: int = 3, tube: float = 0.42, along: int = 360, around: int = 32) -> Mesh:
    """Return a torus knot of quadrilaterals."""
    t = np.arange(along) * TURN / along
    r = 2 + np.cos(q * t)
    middle = np.stack([r * np.cos(p * t), r * np.sin(p * t), np.sin(q * t)], -1)
    tangent = np.roll(middle, -1, 0) - np.roll(middle, 1, 0)
    side = np.cross(tangent, middle * [1, 1, 0] - [0, 0, 3])
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    up = np.cross(side, tangent)
    up /= np.linalg.norm(up, axis=1, keepdims=True)
    s = (np.arange(around) * TURN / around)[:, None]
    points = middle[:, None] + tube * (np.cos(s) * up[:, None] + np.sin(s) * side[:, None])
    return sheet(points, across=True, along=True)


def shell(along: int = 900, around: int = 72) -> Mesh:
    """Return a snail's shell with ribs: circles that grow along a spiral (Thompson 1917)."""
    turns = np.linspace(-10.0, 0, along)[:, None]
    size = np.exp(0.36 * turns)
    s = (np.arange(around) * TURN / around)[None]
    rib = 1 + 0.045 * np.cos(TURN * turns * 13) + 0.012 * np.cos(s * 24)
    across, up = 0.98 + rib * np.cos(s), rib * np.sin(s) * 1.15
    angle = TURN * turns
    points = np.stack(
        [size * across * np.cos(angle), size * across * np.sin(angle), size * (up - 3.15) + 4.2], -1
    )
    mesh = sheet(points, along=True)
    band = 0.5 + 0.5 * np.cos(3 * s + 0.6 * np.sin(TURN * turns * 5))
    stain = (0.5 + 0.5 * np.cos(TURN * turns * 13)) * 0.35 + 0.65 * band**2
    light, dark = np.array([0.99, 0.93, 0.82]), np.array([0.72, 0.36, 0.22])
    stain = 0.9 * np.broadcast_to(stain, points.shape[:2])[..., None]
    mesh.colors = (light + (dark - light) * stain).reshape(-1, 3)
    return mesh


def noise(x: np.ndarray, y: np.ndarray, seed: int) -> np.ndarray:
    """Return smooth noise from -1 to 1 (Perlin 1985), by hashes of a grid."""
    i, j = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    fx, fy = x - i, y - j

    def corner(di: int, dj: int) -> np.ndarray:
        h = ((i + di) * 374761393 + (j + dj) * 668265263 + seed * 1442695041) & 0xFFFFFFFF
        h = ((h ^ (h >> 13)) * 1274126177) & 0xFFFFFFFF
        angle = ((h ^ (h >> 16)) & 0xFFFF) * (TURN / 65536)
        return np.cos(angle) * (fx - di) + np.sin(angle) * (fy - dj)

    u, v = (f**3 * (f * (6 * f - 15) + 10) for f in (fx, fy))
    low = corner(0, 0) + u * (corner(1, 0) - corner(0, 0))
    high = corner(0, 1) + u * (corner(1, 1) - corner(0, 1))
    return (low + v * (high - low)) * 1.5


def island(side: int = 360) -> Mesh:
    """Return mountains in the sea, with a level water surface and colours by height and slope."""
    x, y = np.meshgrid(*2 * [np.linspace(-1, 1, side)], indexing="xy")
    wx, wy = x + 0.16 * noise(2 * x, 2 * y, 11), y + 0.16 * noise(2 * x, 2 * y, 12)
    height, weight, total = np.zeros_like(x), 1.0, 0.0
    shape = np.ones_like(x)
    for octave in range(8):
        f = 1.7 * 2.03**octave
        ridge = (1 - np.abs(noise(f * wx + 7, f * wy + 3, octave))) ** 2
        height += weight * ridge * shape
        shape = np.clip(ridge * 1.2, 0, 1)
        total += weight
        weight *= 0.48
    height = height / total
    far = np.sqrt(x * x * 0.92 + y * y) + 0.14 * noise(3 * x, 3 * y, 21)
    rise = np.clip(1.12 - far, 0, 1)
    height = (height * 1.25 - 0.2) * rise**0.85 * 0.62 - 0.085
    water = height < 0
    z = np.where(water, 0, height)
    step = 2 / (side - 1)
    gy, gx = np.gradient(z, step)
    slope = np.hypot(gx, gy)
    rough = 0.5 + 0.5 * noise(14 * x, 14 * y, 31)
    color = np.empty((*x.shape, 3))
    color[:] = (0.52, 0.47, 0.43)  # rock
    color[(slope < 0.75 + 0.35 * rough)] = (0.34, 0.42, 0.22)  # grass
    color[(slope < 0.7) & (z < 0.07 + 0.09 * rough)] = (0.20, 0.36, 0.18)  # wood
    color[(z > 0.21 + 0.07 * rough) & (slope < 1.5)] = (0.95, 0.96, 0.98)  # snow
    color[(z < 0.008) & (slope < 0.9)] = (0.80, 0.72, 0.54)  # sand
    border = (np.maximum(np.abs(x), np.abs(y)) - 0.8) / 0.15
    depth = np.clip(np.maximum(-height / 0.08, border), 0, 1)[..., None]
    color = np.where(
        water[..., None],
        [0.16, 0.50, 0.55] + ([0.03, 0.16, 0.30] - np.array([0.16, 0.50, 0.55])) * depth**0.6,
        color,
    )
    mesh = sheet(np.stack([x, y, z], -1))
    mesh.colors = color.reshape(-1, 3)
    return mesh


def city(side: int = 30) -> Mesh:
    """Return houses along streets, taller towards the middle, each with steps."""
    random = np.random.RandomState(7)
    boxes = []
    for i in range(-side, side):
        for j in range(-side, side):
            if i % 6 == 0 or j % 5 == 0:
                continue
            middle = np.exp(-(i * i + j * j) / 190.0)
            tall = 0.8 + random.gamma(2.0, 0.7) + random.gamma(1.3, 4.2) * middle
            low, half, center = 0.0, 0.46, np.array([i, j])
            for _ in range(1 + (tall > 4) + (tall > 8)):
                top = low + (tall - low) * random.uniform(0.55, 0.9) if tall - low > 3 else tall
                boxes.append((*(center - half), low, *(center + half), top))
                low, half = top, half * random.uniform(0.55, 0.8)
            boxes.append((*(center - half * 0.5), low, *(center + half * 0.5), low + tall * 0.06))
    boxes.append((-side, -side, -0.5, side, side, 0.0))
    return boxes_of(boxes)


# --- Chess ---


def base(width: float) -> list:
    """Return the foot of a piece, up to its collar."""
    return [
        [(0, 0), (width * 0.98, 0)],
        arc((width * 0.93, 0.07), width * 0.07, -90, 90),
        curve([(width * 0.93, 0.14), (width * 0.86, 0.19), (width * 0.84, 0.26)]),
        arc((width * 0.8, 0.32), 0.06, -80, 90),
    ]


def stem(width: float, neck: float, height: float) -> list:
    """Return the hollow curve from the foot to the collar, and the collar."""
    w = width * 0.72
    return [
        curve(
            [
                (width * 0.8, 0.38),
                (w * 0.86, 0.46),
                ((w + neck) * 0.44, 0.46 + (height - 0.46) * 0.35),
                (neck, height),
            ],
            20,
        ),
        [(neck, height), (neck * 1.62, height + 0.03)],
        arc((neck * 1.62, height + 0.07), 0.04, -90, 90),
        [(neck * 1.62, height + 0.11), (neck * 1.1, height + 0.15)],
    ]


def pawn() -> Mesh:
    """Return a pawn."""
    return lathe([*base(0.4), *stem(0.4, 0.13, 0.86), arc((0, 1.19), 0.235, -52, 90, 32)])


def bishop() -> Mesh:
    """Return a bishop."""
    head = curve([(0.14, 1.33), (0.245, 1.49), (0.235, 1.68), (0.13, 1.88), (0.05, 1.97)], 16)
    return lathe([*base(0.44), *stem(0.44, 0.13, 1.18), head, arc((0, 2.03), 0.075, -50, 90)])


def rook() -> Mesh:
    """Return a rook."""
    tower = curve([(0.36, 0.38), (0.30, 0.5), (0.255, 0.75), (0.25, 1.05)], 16)
    top = lines((0.25, 1.05), (0.33, 1.11), (0.345, 1.36), (0.235, 1.36), (0.235, 1.24), (0, 1.24))
    parts = [lathe([*base(0.45), tower, *top])]
    angle = np.linspace(0, TURN / 6 * 0.68, 10)
    rim = np.concatenate([circle(angle, 0.345), circle(angle[::-1], 0.235)])
    inside = rim * 0.999 + 0.001 * rim.mean(0)
    for k in range(6):
        plate = Plate()
        middle = np.broadcast_to(rim.mean(0), rim.shape)
        plate.strip(middle, inside, 1.46)
        plate.strip(inside, rim, 1.46)
        parts.append(smoothed(plate.solid(floor=1.3)).moved((0, 0, 0), 60 * k))
    return joined(parts)


def queen() -> Mesh:
    """Return a queen."""
    angle = np.arange(96) * TURN / 96
    head = [
        curve([(0.15, 1.55), (0.17, 1.7), (0.22, 1.86), (0.31, 2.02)], 14),
        lines((0.31, 2.02), (0.27, 2.04))[0],
        curve([(0.27, 2.04), (0.2, 2.0), (0.13, 2.04)]),
        arc((0, 2.12), 0.1, -40, 90),
    ]
    mesh = lathe([*base(0.48), *stem(0.48, 0.145, 1.4), *head])
    pearls = [
        lathe([arc((0, 0), 0.045, -90, 90)], 24).moved((0.29 * np.cos(a), 0.29 * np.sin(a), 2.05))
        for a in angle[::8]
    ]
    return joined([mesh, *pearls])


def king() -> Mesh:
    """Return a king."""
    head = [
        curve([(0.16, 1.65), (0.18, 1.8), (0.24, 1.98), (0.3, 2.1)], 14),
        curve([(0.3, 2.1), (0.26, 2.17), (0.14, 2.22), (0.07, 2.24)]),
    ]
    cross = [(-0.045, -0.045, 2.2, 0.045, 0.045, 2.52), (-0.13, -0.04, 2.32, 0.13, 0.04, 2.41)]
    bars = [smoothed(boxes_of([ends])) for ends in cross]
    return joined([lathe([*base(0.5), *stem(0.5, 0.155, 1.5), *head]), *bars])


# --- Vessels ---


def goblet() -> Mesh:
    """Return a wine glass, a closed solid."""
    bowl = [(0.26, 1.43), (0.49, 1.65), (0.57, 1.98), (0.525, 2.32), (0.45, 2.66)]
    outside = curve([(0.055, 1.2), (0.1, 1.34), *bowl], 14)
    hollow = [(0.0, 1.42), (0.22, 1.46), (0.45, 1.66), (0.53, 1.98), (0.49, 2.32), (0.415, 2.66)]
    foot = [(0.55, 0.05), (0.3, 0.09), (0.1, 0.16), (0.055, 0.3), (0.05, 0.7), (0.055, 1.2)]
    rim, lip = arc((0.55, 0.025), 0.025, -90, 90, 8), arc((0.4325, 2.66), 0.0175, 0, 180, 8)
    inside = curve(hollow, 14)[::-1]
    return lathe([[(0, 0), (0.55, 0)], rim, curve(foot, 14), outside, lip, inside], 128)


def wine() -> Mesh:
    """Return what is in the goblet, with a little air around it: media do not overlap."""
    side = curve([(0.0, 1.425), (0.216, 1.464), (0.446, 1.664), (0.526, 1.97)], 14)
    return lathe([side, [(0.526, 1.97), (0, 1.97)]], 128)


def vase() -> list[Mesh]:
    """Return a vase's outside, with texture coordinates around and upwards, and its inside."""
    belly = [(0.42, 0.0), (0.5, 0.06), (0.86, 0.62), (0.92, 1.02), (0.7, 1.5), (0.36, 1.86)]
    outside = curve([*belly, (0.31, 2.1), (0.46, 2.38)], 20)
    length = np.append(0, np.cumsum(np.linalg.norm(np.diff(outside, axis=0), axis=1)))
    angle = np.linspace(0, TURN, 145)
    body = sheet(revolved(outside, angle))
    around = np.broadcast_arrays(angle / TURN, 1 - length[:, None] / length[-1])
    body.uvs = np.stack(around, -1).reshape(-1, 2)
    hollow = [(0.42, 2.38), (0.28, 2.1), (0.33, 1.84), (0.6, 1.5), (0.8, 1.0), (0.4, 0.1)]
    return [body, lathe([arc((0.44, 2.38), 0.02, 0, 180, 8), curve([*hollow, (0.0, 0.08)])], 144)]


# --- Files with looks ---


def write_gearbox(path: Path) -> None:
    """Write a planetary gear: a sun of 18 teeth, three planets of 18 and a ring of 54."""
    glb, module = Glb(), 0.1
    steel = glb.material("steel", (0.62, 0.63, 0.66), 1, 0.32)
    brass = glb.material("brass", (0.89, 0.68, 0.32), 1, 0.28)
    dark = glb.material("blackened steel", (0.26, 0.27, 0.30), 1, 0.4)
    paint = glb.material("paint", (0.02, 0.12, 0.24), 0, 0.35)
    glb.put("sun", glb.mesh(smoothed(gear(18, module, 0.5, 0.2)), steel))
    planet = glb.mesh(smoothed(gear(18, module, 0.5, 0.2)), brass)
    pin = glb.mesh(
        lathe(lines((0, -0.62), (0.19, -0.62), (0.19, 0.42), (0.16, 0.45), (0, 0.45))), steel
    )
    for k in range(3):
        a = k * TURN / 3
        place = (1.8 * np.cos(a), 1.8 * np.sin(a), 0)
        glb.put(f"planet {k + 1}", planet, place, 10)
        glb.put(f"pin {k + 1}", pin, place)
    radius, angle = involute(54, module, 2.7 + 1.25 * module, 2.7 - module).T
    ring, turned = Plate(), angle + TURN / 108
    ring.strip(radius[:, None] * circle(turned, 1), circle(turned, 2.95), 0.3)
    ring.ring_with_holes(circle(turned, 2.95), circle(turned, 3.35), 0.3, 12, 3.15, 0.1)
    glb.put("ring", glb.mesh(smoothed(ring.solid()), dark))
    plate, angle = Plate(), np.arange(288) * TURN / 288
    plate.strip(circle(angle, 0.16), circle(angle, 0.6), 0.09)
    wavy = 1.75 + 0.5 * np.cos(3 * angle)
    plate.ring_with_holes(circle(angle, 0.6), wavy[:, None] * circle(angle, 1), 0.09, 3, 1.25, 0.34)
    glb.put("carrier", glb.mesh(smoothed(plate.solid()), dark), (0, 0, -0.52), 0)
    shaft = lines((0, -0.4), (0.2, -0.4), (0.2, 1.15), (0.16, 1.2), (0, 1.2))
    glb.put("shaft", glb.mesh(lathe(shaft), steel))
    cup = [(0, -0.95), (3.35, -0.95), (3.35, -0.3), (3.05, -0.3), (3.05, -0.75), (0, -0.75)]
    lid = [(0.3, 0.62), (0.3, 0.42), (3.05, 0.42), (3.05, 0.3), (3.35, 0.3), (3.35, 0.55)]
    lid += [(0.6, 0.62), (0.6, 0.8), (0.3, 0.8), (0.3, 0.62)]
    glb.put("cup", glb.mesh(lathe(lines(*cup), 144), paint))
    glb.put("lid", glb.mesh(lathe(lines(*lid), 144), paint))
    glb.write(path)


def write_balls(path: Path) -> None:
    """Write three rows of balls: copper, steel and red plastic, from smooth to rough."""
    glb = Glb()
    ball = lathe([arc((0, 0), 0.46, -90, 90, 48)], 96)
    rows = [((0.98, 0.60, 0.42), 1), ((0.55, 0.60, 0.66), 1), ((0.72, 0.06, 0.04), 0)]
    for row, (color, metallic) in enumerate(rows):
        for column in range(7):
            roughness = column / 6
            material = glb.material(
                f"{'metal' if metallic else 'plastic'} {roughness:.2f}", color, metallic, roughness
            )
            glb.put(f"ball {row}-{column}", glb.mesh(ball, material), (column - 3, 0, 1 - row))
    glb.write(path)


def bumps(height: np.ndarray) -> np.ndarray:
    """Return the normal map of heights that repeat, in texels."""
    gy, gx = np.gradient(np.pad(height, 1, "wrap"))
    normal = np.stack([-gx[1:-1, 1:-1], gy[1:-1, 1:-1], np.ones_like(height)], -1)
    return normal / np.linalg.norm(normal, axis=-1, keepdims=True) * 0.5 + 0.5


def tiles(size: int = 768) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return colours, occlusion with roughness and metal, and normals of glazed stars."""
    v, u = (np.mgrid[:size, :size] + 0.5) / size
    x, y = (u * 12) % 1 - 0.5, (v * 9) % 1 - 0.5
    square = np.maximum(np.abs(x), np.abs(y))
    turned = (np.abs(x) + np.abs(y)) * 0.5**0.5
    star = np.minimum(square, turned) - 0.36  # below 0 inside of the star of two squares
    small = np.abs(np.maximum(0.5 - np.abs(x), 0.5 - np.abs(y))) - 0.12
    inner = np.maximum(square, turned) - 0.2
    line = np.min(np.abs([star, small, inner]), axis=0)
    gold = np.clip((0.03 - line) / 0.012, 0, 1)[..., None]
    which = np.where(inner < 0, 2, np.where(star < 0, 0, np.where(small < 0, 3, 1)))
    blue, white, teal, green = (5, 20, 45), (93, 91, 84), (10, 52, 55), (5, 36, 42)
    paint = np.array([blue, white, teal, green])[which] / 100
    speck = 0.06 * noise(u * 60, v * 45, 5)[..., None] + 0.05 * noise(u * 12, v * 9, 6)[..., None]
    color = (paint * (1 + speck)) * (1 - gold) + np.array([0.96, 0.78, 0.42]) * gold
    height = np.clip((line - 0.02) / 0.05, 0, 1) ** 0.5 * 1.0 - 0.15 * gold[..., 0]
    height = height + 0.05 * noise(u * 30, v * 24, 8)
    rough = np.where(gold[..., 0] > 0.5, 0.3, 0.12 + 0.5 * np.clip(0.04 - line, 0, 1) * 8)
    packed = np.stack([np.clip(0.55 + line * 7, 0, 1), rough, gold[..., 0]], -1)
    return color, packed, bumps(2.2 * height)


def planks(size: int = 768) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return colours, roughness and normals of oak planks."""
    v, u = (np.mgrid[:size, :size] + 0.5) / size
    row = np.floor(v * 6)
    along = u * 2 + (row * 0.37) % 1
    plank = np.floor(along) % 2 + row * 7
    tone = 0.82 + 0.26 * np.sin(plank * 12.9898) ** 2
    grain = noise(along * 5 + plank * 3, v * 90 + 0.6 * noise(u * 6, v * 12, 41), 42)
    vein = noise(along * 3 + plank, v * 34 + 1.4 * noise(u * 4, v * 8, 43), 44)
    seam = np.minimum(np.abs((v * 6) % 1 - 0.5) - 0.485, 1) > 0
    seam |= np.abs(along % 1 - 0.5) > 0.4965
    color = np.array([0.62, 0.43, 0.27]) * (tone + 0.10 * grain + 0.13 * vein)[..., None]
    color = np.where(seam[..., None], color * 0.35, color)
    height = 0.25 * grain - 2.0 * seam
    packed = np.stack([np.ones_like(u), 0.42 + 0.12 * grain + 0.3 * seam, np.zeros_like(u)], -1)
    return color, packed, bumps(height)


def write_vase(path: Path) -> None:
    """Write a vase of glazed tiles on oak planks: every texture of glTF's core but emission."""
    glb = Glb()

    def textured(name: str, textures: tuple, **more: object) -> int:
        slots = ("baseColorTexture", "metallicRoughnessTexture", "normalTexture")
        for slot, pixels in zip(slots, textures, strict=True):
            more[slot] = glb.texture(pixels)
        return glb.material(name, (1, 1, 1), 1, 1, **more)

    body, inside = vase()
    glazed = textured("tiles", tiles(), occlusionTexture={"index": 1})
    glb.put("vase", glb.mesh(body, glazed))
    glb.put("inside", glb.mesh(inside, glb.material("glaze", (0.03, 0.16, 0.2), 0, 0.15)))
    corners = np.array([[-60, -60, 0], [60, -60, 0], [-60, 60, 0], [60, 60, 0]], float)
    floor = sheet(corners.reshape(2, 2, 3))
    floor.uvs = floor.vertices[:, :2] * [0.28, -0.28]
    glb.put("floor", glb.mesh(floor, textured("oak", planks())))
    glb.write(path)


def write_extensions(path: Path) -> None:
    """Write four balls on stands: a clear coat, cloth, glass with a volume, and a lamp."""
    glb = Glb()
    lower, upper = arc((0, 1.12), 0.62, -90, 20, 40), arc((0, 1.12), 0.62, 27, 90, 30)
    groove = lines(lower[-1], (0.5, 1.33), (0.5, 1.40), upper[0])
    ball = lathe([lower, *groove, upper])
    stand = lathe(
        [
            [(0, 0), (0.5, 0)],
            arc((0.5, 0.06), 0.06, -90, 90),
            curve([(0.5, 0.12), (0.36, 0.17), (0.3, 0.32), (0.38, 0.56)]),
            [(0.38, 0.56), (0.0, 0.5)],
        ]
    )
    black = glb.mesh(stand, glb.material("stand", (0.05, 0.05, 0.055), 0, 0.4))
    coat = {"clearcoatFactor": 1.0, "clearcoatRoughnessFactor": 0.03}
    sheen = {"sheenColorFactor": [0.75, 0.72, 1.0], "sheenRoughnessFactor": 0.4}
    green = {"attenuationColor": [0.1, 0.75, 0.42], "attenuationDistance": 0.9}
    clear = {
        "KHR_materials_transmission": {"transmissionFactor": 1.0},
        "KHR_materials_ior": {"ior": 1.5},
        "KHR_materials_volume": {"thicknessFactor": 1.0, **green},
    }
    strength = {"KHR_materials_emissive_strength": {"emissiveStrength": 1.6}}
    kinds = [
        glb.material("coat", (0.62, 0.02, 0.03), 0.75, 0.5, KHR_materials_clearcoat=coat),
        glb.material("cloth", (0.04, 0.03, 0.22), 0, 1, KHR_materials_sheen=sheen),
        glb.material("glass", (1, 1, 1), 0, 0, **clear),
        glb.material("lamp", (0.2, 0.2, 0.2), 0, 0.6, emissiveFactor=[1, 0.5, 0.16], **strength),
    ]
    for k, material in enumerate(kinds):
        place = (1.5 * (k - 1.5), 0.2 * (k - 1.5) ** 2 - 0.5, 0)
        glb.put(glb.tree["materials"][material]["name"], glb.mesh(ball, material), place)
        glb.put(f"stand {k + 1}", black, place)
    glb.write(path)


def write_studio(path: Path, width: int = 512) -> None:
    """Write a studio as light from all around: a window, a strip and panels."""
    height = width // 2
    latitude = (0.5 - (np.arange(height) + 0.5) / height)[:, None] * 180
    longitude = ((np.arange(width) + 0.5) / width - 0.5)[None] * 360
    above = np.clip(latitude / 90, 0, 1)[..., None]
    light = np.where(above > 0, 0.32, 0.2) * np.array([0.9, 0.95, 1.05]) + 0.1 * above**2
    light = np.repeat(light, width, 1)

    def panel(east: float, up: float, wide: float, tall: float, color: tuple) -> None:
        away = np.abs((longitude - east + 180) % 360 - 180), np.abs(latitude - up)
        inside = [
            np.clip((size / 2 - x) / 3, 0, 1) for size, x in zip((wide, tall), away, strict=True)
        ]
        light[:] += (inside[0] * inside[1])[..., None] * np.array(color)

    for k in range(2):  # a window of two by two panes
        for j in range(2):
            panel(-68 + 44 * k, 24 + 33 * j, 41, 30, (3.0, 2.9, 2.75))
    panel(75, 22, 16, 66, (3.2, 3.5, 4.0))
    panel(165, 30, 60, 26, (2.4, 2.0, 1.6))
    light += np.clip((latitude - 72) / 6, 0, 1)[..., None] * np.array([3.0, 3.0, 3.0])
    largest = light.max(-1)
    mantissa, exponent = np.frexp(largest)
    scale = np.where(largest > 1e-9, mantissa * 256 / np.maximum(largest, 1e-9), 0)
    rows = np.concatenate([light * scale[..., None], (exponent + 128)[..., None]], -1).astype("u1")
    header = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n"
    path.write_bytes(header.encode() + rows.tobytes())


def write_sphereflake(path: Path, levels: int = 4) -> None:
    """Write a sphereflake (Haines 1987) as scene file: nine mirrors on each, a third as large."""
    spheres = []

    def grow(center: np.ndarray, axis: np.ndarray, radius: float, level: int) -> None:
        spheres.append((center, radius, level))
        if level + 1 == levels:
            return
        side = np.cross(axis, [0.3, 0.8, 0.5])
        side /= np.linalg.norm(side)
        other = np.cross(axis, side)
        for count, tilt, start in ((6, 90.0, 0.0), (3, 35.3, 0.5)):
            for k in range(count):
                a, t = (k + start) * TURN / count, np.radians(tilt)
                out = np.sin(t) * (np.cos(a) * side + np.sin(a) * other) + np.cos(t) * axis
                grow(center + out * radius * 4 / 3, out, radius / 3, level + 1)

    grow(np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.0, 1.0]), 1.0, 0)
    text = [
        f"""[[objects]]
shape = "sphere"
center = {[round(float(x), 6) for x in center]}
radius = {radius:.6f}
color = {"[0.96, 0.80, 0.50]" if level % 2 else "[0.93, 0.94, 0.96]"}
material = {{ kind = "metal-rough", metallic = 1, roughness = 0 }}
"""
        for center, radius, level in spheres
    ]
    path.write_text("\n".join([SPHEREFLAKE, *text]))


SPHEREFLAKE = """\
[camera]
position = [1.5, -6.4, 2.5]
look_at = [0.3, 0, 1.05]
fov = 31

[[objects]]
file = "board.obj"

[[objects]]
shape = "sphere"
center = [1.95, -0.9, 0.6]
radius = 0.6
material = { kind = "glass", ior = 1.5, absorption = [0.5, 0.12, 0.08] }

[[lights]]
kind = "directional"
direction = [0.6, 0.5, -1]
color = [0.8, 0.78, 0.72]

[sky]
horizon = "#dce9f2"
zenith = "#4d86b8"

[shading]
shader = "whitted"
"""


def write_board(folder: Path) -> None:
    """Write a chequered board as OBJ, eight by eight and 1.2 wide each, with its library."""
    (folder / "board.mtl").write_text(
        "newmtl light\nKd 0.86 0.80 0.68\nPr 0.7\nPm 0\n"
        "newmtl dark\nKd 0.10 0.075 0.06\nPr 0.7\nPm 0\n"
        "newmtl edge\nKd 0.17 0.08 0.04\nPr 0.8\nPm 0\n"
    )
    text, step = ["mtllib board.mtl"], 1.2
    for i in range(9):
        text += [f"v {step * (j - 4):.1f} {step * (i - 4):.1f} 0" for j in range(9)]
    for k, name in enumerate(("light", "dark")):
        text += ["o squares", f"usemtl {name}"]
        for i in range(8):
            text += [
                f"f {9 * i + j + 1} {9 * i + j + 2} {9 * i + j + 11} {9 * i + j + 10}"
                for j in range(8)
                if (i + j) % 2 == k
            ]
    inner, outer = 4 * step, 4 * step + 0.5
    for r, z in ((inner, 0), (outer, 0), (outer, -0.3)):
        text += [f"v {x * r:.1f} {y * r:.1f} {z}" for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    text += ["o edge", "usemtl edge"]
    for ring in (82, 86):
        text += [
            f"f {ring + k} {ring + 4 + k} {ring + 4 + (k + 1) % 4} {ring + (k + 1) % 4}"
            for k in range(4)
        ]
    (folder / "board.obj").write_text("\n".join(text) + "\n")


def hoop() -> Mesh:
    """Return a flat ring with rounded edges."""

    def side(r: float, z: float, start: float) -> np.ndarray:
        return arc((r, z), 0.04, start, start + 90, 8)

    corners = [side(2.2, -0.16, -90), side(2.2, 0.16, 0), side(1.75, 0.16, 90)]
    corners.append(side(1.75, -0.16, 180))
    profile = []
    for this, following in zip(corners, [*corners[1:], corners[0]], strict=True):
        profile += [this, [this[-1], following[0]]]
    return lathe(profile, 192)


def main(folder: Path, only: Collection[str] = ()) -> None:
    """Write all models, or those that are named."""

    def ply(model: Callable[[], Mesh]) -> Callable[[Path], None]:
        return lambda path: write_ply(path, model())

    pieces = (pawn, rook, bishop, queen, king)
    models: dict[str, Callable[[Path], None]] = {
        "flange.stl": lambda path: write_stl(path, flange()),
        "knot.ply": ply(knot),
        "net.ply": ply(lambda: knot(3, 4, 0.34, 150, 12)),
        "shell.ply": ply(shell),
        "island.ply": ply(island),
        "city.ply": ply(city),
        **{f"{piece.__name__}.ply": ply(piece) for piece in pieces},
        "goblet.ply": ply(goblet),
        "wine.ply": ply(wine),
        "gearbox.glb": write_gearbox,
        "balls.glb": write_balls,
        "vase.glb": write_vase,
        "extensions.glb": write_extensions,
        "studio.hdr": write_studio,
        "hoop.ply": ply(hoop),
        "board.obj": lambda path: write_board(path.parent),
        "sphereflake.toml": write_sphereflake,
    }
    folder.mkdir(parents=True, exist_ok=True)
    for name in only or models:
        models[name](folder / name)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
