"""Cameras and pictures."""

import firsthit as fh
import numpy as np
import pytest
from support import SQUARE, ball

CAMERA = {
    "position": (0.2, 1, 5),
    "aim": (0, -0.1, -3),
    "up": (0.1, 1, 0),
    "focal_length": 0.5,
    "width": 0.8,
    "height": 0.45,
    "rows": 9,
    "columns": 16,
}


@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
@pytest.mark.parametrize("ray_start", ["viewplane", "eye"])
def test_rays_and_distances_are_the_specifications_formulas(projection, ray_start):
    camera = fh.Camera(**CAMERA, projection=projection, ray_start=ray_start)
    origins, directions = camera.rays()
    u_c = np.array(CAMERA["aim"]) / np.linalg.norm(CAMERA["aim"])
    u_x = np.cross(u_c, CAMERA["up"])
    u_x /= np.linalg.norm(u_x)
    u_y = np.cross(-u_c, u_x)
    i = np.arange(9)[::-1, None, None]
    j = np.arange(16)[None, :, None]
    p_x, p_y = -0.4 + 0.8 / 16 * (j + 0.5), -0.225 + 0.45 / 9 * (i + 0.5)
    p = np.array(CAMERA["position"]) + 0.5 * u_c + p_x * u_x + p_y * u_y
    along = p - CAMERA["position"] if projection == "perspective" else u_c + 0 * p
    u_r = along / np.linalg.norm(along, axis=-1, keepdims=True)
    start = p
    if ray_start == "eye":
        start = (
            np.array(CAMERA["position"]) + 0 * p if projection == "perspective" else p - 0.5 * u_c
        )
    np.testing.assert_allclose(origins, start, atol=1e-14)
    np.testing.assert_allclose(directions, u_r, atol=1e-15)

    hits = ball().shoot(camera)
    met = hits.object == 0
    assert 0 < met.sum() < met.size
    there = origins[met] + hits.t[met][:, None] * directions[met]
    np.testing.assert_allclose(hits.position[met], there)
    z = (hits.position - CAMERA["position"]) @ u_c
    np.testing.assert_allclose(hits.z[met], z[met])
    whole = np.linalg.norm(hits.position - CAMERA["position"], axis=-1)
    np.testing.assert_allclose(hits.range[met], (whole if projection == "perspective" else z)[met])
    assert (hits.z[~met] == np.inf).all()
    assert (hits.range[~met] == np.inf).all()
    arrays = ball().shoot(origins, directions)
    np.testing.assert_array_equal(arrays.t, hits.t)
    np.testing.assert_array_equal(arrays.normal, hits.normal)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"aim": (0, 0, 0)}, "aim must be a finite direction, not zero"),
        ({"up": (0, 0.2, 6)}, "up must be in another direction than aim"),
        ({"focal_length": 0}, "focal_length must be a positive, finite number"),
        ({"rows": 0}, "rows must be at least 1"),
        ({"rows": 2.5}, "rows must be a whole number, got 2.5"),
        ({"columns": -1}, "columns must be zero or more"),
        ({"position": (np.nan, 0, 0)}, "position must be finite"),
        ({"position": (0, 0)}, "position must be three numbers"),
        ({"projection": "fisheye"}, "projection must be one of perspective, orthographic"),
        ({"ray_start": "lens"}, "ray_start must be one of viewplane, eye"),
        ({"width": "wide"}, "width must be a number, got 'wide'"),
    ],
)
def test_cameras_that_make_no_sense_are_refused_by_name(change, words):
    with pytest.raises(ValueError, match=words):
        fh.Camera(**{**CAMERA, **change})


def test_look_at_has_its_target_in_the_middle_and_says_what_it_is():
    camera = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 90, rows=4, columns=8)
    assert (camera.ray_start, camera.focal_length) == ("eye", 1.0)
    np.testing.assert_allclose((camera.width, camera.height), (4, 2), rtol=1e-15)
    np.testing.assert_array_equal(camera.aim, [0, 0, -1])
    np.testing.assert_array_equal(camera.right, [1, 0, 0])
    assert eval(repr(camera), {"Camera": fh.Camera}) == camera
    with pytest.raises(ValueError, match="target must be another point"):
        fh.Camera.look_at((0, 0, 5), (0, 0, 5), (0, 1, 0), 90, 4, 8)
    with pytest.raises(ValueError, match="fov must be between 0 and 180"):
        fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 180, 4, 8)


