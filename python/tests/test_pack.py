"""Parts as tar files: what is in them, the same bytes, and what is refused."""

import hashlib
import io
import json
import os
import re
import shutil
import sys
import tarfile
from itertools import pairwise
from pathlib import Path

import firsthit as fh
import numpy as np
import pytest
from dataset_support import PLANS, plan, record, tree
from many_support import batches, cameras, forge, rays, scene

POSIX = pytest.mark.skipif(sys.platform == "win32", reason="links and pipes are those of Unix")
pytestmark = pytest.mark.usefixtures("workers_find_the_tests")


def samples(folder):
    """Read shards as WebDataset does: in their order, by the key up to a name's first dot."""
    held = None
    for path in sorted(Path(folder).glob("*.tar")):
        with tarfile.open(path) as tar:
            for entry in tar:
                if not entry.isreg():
                    continue
                found = re.match(r"^((?:.*/|)[^.]+)[.]([^/]*)$", entry.name)
                assert found is not None, entry.name
                key, extension = found[1], found[2].lower()
                if held is None or held["__key__"] != key:
                    if held is not None:
                        yield held
                    held = {"__key__": key, "__shard__": path.name}
                assert extension not in held, entry.name
                held[extension] = tar.extractfile(entry).read()
        yield held
        held = None


def entries(folder):
    """The entries of all shards."""
    for path in sorted(Path(folder).glob("*.tar")):
        with tarfile.open(path) as tar:
            yield from tar.getmembers()


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    """A job of three parts, with five pictures each but for the last."""
    folder = tmp_path_factory.mktemp("pictures")
    made = fh.render_many(
        scene(), cameras(), folder, channels=["z", "color"], save=[".npz", ".png"], part_size=5
    )
    assert made.parts == 3
    return folder


@pytest.fixture(scope="module")
def frames(tmp_path_factory):
    folder = tmp_path_factory.mktemp("frames")
    fh.dataset(fh.Plan.from_dict(plan(), PLANS), folder)
    return folder


def test_a_sample_is_a_picture_with_its_record(pictures, tmp_path):
    packed = fh.many.pack(pictures, tmp_path)
    assert (packed.samples, packed.parts, packed.missing) == (12, 3, 0)
    read = list(samples(tmp_path))
    assert [one["__key__"] for one in read] == [f"{k // 5:06d}-{k:06d}" for k in range(12)]
    for k, one in enumerate(read):
        part = pictures / "parts" / f"{k // 5:06d}"
        for extension in ("npz", "z.png", "color.png"):
            assert one[extension] == (part / f"{k:06d}.{extension}").read_bytes()
        said, whole = json.loads(one["json"]), json.loads((part / "part.json").read_text())
        names = [f"{k:06d}.{extension}" for extension in ("color.png", "npz", "z.png")]
        assert said.pop("files") == {name: whole["files"][name] for name in names}
        assert said.pop("pictures") == [f"{k:06d}"]
        assert said == {key: whole[key] for key in ("job", "part", "digest")}
        assert len(one) == 6
    assert packed.bytes == sum(path.stat().st_size for path in packed.shards)


def test_a_sample_is_what_a_sensor_sees_in_a_frame(frames, tmp_path):
    fh.many.pack(frames, tmp_path)
    read = {one["__key__"]: one for one in samples(tmp_path)}
    assert list(read) == [f"{k:06d}-{name}" for k in range(7) for name in ("eye", "lidar")]
    for k in range(7):
        folder, whole = frames / "frames" / f"{k:06d}", record(frames, k)
        eye, lidar = read[f"{k:06d}-eye"], read[f"{k:06d}-lidar"]
        assert eye["color.png"] == (folder / "eye.color.png").read_bytes()
        assert lidar["ply"] == (folder / "lidar.ply").read_bytes()
        masks = sorted(folder.glob("eye.visible/*.png"))
        assert masks
        for path in masks:
            assert eye[f"visible.{path.name}"] == path.read_bytes()
        said = json.loads(eye["json"])
        assert said["annotations"] == {"eye": whole["annotations"]["eye"]}
        assert said["world_from_rig"] == whole["world_from_rig"]
        assert json.loads(lidar["json"])["annotations"] == {}
        files = json.loads(eye["json"])["files"] | json.loads(lidar["json"])["files"]
        assert files == whole["files"]


