"""The oracle's answers, through Python."""

import json

import firsthit as fh
import numpy as np
import pytest
from support import REFDATA, needs_refdata

CASES = sorted(REFDATA.glob("oracle/*.json"))


def scene_of(case):
    scene = fh.load(REFDATA / "oracle" / case["mesh"]) if "mesh" in case else fh.Scene()
    for made in case.get("objects", []):
        if "sphere" in made:
            scene.add(fh.Sphere(made["sphere"][:3], made["sphere"][3]))
        elif "plane" in made:
            scene.add(fh.Plane(made["plane"][:3], made["plane"][3:]))
        else:
            points = np.reshape(made["tris"], (-1, 3))
            scene.add(fh.Mesh(points, np.arange(len(points)).reshape(-1, 3)))
    return scene


@needs_refdata
@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_every_pixel_of_every_case_agrees(path):
    case = json.loads(path.read_text())
    c, scene = case["camera"], scene_of(case)
    camera = fh.Camera(
        c["x_c"],
        c["u_c"],
        c["v_up"],
        c["z_p"],
        c["w"],
        c["h"],
        c["M"],
        c["N"],
        projection="orthographic" if c["ortho"] else "perspective",
    )
    hits = scene.shoot(camera)
    before = np.cumsum([0] + [max(made.triangles, 1) for made in scene.objects])
    # The oracle's row 0 is the bottom one, and it counts primitives through all objects.
    t = hits.t[::-1]
    number = np.where(hits.object < 0, -1, before[hits.object] + hits.primitive)[::-1]
    with np.load(path.with_suffix(".npz")) as answer:
        same = lambda a: np.isclose(t, a, rtol=1e-9, atol=0)  # noqa: E731
        clear, edge, silhouette = (answer["amb"] == kind for kind in range(3))
        assert clear.sum() > 100
        assert (same(answer["t"]) & (number == answer["prim"]))[clear].all()
        candidate = (answer["cand"] == number[..., None]).any(-1)
        assert (same(answer["t"]) & candidate)[edge].all()
        other = np.isclose(t[..., None], answer["alts"], rtol=1e-9, atol=0).any(-1)
        assert (other | same(answer["t"]))[silhouette].all()


@needs_refdata
def test_every_ray_from_inside_hits():
    scene = fh.load(REFDATA / "oracle" / "ico3.ply")
    with np.load(REFDATA / "oracle" / "rays_ico3.npz") as rays:
        assert (scene.shoot(rays["origin"], rays["dir"]).object == 0).all()
