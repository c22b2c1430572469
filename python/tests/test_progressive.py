"""Pictures that get better: the bytes of `render` at the end, and no damage by stopping early."""

import os
import signal
import subprocess
import sys
import time

import firsthit as fh
import numpy as np
import pytest
from support import ball, bumpy_sphere

CAMERA = fh.Camera.look_at((0, -6, 3), (0, 0, 0), (0, 0, 1), 40, rows=20, columns=30)
LENS = CAMERA.thin_lens(aperture=0.4, focus=6)

#: A channel of each kind: of sums, of all samples at once, of centres, and lines.
CHANNELS = ("z", "color", "ao", "samples", "crypto_object", "edge", "alpha", "object")


@pytest.fixture
def scene():
    scene = fh.Scene()
    scene.add(fh.Mesh(*bumpy_sphere(8, 1)), name="stone", color="orange")
    scene.add(fh.Box((-4, -4, -2), (4, 4, -1.5)))
    return scene


def assert_same(one, other):
    """Frames are the same, bit for bit, and say the same of themselves."""
    assert one.channels == other.channels
    for name, array in one.items():
        assert (array.dtype, array.shape) == (other[name].dtype, other[name].shape)
        assert array.tobytes() == other[name].tobytes(), name
    assert one.metadata == other.metadata
    assert one.display == other.display


def red(hits):
    return np.where(hits.object[..., None] >= 0, [1.0, 0.25, 0.0], 0.5)


def drawn(hits, draws):
    return draws.four()[..., :3] + red(hits)


@pytest.mark.parametrize(("samples", "counts"), [(1, [1]), (2, [1, 2]), (6, [1, 2, 4, 6])])
@pytest.mark.parametrize(
    "look",
    [
        {"channels": CHANNELS, "edges": 1.5},
        {"environment": fh.Environment.daylight(30), "cull": "back", "region": np.s_[3:9, 5:]},
        {"background": "transparent", "light": "studio", "color_by": "height", "threads": 1},
        {"shade": fh.Shader("path", depth=3), "objects": "stone", "threads": 3},
        {"channels": CHANNELS, "shade": red, "edges": 2.0, "region": np.s_[:7, 4:20]},
        {"shade": drawn},
    ],
    ids=["channels", "environment", "transparent", "path", "own", "drawn"],
)
def test_the_last_frame_has_the_bytes_of_the_picture(scene, look, samples, counts, tmp_path):
    frames = list(fh.render_progressively(scene, CAMERA, samples=samples, **look))
    assert [frame.metadata["samples"] for frame in frames] == counts
    whole = fh.render(scene, CAMERA, samples=samples, **look)
    assert_same(frames[-1], whole)
    frames[-1].save(tmp_path / "a.npz")
    whole.save(tmp_path / "b.npz")
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


def test_each_frame_is_the_picture_of_so_many_samples(scene):
    how = {"channels": CHANNELS, "light": "overcast"}
    for frame in fh.render_progressively(scene, CAMERA, samples=5, **how):
        count = frame.metadata["samples"]
        assert_same(frame, fh.render(scene, CAMERA, samples=count, **how))
        assert set(frame["samples"].ravel()) == {count}


def test_without_a_number_there_are_as_many_as_render_takes(scene):
    frames = list(fh.render_progressively(scene, CAMERA))
    assert [frame.metadata["samples"] for frame in frames] == [1, 2, 4, 8, 16]
    assert_same(frames[-1], fh.render(scene, CAMERA))
    scene.shading = fh.Shading("unlit", samples=3)
    *_, last = fh.render_progressively(scene)
    assert_same(last, fh.render(scene))


def test_a_lens_begins_with_two_samples(scene):
    frames = list(fh.render_progressively(scene, LENS, samples=5, channels=("color", "z")))
    assert [frame.metadata["samples"] for frame in frames] == [2, 4, 5]
    assert_same(frames[-1], fh.render(scene, LENS, samples=5, channels=("color", "z")))
    with pytest.raises(ValueError, match="samples must be at least 2"):
        fh.render_progressively(scene, LENS, samples=1)


