"""Jobs in parts: the same bytes whoever makes them, and after any kill."""

import errno
import functools
import io
import itertools
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
from firsthit.many._ray_files import ray_files
from many_support import Slow, Wrong, cameras, forge, of_processes, rays, red, scene, tree
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


def test_pictures_are_those_of_render(tmp_path):
    views = cameras(3)
    made = fh.render_many(
        scene(), views, tmp_path, channels=["z", "object"], save=[".npz", ".png", ".exr"]
    )
    for k, view in enumerate(views):
        frame = fh.render(scene(), view, channels=["z", "object"])
        folder = tmp_path / "parts" / f"{k:06d}"
        for name in ("z", "object"):
            npz, exr = (fh.Frame.load(folder / f"{k:06d}{end}")[name] for end in (".npz", ".exr"))
            np.testing.assert_array_equal(npz, frame[name])
            np.testing.assert_array_equal(exr, frame[name].astype(np.float32))
        names = {path.name for path in folder.iterdir()}
        assert names == {
            "part.json",
            *(f"{k:06d}{end}" for end in (".npz", ".exr", ".z.png", ".object.png")),
        }
    assert fh.parts(tmp_path).digest == made.digest


def test_cameras_by_name_and_looks_are_those_of_render(tmp_path):
    (view,) = cameras(1)
    look = {"samples": 2, "shade": red, "objects": ["ball"]}
    fh.render_many(scene(), {"front": view}, tmp_path, on=fh.many.processes(1), **look)
    read = fh.Frame.load(tmp_path / "parts" / "000000" / "front.npz")
    np.testing.assert_array_equal(read["color"], fh.render(scene(), view, **look)["color"])
    with pytest.raises(fh.FileWriteError, match="the folder is another job's"):
        fh.render_many(scene(), {"back": view}, tmp_path, **look)
    with pytest.raises(fh.FileWriteError, match="another job's: its look"):
        fh.render_many(scene(), {"front": view}, tmp_path, **{**look, "samples": 1})


LOOKS = {
    "samples": 2,
    "shade": fh.Shader("phong", shininess=9),
    "edges": fh.Edges(1.5, kinds="silhouette"),
    "ground": True,
    "color_by": np.array([3.0, 1.0]),
    "color_map": "turbo",
    "color_range": (0, np.float64(4)),
}


@pytest.mark.parametrize(
    "look",
    [LOOKS | {"light": "studio"}, LOOKS | {"environment": fh.Environment.daylight(20, 70)}],
    ids=["light", "environment"],
)
def test_all_looks_are_those_of_render(look, tmp_path):
    on, views = fh.many.processes(1), cameras(2)
    made = fh.render_many(scene(), views, tmp_path, on=on, **look)
    for k, view in enumerate(views):
        path = tmp_path / "parts" / f"{k:06d}" / f"{k:06d}.npz"
        expected = fh.render(scene(), view, **look)
        np.testing.assert_array_equal(fh.Frame.load(path)["color"], expected["color"])
        said = fh.read_metadata(path)
        for name in ("scene", "shading", "colors"):
            assert said[name] == expected.metadata[name]
    again = fh.render_many(scene(), views, tmp_path, **look)
    assert (again.kept, again.digest) == (2, made.digest)
    for name, value in {"edges": 1.0, "ground": False, "color_by": [3.0, 2.0]}.items():
        with pytest.raises(fh.FileWriteError, match="another job's: its look"):
            fh.render_many(scene(), views, tmp_path, **{**look, name: value})
    if "environment" in look:
        other = {**look, "environment": fh.Environment.daylight(21, 70)}
        with pytest.raises(fh.FileWriteError, match="another job's"):
            fh.render_many(scene(), views, tmp_path, **other)


def test_an_environment_goes_with_the_file_of_a_scene(tmp_path):
    lit = scene()
    lit.shading = fh.Shading(light="studio")
    lit.save(tmp_path / "a.fhs")
    (view,), sky = cameras(1), fh.Environment.gradient("white", "blue")
    how = {"on": fh.many.processes(1), "environment": sky, "samples": 2}
    fh.render_many(tmp_path / "a.fhs", {"a": view}, tmp_path / "out", **how)
    read = fh.Frame.load(tmp_path / "out" / "parts" / "000000" / "a.npz")
    expected = fh.render(fh.open(tmp_path / "a.fhs"), view, environment=sky, samples=2)
    np.testing.assert_array_equal(read["color"], expected["color"])
    assert fh.open(tmp_path / "a.fhs").environment is None


