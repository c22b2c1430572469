"""Filters of rays: masks, sides, skipped and left surfaces. Judged by sifting all hits."""

import pickle

import firsthit as fh
import numpy as np
import pytest
from support import SQUARE, ball, bumpy_sphere

RNG = np.random.default_rng(5)
MASKS = np.array([0b0001, 0b0010, 0b1100, 1 << 31], np.uint32)


def scene_of_four():
    """Two meshes, a box and a ball, which overlap."""
    scene = fh.Scene()
    turned = np.diag([1.5, 1.2, -1.1, 1])
    shapes = [fh.Mesh(*bumpy_sphere(12, 1)), fh.Mesh(*bumpy_sphere(9, 2))]
    shapes += [fh.Box((-0.9, -0.9, -0.9), (0.9, 0.9, 0.9)), fh.Sphere((0.2, 0, 0), 1.1)]
    for k, shape in enumerate(shapes):
        transform = turned if k == 1 else None
        scene.add(shape, name=f"part {k % 3}", transform=transform, mask=int(MASKS[k]))
    return scene


def rays(count):
    origins = RNG.normal(size=(count, 3))
    origins *= 4 / np.linalg.norm(origins, axis=-1)[:, None]
    return origins, RNG.uniform(-1, 1, (count, 3)) - origins


def sifted(scene, origins, directions, mask, cull, skip):
    """The first of all hits that a ray is to meet: distances, objects, primitives; and how many."""
    met = scene.shoot_all(origins, directions)
    ray, which = met.ray, met.object
    keep = MASKS[which] & np.broadcast_to(mask, len(origins)).astype(np.uint32)[ray] != 0
    if cull is not None:
        keep &= met.front != (cull == "front")
    if skip is not None:
        skipped = (which == np.resize(skip[0], len(origins))[ray]) & (which < 2)
        keep &= ~(skipped & (met.primitive == np.resize(skip[1], len(origins))[ray]))
    t = np.full(len(origins), np.inf)
    found, primitive = np.full(len(origins), -1), np.full(len(origins), -1)
    first, at = np.unique(ray[keep], return_index=True)
    t[first] = met.t[keep][at]
    found[first], primitive[first] = which[keep][at], met.primitive[keep][at]
    return t, found, primitive, np.bincount(ray[keep], minlength=len(origins))


@pytest.mark.parametrize("count", [60, 3000])
@pytest.mark.parametrize("cull", [None, "front", "back"])
@pytest.mark.parametrize("masks", ["one", "each", None])
@pytest.mark.parametrize("skips", [False, True])
def test_what_is_left_out_is_as_if_it_were_not_there(count, cull, masks, skips):
    scene, (origins, directions) = scene_of_four(), rays(count)
    mask = {"one": 0b0101, "each": RNG.choice([0, 1, 3, 12, 1 << 31], count), None: None}[masks]
    skip = None
    if skips:
        hits = scene.shoot(origins, directions)
        skip = np.where(hits.object < 2, hits.object, -1), hits.primitive
    kept = {"mask": mask, "cull": cull, "skip": skip}
    bits = 0xFFFFFFFF if mask is None else mask
    t, which, primitive, counts = sifted(scene, origins, directions, bits, cull, skip)
    assert (which >= 0).any()
    assert skips or mask is None or (which < 0).any()
    hits = scene.shoot(origins, directions, **kept)
    np.testing.assert_array_equal(hits.t, t)
    np.testing.assert_array_equal(hits.object, which)
    np.testing.assert_array_equal(hits.primitive, primitive)
    # What is asked about hits later does not depend on what was left out.
    expected = origins + t[:, None] * directions
    met = which >= 0
    np.testing.assert_allclose(hits.position[met], expected[met], atol=1e-12)
    np.testing.assert_array_equal(scene.occluded(origins, directions, **kept), met)
    np.testing.assert_array_equal(scene.count(origins, directions, **kept), counts)
    all_hits = scene.shoot_all(origins, directions, **kept)
    np.testing.assert_array_equal(all_hits.counts, counts)
    nearest = scene.shoot_all(origins, directions, k=1, **kept)
    np.testing.assert_array_equal(nearest.t[:, 0], t)


