"""The drop-in replacements by themselves, against closed forms."""

import copy
import importlib.util
import pickle

import firsthit as fh
import numpy as np
import pytest
from firsthit.compat.open3d import RaycastingScene
from firsthit.compat.trimesh import (
    ProximityQuery,
    RayMeshIntersector,
    closest_point,
    signed_distance,
)
from support import bumpy_sphere, output

#: The cube from -1 to 1: its faces 2k and 2k + 1 are the side k of -x, +x, -y, +y, -z, +z.
CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float64)
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
FACES = np.array([t for a, b, c, d in SIDES for t in ((a, b, c), (a, c, d))])


class Thing:
    """A mesh of no package."""

    def __init__(self, vertices=CORNERS, faces=FACES):
        self.vertices, self.faces = np.array(vertices), np.array(faces)


def sides(faces):
    return np.asarray(faces) // 2


def test_meshes_that_know_their_vertices_later_are_taken():
    class Late:
        @property
        def vertices(self):
            return np.eye(3) * self.size

        @property
        def faces(self):
            return np.array([[0, 1, 2]])

    mesh = Late()
    queries = RayMeshIntersector(mesh)
    mesh.size = 3.0
    assert queries.intersects_any([[0, 0, 0]], [[1, 1, 1]]).tolist() == [True]
    with pytest.raises(TypeError, match="mesh must have vertices and faces, got a dict"):
        RayMeshIntersector({})


def test_neither_peer_is_imported():
    words = output(
        "sys.modules['trimesh'] = sys.modules['open3d'] = None\n"
        "import firsthit.compat.trimesh, firsthit.compat.open3d\n"
        "print('imported')"
    )
    assert words == ["imported"]