def test_lines_of_the_scene_are_part_of_a_job(tmp_path):
    drawn = scene()
    fh.render_many(drawn, cameras(1), tmp_path)
    drawn.edges = fh.Edges(2)
    with pytest.raises(fh.FileWriteError, match="another job's"):
        fh.render_many(drawn, cameras(1), tmp_path)


def test_numbers_that_json_has_not_are_part_of_a_job(tmp_path):
    endless = scene()
    endless.shading = fh.Shading("direct", colors=fh.Colors([np.nan, 2.0], missing="red"))
    assert endless.shading.shade["reach"] == np.inf
    look = {"shade": fh.Shader("lambert", depth_far=np.inf)}
    for kept in (0, 1):
        assert fh.render_many(endless, cameras(1), tmp_path, **look).kept == kept
    endless.shading = fh.Shading("direct", reach=3.0, colors=endless.shading.colors)
    with pytest.raises(fh.FileWriteError, match="another job's"):
        fh.render_many(endless, cameras(1), tmp_path, **look)


def test_far_and_dtype_are_those_of_save_and_render(tmp_path):
    (view,) = cameras(1)
    how = {"channels": ["z"], "save": [".png", ".npz"], "png_scale": 1e-4}
    fh.render_many(scene(), {"a": view}, tmp_path / "out", **how, far="zero", dtype=np.float32)
    frame = fh.render(scene(), view, channels="z", dtype="float32")
    frame.save(tmp_path / "a.png", png_scale=1e-4, far="zero")
    made = tmp_path / "out" / "parts" / "000000"
    assert (made / "a.png").read_bytes() == (tmp_path / "a.png").read_bytes()
    with np.load(made / "a.npz") as file:
        assert file["z"].dtype == np.float32
        np.testing.assert_array_equal(file["z"], frame["z"])
    for other in ({"far": "saturate", "dtype": "float32"}, {"far": "zero"}):
        with pytest.raises(fh.FileWriteError, match="another job's"):
            fh.render_many(scene(), {"a": view}, tmp_path / "out", **how, **other)
    with pytest.raises(ValueError, match="far needs png_scale"):
        fh.render_many(scene(), [view], tmp_path / "b", channels="z", far="zero")


def test_exposure_and_tone_map_are_those_of_save(tmp_path):
    (view,), how = cameras(1), {"exposure": -1, "tone_map": "agx"}
    fh.render_many(scene(), {"a": view}, tmp_path / "out", save=[".png", ".npz"], **how)
    frame = fh.render(scene(), view)
    frame.save(tmp_path / "a.png", **how)
    made = tmp_path / "out" / "parts" / "000000"
    assert (made / "a.png").read_bytes() == (tmp_path / "a.png").read_bytes()
    np.testing.assert_array_equal(fh.Frame.load(made / "a.npz")["color"], frame["color"])
    other = {**how, "exposure": -2}
    with pytest.raises(fh.FileWriteError, match="another job's: its exposure"):
        fh.render_many(scene(), {"a": view}, tmp_path / "out", save=[".png", ".npz"], **other)


def test_hits_are_those_of_shoot(hits):
    origins, directions = rays()
    found = scene().shoot(origins, directions)
    for k in range(12):
        with np.load(io.BytesIO(hits[1][f"parts/{k:06d}/hits.npz"])) as file:
            part = slice(900 * k, 900 * (k + 1))
            np.testing.assert_array_equal(file["t"], found.t[part])
            np.testing.assert_array_equal(file["normal"], found.normal[part])


def sources(folder):
    """Yield one set of rays in every form."""
    origins, directions = rays()
    folder.mkdir(exist_ok=True)
    cuts = [0, 3_333, 10_000]
    for k, (first, last) in enumerate(itertools.pairwise(cuts)):
        named = {"origins": origins[first:last], "directions": directions[first:last]}
        np.savez(folder / f"{k}.npz", **named)
        both = np.concatenate([origins[first:last], directions[first:last]], axis=1)
        np.save(folder / f"{k}.npy", both)
    yield "mapping", {"origins": origins, "directions": directions, "t_min": 0}
    yield "pattern", str(folder / "*.npz")
    yield "list", [folder / "0.npy", folder / "1.npy"]