def test_more_rays_than_go_at_a_time_are_filtered_each_by_its_own():
    scene, count = scene_of_four(), (1 << 19) + 77
    origins, directions = (np.resize(array, (count, 3)) for array in rays(500))
    mask = np.resize(RNG.integers(0, 16, 77), count)
    hits = scene.shoot(origins, directions, mask=mask)
    last = slice(count - 700, count)
    again = scene.shoot(origins[last], directions[last], mask=mask[last])
    np.testing.assert_array_equal(hits.t[last], again.t)
    np.testing.assert_array_equal(hits.object[last], again.object)


@pytest.mark.parametrize("aim", ["perspective", "orthographic"])
@pytest.mark.parametrize(
    "kept",
    [
        {"mask": 3},
        {"cull": "front"},
        {"t_min": 3.5},
        {"t_max": 3.2},
        {"t_min": 3.1, "t_max": 4.2, "mask": 6, "cull": "back"},
        {"objects": ["part 1", 3]},
        {"skip": (3, 0), "objects": 3},
    ],
)
def test_a_cameras_rays_are_filtered_like_any(aim, kept):
    scene = scene_of_four()
    camera = fh.Camera.look_at((4, 1, 2), (0, 0, 0), (0, 0, 1), 50, 24, 32, aim)
    hits, same = scene.shoot(camera, **kept), scene.shoot(*camera.rays(), **kept)
    assert hits.shape == (24, 32)
    for name in ("t", "object", "primitive", "normal", "position"):
        np.testing.assert_array_equal(getattr(hits, name), getattr(same, name))
    met = hits.object >= 0
    assert met.any()
    assert not np.array_equal(scene.shoot(camera).t, hits.t)
    assert np.isfinite(hits.z[met]).all()
    t = hits.t[met]
    assert (t > kept.get("t_min", 0)).all()
    assert (t <= kept.get("t_max", np.inf)).all()


def test_limits_of_a_camera_may_be_those_of_its_pixels():
    scene = ball()
    camera = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 30, 9, 7)
    first = scene.shoot(camera)
    second = scene.shoot(camera, t_min=first.t)
    met = second.object >= 0
    assert met.sum() == (first.object >= 0).sum() > 10
    assert (second.t[met] > first.t[met]).all()
    with pytest.raises(ValueError, match="camera"):
        scene.shoot(camera, t_min=np.ones((2, 9, 7)))


def test_objects_are_chosen_by_identifier_or_name():
    scene, (origins, directions) = scene_of_four(), rays(800)
    for given, meant in [
        ("part 0", [0, 3]),
        (2, [2]),
        (np.int32(1), [1]),
        (np.array([1, 2]), [1, 2]),
        ([], []),
        ([0, "part 1"], [0, 1]),
    ]:
        hits = scene.shoot(origins, directions, objects=given)
        assert set(hits.object[hits.object >= 0].tolist()) == set(meant)
        bits = fh.Scene()
        for k, made in enumerate(scene.objects):
            bits.add(made.shape, transform=made.transform, mask=int(k in meant))
        np.testing.assert_array_equal(hits.t, bits.shoot(origins, directions, mask=1).t)
    for wrong, error, match in [
        ("part", ValueError, "no object with the name 'part'"),
        (9, IndexError, "no object 9; there are 4"),
        (-1, IndexError, "no object -1"),
        (0.5, TypeError, "identifiers or names"),
        ([True], TypeError, "must be an int"),
    ]:
        with pytest.raises(error, match=match):
            scene.shoot(origins, directions, objects=wrong)


