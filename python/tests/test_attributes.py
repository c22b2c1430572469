"""Attributes at hits: against NumPy's arithmetic, closed forms and trimesh."""

import copy
import pickle

import firsthit as fh
import numpy as np
import pytest
from support import SQUARE, bumpy_sphere

#: Rays down onto the square: (0.25, 0.5, 0.25), (0.125, 0.375, 0.5), and one that misses.
ORIGINS = np.array([[0.75, 0.25, 1], [0.375, 0.875, 1], [3, 3, 1]])
DOWN = (0, 0, -1)


def square(**properties):
    scene = fh.Scene()
    scene.add(fh.Mesh(*SQUARE, **properties))
    return scene


def weighted(weights, values):
    """Return w0 v0 + w1 v1 + w2 v2 from left to right, for values (n, 3, ...)."""
    w = weights.reshape(*weights.shape, *[1] * (values.ndim - 2))
    return (w[:, 0] * values[:, 0] + w[:, 1] * values[:, 1]) + w[:, 2] * values[:, 2]


def star(rays=3000, **properties):
    points, triangles = bumpy_sphere(12, 3)
    rng = np.random.default_rng(8)
    made = {name: make(rng, len(points), len(triangles)) for name, make in properties.items()}
    scene = fh.Scene()
    scene.add(fh.Mesh(points, triangles, **made))
    origins = rng.normal(size=(rays, 3)) * 3
    hits = scene.shoot(origins, rng.normal(size=(rays, 3)) - origins)
    return triangles, made, hits


def test_vertices_are_interpolated_to_the_bits_of_numpy():
    triangles, made, hits = star(
        vertex_properties=lambda rng, n, m: {"a": rng.normal(size=n), "b": rng.normal(size=(n, 4))}
    )
    met = hits.object >= 0
    assert 300 < met.sum() < 2700
    corners = triangles[hits.primitive[met]]
    given = made["vertex_properties"]
    np.testing.assert_array_equal(
        hits["a"][met], weighted(hits.barycentric[met], given["a"][corners])
    )
    np.testing.assert_array_equal(
        hits["b"][met], weighted(hits.barycentric[met], given["b"][corners])
    )
    assert hits["b"].shape == (3000, 4)
    assert np.isnan(hits["a"][~met]).all()
    assert np.isnan(hits["b"][~met]).all()


def test_corners_and_faces_have_numbers_of_their_own():
    _, made, hits = star(
        corner_properties=lambda rng, _, m: {
            "a": rng.normal(size=(m, 3)),
            "b": rng.normal(size=(m, 3, 2)).astype(np.float32),
        },
        face_properties=lambda rng, _, m: {"a": rng.normal(size=m), "part": np.arange(m) - 5},
    )
    met = hits.object >= 0
    weights, primitive = hits.barycentric[met], hits.primitive[met]
    corners, faces = made["corner_properties"], made["face_properties"]
    np.testing.assert_array_equal(hits["a"][met], weighted(weights, corners["a"][primitive]))
    twice = corners["b"].astype(np.float64)[primitive]
    np.testing.assert_array_equal(hits["b"][met], weighted(weights, twice))
    np.testing.assert_array_equal(hits.attribute("a", of="faces")[met], faces["a"][primitive])
    np.testing.assert_array_equal(hits["part"][met], primitive - 5)
    assert hits.attributes == ("a", "b", "part")


def test_integers_are_labels_of_the_nearest_corner():
    triangles, made, hits = star(
        vertex_properties=lambda rng, n, m: {"label": rng.integers(-(2**40), 2**40, n)}
    )
    met = hits.object >= 0
    nearest = np.argmax(hits.barycentric[met], axis=1)
    vertices = triangles[hits.primitive[met], nearest]
    np.testing.assert_array_equal(hits["label"][met], made["vertex_properties"]["label"][vertices])


def test_a_quantity_that_is_linear_in_space_is_that_of_the_point():
    linear = lambda p: p @ [3, -0.5, 0.25] + 11  # noqa: E731
    points, triangles = bumpy_sphere(20, 5)
    scene = fh.Scene()
    scene.add(fh.Mesh(points, triangles, vertex_properties={"heat": linear(points.astype(float))}))
    hits = scene.shoot(fh.Camera.look_at((4, 3, 5), (0, 0, 0), (0, 0, 1), 40, 60, 80))
    met = hits.object >= 0
    assert hits["heat"].shape == (60, 80)
    np.testing.assert_allclose(hits["heat"][met], linear(hits.position[met]), rtol=0, atol=1e-13)


