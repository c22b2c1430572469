"""Calibrated cameras against OpenCV, COLMAP and the papers' formulas."""

import json
import math

import firsthit as fh
import mpmath
import numpy as np
import pytest
from support import cases

cv2 = pytest.importorskip("cv2")

ROWS, COLUMNS = 96, 128


def pixel_centres(camera):
    """Return what `project` should say of every pixel's ray."""
    v, u = np.mgrid[: camera.rows, : camera.columns] + 0.5
    return np.stack([u, v], axis=-1)


def some_points(camera, count, rng):
    """Return pixels, and points of the world on their rays; of pixels that see something."""
    _, directions = camera.rays()
    rows, columns = np.nonzero(np.isfinite(directions[..., 0]))
    chosen = rng.integers(0, len(rows), count)
    # The corners and the rows at the fold, if there is one, are where fixed iterations fail.
    chosen[:4] = 0, len(rows) - 1, rows.argmax(), columns.argmax()
    rows, columns = rows[chosen], columns[chosen]
    depth = rng.uniform(0.5, 20.0, count)[:, None]
    return np.stack([columns, rows], axis=-1), camera.position + depth * directions[rows, columns]


def random_pose(rng):
    return rng.normal(size=3) * rng.uniform(0.1, 3.0), rng.normal(size=3) * 3.0


def random_k(rng):
    fx = rng.uniform(50.0, 180.0)
    return np.array(
        [
            [fx, 0.0, COLUMNS / 2 + rng.normal() * 6],
            [0.0, fx * rng.uniform(0.9, 1.1), ROWS / 2 + rng.normal() * 6],
            [0.0, 0.0, 1.0],
        ]
    )


def random_distortion(rng, count):
    d = np.zeros(14)
    d[:2] = rng.normal(size=2) * (0.25, 0.1)
    d[2:4] = rng.normal(size=2) * 0.002
    d[4] = rng.normal() * 0.03
    if count >= 8:
        d[5:8] = rng.normal(size=3) * (0.2, 0.08, 0.02)
    if count >= 12:
        d[8:12] = rng.normal(size=4) * 0.003
    if count == 14:
        d[12:] = rng.normal(size=2) * 0.03
    return d[:count]


@pytest.mark.parametrize("count", [0, 4, 5, 8, 12, 14])
def test_rays_of_opencv_cameras_project_back_to_their_pixels(count):
    rng = np.random.default_rng(count)
    for _ in range(cases(170)):
        k, distortion = random_k(rng), random_distortion(rng, count)
        rvec, tvec = random_pose(rng)
        camera = fh.Camera.from_opencv(k, distortion, rvec, tvec, rows=ROWS, columns=COLUMNS)
        pixels, points = some_points(camera, 40, rng)
        expected, _ = cv2.projectPoints(points, rvec, tvec, k, distortion if count else None)
        assert np.abs(expected[:, 0] - pixels).max() < 1e-6
        # Pixel coordinates begin half a pixel earlier here.
        assert np.abs(camera.project(points) - pixels - 0.5).max() < 1e-6


def test_rays_of_opencv_fisheyes_project_back_to_their_pixels():
    rng = np.random.default_rng(7)
    for _ in range(cases(1000)):
        k, d = random_k(rng), rng.normal(size=4) * (0.05, 0.02, 0.01, 0.003)
        k[:2, :2] *= 0.5
        rvec, tvec = random_pose(rng)
        camera = fh.Camera.from_opencv(
            k, d, rvec, tvec, rows=ROWS, columns=COLUMNS, model="fisheye"
        )
        pixels, points = some_points(camera, 40, rng)
        in_camera = (points - camera.position) @ camera.aim
        # OpenCV divides by z, and so knows no points behind.
        in_front = in_camera > 1e-3
        expected, _ = cv2.fisheye.projectPoints(points[in_front][:, None], rvec, tvec, k, d)
        assert np.abs(expected[:, 0] - pixels[in_front]).max() < 1e-6
        assert np.abs(camera.project(points) - pixels - 0.5).max() < 1e-6


def test_what_goes_to_opencv_comes_back():
    rng = np.random.default_rng(3)
    for count in (0, 5, 14):
        k, distortion = random_k(rng), random_distortion(rng, count)
        rvec, tvec = rng.uniform(-1.5, 1.5, 3), rng.normal(size=3)
        camera = fh.Camera.from_opencv(k, distortion, rvec, tvec, rows=ROWS, columns=COLUMNS)
        out = camera.to_opencv()
        assert np.allclose(out.K, k, rtol=1e-14)
        assert np.allclose(out.rvec, rvec, atol=1e-13)
        assert np.allclose(out.tvec, tvec, atol=1e-13)
        assert np.allclose(out.distortion[:count], distortion, rtol=0, atol=0)
        again = fh.Camera.from_opencv(
            out.K, out.distortion, out.rvec, out.tvec, rows=ROWS, columns=COLUMNS
        )
        assert np.allclose(again.rays()[1], camera.rays()[1], atol=1e-12, equal_nan=True)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-3, 1.0, 3.0, math.pi - 1e-9, math.pi])