def small() -> fh.Camera:
    return fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 40, rows=12, columns=16)


def test_a_frame_has_its_channels_with_their_types():
    names = ("color", "t", "range", "z", "object", "primitive", "face", "normal", "position")
    frame = fh.render(ball(), small(), channels=(*names, "barycentric", "uv", "front"))
    kinds = {name: (frame[name].dtype.str[1:], frame[name].shape[2:]) for name in frame}
    assert kinds == {
        **dict.fromkeys(("t", "range", "z"), ("f8", ())),
        **dict.fromkeys(("object", "primitive", "face"), ("i4", ())),
        **dict.fromkeys(("normal", "position", "barycentric"), ("f8", (3,))),
        "color": ("f4", (3,)),
        "uv": ("f8", (2,)),
        "front": ("b1", ()),
    }
    hits = ball().shoot(small())
    for name in ("t", "z", "object", "normal"):
        np.testing.assert_array_equal(frame[name], getattr(hits, name))
    assert repr(frame).startswith("Frame(16 x 12 pixels: color, t,")
    with pytest.raises(KeyError, match=r"no channel 'depth'; .*; depth is called z, the distance"):
        frame["depth"]
    with pytest.raises(KeyError, match="; did you mean 'normal'"):
        frame["normals"]


@pytest.mark.parametrize("length", [1.0, 1e-200, 1e200])
def test_incidence_is_the_angle_of_the_closed_form_on_both_sides(length):
    scene = fh.Scene()
    scene.add(fh.Sphere((0, 0, 0), 2))
    scene.add(fh.Mesh([(-9, -9, 0), (9, -9, 0), (0, 9, 0)], [[0, 1, 2]]), transform=shifted(20))
    # The sine is the distance from the axis over the radius.
    offsets = np.array([0, 1e-12, 1e-7, 0.3, 1.0, 1.9999, 2 - 1e-9])
    origins = np.stack([offsets, 0 * offsets, 0 * offsets + 5], axis=-1)
    down = scene.shoot(origins, (0, 0, -length))
    np.testing.assert_allclose(down.incidence, np.arcsin(offsets / 2), rtol=1e-13, atol=1e-15)
    inside = scene.shoot((0.5, 0, 0), (0, 0, length))
    np.testing.assert_allclose(inside.incidence, np.arcsin(0.25), rtol=1e-15)
    angles = np.array([0, 1e-9, 0.7, 1.5])
    ways = length * np.stack([np.sin(angles), 0 * angles, np.cos(angles)], axis=-1)
    for side in (1, -1):
        met = scene.shoot((0, 0, 20 - side), side * ways)
        seen = met.object == 1
        assert seen.tolist() == [True] * 3 + [False]
        np.testing.assert_allclose(met.incidence[seen], angles[seen], rtol=1e-14, atol=1e-18)
    assert np.isnan(scene.shoot((0, 0, 9), (0, length, 0)).incidence)


def shifted(z: float) -> np.ndarray:
    matrix = np.eye(4)
    matrix[2, 3] = z
    return matrix


def test_colours_are_the_objects_the_lights_and_the_backgrounds():
    scene = fh.Scene()
    scene.add(fh.Mesh(*SQUARE), transform=np.diag([9, 9, 9, 1.0]), color=(0.5, 0.25, 1))
    camera = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 40, rows=4, columns=4)
    sky = (0.2, 0.3, 0.5)
    unlit = fh.render(scene, camera, background=sky, shade="unlit")["color"]
    np.testing.assert_array_equal(unlit[0, 3], np.float32([0.5, 0.25, 1]))
    np.testing.assert_array_equal(unlit[3, 0], np.float32(sky))
    scene.add_light(fh.DirectionalLight((0, 0, -2), color=(1, 1, 0)))
    lit = fh.render(scene, camera, background=sky, ambient=(0.1, 0.1, 0.1))["color"]
    np.testing.assert_allclose(lit[0, 3], [0.55, 0.275, 0.1], rtol=1e-6)
    normal = fh.render(scene, camera, shade="normal")["color"]
    np.testing.assert_array_equal(normal[0, 3], [0.5, 0.5, 1])


