"""Ray and distance queries with the interface of Open3D's ``RaycastingScene``.

>>> import numpy as np
>>> from firsthit.compat.open3d import RaycastingScene
>>> scene = RaycastingScene()
>>> scene.add_triangles(np.float32([[0, 0, 0], [1, 0, 0], [1, 1, 0]]), np.uint32([[0, 1, 2]]))
0
>>> scene.cast_rays(np.float32([[0.5, 0.25, 1, 0, 0, -1]]))["t_hit"]
array([1.], dtype=float32)

Answers are arrays. They are Open3D's tensors where tensors are asked about, or the scene holds a
mesh of Open3D's or one of tensors. Numbers come as float32, as Open3D's do; to rays and points of
float64 they come as float64.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from firsthit._base.arrays import count, threads_or_all
from firsthit._objects.mesh import Mesh
from firsthit._scene.scene import Scene

from ._foreign_meshes import TOUCHING, is_of, unit_normals
from ._pinhole import rays_of_matrices, rays_of_view
from ._tensors import array_of, asked_about, is_tensor, like, or_zero, parts_of

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit._queries.hits import Hits
    from firsthit._queries.of_points import ClosestPoints
    from firsthit.typing import FillRule, MeshLike, TensorMeshLike, TriangleMeshLike

    from ._tensors import Asked, Tensor

#: How many answers about a point and a mesh are held at a time.
_ANSWERS = 1 << 24


class RaycastingScene:
    """Meshes for rays and points, in the words of ``open3d.t.geometry.RaycastingScene``.

    Parameters
    ----------
    nthreads : int
        The number of threads for queries that name none; 0 for all cores.
    device : str or open3d.core.Device
        ``"CPU:0"``: there is no other.
    rule : {"nonzero", "parity"}
        The rule of the inside, see `firsthit.Scene.inside`.

    Raises
    ------
    ValueError
        For another device, and for a number of threads that is negative or above 1024.
    """

    #: The identifier of what there is not.
    INVALID_ID = 2**32 - 1

    def __init__(
        self, nthreads: int = 0, device: object = "CPU:0", *, rule: FillRule = "nonzero"
    ) -> None:
        if not str(device).upper().startswith("CPU"):
            raise ValueError(f"device must be the CPU, got {device}")
        self._nthreads, self._rule = nthreads, rule
        threads_or_all(self._threads(0))
        self._scene = Scene()
        #: Whether anything in it was Open3D's.
        self._is_open3d = False
        #: The normals of the triangles, one mesh after the other, and where each mesh begins.
        self._normals: list[npt.NDArray[np.float64]] = []
        self._firsts = [0]

    @overload
    def add_triangles(
        self, vertex_positions: npt.ArrayLike | Tensor, triangle_indices: npt.ArrayLike | Tensor
    ) -> int: ...

    @overload
    def add_triangles(
        self, vertex_positions: TensorMeshLike | TriangleMeshLike | MeshLike
    ) -> int: ...

    def add_triangles(self, vertex_positions: Any, triangle_indices: Any = None) -> int:
        """Add a mesh.

        Parameters
        ----------
        vertex_positions : (n, 3) array_like or tensor, or a mesh
            The vertices; or a mesh of Open3D's, or anything with ``vertices`` and ``faces``.
        triangle_indices : (m, 3) array_like or tensor of int
            The vertices of each triangle; left out with a mesh.

        Returns
        -------
        int
            The identifier of the mesh; the first has 0.

        Raises
        ------
        ValueError
            For arrays of a wrong shape or type, and for an index without a vertex.
        """
        if triangle_indices is None:
            self._is_open3d |= is_of("open3d", vertex_positions)
            vertex_positions, triangle_indices = parts_of(vertex_positions)
        self._is_open3d |= is_tensor(vertex_positions) or is_tensor(triangle_indices)
        mesh = Mesh(array_of(vertex_positions), array_of(triangle_indices))
        normals = unit_normals(mesh.vertices[mesh.triangles])
        self._normals.append(normals)
        self._firsts.append(self._firsts[-1] + len(normals))
        return self._scene.add(mesh)

    def cast_rays(self, rays: npt.ArrayLike | Tensor, nthreads: int = 0) -> dict[str, Any]:
        """Find the first hit of each ray.

        Parameters
        ----------
        rays : (..., 6) array_like or tensor
            The origin and the direction of each, of any length but zero.
        nthreads : int
            The number of threads; 0 for those of the scene.

        Returns
        -------
        dict of str to array or tensor
            ``t_hit`` (...), in units of the direction's length, infinite where nothing is hit;
            ``geometry_ids`` and ``primitive_ids`` (...) uint32, the mesh and its triangle, or
            `INVALID_ID`; ``primitive_uvs`` (..., 2), the weights of the triangle's second and third
            corner; ``primitive_normals`` (..., 3). The last two are zero where nothing is hit.

        Raises
        ------
        ValueError
            For an array of a wrong shape or type.
        """
        asked = self._asked("rays", rays, 6)
        origins, directions = asked.rays()
        how: dict[str, Any] = {"dtype": asked.dtype, "threads": self._threads(nthreads)}
        hits = self._scene.shoot(origins, directions, t_min=TOUCHING, **how)
        return {"t_hit": asked.number(hits.t), **self._surface(asked, hits)}

    def test_occlusions(
        self,
        rays: npt.ArrayLike | Tensor,
        tnear: float = 0.0,
        tfar: float = math.inf,
        nthreads: int = 0,
    ) -> Any:
        """Tell whether each ray meets anything.

        Parameters
        ----------
        rays, nthreads
            As for `cast_rays`.
        tnear, tfar : float
            The limits of the rays: hits have ``tnear <= t <= tfar``.

        Returns
        -------
        (...) array or tensor of bool
            Whether there is a hit.
        """
        asked, threads = self._asked("rays", rays, 6), self._threads(nthreads)
        least = float(np.nextafter(tnear, -math.inf))
        hides = self._scene.occluded(*asked.rays(), t_min=least, t_max=tfar, threads=threads)
        return asked.answer(hides)

    def count_intersections(self, rays: npt.ArrayLike | Tensor, nthreads: int = 0) -> Any:
        """Count how often each ray crosses a mesh.

        Parameters
        ----------
        rays, nthreads
            As for `cast_rays`.

        Returns
        -------
        (...) array or tensor of int32
            The number of crossings, as `firsthit.Scene.count` tells them.
        """
        asked = self._asked("rays", rays, 6)
        threads = self._threads(nthreads)
        counts = self._scene.count(*asked.rays(), t_min=TOUCHING, threads=threads)
        return asked.answer(counts.astype(np.int32))

    def list_intersections(self, rays: npt.ArrayLike | Tensor, nthreads: int = 0) -> dict[str, Any]:
        """Find every crossing of each ray with a mesh.

        Parameters
        ----------
        rays, nthreads
            As for `cast_rays`.

        Returns
        -------
        dict of str to array or tensor
            Ray by ray, the m crossings of each in order: ``ray_ids`` (m,) uint32, ``t_hit``,
            ``geometry_ids``, ``primitive_ids`` (m,) and ``primitive_uvs`` (m, 2) as of
            `cast_rays`; and ``ray_splits`` (n + 1,) uint32, where those of each of the n rays
            begin, and m.
        """
        asked = self._asked("rays", rays, 6)
        origins, directions = (part.reshape(-1, 3) for part in asked.rays())
        threads = self._threads(nthreads)
        met = self._scene.shoot_all(origins, directions, t_min=TOUCHING, threads=threads)
        return {
            "ray_splits": asked.answer(met.offsets.astype(np.uint32)),
            "ray_ids": asked.answer(met.ray.astype(np.uint32)),
            "t_hit": asked.number(met.t),
            "geometry_ids": asked.identifier(met.object),
            "primitive_ids": asked.identifier(met.primitive),
            "primitive_uvs": asked.number(met.barycentric[..., 1:]),
        }

    def compute_closest_points(
        self, query_points: npt.ArrayLike | Tensor, nthreads: int = 0
    ) -> dict[str, Any]:
        """Find the point of the meshes that is nearest to each point.

        Parameters
        ----------
        query_points : (..., 3) array_like or tensor
            The points.
        nthreads : int
            The number of threads; 0 for those of the scene.

        Returns
        -------
        dict of str to array or tensor
            ``points`` (..., 3); ``geometry_ids``, ``primitive_ids``, ``primitive_uvs`` and
            ``primitive_normals`` as of `cast_rays`. The points are NaN where there are none.

        Raises
        ------
        ValueError
            For an array of a wrong shape or type.
        """
        asked = self._asked("query_points", query_points, 3)
        found = self._scene.closest_point(asked.array, threads=self._threads(nthreads))
        return {"points": asked.number(found.point), **self._surface(asked, found)}

    def compute_distance(self, query_points: npt.ArrayLike | Tensor, nthreads: int = 0) -> Any:
        """Measure how far points are from the nearest mesh.

        Parameters
        ----------
        query_points, nthreads
            As for `compute_closest_points`.

        Returns
        -------
        (...) array or tensor
            The distances, infinite where there is no mesh.
        """
        asked = self._asked("query_points", query_points, 3)
        found = self._scene.closest_point(asked.array, threads=self._threads(nthreads))
        return asked.number(found.distance)

    def compute_signed_distance(
        self, query_points: npt.ArrayLike | Tensor, nthreads: int = 0, nsamples: int = 1
    ) -> Any:
        """Measure how far points are from the nearest mesh, negative inside.

        Parameters
        ----------
        query_points, nthreads, nsamples
            As for `compute_occupancy`.

        Returns
        -------
        (...) array or tensor
            The distances.
        """
        _check_samples(nsamples)
        asked = self._asked("query_points", query_points, 3)
        threads = self._threads(nthreads)
        distance = self._scene.closest_point(asked.array, threads=threads).distance
        inside = self._inside(asked.array, threads)
        return asked.number(np.where(inside & (distance > 0.0), -distance, distance))

    def compute_occupancy(
        self, query_points: npt.ArrayLike | Tensor, nthreads: int = 0, nsamples: int = 1
    ) -> Any:
        """Tell which points are inside, as 1 and 0.

        A point is inside if it is inside an odd number of the meshes: a mesh within another is a
        hollow. The inside of a single mesh is that of `firsthit.Scene.inside`.

        Parameters
        ----------
        query_points, nthreads
            As for `compute_closest_points`.
        nsamples : int
            An odd number, by which Open3D makes errors rarer. Here every number gives the same: one
            ray decides exactly.

        Returns
        -------
        (...) array or tensor
            1 for points inside, 0 for others.

        Raises
        ------
        ValueError
            For an array of a wrong shape or type, and for ``nsamples`` that are not odd.
        """
        _check_samples(nsamples)
        asked = self._asked("query_points", query_points, 3)
        return asked.number(self._inside(asked.array, self._threads(nthreads)))

    @overload
    @staticmethod
    def create_rays_pinhole(
        intrinsic_matrix: npt.ArrayLike | Tensor,
        extrinsic_matrix: npt.ArrayLike | Tensor,
        width_px: int,
        height_px: int,
    ) -> Any: ...

    @overload
    @staticmethod
    def create_rays_pinhole(
        fov_deg: float,
        center: npt.ArrayLike | Tensor,
        eye: npt.ArrayLike | Tensor,
        up: npt.ArrayLike | Tensor,
        width_px: int,
        height_px: int,
    ) -> Any: ...

    @staticmethod
    def create_rays_pinhole(*args: Any, **kwargs: Any) -> Any:
        """Make the rays of a pinhole camera, one through the centre of each pixel.

        It takes ``(intrinsic_matrix, extrinsic_matrix, width_px, height_px)`` or ``(fov_deg,
        center, eye, up, width_px, height_px)``.

        Parameters
        ----------
        intrinsic_matrix : (3, 3) array_like or tensor
            From camera coordinates to pixels: the focal lengths and the principal point.
        extrinsic_matrix : (4, 4) array_like or tensor
            From world to camera coordinates; the camera looks along +z, and y points down.
        fov_deg : float
            The horizontal field of view, in degrees.
        center, eye, up : (3,) array_like or tensor
            Where the camera looks, where it is, and which way is up. As of Open3D, the rows begin
            at the bottom of the view, and the columns at its right.
        width_px, height_px : int
            The size in pixels.

        Returns
        -------
        (height_px, width_px, 6) array of float32, or tensor
            The rays, not of length one: their ``t`` is the depth along the camera's axis.

        Raises
        ------
        TypeError
            For arguments of neither form.
        ValueError
            For arrays of a wrong shape, a field of view that is not between 0 and 180, an ``up``
            along the view, and a matrix that is not invertible.
        """
        plain = [array_of(value) for value in args]
        named = {name: array_of(value) for name, value in kwargs.items()}
        is_view = "fov_deg" in named or (len(plain) > 0 and np.ndim(plain[0]) == 0)
        rays = (rays_of_view if is_view else rays_of_matrices)(*plain, **named)
        tensor = next((v for v in (*args, *kwargs.values()) if is_tensor(v)), None)
        return like(None if tensor is None else tensor.device, rays.astype(np.float32))

    def _threads(self, nthreads: int) -> int | None:
        """Return what ``threads`` of `firsthit.Scene` is to be."""
        return count("nthreads", nthreads) or count("nthreads", self._nthreads) or None

    def _asked(self, name: str, given: Any, columns: int) -> Asked:
        """Return what was asked about, (..., columns)."""
        return asked_about(name, given, columns, wants_tensors=self._is_open3d)

    def _surface(self, asked: Asked, met: Hits | ClosestPoints) -> dict[str, Any]:
        """Return the surfaces of first hits or of closest points; zeros where there are none."""
        weights = or_zero(met.object >= 0, met.barycentric[..., 1:])
        return {
            "geometry_ids": asked.identifier(met.object),
            "primitive_ids": asked.identifier(met.primitive),
            "primitive_uvs": asked.number(weights),
            "primitive_normals": asked.number(self._normals_of(met.object, met.primitive)),
        }

    def _inside(self, points: npt.NDArray[Any], threads: int | None) -> npt.NDArray[np.bool_]:
        flat = points.reshape(-1, 3)
        inside = np.empty(len(flat), np.bool_)
        # There is an answer for each point and mesh.
        step = max(1, _ANSWERS // max(1, len(self._scene.objects)))
        for start in range(0, len(flat), step):
            part = slice(start, start + step)
            by_mesh = self._scene.inside(flat[part], "object", rule=self._rule, threads=threads)
            np.logical_xor.reduce(by_mesh, axis=-1, out=inside[part])
        return inside.reshape(points.shape[:-1])

    def _normals_of(
        self, meshes: npt.NDArray[np.int32], triangles: npt.NDArray[np.int32]
    ) -> npt.NDArray[np.float64]:
        """Return the normals of triangles; zero where there is none."""
        normals = np.zeros((*meshes.shape, 3))
        is_hit = meshes >= 0
        if is_hit.any():
            if len(self._normals) > 1:
                self._normals = [np.concatenate(self._normals)]
            firsts = np.array(self._firsts)
            normals[is_hit] = self._normals[0][firsts[meshes[is_hit]] + triangles[is_hit]]
        return normals


def _check_samples(nsamples: int) -> None:
    if count("nsamples", nsamples) % 2 == 0:
        raise ValueError(f"nsamples must be odd, got {nsamples}")
