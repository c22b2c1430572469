"""Objects by their names, of which there may be many."""

import copy
import pickle

import firsthit as fh
import numpy as np
import pytest
from firsthit._objects.object_list import ObjectList


def boxes(count: int) -> fh.Scene:
    scene = fh.Scene()
    for k in range(count):
        scene.add(fh.Box((3 * k, 0, 0), (3 * k + 1, 1, 1)), name=f"part {k}")
    return scene


def test_a_thousand_names_are_looked_up_without_a_walk_for_each(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene = boxes(1000)
    names = [made.name for made in scene.objects]
    scene.hide(names)
    visits = 0
    get = ObjectList.__getitem__

    def counted(self: ObjectList, key: int) -> object:
        nonlocal visits
        visits += 1
        return get(self, key)

    def walk(self: ObjectList) -> None:
        raise AssertionError("a walk over all objects")

    monkeypatch.setattr(ObjectList, "__getitem__", counted)
    monkeypatch.setattr(ObjectList, "__iter__", walk)
    scene.show(names)
    scene.move(names, np.eye(4))
    for name in names:
        scene.hide(name)
    scene.show("part 999")
    scene.remove("part 998")
    found = scene.shoot([[2997.5, 0.5, 9]], (0, 0, -1), objects=["part 999", "part 3"])
    assert found.object == [999]
    assert visits < 20 * len(names)


def test_a_slip_of_the_finger_is_told() -> None:
    scene, camera = boxes(2), fh.Camera.look_at((1, 1, 9), (1, 1, 0), (0, 1, 0), 45, 4, 4)
    with pytest.raises(ValueError, match="'prat 1'; did you mean 'part 1'"):
        scene.hide("prat 1")
    with pytest.raises(ValueError, match="'PART 1'; did you mean 'part 1'"):
        scene.hide("PART 1")
    with pytest.raises(ValueError, match="got 'depht'; depth is called z, the distance"):
        fh.render(scene, camera, channels="depht")
    scene.add(fh.Sphere((0, 0, 0), 1), name="t")
    with pytest.raises(ValueError, match=r"no object with the name 'dept'$"):
        scene.hide("dept")
    with pytest.raises(ValueError, match="got 'lambrt'; did you mean 'lambert'"):
        fh.render(scene, camera, shade="lambrt")


def test_names_stay_right_whatever_is_added_removed_or_copied() -> None:
    scene = boxes(3)
    aim = np.array([[0.5, 0.5, 9], [3.5, 0.5, 9], [6.5, 0.5, 9]])
    with pytest.raises(ValueError, match="no object with the name 'late'"):
        scene.hide("late")
    before = scene.shoot(aim, (0, 0, -1))
    twin = copy.copy(scene)
    scene.remove("part 1")
    scene.add(fh.Box((3, 0, 0), (4, 1, 1)), name="late")
    twin.add(fh.Box((3, 0, 2), (4, 1, 3)), name="other")
    near = r"; did you mean 'part 2'\?"
    for of, lacks, hint in ((scene, "part 1", near), (scene, "other", ""), (twin, "late", "")):
        with pytest.raises(ValueError, match=f"no object with the name '{lacks}'{hint}$"):
            of.hide(lacks)
    for of, name, expected in ((scene, "late", 3), (twin, "other", 3), (twin, "part 1", 1)):
        for each in (of, pickle.loads(pickle.dumps(of))):
            found = each.shoot(aim, (0, 0, -1), objects=[name]).object
            np.testing.assert_array_equal(found, [-1, expected, -1])
    # What was shot before a removal still knows the name.
    scan = fh.LidarScan.from_hits(before, classes={"part 1": 7})
    np.testing.assert_array_equal(scan.classification, [0, 7, 0])
    scene.add(fh.Box((9, 0, 0), (10, 1, 1)), name="late")
    with pytest.raises(ValueError, match="2 objects have the name 'late'"):
        scene.move("late", None)
