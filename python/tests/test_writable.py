"""Arrays of one's own that hits fill, and numbers where one ray is asked."""

import firsthit as fh
import numpy as np
import pytest
from support import Dlpack, ball

RAYS = ([[0, 0, 5], [0, 0.6, 5], [0, 3, 5]], [0, 0, -1])


def test_channels_and_attributes_fill_an_array_of_one_s_own():
    hits = ball().shoot(*RAYS)
    for name, dtype in (
        ("t", np.float32),
        ("normal", float),
        ("object", np.int64),
        ("front", bool),
    ):
        out = np.zeros(hits.channel(name).shape, dtype)
        assert hits.channel(name, out=out) is out
        np.testing.assert_array_equal(out, hits.channel(name).astype(dtype))
    tensor = Dlpack(np.zeros((3, 3)))
    assert hits.channel("position", out=tensor) is tensor
    np.testing.assert_array_equal(tensor.array, hits.position)
    part = np.zeros((3, 2, 3))[:, 1]
    hits.channel("normal", out=part)
    np.testing.assert_array_equal(part, hits.normal)
    met = ball().shoot_all(*RAYS)
    out = np.empty(4)
    assert met.channel("t", out=out) is out
    np.testing.assert_array_equal(out, met.t)
    scene = fh.Scene()
    heat = {"heat": [1.0, 2.0, 3.0]}
    scene.add(fh.Mesh([[0, 0, 0], [9, 0, 0], [0, 9, 0]], [[0, 1, 2]], vertex_properties=heat))
    hits, out = scene.shoot(*RAYS), np.zeros(3)
    for filled in (hits.attribute("heat", out=out), hits.channel("attribute:heat", out=out)):
        assert filled is out
        np.testing.assert_array_equal(out, hits["heat"])


@pytest.mark.parametrize(
    ("out", "error", "message"),
    [
        (np.zeros(2), ValueError, r"out must have the shape \(3,\), got \(2,\)"),
        (np.zeros(3, np.int32), ValueError, "out must take float64, got an array of int32"),
        (np.broadcast_to(0.0, 3), ValueError, "got a read-only one"),
        ([0, 0, 0], TypeError, "out must be an array that can be written"),
    ],
)
def test_what_cannot_be_filled_is_refused(out, error, message):
    with pytest.raises(error, match=message):
        ball().shoot(*RAYS).channel("t", out=out)


def test_tables_can_be_copies_that_are_written():
    hits, met = ball().shoot(*RAYS), ball().shoot_all(*RAYS)
    scan = fh.Lidar([0, 90], [0, 0]).scan(ball())
    for thing in (hits, met, scan):
        table, views = thing.to_dict(copy=True), thing.to_dict()
        for name, column in table.items():
            np.testing.assert_array_equal(column, views[name])
            column[...] = 0
            assert name in ("row", "column") or not views[name].flags.writeable
    assert hits.t[0] == 4


def test_one_ray_s_hit_is_numbers_and_not_arrays_of_no_axes():
    scene = ball()
    hit = scene.shoot((0, 0, 5), (0, 0, -1))
    for name in ("t", "object", "primitive", "face", "node", "mesh", "material"):
        assert isinstance(hit.channel(name), np.number), name
        assert isinstance(getattr(hit, name), np.number), name
    assert isinstance(hit.front, np.bool_)
    assert isinstance(hit.incidence, np.float64)
    assert repr(hit.t) == "np.float64(4.0)"
    assert f"{hit.t} {hit.object}" == "4.0 0"
    assert hit.normal.tolist() == [0, 0, 1]
    t, found = hit
    assert (float(t), int(found), hit.t.shape) == (4, 0, ())
    assert hit.to_dict(["t", "normal"])["t"].tolist() == [4]
    one = scene.shoot(*RAYS)[1]
    assert isinstance(one.t, np.float64)
    single = scene.shoot((0, 0, 5), (0, 0, -1), dtype=np.float32)
    assert isinstance(single.t, np.float32)
    # So do all other questions about one ray or one point.
    assert isinstance(scene.occluded((0, 0, 5), (0, 0, -1)), np.bool_)
    assert scene.count((0, 0, 5), (0, 0, -1)) == np.int64(2)
    assert isinstance(scene.path_length((0, 0, 5), (0, 0, -1), by=None), np.float64)
    assert isinstance(scene.inside((0, 0, 0)), np.bool_)
    assert isinstance(scene.visible((0, 0, 5), (0, 0, 3)), np.bool_)
    assert isinstance(scene.signed_distance((0, 0, 5)), np.float64)
    assert isinstance(scene.thickness(hit), np.float64)
    near = scene.closest_point((0, 0, 5))
    assert isinstance(near.distance, np.float64)
    assert isinstance(near.object, np.int32)
