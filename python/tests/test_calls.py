"""How calls work: small ones without threads, long ones followed, none torn by others."""

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import firsthit as fh
import numpy as np
import pytest
from support import SQUARE, ball, bumpy_sphere

#: More than goes to the native half at a time.
LONG = (1 << 19) + 1000


def scene_of_everything():
    scene = fh.Scene()
    scene.add(fh.Mesh(*bumpy_sphere(20, 1)))
    scene.add(fh.Mesh(*SQUARE), transform=np.diag([3, 3, 3, 1.0]))
    scene.add(fh.Plane((0, 0, -2), (0, 0, 1)))
    scene.add(fh.Cone((1, 1, 0), (1, 1, 1), 0.5))
    return scene


@pytest.mark.parametrize("shoot", [fh.Scene.shoot, fh.Scene.occluded])
def test_what_another_thread_adds_meanwhile_is_for_the_next_call(shoot):
    scene, origins = ball(), np.full((LONG, 3), 5, np.float32)
    down = np.float32([0, 0, -1])

    def met():
        found = shoot(scene, origins, down, progress=meanwhile)
        return found if isinstance(found, np.ndarray) else found.object >= 0

    def meanwhile(done, total):
        if len(scene.objects) == 1:
            thread = threading.Thread(target=scene.add, args=(fh.Plane((0, 0, 0), (0, 0, 1)),))
            thread.start()
            thread.join()

    assert not met().any()
    assert len(scene.objects) == 2
    assert met().all()


def test_hits_are_of_the_scene_that_was_shot_at_though_another_thread_added():
    scene = ball()
    camera = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 20, 300, 400)
    before = scene.shoot(camera)

    def meanwhile(done, total):
        if len(scene.objects) == 1:
            scene.add(fh.Box((-9, -9, 1), (9, 9, 2)))

    hits = scene.shoot(camera, progress=meanwhile)
    assert len(scene.objects) == 2
    for name in ("t", "object", "normal", "position", "front"):
        np.testing.assert_array_equal(getattr(hits, name), getattr(before, name))


def threads_made(work):
    """How many threads or processes began on the machine meanwhile, of which one is not work's."""

    def number():
        numbers = []
        thread = threading.Thread(target=lambda: numbers.append(threading.get_native_id()))
        thread.start()
        thread.join()
        return numbers[0]

    before = number()
    work()
    # Past the largest number, Linux begins again at 300.
    return (number() - before) % (int(Path("/proc/sys/kernel/pid_max").read_text()) - 300)


@pytest.mark.skipif(sys.platform != "linux", reason="threads are numbered in order")
def test_calls_with_few_rays_make_no_threads():
    scene, camera = ball(), fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 20, 4, 4)
    origins = np.tile([0.0, 0, 5], (100, 1))
    scene.shoot([0, 0, 5], [0, 0, -1])

    def work():
        for _ in range(500):
            scene.shoot([0, 0, 5], [0, 0, -1])
            assert scene.shoot(origins, [0, 0, -1]).normal[0, 2] == 1
            assert scene.occluded(origins, [0, 0, -1]).all()
            assert scene.shoot(camera).z.shape == (4, 4)

    # A call that makes threads makes at least one. Other programs make some too, so one quiet try
    # of three suffices.
    assert any(threads_made(work) < 500 for _ in range(3))
    many = np.tile([0.0, 0, 5], (5000, 1))
    assert threads_made(lambda: [scene.shoot(many, [0, 0, -1]) for _ in range(50)]) > 50


def test_few_rays_and_many_come_to_the_same_bits():
    scene = scene_of_everything()
    rng = np.random.default_rng(3)
    origins, directions = rng.uniform(-3, 3, (2, 3000, 3))
    ends = rng.uniform(1, 9, 3000)
    many = scene.shoot(origins, directions, t_max=ends)
    met = scene.occluded(origins, directions, t_max=ends)
    assert len(np.unique(many.object)) == 5
    for start in range(0, 3000, 300):
        part = slice(start, start + 300)
        few = scene.shoot(origins[part], directions[part], t_max=ends[part])
        for name in few.channels:
            np.testing.assert_array_equal(few.channel(name), many.channel(name)[part], name)
        found = scene.occluded(origins[part], directions[part], t_max=ends[part])
        np.testing.assert_array_equal(found, met[part])


def test_a_small_camera_sees_what_its_rays_meet():
    scene = scene_of_everything()
    camera = fh.Camera.framing(scene, rows=15, columns=20)
    hits, rays = scene.shoot(camera), scene.shoot(*camera.rays())
    for name in rays.channels:
        np.testing.assert_array_equal(hits.channel(name), rays.channel(name), name)