@pytest.mark.parametrize(
    ("kept", "match"),
    [
        ({"mask": -1}, "mask must be from 0 to 4294967295"),
        ({"mask": 1 << 32}, "mask must be from 0"),
        ({"mask": 0.5}, "mask must be whole numbers"),
        ({"mask": [1, 2, 3]}, "broadcast"),
        ({"cull": "both"}, "cull must be 'front', 'back' or None"),
        ({"skip": 3}, "skip must be a pair"),
        ({"skip": (0, 1, 2)}, "skip must be a pair"),
        ({"skip": (0, 1 << 31)}, r"skip\[1\] must be from"),
        ({"skip": ([0, 0, 0], 1)}, "broadcast"),
    ],
)
def test_wrong_filters_are_refused(kept, match):
    for ask in (fh.Scene.shoot, fh.Scene.occluded, fh.Scene.count, fh.Scene.shoot_all):
        with pytest.raises(ValueError, match=match):
            ask(ball(), [[0, 0, 5], [0, 0, 6]], [0, 0, -1], **kept)


def test_rays_that_leave_a_closed_mesh_cross_it_as_often_as_they_must():
    scene = fh.Scene()
    scene.add(fh.Mesh(*bumpy_sphere(40, 3)))
    hits = scene.shoot(*rays(20_000))
    hits = hits[hits.object >= 0]
    directions = RNG.normal(size=hits.normal.shape)
    leaving = hits.leave(directions)
    inwards = (directions * hits.normal).sum(-1) < 0
    counts = scene.count(leaving)
    np.testing.assert_array_equal(counts % 2 == 1, inwards)
    np.testing.assert_array_equal(scene.occluded(leaving), counts > 0)
    first = scene.shoot(leaving)
    np.testing.assert_array_equal(first.object >= 0, counts > 0)
    assert not ((first.primitive == hits.primitive) & (first.object >= 0)).any()
    # From the rounded positions without a filter some meet what they leave.
    rounded = scene.count(hits.position, directions)
    assert (rounded != counts).any()


def test_leaving_rays_broadcast_and_those_of_misses_meet_nothing():
    scene = ball()
    hits = scene.shoot([[0, 0, 5], [0, 3, 5]], [0, 0, -1])
    leaving = hits.leave([[[0, 0, -2]], [[0, 0, 1]], [[0, 1, -1]]])
    assert (leaving.shape, len(leaving)) == ((3, 2), 3)
    assert repr(leaving) == "LeavingRays(shape=(3, 2))"
    assert np.isnan(leaving.origin[:, 1]).all()
    np.testing.assert_array_equal(leaving.direction[1, 0], [0, 0, 1])
    met = scene.shoot(leaving)
    np.testing.assert_array_equal(met.t, [[1, np.inf], [np.inf, np.inf], [1, np.inf]])
    np.testing.assert_array_equal(scene.shoot(leaving, t_max=[0.5, 1]).t, np.full((3, 2), np.inf))
    np.testing.assert_array_equal(scene.shoot(leaving, cull="back").t, np.full((3, 2), np.inf))
    again = pickle.loads(pickle.dumps(leaving))
    np.testing.assert_array_equal(scene.shoot(again).t, met.t)
    one = scene.shoot((0, 0, 5), (0, 0, -1)).leave((0, 0, -1))
    assert float(scene.shoot(one).t) == 2
    with pytest.raises(TypeError, match="one ray"):
        len(one)
    with pytest.raises(ValueError, match="directions must be left out"):
        scene.shoot(leaving, [0, 0, 1])
    with pytest.raises(ValueError, match="broadcast against the hits"):
        hits.leave([[0, 0, 1]] * 3)
    with pytest.raises(ValueError, match="shape"):
        hits.leave(1.0)
    with pytest.raises(TypeError, match=r"Hits\.leave"):
        fh.LeavingRays()


def test_filters_are_kept_whatever_becomes_of_their_arrays():
    scene = fh.Scene()
    scene.add(fh.Mesh(*SQUARE), mask=2)
    directions = np.array([[0, 0, -1.0]])
    hits = scene.shoot([[0.25, 0.5, 1]], directions)
    leaving = hits.leave(directions)
    directions[:] = [0, 0, 1]
    np.testing.assert_array_equal(leaving.direction, [[0, 0, -1]])
    mask = np.full(2, 2)
    kept = scene.shoot([[0.25, 0.5, 1], [0.5, 0.25, 1]], [0, 0, -1], mask=mask)
    mask[:] = 0
    assert (kept.object == 0).all()
    assert scene.objects[0].mask == 2