def test_an_own_shader_sees_misses_too_and_is_averaged():
    seen = []

    def shade(hits):
        seen.append(hits.shape)
        fog = np.exp(-np.where(hits.object < 0, 9, hits.z))
        return np.where((hits.object < 0)[..., None], [0, 0, 1.0], fog[..., None])

    frame = fh.render(ball(), small(), shade=shade, channels=("color", "object"), samples=1)
    assert seen == [(12, 16)]
    assert (frame["color"][frame["object"] < 0] == [0, 0, 1]).all()
    np.testing.assert_allclose(frame["color"][6, 8, 0], np.exp(-4), rtol=0.05)
    many = fh.render(ball(), small(), shade=shade, samples=9)["color"]
    assert len(seen) == 10
    border = (many[..., 2] > 0.05) & (many[..., 2] < 0.95)
    assert border.any()
    with pytest.raises(ValueError, match=r"shade must return colours of shape \(12, 16, 3\)"):
        fh.render(ball(), small(), shade=lambda hits: hits.t, samples=1)
    for name, value in {"background": "red", "ambient": (1, 1, 1), "shadows": False}.items():
        with pytest.raises(ValueError, match=f"{name} does nothing with a shade of one's own"):
            fh.render(ball(), small(), shade=shade, **{name: value})


def test_own_shading_sees_the_scene_as_it_was_when_render_began():
    scene = ball()

    def add_once(_done, _total):
        if len(scene.objects) == 1:
            scene.add(fh.Sphere((0, 0, 2), 1))

    frame = fh.render(
        scene,
        small(),
        channels=("color", "object"),
        samples=1,
        progress=add_once,
        shade=lambda hits: np.repeat(hits.object[..., None], 3, -1),
    )
    assert len(scene.objects) == 2
    np.testing.assert_array_equal(frame["color"][..., 0], frame["object"])


def test_own_shading_samples_the_same_points_as_the_library():
    mask = fh.render(
        ball(), small(), shade=lambda hits: (hits.object >= 0)[..., None] * np.ones(3), samples=16
    )
    scene = fh.Scene()
    scene.add(fh.Sphere((0, 0, 0), 1), color=(1, 1, 1))
    same = fh.render(scene, small(), shade="unlit", samples=16, background=(0, 0, 0))
    np.testing.assert_array_equal(mask["color"], same["color"])


@pytest.mark.parametrize("threads", [2, 7])
def test_the_same_picture_for_any_number_of_threads(threads):
    one = fh.render(ball(), small(), samples=4, threads=1)["color"]
    np.testing.assert_array_equal(
        fh.render(ball(), small(), samples=4, threads=threads)["color"], one
    )


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"channels": ("depth",)}, "channels must be among color, t, range, z"),
        ({"channels": "depth"}, "depth is called z, the distance along the camera's aim, or range"),
        ({"channels": "albedo"}, "got 'albedo'$"),
        ({"samples": 0}, "samples must be from 1 to 4294967295"),
        ({"shade": "toon"}, "shade must be one of direct, path, .*, normal, got 'toon'"),
        ({"background": (1, 2)}, "background must be three numbers"),
        ({"threads": 0}, "threads must be from 1 to 1024"),
    ],
)
def test_requests_that_make_no_sense_are_refused_by_name(change, words):
    with pytest.raises(ValueError, match=words):
        fh.render(ball(), small(), **change)


