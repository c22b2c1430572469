"""Points of clouds."""

import firsthit as fh
import laspy
import numpy as np
import pytest
import trimesh
from support import ball

CORNERS = np.array([[0.5, 0.25, 2.0], [4.0, -1.5, 0.0], [-7.0, 8.0, 1.25]])


@pytest.fixture
def scan():
    scene = fh.Scene()
    scene.add(fh.Box((-5, -4, -2), (5, 4, 3)))
    scene.add(fh.Sphere((2, 1, 0), 1))
    return fh.Lidar.spinning([-20.0, 0.0, 20.0], columns=32).scan(scene)


@pytest.mark.parametrize("extension", fh.LidarScan.EXTENSIONS)
def test_scans_are_read_from_every_format(scan, tmp_path, extension):
    if extension == ".parquet":
        pytest.skip("Parquet is a table of its own")
    path = tmp_path / f"scan{extension}"
    scan.save(path)
    points, columns = fh.read_points(path)
    bound = {".pcd": 1e-6, ".las": 6e-5, ".laz": 6e-5}.get(extension, 0.0)
    assert np.abs(points - scan.point).max() <= bound
    assert np.array_equal(columns["object"], scan.object)
    assert np.array_equal(columns["ring"], scan.ring)
    assert np.abs(columns["range"] - scan.range).max() <= bound


@pytest.mark.parametrize("version", ["1.2", "1.4"])
@pytest.mark.parametrize("extension", ["las", "laz"])
def test_other_programs_las_and_laz_are_read(tmp_path, version, extension):
    form = {"1.2": 3, "1.4": 7}[version]
    header = laspy.LasHeader(point_format=form, version=version)
    header.offsets, header.scales = [0, 0, 0], [0.001, 0.001, 0.001]
    header.add_extra_dim(laspy.ExtraBytesParams("quality", "f8"))
    las = laspy.LasData(header)
    many = np.random.default_rng(5).uniform(-50, 50, (120_000, 3)).round(3)
    las.xyz = many
    las.intensity = np.arange(len(many)) % 65536
    las.gps_time = np.arange(len(many)) / 7
    las.red = np.arange(len(many)) % 251
    las.classification = np.arange(len(many)) % 30
    las.quality = many[:, 0]
    las.write(tmp_path / f"a.{extension}")
    points, columns = fh.read_points(tmp_path / f"a.{extension}")
    assert np.array_equal(points, np.asarray(las.xyz))
    for name in ("intensity", "gps_time", "red", "classification", "quality"):
        assert np.array_equal(columns[name], np.asarray(las[name])), name
    assert columns["intensity"].dtype == np.uint16


def test_point_clouds_of_trimesh_are_read(tmp_path):
    cloud = trimesh.PointCloud(CORNERS, colors=[[1, 2, 3, 255]] * 3)
    for encoding in ("ascii", "binary_little_endian"):
        path = tmp_path / f"{encoding}.ply"
        path.write_bytes(trimesh.exchange.ply.export_ply(cloud, encoding=encoding.split("_")[0]))
        points, columns = fh.read_points(path)
        assert np.array_equal(points, CORNERS)
        assert columns["color"][0, :3].tolist() == [1, 2, 3]


def test_text_of_numpy_and_of_others_is_read(tmp_path):
    np.savetxt(tmp_path / "a.xyz", CORNERS)
    np.savetxt(tmp_path / "a.csv", CORNERS, delimiter=",", header="x,y,z")
    np.savetxt(tmp_path / "a.asc", CORNERS, header="X Y Z", comments="//")
    np.savetxt(tmp_path / "a.tsv", CORNERS, delimiter="\t", header="x\ty\tz", comments="")
    np.save(tmp_path / "a.npy", CORNERS.astype("f4"))
    np.savez(tmp_path / "a.npz", points=CORNERS, weight=[1, 2, 3], other=np.zeros(7))
    for extension in ("xyz", "csv", "asc", "tsv", "npy", "npz"):
        points, columns = fh.read_points(tmp_path / f"a.{extension}")
        assert np.array_equal(points, CORNERS), extension
        assert list(columns) == (["weight"] if extension == "npz" else [])


def test_pictures_give_the_points_of_their_pixels(tmp_path):
    scene = ball()
    frame = fh.render(scene, channels=["position", "normal", "object"])
    for extension in ("npz", "exr"):
        frame.save(tmp_path / f"a.{extension}")
        points, columns = fh.read_points(tmp_path / f"a.{extension}")
        expected = frame["position"].reshape(-1, 3)
        if extension == "exr":
            expected = expected.astype("f4").astype("f8")
        assert np.array_equal(points, expected, equal_nan=True)
        assert columns["normal"].shape == points.shape


def test_what_has_no_points_is_refused_with_its_line(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("1 2 3\n4 5\n")
    with pytest.raises(fh.FileFormatError, match=r"a\.txt: line 2: expected 3 columns, got 2"):
        fh.read_points(path)
    np.savez(tmp_path / "a.npz", rays=np.zeros((2, 6)))
    with pytest.raises(fh.FileFormatError, match=r"expected an array points or .* got rays"):
        fh.read_points(tmp_path / "a.npz")
    with pytest.raises(fh.FileReadError):
        fh.read_points(tmp_path / "none.las")
    trimesh.creation.box().export(tmp_path / "a.ply")
    with pytest.warns(fh.FirsthitWarning, match="12 of the element face are not read"):
        assert len(fh.read_points(tmp_path / "a.ply").positions) == 8