def test_without_channels_of_samples_there_is_one_frame(scene):
    (frame,) = fh.render_progressively(scene, CAMERA, samples=8, channels=("z", "object", "edge"))
    assert_same(frame, fh.render(scene, CAMERA, samples=8, channels=("z", "object", "edge")))


def test_a_function_of_one_s_own_is_called_once_for_each_sample(scene):
    seen = []

    def shade(hits, draws):
        seen.append(hits.shape)
        return red(hits)

    for _ in fh.render_progressively(scene, CAMERA, samples=6, shade=shade):
        pass
    assert seen == 6 * [(20, 30)]


def test_whoever_stops_early_keeps_frames_as_they_are(scene):
    steps = fh.render_progressively(scene, CAMERA, channels=("color", "z"), samples=64)
    first, second = next(steps), next(steps)
    kept = {name: array.copy() for name, array in first.items()}
    second["z"][:] = 7.0
    third = next(steps)
    steps.close()
    assert next(steps, None) is None
    for name, array in kept.items():
        np.testing.assert_array_equal(first[name], array)
    assert_same(third, fh.render(scene, CAMERA, channels=("color", "z"), samples=4))


def test_frames_are_of_the_scene_as_it_was_at_the_call(scene):
    expected = fh.render(scene, CAMERA, samples=4)
    steps = fh.render_progressively(scene, CAMERA, samples=4)
    next(steps)
    scene.add(fh.Sphere(center=(0, -2, 0), radius=1))
    scene.display = fh.Display(2)
    *_, last = steps
    assert_same(last, expected)


@pytest.mark.parametrize(
    ("given", "error", "words"),
    [
        ({"scene": 3}, TypeError, "takes a Scene"),
        ({"samples": 0}, ValueError, "samples must be from 1"),
        ({"channels": "x"}, ValueError, "channel"),
        ({"channels": "attribute:heat"}, ValueError, "attribute"),
        ({"color_by": "heat"}, ValueError, "color_by|attribute"),
        ({"region": np.s_[5:5, :]}, ValueError, "region"),
        ({"camera": fh.RaySensor([[0, 0, 5]], [[0, 0, -1]]), "edges": 1.0}, ValueError, "edges"),
        ({"shade": "toon"}, ValueError, "shade"),
        ({"shade": red, "ground": True}, ValueError, "ground does nothing"),
        ({"environment": "sky.hdr"}, TypeError, "environment must be"),
        ({"threads": 0}, ValueError, "threads"),
        ({"progress": "yes"}, TypeError, "progress must be"),
    ],
)
def test_what_makes_no_picture_is_refused_at_the_call(scene, given, error, words):
    with pytest.raises(error, match=words):
        fh.render_progressively(**({"scene": scene, "camera": CAMERA} | given))


@pytest.mark.parametrize("shade", ["direct", red])
def test_progress_counts_all_frames_and_only_grows(scene, shade):
    told = []
    steps = fh.render_progressively(
        scene,
        CAMERA,
        channels=("color", "ao", "z"),
        samples=6,
        shade=shade,
        progress=lambda done, total: told.append((done, total)),
    )
    assert told == []
    assert len(list(steps)) == 4
    assert told == sorted(told)
    assert len({total for _, total in told}) == 1
    assert told[-1][0] == told[-1][1]


def test_what_progress_raises_ends_the_frames():
    told = []

    def enough(done, total):
        told.append(done)
        if done > 2 * 600 * 2:
            raise LookupError("enough")

    steps = fh.render_progressively(ball(), CAMERA, samples=1024, progress=enough)
    with pytest.raises(LookupError, match="enough"):
        for _ in steps:
            pass
    count = len(told)
    assert next(steps, None) is None
    assert len(told) == count