def test_frames_are_saved_whole_and_show_themselves(tmp_path):
    from PIL import Image

    frame = fh.render(ball(), small(), channels=("color", "z", "object"), background=(1, 1, 1))
    frame.save(tmp_path / "out.npz")
    with np.load(tmp_path / "out.npz") as saved:
        assert set(saved) == {"color", "z", "object", "metadata"}
        for name in frame:
            np.testing.assert_array_equal(saved[name], frame[name])
    frame.save(tmp_path / "out.png")
    with Image.open(tmp_path / "out.png") as picture:
        pixels = np.asarray(picture)
    assert pixels.shape == (12, 16, 3)
    assert (pixels[0, 0] == 255).all()
    frame.save(str(tmp_path / "part-{channel}.npy"))
    np.testing.assert_array_equal(np.load(tmp_path / "part-z.npy"), frame["z"])
    assert frame._png().startswith(b"\x89PNG")
    with pytest.raises(ValueError, match=r"known format's extension"):
        frame.save(tmp_path / "out.gif")
    with pytest.raises(fh.FileWriteError):
        frame.save(tmp_path / "none" / "out.png")


@pytest.mark.parametrize(
    ("channels", "name"), [(("z", "t"), "a.png"), (("z", "t"), "a.npy"), (("color", "z"), "a.npy")]
)
def test_a_channel_that_would_go_to_no_file_is_refused_as_by_the_program(channels, name, tmp_path):
    frame = fh.render(ball(), small(), channels=channels, samples=1)
    with pytest.raises(ValueError, match=r"the channel z goes to no file: .*put {channel} into"):
        frame.save(tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_pictures_too_large_for_memory_are_a_memory_error():
    camera = fh.Camera(**{**CAMERA, "rows": 10**7, "columns": 10**7})
    with pytest.raises(MemoryError):
        camera.rays()
    with pytest.raises(MemoryError):
        ball().shoot(camera)
    with pytest.raises(MemoryError):
        fh.render(ball(), camera)


def test_a_camera_looks_through_one_side():
    scene = fh.Scene()
    room = scene.add(fh.Box((-2, -2, 0), (2, 2, 3)), name="room")
    scene.add(fh.Sphere((0, 0, 1), 0.5), name="ball")
    scene.add_light(fh.DirectionalLight((0, 0, -1)))
    camera = fh.Camera.framing(scene, rows=40, columns=60)
    channels = ["t", "object", "normal", "front", "color"]
    inside = fh.render(scene, camera, channels=channels, cull="front", samples=1)
    hits = scene.shoot(camera, cull="front")
    for name in ("t", "object", "normal", "front"):
        assert np.array_equal(inside[name], getattr(hits, name), equal_nan=True)
    assert (inside["object"] == 1).any()
    assert not inside["front"].any()
    outside = fh.render(scene, camera, channels=channels, cull="back", samples=1)
    assert np.array_equal(outside["t"], scene.shoot(camera, cull="back").t)
    assert not (outside["object"] == 1).any()
    part = fh.render(scene, camera, channels=channels, cull="front", region=np.s_[10:30, 5:50])
    whole = fh.render(scene, camera, channels=channels, cull="front")
    for name in channels:
        assert np.array_equal(part[name], whole[name][10:30, 5:50], equal_nan=True)
    lonely = fh.render(scene, camera, channels=channels, objects="ball")
    scene.hide(room)
    hidden = fh.render(scene, camera, channels=channels)
    for name in channels:
        assert np.array_equal(lonely[name], hidden[name], equal_nan=True)
    with pytest.raises(ValueError, match="cull must be"):
        fh.render(scene, camera, cull="side")


def test_own_shaders_see_what_the_camera_sees():
    scene = fh.Scene()
    scene.add(fh.Box((-2, -2, 0), (2, 2, 3)))
    scene.add(fh.Sphere((0, 0, 1), 0.5), name="ball")
    camera = fh.Camera.framing(scene, rows=40, columns=60)

    def is_ball(hits: fh.Hits) -> np.ndarray:
        return np.repeat((hits.object == 1)[..., None], 3, -1)

    for samples in (1, 3):
        through = fh.render(scene, camera, shade=is_ball, cull="front", samples=samples)
        assert 0 < through["color"].mean() < 0.5
        alone = fh.render(scene, camera, shade=is_ball, objects="ball", samples=samples)
        back = fh.render(
            scene, camera, shade=is_ball, objects="ball", cull="front", samples=samples
        )
        assert np.array_equal(alone["color"], back["color"])
        assert np.array_equal(alone["color"], through["color"])