class TestTrimesh:
    """The words of ``trimesh.ray`` and ``trimesh.proximity``."""

    @pytest.fixture
    def rays(self):
        return RayMeshIntersector(Thing())

    @pytest.fixture
    def query(self):
        return ProximityQuery(Thing())

    def test_hits_come_ray_by_ray_and_along_each(self, rays):
        origins, along = (
            [[0.3, 0.2, 5], [9, 9, 9], [-5, 0.1, 0.4]],
            [[0, 0, -2], [0, 0, 1], [1, 0, 0]],
        )
        face, ray, where = rays.intersects_id(origins, along, return_locations=True)
        assert ray.tolist() == [0, 0, 2, 2]
        assert sides(face).tolist() == [5, 4, 0, 1]
        # Places are means of corners, off by a few roundings of numbers below 1.
        places = [[0.3, 0.2, 1], [0.3, 0.2, -1], [-1, 0.1, 0.4], [1, 0.1, 0.4]]
        assert np.allclose(where, places, rtol=0, atol=1e-15)
        assert (face.dtype, ray.dtype, where.dtype) == (np.int64, np.int64, np.float64)
        again = rays.intersects_location(origins, along)
        assert [part.tolist() for part in again] == [where.tolist(), ray.tolist(), face.tolist()]
        assert len(rays.intersects_id(origins, along)) == 2

    def test_the_first_hits_are_one_of_each_ray(self, rays):
        origins, along = (
            [[0.3, 0.2, 5], [9, 9, 9], [0, 0.1, 0.4]],
            [[0, 0, -2], [0, 0, 1], [1, 0, 0]],
        )
        face, ray = rays.intersects_id(origins, along, multiple_hits=False)
        assert ray.tolist() == [0, 2]
        assert sides(face).tolist() == [5, 1]
        first = rays.intersects_first(origins, along)
        assert first.tolist() == [face[0], -1, face[1]]
        assert rays.intersects_any(origins, along).tolist() == [True, False, True]

    def test_max_hits_ends_each_ray(self, rays):
        origins, along = [[0.3, 0.2, 5]] * 2, [[0, 0, -1], [0, 0, 1]]
        face, ray = rays.intersects_id(origins, along, max_hits=1)
        assert (sides(face).tolist(), ray.tolist()) == ([5], [0])
        assert len(rays.intersects_id(origins, along, max_hits=9)[0]) == 2

    def test_a_surface_at_the_origin_counts_and_what_is_behind_does_not(self, rays):
        face, _ray = rays.intersects_id([[0.3, 0.2, 1]], [[0, 0, -1]])
        assert sides(face).tolist() == [5, 4]
        assert sides(rays.intersects_first([[0.3, 0.2, 1]], [[0, 0, 1]])).tolist() == [5]
        assert rays.intersects_any([[0.3, 0.2, 1 + 1e-15]], [[0, 0, 1]]).tolist() == [False]

    def test_corners_and_edges_are_crossed_once(self, rays):
        middles = (CORNERS[FACES] + CORNERS[np.roll(FACES, 1, axis=1)]).reshape(-1, 3) / 2
        ends = np.vstack([CORNERS, middles])
        _face, ray = rays.intersects_id(np.zeros_like(ends), ends)
        assert np.bincount(ray, minlength=len(ends)).tolist() == [1] * len(ends)

    def test_no_hits_and_no_rays_have_the_types_of_hits(self, rays):
        for origins, along in [([[0, 0, 9]], [[0, 0, 1]]), (np.zeros((0, 3)), np.zeros((0, 3)))]:
            face, ray, where = rays.intersects_id(origins, along, return_locations=True)
            assert (face.shape, ray.shape, where.shape) == ((0,), (0,), (0, 3))
            assert (face.dtype, ray.dtype, where.dtype) == (np.int64, np.int64, np.float64)

    def test_a_changed_mesh_gives_new_answers(self):
        mesh = Thing()
        rays, query = RayMeshIntersector(mesh), ProximityQuery(mesh)
        ask = [[0, 0.1, 5]], [[0, 0, -1]]
        assert rays.intersects_location(*ask)[0][0, 2] == 1
        assert query.vertex([[2, 2, 2]])[0].tolist() == [np.sqrt(3)]
        mesh.vertices *= 2
        assert rays.intersects_location(*ask)[0][0, 2] == 2
        assert query.vertex([[2, 2, 2]])[0].tolist() == [0]
        assert query.on_surface([[0, 0.1, 5]])[1].tolist() == [3]

    def test_points_inside_and_outside(self, rays):
        inside = rays.contains_points([[0, 0, 0], [0.99, -0.99, 0.5], [1.01, 0, 0], [9, 9, 9]])
        assert inside.tolist() == [True, True, False, False]
        assert inside.dtype == np.bool_

    def test_distances_are_positive_inside(self, query):
        points = [[0, 0, 0.75], [0, 0, 3], [3, 3, 1], [1, 0.3, 0.2], [0, 0, 1 + 1e-9]]
        distances = query.signed_distance(points)
        assert distances[:4].tolist() == [0.25, -2, -np.sqrt(8), 0]
        # Within trimesh's tolerance of the surface.
        assert 0 < distances[4] < 2e-9
        assert signed_distance(Thing(), points).tolist() == distances.tolist()

    def test_the_face_at_an_edge_is_the_one_that_faces_the_point(self, query):
        # Nearest to all of them is the edge at x = z = 1.
        points = np.array([[2, 0.5, 1 + 1e-3], [1 + 1e-3, 0.5, 2]])
        closest, distance, face = query.on_surface(points)
        assert closest.tolist() == [[1, 0.5, 1]] * 2
        assert np.allclose(distance, np.hypot(1, 1e-3), rtol=1e-15)
        assert sides(face).tolist() == [1, 5]
        assert closest_point(Thing(), points)[2].tolist() == face.tolist()
        # At a corner, with six or fewer faces: those of the side that it faces most.
        assert sides(query.on_surface([[1.1, 1.2, 1.1]])[2]).tolist() == [3]

    def test_the_nearest_vertex_is_that_of_all_vertices(self):
        vertices, faces = bumpy_sphere(12, 3)
        vertices = np.vstack([vertices, [[4, 0, 0]]])
        query = ProximityQuery(Thing(vertices, faces))
        points = np.random.default_rng(5).uniform(-3, 5, (500, 3))
        all_of_them = np.linalg.norm(points[:, None] - vertices, axis=2)
        distance, vertex = query.vertex(points)
        assert vertex.tolist() == all_of_them.argmin(axis=1).tolist()
        assert len(vertices) - 1 in vertex
        assert np.allclose(distance, all_of_them.min(axis=1), rtol=1e-15)
        assert query.vertex(points[0]) == (distance[0], vertex[0])

    def test_a_mesh_without_faces_meets_nothing(self):
        nothing = Thing(np.zeros((0, 3)), np.zeros((0, 3), int))
        assert RayMeshIntersector(nothing).intersects_first([[0, 0, 0]], [[0, 0, 1]]).tolist() == [
            -1
        ]
        closest, distance, face = ProximityQuery(nothing).on_surface([[0, 0, 0]])
        assert np.isnan(closest).all()
        assert (distance.tolist(), face.tolist()) == ([np.inf], [-1])

    def test_copies_answer_alike(self, rays, query):
        ask = [[0.3, 0.2, 5]], [[0, 0, -1]]
        rays.intersects_first(*ask)
        for twin in (copy.copy(rays), copy.deepcopy(rays), pickle.loads(pickle.dumps(rays))):
            assert twin.intersects_first(*ask).tolist() == rays.intersects_first(*ask).tolist()
        twin = pickle.loads(pickle.dumps(query))
        assert twin.on_surface([[0, 0, 5]])[1].tolist() == [4]

    def test_a_mesh_that_carries_them_is_unpickled(self):
        things = [Thing()]
        if peer := importlib.util.find_spec("trimesh") and importlib.import_module("trimesh"):
            things.append(peer.Trimesh(CORNERS, FACES, process=False))
        for thing in things:
            thing.ray, thing.nearest = RayMeshIntersector(thing), ProximityQuery(thing)
            assert thing.ray.intersects_first([[0.3, 0.2, 5]], [[0, 0, -1]]) // 2 == [5]
            assert thing.nearest.on_surface([[0, 0, 5]])[1].tolist() == [4]
            twin = pickle.loads(pickle.dumps(thing))
            assert twin.ray.mesh is twin
            assert twin.ray.intersects_first([[0.3, 0.2, 5]], [[0, 0, -1]]) // 2 == [5]
            assert twin.nearest.on_surface([[0, 0, 5]])[1].tolist() == [4]

    @pytest.mark.parametrize(
        ("origins", "along", "said"),
        [
            ([0, 0, 0], [[0, 0, 1]], r"ray_origins must have the shape \(n, 3\), got \(3,\)"),
            ([[0, 0, 0]], [[0, 0]], r"ray_directions must have the shape \(n, 3\), got \(1, 2\)"),
            ([[0, 0, 0]], [[0, 0, 1]] * 2, r"same shape, got \(1, 3\) and \(2, 3\)"),
        ],
    )
    def test_rays_of_a_wrong_shape_are_refused(self, rays, origins, along, said):
        for ask in (rays.intersects_id, rays.intersects_first, rays.intersects_any):
            with pytest.raises(ValueError, match=said):
                ask(origins, along)

    def test_points_of_a_wrong_shape_are_refused(self, rays, query):
        for ask in (rays.contains_points, query.on_surface, query.signed_distance):
            with pytest.raises(ValueError, match=r"points must have the shape \(n, 3\)"):
                ask([0, 0, 0])


