"""Data sets: the same bytes however they are made, and frames that are kept."""

import json
import os
import pickle
import random
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import firsthit as fh
import numpy as np
import pytest
from dataset_support import LONG, PLANS, plan, record, tree
from firsthit._parts import scene_store
from firsthit._parts.digest import of_arrays
from firsthit._parts.job import known_job, write_job
from support import FULL

POSIX = pytest.mark.skipif(sys.platform == "win32", reason="signals are those of Unix")


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A data set that was made in one run."""
    folder = tmp_path_factory.mktemp("whole")
    made = fh.dataset(fh.Plan.from_dict(plan(), PLANS), folder)
    assert (made.frames, made.made, made.kept, made.missing) == (7, 7, 0, 0)
    return folder, made.digest


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_the_bytes_are_the_same_for_any_number_of_threads(whole, tmp_path, threads):
    made = fh.dataset(fh.Plan.from_dict(plan(), PLANS), tmp_path, threads=threads)
    assert made.digest == whole[1]
    assert tree(tmp_path) == tree(whole[0])


@pytest.mark.parametrize("on", [ThreadPoolExecutor(2), fh.many.processes(2)], ids=["threads", "2"])
def test_the_bytes_are_the_same_for_any_workers(whole, tmp_path, on):
    made = fh.dataset(fh.Plan.from_dict(plan(), PLANS), tmp_path, on=on)
    assert (made.made, made.digest) == (7, whole[1])
    assert tree(tmp_path) == tree(whole[0])
    state = fh.parts(tmp_path)
    assert (state.parts, state.done, state.digest) == (7, 7, whole[1])


@pytest.mark.parametrize("order", [(1, 2, 3), (3, 1, 2), (2, 3, 1)])
def test_parts_in_any_order_come_to_the_bytes_of_one_run(whole, tmp_path, order):
    parts = [fh.dataset(fh.Plan.from_dict(plan(), PLANS), tmp_path, part=(k, 3)) for k in order]
    assert sum(part.made for part in parts) == 7
    assert [part.kept for part in parts] == [0, 0, 0]
    assert [part.digest for part in parts[:2]] == [None, None]
    assert parts[2].digest == whole[1]
    assert tree(tmp_path) == tree(whole[0])


def test_more_parts_than_frames_leave_some_with_nothing_to_do(whole, tmp_path):
    made = fh.Plan.from_dict(plan(), PLANS)
    parts = [fh.dataset(made, tmp_path, part=(k, 9)) for k in range(1, 10)]
    assert sorted(part.made for part in parts) == [0, 0, 1, 1, 1, 1, 1, 1, 1]
    assert tree(tmp_path) == tree(whole[0])


def test_another_seed_makes_other_frames(whole, tmp_path):
    other = plan(lambda made: made["poses"].update(seed=4))
    assert fh.dataset(fh.Plan.from_dict(other, PLANS), tmp_path).digest != whole[1]


def test_the_digest_is_that_of_the_arrays(whole):
    folder, _ = whole
    said, frame = record(folder, 2), folder / "frames" / "000002"
    picture, cloud = fh.Frame.load(frame / "eye.npz"), np.load(frame / "lidar.npz")
    arrays = {"pose": np.array(said["world_from_rig"]), "time": np.array(said["time"])}
    arrays |= {f"eye/{name}": picture[name] for name in ("color", "z", "object")}
    text = json.dumps(said["annotations"]["eye"], separators=(",", ":")).encode()
    arrays["eye/annotations"] = np.frombuffer(text, np.uint8)
    arrays |= {f"lidar/{name}": cloud[name] for name in cloud.files if name != "metadata"}
    assert of_arrays(arrays) == said["digest"]
    # One bit of one array is enough.
    arrays["eye/z"] = np.nextafter(arrays["eye/z"], 0)
    assert of_arrays(arrays) != said["digest"]


def stamps(folder):
    return {
        path.name: (path.stat().st_mtime_ns, path.stat().st_ino)
        for path in (folder / "frames").iterdir()
        if not path.name.startswith(".")
    }


def test_finished_frames_are_not_made_again(tmp_path):
    made = fh.Plan.from_dict(plan(), PLANS)
    fh.dataset(made, tmp_path, part=(1, 2))
    before = stamps(tmp_path)
    assert len(before) == 3
    done = fh.dataset(made, tmp_path)
    assert (done.made, done.kept) == (4, 3)
    after = stamps(tmp_path)
    assert {name: after[name] for name in before} == before
    assert fh.dataset(made, tmp_path) == (7, 0, 7, 0, done.digest)
    assert stamps(tmp_path) == after


def command(*arguments, **options):
    line = [sys.executable, "-m", "firsthit", "dataset", *map(str, arguments)]
    return subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options)


def finished(folder):
    frames = folder / "frames"
    there = frames.iterdir() if frames.is_dir() else ()
    return sum(not path.name.startswith(".") for path in there)


def stop_within(process, folder, count, how, after=0.0):
    """Stop a run when it has made so many frames; tell whether it was at work."""
    end = time.monotonic() + 60
    while finished(folder) < count and process.poll() is None and time.monotonic() < end:
        time.sleep(0.001)
    time.sleep(after)
    is_at_work = process.poll() is None
    process.send_signal(how)
    process.communicate(timeout=60)
    return is_at_work


@POSIX
def test_runs_that_are_killed_at_random_moments_come_to_the_same_bytes(long_plan, tmp_path):
    chance, out, kills = random.Random(5), tmp_path / "killed", 0
    kept, runs = {}, 6 if FULL else 3
    for _ in range(runs):
        process = command(long_plan, "-o", out, "--threads", "1")
        count = finished(out) + chance.randrange(1, 6)
        if stop_within(process, out, count, signal.SIGKILL, chance.uniform(0.0, 0.02)):
            assert process.returncode == -signal.SIGKILL
            kills += 1
        # What was whole before the kill is the same folder still.
        now = stamps(out)
        assert kept.items() <= now.items()
        kept = now
    assert kills >= runs - 2
    assert runs - 2 <= len(kept) < LONG
    last = fh.dataset(long_plan, out)
    assert (last.kept, last.made) == (len(kept), LONG - len(kept))
    assert kept.items() <= stamps(out).items()
    assert last == (LONG, last.made, last.kept, 0, fh.dataset(long_plan, tmp_path / "one").digest)
    assert tree(out) == tree(tmp_path / "one")


@POSIX
def test_ctrl_c_leaves_a_folder_that_can_be_gone_on_with(long_plan, tmp_path):
    out = tmp_path / "out"
    process = command(long_plan, "-o", out, "--threads", "1", start_new_session=True)
    assert stop_within(process, out, 3, signal.SIGINT)
    assert process.returncode == 130
    assert not [path for path in (out / "frames").iterdir() if path.name.startswith(".")]
    kept = finished(out)
    assert 3 <= kept < LONG
    assert fh.dataset(long_plan, out).kept == kept


def test_two_runs_at_the_same_time_do_no_harm(long_plan, tmp_path):
    runs = [command(long_plan, "-o", tmp_path / "out", "--threads", "1") for _ in range(2)]
    for run in runs:
        _, said = run.communicate(timeout=120)
        assert run.returncode == 0, said
    fh.dataset(long_plan, tmp_path / "one")
    assert tree(tmp_path / "out") == tree(tmp_path / "one")


def test_another_plan_is_refused_in_the_folder(whole, tmp_path):
    other = fh.Plan.from_dict(plan(lambda made: made["poses"].update(count=8)), PLANS)
    before = tree(whole[0])
    with pytest.raises(
        fh.FileWriteError, match=r"job\.json: the folder is another job's: its plan"
    ):
        fh.dataset(other, whole[0])
    assert tree(whole[0]) == before
    (tmp_path / "frames").mkdir()
    with pytest.raises(fh.FileWriteError, match=r"frames without a job\.json"):
        fh.dataset(other, tmp_path)


def test_another_version_of_the_answer_is_refused(tmp_path):
    made = fh.Plan.from_dict(plan(), PLANS)
    fh.dataset(made, tmp_path, part=(1, 7))
    path = tmp_path / "job.json"
    write_job(path, known_job(path) | {"answer": 0})
    with pytest.raises(fh.FileWriteError, match="its answer is 0, this one's 2"):
        fh.dataset(made, tmp_path)
    path.write_text(path.read_text().replace('"answer": 0', '"answer": 2'))
    with pytest.raises(fh.FileFormatError, match="its check does not fit what it says"):
        fh.dataset(made, tmp_path)
    path.write_text("{}")
    with pytest.raises(fh.FileFormatError, match="no job of firsthit"):
        fh.dataset(made, tmp_path)


@pytest.mark.parametrize(
    ("before", "after", "what"),
    [
        ("radius = 0.5", "radius = 0.6", "fingerprint"),
        ('name = "ball"', 'name = "bell"', "setting"),
        ("[[objects]]", 'background = { color = "red" }\n[[objects]]', "setting"),
        ("[[objects]]", "up = [0, 1, 0]\n[[objects]]", "setting"),
        ("[[objects]]", "shading = { samples = 2 }\n[[objects]]", "setting"),
    ],
)
def test_a_scene_that_changed_since_the_job_began_is_refused(tmp_path, before, after, what):
    scene = (PLANS / "yard.toml").read_text()
    (tmp_path / "yard.toml").write_text(scene)
    made = fh.Plan.from_dict(plan(), tmp_path)
    fh.dataset(made, tmp_path / "out", part=(1, 7))
    (tmp_path / "yard.toml").write_text(scene.replace(before, after, 1))
    words = rf"yard\.toml: not what it was when the job began: its {what} is"
    with pytest.raises(fh.FileFormatError, match=words):
        fh.dataset(made, tmp_path / "out")
    assert finished(tmp_path / "out") == 1


def cut_short(frame):
    path = frame / "eye.npz"
    path.write_bytes(path.read_bytes()[:-1])


def without_a_file(frame):
    (frame / "lidar.ply").unlink()


def with_another_record(frame):
    path = frame / "frame.json"
    path.write_text(path.read_text().replace('"time":0.0', '"time":1.0'))


def without_a_record(frame):
    (frame / "frame.json").unlink()


def with_a_changed_byte(frame):
    path = frame / "eye.npz"
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def with_a_pipe_for_a_record(frame):
    (frame / "frame.json").unlink()
    os.mkfifo(frame / "frame.json")


def with_a_record_that_has_no_end(frame):
    (frame / "frame.json").unlink()
    (frame / "frame.json").symlink_to("/dev/zero")


def with_a_record_that_is_nested_too_deeply(frame):
    (frame / "frame.json").write_text("[" * 200_000)


def that_is_a_link(frame):
    outside = frame.parent.parent.parent / "outside"
    frame.rename(outside)
    frame.symlink_to(outside)


@pytest.mark.parametrize(
    "damage",
    [
        cut_short,
        without_a_file,
        with_another_record,
        without_a_record,
        with_a_pipe_for_a_record,
        with_a_record_that_has_no_end,
        with_a_record_that_is_nested_too_deeply,
        that_is_a_link,
    ],
)
def test_a_damaged_frame_is_made_again(whole, tmp_path, damage):
    made = fh.Plan.from_dict(plan(), PLANS)
    out = tmp_path / "out"
    fh.dataset(made, out)
    damage(out / "frames" / "000004")
    again = fh.dataset(made, out)
    assert (again.made, again.kept, again.digest) == (1, 6, whole[1])
    assert tree(out) == tree(whole[0])


def test_what_is_no_job_is_told_at_once(tmp_path):
    os.mkfifo(tmp_path / "job.json")
    with pytest.raises(fh.FileFormatError, match="a pipe"):
        fh.dataset(fh.Plan.from_dict(plan(), PLANS), tmp_path)


def test_a_changed_byte_is_found_where_bytes_are_verified(whole, tmp_path):
    made = fh.Plan.from_dict(plan(), PLANS)
    fh.dataset(made, tmp_path)
    with_a_changed_byte(tmp_path / "frames" / "000004")
    assert fh.dataset(made, tmp_path).made == 0
    assert tree(tmp_path) != tree(whole[0])
    assert fh.dataset(made, tmp_path, verify=True).made == 1
    assert tree(tmp_path) == tree(whole[0])


def test_what_killed_runs_left_is_removed_after_a_day(tmp_path):
    made = fh.Plan.from_dict(plan(), PLANS)
    fh.dataset(made, tmp_path, part=(1, 7))
    left = [tmp_path / "frames" / f".00000{k}.{'0' * 31}{k}" for k in range(3)]
    for folder in left:
        folder.mkdir()
        (folder / "eye.npz").write_text("half")
    mine = tmp_path / "frames" / ".notes"
    mine.mkdir()
    for folder in (left[0], left[1], mine):
        os.utime(folder, (time.time() - 90_000,) * 2)
    fh.dataset(made, tmp_path, part=(1, 7))
    assert [folder.exists() for folder in (*left, mine)] == [False, False, True, True]


@pytest.mark.parametrize("stop", [0, 1, 9, 11])
def test_a_run_that_ends_while_it_puts_together_is_gone_on_with(whole, tmp_path, monkeypatch, stop):
    made, written, write = fh.Plan.from_dict(plan(), PLANS), [], fh.datasets._merge.write

    def ending(path, content):
        if len(written) == stop:
            path.with_name(f".{path.name}.{'0' * 32}").write_bytes(content[:5])
            raise KeyboardInterrupt
        written.append(path)
        write(path, content)

    with monkeypatch.context() as patched:
        patched.setattr("firsthit.datasets._merge.write", ending)
        with pytest.raises(KeyboardInterrupt):
            fh.dataset(made, tmp_path)
    (left,) = tmp_path.rglob(f".*.{'0' * 32}")
    os.utime(left, (time.time() - 90_000,) * 2)
    assert fh.dataset(made, tmp_path).made == 0
    assert tree(tmp_path) == tree(whole[0])
    assert not left.exists()


def test_a_plan_pickles(whole, tmp_path):
    data = plan()
    made = pickle.loads(pickle.dumps(fh.Plan.from_dict(data, PLANS)))
    assert fh.dataset(made, tmp_path).digest == whole[1]
    kept = fh.Plan.from_dict(data, PLANS)
    data["poses"]["count"] = 1
    assert pickle.loads(pickle.dumps(kept)).frames == 7


def test_progress_counts_frames_and_an_exception_from_it_ends_the_run(tmp_path):
    made, told = fh.Plan.from_dict(plan(), PLANS), []

    def stop(done, total):
        told.append((done, total))
        if done == 2:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        fh.dataset(made, tmp_path, progress=stop)
    assert told == [(0, 7), (1, 7), (2, 7)]
    told.clear()
    fh.dataset(made, tmp_path, progress=lambda *both: told.append(both))
    assert told == [(done, 7) for done in range(2, 8)]


def test_progress_on_a_terminal_has_the_time_left(tmp_path, capsys, monkeypatch):
    clock = iter(range(0, 1000, 10))
    monkeypatch.setattr("firsthit._base.progress.time.monotonic", lambda: next(clock))
    fh.dataset(fh.Plan.from_dict(plan(), PLANS), tmp_path, progress=True)
    said = capsys.readouterr().err
    assert "1 of 7 frames, 14 %, 2 min left" in said
    assert "6 of 7 frames, 85 %, " in said


@pytest.mark.parametrize("part", [(0, 3), (4, 3), (1,), "1/3", (1, 0), (1.5, 3)])
def test_a_part_that_there_is_not_is_refused(tmp_path, part):
    with pytest.raises(ValueError, match="part must be"):
        fh.dataset(fh.Plan.from_dict(plan(), PLANS), tmp_path / "out", part=part)
    assert not (tmp_path / "out").exists()


def test_a_folder_that_cannot_be_written_to_is_an_error_of_writing(tmp_path):
    (tmp_path / "file").write_text("")
    made = fh.Plan.from_dict(plan(), PLANS)
    with pytest.raises(fh.FileWriteError, match="a file, not a folder"):
        fh.dataset(made, tmp_path / "file")
    with pytest.raises(fh.FileWriteError):
        fh.dataset(made, tmp_path / "file" / "below")


def test_a_frame_that_a_format_cannot_hold_is_named(tmp_path):
    made = plan(lambda made: made["output"].update(png_scale=1e-6))
    with (
        pytest.warns(fh.FirsthitWarning, match="PNGs of z end at 0.065535"),
        pytest.raises(ValueError, match=r"^frame 0: png_scale must be so large"),
    ):
        fh.dataset(fh.Plan.from_dict(made, PLANS), tmp_path)
    assert list(Path(tmp_path, "frames").iterdir()) == []


def test_a_plan_of_a_billion_frames_begins_at_once(tmp_path):
    made = fh.Plan.from_dict(plan(lambda made: made["poses"].update(count=10**9)), PLANS)

    def stop(done, total):
        assert total == 10**9
        if done == 2:
            raise RuntimeError("enough")

    begun = time.monotonic()
    for _ in range(2):
        with pytest.raises(RuntimeError, match="enough"):
            fh.dataset(made, tmp_path, progress=stop)
    part = fh.dataset(made, tmp_path, part=(10**9, 10**9))
    assert (part.made, part.missing) == (1, 10**9 - 3)
    assert time.monotonic() - begun < 30
    names = sorted(path.name for path in (tmp_path / "frames").iterdir())
    assert names == ["000000000", "000000001", "999999999"]


def test_scenes_of_a_job_are_read_once_more_only_where_they_are_needed(tmp_path, monkeypatch):
    read = []
    load = scene_store.load
    monkeypatch.setattr(
        "firsthit._parts.scene_store.load", lambda path: read.append(path.name) or load(path)
    )

    def three(made):
        made["scenes"] = [{"file": "yard.toml", "name": name} for name in "abc"]
        made["output"] = {}

    made = fh.Plan.from_dict(plan(three), PLANS)
    assert fh.dataset(made, tmp_path, part=(1, 100)).made == 0
    assert len(read) == 3
    assert fh.dataset(made, tmp_path, part=(2, 3)).made == 7
    assert len(read) == 4


def test_every_format_has_the_same_bytes_again(tmp_path):
    for package in ("laspy", "lazrs", "pyarrow"):
        pytest.importorskip(package)

    def with_all(made):
        made["poses"]["count"] = 2
        clouds = [extension[1:] for extension in fh.LidarScan.EXTENSIONS]
        made["output"] = {"clouds": clouds, "frames": ["npz", "exr"], "pictures": ["color"]}

    made = fh.Plan.from_dict(plan(with_all), PLANS)
    for name, threads in (("one", 1), ("two", 2)):
        fh.dataset(made, tmp_path / name, threads=threads)
    found = tree(tmp_path / "one")
    assert found == tree(tmp_path / "two")
    kinds = {name.rsplit(".", 1)[1] for name in found}
    assert kinds == {"npz", "ply", "pcd", "las", "laz", "csv", "parquet", "exr", "png", "json"}


def test_a_missing_package_is_told_before_anything_is_made(tmp_path, without):
    without("pyarrow")
    made = fh.Plan.from_dict(plan(lambda made: made["output"].update(clouds="parquet")), PLANS)
    with pytest.raises(ImportError, match="parquet takes the package pyarrow"):
        fh.dataset(made, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_each_scanner_has_noise_of_its_own_in_each_frame(tmp_path):
    lidar = {"kind": "lidar", "pattern": "spinning", "elevations": [-9], "columns": 60}
    pose = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 1]]
    asked = {
        "scenes": [{"file": "yard.toml"}],
        "sensors": [lidar | {"name": name, "noise": 0.1} for name in ("a", "b")]
        + [lidar | {"name": "c"}],
        "poses": {"kind": "list", "body": "forwards-left-up", "matrices": [pose, pose]},
    }
    fh.dataset(fh.Plan.from_dict(asked, PLANS), tmp_path)
    ranges = {
        (frame, name): np.load(tmp_path / "frames" / f"{frame:06d}" / f"{name}.npz")["range"]
        for frame in (0, 1)
        for name in "abc"
    }
    noisy = [ranges[frame, name] - ranges[0, "c"] for frame in (0, 1) for name in "ab"]
    assert (ranges[0, "c"] == ranges[1, "c"]).all()
    for k, one in enumerate(noisy):
        assert 0.05 < one.std() < 0.2
        for other in noisy[:k]:
            assert abs(np.corrcoef(one, other)[0, 1]) < 0.6


def test_the_bytes_of_a_plan_are_those_of_files_that_nothing_compresses(tmp_path):
    """Beams that all meet something, and every format."""
    scene = fh.Scene()
    scene.add(fh.Sphere((0, 0, 0), 50), name="all around")
    scene.save(tmp_path / "ball.fhs")
    channels = ["color", "z", "object", "normal", "crypto_object", "uv", "front"]
    data = {
        "scenes": [{"file": "ball.fhs"}],
        "sensors": [
            {"columns": 100, "rows": 80},
            {"kind": "lidar", "pattern": "spinning", "elevations": [0, 5, 9], "columns": 900},
        ],
        "poses": {"kind": "inside", "count": 1, "low": [-1, -1, -1], "high": [1, 1, 1]},
        "output": {"channels": channels, "frames": ["npz", "exr"], "pictures": ["color"]}
        | {"clouds": ["npz", "ply", "pcd", "csv", "las"]},
    }
    made = fh.Plan.from_dict(data, tmp_path)
    fh.dataset(made, tmp_path / "out")
    sizes = {name: file["bytes"] for name, file in record(tmp_path / "out", 0)["files"].items()}
    flat = sum(size for name, size in sizes.items() if name.startswith("lidar") or "npz" in name)
    exr_and_png = 100 * 80 * (4 * (3 + 1 + 1 + 3 + 12 + 2 + 1) + 3)
    assert made.cost().bytes - exr_and_png == pytest.approx(flat, rel=0.1)
    assert sizes["camera.exr"] + sizes["camera.color.png"] < exr_and_png


@pytest.mark.parametrize("workers", [None, ThreadPoolExecutor])
def test_a_data_set_is_not_all_there_where_its_scene_has_changed(tmp_path, workers):
    scene = (PLANS / "yard.toml").read_text()
    (tmp_path / "yard.toml").write_text(scene)
    made = fh.Plan.from_dict(plan(), tmp_path)
    done = fh.dataset(made, tmp_path / "out")
    before = tree(tmp_path / "out")
    (tmp_path / "yard.toml").write_text(scene.replace("radius = 0.5", "radius = 0.6"))
    with pytest.raises(fh.FileFormatError, match=r"yard\.toml: not what it was when the job began"):
        fh.dataset(made, tmp_path / "out", on=workers and workers(2))
    assert tree(tmp_path / "out") == before
    (tmp_path / "yard.toml").unlink()
    assert fh.dataset(made, tmp_path / "out").digest == done.digest
