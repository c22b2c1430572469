"""Folds and matrices of jobs in parts, against NumPy and `visible`."""

import subprocess
import sys

import firsthit as fh
import numpy as np
import pytest
from many_support import rays, scene

pytestmark = pytest.mark.usefixtures("workers_find_the_tests")
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
