"""Every hit of rays: against first hits one after the other, closed forms, and parts of arrays."""

import copy
import pickle
import zipfile

import firsthit as fh
import numpy as np
import pytest
from firsthit._base.arrays import chosen
from support import SQUARE, ball, bumpy_sphere, output

#: More than goes to the native half at a time.
LONG = (1 << 19) + 1000


def onion():
    """Three balls around the origin, and a square."""
    scene = fh.Scene()
    for radius in (1, 2, 3):
        scene.add(fh.Sphere(center=(0, 0, 0), radius=radius))
    scene.add(fh.Mesh(*SQUARE))
    return scene


def rays(count, seed=1):
    origins, directions = np.random.default_rng(seed).uniform(-4, 4, (2, count, 3))
    return origins, directions


def test_the_hits_of_a_ball_are_where_the_roots_are():
    origins, directions = rays(2000)
    met = ball().shoot_all(origins, directions)
    a, b = (directions**2).sum(-1), (origins * directions).sum(-1)
    root = b * b - a * ((origins**2).sum(-1) - 1)
    with np.errstate(invalid="ignore"):
        near, far = (-b - np.sqrt(root)) / a, (-b + np.sqrt(root)) / a
    expected = (near > 0).astype(int) + (far > 0)
    np.testing.assert_array_equal(met.counts, expected)
    assert set(expected) == {0, 1, 2}
    both = met[expected == 2]
    np.testing.assert_allclose(both.t.reshape(-1, 2)[:, 0], near[expected == 2], rtol=1e-9)
    np.testing.assert_allclose(both.t.reshape(-1, 2)[:, 1], far[expected == 2], rtol=1e-9)
    np.testing.assert_array_equal(both.front.reshape(-1, 2), [[True, False]] * len(both))
    np.testing.assert_allclose(np.linalg.norm(met.position, axis=-1), 1, rtol=1e-12)
    np.testing.assert_allclose(met.normal, met.position, atol=1e-12)


def test_walking_from_hit_to_hit_leads_to_the_same():
    scene = fh.Scene()
    scene.add(fh.Mesh(*bumpy_sphere(12, 1)))
    scene.add(fh.Box((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)))
    scene.add(fh.Plane((0, 0, -1), (0, 0, 1)))
    origins, directions = rays(500)
    met = scene.shoot_all(origins, directions)
    start = np.zeros(500)
    for step in range(met.counts.max() + 1):
        walked = scene.shoot(origins, directions, t_min=start)
        here = met.counts > step
        np.testing.assert_array_equal(walked.object >= 0, here)
        places = met.offsets[:-1][here] + step
        np.testing.assert_array_equal(met.t[places], walked.t[here])
        np.testing.assert_array_equal(met.object[places], walked.object[here])
        np.testing.assert_array_equal(met.primitive[places], walked.primitive[here])
        np.testing.assert_array_equal(met.normal[places], walked.normal[here])
        start = np.where(here, walked.t, np.inf)
    np.testing.assert_array_equal(met.counts, scene.count(origins, directions))


def test_the_nearest_are_the_first_of_all():
    scene = onion()
    origins, directions = rays(2000)
    met = scene.shoot_all(origins, directions, t_min=-0.25, t_max=2)
    for k in (1, 3, 9):
        some = scene.shoot_all(origins, directions, k, t_min=-0.25, t_max=2)
        assert isinstance(some, fh.Hits)
        assert some.shape == (2000, k)
        there = np.arange(k) < met.counts[:, None]
        place = np.minimum(met.offsets[:-1, None] + np.arange(k), len(met.t) - 1)
        for name in met.channels:
            whole = met.channel(name)[place]
            mask = there.reshape(*there.shape, *[1] * (whole.ndim - 2))
            miss = {"t": np.inf, "front": False}.get(name, -1 if whole.dtype == "i4" else np.nan)
            np.testing.assert_array_equal(some.channel(name), np.where(mask, whole, miss), name)
    np.testing.assert_array_equal(some.origin[:, 5], origins)
    np.testing.assert_array_equal(some[:, 0].direction, directions)


@pytest.mark.parametrize(
    "index",
    [5, -1, slice(3, 7), np.arange(40) % 3 == 0, [5, 0, 5], np.array([[1, 2], [3, 0]]), ..., []],
    ids=str,
)
def test_some_rays_have_their_hits(index):
    scene = onion()
    origins, directions = rays(40)
    met = scene.shoot_all(origins, directions)
    some = met[index]
    expected = scene.shoot_all(origins[index], directions[index])
    if isinstance(some, fh.Hits):
        assert some.shape == (expected.counts,)
        expected = expected.hits
    else:
        assert some.shape == expected.shape
        np.testing.assert_array_equal(some.offsets, expected.offsets)
        np.testing.assert_array_equal(some.ray, expected.ray)
        np.testing.assert_array_equal(some.origin, expected.origin)
        np.testing.assert_array_equal(some.direction, expected.direction)
    for name in met.channels:
        np.testing.assert_array_equal(some.channel(name), expected.channel(name), name)