def all_hits(folder, name="t"):
    parts = sorted(Path(folder, "parts").iterdir())
    return np.concatenate([np.load(part / "hits.npz")[name] for part in parts])


def test_rays_come_in_many_forms(tmp_path):
    t = scene().shoot(*rays()).t
    for name, source in sources(tmp_path / "rays"):
        for engine in (None, fh.many.processes(2)):
            out = tmp_path / f"{name}{engine}"
            fh.shoot_many(scene(), source, out, part_size=1_234, on=engine)
            np.testing.assert_array_equal(all_hits(out), t)


def test_rays_of_sensors_are_those_of_their_pixels(tmp_path):
    views = [*cameras(2), fh.Lidar.named("vlp-16", columns=40)]
    fh.shoot_many(scene(), views, tmp_path, part_size=700, on=ThreadPoolExecutor(2))
    expected = [scene().shoot(view).t.ravel() for view in views]
    np.testing.assert_array_equal(all_hits(tmp_path), np.concatenate(expected))


def test_rays_of_parquet_files(tmp_path):
    pyarrow = pytest.importorskip("pyarrow")
    import pyarrow.parquet as parquet

    both = np.concatenate(rays(), axis=1)
    columns = dict(zip(("ox", "oy", "oz", "dx", "dy", "dz"), both.T, strict=True))
    table = pyarrow.table({**columns, "other": both[:, 0], "t_max": np.full(10_000, 5.5)})
    parquet.write_table(table, tmp_path / "r.parquet", row_group_size=1_100)
    out = tmp_path / "out"
    fh.shoot_many(
        scene(),
        tmp_path / "r.parquet",
        out,
        channels=["t", "normal"],
        save=".parquet",
        part_size=2_500,
    )
    read = parquet.ParquetDataset(sorted(out.glob("parts/*/hits.parquet"))).read()
    found = scene().shoot(*rays(), t_max=5.5)
    np.testing.assert_array_equal(read["t"].to_numpy(), found.t)
    np.testing.assert_array_equal(read["normal_y"].to_numpy(), found.normal[:, 1])


def batches(count=10_000, size=1_500):
    origins, directions = rays(count)
    for first in range(0, count, size):
        yield origins[first : first + size], directions[first : first + size]


def test_rays_of_a_generator_are_a_part_for_each_batch(tmp_path):
    first = fh.shoot_many(scene(), batches(), tmp_path, part=(2, 3))
    assert (first.parts, first.made, first.digest) == (7, 2, None)
    made = fh.shoot_many(scene(), batches(), tmp_path, on=fh.many.processes(2))
    assert (made.parts, made.made, made.kept, made.missing) == (7, 5, 2, 0)
    np.testing.assert_array_equal(all_hits(tmp_path), scene().shoot(*rays()).t)
    state = fh.parts(tmp_path)
    assert (state.parts, state.done, state.digest) == (7, 7, made.digest)
    with pytest.raises(fh.FileWriteError, match="other rays than those that came now"):
        fh.shoot_many(scene(), batches(size=1_400), tmp_path)


def test_a_generator_that_ends_elsewhere_is_another_job(tmp_path):
    made = fh.shoot_many(scene(), batches(), tmp_path, fold=fh.many.Sum(), progress=lambda *_: None)
    found = scene().shoot(*rays())
    assert made.result["count"] == (found.object >= 0).sum()
    with pytest.raises(fh.FileWriteError, match="rays came in 6 batches, and in 7 before"):
        fh.shoot_many(scene(), itertools.islice(batches(), 6), tmp_path, fold=fh.many.Sum())
    assert fh.parts(tmp_path).digest == made.digest


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


def test_a_file_of_rays_that_has_grown_is_read_anew(tmp_path):
    origins, directions = rays()
    path = tmp_path / "r.npz"
    np.savez(path, origins=origins[:100], directions=directions[:100])
    fh.shoot_many(scene(), path, tmp_path / "a")
    np.savez(path, origins=origins[:200], directions=directions[:200])
    fh.shoot_many(scene(), path, tmp_path / "b")
    assert len(all_hits(tmp_path / "b")) == 200
    with pytest.raises(fh.FileWriteError, match="its rays is"):
        fh.shoot_many(scene(), path, tmp_path / "a")
    # A worker, which does not count rows again, sees new numbers too.
    (file,) = ray_files(path)
    np.testing.assert_array_equal(file.rays(0, 9)["origins"], origins[:9])
    np.savez(path, origins=-origins[:200], directions=directions[:200])
    os.utime(path, (1, 1))
    np.testing.assert_array_equal(file.rays(0, 9)["origins"], -origins[:9])


