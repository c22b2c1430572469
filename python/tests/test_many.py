"""Jobs in parts: the same bytes whoever makes them, and after any kill."""

import errno
import functools
import io
import multiprocessing
import os
import pickle
import shutil
import subprocess
import sys
import time
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import firsthit as fh
import many_support
import numpy as np
import pages
import pytest
from firsthit._parts.engine import Task, results
from firsthit._parts.job import begin_job
from many_support import Slow, Wrong, all_hits, cameras, forge, of_processes, rays, scene, tree
from support import cases

ROOT = Path(__file__).resolve().parents[2]
POSIX = pytest.mark.skipif(sys.platform == "win32", reason="signals are those of Unix")
pytestmark = pytest.mark.usefixtures("workers_find_the_tests")


class OneByOne:
    """Anything with ``submit`` will do."""

    def submit(self, work, *given):
        future = Future()
        future.set_result(work(*given))
        return future


ENGINES = {
    "none": lambda: None,
    "submit": OneByOne,
    "threads": lambda: ThreadPoolExecutor(2),
    "spawn-1": lambda: of_processes(1, "spawn"),
    "forkserver-4": lambda: of_processes(4, "forkserver"),
    "processes-2": lambda: fh.many.processes(2),
}
if "fork" in multiprocessing.get_all_start_methods():
    ENGINES["fork-2"] = lambda: ProcessPoolExecutor(
        2, mp_context=multiprocessing.get_context("fork")
    )


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pictures")
    made = fh.render_many(scene(), cameras(), folder, channels=["z", "color"], part_size=5)
    assert (made.parts, made.made, made.kept, made.missing) == (3, 3, 0, 0)
    return made.digest, tree(folder)


@pytest.fixture(scope="module")
def hits(tmp_path_factory):
    folder = tmp_path_factory.mktemp("hits")
    made = fh.shoot_many(scene(), rays(), folder, channels=["t", "normal"], part_size=900)
    assert (made.parts, made.made) == (12, 12)
    return made.digest, tree(folder)


@pytest.mark.parametrize("engine", ENGINES)
def test_pictures_have_the_same_bytes_on_every_engine(pictures, engine, tmp_path):
    made = fh.render_many(
        scene(), cameras(), tmp_path, channels=["z", "color"], part_size=5, on=ENGINES[engine]()
    )
    assert made.digest == pictures[0]
    assert tree(tmp_path) == pictures[1]


@pytest.mark.parametrize("engine", ENGINES)
def test_hits_have_the_same_bytes_on_every_engine(hits, engine, tmp_path):
    made = fh.shoot_many(
        scene(), rays(), tmp_path, channels=["t", "normal"], part_size=900, on=ENGINES[engine]()
    )
    assert made.digest == hits[0]
    assert tree(tmp_path) == hits[1]


def test_hits_are_those_of_shoot(hits):
    origins, directions = rays()
    found = scene().shoot(origins, directions)
    for k in range(12):
        with np.load(io.BytesIO(hits[1][f"parts/{k:06d}/hits.npz"])) as file:
            part = slice(900 * k, 900 * (k + 1))
            np.testing.assert_array_equal(file["t"], found.t[part])
            np.testing.assert_array_equal(file["normal"], found.normal[part])


def test_many_that_begin_at_once_are_one_job(tmp_path):
    """As the tasks of an array do: one of them makes the folder, the others find it."""
    code = (
        "import sys, time, firsthit as fh, many_support as m\n"
        "time.sleep(max(0.0, float(sys.argv[2]) - time.time()))\n"
        "part = int(sys.argv[3]), 8\n"
        "fh.shoot_many(m.scene(), m.rays(), sys.argv[1], part_size=500, part=part)\n"
    )
    for k in range(cases(4)):
        out, at = tmp_path / str(k), str(time.time() + 2.0)
        runs = [
            subprocess.Popen([sys.executable, "-c", code, str(out), at, str(part)])
            for part in range(1, 9)
        ]
        assert [run.wait(60) for run in runs] == [0] * 8
        assert fh.parts(out).missing == ()


def test_who_comes_second_finds_the_job_of_the_first(tmp_path):
    """Both found no job before: only one of them may write it."""
    path = tmp_path / "out" / "job.json"
    assert begin_job(path, {"of": 1}) == {"of": 1}
    assert begin_job(path, {"of": 2}) == {"of": 1}
    assert [each.name for each in path.parent.iterdir()] == ["job.json"]