INTERRUPTED = """
import time, numpy as np, firsthit as fh
scene = fh.Scene()
scene.add(fh.Sphere((0, 0, 0), 1))
camera = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 45, 300, 300)
steps = fh.render_progressively(scene, camera, samples=1 << 20)
first = next(steps)
kept = first["color"].copy()
print("ready", flush=True)
try:
    for frame in steps:
        %s
except KeyboardInterrupt:
    stopped = time.time()
    again = fh.render(scene, camera, samples=1)["color"]
    same = (first["color"] == kept).all() and (again == kept).all()
    print("stopped", stopped, same, next(steps, None), flush=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals are those of Unix")
@pytest.mark.parametrize("between", ["pass", "time.sleep(60)"], ids=["within", "between"])
def test_ctrl_c_ends_a_step_and_leaves_what_was_made(between):
    command = [sys.executable, "-c", INTERRUPTED % between]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout.readline() == "ready\n"
        time.sleep(0.5)
        sent = time.time()
        os.kill(child.pid, signal.SIGINT)
        words = child.stdout.read().split()
    assert child.returncode == 0
    # A step that was ended is the last one; between two steps nothing is lost.
    next_one = "None" if between == "pass" else "Frame(300"
    assert (words[0], words[2:4]) == ("stopped", ["True", next_one])
    # As for `render`.
    assert float(words[1]) - sent < 2


def test_a_noise_ends_the_samples_of_quiet_tiles():
    scene = fh.Scene()
    scene.add(fh.Sphere((0, 0, 0), 1))
    camera = fh.Camera.look_at((0, -5, 2), (0, 0, 0), (0, 0, 1), 60, rows=96, columns=128)
    asked = {"channels": ("color", "samples"), "ground": False}
    noisy = fh.render(scene, camera, noise=0.02, **asked)
    samples = noisy["samples"]
    # Tiles are asked after 32 samples for the first time, and the background has no noise.
    assert samples.min() == 32
    assert 32 < samples.max() <= 256
    most = fh.render(scene, camera, noise=1e-9, samples=40, **asked)
    whole = fh.render(scene, camera, samples=40, **asked)
    lit = most["samples"] == 40
    np.testing.assert_array_equal(most["color"][lit], whole["color"][lit])
    for wrong, message in [(0, "noise must be"), ("a", "noise must be"), (np.nan, "noise must be")]:
        with pytest.raises(ValueError, match=message):
            fh.render(scene, camera, noise=wrong)
    with pytest.raises(ValueError, match="region must be none where there is a noise"):
        fh.render(scene, camera, noise=0.1, region=np.s_[:8, :8])
    with pytest.raises(ValueError, match="shade of one's own"):
        fh.render(scene, camera, noise=0.1, shade=lambda hits: np.zeros((*hits.shape, 3)))


def test_ambient_occlusion_up_to_a_distance_is_a_channel():
    scene = fh.Scene()
    scene.add(fh.Sphere((0, 0, 0), 1))
    scene.add(fh.Box((-3, -3, -1.2), (3, 3, -1)))
    camera = fh.Camera.look_at((5, -4, 3), (0, 0, 0), (0, 0, 1), 40, rows=20, columns=30)
    near = fh.render(scene, camera, channels="ao:0.5", samples=16)["ao:0.5"]
    far = fh.render(scene, camera, channels="ao", samples=16)["ao"]
    assert near.shape == (20, 30)
    assert (near >= far).all()
    assert near.mean() > far.mean()
    with pytest.raises(ValueError, match=r"positive distance, such as ao:0\.5, got ao:-1"):
        fh.render(scene, camera, channels="ao:-1")


@pytest.mark.parametrize("name", ["sums", "squares", "samples"])
def test_a_state_whose_numbers_were_changed_is_refused(scene, tmp_path, name):
    state = tmp_path / "state.npz"
    fh.render(scene, CAMERA, samples=3, resume=state)
    with np.load(state) as file:
        arrays = {**file}
    arrays[name].flat[7] += 1
    np.savez(state, **arrays)
    with pytest.raises(ValueError, match=r"state\.npz, whose numbers were changed since"):
        fh.render(scene, CAMERA, samples=8, resume=state)


def test_a_picture_goes_on_from_the_state_in_a_file(scene, tmp_path):
    state = tmp_path / "state.npz"
    fh.render(scene, CAMERA, channels=CHANNELS, samples=3, resume=state)
    assert state.exists()
    resumed = fh.render(scene, CAMERA, channels=CHANNELS, samples=8, resume=str(state))
    assert_same(resumed, fh.render(scene, CAMERA, channels=CHANNELS, samples=8))
    # All is known: only what is not of the state is made anew.
    again = fh.render(scene, CAMERA, channels=CHANNELS, samples=8, resume=state)
    assert_same(again, resumed)
    for wrong, message in [
        ({"samples": 4, "resume": state}, "samples must be at least .* got 4, and .* has 8"),
        ({"samples": 8, "resume": state, "light": "sun"}, "state must be .* other light"),
        ({"samples": 8, "resume": state, "noise": 0.1}, "state must be .* another noise"),
        ({"resume": tmp_path / "state.npy"}, "resume must be a file whose name ends in .npz"),
        ({"resume": state, "channels": "z"}, "resume must be left out without color"),
        ({"resume": state, "shade": lambda hits: np.zeros((*hits.shape, 3))}, "one's own"),
    ]:
        with pytest.raises(ValueError, match=message):
            fh.render(scene, CAMERA, **wrong)
    with pytest.raises(TypeError):
        fh.render(scene, CAMERA, resume=3)


@pytest.mark.skipif(os.name == "nt", reason="signals are sent by number")
def test_ctrl_c_keeps_the_state_of_a_picture(tmp_path):
    state = tmp_path / "state.npz"
    program = f"""
