"""Output files, opened by the programs that people open them with."""

import json
import re
from typing import get_args

import firsthit as fh
import numpy as np
import pytest
from firsthit.typing import ChannelName
from support import ROOT, ball

ROWS, COLUMNS = 20, 30
CHANNELS = ("color", "t", "range", "z", "object", "primitive", "normal", "position", "uv", "front")
#: What an EXR calls the components of each channel.
EXR_NAMES = {
    "color": ["R", "G", "B"],
    "z": ["Z"],
    "normal": ["N.X", "N.Y", "N.Z"],
    "position": ["P.X", "P.Y", "P.Z"],
    "uv": ["uv.U", "uv.V"],
}


@pytest.mark.parametrize("dtype", ["i8", "u1", "u4", "i4", ">i2"])
def test_a_frame_of_integers_is_saved_as_int32(dtype, tmp_path):
    object_of = np.arange(6, dtype=dtype).reshape(2, 3)
    own = fh.Frame((2, 3), {"object": object_of, "attribute:a": object_of.astype(np.float16)})
    own.save(tmp_path / "{channel}.npy")
    assert np.load(tmp_path / "object.npy").dtype == np.int32
    np.testing.assert_array_equal(np.load(tmp_path / "object.npy"), object_of)
    assert np.load(tmp_path / "attribute-a.npy").dtype == np.float32
    assert own.metadata == {}
    assert own._png().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("shape", "channels", "error", "words"),
    [
        (
            (2, 3),
            {"t": np.zeros((3, 2))},
            ValueError,
            r"'t' must have the shape \(2, 3\) or \(2, 3",
        ),
        ((2, 3), {"t": np.zeros(6)}, ValueError, r"channel 't' must have the shape .* got \(6,\)"),
        ((2, 3), {"t": [["a"] * 3] * 2}, ValueError, "channel 't' must be bool or real numbers"),
        ((2, 3), {"t": [[1], [1, 2]]}, ValueError, "channel 't' must be an array"),
        ((2, 3, 4), {}, ValueError, r"shape must be \(rows, columns\), got \(2, 3, 4\)"),
        ((2, 3), [np.zeros((2, 3))], TypeError, "channels must be a dict of arrays"),
        ((2, 3), {1: np.zeros((2, 3))}, TypeError, "a name of channels must be a str, got 1"),
    ],
)
def test_a_frame_of_what_is_no_picture_is_refused_by_name(shape, channels, error, words):
    with pytest.raises(error, match=words):
        fh.Frame(shape, channels)


def test_an_integer_that_no_file_holds_is_refused_by_the_channel_s_name(tmp_path):
    own = fh.Frame((1, 1), {"object": np.full((1, 1), 2**31)})
    with pytest.raises(
        ValueError, match="channel 'object' must be int32 to be written, got 2147483648"
    ):
        own.save(tmp_path / "a.npy")
    assert not list(tmp_path.iterdir())


def scene():
    """A ball in the upper left, in front of nothing; a box in the lower right."""
    made = fh.Scene()
    made.add(fh.Sphere(center=(-1, 1, 0), radius=0.8), color=(1, 0.25, 0))
    made.add(fh.Box((0.2, -2, -1), (2, -0.2, 0)), color=(0, 0.5, 1))
    return made


def camera(projection="perspective"):
    return fh.Camera.look_at(
        (0, 0, 6), (0, 0, 0), (0, 1, 0), 45, ROWS, COLUMNS, projection=projection
    )


@pytest.fixture(scope="module")
def frame():
    return fh.render(scene(), camera(), channels=CHANNELS, background=(0.1, 0.2, 0.9))


@pytest.fixture(scope="module")
def exr(frame, tmp_path_factory):
    path = tmp_path_factory.mktemp("exr") / "all.exr"
    frame.save(path)
    return path


def as_float32(array):
    return array.astype(np.float32) if array.dtype == np.float64 else array