def test_a_name_in_brackets_is_a_channel_or_an_attribute():
    colors = [[0.25, 0.5, 1], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    scene = square(vertex_properties={"t": [5.0, 5, 5, 5]}, colors=colors)
    hits = scene.shoot(ORIGINS, DOWN)
    assert hits["t"].tolist() == [1, 1, np.inf]
    assert hits.attribute("t")[:2].tolist() == [5, 5]
    assert hits["normal"].shape == (3, 3)
    assert hits["colors"][0].tolist() == [0.25 * 0.25 + 0.5, 0.25 * 0.5 + 0.25, 0.25]
    assert hits.attributes == ("colors", "t")
    assert hits["colors"] is not None
    assert np.shares_memory(hits["colors"], hits["colors"])
    assert not hits["colors"].flags.writeable
    with pytest.raises(AttributeError):
        hits["range"]


def test_an_attribute_has_one_name_in_every_call(tmp_path):
    heat, pair = [1.0, 2, 3, 4.5], np.eye(4, 2) + 0.5
    scene = square(vertex_properties={"t": heat, "pair": pair})
    hits, met = scene.shoot(ORIGINS, DOWN), scene.shoot_all(ORIGINS, DOWN)
    for some in (hits, met):
        expected = some.attribute("t")
        assert some["attribute:t"] is not some["t"]
        np.testing.assert_array_equal(some["attribute:t"], expected)
        np.testing.assert_array_equal(some.channel("attribute:t"), expected)
        table = some.to_dict(["t", "attribute:t", "attribute:pair"])
        assert list(table)[-3:] == ["attribute:t", "attribute:pair_0", "attribute:pair_1"]
        np.testing.assert_array_equal(table["attribute:t"], expected)
        np.testing.assert_array_equal(table["attribute:pair_1"], some["pair"][:, 1])
    with pytest.raises(ValueError, match="got 'head'; there are"):
        hits.channel("attribute:head")


def test_parts_copies_and_pickles_of_hits_have_the_same_attributes():
    _, _, hits = star(vertex_properties=lambda rng, n, m: {"a": rng.normal(size=n)})
    whole = hits["a"]
    np.testing.assert_array_equal(hits[100:200]["a"], whole[100:200])
    np.testing.assert_array_equal(copy.copy(hits)["a"], whole)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(hits))["a"], whole)
    assert hits[0]["a"].shape == ()


def test_all_hits_have_attributes():
    points, triangles = bumpy_sphere(10, 3)
    scene = fh.Scene()
    scene.add(fh.Mesh(points, triangles, vertex_properties={"x": points[:, 0].astype(float)}))
    origins = np.random.default_rng(1).normal(size=(50, 3)) * 2
    met = scene.shoot_all(origins, 0.3 - origins)
    assert len(met.t) > 20
    assert met.attributes == ("x",)
    np.testing.assert_allclose(met["x"], met.position[:, 0], atol=1e-14)
    np.testing.assert_array_equal(met.attribute("x"), met["x"])


def test_more_hits_than_go_at_once_and_any_number_of_threads_give_the_same():
    scene = square(vertex_properties={"a": [0.1, 0.7, 0.3, 0.9]})
    origins = np.random.default_rng(2).uniform(-0.2, 1.2, ((1 << 19) + 700, 3))
    origins[:, 2] = 1
    hits = scene.shoot(origins, DOWN, threads=2)
    met = hits.object >= 0
    told = []
    a = hits.attribute("a", threads=1, progress=lambda done, total: told.append((done, total)))
    assert told[-1] == (len(origins), len(origins))
    corners = np.array([[0.1, 0.7, 0.3], [0.1, 0.3, 0.9]])[hits.primitive[met]]
    np.testing.assert_array_equal(a[met], weighted(hits.barycentric[met], corners))
    assert np.isnan(a[~met]).all()
    again = copy.copy(scene).shoot(origins, DOWN, threads=2)
    np.testing.assert_array_equal(again.attribute("a", threads=3), a)