import firsthit as fh
scene = fh.Scene()
scene.add(fh.Sphere((0, 0, 0), 1))
camera = fh.Camera.look_at((0, -6, 3), (0, 0, 0), (0, 0, 1), 40, rows=200, columns=300)
told = lambda done, total: done and print("begun", flush=True)
try:
    fh.render(scene, camera, samples=100_000, resume={str(state)!r}, progress=told)
except KeyboardInterrupt:
    print("stopped", flush=True)
"""
    with subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "begun\n"
        process.send_signal(signal.SIGINT)
        rest, _ = process.communicate(timeout=60)
    assert rest.endswith("stopped\n")
    known = np.load(state)["samples"]
    assert (known == known.flat[0]).all()
    assert 0 < known.flat[0] < 100_000


def test_a_state_of_other_numbers_of_an_attribute_is_refused(tmp_path):
    def painted(heat, of="vertex_properties"):
        scene = fh.Scene()
        corners = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
        triangles = [[0, 1, 2], [0, 2, 3]]
        scene.add(fh.Mesh(corners, triangles, **{of: {"heat": heat}}))
        return scene

    how = {"color_by": "attribute:heat", "color_range": (0, 9), "shade": "unlit"}
    state = tmp_path / "state.npz"
    fh.render(painted([0.0, 0, 0, 0]), CAMERA, samples=2, resume=state, **how)
    fh.render(painted([0.0, 0, 0, 0]), CAMERA, samples=3, resume=state, **how)
    for other in (painted([9.0, 0, 0, 0]), painted([0.0, 0], of="face_properties")):
        with pytest.raises(ValueError, match="state must be that of this picture"):
            fh.render(other, CAMERA, samples=4, resume=state, **how)


def test_a_state_that_cannot_be_saved_is_told_before_the_work(scene, tmp_path):
    told = []
    for name in ("gone/state.npz", "."):
        with pytest.raises((OSError, ValueError)):
            fh.render(
                scene,
                CAMERA,
                samples=4,
                resume=tmp_path / name,
                progress=lambda done, total: told.append(done),
            )
    assert not any(told)
