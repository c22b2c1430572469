"""The explanation of one ray agrees with what else there is to be asked."""

import json
import pickle
import subprocess
import sys

import firsthit as fh
import numpy as np
import pytest
from support import ball, bumpy_sphere


def everything(seed):
    """Shapes in a heap, some in one place, some masked or hidden."""
    random = np.random.default_rng(seed)
    scene = fh.Scene()
    bumpy = fh.Mesh(*bumpy_sphere(8, seed))
    for _ in range(12):
        place = np.eye(4)
        place[:3, 3] = random.uniform(-2, 2, 3)
        shapes = [
            bumpy,
            fh.Sphere(random.uniform(-2, 2, 3), 0.7),
            fh.Box((-1, -1, -1), random.uniform(0, 1, 3)),
            fh.Disc((0, 0, 0), random.normal(size=3), 1.5),
        ]
        shape = shapes[random.integers(4)]
        mask = int(random.integers(1, 4))
        for _ in range(random.integers(1, 3)):
            scene.add(shape, name=f"n{len(scene.objects)}", transform=place, mask=mask)
    scene.hide(int(random.integers(len(scene.objects))))
    return scene, random


@pytest.mark.parametrize("seed", range(4))
def test_it_agrees_with_shoot_and_shoot_all(seed):
    scene, random = everything(seed)
    settings = [{}, {"cull": "back"}, {"mask": 1}, {"t_max": 3.0}, {"t_min": -2.0}]
    hits = 0
    for k in range(100):
        origin = random.uniform(-4, 4, 3)
        ray = origin, random.uniform(-2, 2, 3) - origin
        use = settings[k % len(settings)]
        story, hit = scene.explain(*ray, **use), scene.shoot(*ray, **use)
        met = scene.shoot_all(*ray, **use)
        if hit.object < 0:
            assert story.hit is None
            assert story.behind_count == 0
            continue
        hits += 1
        for name in ("t", "object", "primitive", "face", "front"):
            assert story.hit[name] == getattr(hit, name), name
        for name in ("position", "normal", "base_color"):
            np.testing.assert_array_equal(story.hit[name], np.asarray(getattr(hit, name)))
        assert story.behind_count == len(met.t) - 1
        assert [place.t for place in story.behind] == list(met.t[1:11])
        assert [place.front for place in story.behind] == list(met.front[1:11])
        by_reason = {one.object: one.reason for one in story.candidates}
        assert list(by_reason) == list(range(len(scene.objects)))
        for identifier, reason in by_reason.items():
            if reason in {"hidden", "masked"}:
                continue
            alone = scene.shoot(*ray, objects=identifier, **use)
            assert (alone.object >= 0) == (reason in {"hit", "tied", "behind_hit"}), reason
    assert hits > 20


def test_a_pixel_is_that_of_a_camera():
    scene, _ = everything(9)
    camera = fh.Camera.look_at((0, -9, 3), (0, 0, 0), (0, 0, 1), 40, 5, 7)
    hits = scene.shoot(camera)
    for row in range(5):
        for column in range(7):
            story = scene.explain(camera, pixel=(row, column))
            found = -1 if story.hit is None else story.hit["object"]
            assert found == hits.object[row, column]
            if found >= 0:
                assert story.hit["t"] == hits.t[row, column]
                assert story.to_dict()["pixel"]["z"] == hits.z[row, column]
    limited = scene.explain(camera, pixel=(2, 3), t_max=1.0, cull="front")
    assert limited.hit is None
    assert limited.to_dict()["ray"]["cull"] == "front"


def test_rays_that_leave_surfaces_and_chosen_objects():
    scene = fh.Scene()
    scene.add(fh.Mesh(*bumpy_sphere(8, 1)), name="skin")
    scene.add(fh.Sphere((0, 0, 0), 0.1), name="core")
    hits = scene.shoot((0, 0, 5), (0, 0, -1))
    inwards = hits.leave((0.0, 0.0, -1.0))
    story = scene.explain(inwards)
    assert story.hit["name"] == "core"
    assert story.to_dict()["ray"]["leaves"] == [0, int(hits.primitive)]
    story = scene.explain(inwards, objects="skin")
    assert (story.hit["name"], story.counts) == ("skin", {"hit": 1, "not_among": 1})


