"""Ray and distance queries with the interface of trimesh's, for its meshes and others.

>>> import numpy as np
>>> from firsthit.compat.trimesh import RayMeshIntersector
>>> class Square:
...     vertices = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
...     faces = np.array([[0, 1, 2], [0, 2, 3]])
>>> rays = RayMeshIntersector(Square())
>>> rays.intersects_first([[0.7, 0.2, 1], [5, 5, 1]], [[0, 0, -1], [0, 0, -1]])
array([ 0, -1])

For a ``trimesh.Trimesh`` it takes the place of ``mesh.ray``, and `ProximityQuery` that of
``mesh.nearest``: ``mesh.ray = RayMeshIntersector(mesh)``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np

from firsthit._base.arrays import numbers

from ._foreign_meshes import TOUCHING, unit_normals
from ._kept import Kept, surface, vertices_alone

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit._queries.of_points import ClosestPoints
    from firsthit.typing import FillRule, MeshLike

    Indices = npt.NDArray[np.int64]
    Floats = npt.NDArray[np.float64]

__all__ = ["ProximityQuery", "RayMeshIntersector", "closest_point", "signed_distance"]

#: Points as near as this to the surface are inside for trimesh, whose ``tol.merge`` it is.
_ON_SURFACE = 1e-8

#: Faces whose distances differ by no more than this part of them count as equally near.
_EQUALLY_NEAR = 1e-8

#: Among so many of them the one that faces the point is looked for.
_MOST_NEAR = 16


class RayMeshIntersector:
    """Ray queries of one mesh, in the words of ``trimesh.ray``.

    Parameters
    ----------
    mesh : trimesh.Trimesh, or anything with ``vertices`` and ``faces``
        It may be changed later: it is asked before each query whether it is still the same.
    scale_to_box : bool
        Taken for code that was written for trimesh's Embree, and without effect: everything is
        computed in float64, so that no mesh need be scaled.
    rule : {"nonzero", "parity"}
        The rule of the inside, see `firsthit.Scene.inside`.
    """

    def __init__(
        self, mesh: MeshLike, scale_to_box: bool = True, *, rule: FillRule = "nonzero"
    ) -> None:
        self.mesh, self._scale_to_box, self._rule = mesh, scale_to_box, rule
        self._kept = Kept(mesh, surface)

    @overload
    def intersects_id(
        self,
        ray_origins: npt.ArrayLike,
        ray_directions: npt.ArrayLike,
        return_locations: Literal[False] = False,
        multiple_hits: bool = True,
        max_hits: int | None = None,
    ) -> tuple[Indices, Indices]: ...

    @overload
    def intersects_id(
        self,
        ray_origins: npt.ArrayLike,
        ray_directions: npt.ArrayLike,
        return_locations: Literal[True],
        multiple_hits: bool = True,
        max_hits: int | None = None,
    ) -> tuple[Indices, Indices, Floats]: ...

    def intersects_id(
        self,
        ray_origins: npt.ArrayLike,
        ray_directions: npt.ArrayLike,
        return_locations: bool = False,
        multiple_hits: bool = True,
        max_hits: int | None = None,
    ) -> tuple[Indices, Indices] | tuple[Indices, Indices, Floats]:
        """Find the faces that rays meet.

        Parameters
        ----------
        ray_origins, ray_directions : (n, 3) array_like
            The rays. Directions have any length but zero.
        return_locations : bool
            Whether to return the points, too.
        multiple_hits : bool
            Whether all hits of a ray are wanted, or the first.
        max_hits : int, optional
            The most hits of a ray where several are wanted; all if left out.

        Returns
        -------
        index_tri : (m,) array of int64
            The faces, ray by ray and along each ray.
        index_ray : (m,) array of int64
            The ray of each.
        locations : (m, 3) array of float64
            Only with ``return_locations``: the points, on the faces.

        Raises
        ------
        ValueError
            For arrays of a wrong shape or type, and a ``max_hits`` that is not positive.
        """
        origins, directions = _rays(ray_origins, ray_directions)
        scene = self._kept.scene()
        if not multiple_hits:
            first = scene.shoot(origins, directions, t_min=TOUCHING)
            index_ray = np.flatnonzero(first.object >= 0)
            hits = first[index_ray]
        elif max_hits is None:
            crossed = scene.shoot_all(origins, directions, t_min=TOUCHING)
            index_ray, hits = crossed.ray.copy(), crossed.hits
        else:
            nearest = scene.shoot_all(origins, directions, max_hits, t_min=TOUCHING)
            index_ray, column = np.nonzero(nearest.object >= 0)
            hits = nearest[index_ray, column]
        index_tri = hits.primitive.astype(np.int64)
        if return_locations:
            return index_tri, index_ray, hits.position.copy()
        return index_tri, index_ray

    def intersects_location(
        self,
        ray_origins: npt.ArrayLike,
        ray_directions: npt.ArrayLike,
        multiple_hits: bool = True,
        max_hits: int | None = None,
    ) -> tuple[Floats, Indices, Indices]:
        """Find the points where rays meet the mesh.

        Parameters
        ----------
        ray_origins, ray_directions, multiple_hits, max_hits
            As for `intersects_id`.

        Returns
        -------
        locations : (m, 3) array of float64
            The points, ray by ray and along each ray.
        index_ray, index_tri : (m,) array of int64
            The ray and the face of each.
        """
        index_tri, index_ray, locations = self.intersects_id(
            ray_origins,
            ray_directions,
            return_locations=True,
            multiple_hits=multiple_hits,
            max_hits=max_hits,
        )
        return locations, index_ray, index_tri

    def intersects_first(
        self, ray_origins: npt.ArrayLike, ray_directions: npt.ArrayLike
    ) -> Indices:
        """Find the first face that each ray meets.

        Parameters
        ----------
        ray_origins, ray_directions : (n, 3) array_like
            As for `intersects_id`.

        Returns
        -------
        (n,) array of int64
            The faces; -1 for a ray that meets none.
        """
        origins, directions = _rays(ray_origins, ray_directions)
        hits = self._kept.scene().shoot(origins, directions, t_min=TOUCHING)
        return hits.primitive.astype(np.int64)

    def intersects_any(
        self, ray_origins: npt.ArrayLike, ray_directions: npt.ArrayLike
    ) -> npt.NDArray[np.bool_]:
        """Tell whether each ray meets the mesh.

        Parameters
        ----------
        ray_origins, ray_directions : (n, 3) array_like
            As for `intersects_id`.

        Returns
        -------
        (n,) array of bool
            Whether there is a hit.
        """
        origins, directions = _rays(ray_origins, ray_directions)
        return self._kept.scene().occluded(origins, directions, t_min=TOUCHING)

    def contains_points(self, points: npt.ArrayLike) -> npt.NDArray[np.bool_]:
        """Tell which points are inside the mesh, as `firsthit.Scene.inside` does.

        Parameters
        ----------
        points : (n, 3) array_like
            The points.

        Returns
        -------
        (n,) array of bool
            Whether each is inside: exactly if the mesh is closed, else by its winding number.
        """
        return self._kept.scene().inside(_points(points), rule=self._rule)


class ProximityQuery:
    """Nearest-point queries of one mesh, in the words of ``trimesh.proximity``.

    Parameters
    ----------
    mesh : trimesh.Trimesh, or anything with ``vertices`` and ``faces``
        It may be changed later: it is asked before each query whether it is still the same.
    rule : {"nonzero", "parity"}
        The rule of the inside, see `firsthit.Scene.inside`.
    """

    def __init__(self, mesh: MeshLike, *, rule: FillRule = "nonzero") -> None:
        self._mesh, self._rule = mesh, rule
        self._kept = Kept(mesh, surface)
        self._kept_vertices = Kept(mesh, vertices_alone)

    def on_surface(self, points: npt.ArrayLike) -> tuple[Floats, Floats, Indices]:
        """Find the point of the mesh that is nearest to each point.

        Parameters
        ----------
        points : (n, 3) array_like
            The points.

        Returns
        -------
        closest : (n, 3) array of float64
            The nearest points.
        distance : (n,) array of float64
            How far away they are.
        triangle_id : (n,) array of int64
            Their faces. Of several at the same distance, up to one part in 10^8, it is the one that
            faces the point most: at an edge the point is in front of that face or behind it as it
            is outside of the mesh or inside.
        """
        asked = _points(points)
        scene = self._kept.scene()
        found = scene.closest_point(asked, k=2)
        closest, distance = found.point[:, 0].copy(), found.distance[:, 0].copy()
        triangle_id = found.primitive[:, 0].astype(np.int64)
        several = _are_equally_near(found.distance)[:, 1]
        if several.any():
            some = asked[several]
            found = scene.closest_point(some, k=_MOST_NEAR)
            rows = np.arange(len(some)), _facing(self._mesh, some, found)
            closest[several], distance[several] = found.point[rows], found.distance[rows]
            triangle_id[several] = found.primitive[rows]
        return closest, distance, triangle_id

    def vertex(self, points: npt.ArrayLike) -> tuple[Any, Any]:
        """Find the vertex that is nearest to each point.

        Parameters
        ----------
        points : (..., 3) array_like
            The points.

        Returns
        -------
        distance : (...) array of float64
            How far away the vertices are.
        vertex_id : (...) array of int64
            The vertices, also those that no face has; of several at the same distance the lowest.
        """
        found = self._kept_vertices.scene().closest_point(points)
        return found.distance[()], found.primitive.astype(np.int64)[()]

    def signed_distance(self, points: npt.ArrayLike) -> Floats:
        """Measure how far points are from the surface, positive inside.

        Parameters
        ----------
        points : (n, 3) array_like
            The points.

        Returns
        -------
        (n,) array of float64
            The distances: positive for points inside the mesh, and for those within 1e-8 of its
            surface; negative for those outside. The inside is that of
            `RayMeshIntersector.contains_points`.
        """
        asked = _points(points)
        scene = self._kept.scene()
        distance = scene.closest_point(asked).distance
        is_positive = (distance <= _ON_SURFACE) | scene.inside(asked, rule=self._rule)
        return np.where(is_positive, distance, -distance)


def closest_point(mesh: MeshLike, points: npt.ArrayLike) -> tuple[Floats, Floats, Indices]:
    """Find the point of a mesh that is nearest to each point; see `ProximityQuery.on_surface`.

    A mesh whose ``nearest`` is a `ProximityQuery` keeps its trees for the next call.
    """
    return _query(mesh).on_surface(points)


def signed_distance(mesh: MeshLike, points: npt.ArrayLike) -> Floats:
    """Measure how far points are from a mesh; see `ProximityQuery.signed_distance`.

    A mesh whose ``nearest`` is a `ProximityQuery` keeps its trees for the next call.
    """
    return _query(mesh).signed_distance(points)


def _query(mesh: MeshLike) -> ProximityQuery:
    own = getattr(mesh, "nearest", None)
    return own if isinstance(own, ProximityQuery) else ProximityQuery(mesh)


def _are_equally_near(distances: Floats) -> npt.NDArray[np.bool_]:
    """Tell which of the nearest (n, k) are as near as the first, which has to be away."""
    first = distances[:, :1]
    is_apart = (first > 0.0) & np.isfinite(first)
    return is_apart & (distances <= first * (1.0 + _EQUALLY_NEAR))


def _facing(mesh: MeshLike, points: Floats, found: ClosestPoints) -> npt.NDArray[np.intp]:
    """Return which of the equally near faces (n, k) faces each point most."""
    corners = np.asarray(mesh.vertices, np.float64)[np.asarray(mesh.faces)[found.primitive]]
    away = (points[:, None] - found.point) / found.distance[..., None]
    cosines = np.einsum("nki,nki->nk", unit_normals(corners), away)
    is_near = _are_equally_near(found.distance)
    best: npt.NDArray[np.intp] = np.where(is_near, cosines, -np.inf).argmax(axis=1)
    return best


def _rays(origins: npt.ArrayLike, directions: npt.ArrayLike) -> tuple[Floats, Floats]:
    """Return rays, both (n, 3)."""
    start, way = _points(origins, "ray_origins"), _points(directions, "ray_directions")
    if start.shape != way.shape:
        raise ValueError(
            "ray_origins and ray_directions must have the same shape, "
            f"got {start.shape} and {way.shape}"
        )
    return start, way


def _points(points: npt.ArrayLike, name: str = "points") -> Floats:
    """Return points, (n, 3)."""
    array = numbers(name, points)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name} must have the shape (n, 3), got {array.shape}")
    return np.asarray(array, np.float64)