def test_rays_of_several_axes_broadcast_and_are_counted_row_by_row():
    scene = onion()
    origins, directions = rays(12)
    grid = scene.shoot_all(origins[:4, None], directions[None, :3])
    assert grid.shape == grid.counts.shape == (4, 3)
    assert len(grid) == 4
    for row, line in enumerate(grid):
        assert isinstance(line, fh.AllHits)
        assert line.shape == (3,)
        for column, hits in enumerate(line):
            alone = scene.shoot_all(origins[row], directions[column])
            np.testing.assert_array_equal(hits.t, alone.t)
            np.testing.assert_array_equal(grid[row, column].normal, alone.normal)
            np.testing.assert_array_equal(hits.origin, np.tile(origins[row], (len(hits), 1)))
    np.testing.assert_array_equal(grid.ray // 3, np.repeat(np.arange(4), grid.counts.sum(1)))
    some = scene.shoot_all(origins[:4, None], directions[None, :3], k=2)
    assert some.position.shape == (4, 3, 2, 3)
    np.testing.assert_array_equal(some.object[..., 0] >= 0, grid.counts > 0)
    np.testing.assert_array_equal(some.object[..., 1] >= 0, grid.counts > 1)


def test_one_ray_has_no_length():
    met = onion().shoot_all((0, 0, 9), (0, 0, -1))
    # The square has its corner there: the ray beside, a little further along +x, crosses it.
    assert (met.shape, met.counts.item(), met[()].shape) == ((), 7, (7,))
    assert met.t.tolist() == [6, 7, 8, 9, 10, 11, 12]
    with pytest.raises(TypeError, match="no length"):
        len(met)
    assert onion().shoot_all((0, 0, 9), (0, 0, -1), k=2).t.tolist() == [6, 7]


@pytest.mark.parametrize("count", [0, 1, 511, 3000])
def test_few_and_many_rays_come_to_the_same(count):
    scene = onion()
    origins, directions = rays(count)
    met = scene.shoot_all(origins, directions)
    for threads in (1, 3):
        again = scene.shoot_all(origins.astype("f8"), directions, threads=threads)
        np.testing.assert_array_equal(met.offsets, again.offsets)
        np.testing.assert_array_equal(met.t, again.t)
    assert met.hits.shape == (len(met.t),)
    assert met.offsets.dtype == np.int64
    assert scene.shoot_all(origins, directions, k=2).shape == (count, 2)


def test_long_arrays_are_done_in_parts():
    scene = ball()
    origins = np.zeros((LONG, 3), np.float32)
    origins[:, 2] = np.arange(LONG) % 3 * 2 - 2
    told = []
    met = scene.shoot_all(origins, [0, 0, 1], progress=lambda *numbers: told.append(numbers))
    assert told[-1] == (LONG, LONG)
    assert told == sorted(told)
    np.testing.assert_array_equal(met.counts, 2 - np.arange(LONG) % 3)
    np.testing.assert_array_equal(met[LONG - 1].t, met[(LONG - 1) % 3].t)
    some = scene.shoot_all(origins, [0, 0, 1], k=1)
    np.testing.assert_array_equal(some.t[:, 0], np.tile([1.0, 1, np.inf], LONG // 3 + 1)[:LONG])
    np.testing.assert_array_equal(some[-5:].normal, some.normal[-5:])


def test_what_is_kept_is_ours_and_goes_with_copies():
    scene = onion()
    origins, directions = rays(50)
    met, near = scene.shoot_all(origins, directions), scene.shoot_all(origins, directions, k=2)
    positions, firsts = met.position.copy(), near.position.copy()
    scene.add(fh.Sphere((0, 0, 0), 9))
    origins[:] = np.nan
    for kept in (met, copy.copy(met), copy.deepcopy(met), pickle.loads(pickle.dumps(met))):
        np.testing.assert_array_equal(kept.position, positions)
        np.testing.assert_array_equal(kept.ray, met.ray)
        assert np.isfinite(kept.origin).all()
        for array in (kept.t, kept.offsets, kept.counts, kept.ray, kept.position, kept.origin):
            with pytest.raises(ValueError, match="read-only"):
                array[...] = 0
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(near)).position, firsts)


def test_large_arrays_are_copied_too():
    origins = np.tile([0.0, 0, 5], (50_000, 1))
    met = ball().shoot_all(origins, [0, 0, -1])
    origins[:] = 7
    assert met.position[-1].tolist() == [0, 0, -1]
    assert met[9].origin.tolist() == [[0, 0, 5]] * 2


def test_all_hits_have_every_channel_that_they_name():
    scene = onion()
    met = scene.shoot_all([[0.2, 0.1, 5], [0, 9, 5]], [0, 0, -1])
    assert met.names("object") == met.hits.names("object") == ("",) * 4
    assert tuple(name for name, _ in met.items()) == met.channels
    for name, array in met.items():
        np.testing.assert_array_equal(getattr(met, name), array)


def test_whole_numbers_take_no_longer_among_many_rays():
    # An array of all their numbers has no room in memory.
    assert chosen((7, -1), (1 << 45, 8)).tolist() == 63
    assert chosen(-1, (1 << 45, 2)).tolist() == [(1 << 46) - 2, (1 << 46) - 1]
    met = ball().shoot_all(np.tile([0.0, 0, 5], (1000, 1)), [0, 0, -1])
    assert [len(each) for each in met] == [2] * 1000


def test_a_file_of_all_hits_has_their_rays_first(tmp_path):
    met = onion().shoot_all([[0.2, 0.1, 5], [0, 9, 5], [0, 0, 5]], [0, 0, -1])
    met.save(tmp_path / "a.npz", ["t", "normal"])
    assert np.load(tmp_path / "a.npz")["ray"].tolist() == met.ray.tolist()
    met.save(tmp_path / "packed.npz", ["t", "normal"], compress=True)
    with zipfile.ZipFile(tmp_path / "packed.npz") as packed:
        assert {entry.compress_type for entry in packed.infolist()} == {zipfile.ZIP_DEFLATED}
    assert np.load(tmp_path / "packed.npz")["t"].tolist() == met.t.tolist()
    met.save(tmp_path / "a-{channel}.npy")
    assert np.load(tmp_path / "a-ray.npy").tolist() == met.ray.tolist()
    for name in ("a.npz", "a-ray.npy"):
        assert fh.read_metadata(tmp_path / name)["channels"][0]["name"] == "ray"
    met.save(tmp_path / "t.npy")
    assert np.load(tmp_path / "t.npy").tolist() == met.t.tolist()


@pytest.mark.parametrize("index", [2, -1, np.int32(1), (1, -2), (np.uint8(2), 0), (), (0, 1, -1)])
def test_whole_numbers_lead_where_those_of_arrays_lead(index):
    origins = np.random.default_rng(2).uniform((-1, -1, 4), (1, 1, 6), (3, 4, 2, 3))
    hits, met = (ask(ball(), origins, [0, 0, -1]) for ask in (fh.Scene.shoot, fh.Scene.shoot_all))
    for name in ("t", "object", "origin", "position"):
        np.testing.assert_array_equal(getattr(hits[index], name), getattr(hits, name)[index])
    some = met[index]
    if isinstance(some, fh.AllHits):
        np.testing.assert_array_equal(some.counts, met.counts[index])
        np.testing.assert_array_equal(some.origin, met.origin[index])
    else:
        assert len(some) == met.counts[index]
        assert (some.origin == met.origin[index]).all()


@pytest.mark.parametrize("index", [3, -4, (0, 4), (0, 0, 2), (0, 0, 0, 0), 0.5])
def test_an_index_beyond_the_rays_is_refused_as_by_arrays(index):
    hits = ball().shoot(np.zeros((3, 4, 2, 3)), [0, 0, -1])
    with pytest.raises(IndexError) as expected:
        hits.t[index]
    with pytest.raises(IndexError) as refused:
        hits[index]
    assert str(refused.value) == str(expected.value)


def test_tables_have_a_row_for_each_hit(tmp_path):
    met = ball().shoot_all([[0, 0, 5], [0, 3, 5], [0, 0, 0]], [0, 0, -1])
    table = met.to_dict(["t", "normal"])
    assert list(table) == ["ray", "t", "normal_x", "normal_y", "normal_z"]
    assert table["ray"].tolist() == [0, 0, 2]
    met.save(tmp_path / "cloud.ply")
    assert fh.read_metadata(tmp_path / "cloud.ply")["shape"] == [3]
    assert repr(met) == "AllHits(shape=(3,), 3 hits)"


@pytest.mark.parametrize(
    ("k", "words"),
    [(0, "1 or more"), (-1, "1 or more"), (1.5, "a whole number"), (True, "a whole")],
)
def test_k_is_a_positive_number(k, words):
    with pytest.raises(ValueError, match=f"k must be {words}.*, got {k}"):
        ball().shoot_all((0, 0, 5), (0, 0, -1), k)


def test_what_does_not_fit_into_memory_is_refused():
    with pytest.raises(MemoryError):
        ball().shoot_all(np.zeros((9, 3)), (0, 0, -1), k=1 << 58)
    with pytest.raises(TypeError, match="made by"):
        fh.AllHits()
    with pytest.raises(ValueError, match="directions"):
        ball().shoot_all((0, 0, 5), (0, 0))


def test_ctrl_c_ends_it():
    script = """
scene = fh.Scene()
for radius in range(1, 2000):
    scene.add(fh.Sphere((0, 0, 0), radius))
def told(done, total):
    os.kill(os.getpid(), signal.SIGINT)
try:
    scene.shoot_all(np.zeros((400_000, 3)), [0, 0, 1], k=1, progress=told)
except KeyboardInterrupt:
    print("stopped")
"""
    assert output(script) == ["stopped"]