def test_rotation_vectors_are_those_of_rodrigues(angle):
    axis = np.array([0.6, -0.48, 0.64])
    camera = fh.Camera.from_opencv([500, 500, 320, 240], rvec=angle * axis, rows=4, columns=4)
    expected, _ = cv2.Rodrigues(angle * axis)
    out = camera.to_opencv()
    assert np.abs(out.R - expected).max() < 1e-14
    assert np.abs(cv2.Rodrigues(out.rvec)[0] - expected).max() < 1e-14


def test_pixels_beyond_the_fold_see_nothing_and_say_so():
    # r (1 - 0.6 r^2) turns back at r^2 = 1 / 1.8.
    camera = fh.Camera.from_opencv([200, 200, 319.5, 239.5], (-0.6, 0, 0, 0), rows=480, columns=640)
    fold = 200 * math.sqrt(1 / 1.8) * (1 - 0.6 / 1.8)
    radius = np.linalg.norm(pixel_centres(camera) - (320, 240), axis=-1)
    scene = fh.Scene()
    scene.add(fh.Sphere(center=(0, 0, 0), radius=50))
    frame = fh.render(scene, camera, channels=("valid", "z", "object"))
    assert np.array_equal(frame["valid"], radius < fold)
    assert np.array_equal(frame["object"] >= 0, radius < fold)
    assert np.all(np.isinf(frame["z"]) == ~frame["valid"])


# The papers' formulas, in 40 digits, from a direction to the normalised image.


def double_sphere(x, y, z, p):
    d1 = mpmath.sqrt(x**2 + y**2 + z**2)
    d2 = mpmath.sqrt(x**2 + y**2 + (p["xi"] * d1 + z) ** 2)
    below = p["alpha"] * d2 + (1 - p["alpha"]) * (p["xi"] * d1 + z)
    return x / below, y / below


def eucm(x, y, z, p):
    d = mpmath.sqrt(p["beta"] * (x**2 + y**2) + z**2)
    below = p["alpha"] * d + (1 - p["alpha"]) * z
    return x / below, y / below


def ucm(x, y, z, p):
    return eucm(x, y, z, {"beta": mpmath.mpf(1), **p})


def mei(x, y, z, p):
    length = mpmath.sqrt(x**2 + y**2 + z**2)
    x, y = x / (z + p["xi"] * length), y / (z + p["xi"] * length)
    q = x**2 + y**2
    radial = 1 + p["k1"] * q + p["k2"] * q**2
    return (
        x * radial + 2 * p["p1"] * x * y + p["p2"] * (q + 2 * x**2),
        y * radial + p["p1"] * (q + 2 * y**2) + 2 * p["p2"] * x * y,
    )


def of_angle(radius):
    def model(x, y, z, p):
        off = mpmath.hypot(x, y)
        share = radius(mpmath.atan2(off, z), p) / off
        return x * share, y * share

    return model


def thin_prism_fisheye(x, y, z, p):
    off = mpmath.hypot(x, y)
    angle = mpmath.atan2(off, z)
    x, y, q = x * angle / off, y * angle / off, angle**2
    radial = 1 + p["k1"] * q + p["k2"] * q**2 + p["k3"] * q**3 + p["k4"] * q**4
    return (
        x * radial + 2 * p["p1"] * x * y + p["p2"] * (q + 2 * x**2) + p["sx1"] * q,
        y * radial + p["p1"] * (q + 2 * y**2) + 2 * p["p2"] * x * y + p["sy1"] * q,
    )


def rad_tan_thin_prism_fisheye(x, y, z, p):
    off = mpmath.hypot(x, y)
    angle = mpmath.atan2(off, z)
    radius = angle * (1 + sum(p[f"k{k}"] * angle ** (2 * k + 2) for k in range(6)))
    x, y, q = x * radius / off, y * radius / off, radius**2
    across = p["p0"] * (q + 2 * x**2) + 2 * p["p1"] * x * y
    down = p["p1"] * (q + 2 * y**2) + 2 * p["p0"] * x * y
    return (
        x + across + p["s0"] * q + p["s1"] * q**2,
        y + down + p["s2"] * q + p["s3"] * q**2,
    )


THIN_PRISM = {
    "k1": -0.04,
    "k2": 0.01,
    "p1": 0.002,
    "p2": -0.003,
    "k3": -0.002,
    "k4": 0.0004,
    "sx1": 0.003,
    "sy1": -0.002,
}
RAD_TAN_THIN_PRISM = {
    "k0": -0.04,
    "k1": 0.02,
    "k2": -0.01,
    "k3": 0.003,
    "k4": -0.0005,
    "k5": 0.00003,
    "p0": 0.002,
    "p1": -0.001,
    "s0": -0.002,
    "s1": 0.0003,
    "s2": 0.001,
    "s3": -0.0002,
}
MODELS = {
    "double_sphere": (double_sphere, {"xi": -0.2, "alpha": 0.59}),
    "eucm": (eucm, {"alpha": 0.62, "beta": 1.1}),
    "ucm": (ucm, {"alpha": 0.65}),
    "mei": (mei, {"xi": 1.2, "k1": -0.1, "k2": 0.02, "p1": 0.001, "p2": -0.0005}),
    "kannala_brandt": (
        of_angle(lambda a, p: sum(p[f"k{k}"] * a ** (2 * k - 1) for k in range(1, 6))),
        {"k1": 0.99, "k2": -0.02, "k3": 0.003, "k4": -0.001, "k5": 0.0001},
    ),
    "fov": (
        of_angle(
            lambda a, p: mpmath.atan(2 * mpmath.tan(p["omega"] / 2) * mpmath.tan(a)) / p["omega"]
        ),
        {"omega": 0.93},
    ),
    "thin_prism_fisheye": (thin_prism_fisheye, THIN_PRISM),
    "rad_tan_thin_prism_fisheye": (rad_tan_thin_prism_fisheye, RAD_TAN_THIN_PRISM),
    "equidistant": (of_angle(lambda a, _: a), {"fov": 220}),
    "equisolid": (of_angle(lambda a, _: 2 * mpmath.sin(a / 2)), {"fov": 220}),
    "stereographic": (of_angle(lambda a, _: 2 * mpmath.tan(a / 2)), {"fov": 220}),
    "orthographic_fisheye": (of_angle(lambda a, _: mpmath.sin(a)), {"fov": 178}),
}