def test_every_query_takes_a_camera_for_its_rays():
    scene = scene_of_everything()
    camera = fh.Camera.framing(scene, rows=5, columns=7)
    rays, ends = camera.rays(), np.linspace(1, 9, 7)
    for ask in (fh.Scene.occluded, fh.Scene.count, fh.Scene.path_length):
        expected = ask(scene, *rays, t_max=ends)
        np.testing.assert_array_equal(ask(scene, camera, t_max=ends), expected)
        assert expected.shape[:2] == (5, 7)
    met, expected = scene.shoot_all(camera, cull="back"), scene.shoot_all(*rays, cull="back")
    assert met.shape == (5, 7)
    np.testing.assert_array_equal(met.t, expected.t)
    first = scene.shoot_all(camera, k=2)
    np.testing.assert_array_equal(first.t, scene.shoot_all(*rays, k=2).t)
    with pytest.raises(ValueError, match="directions must be left out with a camera"):
        scene.count(camera, [0, 0, 1])
    with pytest.raises(ValueError, match=r"t_max .* must broadcast|have no shape \(3, 5, 7\)"):
        scene.count(camera, t_max=np.ones((3, 1, 1)))
    with pytest.raises(ValueError, match="origins must not be LeavingRays"):
        scene.path_length(scene.shoot(camera).leave([0, 0, 1]))


@pytest.mark.parametrize("length", [0, 1, 100, 3000, LONG])
def test_one_origin_or_direction_for_all_rays_is_one_for_each(length):
    rng, scene = np.random.default_rng(5), scene_of_everything()
    one, each = rng.uniform(-1, 1, 3), rng.uniform(-3, 3, (length, 3))
    all_of_it = np.broadcast_to(one, (length, 3)).copy()
    for given, told in [((one, each), (all_of_it, each)), ((each, one), (each, all_of_it))]:
        hits, expected = scene.shoot(*given), scene.shoot(*told)
        for name in ("t", "object", "position", "normal", "origin", "direction"):
            np.testing.assert_array_equal(getattr(hits, name), getattr(expected, name))
        np.testing.assert_array_equal(scene.occluded(*given), scene.occluded(*told))
    ends = np.arange(length) % 3 + 0.5
    alone = scene.shoot([0, 0, 9], [0, 0, -4], t_max=ends)
    np.testing.assert_array_equal(alone.t, np.where(ends > alone.t.min(initial=9), alone.t, np.inf))
    assert alone.normal.shape == (length, 3)


def followed(call):
    """Return what a call tells a function that follows it, and its result."""
    told = []
    made = call(lambda done, total: told.append((done, total)))
    return told, made


CAMERA = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 40, rows=120, columns=160)


@pytest.mark.parametrize(
    ("call", "total"),
    [
        (lambda told: ball().shoot([0, 0, 5], [0, 0, -1], progress=told), 1),
        (lambda told: ball().shoot(np.zeros((0, 3)), [0, 0, -1], progress=told), 0),
        (lambda told: ball().shoot(np.zeros((5000, 3)), [0, 0, -1], progress=told), 5000),
        (lambda told: ball().shoot(np.zeros((LONG, 3), "f4"), [0, 0, -1], progress=told), LONG),
        (lambda told: ball().shoot(CAMERA, progress=told), 19200),
        (lambda told: ball().occluded(np.zeros((5, 3)), [0, 0, -1], progress=told), 5),
        (lambda told: ball().occluded(np.zeros((LONG, 3), "f4"), [0, 0, 1], progress=told), LONG),
        (lambda told: ball().shoot(CAMERA).channel("normal", progress=told), 19200),
        (lambda told: ball().shoot(CAMERA).channel("z", progress=told), 19200),
        (lambda told: ball().shoot(CAMERA)[3:5].channel("z", progress=told), 320),
        (
            lambda told: ball().shoot(*CAMERA.rays()).channel("position", progress=told),
            19200,
        ),
        (lambda told: fh.render(ball(), CAMERA, progress=told), 19200 * 2 * 16),
        (lambda told: fh.render(ball(), CAMERA, channels=("z", "t"), progress=told), 19200 * 2),
        (
            lambda told: fh.render(
                ball(),
                CAMERA,
                channels=("color", "z"),
                samples=3,
                shade=lambda hits: np.zeros((*hits.shape, 3)),
                progress=told,
            ),
            19200 * (1 + 1 + 3),
        ),
    ],
)
def test_progress_only_grows_and_ends_with_everything(call, total):
    told, _ = followed(call)
    done = [each for each, _ in told]
    assert {of for _, of in told} <= {total}
    assert done == sorted(done)
    if total:
        assert told[-1] == (total, total)


def test_what_was_made_already_says_nothing():
    hits = ball().shoot(CAMERA)
    first, made = followed(lambda told: hits.channel("normal", progress=told))
    second, again = followed(lambda told: hits.channel("normal", progress=told))
    assert (bool(first), second) == (True, [])
    assert np.shares_memory(made, again)