FOLDS = [
    fh.many.Sum("t"),
    fh.many.Sum("normal"),
    fh.many.Minimum("t"),
    fh.many.Histogram("t", [0, 3, 4.5, 5, 7]),
    fh.many.Bits(),
]


@pytest.mark.parametrize("fold", FOLDS, ids=repr)
def test_folds_are_what_numpy_makes_of_all_hits(fold, tmp_path):
    made = fh.shoot_many(scene(), rays(), tmp_path / "a", fold=fold, part_size=1_000)
    found = scene().shoot(*rays())
    met = found.object >= 0
    result = made.result
    if isinstance(fold, fh.many.Sum):
        values = found.channel(fold.channel)[met]
        assert result["count"] == met.sum()
        np.testing.assert_allclose(result["sum"], values.sum(axis=0), rtol=1e-12)
    elif isinstance(fold, fh.many.Minimum):
        assert (result["value"], result["ray"]) == (found.t.min(), found.t.argmin())
    elif isinstance(fold, fh.many.Histogram):
        counts, _ = np.histogram(found.t[met], fold.edges)
        assert result["counts"].tolist() == counts.tolist()
        outside = result["below"], result["above"]
        assert outside == ((found.t[met] < 0).sum(), (found.t[met] >= 7).sum())
    else:
        bits = np.unpackbits(result["bits"], count=int(result["rays"]), bitorder="little")
        np.testing.assert_array_equal(bits.astype(bool), met)
    again = fh.shoot_many(
        scene(), rays(), tmp_path / "b", fold=fold, part_size=1_000, on=fh.many.processes(2)
    )
    assert again.digest == made.digest
    for name, array in made.result.items():
        assert again.result[name].tobytes() == array.tobytes()
    assert (tmp_path / "a" / "fold.npz").read_bytes() == (tmp_path / "b" / "fold.npz").read_bytes()


def test_a_matrix_of_sights_is_that_of_visible(tmp_path):
    a, b = rays(100)[0], rays(77, seed=5)[0]
    seen = scene().visible(a[:, None], b)
    digests = set()
    for k, engine in enumerate((None, fh.many.processes(2))):
        out = tmp_path / str(k)
        made = fh.visible_many(scene(), a, b, out, block=(32, 24), on=engine)
        assert made.parts == 16
        digests.add(made.digest)
        np.testing.assert_array_equal(fh.many.bits(out), seen)
        np.testing.assert_array_equal(fh.many.bits(out, rows=slice(30, 70)), seen[30:70])
    assert len(digests) == 1


@pytest.mark.parametrize("how", [{"tolerance": 0.4}, {"blend_below": 0.5}])
def test_a_matrix_of_sights_takes_what_visible_takes(how, tmp_path):
    looked = fh.Scene()
    # A wall of blended glass, and a solid one.
    corners = [(-9, -9), (9, -9), (9, 9), (-9, 9)]
    glass = fh.Material(alpha=0.25, alpha_mode="blend")
    for z, material in ((1, glass), (3, None)):
        wall = fh.Mesh([(*corner, z) for corner in corners], [(0, 1, 2), (0, 2, 3)])
        looked.add(wall, material=material)
    a, b = [(0, 0, 0), (0, 0, 2), (0, 0, 2.9)], [(1, 0, 0.7), (1, 0, 2.8), (1, 0, 3.3)]
    seen = looked.visible(np.array(a)[:, None], b, **how)
    assert (seen != looked.visible(np.array(a)[:, None], b)).any()
    made = fh.visible_many(looked, a, b, tmp_path / "how", block=(2, 8), **how)
    np.testing.assert_array_equal(fh.many.bits(tmp_path / "how"), seen)
    (what, value), *_ = how.items()
    with pytest.raises(fh.FileWriteError, match=f"its {what} is {value}, this one's not given"):
        fh.visible_many(looked, a, b, tmp_path / "how", block=(2, 8))
    plain = fh.visible_many(looked, a, b, tmp_path / "plain", block=(2, 8))
    with pytest.raises(fh.FileWriteError, match=f"its {what} is not given, this one's {value}"):
        fh.visible_many(looked, a, b, tmp_path / "plain", block=(2, 8), **how)
    assert plain.digest != made.digest