def test_what_is_inside_is_the_same_whatever_is_asked_at_a_time(monkeypatch):
    scene = RaycastingScene()
    for size in (1, 2, 3):
        scene.add_triangles(CORNERS * size, FACES)
    asked = np.random.default_rng(1).uniform(-4, 4, (7, 11, 3)).astype(np.float32)
    largest = np.abs(asked).max(axis=-1)
    expected = (largest < 1) | ((largest > 2) & (largest < 3))
    for at_once in (1, 10, 1 << 24):
        monkeypatch.setattr("firsthit.compat.open3d._ANSWERS", at_once)
        np.testing.assert_array_equal(scene.compute_occupancy(asked), expected)
    assert scene.compute_occupancy(np.zeros((0, 3), np.float32)).shape == (0,)


class TestOpen3D:
    """The words of ``open3d.t.geometry.RaycastingScene``."""

    @pytest.fixture
    def scene(self):
        made = RaycastingScene()
        assert made.add_triangles(CORNERS, FACES) == 0
        assert made.add_triangles(Thing(CORNERS * 3)) == 1
        return made

    RAYS = np.float32([[0.25, 0.5, 9, 0, 0, -2], [0.25, 0.5, 2, 0, 0, -2], [9, 9, 9, 0, 0, 1]])

    def test_first_hits(self, scene):
        met = scene.cast_rays(self.RAYS)
        assert met["t_hit"].tolist() == [3, 0.5, np.inf]
        assert met["geometry_ids"].tolist() == [1, 0, 2**32 - 1]
        assert sides(met["primitive_ids"]).tolist()[:2] == [5, 5]
        assert met["primitive_ids"][2] == RaycastingScene.INVALID_ID
        assert met["primitive_normals"].tolist() == [[0, 0, 1], [0, 0, 1], [0, 0, 0]]
        for k, size in [(0, 3), (1, 1)]:
            a, b, c = CORNERS[FACES[met["primitive_ids"][k]]] * size
            u, v = met["primitive_uvs"][k]
            place = (1 - u - v) * a + u * b + v * c
            assert np.allclose(place[:2], [0.25, 0.5], atol=1e-6)
        assert met["primitive_uvs"][2].tolist() == [0, 0]
        types = {name: values.dtype for name, values in met.items()}
        single, whole = np.dtype(np.float32), np.dtype(np.uint32)
        assert types == {
            "t_hit": single,
            "geometry_ids": whole,
            "primitive_ids": whole,
            "primitive_uvs": single,
            "primitive_normals": single,
        }

    def test_every_crossing(self, scene):
        met = scene.list_intersections(self.RAYS)
        assert met["ray_splits"].tolist() == [0, 4, 7, 7]
        assert met["ray_ids"].tolist() == [0, 0, 0, 0, 1, 1, 1]
        assert met["t_hit"].tolist() == [3, 4, 5, 6, 0.5, 1.5, 2.5]
        assert met["geometry_ids"].tolist() == [1, 0, 0, 1, 0, 0, 1]
        assert sides(met["primitive_ids"]).tolist() == [5, 5, 4, 4, 5, 4, 4]
        assert met["primitive_uvs"].shape == (7, 2)
        counts = scene.count_intersections(self.RAYS)
        assert (counts.tolist(), counts.dtype) == ([4, 3, 0], np.int32)

    def test_occlusions_have_both_limits_included(self, scene):
        assert scene.test_occlusions(self.RAYS).tolist() == [True, True, False]
        assert scene.test_occlusions(self.RAYS, tnear=6).tolist() == [True, False, False]
        assert scene.test_occlusions(self.RAYS, tnear=6.0000005).tolist() == [False] * 3
        assert scene.test_occlusions(self.RAYS, tfar=3).tolist() == [True, True, False]
        assert scene.test_occlusions(self.RAYS, 0, 0.4).tolist() == [False] * 3
        assert scene.cast_rays(np.float32([[0, 0.5, 3, 0, 0, -1]]))["t_hit"].tolist() == [0]

    def test_nearest_points(self, scene):
        points = np.float32([[0.25, 0.5, 1.25], [0.25, 0.5, 2.5]])
        met = scene.compute_closest_points(points)
        assert met["points"].tolist() == [[0.25, 0.5, 1], [0.25, 0.5, 3]]
        assert met["geometry_ids"].tolist() == [0, 1]
        assert sides(met["primitive_ids"]).tolist() == [5, 5]
        assert met["primitive_normals"].tolist() == [[0, 0, 1]] * 2
        assert scene.compute_distance(points).tolist() == [0.25, 0.5]

    def test_a_mesh_in_a_mesh_is_a_hollow(self, scene):
        points = np.float32([[0, 0, 0.5], [0, 0, 2.5], [0, 0, 5], [0, 0, 3]])
        assert scene.compute_occupancy(points)[:3].tolist() == [0, 1, 0]
        assert scene.compute_signed_distance(points, nsamples=3).tolist() == [0.5, -0.5, 2, 0]

    def test_answers_have_the_shape_of_what_was_asked(self, scene):
        rays = np.broadcast_to(self.RAYS, (2, 5, 3, 6))
        for name, values in scene.cast_rays(rays, nthreads=2).items():
            last = {"primitive_uvs": (2,), "primitive_normals": (3,)}.get(name, ())
            assert values.shape == (2, 5, 3, *last)
        assert scene.count_intersections(rays).shape == (2, 5, 3)
        assert scene.list_intersections(rays)["ray_splits"].shape == (31,)
        points = np.zeros((4, 2, 3))
        assert scene.compute_closest_points(points)["points"].shape == (4, 2, 3)
        for ask in (
            scene.compute_distance,
            scene.compute_signed_distance,
            scene.compute_occupancy,
        ):
            assert ask(points).shape == (4, 2)
            assert ask(points).dtype == np.float64
            assert ask(points.tolist()).dtype == np.float32

    def test_an_empty_scene_is_asked_in_vain(self):
        scene = RaycastingScene(nthreads=1, device="CPU:0")
        assert scene.cast_rays(self.RAYS)["t_hit"].tolist() == [np.inf] * 3
        assert scene.list_intersections(self.RAYS)["ray_splits"].tolist() == [0] * 4
        assert scene.compute_distance([[0, 0, 0]]).tolist() == [np.inf]
        assert scene.compute_occupancy([[0, 0, 0]]).tolist() == [0]
        met = scene.compute_closest_points([[0, 0, 0]])
        assert met["geometry_ids"].tolist() == [RaycastingScene.INVALID_ID]

    def test_answers_can_be_written(self, scene):
        for values in scene.cast_rays(self.RAYS).values():
            values[...] = 0
        assert scene.cast_rays(self.RAYS)["t_hit"][0] == 3

    def test_a_camera_of_matrices(self):
        intrinsic = [[100, 0, 32], [0, 80, 24], [0, 0, 1]]
        # It stands at (1, 2, 3), and looks along +x; its y is the world's -z.
        rotation = np.array([[0, -1, 0], [0, 0, -1], [1, 0, 0]])
        extrinsic = np.eye(4)
        extrinsic[:3, :3], extrinsic[:3, 3] = rotation, -rotation @ [1, 2, 3]
        rays = RaycastingScene.create_rays_pinhole(intrinsic, extrinsic, 64, 48)
        assert (rays.shape, rays.dtype) == ((48, 64, 6), np.float32)
        assert rays[..., :3].reshape(-1, 3).tolist() == [[1, 2, 3]] * (48 * 64)
        row, column = 10, 50
        x, y = (column + 0.5 - 32) / 100, (row + 0.5 - 24) / 80
        assert np.allclose(rays[row, column, 3:], [1, -x, -y], rtol=1e-6)

    def test_a_camera_that_looks_at_a_point(self):
        rays = RaycastingScene.create_rays_pinhole(
            fov_deg=90, center=[0, 0, 0], eye=[0, 0, 5], up=[0, 1, 0], width_px=4, height_px=2
        )
        # Half as wide at a depth of one as the tangent of 45 degrees. Row 0 is below.
        assert rays[0, 0].tolist() == [0, 0, 5, 0.75, -0.25, -1]
        assert rays[1, 3].tolist() == [0, 0, 5, -0.75, 0.25, -1]

    @pytest.mark.parametrize(
        ("call", "said"),
        [
            (lambda scene: scene.cast_rays([[0, 0, 0]]), r"rays must have the shape \(\.\.\., 6\)"),
            (lambda scene: scene.compute_distance([1, 2]), r"query_points must have the shape"),
            (
                lambda scene: scene.compute_occupancy([[0, 0, 0]], nsamples=2),
                "nsamples must be odd",
            ),
            (lambda scene: scene.add_triangles(CORNERS), "triangle_indices must be given"),
            (lambda scene: scene.cast_rays(TestOpen3D.RAYS, nthreads=-1), "nthreads must be zero"),
            (lambda _: RaycastingScene(device="CUDA:0"), "device must be the CPU, got CUDA:0"),
            (lambda _: RaycastingScene(nthreads=9999), "threads must be from 1 to 1024"),
            (lambda _: pinhole(180), "fov_deg must be between 0 and 180, got 180"),
            (lambda _: pinhole(60, eye=(0, 0, 0)), "center must be away from the eye"),
            (lambda _: pinhole(60, up=(0, 0, -2)), "up must be across the view"),
            (
                lambda _: RaycastingScene.create_rays_pinhole(np.zeros((3, 3)), np.eye(4), 2, 2),
                "intrinsic_matrix must be invertible",
            ),
        ],
    )
    def test_what_makes_no_sense_is_refused(self, scene, call, said):
        with pytest.raises(ValueError, match=said):
            call(scene)


