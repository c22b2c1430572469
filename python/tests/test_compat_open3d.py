"""`firsthit.compat.open3d` beside Open3D itself, which answers in float32."""

import numpy as np
import pytest
from firsthit.compat.open3d import RaycastingScene
from support import bumpy_sphere

# Not only where it is not installed: its wheel needs libraries of the system.
open3d = pytest.importorskip(
    "open3d", reason="Open3D is not installed, see `make test-compat`", exc_type=ImportError
)
Theirs = open3d.t.geometry.RaycastingScene

#: Distances are below 8; Open3D rounds them to 2^-21 at best, some times over.
ROUNDING = 2e-5

VERTICES, TRIANGLES = bumpy_sphere(24, 5)
MESHES = [
    (VERTICES, TRIANGLES.astype(np.uint32)),
    (VERTICES * np.float32(0.4), TRIANGLES[:, ::-1].astype(np.uint32)),
    (VERTICES + np.float32([4, 0, 0]), TRIANGLES.astype(np.uint32)),
]


@pytest.fixture(scope="module")
def scenes():
    both = RaycastingScene(), Theirs()
    for scene in both:
        identifiers = [scene.add_triangles(*mesh) for mesh in MESHES]
        assert identifiers == [0, 1, 2]
    return both


@pytest.fixture(scope="module")
def rays():
    """Random rays, that come nowhere near an edge in float32 but for few of them."""
    rng = np.random.default_rng(4)
    origins, targets = rng.uniform(-3, 6, (4000, 3)), rng.uniform(-1.5, 5.5, (4000, 3))
    targets[:, 1:] /= 3
    return np.hstack([origins, targets - origins]).astype(np.float32).reshape(40, 100, 6)


@pytest.fixture(scope="module")
def points():
    return np.random.default_rng(6).uniform([-2, -2, -2], [6, 2, 2], (50, 40, 3)).astype(np.float32)


def arrays(answers):
    return {name: values.numpy() for name, values in answers.items()}


def alike(ours, theirs):
    """How many answers are the same, of those that have the same names, shapes and types."""
    assert set(ours) == set(theirs)
    for name, values in ours.items():
        assert (name, values.shape, values.dtype) == (
            name,
            theirs[name].shape,
            theirs[name].dtype,
        )
    return (ours["geometry_ids"] == theirs["geometry_ids"]) & (
        ours["primitive_ids"] == theirs["primitive_ids"]
    )


def test_first_hits(scenes, rays):
    ours, theirs = scenes[0].cast_rays(rays), arrays(scenes[1].cast_rays(rays))
    same = alike(ours, theirs)
    # In float32 a ray at an edge may meet the neighbour.
    assert np.mean(same) > 0.998
    is_hit = same & np.isfinite(ours["t_hit"])
    assert 1000 < is_hit.sum() < 3900
    assert np.array_equal(np.isfinite(ours["t_hit"]), np.isfinite(theirs["t_hit"]))
    assert np.allclose(ours["t_hit"][is_hit], theirs["t_hit"][is_hit], atol=ROUNDING)
    for name in ("primitive_uvs", "primitive_normals"):
        assert np.allclose(ours[name][same], theirs[name][same], atol=1e-3)


def test_occlusions(scenes, rays):
    for limits in [{}, {"tnear": 0.5}, {"tfar": 0.5}, {"tnear": 0.25, "tfar": 0.75}]:
        ours, theirs = (scene.test_occlusions(rays, **limits) for scene in scenes)
        assert (ours.shape, ours.dtype) == (theirs.numpy().shape, theirs.numpy().dtype)
        assert np.mean(ours == theirs.numpy()) > 0.998
        assert 300 < ours.sum() < 3900


def test_counts(scenes, rays):
    ours, theirs = scenes[0].count_intersections(rays), scenes[1].count_intersections(rays).numpy()
    assert (ours.shape, ours.dtype) == (theirs.shape, theirs.dtype)
    assert np.mean(ours == theirs) > 0.998
    assert ours.max() > 4