@pytest.mark.parametrize("name", MODELS)
def test_models_are_those_of_their_papers(name):
    formula, parameters = MODELS[name]
    camera = fh.Camera.from_intrinsics(
        [[42, 0.5, 65], [0, 41, 47], [0, 0, 1]],
        rows=ROWS,
        columns=COLUMNS,
        convention="colmap",
        projection=name,
        parameters=parameters,
    )
    _, directions = camera.rays()
    rng = np.random.default_rng(1)
    rows, columns = np.nonzero(np.isfinite(directions[..., 0]))
    assert len(rows) > 1000
    with mpmath.workdps(40):
        exact = {key: mpmath.mpf(value) for key, value in parameters.items()}
        for index in rng.integers(0, len(rows), 60):
            row, column = rows[index], columns[index]
            x, y = formula(*map(mpmath.mpf, directions[row, column].tolist()), exact)
            u, v = 42 * x + mpmath.mpf(0.5) * y + 65, 41 * y + 47
            assert abs(u - column - 0.5) < 1e-9
            assert abs(v - row - 0.5) < 1e-9


def test_solid_angles_of_a_panorama_are_the_whole_sphere():
    camera = fh.Camera.equirectangular((0, 0, 0), (0, 1, 0), (0, 0, 1), rows=180, columns=360)
    _, directions = camera.rays()
    latitude = np.arcsin(directions[:, 0, 2])
    # Exactly: the difference of the sines at a row's two edges.
    half = math.pi / 360
    angles = (2 * math.pi / 360) * (np.sin(latitude + half) - np.sin(latitude - half))
    assert abs(math.fsum(angles.tolist() * 360) - 4 * math.pi) < 1e-12


def test_colmap_files_are_read_and_written(tmp_path):
    pycolmap = pytest.importorskip("pycolmap")
    rng = np.random.default_rng(5)
    sizes = {
        "SIMPLE_PINHOLE": (400.0, 310.0, 250.0),
        "PINHOLE": (400.0, 410.0, 310.0, 250.0),
        "SIMPLE_RADIAL": (400.0, 310.0, 250.0, -0.1),
        "RADIAL": (400.0, 310.0, 250.0, -0.1, 0.02),
        "OPENCV": (400.0, 410.0, 310.0, 250.0, -0.1, 0.02, 0.001, -0.002),
        "OPENCV_FISHEYE": (300.0, 310.0, 310.0, 250.0, -0.03, 0.01, -0.004, 0.001),
        "FULL_OPENCV": (400.0, 410.0, 310.0, 250.0, -0.1, 0.02, 0.001, 0.002, 0.01, 0.1, 0.02, 0),
        "SIMPLE_RADIAL_FISHEYE": (300.0, 310.0, 250.0, -0.03),
        "RADIAL_FISHEYE": (300.0, 310.0, 250.0, -0.03, 0.01),
        "FOV": (300.0, 310.0, 310.0, 250.0, 0.9),
        "THIN_PRISM_FISHEYE": (300.0, 310.0, 310.0, 250.0, *THIN_PRISM.values()),
        "RAD_TAN_THIN_PRISM_FISHEYE": (300.0, 310.0, 310.0, 250.0, *RAD_TAN_THIN_PRISM.values()),
        "SIMPLE_FISHEYE": (300.0, 310.0, 250.0),
        "FISHEYE": (300.0, 310.0, 310.0, 250.0),
        "EUCM": (300.0, 310.0, 310.0, 250.0, 0.6, 1.1),
    }
    reconstruction = pycolmap.Reconstruction()
    for number, (model, params) in enumerate(sizes.items(), 1):
        reconstruction.add_camera_with_trivial_rig(
            pycolmap.Camera(
                camera_id=number, model=model, width=COLUMNS, height=ROWS, params=list(params)
            )
        )
        q = rng.normal(size=4)
        rotation = pycolmap.Rotation3d(q / np.linalg.norm(q))
        image = pycolmap.Image(name=f"{model.lower()}.png", camera_id=number, image_id=number)
        reconstruction.add_image_with_trivial_frame(
            image, pycolmap.Rigid3d(rotation, rng.normal(size=3))
        )
    reconstruction.write_text(str(tmp_path))
    reconstruction.write_binary(str(tmp_path))
    for suffix in ("txt", "bin"):
        files = tmp_path / f"cameras.{suffix}", tmp_path / f"images.{suffix}"
        read = fh.Camera.from_colmap(*files)
        assert len(read) == len(sizes)
        for number, model in enumerate(sizes, 1):
            camera = read[f"{model.lower()}.png"]
            pixels, points = some_points(camera, 50, rng)
            pose = reconstruction.images[number].cam_from_world()
            seen = np.array([pose * point for point in points])
            expected = reconstruction.cameras[number].img_from_cam(seen)
            assert np.abs(np.array(expected) - pixels - 0.5).max() < 1e-6
            lines = camera.to_colmap()
            # Models of one focal length come back as those of two.
            (tmp_path / "c.txt").write_text(lines.camera_line() + "\n")
            (tmp_path / "i.txt").write_text(lines.image_lines("a b.png") + "\n")
            again = fh.Camera.from_colmap(tmp_path / "c.txt", tmp_path / "i.txt")["a b.png"]
            assert np.allclose(again.project(points), camera.project(points), atol=1e-8)


