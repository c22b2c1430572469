"""Counting, moving, panoramas and parts of pictures."""

from __future__ import annotations

import pickle

import firsthit as fh
import numpy as np
import pytest
from support import bumpy_sphere, turned


def _scene() -> fh.Scene:
    scene = fh.Scene()
    scene.add(fh.Box(low=(-1, -1, -1), high=(1, 1, 1)))
    corners = np.array([[-3, -3, 0.5], [3, -3, 0.5], [3, 3, 0.5], [-3, 3, 0.5]])
    scene.add(fh.Mesh(corners, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]))
    return scene


def test_count_counts_surfaces_and_copies_of_them() -> None:
    scene = _scene()
    # Through the box and a triangle that is there twice; past the box; past everything.
    origins = [[0.5, -0.3, 9], [2, -1, 9], [9, 9, 9]]
    assert scene.count(origins, [0, 0, -1]).tolist() == [4, 2, 0]
    assert scene.count(origins, [0, 0, -1], t_max=8.5).tolist() == [3, 2, 0]
    many = np.broadcast_to(origins[0], (3, 1000, 3))
    counts = scene.count(many, [0, 0, -1])
    assert (counts.dtype, counts.shape) == (np.int64, (3, 1000))
    assert (counts == 4).all()


def test_one_less_than_no_crossing_is_minus_one() -> None:
    assert (_scene().count([9, 9, 9], [0, 0, -1]) - 1).tolist() == -1


