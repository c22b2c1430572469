"""Cryptomattes, as other programs and users read them."""

import json

import firsthit as fh
import numpy as np
import pytest
from firsthit import _firsthit

ROWS, COLUMNS, SAMPLES = 24, 32, 16


def murmur3(data):
    """MurmurHash3, x86, 32 bits, in other steps than the package's own."""
    mask = 0xFFFFFFFF

    def turned(number, by):
        return (number << by | number >> (32 - by)) & mask

    total = 0
    for first in range(0, len(data), 4):
        word = int.from_bytes(data[first : first + 4], "little")
        word = turned(word * 0xCC9E2D51 & mask, 15) * 0x1B873593 & mask
        total ^= word
        if first + 4 <= len(data):
            total = (turned(total, 13) * 5 + 0xE6546B64) & mask
    total ^= len(data)
    total = (total ^ total >> 16) * 0x85EBCA6B & mask
    total = (total ^ total >> 13) * 0xC2B2AE35 & mask
    return total ^ total >> 16


def identifier(name):
    hashed = murmur3(name.encode())
    return hashed ^ 1 << 23 if hashed >> 23 & 255 in (0, 255) else hashed


def scene():
    made = fh.Scene()
    made.add(fh.Sphere(center=(0, 0, 0), radius=1), name="sphere")
    made.add(fh.Box((-3, -2, -3), (3, -0.7, -2)), name="bühne")
    return made


def camera():
    return fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 45, ROWS, COLUMNS)


@pytest.fixture(scope="module")
def frame():
    return fh.render(scene(), camera(), channels=("color", "crypto_object"), samples=SAMPLES)


def counted(seen_by):
    """Return for each object the share of samples that meet it, shot one sample after the other."""
    counts = np.zeros((2, ROWS, COLUMNS))
    for sample in range(SAMPLES):
        origins, directions = _firsthit.rays_of_rows(seen_by._native, (0, ROWS), sample)
        hits = scene().shoot(origins, directions)
        met = hits.object.reshape(ROWS, COLUMNS)
        counts += [met == 0, met == 1]
    return counts / SAMPLES


@pytest.mark.parametrize("aperture", [0.0, 0.8])
def test_mattes_are_the_shares_of_samples_that_meet_an_object(aperture):
    seen_by = camera().thin_lens(aperture, 5.0)
    made = fh.render(scene(), seen_by, channels="crypto_object", samples=SAMPLES)
    expected = counted(seen_by)
    for name, shares in zip(("sphere", "bühne"), expected, strict=True):
        np.testing.assert_array_equal(made.matte(name), shares.astype(np.float32))
        assert ((shares > 0) & (shares < 1)).sum() > 0
    both = made.matte(["sphere", "bühne"])
    np.testing.assert_array_equal(both, expected.sum(axis=0).astype(np.float32))
    assert both.min() == 0
    assert both.max() == 1


def test_openexr_reads_layers_attributes_and_manifest(frame, tmp_path):
    openexr = pytest.importorskip("OpenEXR")
    path = tmp_path / "mattes.exr"
    frame.save(path)
    with openexr.File(str(path), separate_channels=True) as file:
        header = dict(file.header())
        channels = {name: channel.pixels for name, channel in file.channels().items()}
    key = f"cryptomatte/{murmur3(b'CryptoObject'):08x}"[:-1]
    said = {what: header[f"{key}/{what}"] for what in ("name", "hash", "conversion", "manifest")}
    manifest = json.loads(said.pop("manifest"))
    assert said == {
        "name": "CryptoObject",
        "hash": "MurmurHash3_32",
        "conversion": "uint32_to_float32",
    }
    assert manifest == {name: f"{identifier(name):08x}" for name in ("sphere", "bühne")}
    layers = [f"CryptoObject{layer:02}.{letter}" for layer in range(3) for letter in "RGBA"]
    assert set(channels) == {"R", "G", "B", *layers}
    ids = np.stack([channels[name] for name in layers[0::2]], axis=-1)
    shares = np.stack([channels[name] for name in layers[1::2]], axis=-1)
    assert ids.dtype == shares.dtype == np.float32
    assert np.isfinite(ids).all()
    assert (np.diff(shares, axis=-1) <= 0).all()
    assert (shares.sum(axis=-1) <= 1).all()
    known = {int(text, 16): name for name, text in manifest.items()}
    assert set(np.unique(ids.view(np.uint32))) == {0, *known}
    for number, name in known.items():
        found = np.where(ids.view(np.uint32) == number, shares, 0).sum(axis=-1)
        np.testing.assert_array_equal(found, frame.matte(name))


@pytest.mark.parametrize("name", ["mattes.exr", "mattes.npz"])
def test_a_frame_from_a_file_has_its_mattes(frame, tmp_path, name):
    frame.save(tmp_path / name)
    read = fh.Frame.load(tmp_path / name)
    np.testing.assert_array_equal(read["crypto_object"], frame["crypto_object"])
    np.testing.assert_array_equal(read.matte("sphere"), frame.matte("sphere"))
    assert read.metadata["cryptomatte"]["crypto_object"]["name"] == "CryptoObject"
    read.save(tmp_path / f"again-{name}")
    again = (tmp_path / f"again-{name}").read_bytes()
    assert again == (tmp_path / name).read_bytes()


def test_names_that_the_scene_does_not_have_are_refused(frame):
    with pytest.raises(KeyError, match="no 'cube' in the manifest of crypto_object"):
        frame.matte("cube")
    with pytest.raises(KeyError, match="no channel 'crypto_material'"):
        frame.matte("sphere", "crypto_material")


def test_more_pairs_can_be_asked_for():
    made = fh.render(scene(), camera(), channels="crypto_object:8", samples=4)
    assert made.channels == ("crypto_object",)
    assert made["crypto_object"].shape == (ROWS, COLUMNS, 16)
    with pytest.raises(ValueError, match="even number of pairs from 2 to 64, got crypto_object:5"):
        fh.render(scene(), camera(), channels="crypto_object:5")
    with pytest.raises(ValueError, match="channels must be among"):
        fh.render(scene(), camera(), channels="z:8")


def test_a_png_refuses_mattes(frame, tmp_path):
    with pytest.raises(ValueError, match="other than a Cryptomatte for a PNG"):
        frame.save(tmp_path / "{channel}.png")


def test_mattes_go_with_colours_of_ones_own():
    made = fh.render(
        scene(),
        camera(),
        channels=("color", "crypto_object"),
        samples=4,
        shade=lambda hits: np.repeat(np.isfinite(hits.t)[..., None], 3, axis=-1),
    )
    np.testing.assert_allclose(made.matte(["sphere", "bühne"]), made["color"][..., 0], atol=1e-6)