@pytest.mark.parametrize(
    ("model", "projection", "names", "sizes"),
    [
        ("FOV", "fov", "omega", [0.6]),
        (
            "THIN_PRISM_FISHEYE",
            "thin_prism_fisheye",
            "k1 k2 p1 p2 k3 k4 sx1 sy1",
            [0.05, 0.02, 0.01, 0.01, 0.005, 0.001, 0.01, 0.01],
        ),
        (
            "RAD_TAN_THIN_PRISM_FISHEYE",
            "rad_tan_thin_prism_fisheye",
            "k0 k1 k2 k3 k4 k5 p0 p1 s0 s1 s2 s3",
            [0.05, 0.02, 0.01, 0.003, 0.001, 0.0003, 0.01, 0.01, 0.01, 0.003, 0.01, 0.003],
        ),
    ],
)
def test_rays_of_colmap_cameras_project_back_to_their_pixels(model, projection, names, sizes):
    pycolmap = pytest.importorskip("pycolmap")
    rng = np.random.default_rng(len(sizes))
    worst, count = 0.0, 0
    for _ in range(200):
        k = random_k(rng)
        numbers = rng.normal(size=len(sizes)) * sizes
        if model == "FOV":
            # Below 0.01 COLMAP has a series, with its terms of the second order in the wrong sign.
            numbers += np.copysign(0.02, numbers)
        camera = fh.Camera.from_intrinsics(
            k,
            rows=ROWS,
            columns=COLUMNS,
            convention="colmap",
            projection=projection,
            parameters=dict(zip(names.split(), numbers, strict=True)),
        )
        theirs = pycolmap.Camera(
            model=model,
            width=COLUMNS,
            height=ROWS,
            params=[k[0, 0], k[1, 1], k[0, 2], k[1, 2], *numbers],
        )
        pixels, points = some_points(camera, 60, rng)
        # COLMAP sees nothing behind the camera.
        in_front = points[:, 2] > 1e-3
        expected = np.array(theirs.img_from_cam(points[in_front]))
        worst = max(worst, np.abs(expected - pixels[in_front] - 0.5).max())
        count += in_front.sum()
        assert np.abs(camera.project(points) - pixels - 0.5).max() < 1e-9
    assert count > 10_000
    # Near the middle COLMAP's FOV is a series too.
    assert worst < (1e-6 if model == "FOV" else 1e-9)


@pytest.mark.parametrize(
    ("name", "content", "what"),
    [
        ("cameras.txt", "1 PINHOLE 640 480 1 2 3\n", "txt:1: PINHOLE must have 4 parameters"),
        ("cameras.txt", "1 DIVISION 640 480 1 2 3 4\n", "DIVISION must have 5 parameters"),
        ("cameras.txt", "1 PINHOLE 640 480 1 2 3 x\n", "expected a number, got 'x'"),
        ("cameras.txt", "1 NOTHING 640 480\n", "got 'NOTHING'"),
        ("cameras.txt", b"\xff\xfe", "UTF-8"),
        ("cameras.bin", b"\x01", "the file is cut off"),
        ("cameras.bin", b"\xff" * 8, "entries"),
        ("images.txt", "1 0 0 0 0 0 0 0 1 a.png\n\n", "txt:1: a pose must be"),
        (
            "images.txt",
            "1 1 0 0 0 0 0 0 1 a.png\n\n" * 2,
            "txt:3: image 'a.png': the name is there",
        ),
        ("cameras.txt", "1 PINHOLE 640 480 1 2 3 nan\n", "parameters must be finite"),
        ("cameras.txt", "1 PINHOLE 640 480 1 2 3 4\n" * 2, "txt:2: camera 1 is there twice"),
        ("images.txt", "1 1 0 0 0 0 0 0 7 a.png\n\n", "there is no camera 7"),
        ("images.bin", b"\x01" + b"\0" * 7, "1 entries, and is too short"),
    ],
)
def test_colmap_files_that_are_wrong_are_refused(tmp_path, name, content, what):
    files = {"cameras": tmp_path / "cameras.txt", "images": tmp_path / "images.txt"}
    files["cameras"].write_text("1 PINHOLE 640 480 1 2 3 4\n")
    files["images"].write_text("")
    wrong = tmp_path / name
    wrong.write_bytes(content.encode() if isinstance(content, str) else content)
    files[name.partition(".")[0]] = wrong
    with pytest.raises(fh.FileFormatError, match=what):
        fh.Camera.from_colmap(**files)


