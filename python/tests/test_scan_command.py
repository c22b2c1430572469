"""The command ``firsthit scan``."""

import fcntl
import json
import os
import pty
import signal
import struct
import subprocess
import sys
import termios
import time

import firsthit as fh
import laspy
import numpy as np
import pytest
from firsthit._commands import scan as command
from support import TESTDATA

ROOM = """
[[objects]]
shape = "box"
low = [-4, -3, -1]
high = [4, 3, 2]

[[objects]]
shape = "sphere"
center = [2, 0.5, 0]
radius = 0.5
"""
DRIVE = "time,x,y,z,qx,qy,qz,qw\n3,-1,0,0,0,0,0,1\n3.3,1,0.2,0,0,0,0.6,0.8\n"


@pytest.fixture
def room(tmp_path, monkeypatch):
    """A scene file in the folder that the command works in."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "room.toml").write_text(ROOM)
    (tmp_path / "drive.csv").write_text(DRIVE)
    return fh.load("room.toml")


def arrays(file):
    """What an .npz holds, without its metadata."""
    with np.load(file) as held:
        return {name: held[name] for name in held.files if name != "metadata"}


def assert_same(file, scan):
    held = arrays(file)
    assert tuple(held) == scan.keys()
    for name, array in held.items():
        assert array.dtype == scan[name].dtype
        np.testing.assert_array_equal(array, scan[name], err_msg=name)


def fails(capsys, arguments, code, says):
    assert command.main(arguments.split()) == code
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("firsthit: error: ")
    assert says in said.err
    assert said.err.count("\n") == 1


def runs(arguments):
    assert command.main(arguments.split()) == 0


def child(arguments, **how):
    program = [sys.executable, "-m", "firsthit", "scan", *arguments.split()]
    return subprocess.run(program, capture_output=True, text=True, timeout=120, check=False, **how)


SIMPLE = {
    "--lidar VLP-16": lambda: fh.Lidar.named("vlp-16"),
    "--lidar os1-32 --columns 64 --rate 20 --start 2 --position 1,-0.5,0.25": lambda: (
        fh.Lidar.named("os1-32", 20, 64, start=2, position=(1, -0.5, 0.25))
    ),
    "--elevations -25,15,7 --columns 90": lambda: fh.Lidar.spinning(
        np.linspace(-25, 15, 7), columns=90
    ),
    "--elevations -9,9,3 --columns 50 --azimuth-start -60 --azimuth-end 60 "
    "--direction counterclockwise": lambda: fh.Lidar.spinning(
        [-9, 0, 9], 50, azimuth_start=-60, azimuth_end=60, direction="counterclockwise"
    ),
    "--raster 70,40 --rows 9 --columns 16": lambda: fh.Lidar.raster(70, 40, 9, 16),
    "--raster 70,40 --rows 9 --columns 16 --rate 5 --serpentine --start 2": lambda: fh.Lidar.raster(
        70, 40, 9, 16, rate=5, serpentine=True, start=2
    ),
    "--raster 70,40 --rows 9 --columns 16 --flash --start 2 --position 1,0,0": lambda: (
        fh.Lidar.raster(70, 40, 9, 16, rate=None, start=2, position=(1, 0, 0))
    ),
    "--rosette 38.4 --frequencies 121.6,-77.7 --points 500 --point-rate 1e4": lambda: (
        fh.Lidar.rosette(38.4, (121.6, -77.7), 500, 1e4)
    ),
    "--rosette 38.4 --frequencies -9,4 --points 50 --point-rate 1e3 --share 0.3 "
    "--start -1": lambda: fh.Lidar.rosette(38.4, (-9, 4), 50, 1e3, share=0.3, start=-1),
    "--lissajous 60,30 --frequencies 7,11 --points 500 --point-rate 1e3": lambda: (
        fh.Lidar.lissajous(60, 30, (7, 11), 500, 1e3)
    ),
    "--lissajous 60,30 --frequencies 7,11 --points 50 --point-rate 1e3 --phase -30": lambda: (
        fh.Lidar.lissajous(60, 30, (7, 11), 50, 1e3, phase=-30)
    ),
}


@pytest.mark.parametrize("options", SIMPLE)
def test_the_returns_are_those_of_the_lidar_bit_for_bit(room, capsys, options):
    runs(f"room.toml {options} -o a.npz")
    scan = SIMPLE[options]().scan(room)
    assert_same("a.npz", scan)
    rows, columns = scan.shape
    said = capsys.readouterr()
    assert said.out == f"a.npz: {len(scan):,} returns of {rows} x {columns} beams\n"
    assert said.err == ""


HOW = {
    "--returns all --max-returns 1": {"returns": "all", "max_returns": 1},
    "--returns last --range-gate 0.5": {"returns": "last", "range_gate": 0.5},
    "--divergence 0.003 --subrays 7 --range-gate 0.1 --returns strongest --intensity": {
        "divergence": 0.003,
        "subrays": 7,
        "range_gate": 0.1,
        "returns": "strongest",
        "intensity": True,
    },
    "--noise 0.02,0.001 --dropout 0.1 --seed 5": {
        "noise": (0.02, 0.001),
        "dropout": 0.1,
        "seed": 5,
    },
    "--noise 0.02 --seed 5": {"noise": 0.02, "seed": 5},
    "--min-range 2 --max-range 4.5 --threads 1": {"min_range": 2, "max_range": 4.5, "threads": 1},
}


@pytest.mark.parametrize("options", HOW)
def test_options_of_returns_are_those_of_scan(room, options):
    lidar = "--elevations -15,15,8 --columns 120"
    runs(f"room.toml {lidar} {options} -o a.npz")
    scan = fh.Lidar.spinning(np.linspace(-15, 15, 8), 120).scan(room, **HOW[options])
    assert len(scan) > 0
    assert_same("a.npz", scan)


def test_a_drive_is_scanned_turn_by_turn(room):
    """Three turns of a tenth of a second fit into the trajectory, from its first time on."""
    options = "--lidar vlp-16 --columns 60 --noise 0.01 --seed 8 --trajectory drive.csv"
    place = "--position 0,0,0.3"
    runs(f"room.toml {options} {place} -o a.npz -q")
    drive = fh.Trajectory.load("drive.csv", body="forwards-left-up")
    turns = [
        fh.Lidar.named(
            "vlp-16", columns=60, start=3 + turn / 10, trajectory=drive, position=(0, 0, 0.3)
        ).scan(room, noise=0.01, seed=8 + turn)
        for turn in range(3)
    ]
    joined = fh.LidarScan.joined(turns)
    assert joined.shape == (16, 180)
    assert_same("a.npz", joined)
    held = arrays("a.npz")
    for name in held:
        expected = np.concatenate([scan[name] for scan in turns])
        if name == "column":
            expected += np.repeat([0, 60, 120], [len(scan) for scan in turns])
        np.testing.assert_array_equal(held[name], expected)
    assert np.ptp(held["time"]) > 0.29


def test_a_rose_goes_on_from_turn_to_turn(room):
    """Turns of some points are one scan of all of them, as the curve depends on the time alone."""
    curve = "--rosette 50 --frequencies 12,-7.5 --point-rate 1000 --start 3"
    runs(f"room.toml {curve} --points 60 --turns 3 -o a.npz")
    whole = fh.Lidar.rosette(50, (12, -7.5), 180, 1000, start=3).scan(room)
    held = arrays("a.npz")
    np.testing.assert_array_equal(held["column"], whole.column)
    np.testing.assert_allclose(held["time"], whole.time, rtol=1e-15)
    np.testing.assert_allclose(held["point"], whole.point, rtol=1e-12, atol=1e-12)


def test_rasters_and_figures_fill_a_drive(room, capsys):
    """Three tenths of a second: at 20 pictures, or at 50 points a millisecond apart."""
    for options, turns in [
        ("--raster 70,40 --rows 3 --columns 4 --rate 20", 6),
        ("--lissajous 60,30 --frequencies 7,11 --points 50 --point-rate 1000", 6),
        ("--rosette 60 --frequencies 7,-11 --points 70 --point-rate 1000", 4),
    ]:
        runs(f"room.toml {options} --trajectory drive.csv -o a.npz --json")
        assert json.loads(capsys.readouterr().out)["turns"] == turns
        time = arrays("a.npz")["time"]
        assert time[0] == 3
        assert 3.2 < time.max() < 3.3


@pytest.mark.parametrize(
    ("options", "turns"),
    [
        ("", 1),
        ("--turns 4", 4),
        ("--duration 0.3", 3),
        ("--duration 0.39 --rate 10", 3),
        ("--duration 0.3 --rate 20", 6),
        ("--trajectory drive.csv --start 3.1", 2),
        ("--trajectory drive.csv --turns 2 --interpolation se3", 2),
        ("--trajectory drive.csv --turns 5 --extrapolation hold", 5),
    ],
)
def test_turns_and_durations_count_whole_turns(room, capsys, options, turns):
    runs(f"room.toml --lidar vlp-16 --columns 8 {options} --json")
    report = json.loads(capsys.readouterr().out)
    assert (report["turns"], report["rows"], report["columns"]) == (turns, 16, 8 * turns)
    assert report["outputs"] == ["room-scan.ply"]
    assert report["lidar"] == "vlp-16"
    assert report["warnings"] == []


def test_a_table_of_beams_is_scanned(room, tmp_path):
    (tmp_path / "beams.csv").write_text("azimuth,elevation,time,ring\n0,0,0,0\n90,5,0.1,1\n")
    runs("room.toml --pattern beams.csv -o a.npz")
    assert_same("a.npz", fh.Lidar.from_csv("beams.csv").scan(room))


def test_a_scanner_stands_upright_where_y_is_up(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    corners = "v -9 -1 -9\nv 9 -1 -9\nv 9 -1 9\nv -9 -1 9\nf 4 3 2 1\n"
    (tmp_path / "floor.obj").write_text(corners)
    options = "--elevations -20,-20,1 --columns 12 --position 1,0.5,2 -o a.npz"
    runs(f"floor.obj {options}")
    held = arrays("a.npz")
    # The cone of beams meets the floor in a circle around the scanner, 1.5 below.
    around = np.hypot(held["point"][:, 0] - 1, held["point"][:, 2] - 2)
    assert len(around) == 12
    wide = 1.5 / np.tan(np.radians(20))
    np.testing.assert_allclose(around, wide, rtol=1e-12)
    np.testing.assert_allclose(held["point"][:, 1], -1, rtol=1e-12)
    # Azimuth 0 is along x, and azimuths go to the left: from x to -z, seen from above.
    ahead = held["column"] == 6
    np.testing.assert_allclose(held["point"][ahead], [[1 + wide, -1, 2]], atol=1e-9)


def test_the_up_that_was_guessed_is_said(room, tmp_path, capsys):
    """A pyramid stands on the flat base that it has along y, which is not the convention of STL."""
    scanner, said = "--elevations -20,20,3 --columns 8 -o a.npz", "; guessed: up {} (--up)\n"
    corners = [(-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1), (0, 2, 0)]
    faces = [(0, 1, 2), (0, 2, 3), (1, 0, 4), (2, 1, 4), (3, 2, 4), (0, 3, 4)]
    facets = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join("vertex {} {} {}\n".format(*corners[k]) for k in face)
        + "endloop\nendfacet\n"
        for face in faces
    )
    (tmp_path / "tent.stl").write_text(f"solid tent\n{facets}endsolid tent\n")
    (tmp_path / "floor.obj").write_text("v 0 -1 0\nv 1 -1 0\nv 0 -1 1\nf 1 3 2\n")
    for file, up in [("tent.stl", "+y"), ("floor.obj", "+y")]:
        runs(f"{file} {scanner}")
        assert capsys.readouterr().out.endswith(said.format(up))
        runs(f"{file} {scanner} --json")
        assert json.loads(capsys.readouterr().out)["guessed"] == [f"up {up} (--up)"]
    # Where nothing is guessed, or no guess is used, none is said.
    (tmp_path / "pose.txt").write_text("1 0 0 0\n0 1 0 0\n0 0 1 0\n")
    for run in [
        f"tent.stl {scanner} --up 0,1,0",
        f"tent.stl {scanner} --pose pose.txt",
        f"tent.stl {scanner} --trajectory drive.csv",
        f"room.toml {scanner}",
    ]:
        runs(run)
        assert "guessed" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "forwards", "left"),
    [
        ("--aim 0,2,0", (0, 1, 0), (-1, 0, 0)),
        ("--aim 1,0,-1 --up 0,0,1", (0.5**0.5, 0, -(0.5**0.5)), (0, 1, 0)),
        ("--up 1,0,0", (0, 1, 0), (0, 0, 1)),
        ("--pose pose.txt", (0, 1, 0), (0, 0, 1)),
    ],
)
def test_a_scanner_looks_along_its_aim(room, tmp_path, options, forwards, left):
    (tmp_path / "pose.txt").write_text("0 0 1 0\n1, 0, 0, 0\n0 1 0 0\n")
    (tmp_path / "b.csv").write_text("azimuth,elevation\n0,0\n90,0\n")
    runs(f"room.toml --pattern b.csv {options} -o a.npz")
    held = arrays("a.npz")
    ways = held["point"] / held["range"][:, None]
    np.testing.assert_allclose(ways, [forwards, left], atol=1e-12)


def test_every_format_holds_the_returns(room, tmp_path):
    suffixes = fh.LidarScan.EXTENSIONS
    outputs = " ".join(f"-o a{suffix}" for suffix in suffixes)
    runs(f"room.toml --lidar vlp-16 --columns 36 --turns 2 --noise 0.01 --seed 1 {outputs}")
    scan = fh.LidarScan.joined(
        fh.Lidar.named("vlp-16", columns=36, start=turn / 10).scan(room, noise=0.01, seed=1 + turn)
        for turn in range(2)
    )
    for suffix in suffixes:
        scan.save(f"b{suffix}")
        if suffix not in (".laz", ".npz"):
            assert (tmp_path / f"a{suffix}").read_bytes() == (tmp_path / f"b{suffix}").read_bytes()
    assert_same("a.npz", scan)
    np.testing.assert_allclose(laspy.read("a.laz").xyz, scan.point, atol=0.51e-4)
    with (tmp_path / "a.csv").open() as lines:
        names = lines.readline().strip().split(",")
    assert tuple(names) == tuple(scan.to_dict())
    table = np.loadtxt("a.csv", delimiter=",", skiprows=1)
    for name, column in zip(names, table.T, strict=True):
        np.testing.assert_array_equal(column, scan.to_dict()[name])


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    [
        (
            "room.toml",
            2,
            "--raster --rosette --lissajous --pattern is required",
        ),
        ("room.toml --lidar vlp-17", 2, "--lidar must be one of vlp-16, "),
        ("room.toml --lidar vlp-16 --pattern a.csv", 2, "not allowed with argument --lidar"),
        ("room.toml --lidar vlp-16 --turns 1 --duration 1", 2, "not allowed with"),
        ("room.toml --lidar vlp-16 --turns 0", 2, "--turns: must be a whole number from 1 on"),
        ("room.toml --lidar vlp-16 --rate 0", 2, "--rate: must be above 0, got 0"),
        ("room.toml --lidar vlp-16 --duration 0.05", 2, "less than a turn of 0.1 s"),
        ("room.toml --lidar vlp-16 --position 1,2", 2, "must be 3 numbers, with commas"),
        ("room.toml --lidar vlp-16 --position 1,2,nan", 2, "must be 3 numbers, with commas"),
        ("room.toml --lidar vlp-16 --azimuth-start 0", 2, "--azimuth-start needs --elevations"),
        ("room.toml --elevations 5,-5,3", 2, "--elevations must be LOW,HIGH,N"),
        ("room.toml --elevations -5,5,2.5", 2, "a whole number of lasers, got 2.5"),
        ("room.toml --elevations -5,95,3", 2, "elevations must be from -90 to 90 degrees"),
        ("room.toml --lidar vlp-16 --subrays 4", 2, "--subrays needs --divergence"),
        ("room.toml --lidar vlp-16 --max-returns 4", 2, "--max-returns needs --returns all"),
        ("room.toml --lidar vlp-16 --noise 0.1", 2, "seed must be given with noise"),
        ("room.toml --lidar vlp-16 --seed 1", 2, "--seed needs --noise or --dropout"),
        ("room.toml --lidar vlp-16 --duration 1e9", 2, "fewer than 2^31 columns"),
        (f"room.toml --lidar vlp-16 --turns 2 --noise 0.1 --seed {2**63 - 1}", 2, "leave a number"),
        ("room.toml --lidar vlp-16 --divergence -3", 2, "divergence must be from 0"),
        ("room.toml --lidar vlp-16 --min-range 5 --max-range 4", 2, "must be from 0 on and incre"),
        ("room.toml --lidar vlp-16 --body forwards-left-up", 2, "--body needs --trajectory"),
        ("room.toml --lidar vlp-16 --trajectory drive.csv --aim 1,0,0", 2, "give a --pose"),
        ("room.toml --lidar vlp-16 --pose p.txt --position 0,0,0", 2, "--position must be left"),
        ("room.toml --lidar vlp-16 --aim 0,0,3", 2, "directions that are not parallel"),
        (
            "room.toml --lidar vlp-16 --trajectory drive.csv --turns 9",
            2,
            "within the times of the trajectory",
        ),
        ("room.toml --lidar vlp-16 --trajectory drive.csv --start 3.25", 2, "less than a turn"),
        (
            "room.toml --lidar vlp-16 --trajectory drive.csv --trajectory-format tum",
            2,
            "--body must be given with --trajectory-format tum",
        ),
        ("room.toml --pattern room.toml --columns 8", 2, "--columns must be left out"),
        ("room.toml --pattern room.toml --flash", 2, "--flash must be left out with --pattern"),
        ("room.toml --lidar vlp-16 --rows 8", 2, "--rows needs --raster"),
        ("room.toml --lidar vlp-16 --serpentine", 2, "--serpentine needs --raster"),
        ("room.toml --lidar vlp-16 --points 8", 2, "--points needs --rosette or --lissajous"),
        ("room.toml --raster 70,40 --rows 3", 2, "--raster needs --columns"),
        ("room.toml --raster 70 --rows 3 --columns 4", 2, "must be 2 numbers, with commas"),
        ("room.toml --raster 70,181 --rows 3 --columns 4", 2, "vertical_fov must be above 0"),
        ("room.toml --raster 70,40 --rows 3 --columns 4 --direction clockwise", 2, "--direction n"),
        ("room.toml --raster 7,4 --rows 3 --columns 4 --duration 0.01", 2, "a picture of 0.1 s"),
        (
            "room.toml --raster 70,40 --rows 3 --columns 4 --flash --serpentine",
            2,
            "--serpentine must be left out with --flash",
        ),
        ("room.toml --rosette 40 --points 9 --point-rate 9", 2, "--rosette needs --frequencies"),
        (
            "room.toml --rosette 40 --frequencies 1,2 --points 9 --point-rate 9 --columns 3",
            2,
            "--columns needs --lidar or --elevations or --raster",
        ),
        (
            "room.toml --rosette 40 --frequencies 1,2 --points 9 --point-rate 9 --phase 3",
            2,
            "--phase needs --lissajous",
        ),
        (
            "room.toml --rosette 40 --frequencies 1,2 --points 9 --point-rate 9 --share 3",
            2,
            "share",
        ),
        (
            "room.toml --lissajous 9,9 --frequencies 1,2 --points 9 --point-rate 9 --rate 3",
            2,
            "--rate needs --lidar or --elevations or --raster",
        ),
        (
            "room.toml --lissajous 9,9 --frequencies 1,2 --points 9 --point-rate 9 --duration 0.5",
            2,
            "less than the 1 s of 9 points: say --turns or fewer --points",
        ),
        ("room.toml --rosette 40 --raster 3,4", 2, "not allowed with argument --rosette"),
        ("room.toml --lidar vlp-16 -o a.txt", 2, "--output must end in one of .npz, "),
        ("room.toml --lidar vlp-16 -o a.ply -o a.ply", 2, "must not be given twice"),
        ("room.toml --lidar vlp-16 --shade x", 2, "unrecognized arguments: --shade x"),
        ("none.obj --lidar vlp-16", 3, "none.obj"),
        ("drive.csv --lidar vlp-16", 3, "drive.csv"),
        ("room.toml --lidar vlp-16 --trajectory none.csv", 3, "none.csv"),
        ("room.toml --lidar vlp-16 --trajectory room.toml", 3, "room.toml"),
        ("room.toml --pattern drive.csv", 3, "drive.csv"),
        ("room.toml --lidar vlp-16 --pose drive.csv", 3, "the 12 or 16 numbers of a 3 x 4"),
        ("room.toml --lidar vlp-16 -o none/a.ply", 4, "none/a.ply: no such folder"),
    ],
)
def test_what_is_wrong_is_one_line_and_an_exit_code(room, tmp_path, capsys, arguments, code, says):
    before = sorted(tmp_path.iterdir())
    fails(capsys, arguments, code, says)
    assert sorted(tmp_path.iterdir()) == before


def test_the_3d_file_itself_is_not_written_over(room, tmp_path, capsys):
    fh.Scene().save("empty.fhs")
    (tmp_path / "model.ply").symlink_to(tmp_path / "empty.fhs")
    fails(capsys, "empty.fhs --lidar vlp-16 -o model.ply", 2, "model.ply is an input")


def test_a_missing_package_is_said_before_the_scan(room, capsys, monkeypatch):
    # The second of the two packages, without which the first writes no LAZ.
    monkeypatch.setattr("firsthit._lidar.lidar_scan.find_spec", {"laspy": "there"}.get)
    fails(capsys, "none.obj --lidar vlp-16 -o a.laz", 4, "pip install 'laspy[lazrs]'")


def test_the_program_scans_and_reports_as_json(room, tmp_path):
    ran = child("room.toml --lidar VLP-16 --columns 36 -o a.npz --json", cwd=tmp_path)
    assert (ran.returncode, ran.stderr) == (0, "")
    scan = fh.Lidar.named("vlp-16", columns=36).scan(room)
    report = json.loads(ran.stdout)
    assert report["returns"] == len(scan)
    assert report["scene"] == scan.metadata["scene"]
    assert_same("a.npz", scan)
    failed = child("room.toml --lidar VLP-16 -o a.txt --json", cwd=tmp_path)
    assert failed.returncode == 2
    assert json.loads(failed.stdout)["exit_code"] == 2
    assert "-o FILE" in child("--help").stdout


def test_a_scan_that_meets_nothing_is_an_empty_cloud(room, tmp_path):
    ran = child("room.toml --lidar vlp-16 --position 99,0,9 --max-range 1 -o a.las", cwd=tmp_path)
    assert ran.returncode == 0
    assert ran.stderr == (
        "firsthit: warning: no beam met anything: the scanner starts at 99,0,9, the scene goes "
        "from -4,-3,-1 to 4,3,2, and ranges of 0 to 1 count\n"
    )
    assert ran.stdout == "a.las: 0 returns of 16 x 1808 beams\n"
    assert len(laspy.read("a.las").points) == 0


def test_ctrl_c_ends_a_long_scan_and_leaves_no_file(room, tmp_path):
    """On a terminal, where it shows how far it is."""
    mine, theirs = pty.openpty()
    # A terminal without a width has no room for a bar.
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("4H", 24, 80, 0, 0))
    program = [sys.executable, "-m", "firsthit", "scan"]
    before = sorted(tmp_path.iterdir())
    running = subprocess.Popen(
        [*program, "room.toml", "--lidar", "os1-128", "--turns", "100000"],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=theirs,
    )
    os.close(theirs)
    said = b""
    until = time.monotonic() + 60
    # The first percent is many turns away: 0 % shows that it has begun.
    while b"%" not in said and time.monotonic() < until:
        said += os.read(mine, 1024)
    assert b"%" in said, said
    running.send_signal(signal.SIGINT)
    try:
        assert running.wait(timeout=30) == 130
    finally:
        running.kill()
    while True:
        try:
            part = os.read(mine, 1024)
        except OSError:  # the terminal is gone
            break
        if not part:
            break
        said += part
    os.close(mine)
    assert said.endswith(b"firsthit: error: interrupted\r\n")
    assert running.stdout.read() == b""
    running.stdout.close()
    assert sorted(tmp_path.iterdir()) == before


def test_scans_that_do_not_fit_are_not_joined(room):
    one = fh.Lidar.spinning([0, 1], 8).scan(room)
    with pytest.raises(ValueError, match="as many rows, got 2 and 1"):
        fh.LidarScan.joined([one, fh.Lidar.spinning([0], 8).scan(room)])
    with pytest.raises(ValueError, match="the same arrays"):
        fh.LidarScan.joined([one, fh.Lidar.spinning([0, 1], 8).scan(room, intensity=True)])
    with pytest.raises(ValueError, match="at least one"):
        fh.LidarScan.joined([])
    with pytest.raises(TypeError, match="LidarScan"):
        fh.LidarScan.joined([room])


def test_a_joined_scan_says_of_what_it_is(room):
    scans = [fh.Lidar.spinning([0, 1], 8, start=turn).scan(room) for turn in range(3)]
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


def test_the_help_names_every_option_with_its_unit():
    text = command._parser().format_help()
    units = {
        "divergence": "RADIANS",
        "position": "scene units",
        "min-range": "scene units",
        "max-range": "scene units",
        "range-gate": "scene units",
        "noise": "scene units",
        "rate": "turns in a second",
        "duration": "SECONDS",
        "start": "SECONDS",
        "azimuth-start": "DEGREES",
        "elevations": "degrees",
        "raster": "degrees",
        "rosette": "degrees",
        "lissajous": "degrees",
        "frequencies": "in a second",
        "point-rate": "points in a second",
        "phase": "DEGREES",
    }
    for option, unit in units.items():
        begin = text.index(f"  --{option} ")
        assert unit in " ".join(text[begin : begin + 400].split()), option


def test_real_files_are_scanned(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    file = next(TESTDATA.rglob("*.ply"))
    assert command.main([str(file), "--lidar", "hdl-32e", "--columns", "90", "-q"]) == 0
    assert (tmp_path / f"{file.stem}-scan.ply").stat().st_size > 0


def test_nothing_that_was_read_is_written_over(room, tmp_path, capsys):
    (tmp_path / "beams.csv").write_text("azimuth,elevation\n0,0\n90,0\n")
    (tmp_path / "pose.csv").write_text("1 0 0 0 0 1 0 0 0 0 1 0\n")
    os.link("drive.csv", "second.csv")
    (tmp_path / "link.csv").symlink_to("beams.csv")
    kept = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    lidar = "room.toml --lidar vlp-16"
    for arguments, name in [
        (f"{lidar} --trajectory drive.csv -o drive.csv", "drive.csv"),
        (f"{lidar} --trajectory drive.csv -o second.csv", "second.csv"),
        ("room.toml --pattern beams.csv -o beams.csv", "beams.csv"),
        ("room.toml --pattern beams.csv -o link.csv", "link.csv"),
        (f"{lidar} --pose pose.csv -o ./pose.csv", "pose.csv"),
    ]:
        fails(capsys, arguments, 2, f"{name} is an input; it will not be overwritten")
    fails(capsys, f"{lidar} -o a.ply -o ./a.ply", 2, "must not be given twice")
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == kept


@pytest.mark.skipif(sys.platform != "linux", reason="FIFOs are waited for in steps on Linux")
def test_ctrl_c_ends_the_wait_for_the_reader_of_a_pipe(room):
    os.mkfifo("pipe.ply")
    program = [sys.executable, "-m", "firsthit", "scan", "room.toml", "--lidar", "vlp-16"]
    program += ["-o", "pipe.ply"]
    process = subprocess.Popen(program, stderr=subprocess.PIPE, text=True)
    time.sleep(3)
    assert process.poll() is None
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=10)
    assert (process.returncode, said) == (130, "firsthit: error: interrupted\n")