def test_two_jobs_that_begin_at_once_do_not_share_a_folder(tmp_path):
    code = (
        "import sys, time, firsthit as fh, many_support as m\n"
        "time.sleep(max(0.0, float(sys.argv[2]) - time.time()))\n"
        "try:\n"
        "    fh.shoot_many(m.scene(), m.rays(), sys.argv[1], part_size=int(sys.argv[3]))\n"
        "except fh.FileWriteError as error:\n"
        "    assert 'another job' in str(error)\n"
        "    sys.exit(7)\n"
    )
    out, at = tmp_path / "out", str(time.time() + 2.0)
    runs = [
        subprocess.Popen([sys.executable, "-c", code, str(out), at, size])
        for size in ("500", "600", "700", "800")
    ]
    assert sorted(run.wait(60) for run in runs) == [0, 7, 7, 7]
    assert fh.parts(out, verify=True).missing == ()


def test_workers_write_where_the_driver_does(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    context = multiprocessing.get_context("spawn")
    (tmp_path / "elsewhere").mkdir()
    with ProcessPoolExecutor(1, context, os.chdir, (tmp_path / "elsewhere",)) as pool:
        made = fh.shoot_many(scene(), rays(), "out", part_size=5_000, on=pool)
    assert (made.made, made.missing) == (2, 0)
    assert list((tmp_path / "elsewhere").iterdir()) == []


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="limits are those of Unix")
def test_a_passing_error_removes_no_part(tmp_path, monkeypatch):
    fh.shoot_many(scene(), rays(), tmp_path, part_size=5_000)
    before = tree(tmp_path)

    def fails(path):
        raise OSError(errno.EMFILE, "Too many open files")

    monkeypatch.setattr("firsthit._parts.part.read", fails)
    with pytest.raises(fh.FileReadError, match="Too many open files"):
        fh.shoot_many(scene(), rays(), tmp_path, part_size=5_000)
    assert tree(tmp_path) == before


class Nameless:
    """A fold that a later run cannot know again."""

    def __call__(self, hits):
        return {}

    def merge(self, first, second):
        return first


@pytest.mark.parametrize("fold", [Nameless(), type("Local", (Nameless,), {})()])
def test_what_a_later_run_could_not_know_again_is_refused(fold, tmp_path):
    with pytest.raises(ValueError, match="fold must have a __repr__"):
        fh.shoot_many(scene(), rays(), tmp_path / "a", fold=fold)
    with pytest.raises(ValueError, match="shade must be a function of a module"):
        fh.render_many(scene(), cameras(1), tmp_path / "a", shade=lambda hits: hits.normal)
    how = functools.partial(lambda hits: hits.normal)
    with pytest.raises(ValueError, match="shade must have a __repr__"):
        fh.render_many(scene(), cameras(1), tmp_path / "a", shade=how)
    assert not (tmp_path / "a").exists()


@pytest.mark.parametrize("on", [lambda: fh.many.processes(1), lambda: of_processes(1, "spawn")])
def test_work_that_cannot_be_sent_is_told_at_once(on, tmp_path):
    class Local(Slow):
        pass

    with pytest.raises((AttributeError, pickle.PicklingError), match="Local"):
        fh.shoot_many(scene(), rays(), tmp_path, fold=Local(0.0), on=on())


def test_an_error_of_a_worker_says_where_it_was(tmp_path):
    with pytest.raises(ValueError, match="this fold is wrong") as caught:
        fh.shoot_many(scene(), rays(), tmp_path, fold=Wrong(), on=fh.many.processes(1))
    assert "many_support.py" in caught.value.__notes__[0]


@pytest.mark.parametrize("order", [(1, 2, 3), (3, 1, 2)])
def test_parts_of_a_job_in_any_order_come_to_the_same(hits, order, tmp_path):
    how = {"channels": ["t", "normal"], "part_size": 900}
    runs = [fh.shoot_many(scene(), rays(), tmp_path, part=(k, 3), **how) for k in order]
    assert [run.digest for run in runs] == [None, None, hits[0]]
    assert [run.missing for run in runs] == [8, 4, 0]
    assert tree(tmp_path) == hits[1]