CONVENTIONS = ["opencv", "opengl", "colmap", "blender", "ros", "pytorch3d", "nerfstudio", "gltf"]


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_every_convention_there_and_back(convention):
    rng = np.random.default_rng(11)
    k = [[500.0, 1.0, 301.0], [0.0, 490.0, 233.0], [0.0, 0.0, 1.0]]
    # Independently: the rows of the camera's axes in right, up, backwards.
    axes = {"opencv": (1, -1, -1), "colmap": (1, -1, -1), "ros": (1, -1, -1)}
    signs = np.diag(axes.get(convention, (-1, 1, -1) if convention == "pytorch3d" else (1, 1, 1)))
    first = 0.0 if convention in ("opencv", "ros") else 0.5
    rotation, _ = cv2.Rodrigues(rng.normal(size=3))
    position = rng.normal(size=3)
    world = np.eye(4)
    world[:3, :3], world[:3, 3] = rotation @ signs, position
    if convention in ("opencv", "colmap"):
        pose = np.linalg.inv(world)
    elif convention == "pytorch3d":
        pose = np.linalg.inv(world).T
    else:
        pose = world
    camera = fh.Camera.from_intrinsics(
        k, rows=ROWS, columns=COLUMNS, pose=pose, convention=convention
    )
    assert np.allclose(camera.position, position, atol=1e-13)
    assert np.allclose(camera.right, rotation[:, 0], atol=1e-13)
    assert np.allclose(camera.upwards, rotation[:, 1], atol=1e-13)
    assert np.allclose(camera.aim, -rotation[:, 2], atol=1e-13)
    assert np.allclose(camera.project(position - rotation[:, 2]), (301.5 - first, 233.5 - first))
    back_k, back_pose = camera.to_convention(convention)
    assert np.allclose(back_k, k, atol=1e-10)
    assert np.allclose(back_pose, pose, atol=1e-12)


def test_projection_matrices_are_read():
    rng = np.random.default_rng(2)
    for _ in range(50):
        k = random_k(rng)
        k[0, 1] = rng.normal()
        rvec, tvec = random_pose(rng)
        p = k @ np.column_stack([cv2.Rodrigues(rvec)[0], tvec]) * rng.normal()
        camera = fh.Camera.from_projection_matrix(p, rows=ROWS, columns=COLUMNS)
        pixels, points = some_points(camera, 20, rng)
        seen = np.column_stack([points, np.ones(20)]) @ p.T
        assert np.abs(seen[:, :2] / seen[:, 2:] - pixels).max() < 1e-6
        projection, view = fh.Camera.from_intrinsics(
            k,
            rows=ROWS,
            columns=COLUMNS,
            convention="colmap",
            pose=camera.to_convention("colmap")[1],
        ).to_opengl(0.1, 100.0)
        clip = np.column_stack([points, np.ones(20)]) @ (projection @ view).T
        ndc = clip[:, :2] / clip[:, 3:]
        u, v = (ndc[:, 0] + 1) / 2 * COLUMNS, (1 - ndc[:, 1]) / 2 * ROWS
        again = fh.Camera.from_projection_matrix(projection, view=view, rows=ROWS, columns=COLUMNS)
        assert np.allclose(np.stack([u, v], -1), again.project(points), atol=1e-7)
        # An OpenGL matrix of homogeneous coordinates says the same at any scale.
        for scale in (2.0**-900, 2.0**900):
            scaled = projection * scale
            same = fh.Camera.from_projection_matrix(scaled, view=view, rows=ROWS, columns=COLUMNS)
            assert same == again
    parallel = [[0.5, 0, 0, 0.25], [0, 1, 0, 0], [0, 0, -0.1, 0], [0, 0, 0, 1]]
    camera = fh.Camera.from_projection_matrix(parallel, rows=100, columns=200)
    # x_ndc = 0.5 x + 0.25 is zero at -0.5.
    assert np.allclose(camera.project((-0.5, 0, -3)), (100, 50))
    assert np.allclose(camera.project((1.5, 1, -3)), (200, 0))
    scaled = np.array(parallel) * 2.0**-800
    assert fh.Camera.from_projection_matrix(scaled, rows=100, columns=200) == camera
    with pytest.raises(ValueError, match="positive first and second diagonal"):
        fh.Camera.from_projection_matrix(-np.array(projection), rows=100, columns=200)


