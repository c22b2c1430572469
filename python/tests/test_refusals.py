"""Arguments that make no sense are refused by name, and leave things as they were."""

import firsthit as fh
import numpy as np
import pytest
from support import SQUARE, ball

SURROGATE = "\ud800"
TEXELS = np.zeros((2, 2, 3), np.uint8)
SPHERE = fh.Sphere((0, 0, 0), 2)

#: Anything but what is wanted.
ODD = [
    5,
    None,
    object(),
    b"x",
    [1],
    {"a": 1},
    np.nan,
    1 + 2j,
    np.array(3),
    SPHERE,
    fh.Material,
    len,
]


@pytest.mark.parametrize("name", [SURROGATE, "a\udfffb", 5, None, b"part", ["part"]])
def test_names_that_no_file_holds_are_refused_and_the_scene_goes_on(name):
    scene = ball()
    with pytest.raises((TypeError, ValueError), match="name must be "):
        scene.add(SPHERE, name=name)
    assert len(scene.objects) == 1
    assert scene.shoot([0, 0, 5], [0, 0, -1]).t == 4


@pytest.mark.parametrize(
    ("light", "name"),
    [
        (lambda: fh.PointLight((0, np.nan, 0)), "position"),
        (lambda: fh.SpotLight((np.inf, 0, 0), (0, 0, 1)), "position"),
        (lambda: fh.SpotLight((0, 0, 0), (0, 0, np.nan)), "direction"),
        (lambda: fh.DirectionalLight((0, 0, -np.inf)), "direction"),
        (lambda: fh.SphereLight((np.nan, 0, 0)), "center"),
        (lambda: fh.DiscLight((0, 0, 0), (np.nan, 0, 1)), "normal"),
        (lambda: fh.RectangleLight((0, 0, 0), (1, 0, 0), (0, np.inf, 0)), "edge_v"),
    ],
)
def test_lights_are_at_places_and_have_directions(light, name):
    with pytest.raises(ValueError, match=f"{name} must be three finite numbers"):
        light()


@pytest.mark.parametrize("light", [*ODD, "sun", (0, 0, -1), fh.PointLight])
def test_what_is_no_light_is_refused_and_the_scene_goes_on(light):
    scene = ball()
    with pytest.raises(TypeError, match="light must be a light, got "):
        scene.add_light(light)
    assert scene.lights == ()
    assert scene.shoot([0, 0, 5], [0, 0, -1]).t == 4


CAMERA = {
    "position": (0, 0, 5),
    "aim": (0, 0, -1),
    "up": (0, 1, 0),
    "focal_length": 1,
    "width": 1,
    "height": 1,
    "rows": 3,
    "columns": 3,
}