def pinhole(angle, eye=(0, 0, 5), up=(0, 1, 0)):
    return RaycastingScene.create_rays_pinhole(angle, (0, 0, 0), eye, up, 4, 3)


class TestBesideTrimesh:
    """Our questions to trimesh itself, on its own path in float64."""

    @pytest.fixture
    def peer(self):
        trimesh = pytest.importorskip("trimesh", reason="trimesh is not installed")
        pytest.importorskip("rtree", reason="rtree, which trimesh needs, is not installed")
        pytest.importorskip("scipy", reason="SciPy, which trimesh needs, is not installed")
        return trimesh.Trimesh(*bumpy_sphere(16, 7), process=False, use_embree=False)

    def test_all_hits_first_hits_and_places(self, peer):
        rng = np.random.default_rng(11)
        origins = rng.uniform(-2, 2, (2000, 3))
        along = rng.uniform(-1, 1, (2000, 3)) - origins
        ours = RayMeshIntersector(peer)
        face, ray, where = ours.intersects_id(origins, along, return_locations=True)
        theirs = peer.ray.intersects_id(origins, along, return_locations=True)
        assert sorted(zip(ray, face, strict=True)) == sorted(zip(theirs[1], theirs[0], strict=True))
        order, their_order = np.lexsort((face, ray)), np.lexsort(theirs[:2])
        assert np.allclose(where[order], theirs[2][their_order], atol=1e-9)
        assert len(ray) > 1000
        assert np.array_equal(
            ours.intersects_first(origins, along), peer.ray.intersects_first(origins, along)
        )
        assert np.array_equal(
            ours.intersects_any(origins, along), peer.ray.intersects_any(origins, along)
        )

    def test_points_inside_nearest_points_and_distances(self, peer):
        points = np.random.default_rng(12).uniform(-1.2, 1.2, (1500, 3))
        inside = RayMeshIntersector(peer).contains_points(points)
        assert 200 < inside.sum() < 1300
        assert np.array_equal(inside, peer.ray.contains_points(points))
        ours = ProximityQuery(peer)
        mine, its = ours.on_surface(points), peer.nearest.on_surface(points)
        assert np.allclose(mine[0], its[0], rtol=0, atol=1e-12)
        assert np.allclose(mine[1], its[1], rtol=0, atol=1e-12)
        # At a corner trimesh looks at two of the faces, we at all: ours faces the point more.
        other = mine[2] != its[2]
        away = (points - mine[0])[other]
        cosines = [
            np.sum(peer.face_normals[face[other]] * away, axis=1) for face in (mine[2], its[2])
        ]
        assert (cosines[0] > cosines[1]).all()
        assert other.mean() < 0.2
        assert np.allclose(
            np.abs(ours.signed_distance(points)), peer.nearest.on_surface(points)[1], atol=1e-12
        )
        assert np.array_equal(ours.signed_distance(points) > 0, inside)
        for mine, its in zip(ours.vertex(points), peer.nearest.vertex(points), strict=True):
            assert np.allclose(mine, its, atol=1e-12)

    def test_a_mesh_that_it_changes_is_asked_anew(self, peer):
        peer.ray, peer.nearest = RayMeshIntersector(peer), ProximityQuery(peer)
        before = peer.nearest.signed_distance([[0, 0, 0]])[0]
        assert peer.contains([[1.5, 0, 0]]).tolist() == [False]
        peer.apply_scale(4)
        assert peer.contains([[1.5, 0, 0]]).tolist() == [True]
        assert np.isclose(peer.nearest.signed_distance([[0, 0, 0]])[0], 4 * before, rtol=1e-6)


def test_a_mesh_of_ours_is_taken_too():
    scene = RaycastingScene()
    scene.add_triangles(fh.Mesh(CORNERS, FACES))
    assert scene.compute_distance([[0, 0, 3]]).tolist() == [2]


def test_what_is_no_mesh_is_refused_at_once():
    for made in (RayMeshIntersector, ProximityQuery):
        with pytest.raises(TypeError, match=r"got a Scene; .* to_mesh\(\)"):
            made(type("Scene", (), {})())