def test_what_is_missing_is_told(tmp_path):
    how = {"part_size": 1_000, "channels": "t"}
    fh.shoot_many(scene(), rays(), tmp_path, part=(2, 5), **how)
    shutil.rmtree(tmp_path / "parts" / "000002")
    state = fh.parts(tmp_path)
    assert (state.parts, state.done, state.digest) == (10, 1, None)
    assert state.missing == (range(3), range(4, 10))
    assert state.job["kind"] == "shoot"
    with pytest.raises(fh.FileFormatError, match=r"there is no job\.json"):
        fh.parts(tmp_path / "parts")


@pytest.mark.parametrize("verify", [False, True])
def test_damaged_parts_are_made_again(hits, verify, tmp_path):
    how = {"channels": ["t", "normal"], "part_size": 900}
    fh.shoot_many(scene(), rays(), tmp_path, **how)
    (tmp_path / "parts" / "000003" / "part.json").write_text("{}")
    (tmp_path / "parts" / "000004" / "hits.npz").unlink()
    file = tmp_path / "parts" / "000005" / "hits.npz"
    content = bytearray(file.read_bytes())
    content[1000] ^= 1
    file.write_bytes(content)
    made = fh.shoot_many(scene(), rays(), tmp_path, verify=verify, **how)
    assert made.made == 2 + verify
    assert made.digest == hits[0]
    assert (tree(tmp_path) == hits[1]) == verify


def test_another_job_in_the_folder_is_refused(tmp_path):
    fh.shoot_many(scene(), rays(), tmp_path, part_size=5_000)
    for other, what in (
        (lambda: fh.shoot_many(scene(), rays(), tmp_path, part_size=4_000), "part_size"),
        (lambda: fh.shoot_many(scene(), rays(seed=4), tmp_path, part_size=5_000), "rays"),
        (lambda: fh.shoot_many(scene(), rays(), tmp_path, part_size=5_000, cull="back"), "cull"),
        (lambda: fh.render_many(scene(), cameras(1), tmp_path), "kind"),
    ):
        with pytest.raises(fh.FileWriteError, match=f"another job's: its {what} is"):
            other()
    changed = scene()
    changed.add(fh.Sphere((3, 0, 0), 0.1))
    with pytest.raises(fh.FileWriteError, match="its scene is"):
        fh.shoot_many(changed, rays(), tmp_path, part_size=5_000)


def test_a_scene_may_be_a_file(hits, tmp_path):
    scene().save(tmp_path / "s.fhs")
    how = {"channels": ["t", "normal"], "part_size": 900}
    out = tmp_path / "out"
    made = fh.shoot_many(tmp_path / "s.fhs", rays(), out, on=fh.many.processes(2), **how)
    assert made.digest == hits[0]
    assert not (out / "scene.fhs").exists()
    other = fh.Scene()
    other.add(fh.Sphere((0, 0, 0), 2))
    other.save(tmp_path / "s.fhs")
    with pytest.raises(fh.FileWriteError, match="its scene is"):
        fh.shoot_many(tmp_path / "s.fhs", rays(), out, **how)


@pytest.mark.parametrize("engine", ["none", "threads", "spawn-1"])
def test_an_error_of_the_work_is_raised_at_once(engine, tmp_path):
    with pytest.raises(ValueError, match="this fold is wrong"):
        fh.shoot_many(scene(), rays(), tmp_path, fold=Wrong(), part_size=100, on=ENGINES[engine]())
    assert list((tmp_path / "parts").glob("[0-9]*")) == []


def test_a_scene_that_changes_during_a_run_does_not_change_the_job(tmp_path):
    changing = scene()

    def change(done, total):
        changing.add(fh.Sphere((0, 3, 0), 5))

    how = {"part_size": 2_000, "channels": "t"}
    made = fh.shoot_many(changing, rays(), tmp_path / "a", progress=change, **how)
    assert made.digest == fh.shoot_many(scene(), rays(), tmp_path / "b", **how).digest


def test_selections_are_read_once(tmp_path):
    fh.shoot_many(scene(), rays(), tmp_path, objects=iter(["ball"]), part_size=5_000)
    np.testing.assert_array_equal(all_hits(tmp_path), scene().shoot(*rays(), objects="ball").t)