@pytest.mark.parametrize("value", [*ODD, SURROGATE])
@pytest.mark.parametrize(
    ("name", "make"),
    [
        ("wrap", lambda value: fh.Texture(TEXELS, wrap=value)),
        ("wrap", lambda value: fh.Texture(TEXELS, wrap=("clamp", value))),
        ("filter", lambda value: fh.Texture(TEXELS, filter=value)),
        ("alpha_mode", lambda value: fh.Material(alpha_mode=value)),
        ("unlit", lambda value: fh.Material(unlit=value)),
        ("double_sided", lambda value: fh.Material(double_sided=value)),
        ("shade", lambda value: fh.Shading(shade=value)),
        ("shadows", lambda value: fh.Shading("direct", shadows=value)),
        ("tone_map", lambda value: fh.Display(tone_map=value)),
        ("projection", lambda value: fh.Camera(**CAMERA, projection=value)),
        ("ray_start", lambda value: fh.Camera(**CAMERA, ray_start=value)),
        ("view", lambda value: fh.Camera.framing(ball(), view=value)),
        ("names? of vertex_properties", lambda value: properties(value)),
        ("face_properties", lambda value: fh.Mesh(*SQUARE, face_properties=value)),
    ],
    # Of the functions, nothing that differs between processes (pytest-xdist).
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_words_flags_and_dicts_are_refused_by_name(name, make, value):
    if name in ("face_properties", "shade", "shadows") and value is None:
        return
    is_key = "properties" in name and isinstance(value, list | dict | np.ndarray)
    words = "unhashable|must " if is_key else f"{name} must be "
    with pytest.raises((TypeError, ValueError), match=words):
        make(value)


def properties(name):
    return fh.Mesh(*SQUARE, vertex_properties={name: [1, 2, 3, 4]})


@pytest.mark.parametrize(
    "make",
    [
        lambda color: fh.Material(color=color),
        lambda color: fh.PointLight((0, 0, 9), intensity=color),
        lambda color: fh.Shading(ambient=color),
        lambda color: ball().add(SPHERE, color=color),
        lambda color: setattr(ball(), "background", color),
        lambda color: fh.render(ball(), background=color),
    ],
)
def test_colours_with_lone_surrogates_are_refused_in_words(make):
    with pytest.raises(ValueError, match="must be text without lone surrogates"):
        make(SURROGATE)


@pytest.mark.parametrize("material", [5, np.array(3), len, [5]])
def test_what_is_no_material_is_refused_by_name(material):
    with pytest.raises(TypeError, match="material must be a Material or several, got "):
        ball().add(SPHERE, material=material)


def test_truth_values_of_numpy_are_truth_values():
    yes, no = np.arange(2) == 0
    assert fh.Material(unlit=yes).unlit is True
    assert fh.Shading(shadows=no).shade["shadows"] is False


#: Float32 NaNs that make the processor say so when they are converted.
SIGNALLING = np.full((4, 3), 0x7F800001, np.uint32).view(np.float32)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: fh.Mesh(SIGNALLING, SQUARE[1]), "vertices must be finite"),
        (lambda: fh.Mesh(SQUARE[0], SIGNALLING), "triangles must be whole numbers"),
        (lambda: ball().add(SPHERE, transform=SIGNALLING.reshape(3, 4)), "transform must "),
        (lambda: fh.Sphere(SIGNALLING[0], 1), "center must be finite"),
        (lambda: fh.Camera(**{**CAMERA, "position": SIGNALLING[0]}), "position must be finite"),
        (lambda: fh.Material(color=SIGNALLING[0]), "color must be finite"),
    ],
)
def test_signalling_nans_are_refused_without_a_warning_of_numpy(make, words):
    with pytest.raises(ValueError, match=words):
        make()


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("number", [SIGNALLING, np.full((4, 3), 1e300)])
def test_numbers_that_are_not_finite_go_without_a_warning_where_they_are_taken(number):
    fh.Mesh(*SQUARE, normals=number, uvs=number[:, :2], vertex_properties={"q": number[:, 0]})
    hits = ball().shoot(number, number, t_min=number[:, 0], t_max=number[:, 0])
    assert np.isinf(hits.t).all()
    assert np.isinf(ball().shoot(number, [0, 0, 1], dtype=np.float32).t).all()
    assert not ball().occluded(number, [0, 0, 1]).any()


@pytest.mark.parametrize("size", [2**31, 2**32, 2**62])
def test_a_picture_of_more_pixels_than_any_memory_is_one_error(size):
    scene = ball()
    camera = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 45, size, size)
    for ask in (
        lambda: fh.render(scene, camera),
        lambda: fh.render(scene, camera, channels="z"),
        lambda: next(iter(fh.render_progressively(scene, camera))),
        lambda: scene.shoot(camera),
        lambda: scene.shoot(camera, t_max=3),
        lambda: scene.shoot_all(camera),
        lambda: scene.occluded(camera),
        camera.rays,
    ):
        with pytest.raises(MemoryError, match=f"{size} rows of {size} pixels do not fit"):
            ask()
    part = fh.render(scene, camera, channels="z", region=np.s_[:2, :3])
    assert part["z"].shape == (2, 3)
