"""Where the rays of a job in parts come from."""

import itertools
import os
from concurrent.futures import ThreadPoolExecutor

import firsthit as fh
import numpy as np
import pytest
from firsthit.many._ray_files import ray_files
from many_support import all_hits, cameras, rays, scene

pytestmark = pytest.mark.usefixtures("workers_find_the_tests")


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
