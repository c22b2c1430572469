"""``firsthit parts``: what it says of jobs, whole, partial and hostile."""

import json
import os
import re
import sys
from pathlib import Path

import firsthit as fh
import pytest
from dataset_support import PLANS
from many_support import batches, cameras, forge, rays, scene

POSIX = pytest.mark.skipif(sys.platform == "win32", reason="links and pipes are those of Unix")


@pytest.fixture
def hits(tmp_path):
    """A job of four parts."""
    made = fh.shoot_many(scene(), rays(400), tmp_path / "hits", part_size=100)
    return tmp_path / "hits", made.digest


def test_a_job_that_is_whole_is_told_in_words(firsthit, tmp_path):
    ball, views, (points, _) = scene(), cameras(3), rays(40)
    jobs = {
        "pictures of cameras": lambda out: fh.render_many(ball, views, out, channels="z"),
        "first hits of rays": lambda out: fh.shoot_many(ball, rays(9), out, part_size=3),
        "first hits of rays, as Sum('t')": lambda out: fh.shoot_many(
            ball, rays(9), out, part_size=3, fold=fh.many.Sum("t")
        ),
        "which points see which": lambda out: fh.visible_many(
            ball, points[:3], points, out, block=(1, 64)
        ),
    }
    for k, (words, job) in enumerate(jobs.items()):
        out = tmp_path / str(k)
        digest = job(out).digest
        expected = f"{out}: {words}\nparts: 3 of 3 done\ndigest {digest}\n"
        assert firsthit("parts", out) == (0, expected, "")
    out = tmp_path / "frames"
    digest = fh.dataset(PLANS / "turntable.toml", out).digest
    expected = f"{out}: frames of a data set\nframes: 6 of 6 done\ndigest {digest}\n"
    assert firsthit("parts", out, "--verify") == (0, expected, "")
    assert json.loads(firsthit("parts", out, "--json")[1])["kind"] == "dataset"


def test_what_is_missing_is_ranges_and_an_exit_code(firsthit, tmp_path):
    fh.dataset(PLANS / "turntable.toml", tmp_path, part=(2, 3))
    code, out, err = firsthit("parts", tmp_path)
    assert (code, err) == (1, "")
    assert out.splitlines()[1:] == ["frames: 2 of 6 done", "missing: 0-1, 4-5"]
    code, out, _ = firsthit("parts", tmp_path, "--json")
    assert code == 1
    assert json.loads(out) == {
        "folder": str(tmp_path),
        "kind": "dataset",
        "parts": 6,
        "done": 2,
        "missing": [[0, 1], [4, 5]],
        "digest": None,
        "warnings": [],
    }
    assert firsthit("parts", tmp_path, "-q") == firsthit("parts", tmp_path)


def test_of_many_ranges_only_the_first_are_told(firsthit, tmp_path):
    for k in range(2, 41, 2):
        fh.shoot_many(scene(), rays(40), tmp_path, part_size=1, part=(k, 40))
    _, out, _ = firsthit("parts", tmp_path)
    first = ", ".join(str(k) for k in range(0, 24, 2))
    assert out.splitlines()[2] == f"missing: {first} and 8 more"
    missing = json.loads(firsthit("parts", tmp_path, "--json")[1])["missing"]
    assert missing == [[k, k] for k in range(0, 40, 2)]


def test_a_stream_without_an_end_has_no_number_of_parts(firsthit, tmp_path):
    with pytest.raises(KeyError):
        fh.shoot_many(scene(), batches(3), tmp_path, part=(2, 2))
    code, out, _ = firsthit("parts", tmp_path)
    assert code == 1
    assert out.splitlines()[1:] == [
        "parts: 1 done; the rays have not come to their end",
        "missing: 0",
    ]
    said = json.loads(firsthit("parts", tmp_path, "--json")[1])
    assert (said["parts"], said["missing"]) == (None, [[0, 0]])
    fh.shoot_many(scene(), batches(None), tmp_path)
    assert firsthit("parts", tmp_path)[1].splitlines()[1] == "parts: 4 of 4 done"


def test_a_changed_byte_is_found_where_bytes_are_verified(firsthit, hits):
    folder, digest = hits
    path = folder / "parts" / "000002" / "hits.npz"
    path.write_bytes(path.read_bytes()[:-1] + b"x")
    assert firsthit("parts", folder)[1].endswith(f"digest {digest}\n")
    code, out, _ = firsthit("parts", folder, "--verify")
    assert (code, out.splitlines()[2]) == (1, "missing: 2")
    # Nothing is changed.
    assert path.exists()


@pytest.mark.parametrize("arguments", [["none"], ["file"], ["empty"]])
def test_a_folder_that_is_none_of_a_job_is_a_line(firsthit, tmp_path, monkeypatch, arguments):
    monkeypatch.chdir(tmp_path)
    Path("file").touch()
    Path("empty").mkdir()
    code, out, err = firsthit("parts", *arguments)
    assert (code, out) == (3, "")
    assert err.startswith(f"firsthit: error: {arguments[0]}: there is no job.json")
    assert err.count("\n") == 1
    said = json.loads(firsthit("parts", *arguments, "--json")[1])
    assert said["exit_code"] == 3


def test_wrong_usage_help_and_version(firsthit):
    code, _, err = firsthit("parts")
    assert (code, err.count("\n")) == (2, 1)
    assert "required: FOLDER" in err
    code, text, _ = firsthit("parts", "--help")
    assert code == 0
    assert "Exit codes: 0 all parts are there, 1 some are missing" in text
    assert max(map(len, text.splitlines())) <= 80
    assert firsthit("help", "parts") == (0, text, "")
    assert firsthit("parts", "-V") == (0, f"firsthit {fh.__version__}\n", "")


