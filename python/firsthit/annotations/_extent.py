"""The extent of shapes along directions, exactly: what boxes are made of."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from firsthit._objects.mesh import Mesh
from firsthit._objects.shapes import Box, Cone, Cylinder, Disc, Plane, Sphere

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit._objects.shapes import Shape

    Floats = npt.NDArray[np.float64]


class Corners:
    """The corners of meshes' triangles, each mesh looked up once."""

    def __init__(self) -> None:
        #: The mesh is kept beside its corners, lest another gets its identity.
        self._known: dict[int, tuple[Mesh, Floats]] = {}

    def of(self, mesh: Mesh) -> Floats:
        """Return the vertices that are corners of a triangle, (n, 3), in object space."""
        if id(mesh) not in self._known:
            vertices, triangles = mesh.vertices, mesh.triangles
            is_used = np.zeros(len(vertices), np.bool_)
            is_used[triangles.reshape(-1)] = True
            self._known[id(mesh)] = mesh, vertices[is_used]
        return self._known[id(mesh)][1]


def extent(shape: Shape, directions: Floats, corners: Corners) -> Floats:
    """Return the least and the largest dot product of directions with a shape's points, (2, k).

    Directions, (k, 3), are in object space and of any length. Infinite where a plane has no end,
    and the least is above the largest for a mesh without triangles.
    """
    if isinstance(shape, Mesh):
        points = corners.of(shape)
        if len(points) == 0:
            return np.array([[np.inf], [-np.inf]]) * np.ones(len(directions))
        along = points @ directions.T
        return np.stack((along.min(axis=0), along.max(axis=0)))
    if isinstance(shape, Sphere):
        reach = shape.radius * np.linalg.norm(directions, axis=1)
        return _about(shape.center, reach, directions)
    if isinstance(shape, Box):
        ends = directions * shape.low, directions * shape.high
        return np.stack((np.minimum(*ends).sum(axis=1), np.maximum(*ends).sum(axis=1)))
    if isinstance(shape, Disc):
        return _disc(shape.center, shape.normal, shape.radius, directions)
    if isinstance(shape, Cylinder | Cone):
        axis = np.subtract(shape.top, shape.bottom)
        above = shape.top_radius if isinstance(shape, Cone) else shape.radius
        both = (
            _disc(shape.bottom, axis, shape.radius, directions),
            _disc(shape.top, axis, above, directions),
        )
        return np.stack((np.minimum(both[0][0], both[1][0]), np.maximum(both[0][1], both[1][1])))
    if isinstance(shape, Plane):
        # Along its normal alone it has an end, which rounding hides for all but simple normals.
        across = np.cross(directions, shape.normal)
        at = directions @ shape.point
        is_level = (across == 0.0).all(axis=1)
        return np.stack((np.where(is_level, at, -np.inf), np.where(is_level, at, np.inf)))
    raise TypeError(f"there is no box of {shape!r}")


def _about(center: npt.ArrayLike, reach: Floats, directions: Floats) -> Floats:
    middle = directions @ np.asarray(center, np.float64)
    return np.stack((middle - reach, middle + reach))


def _disc(
    center: npt.ArrayLike, normal: npt.ArrayLike, radius: float, directions: Floats
) -> Floats:
    # The part of a direction in the disc's plane, by a cross product: a difference would cancel.
    axis = np.asarray(normal, np.float64)
    unit = axis / np.linalg.norm(axis)
    return _about(center, radius * np.linalg.norm(np.cross(directions, unit), axis=1), directions)