def test_openexr_reads_every_channel_exactly_under_its_documented_name(frame, exr):
    openexr = pytest.importorskip("OpenEXR")
    with openexr.File(str(exr), separate_channels=True) as file:
        header = dict(file.header())
        channels = {name: channel.pixels for name, channel in file.channels().items()}
    names = []
    for name in CHANNELS:
        parts = EXR_NAMES.get(name, [name])
        names += parts
        expected = as_float32(frame[name]).reshape(ROWS, COLUMNS, -1)
        for k, part in enumerate(parts):
            pixels = channels[part]
            assert pixels.shape == (ROWS, COLUMNS)
            if name in ("object", "primitive"):
                assert pixels.dtype == np.uint32
                pixels = pixels.view(np.int32)
            elif name == "front":
                assert pixels.dtype == np.uint32
            else:
                assert pixels.dtype == np.float32
            np.testing.assert_array_equal(pixels, expected[..., k], err_msg=part)
    assert set(channels) == set(names)
    assert header["compression"] == openexr.ZIP_COMPRESSION
    assert header["lineOrder"] == openexr.INCREASING_Y
    assert json.loads(header["firsthit"]) == fh.read_metadata(exr)
    # Row 0 is the top: the ball is in the upper left.
    identifiers = channels["object"].view(np.int32)
    assert identifiers[ROWS // 4, COLUMNS // 3] == 0
    assert identifiers[3 * ROWS // 4, 2 * COLUMNS // 3] == 1
    assert identifiers[0, -1] == -1


def test_opencv_reads_the_colours_of_an_exr(frame, exr, monkeypatch):
    monkeypatch.setenv("OPENCV_IO_ENABLE_OPENEXR", "1")
    cv2 = pytest.importorskip("cv2")
    if not re.search(r"OpenEXR:\s+(?!NO|\s)", cv2.getBuildInformation()):
        pytest.skip("this OpenCV is built without OpenEXR")
    pixels = cv2.imread(str(exr), cv2.IMREAD_UNCHANGED)
    assert pixels.dtype == np.float32
    np.testing.assert_array_equal(pixels[..., ::-1], frame["color"])


def test_opencv_reads_distances_in_steps(frame, tmp_path):
    cv2 = pytest.importorskip("cv2")
    frame.save(tmp_path / "{channel}.png", png_scale=0.001)
    steps = cv2.imread(str(tmp_path / "z.png"), cv2.IMREAD_UNCHANGED)
    assert (steps.dtype, steps.shape) == (np.uint16, (ROWS, COLUMNS))
    check_steps(steps, frame["z"])
    colors = cv2.imread(str(tmp_path / "color.png"), cv2.IMREAD_UNCHANGED)
    assert (colors.dtype, colors.shape) == (np.uint8, (ROWS, COLUMNS, 3))


def check_steps(steps, z):
    miss = np.isinf(z)
    assert 0 < miss.sum() < miss.size
    np.testing.assert_array_equal(steps == 0, miss)
    assert np.abs(steps[~miss] * 0.001 - z[~miss]).max() <= 0.0005 + 1e-12


def test_pillow_and_imageio_read_distances_in_steps_and_the_text(frame, tmp_path):
    from PIL import Image

    imageio = pytest.importorskip("imageio.v3")
    path = tmp_path / "z.png"
    fh.render(scene(), camera(), channels="z").save(path, png_scale=0.001)
    with Image.open(path) as picture:
        assert picture.mode == "I;16"
        check_steps(np.asarray(picture), frame["z"])
        said = json.loads(picture.text["firsthit"])
    assert said == fh.read_metadata(path)
    (channel,) = said["channels"]
    assert channel["stored"] == {
        "names": ["grey"],
        "dtype": "uint16",
        "encoding": "steps",
        "miss": "0",
        "scale": 0.001,
    }
    check_steps(imageio.imread(path), frame["z"])


def test_imageio_reads_colours_as_srgb_without_alpha(frame, tmp_path):
    imageio = pytest.importorskip("imageio.v3")
    frame.save(tmp_path / "a.png")
    pixels = imageio.imread(tmp_path / "a.png")
    assert (pixels.dtype, pixels.shape) == (np.uint8, (ROWS, COLUMNS, 3))
    linear = np.clip(frame["color"].astype(float), 0, 1)
    curve = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    np.testing.assert_array_equal(pixels, np.floor(255 * curve + 0.5))


def test_numpy_reads_the_metadata_of_an_npz_as_a_text(frame, tmp_path):
    frame.save(tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz", allow_pickle=False) as arrays:
        assert set(arrays) == {*CHANNELS, "metadata"}
        assert arrays["metadata"].shape == ()
        said = json.loads(str(arrays["metadata"]))
    assert said == fh.read_metadata(tmp_path / "a.npz")
    plain = [{k: v for k, v in c.items() if k != "stored"} for c in said["channels"]]
    assert plain == frame.metadata["channels"]


def test_an_npy_has_its_metadata_beside_it(frame, tmp_path):
    frame.save(tmp_path / "{channel}.npy")
    said = json.loads((tmp_path / "z.npy.json").read_text())
    assert said == fh.read_metadata(tmp_path / "z.npy")
    assert [c["name"] for c in said["channels"]] == ["z"]
    (tmp_path / "z.npy.json").unlink()
    assert fh.read_metadata(tmp_path / "z.npy") is None


def write_all(frame, seen, folder):
    """Write a frame in every format, with and without a scale and a tone map; return the paths."""
    for name in ("a.exr", "a.npz", "a.ply", "a.pcd", "{channel}.npy", "{channel}.png"):
        frame.save(folder / name)
    frame.save(folder / "shown.png", exposure=-0.5, tone_map="neutral")
    distances = fh.render(scene(), seen, channels=("t", "range", "z"))
    distances.save(folder / "{channel}-steps.png", png_scale=0.1)
    mattes = fh.render(scene(), seen, channels=("crypto_object", "crypto_material"))
    mattes.save(folder / "mattes.exr")
    paths = [path for path in folder.iterdir() if path.suffix != ".json"]
    assert len(paths) == 2 * len(frame) + 9
    return paths


@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
def test_every_file_says_what_the_schema_says_and_the_schema_says_no_more(projection, tmp_path):
    jsonschema = pytest.importorskip("jsonschema")
    schema = json.loads((ROOT / "docs" / "output-metadata.schema.json").read_text())
    validator = jsonschema.Draft202012Validator(schema)
    seen = camera(projection)
    names = [name for name in get_args(ChannelName) if not name.startswith("crypto_")]
    frame = fh.render(scene(), seen, channels=names)
    for said in (frame.metadata, *map(fh.read_metadata, write_all(frame, seen, tmp_path))):
        validator.validate(said)
        for name in ("position", "aim", "up"):
            np.testing.assert_array_equal(said["camera"][name], getattr(seen, name))
        for name in ("focal_length", "width", "height", "rows", "columns", "projection"):
            assert said["camera"][name] == getattr(seen, name)
        # A field without the schema, or a schema without the field, would be seen.
        for key in said:
            less = {other: said[other] for other in said if other != key}
            assert validator.is_valid(less) == (key in ("shading", "colors", "display")), key
        assert not validator.is_valid(said | {"surprise": None})
    del said["camera"]["pose"]
    assert not validator.is_valid(said)


def test_the_matrices_take_positions_to_their_pixels(frame):
    said = frame.metadata["camera"]
    pose = np.array(said["pose"]["world_from_camera"])
    k = np.array(said["intrinsics"]["k"])
    rows, columns = np.nonzero(frame["object"] >= 0)
    points = frame["position"][rows, columns]
    right_up_back = (points - pose[:3, 3]) @ pose[:3, :3]
    seen = right_up_back * [1, -1, -1]
    np.testing.assert_allclose(seen[:, 2], frame["z"][rows, columns], rtol=1e-12)
    pixels = (seen / seen[:, 2:]) @ k.T
    np.testing.assert_allclose(pixels[:, 0], columns + 0.5, atol=1e-9)
    np.testing.assert_allclose(pixels[:, 1], rows + 0.5, atol=1e-9)


def test_opencv_projects_points_with_k_when_its_convention_is_followed(frame):
    cv2 = pytest.importorskip("cv2")
    said = frame.metadata["camera"]
    k = np.array(said["intrinsics"]["k"])
    k[:2, 2] -= said["intrinsics"]["first_pixel_center"]
    camera_from_world = np.diag([1.0, -1, -1, 1]) @ np.linalg.inv(said["pose"]["world_from_camera"])
    rows, columns = np.nonzero(frame["object"] >= 0)
    turn, _ = cv2.Rodrigues(camera_from_world[:3, :3])
    pixels, _ = cv2.projectPoints(
        frame["position"][rows, columns], turn, camera_from_world[:3, 3], k, None
    )
    np.testing.assert_allclose(pixels[:, 0], np.stack([columns, rows], 1), atol=1e-6)


@pytest.mark.parametrize("name", ["a.exr", "a.npz"])
def test_a_frame_comes_back_from_its_file(frame, name, tmp_path):
    frame.save(tmp_path / name)
    again = fh.Frame.load(tmp_path / name)
    assert (again.shape, set(again)) == (frame.shape, set(frame))
    for channel in frame:
        expected = as_float32(frame[channel]) if name == "a.exr" else frame[channel]
        assert again[channel].dtype == expected.dtype
        np.testing.assert_array_equal(again[channel], expected)
    assert again.metadata["scene"] == frame.metadata["scene"]
    again.save(tmp_path / f"again-{name}")
    assert (tmp_path / f"again-{name}").stat().st_size > 0
    assert fh.read_metadata(tmp_path / f"again-{name}")["camera"] == frame.metadata["camera"]


def test_the_fingerprint_is_the_scenes_not_the_views():
    prints = {
        fh.render(scene(), view, shade=shade).metadata["scene"]
        for view in (camera(), camera("orthographic"))
        for shade in ("lambert", lambda hits: np.ones((*hits.shape, 3)))
    }
    assert len(prints) == 1
    other = scene()
    other.add_light(fh.DirectionalLight((0, 0, -1)))
    assert fh.render(other, camera()).metadata["scene"] not in prints


def test_files_of_others_have_no_metadata(tmp_path):
    np.savez(tmp_path / "a.npz", z=np.ones((2, 3)))
    assert fh.read_metadata(tmp_path / "a.npz") is None
    frame = fh.Frame.load(tmp_path / "a.npz")
    assert (frame.shape, frame.metadata) == ((2, 3), {})
    big_endian = np.asfortranarray(np.arange(24.0).reshape(2, 3, 4).astype(">f4"))
    np.save(tmp_path / "a.npy", big_endian)
    np.testing.assert_array_equal(fh.Frame.load(tmp_path / "a.npy")["array"], big_endian)
    (tmp_path / "a.exr").write_bytes(b"\x76\x2f\x31\x01 and no more")
    with pytest.raises(fh.FileFormatError):
        fh.Frame.load(tmp_path / "a.exr")
    with pytest.raises(fh.FileReadError):
        fh.read_metadata(tmp_path / "none.exr")


def test_an_exr_of_openexr_is_read_in_every_compression(tmp_path):
    openexr = pytest.importorskip("OpenEXR")
    rng = np.random.default_rng(1)
    z = rng.normal(size=(40, 33)).astype(np.float32)
    color = rng.normal(size=(40, 33, 3)).astype(np.float16)
    for name in ("NO", "RLE", "ZIPS", "ZIP", "PIZ"):
        header = {"compression": getattr(openexr, f"{name}_COMPRESSION")}
        path = tmp_path / f"{name}.exr"
        with openexr.File(header, {"RGB": color, "Z": z}) as file:
            file.write(str(path))
        frame = fh.Frame.load(path)
        np.testing.assert_array_equal(frame["z"], z)
        np.testing.assert_array_equal(frame["color"], color.astype(np.float32))


def test_what_16_bits_do_not_hold_is_refused_with_its_pixel(frame, tmp_path):
    with pytest.raises(ValueError, match=r"t is [\d.]+ at row \d+, column \d+; a scale of"):
        frame.save(tmp_path / "{channel}.png", png_scale=1e-5)
    assert not (tmp_path / "t.png").exists()


@pytest.mark.parametrize("name", ["a.exr", "a.npz"])
def test_a_transparent_frame_says_what_its_file_says(name, tmp_path):
    camera = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 45, rows=4, columns=5)
    frame = fh.render(ball(), camera, background="transparent", samples=4)
    assert frame["color"].shape == (4, 5, 4)
    frame.save(tmp_path / name)
    said, in_file = frame.metadata["channels"][0], fh.read_metadata(tmp_path / name)["channels"][0]
    assert said["components"] == 4
    assert {key: in_file[key] for key in said} == said


@pytest.mark.parametrize(
    "dtype", ["V9999", "S9999", "M8[s]", "O", "f8", "int64", "f4,f4", "float64"]
)
def test_metadata_that_name_another_type_are_refused(exr, tmp_path, dtype):
    start, end = b'"name":"object"', b'"stored"'
    before, after = exr.read_bytes().split(start)
    record, rest = after.split(end, 1)
    # As long as it was, so that all else in the file is where it was.
    assert b'"dtype":"int32"' in record
    other = f'"dtype":"{dtype}"'.encode()
    surplus = len(other) - len(b'"dtype":"int32"')
    record = record.replace(b'"dtype":"int32"', other.ljust(len(b'"dtype":"int32"')))
    if surplus > 0:
        about = record.split(b'"about":"')[1].split(b'"')[0]
        record = record.replace(about, about[surplus:])
    path = tmp_path / "other.exr"
    path.write_bytes(before + start + record + end + rest)
    words = f"other.exr: metadata of channel 'object': dtype must be int32 or bool, got '{dtype}'"
    with pytest.raises(fh.FileFormatError, match=re.escape(words)) as error:
        fh.Frame.load(path)
    assert error.value.path == str(path)


def test_an_exr_that_claims_more_than_it_holds_is_refused(exr, tmp_path):
    window = b"dataWindow\0box2i\0" + (16).to_bytes(4, "little")
    before, after = exr.read_bytes().split(window)
    for side in (20_000, 2**30):
        corners = b"".join(number.to_bytes(4, "little") for number in (0, 0, side, side))
        path = tmp_path / "large.exr"
        path.write_bytes(before + window + corners + after[16:])
        with pytest.raises(fh.FileFormatError, match="large"):
            fh.Frame.load(path)


def test_a_far_background_saturates_or_is_a_miss_as_asked(tmp_path):
    path = tmp_path / "z.png"
    far = fh.Frame((1, 3), {"z": np.array([[1.5, 70.0, np.inf]])})
    with pytest.raises(ValueError, match="unless `far` is given"):
        far.save(path, png_scale=0.001)
    for how, beyond in [("saturate", 65.535), ("zero", np.inf)]:
        far.save(path, png_scale=0.001, far=how)
        np.testing.assert_allclose(fh.Frame.load(path)["z"], [[1.5, beyond, np.inf]])
    with pytest.raises(ValueError, match="far must be 'saturate', 'zero' or None, got 'clip'"):
        far.save(path, png_scale=0.001, far="clip")
    with pytest.raises(ValueError, match="far needs png_scale"):
        far.save(path, far="zero")


def test_pillow_reads_labels_and_they_come_back(frame, tmp_path):
    from PIL import Image

    frame.save(tmp_path / "{channel}.png", png_labels=True)
    with Image.open(tmp_path / "object.png") as picture:
        np.testing.assert_array_equal(np.asarray(picture), frame["object"] + 1)
    again = fh.Frame.load(tmp_path / "object.png")["object"]
    assert again.dtype == np.int32
    np.testing.assert_array_equal(again, frame["object"])


def test_float32_on_request_and_packed_npz_hold_the_nearest_numbers(tmp_path):
    channels = ("z", "position", "object", "color")
    exact = fh.render(scene(), camera(), channels=channels)
    single = fh.render(scene(), camera(), channels=channels, dtype="float32")
    for name in channels:
        kind = np.int32 if name == "object" else np.float32
        assert single[name].dtype == kind
        np.testing.assert_array_equal(single[name], exact[name].astype(kind))
    single.save(tmp_path / "plain.npz")
    single.save(tmp_path / "packed.npz", compress=True)
    sizes = [(tmp_path / f"{name}.npz").stat().st_size for name in ("packed", "plain")]
    assert sizes[0] < 0.8 * sizes[1]
    with np.load(tmp_path / "packed.npz") as arrays:
        for name in channels:
            np.testing.assert_array_equal(arrays[name], single[name])
    again = fh.Frame.load(tmp_path / "packed.npz")
    assert again["z"].dtype == np.float32
    assert {each["dtype"] for each in again.metadata["channels"]} == {"float32", "int32"}
    rig = fh.Rig({"eye": camera()})
    assert rig.render(scene(), channels="z", dtype=np.float32)["eye"]["z"].dtype == np.float32
    with pytest.raises(ValueError, match="dtype must be float32 or float64"):
        fh.render(scene(), camera(), channels="z", dtype="float16")