def test_a_projection_matrix_of_any_scale_is_the_same_camera():
    rng = np.random.default_rng(8)
    size = {"rows": ROWS, "columns": COLUMNS}
    for _ in range(20):
        rvec, tvec = random_pose(rng)
        p = random_k(rng) @ np.column_stack([cv2.Rodrigues(rvec)[0], tvec])
        camera = fh.Camera.from_projection_matrix(p, **size)
        # Powers of two change no digit of the matrix, and none of the camera.
        for power in (-900, -340, -1, 340, 900):
            assert fh.Camera.from_projection_matrix(p * 2.0**power, **size) == camera
        _, points = some_points(camera, 20, rng)
        for scale in (1e-300, 1e300, -1e-290):
            same = fh.Camera.from_projection_matrix(p * scale, **size)
            assert np.allclose(same.project(points), camera.project(points), atol=1e-8)


def test_distortion_coefficients_are_a_row_or_a_column():
    k, five = [500, 500, 320, 240], [0.1, -0.2, 0.001, 0.002, 0.03]
    size = {"rows": ROWS, "columns": COLUMNS, "tvec": (0, 0, 0)}
    camera = fh.Camera.from_opencv(k, five, **size)
    for shape in ((1, 5), (5, 1)):
        assert fh.Camera.from_opencv(k, np.reshape(five, shape), **size) == camera
    for given in (np.zeros((4, 2)), np.zeros((2, 4)), np.zeros((2, 2)), np.zeros((1, 1, 5))):
        with pytest.raises(ValueError, match="distortion must be one row or column, got the shape"):
            fh.Camera.from_opencv(k, given, **size)
    with pytest.raises(ValueError, match="distortion must have 0, 4, 5, 8, 12 or 14 numbers"):
        fh.Camera.from_opencv(k, 0.1, **size)


@pytest.mark.parametrize("suffix", ["exr", "npz", "npy", "png"])
def test_an_output_says_which_camera_made_it(tmp_path, suffix):
    scene = fh.Scene()
    scene.add(fh.Sphere(center=(0, 0, 3), radius=1))
    cameras = [
        fh.Camera.from_opencv(
            [30, 31, 20, 15], (-0.2, 0.05, 0.001, 0), (0.1, 0.2, 0.3), rows=30, columns=40
        ),
        fh.Camera.from_intrinsics([30, 30, 9, 7], rows=30, columns=40, convention="ros"),
        fh.Camera.fisheye((0, 0, 0), (0, 0, 1), (0, 1, 0), 200, rows=30, columns=40),
        fh.Camera.framing(scene, rows=30, columns=40),
    ]
    for camera in cameras:
        path = tmp_path / f"z.{suffix}"
        fh.render(scene, camera, channels="z").save(path)
        again = fh.Camera.load(path)
        assert again == camera
        for own, other in zip(again.rays(), camera.rays(), strict=True):
            assert np.array_equal(own, other, equal_nan=True)
    fh.Frame((2, 2), {"attribute:a": np.zeros((2, 2))}).save(tmp_path / "none.npz")
    with pytest.raises(ValueError, match="does not say which camera"):
        fh.Camera.load(tmp_path / "none.npz")


@pytest.mark.parametrize("kind", ["perspective", "opencv"])
def test_a_skew_that_opencv_leaves_out_is_refused(kind):
    k = np.array([[100.0, 5, 32], [0, 100, 24], [0, 0, 1]])
    size = {"rows": 48, "columns": 64}
    # What OpenCV says is the same with and without it.
    points, zero = np.array([[[0.1, 0.2, 1.0]]]), np.zeros(3)
    seen = [
        cv2.projectPoints(points, zero, zero, each, np.zeros(4))[0] for each in (k, k * (k != 5))
    ]
    assert np.array_equal(*seen)
    with pytest.raises(ValueError, match="takes no skew in K, got 5"):
        fh.Camera.from_opencv(k, **size)
    camera = fh.Camera.from_intrinsics(k, projection=kind, convention="opencv", **size)
    with pytest.raises(ValueError, match="takes no skew in K, got 5"):
        camera.to_opencv()


def test_the_skew_of_a_fisheye_is_opencvs_alpha_times_fx():
    k = np.array([[100.0, 5, 32], [0, 101, 24], [0, 0, 1]])
    d = np.array([0.02, -0.005, 0.001, 0.0002])
    points, zero = np.random.default_rng(5).uniform(-1, 1, (20, 3)), np.zeros(3)
    points[:, 2] += 2
    flat, _ = cv2.fisheye.projectPoints(points[None], zero, zero, k, d, alpha=k[0, 1] / k[0, 0])
    camera = fh.Camera.from_opencv(k, d, rows=48, columns=64, model="fisheye")
    np.testing.assert_allclose(camera.project(points), flat[0] + 0.5, atol=1e-9)
    assert np.allclose(camera.to_opencv().K, k, atol=1e-13)


def test_rvec_may_be_a_matrix():
    turned, _ = cv2.Rodrigues(np.array([0.3, -0.5, 0.2]))
    given = {"K": (60, 60, 32, 24), "rows": 48, "columns": 64, "tvec": (1, 2, 3)}
    assert fh.Camera.from_opencv(rvec=turned, **given) == fh.Camera.from_opencv(R=turned, **given)