@pytest.mark.parametrize("name", ["../../secret", "{outside}", "sub/../../../secret"])
def test_a_name_that_leads_out_of_the_part_is_not_looked_at(firsthit, hits, tmp_path, name):
    """The record fits its check, and the file that it names is there with its bytes."""
    folder, _ = hits
    part = folder / "parts" / "000001"
    (part / "sub").mkdir()
    outside = folder / "secret"
    outside.write_bytes((part / "hits.npz").read_bytes())
    named = name.format(outside=outside)
    forge(
        part / "part.json",
        lambda said: said["files"].update({named: said["files"].pop("hits.npz")}),
    )
    assert firsthit("parts", folder)[1].splitlines()[2] == "missing: 1"
    assert firsthit("parts", folder, "--verify")[1].splitlines()[2] == "missing: 1"
    assert outside.exists()


@POSIX
@pytest.mark.parametrize("verify", [[], ["--verify"]])
def test_links_and_pipes_are_no_files_of_a_part(firsthit, hits, tmp_path, verify):
    folder, _ = hits
    file = folder / "parts" / "000000" / "hits.npz"
    file.rename(tmp_path / "moved")
    file.symlink_to(tmp_path / "moved")
    part = folder / "parts" / "000001"
    (part / "hits.npz").unlink()
    os.mkfifo(part / "hits.npz")
    forge(part / "part.json", lambda said: said["files"]["hits.npz"].update(bytes=0))
    part = folder / "parts" / "000003"
    (part / "hits.npz").rename(tmp_path / "hits.npz")
    (part / "sub").symlink_to(tmp_path)
    forge(
        part / "part.json",
        lambda said: said["files"].update({"sub/hits.npz": said["files"].pop("hits.npz")}),
    )
    code, out, _ = firsthit("parts", folder, *verify)
    assert (code, out.splitlines()[2]) == (1, "missing: 0-1, 3")


@POSIX
def test_a_folder_of_parts_that_is_a_link_is_refused(firsthit, hits, tmp_path):
    folder, _ = hits
    (folder / "parts").rename(tmp_path / "elsewhere")
    (folder / "parts").symlink_to(tmp_path / "elsewhere")
    code, _, err = firsthit("parts", folder)
    assert code == 3
    assert err.endswith("parts: a link, not the folder of a job\n")


@POSIX
def test_a_job_that_is_a_pipe_or_has_no_end_is_a_line(firsthit, tmp_path):
    os.mkfifo(tmp_path / "job.json")
    code, _, err = firsthit("parts", tmp_path)
    assert (code, err.count("\n")) == (3, 1)
    (tmp_path / "job.json").unlink()
    with (tmp_path / "job.json").open("wb") as file:
        file.truncate(1 << 40)
    code, _, err = firsthit("parts", tmp_path)
    assert code == 3
    assert "larger than 256 MiB" in err


@pytest.mark.parametrize("digest", [5, None, "\u00e9", ["a"]])
def test_a_record_without_a_digest_is_none(firsthit, hits, digest):
    folder, _ = hits
    forge(folder / "parts" / "000002" / "part.json", lambda said: said.update(digest=digest))
    code, out, err = firsthit("parts", folder)
    assert (code, err, out.splitlines()[2]) == (1, "", "missing: 2")


@pytest.mark.parametrize("known", [5, None, {}, {"bytes": 1}, [1, 2], {"sha256": None}])
def test_a_record_that_says_nothing_of_a_file_is_none(firsthit, hits, known, tmp_path):
    folder, _ = hits
    if known == {"sha256": None}:
        known["bytes"] = (folder / "parts" / "000002" / "hits.npz").stat().st_size
    forge(
        folder / "parts" / "000002" / "part.json",
        lambda said: said["files"].update({"hits.npz": known}),
    )
    code, out, err = firsthit("parts", folder)
    assert (code, err, out.splitlines()[2]) == (1, "", "missing: 2")
    assert firsthit("pack", folder, "-o", tmp_path / "out", "--partial")[0] == 0


def test_a_record_that_is_nested_deeply_is_none(firsthit, hits):
    """At some depth it can be read, and its check cannot be made."""
    folder, _ = hits
    path = folder / "parts" / "000002" / "part.json"
    plain = path.read_text().rstrip()
    for depth in range(850, 1000):
        path.write_text(plain[:-1] + f', "x": {"[" * depth}{"]" * depth}}}')
        code, out, err = firsthit("parts", folder)
        assert (code, err, out.splitlines()[2]) == (1, "", "missing: 2")


@pytest.mark.parametrize(
    "change",
    [{"parts": -1}, {"parts": 10**30}, {"parts": "4"}, {"parts": 4.0}, {"job": 7}, {"job": None}],
)
def test_a_job_of_nonsense_is_a_line(firsthit, hits, change):
    folder, _ = hits
    forge(folder / "job.json", lambda said: said.update(change))
    code, out, err = firsthit("parts", folder)
    assert (code, out, err.count("\n")) == (3, "", 1)


def test_names_in_jobs_cannot_write_to_the_terminal(firsthit, hits):
    folder, _ = hits
    for change in ({"fold": ["a", "\u001b[2J\nparts: 9\u202e"]}, {"kind": ["\u001b[2J"]}):
        forge(folder / "job.json", lambda said, change=change: said.update(change))
        code, out, _ = firsthit("parts", folder)
        assert code == 0
        assert re.search("[\u001b\u202e]", out) is None
        assert out.count("\n") == 3