@pytest.mark.parametrize("sizes", [3, 8, 1_001])
def test_bits_of_parts_of_any_size(sizes, tmp_path):
    some = rays(3_000)
    made = fh.shoot_many(scene(), some, tmp_path, fold=fh.many.Bits(), part_size=sizes * 10 + 3)
    bits = np.unpackbits(made.result["bits"], count=3_000, bitorder="little")
    np.testing.assert_array_equal(bits.astype(bool), scene().shoot(*some).object >= 0)


@pytest.mark.parametrize(
    "wrong",
    [
        lambda out: fh.shoot_many(scene(), rays(), out, objects="nope"),
        lambda out: fh.shoot_many(scene(), rays(), out, cull="x"),
        lambda out: fh.shoot_many(scene(), rays(), out, fold=fh.many.Sum("nope")),
        lambda out: fh.shoot_many(scene(), rays(), out, fold=fh.many.Histogram("normal", [0, 1])),
        lambda out: fh.render_many(scene(), cameras(1), out, shade="x"),
        lambda out: fh.render_many(scene(), cameras(1), out, samples=0),
        lambda out: fh.visible_many(scene(), *rays(9), out, objects=[99]),
        lambda out: fh.visible_many(scene(), *rays(9), out, tolerance=-1),
        lambda out: fh.visible_many(scene(), *rays(9), out, blend_below=2),
    ],
)
def test_what_the_scene_refuses_makes_no_folder(wrong, tmp_path):
    with pytest.raises((ValueError, IndexError)):
        wrong(tmp_path / "out")
    assert not (tmp_path / "out").exists()


@POSIX
def test_nothing_is_followed_out_of_a_job_s_folder(tmp_path):
    out, outside = tmp_path / "out", tmp_path / "outside"
    how = {"fold": fh.many.Bits(), "part_size": 5_000}
    fh.shoot_many(scene(), rays(), out, **how)
    (outside / "000000").mkdir(parents=True)
    (outside / "000000" / "precious").write_text("")
    shutil.rmtree(out / "parts")
    (out / "parts").symlink_to(outside)
    with pytest.raises(fh.FileWriteError, match="a link, not the folder of a job"):
        fh.shoot_many(scene(), rays(), out, **how)
    assert (outside / "000000" / "precious").exists()
    (out / "parts").unlink()
    fh.shoot_many(scene(), rays(), out, **how)
    result = out / "parts" / "000001" / "fold.npz"
    for change in (lambda: os.mkfifo(result), lambda: result.symlink_to("../000000/fold.npz")):
        result.unlink()
        change()
        forge(result.parent / "part.json", lambda said: said.update(files={}))
        with pytest.raises(fh.FileFormatError, match=r"its record has no fold\.npz"):
            fh.shoot_many(scene(), rays(), out, **how)


def test_an_error_of_one_s_own_file_is_told_as_it_is(tmp_path):
    with pytest.raises(FileNotFoundError, match="/no/table"):
        fh.shoot_many(scene(), rays(), tmp_path, fold=many_support.Reading("/no/table"))


def test_progress_counts_parts_that_were_kept(tmp_path):
    told = []
    how = {"part_size": 2_500, "progress": lambda done, total: told.append((done, total))}
    fh.shoot_many(scene(), rays(), tmp_path, part=(1, 2), **how)
    assert told == [(0, 2), (1, 2), (2, 2)]
    told.clear()
    fh.shoot_many(scene(), rays(), tmp_path, on=ThreadPoolExecutor(2), **how)
    assert told == [(2, 4), (3, 4), (4, 4)]

    def stop(done, total):
        raise KeyError(done)

    with pytest.raises(KeyError):
        fh.shoot_many(scene(), rays(), tmp_path / "b", progress=stop)


def test_few_tasks_wait_however_many_there_are():
    """A driver of a million parts stays small: tasks are drawn when there is room."""
    drawn, done, most = 0, 0, 0

    def tasks():
        nonlocal drawn, most
        for number in range(20_000):
            drawn += 1
            most = max(most, drawn - done)
            yield Task(number)

    with ThreadPoolExecutor(2) as pool:
        for _ in results(abs_of_number, tasks(), pool):
            done += 1
    assert done == 20_000
    assert most <= 4 * 2 + 1


def abs_of_number(task):
    return abs(task.number)