def test_hits_folds_and_sights_are_packed_too(tmp_path):
    fh.shoot_many(scene(), rays(100), tmp_path / "hits", part_size=40)
    fh.shoot_many(scene(), rays(100), tmp_path / "fold", part_size=40, fold=fh.many.Sum())
    fh.visible_many(scene(), rays(20)[0], rays(30)[0], tmp_path / "seen", block=(8, 64))
    for job, name, extension in (
        ("hits", "hits", "npz"),
        ("fold", "fold", "npz"),
        ("seen", "block", "bin"),
    ):
        fh.many.pack(tmp_path / job, tmp_path / f"{job}.packed")
        read = list(samples(tmp_path / f"{job}.packed"))
        assert [one["__key__"] for one in read] == [f"{k:06d}-{name}" for k in range(3)]
        path = tmp_path / job / "parts" / "000001" / f"{name}.{extension}"
        assert read[1][extension] == path.read_bytes()


def test_the_same_job_is_the_same_bytes(pictures, tmp_path):
    fh.render_many(
        scene(),
        cameras(),
        tmp_path / "again",
        channels=["z", "color"],
        save=[".npz", ".png"],
        part_size=5,
        on=fh.many.processes(2),
    )
    os.utime(tmp_path / "again" / "parts" / "000000" / "000000.npz", (1, 1))
    (tmp_path / "again" / "parts" / "000000" / "000000.npz").chmod(0o600)
    first = fh.many.pack(pictures, tmp_path / "a", parts=1)
    fh.many.pack(tmp_path / "again", tmp_path / "b", parts=1)
    assert len(first.shards) == 3
    assert tree(tmp_path / "a") == tree(tmp_path / "b")
    names = []
    for entry in entries(tmp_path / "a"):
        names.append(entry.name)
        said = entry.mtime, entry.uid, entry.gid, entry.uname, entry.gname, entry.mode
        assert said == (0, 0, 0, "", "", 0o644)
        assert entry.pax_headers == {}
        assert re.fullmatch(r"[0-9]{6}-[0-9]{6}\.(json|npz|z\.png|color\.png)", entry.name)
    assert names == sorted(names, key=lambda name: (name.split(".")[0], ".json" not in name, name))


def test_the_index_lists_the_shards(pictures, tmp_path):
    packed = fh.many.pack(pictures, tmp_path, parts=2)
    said = json.loads((tmp_path / "pack.json").read_text())
    assert said["job"] == json.loads((pictures / "job.json").read_text())["job"]
    assert (said["parts"], said["missing"], said["split"]) == (3, [], {"parts": 2})
    for path, one in zip(packed.shards, said["shards"], strict=True):
        assert path.name == one["name"]
        assert hashlib.sha256(path.read_bytes()).hexdigest() == one["sha256"]
        assert path.stat().st_size == one["bytes"]
    assert [one["samples"] for one in said["shards"]] == [10, 2]