def test_count_counts_a_shared_edge_once() -> None:
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = [
        [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
        [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
    ]  # fmt: skip
    scene = fh.Scene()
    scene.add(fh.Mesh(corners, faces))
    # Through diagonals of two faces, through two corners, along a face, and past.
    origins = [[0.5, 0.5, 9], [9, 9, 9], [0.5, 1, 9], [2, 2, 9]]
    directions = [[0, 0, -1], [-1, -1, -1], [0, 0, -1], [0, 0, -1]]
    counts = scene.count(origins, directions)
    assert counts[[0, 1, 3]].tolist() == [2, 2, 0]
    assert counts[2] in (0, 2)


def test_a_moved_object_is_where_it_was_moved_to() -> None:
    scene = _scene()
    before = scene.shoot((0, 0, 9), (0, 0, -1))
    there = np.eye(4)
    there[2, 3] = 3
    scene.move(0, there)
    after = scene.shoot((0, 0, 9), (0, 0, -1))
    assert (before.t.item(), after.t.item()) == (8.0, 5.0)
    # What was shot before is still told of where things were.
    assert before.position.tolist() == [0, 0, 1]
    assert scene.objects[0].transform[2, 3] == 3
    assert pickle.loads(pickle.dumps(scene)).shoot((0, 0, 9), (0, 0, -1)).t == 5.0
    scene.move(0, None)
    assert scene.shoot((0, 0, 9), (0, 0, -1)).t == 8.0
    with pytest.raises(IndexError, match="no object 2; there are 2"):
        scene.move(2, there)
    with pytest.raises(ValueError, match="transform"):
        scene.move(0, np.zeros((4, 4)))


def test_one_of_a_thousand_moves_again_and_again() -> None:
    scene = fh.Scene()
    turns = np.linspace(0, 2 * np.pi, 300)
    vertices = np.stack([np.cos(turns), np.sin(turns), turns % 1], -1)
    ball = fh.Mesh(vertices, [[0, k, k + 1] for k in range(1, 299)])
    for k in range(1000):
        place = np.eye(4)
        place[:3, 3] = k % 10, k // 10 % 10, k // 100
        scene.add(ball, transform=place)
    ray = ((3.2, 3.1, 99), (0, 0, -1))
    scene.shoot(*ray)
    place = np.eye(4)
    for k in range(200):
        place[:3, 3] = 3, 3, 20 + 0.1 * k
        scene.move(7, place)
        assert scene.shoot(*ray).object == 7


def test_a_panorama_sees_all_around() -> None:
    scene = fh.Scene()
    for k, place in enumerate(
        [(0, 5, 0), (5, 0, 0), (0, -5, 0), (-5, 0, 0), (0, 0, 5), (0, 0, -5)]
    ):
        assert scene.add(fh.Sphere(center=place, radius=1)) == k
    camera = fh.Camera.equirectangular((0, 0, 0), (0, 1, 0), (0, 0, 1), rows=90, columns=180)
    frame = fh.render(scene, camera, channels=("object", "t", "range", "z"), samples=1)
    middle = [(45, 90), (45, 135), (45, 0), (45, 45), (0, 20), (89, 20)]
    assert [int(frame["object"][pixel]) for pixel in middle] == list(range(6))
    assert np.array_equal(frame["t"], frame["range"])
    directions = camera.rays()[1]
    hit = np.isfinite(frame["t"])
    np.testing.assert_allclose(frame["z"][hit], (frame["t"] * directions[..., 1])[hit], atol=1e-14)
    assert frame.metadata["camera"]["projection"] == "equirectangular"
    assert frame.metadata["camera"]["focal_length"] is None
    assert camera.focal_length is None
    assert pickle.loads(pickle.dumps(camera)) == camera


@pytest.mark.parametrize(
    ("lengths", "kind", "start", "name"),
    [
        ((1.0, 1.0, 1.0), "equirectangular", "eye", "focal_length"),
        ((None, None, None), "perspective", "eye", "focal_length"),
        ((None, None, None), "equirectangular", "viewplane", "ray_start"),
    ],
)
def test_what_does_not_go_together_is_refused(lengths, kind, start, name) -> None:
    with pytest.raises(ValueError, match=f"^{name} must be"):
        fh.Camera((0, 0, 0), (0, 1, 0), (0, 0, 1), *lengths, 4, 8, kind, start)


@pytest.mark.parametrize("samples", [1, 3])
def test_a_region_is_that_part_of_the_picture(samples: int) -> None:
    scene = _scene()
    camera = fh.Camera.framing(scene, rows=60, columns=80)
    region = np.s_[7:33, 50:]
    for shade in ("lambert", lambda hits: np.repeat(hits.t[..., None] < 9, 3, -1)):
        how = {"channels": ("color", "z", "object"), "samples": samples, "shade": shade}
        whole = fh.render(scene, camera, **how)
        part = fh.render(scene, camera, **how, region=region)
        assert part.shape == (26, 30)
        for name in ("color", "z", "object"):
            np.testing.assert_array_equal(part[name], whole[name][region])
    for wrong, error in [(np.s_[5:5, :], ValueError), (np.s_[::2, :], ValueError), (3, TypeError)]:
        with pytest.raises(error, match="region must"):
            fh.render(scene, camera, region=wrong)


@pytest.mark.parametrize("samples", [1, 3])
@pytest.mark.parametrize("kind", ["perspective", "orthographic", "equirectangular"])
@pytest.mark.parametrize("region", [np.s_[7:33, 50:], np.s_[0:2, 0:2], np.s_[:, 5:6], np.s_[:, :]])
def test_an_own_shader_sees_the_pixels_of_the_region_alone(samples, kind, region) -> None:
    scene = _scene()
    framing = fh.Camera.framing(scene, rows=60, columns=80)
    camera = framing
    if kind == "equirectangular":
        camera = fh.Camera.equirectangular((0, 0, 3), (1, 0, -1), (0, 0, 1), 60, 80)
    elif kind == "orthographic":
        lengths = framing.focal_length, 6.0, 4.5
        place = framing.position, framing.aim, framing.up
        camera = fh.Camera(*place, *lengths, 60, 80, "orthographic")
    seen = []

    def shade(hits: fh.Hits) -> np.ndarray:
        seen.append(hits.shape)
        numbers = hits.position.sum(-1) + hits.uv.sum(-1) + hits.origin[..., 0]
        colors = np.stack([hits.z, hits.range, np.nan_to_num(numbers) + hits.direction[..., 1]], -1)
        return np.where(np.isfinite(colors), colors, -1)

    reports: list[tuple[int, int]] = []
    whole = fh.render(scene, camera, samples=samples, shade=shade)["color"]
    seen.clear()
    part = fh.render(
        scene,
        camera,
        samples=samples,
        shade=shade,
        region=region,
        progress=lambda done, total: reports.append((done, total)),
    )["color"]
    expected = whole[region]
    assert seen == [expected.shape[:2]] * samples
    assert part.tobytes() == np.ascontiguousarray(expected).tobytes()
    # Beside the samples, the first hits of the region's pixels.
    assert reports[-1] == (expected[..., 0].size * (samples + 1),) * 2


def test_an_own_shader_gets_the_pixels_of_a_region_from_the_hits() -> None:
    camera = fh.Camera.framing(_scene(), rows=6, columns=8)
    tables = []

    def shade(hits: fh.Hits) -> np.ndarray:
        tables.append(hits.to_dict("t"))
        return np.zeros((*hits.shape, 3))

    fh.render(_scene(), camera, samples=1, shade=shade, region=np.s_[2:4, 3:5])
    assert tables[0]["row"].tolist() == [2, 2, 3, 3]
    assert tables[0]["column"].tolist() == [3, 4, 3, 4]


@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
def test_samples_of_a_pixel_have_distances_too(projection: str) -> None:
    scene = _scene()
    framed = fh.Camera.framing(scene, rows=12, columns=16)
    lengths = (framed.focal_length, 9.0, 12.0)
    camera = fh.Camera(framed.position, framed.aim, framed.up, *lengths, 12, 16, projection)
    misses = []

    def shade(hits: fh.Hits) -> np.ndarray:
        missed = hits.object < 0
        away = hits.position - camera.position
        z = np.where(missed, np.inf, away @ np.asarray(camera.aim))
        np.testing.assert_allclose(hits.z, z, rtol=1e-12)
        along = np.linalg.norm(away, axis=-1)
        expected = along if projection == "perspective" else z
        np.testing.assert_allclose(hits.range, np.where(missed, np.inf, expected), rtol=1e-12)
        misses.append(int(missed.sum()))
        return np.zeros((*hits.shape, 3))

    fh.render(scene, camera, samples=3, shade=shade)
    assert len(misses) == 3
    assert 0 < misses[1] < 12 * 16


def test_parts_of_a_panorama_s_hits_miss_as_the_whole_does() -> None:
    scene = fh.Scene()
    scene.add(fh.Sphere((0, 0, -5), 1))
    camera = fh.Camera.equirectangular((0, 0, 0), (0, 1, 0), (0, 0, 1), rows=8, columns=8)
    hits = scene.shoot(camera)
    assert 0 < (hits.object < 0).sum() < 64
    for name in ("z", "range"):
        whole = hits.channel(name)
        np.testing.assert_array_equal(hits[...].channel(name), whole)
        assert (whole[hits.object < 0] == np.inf).all()


def test_samples_know_their_pixels() -> None:
    scene = _scene()
    camera = fh.Camera.framing(scene, rows=6, columns=8)

    def shade(hits: fh.Hits) -> np.ndarray:
        table = hits[hits.object < 2].to_dict("t")
        return np.stack([table["row"], table["column"], table["t"]], -1).reshape(*hits.shape, 3)

    colors = fh.render(scene, camera, samples=3, shade=shade, region=np.s_[2:5, 3:])["color"]
    assert colors[..., 0].tolist() == [[row] * 5 for row in (2, 3, 4)]
    assert colors[..., 1].tolist() == [[3, 4, 5, 6, 7]] * 3


@pytest.mark.parametrize(
    ("wrong", "error", "message"),
    [
        ({"shade": 5}, TypeError, "shade must be the name of a shader or a function, got 5"),
        ({"channels": None}, TypeError, "channels must be a str or several, got None"),
        ({"region": np.s_[0.0:2.0, :]}, TypeError, "region must be two slices of int"),
        ({"region": np.s_[0:2:0, :]}, ValueError, "region must be two slices of int"),
        ({"shade": lambda hits: 1j * hits.normal}, ValueError, "must return real numbers"),
    ],
)
def test_what_makes_no_picture_is_told_by_its_name(wrong, error, message) -> None:
    with pytest.raises(error, match=message):
        fh.render(_scene(), **{"channels": ("t", "color"), **wrong})


def _patch(middle: np.ndarray, across: np.ndarray, down: np.ndarray, count: int) -> fh.Mesh:
    """Return a parallelogram of so many times two triangles both ways: enough for a tree."""
    x, y = np.meshgrid(*2 * [np.linspace(-1, 1, count + 1)])
    corners = middle + x[..., None] * across + y[..., None] * down
    numbers = np.arange(x.size).reshape(x.shape)
    a, b, c, d = (
        part.reshape(-1)
        for part in (numbers[:-1, :-1], numbers[:-1, 1:], numbers[1:, :-1], numbers[1:, 1:])
    )
    return fh.Mesh(corners.reshape(-1, 3), np.concatenate([np.c_[a, b, d], np.c_[a, d, c]]))


@pytest.mark.parametrize("degrees", [3.0, 3.9, 4.1, 4.25])
def test_a_coarse_fisheye_sees_what_is_just_before_a_wall(degrees: float) -> None:
    # The tile in the middle, whose corner pixels are nearly a pixel off its grid.
    n = 48
    fov = n * degrees
    camera = fh.Camera.fisheye((0, 0, 0), (0, 0, 1), (0, 1, 0), fov, rows=n, columns=n)
    _, directions = camera.rays()
    axes = np.eye(3)
    wall = _patch(10 * axes[2], 100 * axes[0], 100 * axes[1], 12)
    for row, column in ((16, 16), (31, 16)):
        way = directions[row, column]
        for share in (0.999, 0.99, 0.985):
            place = 10 * share / way[2] * way
            aside = np.cross(way, axes[2])
            card = _patch(place, 0.01 * aside, 0.01 * np.cross(way, aside), 6)
            scene = fh.Scene()
            scene.add(wall)
            scene.add(card)
            assert scene.shoot(camera).object[row, column] == 1


@pytest.mark.parametrize(
    ("projection", "fov", "rows"),
    [
        ("equidistant", 200, 50),
        ("equidistant", 200, 64),
        ("equidistant", 150, 130),
        ("equisolid", 220, 56),
        ("stereographic", 190, 60),
        ("orthographic_fisheye", 170, 48),
        ("equirectangular", 360, 90),
    ],
)
def test_coarse_curved_pictures_meet_what_their_rays_meet_alone(projection, fov, rows) -> None:
    # Rays up to a pixel off their tiles' grids; triangles of less than a pixel and of many; more
    # objects than are asked one by one.
    scene, rng = fh.Scene(), np.random.default_rng(5)
    for k in range(20):
        way = rng.normal(size=3)
        place = way / np.linalg.norm(way) * rng.uniform(1.5, 6)
        mesh = fh.Mesh(*bumpy_sphere(5 + 9 * (k % 5), k))
        scene.add(mesh, transform=turned(rng.normal(size=3), k, place, rng.uniform(0.2, 1.0)))
    pose = (0, 0, 0), (0.1, 0, 1), (0, 1, 0)
    if projection == "equirectangular":
        camera = fh.Camera.equirectangular(*pose, rows, 2 * rows + 3)
    else:
        camera = fh.Camera.fisheye(*pose, fov, rows, rows + 7, projection)
    hits = scene.shoot(camera)
    assert 0.15 < (hits.object >= 0).mean() < 0.9
    origins, directions = (array.reshape(-1, 3) for array in camera.rays())
    # In an order that is that of no picture.
    order = rng.permutation(len(directions))
    alone = scene.shoot(origins[order], directions[order])
    for name in ("t", "object", "primitive"):
        np.testing.assert_array_equal(hits.channel(name).reshape(-1)[order], alone.channel(name))
