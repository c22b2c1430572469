"""Shapes as meshes, for formats that have nothing else."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from firsthit._objects.shapes import Box, Cone, Cylinder, Disc, Mesh, Sphere

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit._objects.shapes import Shape

    Floats = npt.NDArray[np.float64]

#: Into so many sides a circle is cut; half of a sphere's meridian into a quarter as many.
SIDES = 64

#: The sides of a box between its corners, which are counted by bits: x, y and z.
_BOX = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]


def tessellated(shape: Shape) -> Mesh | None:
    """Return a shape as a mesh, whose corners are on it; ``None`` where it has no end."""
    if isinstance(shape, Mesh):
        return shape
    if isinstance(shape, Box):
        ends = (np.arange(8)[:, None] >> np.arange(3)) & 1
        return Mesh(np.where(ends == 1, shape.high, shape.low), _BOX)
    if isinstance(shape, Sphere):
        angles = np.linspace(0.0, np.pi, SIDES // 2 + 1)
        rims = [(shape.radius * np.sin(a), -shape.radius * np.cos(a)) for a in angles[1:-1]]
        poles = -shape.radius, shape.radius
        return _turned(shape.center, (0.0, 0.0, 1.0), rims, poles)
    if isinstance(shape, Disc):
        return _turned(shape.center, shape.normal, [(shape.radius, 0.0)], (None, 0.0))
    if isinstance(shape, Cylinder | Cone):
        axis = np.subtract(shape.top, shape.bottom)
        far = float(np.linalg.norm(axis))
        radii = shape.radius, (shape.radius if isinstance(shape, Cylinder) else shape.top_radius)
        rims = [(r, z) for r, z in zip(radii, (0.0, far), strict=True) if r > 0.0]
        return _turned(shape.bottom, axis, rims, (0.0, far))
    return None


def _turned(
    center: npt.ArrayLike,
    axis: npt.ArrayLike,
    rims: list[tuple[float, float]],
    ends: tuple[float | None, float],
) -> Mesh:
    """Return the mesh of rims, each a radius and a height, and of the ends of the axis."""
    w = np.asarray(axis, np.float64)
    w = w / np.linalg.norm(w)
    u = np.cross(w, np.eye(3)[np.abs(w).argmin()])
    u = u / np.linalg.norm(u)
    if np.array_equal(w, (0.0, 0.0, 1.0)):
        # Then the corners include the ends of all axes.
        u = np.array([1.0, 0.0, 0.0])
    v = np.cross(w, u)
    turn = 2.0 * np.pi * np.arange(SIDES) / SIDES
    around = np.cos(turn)[:, None] * u + np.sin(turn)[:, None] * v
    points = [radius * around + height * w for radius, height in rims]
    here = np.arange(SIDES)
    there = (here + 1) % SIDES
    polygons = []
    for k in range(len(rims) - 1):
        a, b = SIDES * k, SIDES * (k + 1)
        polygons += np.stack([a + here, a + there, b + there, b + here], axis=1).tolist()
    count, last = SIDES * len(rims), SIDES * (len(rims) - 1)
    low, high = ends
    if low is not None:
        points.append(low * w[None])
        polygons += [[count, k, j] for j, k in zip(here.tolist(), there.tolist(), strict=True)]
        count += 1
    points.append(high * w[None])
    polygons += [[count, last + j, last + k] for j, k in zip(here, there, strict=True)]
    return Mesh(np.asarray(center, np.float64) + np.concatenate(points), polygons)