def test_poses_of_three_decimals_become_the_nearest_rotation_with_a_warning():
    rng, warned = np.random.default_rng(8), 0
    for _ in range(50):
        turned, _ = cv2.Rodrigues(rng.normal(size=3))
        pose = np.column_stack([turned.round(3), (1, 2, 3)])
        given = {"K": (60, 60, 32, 24), "rows": 48, "columns": 64, "convention": "blender"}
        if np.abs(pose[:, :3].T @ pose[:, :3] - np.eye(3)).max() < 1e-4:
            continue
        warned += 1
        with pytest.warns(fh.FirsthitWarning, match="rotation is rounded"):
            camera = fh.Camera.from_intrinsics(pose=pose, **given)
        u, _, v = np.linalg.svd(pose[:, :3])
        np.testing.assert_allclose(camera.to_convention("blender")[1][:3, :3], u @ v, atol=1e-13)
        with pytest.warns(fh.FirsthitWarning, match="rotation is rounded"):
            camera.moved(pose)
    assert warned > 30


def test_a_refused_pose_says_how_far_it_is_off_and_how_far_it_may_be(tmp_path):
    given = {"K": (60, 60, 32, 24), "rows": 48, "columns": 64, "convention": "blender"}
    camera = fh.Camera.from_intrinsics(**given)
    rig = fh.Rig({"a": camera})
    off = r"1\.0e-2 off the nearest rotation, and what is rounded by up to 1e-3 is mended"
    for scales, why in (
        ((1.01, 1, 1), off),
        ((1, 1, -1), "it mirrors"),
        ((1, 0, 1), "it flattens space"),
    ):
        pose = np.diag([*scales, 1.0])
        model = {"fl_x": 60, "fl_y": 60, "cx": 32, "cy": 24, "w": 64, "h": 48}
        model["frames"] = [{"file_path": "a.png", "transform_matrix": pose.tolist()}]
        (tmp_path / "transforms.json").write_text(json.dumps(model))
        for refused in (
            lambda pose=pose: fh.Camera.from_intrinsics(pose=pose, **given),
            lambda pose=pose: camera.moved(pose),
            lambda pose=pose: rig.at(pose),
            lambda: fh.Camera.from_nerfstudio(tmp_path / "transforms.json"),
        ):
            with pytest.raises(ValueError, match=f"without a scale or a mirror, got .*{why}"):
                refused()
    off = "products of its columns are off by 2.01e-2, at most 0.0001 is expected"
    with pytest.raises(ValueError, match=f"matrices: at index 1: .*{off}"):
        fh.Trajectory.from_matrices([0, 1], [np.eye(4), np.diag([1.01, 1, 1, 1])], body="camera")


def test_an_opencv_fisheye_sees_nothing_beyond_its_field_of_view():
    given = {"K": (30, 30, 32, 24), "rows": 48, "columns": 64, "convention": "colmap"}
    parameters = {"k1": 0.01, "fov": 120}
    camera = fh.Camera.from_intrinsics(projection="opencv_fisheye", parameters=parameters, **given)
    assert camera.parameters["fov"] == 120
    angles = np.radians([59.9, 60.1])
    seen = camera.project(np.stack([np.sin(angles), 0 * angles, np.cos(angles)], axis=-1))
    assert np.isfinite(seen[:, 0]).tolist() == [True, False]
    # Without a distortion it is an equidistant one.
    others = (0, 0, 0), (0, 0, -1), (0, 1, 0), 100, 48, 64
    both = [fh.Camera.fisheye(*others, kind) for kind in ("opencv_fisheye", "equidistant")]
    rays = [camera.rays()[1] for camera in both]
    np.testing.assert_allclose(*rays, atol=1e-14)
    with pytest.raises(ValueError, match="COLMAP has a model for, got opencv_fisheye with fov"):
        both[0].to_colmap()


@pytest.mark.parametrize(
    ("layout", "shape"),
    [("row", (4, 24)), ("column", (24, 4)), ("two rows", (8, 12)), ("cross", (12, 16))],
)
def test_a_cube_map_sees_every_direction(layout, shape):
    camera = fh.Camera.cube_map((1, 2, 3), (0, 1, 0), (0, 0, 1), 4, layout)
    assert camera.shape == shape
    directions = camera.rays()[1]
    seen = np.isfinite(directions[..., 0])
    assert seen.sum() == 6 * 16
    assert np.abs(directions[seen].sum(axis=0)).max() < 1e-12
    toward = np.random.default_rng(1).normal(size=(50, 3))
    assert np.isfinite(camera.project(camera.position + toward)).all()
    with pytest.raises(ValueError, match="layout must be one of row, column, two rows, cross"):
        fh.Camera.cube_map((0, 0, 0), (0, 1, 0), (0, 0, 1), 4, "dice")


def test_cropped_and_binned_cameras_see_the_same():
    camera = fh.Camera.from_opencv([300, 310, 322, 238], (-0.1, 0.02, 0, 0), rows=480, columns=640)
    part = camera.crop(np.s_[100:300, 50:450])
    assert np.allclose(part.rays()[1], camera.rays()[1][100:300, 50:450], atol=1e-14)
    half = camera.resize(240, 320)
    assert np.allclose(half.intrinsic_matrix[:2], camera.intrinsic_matrix[:2] / 2)
    point = (0.3, 0.2, 2.0)
    assert np.allclose(half.project(point) * 2, camera.project(point))
    for wrong in [(0, 0), (5, 481), (-1, 5)]:
        with pytest.raises(ValueError, match="rows must be a part"):
            camera.crop(wrong, (0, 5))
    with pytest.raises(ValueError, match="steps"):
        camera.crop(slice(0, 10, 2), slice(0, 10))


