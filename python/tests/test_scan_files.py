"""Files of scans, read by independent readers and by us."""

import io
import json
import pickle

import firsthit as fh
import numpy as np
import pytest
from lidar_support import layers, room


def test_a_scan_of_nothing_is_empty_and_can_be_saved(tmp_path):
    for how in ({}, {"returns": "all"}, {"divergence": 0.01}, {"noise": 1, "seed": 1}):
        scan = fh.Lidar([0, 1], [0, 0]).scan(fh.Scene(), **how)
        assert len(scan) == 0
        assert np.isinf(scan.to_image()).all()
        assert (scan.to_image("object") == -1).all()
        assert np.isnan(scan.to_image("point")).all()
    for name in ("a.npz", "a.ply", "a.pcd", "a.las"):
        scan.save(tmp_path / name)


@pytest.fixture
def scan():
    lidar = fh.Lidar.named("vlp-16", columns=50, position=(0.5, 0.25, 0.125), start=100)
    return lidar.scan(layers(), returns="all", intensity=True, range_gate=0.01)


def test_an_npz_is_read_by_numpy(scan, tmp_path):
    scan.save(tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz") as read:
        for name in list(scan.keys()):
            np.testing.assert_array_equal(read[name], scan[name])
        said = json.loads(str(read["metadata"]))
    assert said["sensor"]["words"] == {"pattern": "vlp-16"}
    units = {channel["name"]: channel["unit"] for channel in said["channels"]}
    assert units["time"] == "second"
    assert said["scan"]["returns"] == "all"
    assert {channel.pop("stored")["encoding"] for channel in said["channels"]} == {"exact"}
    assert said == json.loads(json.dumps(scan.metadata))


@pytest.mark.parametrize("extension", [".npz", ".ply", ".pcd"])
def test_what_files_of_scans_say_is_read_as_that_of_frames(scan, tmp_path, extension):
    path = tmp_path / f"a{extension}"
    scan.save(path)
    said = fh.read_metadata(path)
    assert said["sensor"] == scan.metadata["sensor"]
    assert [channel["name"] for channel in said["channels"]] == list(scan.keys())


def test_las_counts_no_further_than_it_can(tmp_path):
    laspy = pytest.importorskip("laspy")
    scene = fh.Scene()
    for k in range(20):
        scene.add(fh.Box((3 + k, -9, -9), (3.5 + k, 9, 9)))
    beam = fh.Lidar.spinning([0.0], columns=4, azimuth_start=-1, azimuth_end=1)
    scan = beam.scan(scene, returns="all")
    assert scan.number_of_returns.max() == 40
    scan.save(tmp_path / "a.las")
    read = laspy.read(tmp_path / "a.las")
    np.testing.assert_array_equal(read.return_number, np.minimum(scan.return_number, 15))
    assert set(np.asarray(read.number_of_returns)) == {15}


def test_a_laz_has_no_day(scan, tmp_path):
    pytest.importorskip("lazrs")
    scan.save(tmp_path / "a.laz")
    assert (tmp_path / "a.laz").read_bytes()[90:94] == bytes(4)


def test_a_ply_is_read_by_trimesh(scan, tmp_path):
    trimesh = pytest.importorskip("trimesh")
    scan.save(tmp_path / "a.ply")
    cloud = trimesh.load(tmp_path / "a.ply")
    np.testing.assert_array_equal(cloud.vertices, scan.point)
    data = cloud.metadata["_ply_raw"]["vertex"]["data"]
    np.testing.assert_array_equal(data["time"], scan.time)
    np.testing.assert_array_equal(data["ring"], scan.ring)


def test_a_pcd_is_what_its_header_says(scan, tmp_path):
    scan.save(tmp_path / "a.pcd")
    content = (tmp_path / "a.pcd").read_bytes()
    header, body = content.split(b"DATA binary\n", 1)
    said = dict(line.split(" ", 1) for line in header.decode().splitlines()[1:])
    fields, kinds, sizes = (said[name].split() for name in ("FIELDS", "TYPE", "SIZE"))
    columns = [
        (field, f"<{kind.lower()}{size}")
        for field, kind, size in zip(fields, kinds, sizes, strict=True)
    ]
    read = np.frombuffer(body, columns)
    assert len(read) == len(scan) == int(said["POINTS"])
    np.testing.assert_array_equal(read["x"], scan.point[:, 0].astype(np.float32))
    np.testing.assert_array_equal(read["return_number"], scan.return_number)
    np.testing.assert_array_equal(read["time"], scan.time)


@pytest.mark.parametrize("name", ["a.las", "a.laz"])
def test_a_las_and_a_laz_are_read_by_laspy(name, scan, tmp_path):
    laspy = pytest.importorskip("laspy")
    if name == "a.laz":
        pytest.importorskip("lazrs")
    scan.save(tmp_path / name)
    read = laspy.read(tmp_path / name)
    assert (str(read.header.version), read.header.point_format.id) == ("1.4", 6)
    assert len(read) == len(scan)
    np.testing.assert_allclose(read.xyz, scan.point, atol=0.50001e-4)
    np.testing.assert_array_equal(read.header.mins, read.xyz.min(axis=0))
    np.testing.assert_array_equal(read.header.maxs, read.xyz.max(axis=0))
    np.testing.assert_array_equal(read.gps_time, scan.time)
    np.testing.assert_array_equal(read.return_number, scan.return_number)
    np.testing.assert_array_equal(read.number_of_returns, scan.number_of_returns)
    np.testing.assert_allclose(read.intensity / 65535, scan.intensity, atol=0.51 / 65535)
    np.testing.assert_array_equal(read["range"], scan.range)
    for extra in ("ring", "object", "row", "column"):
        np.testing.assert_array_equal(read[extra], scan[extra])
    by_return = [np.count_nonzero(scan.return_number == k + 1) for k in range(15)]
    assert list(read.header.number_of_points_by_return) == by_return


def test_a_parquet_is_read_by_pyarrow(scan, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    scan.save(tmp_path / "a.parquet")
    table = parquet.read_table(tmp_path / "a.parquet")
    for name, column in scan.to_dict().items():
        np.testing.assert_array_equal(table[name].to_numpy(), column)
    assert json.loads(table.schema.metadata[b"firsthit"]) == scan.metadata


def test_a_las_of_a_far_place_has_the_steps_that_reach(tmp_path):
    pattern = {"azimuths": [0, 90], "elevations": [0, 0]}
    made = fh.Scene()
    made.add(fh.Box((-3e6, -3e6, -3e6), (3e6, 3e6, 3e6)))
    scan = fh.Lidar(**pattern, position=(1e5, 0, 0)).scan(made)
    laspy = pytest.importorskip("laspy")
    scan.save(tmp_path / "a.las")
    read = laspy.read(tmp_path / "a.las")
    assert read.header.scales.tolist() == [0.01] * 3
    np.testing.assert_allclose(read.xyz, scan.point, atol=0.00501)


def test_packages_that_are_missing_are_named(scan, tmp_path, without):
    without("pyarrow")
    with pytest.raises(ImportError, match="pip install pyarrow"):
        scan.save(tmp_path / "a.parquet")
    with pytest.raises(ValueError, match=r"path must end in one of \.npz"):
        scan.save(tmp_path / "a.e57")
    assert list(tmp_path.iterdir()) == []


def test_the_same_scan_has_the_same_bytes_and_writing_is_whole(scan, tmp_path):
    for name in ("a.ply", "a.pcd", "a.las"):
        scan.save(tmp_path / name)
        first = (tmp_path / name).read_bytes()
        pickle.loads(pickle.dumps(scan)).save(tmp_path / name)
        assert (tmp_path / name).read_bytes() == first
    with pytest.raises(fh.FileWriteError):
        scan.save(tmp_path / "none" / "a.las")
    out = io.BytesIO((tmp_path / "a.las").read_bytes())
    assert out.read(4) == b"LASF"


def test_an_npz_is_read_back_as_it_was(scan, tmp_path):
    other = fh.Lidar.named("vlp-16", columns=18).scan(
        layers(), returns="all", intensity=True, noise=0.1, seed=2
    )
    for written in (scan, other, fh.LidarScan.joined([other, other])):
        written.save(tmp_path / "a.npz")
        read = fh.LidarScan.load(tmp_path / "a.npz")
        assert (read.shape, read.keys(), read.metadata) == (
            written.shape,
            written.keys(),
            written.metadata,
        )
        for name in written.keys():  # noqa: SIM118 - a scan has no other names
            assert read[name].dtype == written[name].dtype
            np.testing.assert_array_equal(read[name], written[name])
        np.testing.assert_array_equal(read.to_image("time"), written.to_image("time"))
        again = fh.LidarScan.joined([read, written])
        assert again.shape[1] == 2 * written.shape[1]
        assert not read.range.flags.writeable


def test_what_is_no_npz_of_a_scan_is_refused(scan, tmp_path):
    scan.save(tmp_path / "good.npz")
    with np.load(tmp_path / "good.npz") as file:
        good = {name: file[name] for name in file.files}
    said = json.loads(str(good["metadata"]))

    def refused(what, **changed):
        arrays = {name: array for name, array in {**good, **changed}.items() if array is not None}
        np.savez(tmp_path / "bad.npz", **arrays)
        with pytest.raises(fh.FileFormatError, match=what):
            fh.LidarScan.load(tmp_path / "bad.npz")

    def with_words(**changed):
        return np.array(json.dumps({**said, **changed}))

    refused("lack a lidar", metadata=None)
    refused("lack a lidar", metadata=with_words(sensor=None))
    refused(
        r"\[1099511627776\] columns",
        metadata=with_words(sensor=said["sensor"] | {"columns": 1 << 40}),
    )
    refused(
        "4611686018427387904 x ", metadata=with_words(sensor=said["sensor"] | {"rows": 1 << 62})
    )
    refused("scans have no columns", metadata=with_words(scans=[{}]))
    refused("row must be from 0", metadata=with_words(sensor={**said["sensor"], "rows": 1}))
    refused("column must be from 0", column=np.full_like(good["column"], -1))
    refused("it has no ring", ring=None)
    refused("time must be float64", time=good["time"].astype(np.float32))
    refused(r"point must be float64 of the shape \(\d+, 3\)", point=good["point"][1:])
    with pytest.raises(fh.FileError):
        fh.LidarScan.load(tmp_path / "none.npz")
    with pytest.raises(
        fh.FileFormatError, match=r"good\.ply: a scan is .*; read_points reads \.ply"
    ):
        fh.LidarScan.load(tmp_path / "good.ply")


def test_a_las_says_what_it_is(tmp_path):
    laspy = pytest.importorskip("laspy")
    # So many turns that the metadata are longer than the 64 KiB of a record before the points.
    turn = fh.Lidar.named("vlp-16", columns=2).scan(layers())
    scan = fh.LidarScan.joined([turn] * 400)
    for name in ("a.las", "a.laz") if laspy.LazBackend.detect_available() else ("a.las",):
        scan.save(tmp_path / name)
        records = laspy.read(tmp_path / name).evlrs
        (own,) = (record for record in records if record.user_id == "firsthit")
        assert json.loads(own.record_data) == scan.metadata
    assert len(json.dumps(scan.metadata)) > 1 << 16


def test_las_has_the_classes_of_objects(tmp_path):
    laspy = pytest.importorskip("laspy")
    made = layers()
    made.add(fh.Box((-9, -9, -3), (9, 9, -2)), name="ground")
    lidar = fh.Lidar.named("vlp-16", columns=90)
    scan = lidar.scan(made, classes={"ground": 2, 0: 6, 1: 255})
    wanted = np.array([6, 255, 0, 2])[scan.object]
    np.testing.assert_array_equal(scan.classification, wanted)
    assert set(scan.classification.tolist()) == {0, 2, 6, 255}
    for name in ("a.las", "a.npz", "a.ply", "a.pcd"):
        scan.save(tmp_path / name)
    np.testing.assert_array_equal(laspy.read(tmp_path / "a.las").classification, wanted)
    read = fh.LidarScan.load(tmp_path / "a.npz")
    np.testing.assert_array_equal(read.classification, wanted)
    assert fh.read_metadata(tmp_path / "a.ply")["channels"][-1]["name"] == "classification"
    assert lidar.scan(made).classification is None
    for classes, error, message in (
        ({"none": 2}, ValueError, "no object with the name 'none'"),
        ({9: 2}, IndexError, "there is no object 9"),
        ({0: 256}, ValueError, r"classes\[0\] must be from 0 to 255, got 256"),
        ([2], TypeError, "classes must be a dict"),
    ):
        with pytest.raises(error, match=message):
            lidar.scan(made, classes=classes)


def test_rays_of_one_s_own_make_a_scan_with_its_files(tmp_path):
    made = layers()
    origins = np.array([[0, 0, k] for k in (0, 0.5, 60)], float)
    times, rings = np.array([[0.1, 0.2, 0.3]] * 2), [[5], [6]]
    rays = np.stack([origins, origins + np.array([0, 0.1, 0])]), (2, 0, 0)
    pose = [[0, -1, 0, 1], [1, 0, 0, 0], [0, 0, 1, 0]]
    how = {"time": times, "ring": rings, "intensity": 0.5, "pose": pose, "classes": {0: 4}}
    scan = fh.LidarScan.from_hits(made.shoot(*rays), **how)
    assert scan.shape == (2, 3)
    # The third ray of each row meets nothing.
    assert scan.column.tolist() == [0, 1, 0, 1]
    assert scan.range.tolist() == [4] * 4
    assert scan.ring.tolist() == [5, 5, 6, 6]
    assert scan.time.tolist() == [0.1, 0.2] * 2
    assert scan.intensity.tolist() == [0.5] * 4
    assert scan.classification.tolist() == [4] * 4
    world = scan.sensor_point @ np.array(pose)[:, :3].T + (1, 0, 0)
    np.testing.assert_allclose(world, scan.point, atol=1e-12)
    np.testing.assert_allclose(scan.point[:, 0], 4)
    np.testing.assert_array_equal(np.isinf(scan.to_image()), [[False, False, True]] * 2)
    each = np.broadcast_to(pose, (2, 3, 3, 4))
    again = fh.LidarScan.from_hits(made.shoot(*rays), **{**how, "pose": each})
    np.testing.assert_allclose(again.sensor_point, scan.sensor_point, atol=1e-12)
    for name in ("a.npz", "a.las", "a.ply", "a.pcd", "a.csv"):
        scan.save(tmp_path / name)
    read = fh.LidarScan.load(tmp_path / "a.npz")
    assert read.metadata == scan.metadata
    assert read.metadata["sensor"]["kind"] == "rays"
    assert fh.LidarScan.joined([scan, read]).shape == (2, 6)
    every = fh.LidarScan.from_hits(made.shoot_all(*rays))
    assert every.return_number.tolist()[:6] == [1, 2, 3, 4, 5, 6]
    assert every.number_of_returns.tolist()[:6] == [6] * 6
    assert every.range[:2].tolist() == pytest.approx([4, 4.001])
    one = fh.LidarScan.from_hits(made.shoot((0, 0, 0), (1, 0, 0)))
    assert (one.shape, len(one)) == ((1, 1), 1)
    assert len(fh.LidarScan.from_hits(made.shoot((0, 0, 0), (-1, 0, 0)))) == 0


@pytest.mark.parametrize(
    ("how", "message"),
    [
        ({"time": [1, 2]}, r"time must broadcast to \(3,\), got \(2,\)"),
        ({"time": np.nan}, "time must be finite"),
        ({"ring": 0.5}, "ring must be whole numbers"),
        ({"ring": -1}, "ring must be whole numbers from 0 on"),
        ({"pose": np.diag([1, 1, 2, 1])}, "pose must be a rotation"),
        ({"pose": np.zeros((2, 4, 4))}, r"pose must have the shape \(4, 4\)"),
        ({"intensity": "a"}, "intensity must be"),
    ],
)
def test_scans_of_rays_of_one_s_own_that_make_no_sense_are_refused(how, message):
    hits = room().shoot([[0, 0, 0]] * 3, (1, 0, 0))
    with pytest.raises(ValueError, match=message):
        fh.LidarScan.from_hits(hits, **how)
    with pytest.raises(ValueError, match="hits must have the shape"):
        fh.LidarScan.from_hits(room().shoot(np.zeros((2, 2, 2, 3)), (1, 0, 0)))
    with pytest.raises(TypeError, match="hits must be Hits"):
        fh.LidarScan.from_hits([1])


def test_scans_that_do_not_fit_are_not_joined():
    one = fh.Lidar.spinning([0, 1], 8).scan(room())
    with pytest.raises(ValueError, match="as many rows, got 2 and 1"):
        fh.LidarScan.joined([one, fh.Lidar.spinning([0], 8).scan(room())])
    with pytest.raises(ValueError, match="the same arrays"):
        fh.LidarScan.joined([one, fh.Lidar.spinning([0, 1], 8).scan(room(), intensity=True)])
    with pytest.raises(ValueError, match="at least one"):
        fh.LidarScan.joined([])
    with pytest.raises(TypeError, match="LidarScan"):
        fh.LidarScan.joined([room()])


def test_a_joined_scan_says_of_what_it_is():
    scans = [fh.Lidar.spinning([0, 1], 8, start=turn).scan(room()) for turn in range(3)]
    joined = fh.LidarScan.joined([fh.LidarScan.joined(scans[:2]), scans[2]])
    expected = [
        {
            "sensor": scan.metadata["sensor"]["digest"],
            "columns": 8,
            "scene": scan.metadata["scene"],
            "scan": scan.metadata["scan"],
        }
        for scan in scans
    ]
    assert joined.metadata["scans"] == expected
    assert len({each["sensor"] for each in expected}) == 1  # times are not in the digest
    assert joined.metadata["sensor"] == scans[0].metadata["sensor"]
    assert "scans" not in scans[0].metadata
    np.testing.assert_array_equal(joined.to_image()[:, 16:], scans[2].to_image())
    assert not joined.column.flags.writeable