def test_no_rays_have_no_attributes_of_as_many_numbers():
    scene = square(vertex_properties={"a": np.ones((4, 3))})
    assert scene.shoot(np.empty((0, 3)), DOWN)["a"].shape == (0, 3)


def test_pickled_meshes_keep_their_properties_and_which_are_labels():
    mesh = fh.Mesh(
        *SQUARE,
        vertex_properties={"label": [1, 2, 3, 4], "heat": [1.5, 2, 3, 4], "pair": np.eye(4, 2)},
        corner_properties={"c": np.arange(6.0).reshape(2, 3)},
        face_properties={"part": [7, 8]},
        normals=[[0, 0, 1]] * 4,
        slots=[0, 1],
    )
    again = pickle.loads(pickle.dumps(mesh))
    assert again.corner_properties["c"].tolist() == [[0, 1, 2], [3, 4, 5]]
    assert again.vertex_properties["pair"].tolist() == np.eye(4, 2).tolist()
    assert again.slots.tolist() == [0, 1]
    for made in (mesh, again):
        scene = fh.Scene()
        scene.add(made)
        hits = scene.shoot(ORIGINS[:2], DOWN)
        assert hits["label"].tolist() == [2, 4]
        assert hits["heat"].tolist() == [0.25 * 1.5 + 1 + 0.75, 0.125 * 1.5 + 0.375 * 3 + 2]
        assert hits["part"].tolist() == [7, 8]


@pytest.mark.parametrize(
    ("properties", "message"),
    [
        ({"corner_properties": {"a": [1, 2]}}, r"a must have the shape \(m, 3\) or \(m, 3, k\)"),
        ({"corner_properties": {"a": np.zeros((3, 3))}}, "three for each triangle, got 9 of 'a'"),
        ({"vertex_properties": {"a": np.zeros((4, 0))}}, r"\(n,\) or \(n, k\), got \(4, 0\)"),
        ({"vertex_properties": {"a": np.zeros((3, 2))}}, "as many as vertices, got 6 numbers, 2"),
        ({"face_properties": {"a": np.zeros((2, 2, 2))}}, "must have the shape"),
        ({"vertex_properties": {"a": [2**53 + 1] * 4}}, r"a must be at most 2\*\*53, .* got 9007"),
        ({"vertex_properties": {"a": np.uint64([1, 2, 3, 2**64 - 1])}}, "to 18446744073709551615"),
        ({"vertex_properties": {"a": [[1], [1, 2]]}}, "a must be an array of numbers: "),
    ],
)
def test_properties_that_do_not_fit_are_refused(properties, message):
    with pytest.raises(ValueError, match=message):
        fh.Mesh(*SQUARE, **properties)


def test_a_name_that_no_mesh_has_is_refused_with_those_there_are():
    hits = square(vertex_properties={"heat": [1, 2, 3, 4]}).shoot(ORIGINS, DOWN)
    with pytest.raises(ValueError, match="got 'head'; there are heat"):
        hits["head"]
    with pytest.raises(ValueError, match="no mesh has any"):
        hits.attribute("heat", of="corners")
    with pytest.raises(ValueError, match="of must be one of vertices, corners, faces"):
        hits.attribute("heat", of="edges")


def test_attributes_are_those_that_trimesh_interpolates():
    trimesh = pytest.importorskip("trimesh")
    points, triangles = bumpy_sphere(12, 3)
    values = np.random.default_rng(4).normal(size=(len(points), 2))
    scene = fh.Scene()
    scene.add(fh.Mesh(points, triangles, vertex_properties={"a": values}))
    rng = np.random.default_rng(5)
    origins = rng.normal(size=(800, 3)) * 3
    hits = scene.shoot(origins, rng.normal(size=(800, 3)) - origins)
    hits = hits[hits.object >= 0]
    corners = points.astype(float)[triangles[hits.primitive]]
    weights = trimesh.triangles.points_to_barycentric(corners, hits.position)
    expected = (weights[..., None] * values[triangles[hits.primitive]]).sum(axis=1)
    np.testing.assert_allclose(hits["a"], expected, atol=1e-9)