def test_a_shifted_and_tilted_viewplane_is_the_chapters():
    camera = fh.Camera(
        (1, 2, 3),
        (0, 0, -1),
        (0, 1, 0),
        2.0,
        4.0,
        3.0,
        30,
        40,
        parameters={"shift_x": 0.5, "shift_y": -0.25, "tilt_x": 10.0},
    )
    origins, directions = camera.rays()
    # Rays start on the viewplane: all starts lie in one plane, turned by ten degrees about up.
    turned = math.radians(10)
    right = np.array([math.cos(turned), 0, math.sin(turned)])
    middle = np.array([1, 2, 1]) + 0.5 * right + np.array([0, -0.25, 0])
    x = (np.arange(40) + 0.5 - 20) * 0.1
    y = (15 - np.arange(30) - 0.5) * 0.1
    expected = middle + x[None, :, None] * right + y[:, None, None] * np.array([0, 1, 0])
    assert np.allclose(origins, expected, atol=1e-14)
    away = origins - (1, 2, 3)
    assert np.allclose(directions, away / np.linalg.norm(away, axis=-1, keepdims=True))


@pytest.mark.parametrize(
    ("make", "what"),
    [
        (lambda: fh.Camera.from_opencv([1, 1, 0, 0], (1, 2, 3), rows=2, columns=2), "0, 4, 5, 8"),
        (lambda: fh.Camera.from_opencv([0, 1, 0, 0], rows=2, columns=2), "fx must be a positive"),
        (
            lambda: fh.Camera.from_opencv(
                [1, 1, 0, 0], rvec=(0, 0, 0), R=np.eye(3), rows=2, columns=2
            ),
            "one of rvec and R",
        ),
        (
            lambda: fh.Camera.from_intrinsics([1, 1, 0, 0], rows=2, columns=2, convention="maya"),
            "convention must be one of opencv",
        ),
        (
            lambda: fh.Camera.from_intrinsics(
                [1, 1, 0, 0], rows=2, columns=2, convention="ros", pose=2 * np.eye(4)
            ),
            "pose must be",
        ),
        (
            lambda: fh.Camera.from_intrinsics(
                [1, 1, 0, 0],
                rows=2,
                columns=2,
                convention="ros",
                projection="eucm",
                parameters={"k1": 1.0},
            ),
            "there are fx, fy, cx, cy, skew, alpha, beta",
        ),
        (
            lambda: fh.Camera.fisheye((0, 0, 0), (0, 0, 1), (0, 1, 0), 361, rows=2, columns=2),
            "fov must be a number above 0 and up to 360",
        ),
        (
            lambda: fh.Camera.from_projection_matrix(np.zeros((3, 4)), rows=2, columns=2),
            "P must be",
        ),
    ],
)
def test_what_makes_no_camera_is_refused(make, what):
    with pytest.raises(ValueError, match=what):
        make()


def test_a_colmap_folder_is_read_without_its_files_names(tmp_path):
    folder = tmp_path / "sparse"
    with pytest.raises(fh.FileReadError, match="sparse: No such file"):
        fh.Camera.from_colmap(folder)
    folder.mkdir()
    (folder / "cameras.txt").write_text("1 PINHOLE 640 480 1 2 3 4\n2 DIVISION 6 4 1 2 3 4 5\n")
    with pytest.raises(fh.FileFormatError, match=r"sparse: expected cameras\.bin and images\.bin"):
        fh.Camera.from_colmap(folder)
    (folder / "images.txt").write_text("1 1 0 0 0 0 0 0 1 a.png\n\n")
    assert list(fh.Camera.from_colmap(folder)) == ["a.png"]
    # Of both pairs it is the binary one, as COLMAP itself takes it.
    for name in ("cameras", "images"):
        (folder / f"{name}.bin").write_bytes(bytes(8))
    assert fh.Camera.from_colmap(folder) == {}
    for name in ("cameras", "images"):
        (folder / f"{name}.bin").unlink()
    lines = "1 1 0 0 0 0 0 0 2 b.png\n\n1 1 0 0 0 0 0 0 1 c.png\n\n"
    (tmp_path / "images.txt").write_text(lines)
    with pytest.warns(fh.FirsthitWarning, match=r"1 images are left out, such as 'b.png'.*DIVISI"):
        read = fh.Camera.from_colmap(folder / "cameras.txt", tmp_path / "images.txt")
    assert list(read) == ["c.png"]
    (folder / "images.txt").unlink()
    (folder / "images.txt").symlink_to(tmp_path / "images.txt")
    with pytest.raises(fh.FileFormatError, match="outside the reconstruction's folder"):
        fh.Camera.from_colmap(folder)


def test_none_stands_for_no_distortion_no_rotation_and_no_translation():
    plain = fh.Camera.from_opencv([500, 500, 320, 240], rows=480, columns=640)
    given = fh.Camera.from_opencv([500, 500, 320, 240], None, None, None, rows=480, columns=640)
    np.testing.assert_array_equal(given.rays(), plain.rays())