def test_a_line_has_rays_and_percents_and_is_gone_at_the_end(capsys):
    ball().shoot(CAMERA, progress=True)
    said = capsys.readouterr().err
    assert "\r19200 of 19200 rays, 100 %" in said
    assert said.rsplit("\r", 2)[1].strip() == ""
    fh.render(ball(), CAMERA, samples=1, progress=True)
    assert "\rshooting: " in capsys.readouterr().err


@pytest.fixture
def large(tmp_path):
    """Write a file whose reading takes a while."""
    side = 700
    x, y = np.meshgrid(np.arange(side), np.arange(side))
    corners = np.stack([x, y, np.sin(x) * np.cos(y)], -1).reshape(-1, 3)
    first = (x + side * y)[:-1, :-1].ravel()
    faces = np.concatenate(
        [[first, first + 1, first + side + 1], [first, first + side + 1, first + side]], 1
    ).T
    scene = fh.Scene()
    scene.add(fh.Mesh(corners, faces))
    scene.save(tmp_path / "large.fhs")
    with (tmp_path / "large.obj").open("w") as file:
        np.savetxt(file, corners, fmt="v %g %g %g")
        np.savetxt(file, faces + 1, fmt="f %d %d %d")
    return tmp_path / "large.obj"


LONG_WORK = pytest.mark.parametrize(
    "work",
    [
        lambda path, told: fh.load(path, progress=told),
        lambda path, told: fh.open(path.with_suffix(".fhs"), verify=True, progress=told),
        lambda path, told: fh.load(path).shoot((0, 0, 9), (0, 0, -1), progress=told),
        lambda path, told: fh.load(path).lint(progress=told),
        lambda path, told: fh.load(path).section((9, 9, 0), (1, 0, 0), progress=told),
        lambda path, told: fh.load(path).save(path.with_suffix(".new.fhs"), progress=told),
    ],
)


@LONG_WORK
def test_ctrl_c_ends_long_work(work, large):
    def again_and_again():
        threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
        while True:
            work(large, None)

    with pytest.raises(KeyboardInterrupt):
        again_and_again()


@LONG_WORK
def test_steps_are_told_to_their_ends_and_can_be_stopped(work, large):
    told = []
    work(large, lambda *both: told.append(both))
    assert told
    assert all(0 <= done <= total for done, total in told)
    assert told[-1][0] == told[-1][1]

    def enough(done, total):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        work(large, enough)
    with pytest.raises(TypeError, match="progress must be"):
        work(large, "yes")


def test_steps_are_shown_with_their_names(large, capsys):
    fh.load(large, progress=True)
    said = capsys.readouterr().err
    assert f"parsing {large}: " in said
    assert "bytes, " in said


def test_what_progress_raises_ends_the_work():
    def enough(done, total):
        raise LookupError(f"enough of {total}")

    for call in (
        lambda: ball().shoot([0, 0, 5], [0, 0, -1], progress=enough),
        lambda: ball().shoot(CAMERA, progress=enough),
        lambda: fh.render(ball(), CAMERA, progress=enough),
        lambda: ball().shoot(CAMERA).channel("normal", progress=enough),
    ):
        with pytest.raises(LookupError, match="enough of"):
            call()
    with pytest.raises(TypeError, match="progress must be True or a function of two numbers"):
        ball().shoot(CAMERA, progress="yes")


@pytest.mark.parametrize("threads", [1, 3])
def test_channels_are_the_same_with_any_number_of_threads(threads):
    scene = scene_of_everything()
    expected = scene.shoot(CAMERA)
    hits = scene.shoot(CAMERA, threads=threads)
    for name in hits.channels:
        made = hits.channel(name, threads=threads)
        np.testing.assert_array_equal(made, expected.channel(name), name)
    with pytest.raises(ValueError, match="threads must be from 1 to 1024"):
        scene.shoot(CAMERA).channel("uv", threads=0)


INTERRUPTED = """
import threading, time, numpy as np, firsthit as fh
scene = fh.Scene()
scene.add(fh.Sphere((0, 0, 0), 1))
camera = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 45, 4000, 4000)
told = lambda done, total: print(done, total, flush=True)
try:
    fh.render(scene, camera, samples=4096, progress=told)
except KeyboardInterrupt:
    print("stopped", scene.shoot((0, 0, 5), (0, 0, -1)).t, flush=True)
"""


def test_ctrl_c_interrupts_what_is_followed():
    command = [sys.executable, "-c", INTERRUPTED]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as child:
        done, total = map(int, child.stdout.readline().split())
        child.send_signal(signal.SIGINT)
        *_, last = child.stdout
    assert 0 <= done < total == 4000 * 4000 * 2 * 4096
    assert (child.returncode, last) == (0, "stopped 4.0\n")