def test_the_text_is_that_of_the_program(tmp_path):
    (tmp_path / "part.obj").write_text("o one\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    ray = "0.2,0.3,5,0,0,-1"
    command = [sys.executable, "-m", "firsthit", "probe", "part.obj", "--ray", ray]
    told = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    story = fh.load(tmp_path / "part.obj").explain((0.2, 0.3, 5), (0, 0, -1))
    assert told.stdout == f"{story}\n"
    command.append("--json")
    told = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    record = json.loads(told.stdout)
    assert record.pop("warnings") == record.pop("guessed") == []
    assert record == story.to_dict() == json.loads(json.dumps(story.to_dict()))


def test_a_story_can_be_pickled_and_is_not_changed_from_outside():
    scene = ball()
    story = scene.explain((0, 0, 5), (0, 0, -1))
    assert repr(story) == "Explanation(t=4.0, object=0, 1 objects)"
    story.hit["t"] = 0
    story.to_dict()["hit"] = None
    again = pickle.loads(pickle.dumps(story))
    assert again.hit["t"] == 4.0
    assert str(again) == str(story)
    assert repr(scene.explain((9, 9, 9), (0, 0, 1))) == "Explanation(miss, 1 objects)"
    assert scene.explain((0, 0, 5), (0, 0, 0)).fault == "its direction is zero"


def test_what_makes_no_sense_is_refused():
    scene = ball()
    camera = fh.Camera.look_at((0, -9, 3), (0, 0, 0), (0, 0, 1), 40, 5, 7)
    up = (0, 0, 1)
    with pytest.raises(ValueError, match="5 rows and 7 columns, from 0,0 to 4,6"):
        scene.explain(camera, pixel=(0, 7))
    with pytest.raises(ValueError, match="one of the picture"):
        scene.explain(camera, pixel=(-1, 0))
    with pytest.raises(ValueError, match="pixel must be given"):
        scene.explain(camera)
    with pytest.raises(ValueError, match="pair"):
        scene.explain(camera, pixel=3)
    with pytest.raises(TypeError, match="int"):
        scene.explain(camera, pixel=(0.5, 1))
    with pytest.raises(ValueError, match="without a camera"):
        scene.explain(up, up, pixel=(0, 0))
    with pytest.raises(ValueError, match="direction must be left out"):
        scene.explain(camera, up, pixel=(0, 0))
    with pytest.raises(ValueError, match=r"one ray, got rays of shape \(2,\)"):
        scene.explain([up, up], up)
    with pytest.raises(ValueError, match="directions"):
        scene.explain(up)
    with pytest.raises(ValueError, match="cull"):
        scene.explain(up, up, cull="side")
    with pytest.raises(ValueError, match="behind"):
        scene.explain(up, up, behind=-1)
    with pytest.raises(ValueError, match="no object"):
        scene.explain(up, up, objects="cube")


def test_the_hit_has_node_mesh_and_material_of_the_channels():
    glass, steel = (fh.Material(name=name) for name in ("glass", "steel"))
    scene = fh.Scene()
    mesh = fh.Mesh(*bumpy_sphere(8, 2))
    scene.add(mesh, name="ball", material=steel)
    scene.add(mesh, name="ball", material=glass, transform=np.eye(4) + 4 * np.eye(4, k=3))
    scene.add(fh.Sphere((8, 0, 0), 1), name="ball", material=glass)
    scene.add(fh.Sphere((12, 0, 0), 1), name="ball")
    for x in (0, 4, 8, 12):
        ray = (x, 0, 9), (0, 0, -1)
        story, hits = scene.explain(*ray), scene.shoot(*ray)
        for channel in ("node", "mesh", "material"):
            number, entry = int(hits[channel]), story.hit[channel]
            if number < 0:
                assert entry is None, channel
                continue
            assert entry["id"] == number
            assert entry["name"] == hits.names(channel)[number]
            assert f"{channel} {number}" in str(story)
    assert story.hit["material"] is None


def test_what_is_between_a_dark_point_and_the_lamp():
    scene = fh.Scene()
    scene.add(fh.Mesh([(-9, -9, 0), (9, -9, 0), (0, 9, 0)], [(0, 1, 2)]), name="ground")
    scene.add(fh.Sphere((0, 0, 4), 1), name="cloud")
    scene.add(fh.Sphere((0, 0, 20), 1), name="beyond the lamp")
    camera = fh.Camera.look_at((0, -12, 3), (0, 0, 0), (0, 0, 1), 40, 9, 9)
    lamp = np.array([0.0, 0.0, 9.0])
    hits = scene.shoot(camera)
    on_ground = np.argwhere(hits.object == 0)
    blockers = set()
    for r, c in on_ground:
        to_lamp = lamp - hits.position[r, c]
        story = scene.explain(hits[r, c].leave(to_lamp), t_max=1)
        is_lit = scene.visible(hits[r, c], lamp)
        assert (story.hit is None) == is_lit
        assert story.to_dict()["ray"]["leaves"][0] == 0
        blockers.add(story.hit and story.hit["name"])
        if story.hit is not None:
            assert 0 < story.hit["t"] < 1
        else:
            assert story.candidates[0].reason == "left"
    assert blockers == {None, "cloud"}


def test_limits_and_filters_of_a_pixel_are_those_of_its_ray():
    scene = fh.Scene()
    scene.add(fh.Sphere((0, 0, 0), 1), name="a", mask=1)
    scene.add(fh.Sphere((0, 3, 0), 1), name="b", mask=2)
    camera = fh.Camera.look_at((0, -9, 0), (0, 0, 0), (0, 0, 1), 40, 3, 3)
    limits = {}, {"t_min": 9.0}, {"t_max": 9.0}
    for use in (*limits, {"mask": 2}, {"cull": "front"}, {"skip": (0, 0)}):
        by_pixel = scene.explain(camera, pixel=(1, 1), **use).to_dict()
        ray = by_pixel["ray"]
        by_ray = scene.explain(ray["origin"], ray["direction"], **use).to_dict()
        assert by_pixel.pop("pixel")["column"] == 1
        assert by_ray.pop("pixel") is None
        assert by_pixel == by_ray
    with pytest.raises(ValueError, match="t_max must be one number"):
        scene.explain(camera, pixel=(1, 1), t_max=[1.0, 2.0])
    with pytest.raises(ValueError, match="one ray"):
        scene.explain(camera, pixel=(1, 1), mask=[1, 2])
