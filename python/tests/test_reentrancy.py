"""Scenes used while they are built: by handlers, finalisers, children; and with little memory."""

import subprocess
import sys

import pytest
from support import PRELUDE, output

#: A scene whose trees take some tenths of a second, and rays that meet it.
SLOW = """
from support import bumpy_sphere
points, triangles = bumpy_sphere(400, 1)
scene = fh.Scene()
scene.add(fh.Mesh(points, triangles))
def shot():
    return float(scene.shoot((0, 0, 0), (0, 0, 1)).t)
"""


def test_a_signal_s_handler_may_use_the_scene_that_is_being_built():
    script = """
seen = []
def handler(number, frame):
    seen.append(shot())
signal.signal(signal.SIGALRM, handler)
signal.setitimer(signal.ITIMER_REAL, 0.06)
begun = scene.shoot((0, 0, 0), (0, 0, 1)).t
signal.setitimer(signal.ITIMER_REAL, 0)
print(len(seen), seen == [begun])
"""
    assert output(SLOW + script) == ["1", "True"]


def test_what_a_handler_adds_meanwhile_is_there_afterwards():
    script = """
def handler(number, frame):
    added.append(scene.add(fh.Sphere((0, 0, 0), 0.1)))
    met.append(int(scene.shoot((0, 0, 0), (0, 0, 1)).object))
added, met = [], []
signal.signal(signal.SIGALRM, handler)
signal.setitimer(signal.ITIMER_REAL, 0.06)
first = int(scene.shoot((0, 0, 0), (0, 0, 1)).object)
print(added, met, first, int(scene.shoot((0, 0, 0), (0, 0, 1)).object), len(scene.objects))
"""
    assert output(SLOW + script) == ["[1]", "[1]", "0", "1", "2"]


def test_a_finaliser_may_use_the_scene_that_is_being_built():
    script = """
class Finalised:
    def __del__(self):
        seen.append(shot())

class Sphere(fh.Sphere):
    def _native(self):
        waste = Finalised()
        waste.itself = waste
        del waste
        gc.collect()
        return super()._native()

seen = []
scene.add(Sphere((0, 0, 0), 0.5))
seen.clear()
print(shot(), *set(seen))
"""
    assert output(SLOW + script) == ["0.5", "0.5"]


def test_two_scenes_whose_handlers_use_each_other_do_not_wait_for_ever():
    script = """
class Box(fh.Box):
    def _native(self):
        other = uses.pop(id(self), None)
        if other is not None:
            time.sleep(0.2)
            other.shoot((0, 0, 0), (0, 0, 1))
        return super()._native()

uses, other = {}, fh.Scene()
for mine, its in ((scene, other), (other, scene)):
    box = Box((-9, -9, -9), (9, 9, 9))
    mine.add(box)
    uses[id(box)] = its
def build(which):
    which.shoot((0, 0, 0), (0, 0, 1))
threads = [threading.Thread(target=build, args=(each,)) for each in (scene, other)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join(20)
print(*(thread.is_alive() for thread in threads), flush=True)
os._exit(0)
"""
    assert output(SLOW + script) == ["False", "False"]


def test_threads_that_come_meanwhile_wait_for_the_one_that_builds():
    script = """
built = []
build = fh._firsthit.Scene
fh._objects.traceable._firsthit = type("Counted", (), {
    **vars(fh._firsthit), "Scene": staticmethod(lambda *given: built.append(1) or build(*given))
})
threads = [threading.Thread(target=shot) for _ in range(8)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
print(len(built))
"""
    assert output(SLOW + script) == ["1"]


@pytest.mark.skipif(sys.platform == "win32", reason="no fork")
def test_a_child_that_is_forked_while_the_scene_is_built_shoots():
    script = """
def forked():
    time.sleep(0.06)
    results.append(not is_built)
    child = os.fork()
    if child == 0:
        signal.alarm(20)
        faulthandler.dump_traceback_later(15)
        many = scene.shoot(np.zeros(3), np.random.default_rng(1).normal(size=(5000, 3)))
        os._exit(0 if (many.object == 0).all() and shot() else 1)
    results.append(os.waitpid(child, 0)[1])
results, is_built = [], []
thread = threading.Thread(target=forked)
thread.start()
shot()
is_built.append(True)
thread.join()
print(*results)
"""
    assert output(SLOW + script) == ["True", "0"]


@pytest.mark.skipif(sys.platform == "win32", reason="no fork")
def test_a_child_that_is_forked_while_a_picture_is_made_makes_one():
    script = """
camera = fh.Camera.look_at((0, -5, 0), (0, 0, 0), (0, 0, 1), 45, 40, 40)
shot()
def forked():
    for _ in range(20):
        time.sleep(0.004)
        child = os.fork()
        if child == 0:
            signal.alarm(20)
            faulthandler.dump_traceback_later(15)
            fh.render(scene, camera, samples=1)
            os._exit(0)
        results.append(os.waitpid(child, 0)[1])
results = []
thread = threading.Thread(target=forked)
thread.start()
while thread.is_alive():
    fh.render(scene, camera, samples=1)
    scene.add_light(fh.PointLight((0, 0, 9)))
print(len(results), *set(results))
"""
    assert output(SLOW + script, 120) == ["20", "0"]


LIMITED = """
limit = int(sys.argv[1])
camera = fh.Camera.look_at((0, -5, 0), (0, 0, 0), (0, 0, 1), 45, 60, 80)
now = 1024 * int(open("/proc/self/status").read().split("VmSize:")[1].split()[0])
resource.setrlimit(resource.RLIMIT_AS, (now + limit, now + limit))
for work in (
    shot,
    lambda: fh.render(scene, camera, threads=8),
    lambda: scene.shoot(camera, threads=64).normal,
    lambda: scene.shoot(np.zeros((2000, 3)), (0, 0, 1), threads=3),
):
    try:
        work()
        print("done")
    except MemoryError as error:
        print("memory")
"""


@pytest.mark.skipif(sys.platform != "linux", reason="a limit on the address space is Linux's")
@pytest.mark.parametrize("megabytes", [0.1, 2, 4.3, 8, 17, 40, 70, 132, 210, 1000])
def test_little_address_space_is_an_error_and_no_panic(megabytes):
    command = [sys.executable, "-c", PRELUDE + SLOW + LIMITED, str(int(megabytes * 2**20))]
    child = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert "panic" not in child.stderr.lower()
    assert "PanicException" not in child.stderr
    if megabytes <= 17:
        assert (child.returncode, set(child.stdout.split())) == (0, {"memory"}), child.stderr
    if megabytes >= 1000:
        assert (child.returncode, set(child.stdout.split())) == (0, {"done"}), child.stderr