@pytest.mark.parametrize(
    ("call", "error", "what"),
    [
        (lambda out: fh.render_many(scene(), [1], out), TypeError, "cameras must be"),
        (lambda out: fh.render_many(scene(), {"../a": cameras(1)[0]}, out), ValueError, "names"),
        (lambda out: fh.render_many(scene(), cameras(1), out, save=".jpg"), ValueError, "save"),
        (lambda out: fh.render_many(scene(), cameras(1), out, save=[]), ValueError, "save"),
        (lambda out: fh.render_many(scene(), cameras(1), out, channels="x"), ValueError, "channel"),
        (lambda out: fh.render_many(scene(), cameras(1), out, on=3), TypeError, "on must be"),
        (lambda out: fh.render_many(3, cameras(1), out), TypeError, "PathLike"),
        (lambda out: fh.render_many(scene(), cameras(1), out, exposure=1), ValueError, "exposure"),
        (
            lambda out: fh.render_many(
                scene(), cameras(1), out, channels="z", save=".png", tone_map="agx"
            ),
            ValueError,
            "tone_map does nothing",
        ),
        (
            lambda out: fh.render_many(scene(), cameras(1), out, save=".png", tone_map="film"),
            ValueError,
            "tone_map must be one of",
        ),
        (
            lambda out: fh.render_many(scene(), cameras(1), out, color_by="heat"),
            ValueError,
            "heat",
        ),
        (
            lambda out: fh.render_many(
                scene(), cameras(1), out, light="sun", environment=fh.Environment.uniform("red")
            ),
            ValueError,
            "exclude each other",
        ),
        (
            lambda out: fh.render_many(scene(), cameras(1), out, environment="sky.hdr"),
            TypeError,
            "environment must be",
        ),
        (lambda out: fh.shoot_many(scene(), 3, out), TypeError, "rays must be"),
        (lambda out: fh.shoot_many(scene(), ([1, 2], [3]), out), ValueError, "origins must have"),
        (lambda out: fh.shoot_many(scene(), {"origins": 1}, out), ValueError, "rays must have"),
        (lambda out: fh.shoot_many(scene(), rays(), out, fold=len), TypeError, "fold must be"),
        (lambda out: fh.shoot_many(scene(), rays(), out, save=".csv"), ValueError, "save must"),
        (lambda out: fh.shoot_many(scene(), rays(), out, channels="z"), ValueError, "channels"),
        (lambda out: fh.shoot_many(scene(), rays(), out, part_size=0), ValueError, "part_size"),
        (lambda out: fh.shoot_many(scene(), rays(), out, part=(0, 3)), ValueError, "part must"),
        (lambda out: fh.shoot_many(scene(), "none*.npz", out), fh.FileReadError, "no such files"),
        (lambda out: fh.shoot_many(scene(), __file__, out), fh.FileFormatError, "rays are read"),
        (lambda out: fh.visible_many(scene(), [0, 0, 0], [(1, 1, 1)], out), ValueError, "a must"),
        (
            lambda out: fh.visible_many(scene(), [(0, 0, 0)], [(1, 1, 1)], out, block=(1, 9)),
            ValueError,
            "multiple of 8",
        ),
    ],
)
def test_what_makes_no_job_is_refused_before_a_folder_is_made(call, error, what, tmp_path):
    out = tmp_path / "out"
    with pytest.raises(error, match=what):
        call(out)
    assert not out.exists()


def test_the_lines_of_the_page_on_clusters_run(tmp_path, monkeypatch):
    """Those that take no cluster; `cluster_tests` has the others."""
    monkeypatch.chdir(tmp_path)
    fh.Scene.save(scene(), "bunny.fhs")
    page = (ROOT / "docs" / "cluster.md").read_text().replace("bunny.ply", "bunny.fhs")
    told = {}
    for block in pages.blocks(page, "python"):
        if not any(word in block.text for word in ("Client(", "ray.init", "zarr.open")):
            # A hundredth of the rays and pixels will do.
            small = block.text.replace("480, 640", "48, 64").replace("3_000_000", "30_000")
            exec(small, told)
    assert told["made"].result["counts"].sum() > 0
    assert fh.parts("views").digest == fh.parts("views2").digest
    assert {path.name for path in tmp_path.iterdir()} == {
        *("bunny.fhs", "views", "views2", "hits", "depths", "seen")
    }
