"""Masks: their run lengths, boxes and polygons, as pycocotools and OpenCV read them."""

import numpy as np
import pytest
from firsthit.annotations import Mask
from support import of_pycocotools

RNG = np.random.default_rng(13)


def random_masks():
    for k in range(150):
        shape = RNG.integers(1, 20, 2)
        mask = RNG.random(shape) < RNG.random()
        # Some with larger parts and holes.
        yield mask.repeat(3, axis=0).repeat(3, axis=1) if k % 3 == 0 else mask


@of_pycocotools
def test_pycocotools_makes_the_same_run_lengths_boxes_and_areas():
    coco = pytest.importorskip("pycocotools.mask")
    for mask in random_masks():
        own, theirs = Mask.of(mask), coco.encode(np.asfortranarray(mask.astype(np.uint8)))
        assert own.rle()["counts"].encode() == theirs["counts"]
        assert own.rle()["size"] == theirs["size"]
        assert own.pixels == coco.area(theirs)
        if mask.any():
            assert list(own.box) == coco.toBbox(theirs).tolist()
        np.testing.assert_array_equal(own.array, mask)
        flat = coco.frPyObjects({"size": [*mask.shape], "counts": own.run_lengths()}, *mask.shape)
        np.testing.assert_array_equal(coco.decode(flat), mask)
    # Long runs need several characters, with differences of both signs.
    wide = np.zeros((700, 900), bool)
    wide[100:103, 5:] = wide[:, 600] = wide[650, 800:] = True
    own, theirs = Mask.of(wide), coco.encode(np.asfortranarray(wide.astype(np.uint8)))
    assert own.rle()["counts"].encode() == theirs["counts"]


def test_slits_to_holes_go_along_the_edges_of_pixels():
    for mask in random_masks():
        for polygon in Mask.of(mask).polygons():
            steps = np.roll(polygon, -1, axis=0) - polygon
            assert ((steps == 0).sum(axis=1) == 1).all()


@of_pycocotools
@pytest.mark.parametrize("join", [False, True])
def test_pycocotools_makes_exactly_the_mask_of_its_polygons(join):
    coco = pytest.importorskip("pycocotools.mask")
    for mask in random_masks():
        found = Mask.of(mask).polygons(join=join)
        if not mask.any():
            assert found == []
            continue
        assert not join or len(found) == 1
        given = [polygon.reshape(-1).tolist() for polygon in found]
        made = coco.decode(coco.merge(coco.frPyObjects(given, *mask.shape)))
        np.testing.assert_array_equal(made, mask)


def test_opencv_fills_polygons_to_exactly_the_mask():
    cv2 = pytest.importorskip("cv2")
    # OpenCV draws the edge as well, so that each pixel is made of several.
    fine = 8
    for mask in random_masks():
        drawn = np.zeros(np.multiply(mask.shape, fine), np.uint8)
        for polygon in Mask.of(mask).polygons():
            cv2.fillPoly(drawn, [np.round(polygon * fine).astype(np.int32)], 1)
        np.testing.assert_array_equal(drawn[fine // 2 :: fine, fine // 2 :: fine], mask)


def test_a_mask_in_a_larger_picture_has_its_place_there():
    mask = Mask.of(np.eye(3, dtype=bool)[1:], shape=(10, 20), row=4, column=7)
    assert (mask.box, mask.shape) == ((8, 4, 2, 2), (10, 20))
    assert mask.array[4, 8]
    assert mask.array[5, 9]
    assert mask.array.sum() == 2
    assert [polygon.min(axis=0).tolist() for polygon in mask.polygons()] == [[8, 4], [9, 5]]
    with pytest.raises(ValueError, match="must be within the picture"):
        Mask.of(np.eye(3, dtype=bool), shape=(10, 20), row=8)
    with pytest.raises(ValueError, match="of bool, got int64"):
        Mask.of(np.eye(3, dtype=np.int64))


def test_numpy_takes_a_mask_for_its_array_and_saves_no_pickle(tmp_path):
    array = np.array([[0, 0, 0, 0], [0, 1, 1, 0]], bool)
    mask = Mask.of(array)
    np.save(tmp_path / "mask.npy", mask)
    for read in (np.load(tmp_path / "mask.npy"), np.asarray(mask), np.array(mask, copy=True)):
        assert read.dtype == bool
        np.testing.assert_array_equal(read, array)
    assert np.asarray(mask, np.uint8).dtype == np.uint8
    with pytest.raises(ValueError, match="always a new one"):
        mask.__array__(copy=False)