def test_of_copies_in_one_place_each_ray_meets_those_that_it_sees():
    scene, (origins, directions) = fh.Scene(), rays(1200)
    mesh = fh.Mesh(*bumpy_sphere(12, 1))
    for bit in (1, 2, 4):
        scene.add(mesh, mask=bit)
        scene.add(fh.Box((2, -1, -1), (3, 1, 1)), mask=bit)
    mask = np.resize([1, 2, 4, 6, 3], 1200)
    hits, alone = scene.shoot(origins, directions, mask=mask), scene.shoot(origins, directions)
    np.testing.assert_array_equal(hits.t, alone.t)
    met = alone.object >= 0
    first = np.resize([0, 2, 4, 2, 0], 1200)
    np.testing.assert_array_equal(hits.object[met], (first + alone.object % 2)[met])
    for bit, k in ((1, 0), (2, 2), (4, 4)):
        one = scene.shoot(origins, directions, mask=bit)
        np.testing.assert_array_equal(one.object[met], (k + alone.object % 2)[met])
    counts = scene.count(origins, directions)
    np.testing.assert_array_equal(scene.count(origins, directions, mask=5) * 3, counts * 2)
    bits = np.resize([1, 3], 1200)
    share = np.resize([1, 2], 1200)
    np.testing.assert_array_equal(scene.count(origins, directions, mask=bits) * 3, counts * share)


def panes(*alphas):
    """Squares above each other, translucent by these alphas."""
    scene = fh.Scene()
    for height, alpha in enumerate(alphas):
        corners = [[-1, -1, height], [1, -1, height], [1, 1, height], [-1, 1, height]]
        mesh = fh.Mesh(corners, [[0, 1, 2], [0, 2, 3]])
        scene.add(mesh, material=fh.Material(alpha=alpha, alpha_mode="blend"))
    return scene


def test_rays_pass_what_is_translucent_below_an_alpha_by_query(tmp_path):
    scene = panes(1.0, 0.5, 0.2)
    down = ((0.3, 0.2, 9), (0, 0, -1))
    for blend_below, met in [(None, 2), (0.1, 2), (0.5, 1), (0.51, 0)]:
        assert scene.shoot(*down, blend_below=blend_below).object == met
        assert scene.count(*down, blend_below=blend_below) == met + 1
        assert (
            scene.shoot_all(*down, blend_below=blend_below).object.tolist() == [2, 1, 0][2 - met :]
        )
        occluded = scene.occluded(*down, t_max=7.5, blend_below=blend_below)
        assert occluded == (met == 2)
        above, below = (0.3, 0.2, 9), (0.3, 0.2, 1.5)
        assert scene.visible(above, below, blend_below=blend_below) == (met < 2)
        story = scene.explain(*down, blend_below=blend_below)
        assert (story.hit["object"], story.behind_count) == (met, met)
        camera = fh.Camera.look_at((0, 0, 9), (0, 0, 0), (0, 1, 0), 5, rows=2, columns=2)
        frame = fh.render(scene, camera, channels="object", blend_below=blend_below)
        assert (frame["object"] == met).all()
    camera = fh.Camera.look_at((0, 0, 9), (0, 0, 0), (0, 1, 0), 5, rows=2, columns=2)
    fh.render_many(scene, {"a": camera}, tmp_path / "seen", channels=["object"], blend_below=0.5)
    with np.load(tmp_path / "seen" / "parts" / "000000" / "a.npz") as made:
        assert (made["object"] == 1).all()
    rays = np.array([down[0]]), np.array([down[1]])
    fh.shoot_many(scene, rays, tmp_path / "shot", blend_below=0.5)
    with np.load(tmp_path / "shot" / "parts" / "000000" / "hits.npz") as made:
        assert made["object"].tolist() == [1]
    hits = pickle.loads(pickle.dumps(scene.shoot(*down, blend_below=0.5)))
    assert hits.object == 1
    assert scene.shoot(*down, blend_below=0.5, objects=[0, 2]).object == 0
    for wrong in (-0.1, 1.5, np.nan):
        with pytest.raises(ValueError, match="blend_below must be from 0 to 1, got"):
            scene.shoot(*down, blend_below=wrong)