@pytest.mark.parametrize("size", [1, 90_000, 10**12])
def test_shards_are_no_larger_than_asked_unless_of_one_sample(pictures, tmp_path, size):
    packed = fh.many.pack(pictures, tmp_path, size=size)
    held = {}
    for one in samples(tmp_path):
        held.setdefault(one["__shard__"], []).append(one["__key__"])
    counts = [len(held[path.name]) for path in packed.shards]
    assert sum(counts) == 12
    if size != 90_000:
        assert counts == {1: [1] * 12, 10**12: [12]}[size]
    if size == 90_000:
        assert 1 < len(packed.shards) < 12
        assert all(path.stat().st_size <= size for path in packed.shards)
        # None has room for the sample that is first in the next.
        sizes = [sum((e.size + 1023) // 512 * 512 for e in entries_of(p)) for p in packed.shards]
        for (_, own), (after, _) in pairwise(zip(packed.shards, sizes, strict=True)):
            assert -(-(own + first_sample(after) + 1024) // 10_240) * 10_240 > size
    assert [key for keys in held.values() for key in keys] == sorted(
        key for keys in held.values() for key in keys
    )


def entries_of(path):
    with tarfile.open(path) as tar:
        return tar.getmembers()


def first_sample(path):
    found = entries_of(path)
    key = found[0].name.split(".")[0]
    return sum((e.size + 1023) // 512 * 512 for e in found if e.name.split(".")[0] == key)


def test_names_with_dots_and_long_names_keep_their_keys_apart(tmp_path):
    one, two, three, four = cameras(4)
    long = "n" * 150
    views = {"a.b": one, "a": two, "a.b.c": three, long: four}
    fh.render_many(
        scene(), views, tmp_path / "job", channels=["z", "t"], save=[".png", ".npz"], part_size=4
    )
    fh.many.pack(tmp_path / "job", tmp_path / "out")
    read = {sample["__key__"]: sample for sample in samples(tmp_path / "out")}
    keys = {"a": "a", "a%2Eb": "a.b", "a%2Eb%2Ec": "a.b.c", long: long}
    assert set(read) == {f"000000-{key}" for key in keys}
    for key, name in keys.items():
        part = tmp_path / "job" / "parts" / "000000"
        assert read[f"000000-{key}"]["npz"] == (part / f"{name}.npz").read_bytes()
        assert read[f"000000-{key}"]["z.png"] == (part / f"{name}.z.png").read_bytes()
    # Only a long name needs more than the plain header.
    for entry in entries(tmp_path / "out"):
        assert ("path" in entry.pax_headers) == (len(entry.name) > 100)


def test_missing_parts_are_refused_or_left_out(tmp_path):
    how = {"channels": "z", "part_size": 2}
    for k in (2, 5):
        fh.render_many(scene(), cameras(), tmp_path / "job", part=(k, 6), **how)
    with pytest.raises(fh.FileFormatError, match=r"parts are missing: 0, 2-3, 5; partial packs"):
        fh.many.pack(tmp_path / "job", tmp_path / "out")
    assert not (tmp_path / "out").exists()
    packed = fh.many.pack(tmp_path / "job", tmp_path / "out", partial=True, parts=1)
    assert (packed.parts, packed.missing, packed.samples, len(packed.shards)) == (2, 4, 4, 2)
    keys = [one["__key__"] for one in samples(tmp_path / "out")]
    assert keys == ["000001-000002", "000001-000003", "000004-000008", "000004-000009"]
    # More parts are other shards.
    fh.render_many(scene(), cameras(), tmp_path / "job", part=(1, 6), **how)
    with pytest.raises(fh.FileWriteError, match="another job's: its parts is 2, this one's 3"):
        fh.many.pack(tmp_path / "job", tmp_path / "out", partial=True, parts=1)


def test_nothing_to_pack_is_refused(tmp_path):
    fh.render_many(scene(), cameras(), tmp_path / "job", channels="z")
    shutil.rmtree(tmp_path / "job" / "parts")
    with pytest.raises(fh.FileFormatError, match="no part is there"):
        fh.many.pack(tmp_path / "job", tmp_path / "out", partial=True)
    assert not (tmp_path / "out").exists()


def test_a_stream_without_an_end_is_packed_as_far_as_it_goes(tmp_path):
    with pytest.raises(KeyError):
        fh.shoot_many(scene(), batches(3), tmp_path / "job", part=(2, 2))
    with pytest.raises(fh.FileFormatError, match="missing, nobody knows yet how many; partial"):
        fh.many.pack(tmp_path / "job", tmp_path / "out")
    packed = fh.many.pack(tmp_path / "job", tmp_path / "out", partial=True)
    assert (packed.parts, packed.missing, packed.samples) == (1, 1, 1)
    fh.shoot_many(scene(), batches(None), tmp_path / "job")
    assert fh.many.pack(tmp_path / "job", tmp_path / "all").samples == 4


@pytest.mark.parametrize("partial", [False, True])
def test_a_changed_byte_is_found_and_its_shard_not_there(pictures, tmp_path, partial):
    shutil.copytree(pictures, tmp_path / "job")
    path = tmp_path / "job" / "parts" / "000001" / "000007.npz"
    path.write_bytes(path.read_bytes()[:-1] + b"x")
    what = r"000001.000007\.npz: its sha256 is not that of its record"
    with pytest.raises(fh.FileFormatError, match=what):
        fh.many.pack(tmp_path / "job", tmp_path / "out", parts=1, partial=partial)
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "pack.json",
        "shard-000000.tar",
    }


def test_a_file_that_changes_its_size_while_it_is_packed_is_found(pictures, tmp_path):
    shutil.copytree(pictures, tmp_path / "job")
    victim = tmp_path / "job" / "parts" / "000002" / "000011.npz"
    content = victim.read_bytes()
    for other in (content[:-700], content + b"x"):

        def change(done, total, other=other):
            victim.write_bytes(other if done else content)

        victim.write_bytes(content)
        with pytest.raises(fh.FileFormatError, match="its sha256 is not that"):
            fh.many.pack(tmp_path / "job", tmp_path / "out", parts=3, progress=change)
        assert {path.name for path in (tmp_path / "out").iterdir()} == {"pack.json"}


def test_a_run_that_was_stopped_goes_on(pictures, tmp_path):
    def stop(done, total):
        if done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fh.many.pack(pictures, tmp_path / "out", parts=1, progress=stop)
    names = [path.name for path in sorted((tmp_path / "out").iterdir())]
    assert names == ["pack.json", "shard-000000.tar", "shard-000001.tar"]
    before = {name: (tmp_path / "out" / name).stat().st_ino for name in names[1:]}
    fh.many.pack(pictures, tmp_path / "out", parts=1)
    assert {name: (tmp_path / "out" / name).stat().st_ino for name in names[1:]} == before
    fh.many.pack(pictures, tmp_path / "whole", parts=1)
    assert tree(tmp_path / "out") == tree(tmp_path / "whole")


def test_what_is_packed_is_not_packed_again(pictures, tmp_path):
    first = fh.many.pack(pictures, tmp_path, parts=1)
    stamps = {path: path.stat().st_ino for path in tmp_path.iterdir()}
    assert fh.many.pack(pictures, tmp_path, parts=1) == first
    assert {path: path.stat().st_ino for path in tmp_path.iterdir()} == stamps
    content = first.shards[1].read_bytes()
    first.shards[1].unlink()
    assert fh.many.pack(pictures, tmp_path, parts=1) == first
    assert first.shards[1].read_bytes() == content


def test_a_folder_with_something_else_is_refused(pictures, tmp_path):
    for name in ("notes.txt", "shard-000000.tar", "shard-1.tar", ".hidden"):
        out = tmp_path / f"with {name}"
        out.mkdir()
        (out / name).write_text("mine")
        with pytest.raises(fh.FileWriteError, match=f"there is {re.escape(name)} in it"):
            fh.many.pack(pictures, out)
        assert tree_of(out) == {name: b"mine"}
    fh.many.pack(pictures, tmp_path / "own", parts=1)
    with pytest.raises(fh.FileWriteError, match="another job's: its split is"):
        fh.many.pack(pictures, tmp_path / "own", parts=2)
    fh.render_many(scene(), cameras(2), tmp_path / "other", channels="z")
    with pytest.raises(fh.FileWriteError, match="another job's: its job is"):
        fh.many.pack(tmp_path / "other", tmp_path / "own", parts=1)
    # One shard more would be read as well.
    for is_done in (True, False):
        shard = tmp_path / "own" / "shard-000007.tar"
        if not is_done:
            (tmp_path / "own" / "shard-000000.tar").unlink()
        shard.write_text("mine")
        with pytest.raises(fh.FileWriteError, match=r"there is shard-000007\.tar in it"):
            fh.many.pack(pictures, tmp_path / "own", parts=1)
        shard.unlink()
    with pytest.raises(fh.FileWriteError, match=r"there is job\.json in it"):
        fh.many.pack(pictures, pictures)


def tree_of(folder):
    return {path.name: path.read_bytes() for path in Path(folder).iterdir()}


def test_what_killed_runs_left_is_no_hindrance(pictures, tmp_path):
    left = tmp_path / f".shard-000000.tar.{'0' * 32}"
    left.write_text("x")
    fh.many.pack(pictures, tmp_path)
    assert left.exists()
    os.utime(left, (1, 1))
    fh.many.pack(pictures, tmp_path)
    assert not left.exists()


@pytest.mark.parametrize("name", ["../../secret", "{outside}", "..", "a/../../../secret"])
def test_a_name_that_leads_out_of_the_part_is_not_read(tmp_path, name):
    """The record fits its check, and the file that it names is there with its bytes."""
    job = tmp_path / "job"
    fh.shoot_many(scene(), rays(40), job, part_size=10)
    part, outside = job / "parts" / "000001", job / "secret"
    (part / "a").mkdir()
    outside.write_bytes((part / "hits.npz").read_bytes())
    named = name.format(outside=outside)
    forge(part / "part.json", lambda said: said["files"].update({named: said["files"]["hits.npz"]}))
    with pytest.raises(fh.FileFormatError, match="parts are missing: 1;"):
        fh.many.pack(job, tmp_path / "out")
    fh.many.pack(job, tmp_path / "out", partial=True)
    assert [one["__key__"][:6] for one in samples(tmp_path / "out")] == [
        "000000",
        "000002",
        "000003",
    ]


@POSIX
def test_links_and_pipes_are_not_read(tmp_path):
    job = tmp_path / "job"
    fh.shoot_many(scene(), rays(50), job, part_size=10)
    parts = [job / "parts" / f"{k:06d}" for k in range(5)]
    (parts[0] / "hits.npz").rename(tmp_path / "moved.npz")
    (parts[0] / "hits.npz").symlink_to(tmp_path / "moved.npz")
    (parts[1] / "hits.npz").unlink()
    os.mkfifo(parts[1] / "hits.npz")
    forge(parts[1] / "part.json", lambda said: said["files"]["hits.npz"].update(bytes=0))
    parts[2].rename(tmp_path / "moved")
    parts[2].symlink_to(tmp_path / "moved")
    (parts[3] / "hits.npz").rename(tmp_path / "hits.npz")
    (parts[3] / "sub").symlink_to(tmp_path)
    forge(
        parts[3] / "part.json",
        lambda said: said["files"].update({"sub/hits.npz": said["files"].pop("hits.npz")}),
    )
    fh.many.pack(job, tmp_path / "out", partial=True)
    assert [one["__key__"] for one in samples(tmp_path / "out")] == ["000004-hits"]
    (job / "parts").rename(tmp_path / "parts")
    (job / "parts").symlink_to(tmp_path / "parts")
    with pytest.raises(fh.FileFormatError, match="a link, not the folder of a job"):
        fh.many.pack(job, tmp_path / "other", partial=True)


@POSIX
def test_shards_that_are_links_are_replaced_and_not_followed(pictures, tmp_path):
    packed = fh.many.pack(pictures, tmp_path / "out")
    content = packed.shards[0].read_bytes()
    (tmp_path / "else").write_bytes(b"\0" * len(content))
    packed.shards[0].unlink()
    packed.shards[0].symlink_to(tmp_path / "else")
    fh.many.pack(pictures, tmp_path / "out")
    assert not packed.shards[0].is_symlink()
    assert packed.shards[0].read_bytes() == content
    assert (tmp_path / "else").read_bytes() == b"\0" * len(content)


@pytest.mark.parametrize(
    ("names", "is_refused"),
    [
        (["a.NPZ", "a.npz"], True),
        (["a.json"], True),
        (["a"], True),
        (["a.b/c.npz", "a.b.c.npz"], True),
        (["a b\n\u00e9.n z"], False),
        (["a\\..\\..\\b.npz", "a%5C..%5C..%5Cb.npz"], False),
    ],
)
@POSIX
def test_names_that_no_job_has_are_refused_or_made_harmless(tmp_path, names, is_refused):
    job = tmp_path / "job"
    fh.shoot_many(scene(), rays(10), job)
    part = job / "parts" / "000000"
    content = (part / "hits.npz").read_bytes()
    (part / "hits.npz").unlink()
    for name in names:
        (part / name).parent.mkdir(exist_ok=True)
        (part / name).write_bytes(content)

    def rename(said):
        known = said["files"].pop("hits.npz")
        said["files"] = dict.fromkeys(names, known)

    forge(part / "part.json", rename)
    if is_refused:
        with pytest.raises(fh.FileFormatError, match="has no extension of its own"):
            fh.many.pack(job, tmp_path / "out")
        return
    fh.many.pack(job, tmp_path / "out")
    assert len(list(samples(tmp_path / "out"))) == len(names)
    for entry in entries(tmp_path / "out"):
        assert re.fullmatch(r"000000-[A-Za-z0-9_.%~-]+", entry.name)


@pytest.mark.parametrize(
    ("options", "error", "what"),
    [
        ({"size": 0}, ValueError, "size must"),
        ({"size": 1.5}, ValueError, "size must"),
        ({"parts": 0}, ValueError, "parts must"),
        ({"partial": 1}, TypeError, "partial must"),
    ],
)
def test_options_that_are_none_are_refused(pictures, tmp_path, options, error, what):
    with pytest.raises(error, match=what):
        fh.many.pack(pictures, tmp_path / "out", **options)
    assert not (tmp_path / "out").exists()


def test_progress_counts_parts(pictures, tmp_path):
    told = []
    fh.many.pack(pictures, tmp_path, progress=lambda *both: told.append(both))
    assert told[0] == (0, 3)
    assert list(dict.fromkeys(told[1:])) == [(1, 3), (2, 3), (3, 3)]


def test_the_command_packs_what_the_function_packs(firsthit, pictures, tmp_path):
    packed = fh.many.pack(pictures, tmp_path / "one", parts=2)
    out = tmp_path / "two"
    code, text, err = firsthit("pack", pictures, "-o", out, "--parts", 2)
    assert (code, err) == (0, "")
    size = f"{packed.bytes / 1000:.3g} KB"
    assert text == f"{out}: 12 samples of 3 parts in 2 tar files, {size}\n"
    assert tree(tmp_path / "one") == tree(out)
    said = json.loads(firsthit("pack", pictures, "-o", tmp_path / "three", "--json")[1])
    assert said == {
        "output": str(tmp_path / "three"),
        "shards": ["shard-000000.tar"],
        "samples": 12,
        "parts": 3,
        "missing": 0,
        "bytes": (tmp_path / "three" / "shard-000000.tar").stat().st_size,
        "warnings": [],
    }
    assert firsthit("pack", pictures, "-o", tmp_path / "four", "-q", "--size", 1) == (0, "", "")
    split = json.loads((tmp_path / "four" / "pack.json").read_text())["split"]
    assert split == {"size": 1_000_000}


def test_the_command_says_what_is_missing(firsthit, tmp_path):
    fh.shoot_many(scene(), rays(10), tmp_path / "job", part_size=5, part=(1, 2))
    code, out, err = firsthit("pack", tmp_path / "job", "-o", tmp_path / "out")
    assert (code, out) == (3, "")
    assert err.endswith("parts are missing: 1; partial packs what is there\n")
    code, out, _ = firsthit("pack", tmp_path / "job", "-o", tmp_path / "out", "--partial")
    assert code == 0
    assert out.endswith("KB; 1 part missing\n")


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        ([], 2, "required: FOLDER"),
        (["job"], 2, "--output must be given, and not empty; see firsthit pack --help"),
        (["job", "-o", "x", "--size", "0"], 2, "must be a whole number from 1 on"),
        (["job", "-o", "x", "--size", "5", "--parts", "3"], 2, "not allowed with"),
        (["none", "-o", "x"], 3, "none: there is no job.json"),
        (["job", "-o", "file"], 4, "file: File exists"),
        (["job", "-o", "job"], 4, "take another folder"),
    ],
)
def test_failures_are_one_line_with_an_exit_code(
    firsthit, tmp_path, monkeypatch, arguments, code, words
):
    monkeypatch.chdir(tmp_path)
    fh.shoot_many(scene(), rays(10), "job")
    Path("file").touch()
    before = {str(path) for path in tmp_path.rglob("*")}
    got, out, err = firsthit("pack", *arguments)
    assert (got, out, err.count("\n")) == (code, "", 1)
    assert words in err
    assert {str(path) for path in tmp_path.rglob("*")} == before
    assert json.loads(firsthit("pack", *arguments, "--json")[1])["exit_code"] == code


def test_help_is_that_of_the_other_commands(firsthit):
    code, text, _ = firsthit("pack", "--help")
    assert code == 0
    assert max(map(len, text.splitlines())) <= 80
    assert firsthit("help", "pack") == (0, text, "")
    assert firsthit("pack", "-V") == (0, f"firsthit {fh.__version__}\n", "")


def test_arrays_of_samples_are_those_of_the_job(tmp_path):
    fh.shoot_many(scene(), rays(100), tmp_path / "job", part_size=30, channels="t")
    fh.many.pack(tmp_path / "job", tmp_path / "out", parts=3)
    read = [np.load(io.BytesIO(one["npz"]))["t"] for one in samples(tmp_path / "out")]
    np.testing.assert_array_equal(np.concatenate(read), scene().shoot(*rays(100)).t)
