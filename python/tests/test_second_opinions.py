"""Other programs on the same rays: differences only next to an edge."""

import firsthit as fh
import numpy as np
import pytest
from support import bumpy_sphere

trimesh = pytest.importorskip("trimesh")


def rays(n):
    rng = np.random.default_rng(9)
    origins = rng.normal(size=(n, 3))
    origins *= 3 / np.linalg.norm(origins, axis=1, keepdims=True)
    return origins, rng.uniform(-1.2, 1.2, (n, 3)) - origins


def distance_to_an_edge(points, triangles, primitive, position):
    corners = points[triangles[primitive]].astype(float)
    a, b = corners, np.roll(corners, -1, axis=1)
    along = np.einsum("nkc,nkc->nk", position[:, None] - a, b - a)
    along = np.clip(along / np.einsum("nkc,nkc->nk", b - a, b - a), 0, 1)
    return np.linalg.norm(position[:, None] - a - along[..., None] * (b - a), axis=-1).min(1)


def test_embree_agrees_away_from_edges():
    pytest.importorskip("embreex")
    from embreex import rtcore_scene
    from embreex.mesh_construction import TriangleMesh

    points, triangles = bumpy_sphere(40, 2)
    origins, directions = rays(100_000)
    scene = fh.Scene()
    scene.add(fh.Mesh(points, triangles))
    hits = scene.shoot(origins, directions)

    embree = rtcore_scene.EmbreeScene()
    TriangleMesh(embree, points[triangles])
    theirs = embree.run(origins.astype("f4"), directions.astype("f4"), query="INTERSECT")
    differ = np.flatnonzero(hits.primitive != theirs)
    assert len(differ) < 100
    hit = differ[hits.primitive[differ] >= 0]
    near = distance_to_an_edge(points, triangles, hits.primitive[hit], hits.position[hit])
    assert (near < 1e-5).all()


def test_trimesh_agrees_on_where_rays_hit():
    points, triangles = bumpy_sphere(8, 4)
    mesh = trimesh.Trimesh(points, triangles, process=False)
    origins, directions = rays(400)
    scene = fh.Scene()
    scene.add(mesh)
    hits = scene.shoot(origins, directions)
    from trimesh.ray.ray_triangle import RayMeshIntersector

    where, which, _ = RayMeshIntersector(mesh).intersects_location(origins, directions)
    distance = np.linalg.norm(where - origins[which], axis=1) / np.linalg.norm(
        directions[which], axis=1
    )
    first = np.full(len(origins), np.inf)
    np.minimum.at(first, which, distance)
    np.testing.assert_allclose(hits.t, first, rtol=1e-6)