def test_every_crossing(scenes, rays):
    ours, theirs = scenes[0].list_intersections(rays), arrays(scenes[1].list_intersections(rays))
    assert set(ours) == set(theirs)
    for name, values in ours.items():
        assert values.dtype == theirs[name].dtype
        assert values.shape[1:] == theirs[name].shape[1:]
    whole = [np.diff(each["ray_splits"].astype(np.int64)) for each in (ours, theirs)]
    same = whole[0] == whole[1]
    assert np.mean(same) > 0.998
    # Of the rays with as many crossings for both. Open3D's are in no order along a ray.
    order = np.lexsort((theirs["t_hit"], theirs["ray_ids"]))
    theirs = {name: values[order] for name, values in theirs.items() if name != "ray_splits"}
    rows = [np.flatnonzero(same[each["ray_ids"].astype(np.int64)]) for each in (ours, theirs)]
    t, their_t = ours["t_hit"][rows[0]], theirs["t_hit"][rows[1]]
    assert len(t) > 3000
    assert np.mean(np.abs(t - their_t) < ROUNDING) > 0.999
    for name in ("geometry_ids", "primitive_ids"):
        assert np.mean(ours[name][rows[0]] == theirs[name][rows[1]]) > 0.998


def test_nearest_points(scenes, points):
    ours, theirs = (
        scenes[0].compute_closest_points(points),
        arrays(scenes[1].compute_closest_points(points)),
    )
    same = alike(ours, theirs)
    # At the same edge another triangle may come first; the point is the same.
    assert np.allclose(ours["points"], theirs["points"], atol=1e-3)
    assert np.mean(same) > 0.3
    assert np.allclose(ours["primitive_uvs"][same], theirs["primitive_uvs"][same], atol=1e-3)
    assert np.allclose(
        ours["primitive_normals"][same], theirs["primitive_normals"][same], atol=1e-3
    )
    distances = [scene.compute_distance(points) for scene in scenes]
    assert np.allclose(distances[0], distances[1].numpy(), atol=ROUNDING)


def test_inside_and_signed_distances(scenes, points):
    ours, theirs = (scene.compute_occupancy(points) for scene in scenes)
    assert (ours.shape, ours.dtype) == (theirs.numpy().shape, theirs.numpy().dtype)
    assert np.array_equal(ours, theirs.numpy())
    assert 100 < ours.sum() < 1900
    signed, their_signed = (scene.compute_signed_distance(points) for scene in scenes)
    assert np.allclose(signed, their_signed.numpy(), atol=ROUNDING)
    assert np.array_equal(signed < 0, ours == 1)


def test_cameras():
    turn = np.linalg.qr(np.random.default_rng(8).normal(size=(3, 3)))[0]
    extrinsic = np.eye(4)
    extrinsic[:3, :3], extrinsic[:3, 3] = turn * np.sign(np.linalg.det(turn)), [1, 2, 3]
    intrinsic = np.array([[100, 0.5, 32], [0, 80, 24], [0, 0, 1.0]])
    for given in [
        (intrinsic, extrinsic, 64, 48),
        (70.0, np.array([1, 2, 3.0]), np.array([4, -1, 2.0]), np.array([0.1, 0, 1]), 64, 48),
    ]:
        ours, theirs = (kind.create_rays_pinhole(*given) for kind in (RaycastingScene, Theirs))
        assert (ours.shape, ours.dtype) == (theirs.numpy().shape, theirs.numpy().dtype)
        assert np.allclose(ours, theirs.numpy(), atol=1e-6)


def test_what_was_given_as_tensors_is_answered_by_tensors(rays, points):
    scene = RaycastingScene(device=open3d.core.Device("CPU:0"))
    tensor = open3d.core.Tensor
    assert scene.add_triangles(*map(tensor, MESHES[0])) == 0
    for asked in (rays, tensor(rays)):
        met = scene.cast_rays(asked)
        assert all(isinstance(values, tensor) for values in met.values())
        assert met["geometry_ids"].dtype == open3d.core.uint32
    assert isinstance(scene.compute_occupancy(tensor(points)), tensor)
    assert isinstance(scene.test_occlusions(tensor(rays)), tensor)
    arrays_alone = RaycastingScene()
    arrays_alone.add_triangles(*MESHES[0])
    assert isinstance(arrays_alone.count_intersections(rays), np.ndarray)
    assert isinstance(arrays_alone.count_intersections(tensor(rays)), tensor)
    matrices = tensor(np.eye(3)), tensor(np.eye(4))
    assert isinstance(RaycastingScene.create_rays_pinhole(*matrices, 4, 3), tensor)


def test_its_meshes_of_both_kinds_are_taken():
    box = open3d.t.geometry.TriangleMesh.create_box()
    for mesh in (box, box.to_legacy()):
        scene = RaycastingScene()
        assert scene.add_triangles(mesh) == 0
        inside = np.float32([[0.5, 0.5, 0.5], [2, 2, 2]])
        assert scene.compute_occupancy(inside).numpy().tolist() == [1, 0]
