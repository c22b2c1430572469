"""Threads, processes, signals, memory, and the program."""

import concurrent.futures
import json
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time

import firsthit as fh
import numpy as np
import pytest
from support import TESTDATA, ball, bumpy_sphere


def directions(n, seed=0):
    return np.random.default_rng(seed).normal(size=(n, 3))


def shoot_in_child(scene):
    return float(scene.shoot(np.zeros(3), directions(5000)).t.sum())


@pytest.mark.parametrize("method", ["fork", "spawn"])
@pytest.mark.filterwarnings("ignore:This process")
def test_children_shoot_after_fork_and_spawn(method):
    scene = ball()
    expected = shoot_in_child(scene)
    with multiprocessing.get_context(method).Pool(2) as pool:
        assert pool.map(shoot_in_child, [scene] * 4) == [expected] * 4


def test_sixteen_threads_may_ask_one_scene():
    scene = fh.Scene()
    scene.add(fh.Mesh(*bumpy_sphere(30, 1)))
    ways = [directions(20_000, seed) for seed in range(16)]
    with concurrent.futures.ThreadPoolExecutor(16) as pool:
        found = list(pool.map(lambda way: scene.shoot(np.zeros(3), way).t, ways))
    for way, t in zip(ways, found, strict=True):
        np.testing.assert_array_equal(t, scene.shoot(np.zeros(3), way).t)


def test_threads_that_read_a_channel_at_once_get_the_same_memory():
    scene = ball()
    camera = fh.Camera.framing(scene, rows=300, columns=300)
    for _ in range(5):
        hits = scene.shoot(camera)
        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            made = list(pool.map(lambda name, hits=hits: getattr(hits, name), 4 * ["normal"]))
            made_again = list(pool.map(lambda name, hits=hits: getattr(hits, name), 4 * ["origin"]))
        assert all(np.shares_memory(array, hits.normal) for array in made)
        assert all(np.shares_memory(array, hits.origin) for array in made_again)


def test_other_threads_go_on_while_rays_are_shot():
    ticks = []
    done = threading.Event()

    def tick():
        while not done.wait(0.001):
            ticks.append(time.monotonic())

    scene = fh.Scene()
    scene.add(fh.Mesh(*bumpy_sphere(60, 1)))
    scene.shoot(np.zeros(3), [0, 0, 1])
    thread = threading.Thread(target=tick)
    thread.start()
    start = time.monotonic()
    scene.shoot(np.zeros(3), directions(300_000), threads=1)
    end = time.monotonic()
    done.set()
    thread.join()
    assert sum(start < at < end for at in ticks) >= 3


INTERRUPTED = """
import time, numpy as np, firsthit as fh
scene = fh.Scene()
scene.add(fh.Sphere((0, 0, 0), 1))
camera = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 45, 4000, 4000)
print("ready", flush=True)
try:
    fh.render(scene, camera, samples=4096)
except KeyboardInterrupt:
    print("stopped", time.time(), scene.shoot((0, 0, 5), (0, 0, -1)).t, flush=True)
"""


def test_ctrl_c_interrupts_and_leaves_everything_usable():
    command = [sys.executable, "-c", INTERRUPTED]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout.readline() == "ready\n"
        time.sleep(0.5)
        sent = time.time()
        os.kill(child.pid, signal.SIGINT)
        words = child.stdout.read().split()
    assert child.returncode == 0
    assert words[0] == "stopped"
    assert words[2] == "4.0"
    # Half a second is promised; the rest is for machines with other things to do.
    assert float(words[1]) - sent < 2


MEMORY = """
import resource, numpy as np, firsthit as fh
n = 10_000_000
scene = fh.Scene()
scene.add(fh.Sphere((0, 0, 0), 1))
scene.shoot(np.zeros((1000, 3)), [0, 0, 1])
origins = np.zeros((n, 3), np.float32)
directions = np.ones((n, 3), np.float32)
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
hits = scene.shoot(origins, directions)
made = sum(array.nbytes for array in (*hits._arrays, *hits._source.rays.arrays))
print((resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) * 1024 - made)
"""


def test_ten_million_rays_need_little_beside_their_inputs_and_outputs():
    out = subprocess.run([sys.executable, "-c", MEMORY], capture_output=True, text=True, check=True)
    assert int(out.stdout) < 64e6


def test_the_program_is_the_rust_one(tmp_path):
    def run(*arguments):
        command = [sys.executable, "-m", "firsthit", *arguments]
        return subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, check=False)

    info = run("info", str(TESTDATA / "cube_binary.stl"), "--json")
    assert (info.returncode, json.loads(info.stdout)["triangles"]) == (0, 12)
    assert run("render", "none.ply").returncode == 3
    assert run("--nonsense").returncode == 2
    assert run("demo", "--size", "32x20", "--samples", "1").returncode == 0
    assert (tmp_path / "demo.png").stat().st_size > 500


def test_a_wrong_instruction_set_fails_the_first_call_that_needs_it_not_the_import():
    script = """
import firsthit as fh
print(fh.__version__)
scene = fh.Scene()
scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
for call in (fh.info, lambda: scene.shoot((0, 0, 5), (0, 0, -1))):
    try:
        call()
    except ValueError as error:
        print(error)
"""
    child = subprocess.run(
        [sys.executable, "-c", script],
        env=os.environ | {"FIRSTHIT_ISA": "sse9"},
        capture_output=True,
        text=True,
        check=False,
    )
    version, *errors = child.stdout.splitlines()
    assert version == fh.__version__, child.stderr
    assert len(errors) == 2
    assert all(error.startswith("FIRSTHIT_ISA must be ") for error in errors)
