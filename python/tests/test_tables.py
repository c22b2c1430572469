"""Hits and frames as tables: masks, columns, names."""

import pickle

import firsthit as fh
import numpy as np
import pytest
from support import SQUARE, ball

CAMERA = fh.Camera.look_at((1, 2, 5), (0, 0, 0), (0, 1, 0), 30, rows=12, columns=16)
ORTHOGRAPHIC = fh.Camera((0, 0, 5), (0, 0, -1), (0, 1, 0), 1, 3, 3, 12, 16, "orthographic")


def scene():
    made = ball()
    made.add(fh.Mesh(*SQUARE, uvs=np.array(SQUARE[0])[:, :2]), transform=np.diag([3, 3, 3, 1.0]))
    return made


@pytest.mark.parametrize("camera", [CAMERA, ORTHOGRAPHIC])
@pytest.mark.parametrize(
    "index",
    [
        np.arange(192).reshape(12, 16) % 3 == 0,
        np.zeros((12, 16), bool),
        slice(2, 7),
        (slice(None), slice(None, None, -2)),
        (slice(None), 0),
        (slice(None, None, -1), slice(None, None, -1)),
        (3, slice(4, 9)),
        (3, 4),
        ...,
        (None, slice(2)),
        [5, 0, 5],
        (np.array([[1], [2]]), np.array([3, 4])),
        -1,
    ],
    ids=str,
)
def test_hits_are_indexed_as_arrays_of_their_shape_are(camera, index):
    for hits in (scene().shoot(camera), scene().shoot(*camera.rays())):
        some = hits[index]
        assert isinstance(some, fh.Hits)
        assert some.shape == np.empty(hits.shape)[index].shape
        for name in hits.channels:
            expected = hits.channel(name)
            rest = expected.shape[2:]
            chosen = expected[index]
            assert chosen.shape == (*some.shape, *rest)
            np.testing.assert_array_equal(some.channel(name), chosen, name)
        np.testing.assert_array_equal(some.origin, hits.origin[index])
        np.testing.assert_array_equal(some.direction, hits.direction[index])
        again = pickle.loads(pickle.dumps(some))
        np.testing.assert_array_equal(again.normal, some.normal)


def test_some_of_some_hits_are_some_of_all():
    hits = scene().shoot(CAMERA)
    met = hits[hits.object >= 0]
    far = met[met.z > 4.5]
    assert 0 < len(far) < len(met) < 192
    np.testing.assert_array_equal(far.z, hits.z[(hits.object >= 0) & (hits.z > 4.5)])
    np.testing.assert_array_equal(far.range, met.range[met.z > 4.5])
    with pytest.raises(IndexError, match="boolean index did not match"):
        hits[np.ones(5, bool)]
    np.testing.assert_array_equal(hits["z"], hits.z)


def test_one_direction_for_all_stays_one():
    origins = np.float32([[0, 0, 3], [0, 0, 4], [5, 5, 5]])
    hits = ball().shoot(origins, np.float32([0, 0, -1]))
    some = hits[[True, False, True]]
    np.testing.assert_array_equal(some.t, [2, np.inf])
    np.testing.assert_array_equal(some.direction, [[0, 0, -1]] * 2)


def test_the_length_is_that_of_the_first_axis():
    assert len(scene().shoot(CAMERA)) == 12
    assert len(ball().shoot(np.zeros((0, 3)), [0, 0, 1])) == 0
    one = ball().shoot([0, 0, 5], [0, 0, -1])
    with pytest.raises(TypeError, match="no length"):
        len(one)
    assert one
    assert ball().shoot(np.zeros((0, 3)), [0, 0, 1])


def test_items_are_the_channels_in_their_order():
    named = ("node", "mesh", "material")
    rest = ("normal", "incidence", "position", "barycentric", "uv")
    of_rays = ("t", "object", "primitive", "face", *named, *rest)
    hits = scene().shoot(*CAMERA.rays())
    assert (
        tuple(name for name, _ in hits.items())
        == (*of_rays, "base_color", "front")
        == hits.channels
    )
    hits = scene().shoot(CAMERA)
    assert [name for name, _ in hits.items()][:4] == ["t", "range", "z", "object"]
    for name, array in hits.items():
        np.testing.assert_array_equal(array, getattr(hits, name))
        np.testing.assert_array_equal(array, fh.render(scene(), CAMERA, channels=name)[name])
    with pytest.raises(ValueError, match=r"channel must be among t, range, z, .*, got 'color'"):
        hits.channel("color")
    with pytest.raises(ValueError, match="depth is called z, the distance along the camera's aim"):
        hits.channel("depth")
    with pytest.raises(AttributeError, match="no attribute 'depth'; depth is called z"):
        _ = hits.depth
    with pytest.raises(AttributeError, match=r"no attribute 'deep'$"):
        _ = hits.deep
    assert not hasattr(hits, "depth")
    with pytest.raises(AttributeError, match="depth is called t, the length along the ray"):
        _ = ball().shoot([0, 0, 5], [0, 0, -1]).depth
    with pytest.raises(AttributeError, match="range is for hits of a camera"):
        ball().shoot([0, 0, 5], [0, 0, -1]).channel("range")


def test_tables_have_a_row_for_each_ray_and_the_columns_of_the_program_s_csv():
    hits = ball().shoot([[0, 0, 5], [0, 3, 5]], [0, 0, -1])
    table = hits.to_dict()
    names = "t object primitive face node mesh material"
    expected = f"{names} normal_x normal_y normal_z incidence position_x position_y position_z"
    more = "barycentric_0 barycentric_1 barycentric_2 uv_u uv_v base_color_r base_color_g"
    assert list(table) == f"{expected} {more} base_color_b front".split()
    assert {(column.ndim, len(column)) for column in table.values()} == {(1, 2)}
    np.testing.assert_array_equal(table["position_z"], [1, np.nan])
    assert list(hits.to_dict(["object", "uv"])) == ["object", "uv_u", "uv_v"]
    assert list(hits.to_dict("uv")) == ["uv_u", "uv_v"]
    levels = ["base_color_r", "base_color_g", "base_color_b"]
    assert list(hits.to_dict("base_color")) == levels


def test_tables_of_a_camera_s_hits_know_their_pixels():
    hits = scene().shoot(CAMERA)
    table = hits.to_dict(["z"])
    assert list(table) == ["row", "column", "z"]
    np.testing.assert_array_equal(hits.z[table["row"], table["column"]], table["z"])
    mask = hits.object == 1
    some = hits[mask].to_dict(["z"])
    np.testing.assert_array_equal(np.stack([some["row"], some["column"]]), np.nonzero(mask))


def test_pandas_takes_tables():
    pandas = pytest.importorskip("pandas")
    hits = scene().shoot(CAMERA)
    frame = pandas.DataFrame(hits.to_dict())
    assert frame.shape == (192, 27)
    nearest = frame[frame.object >= 0].groupby("object").z.min()
    for number in (0, 1):
        assert nearest[number] == hits.z[hits.object == number].min()
    assert frame.dtypes["front"] == np.bool_
    assert frame.dtypes["object"] == np.int32


def test_frames_are_as_dicts():
    frame = fh.render(ball(), CAMERA, channels=("color", "z"), samples=1)
    assert list(frame.keys()) == list(frame) == ["color", "z"]
    for (name, array), value in zip(frame.items(), frame.values(), strict=True):
        assert array is value is frame[name]
    assert set(dict(frame)) == {"color", "z"}