def test_a_matrix_is_zarr(tmp_path):
    zarr = pytest.importorskip("zarr")
    a, b = rays(100)[0], rays(77, seed=5)[0]
    fh.visible_many(scene(), a, b, tmp_path, block=(32, 24))
    read = zarr.open_array(tmp_path / "visible.zarr", mode="r")
    bits = np.unpackbits(read[:], axis=1, count=read.attrs["columns"], bitorder="little")
    np.testing.assert_array_equal(bits.astype(bool), scene().visible(a[:, None], b))


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


UNGUARDED = """
import sys
import firsthit as fh
print("begins")
scene = fh.Scene()
scene.add(fh.Sphere((0, 0, 0), 1))
rays = [(0, 0, 5)] * 9, (0, 0, -1)
made = fh.shoot_many(scene, rays, sys.argv[1], part_size=3, on=fh.many.processes(2))
print(made.made)
"""
GUARDED = """
import sys
import firsthit as fh
class Count:
    def __repr__(self):
        return "Count()"
    def __call__(self, hits):
        return {"hits": (hits.object >= 0).sum()}
    def merge(self, first, second):
        return {"hits": first["hits"] + second["hits"]}
if __name__ == "__main__":
    scene = fh.Scene()
    scene.add(fh.Sphere((0, 0, 0), 1))
    rays = [(0, 0, 5)] * 9, (0, 0, -1)
    on, out = fh.many.processes(2), sys.argv[1]
    made = fh.shoot_many(scene, rays, out, fold=Count(), part_size=3, on=on)
    print("begins")
    print(int(made.result["hits"]) // 3)
"""


@pytest.mark.parametrize("script", [UNGUARDED, GUARDED], ids=["unguarded", "guarded"])
def test_scripts_run_once_and_their_own_folds_are_found(script, tmp_path):
    (tmp_path / "script.py").write_text(script)
    program = [sys.executable, str(tmp_path / "script.py"), str(tmp_path / "out")]
    ran = subprocess.run(program, capture_output=True, text=True, timeout=60, check=False)
    assert (ran.returncode, ran.stderr) == (0, "")
    assert ran.stdout == "begins\n3\n"


def test_depths_are_in_png_by_steps(tmp_path):
    cv2 = pytest.importorskip("cv2")
    (view,) = cameras(1)
    how = {"channels": ["z", "object"], "save": ".png", "png_scale": 0.001}
    fh.render_many(scene(), {"a": view}, tmp_path, **how)
    read = cv2.imread(str(tmp_path / "parts" / "000000" / "a.z.png"), cv2.IMREAD_UNCHANGED)
    z = fh.render(scene(), view, channels="z")["z"]
    assert read.dtype == np.uint16
    np.testing.assert_allclose(read[np.isfinite(z)] * 0.001, z[np.isfinite(z)], atol=0.0005 + 1e-9)
    with pytest.raises(fh.FileWriteError, match="png_scale"):
        fh.render_many(scene(), {"a": view}, tmp_path, **{**how, "png_scale": 0.002})


@pytest.mark.parametrize("background", ["red", (1, 0, 0), np.zeros(3), "transparent"])
def test_colours_and_numpy_s_numbers_are_part_of_a_job(background, tmp_path):
    how = {"background": background, "samples": np.int64(2), "shadows": False}
    for kept in (0, 1):
        made = fh.render_many(scene(), cameras(1), tmp_path, **how)
        assert (made.made, made.kept) == (1 - kept, kept)


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


def test_cameras_are_drawn_as_they_are_needed(tmp_path):
    """A sequence of one's own makes a camera at a time."""
    asked = []

    class Turning:
        def __len__(self):
            return 40

        def __getitem__(self, k):
            if not 0 <= k < 40:
                raise IndexError(k)
            asked.append(k)
            return cameras(40)[k]

    from collections.abc import Sequence

    Sequence.register(Turning)
    made = fh.render_many(scene(), Turning(), tmp_path, channels="z", part=(4, 8))
    assert made.made == 5
    # Each once for the digest, the first for a try, and then those of the part.
    assert asked == [*range(40), 0, *range(15, 20)]


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
