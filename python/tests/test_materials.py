"""Materials, textures, and what files bring along."""

import copy
import gc
import math
import pickle
import tracemalloc
import weakref

import firsthit as fh
import numpy as np
import pytest

SQUARE = np.float64([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
HALVES = np.uint32([[0, 1, 2], [0, 2, 3]])
UVS = SQUARE[:, :2]
#: Red and green above blue and a transparent white.
TEXELS = np.uint8([[[255, 0, 0, 255], [0, 255, 0, 255]], [[0, 0, 255, 255], [255, 255, 255, 0]]])
CENTRES = np.float64([[0.25, 0.75], [0.75, 0.75], [0.25, 0.25], [0.75, 0.25]])


def scene_of(material, **attributes):
    scene = fh.Scene()
    scene.add(fh.Mesh(SQUARE, HALVES, **attributes), material=material)
    return scene


def colors_at(scene, points):
    """Return the colours of an unlit picture straight down on the points."""
    camera = fh.Camera((0.5, 0.5, 2), (0, 0, -1), (0, 1, 0), 1, 1, 1, 2, 2, "orthographic")
    assert len(points) == 4
    return fh.render(scene, camera, shade="unlit", samples=1)["color"].reshape(4, 3)


def test_texels_are_seen_where_they_are():
    scene = scene_of(fh.Material(texture=fh.Texture(TEXELS)), uvs=UVS)
    assert np.allclose(colors_at(scene, CENTRES), np.float64(TEXELS[..., :3].reshape(4, 3)) / 255)


def test_a_color_at_each_add_takes_no_material_of_its_own():
    mesh = fh.Mesh(SQUARE, HALVES)

    def bytes_of(count, **look):
        scene = fh.Scene()
        scene.add(mesh, **{name: make(0) for name, make in look.items()})
        tracemalloc.start()
        for k in range(count):
            scene.add(mesh, **{name: make(k) for name, make in look.items()})
        taken = tracemalloc.get_traced_memory()[0]
        tracemalloc.stop()
        return taken / count

    one = fh.Material("red")
    least = bytes_of(1000, material=lambda _: one)
    for look in (
        {"color": lambda _: "red"},
        {"color": lambda k: (0.25, 0.5, k % 3)},
        {"material": lambda k: fh.Material("gold", roughness=k % 3 / 2, name="coin")},
    ):
        assert bytes_of(1000, **look) < least + 30, look


def test_objects_share_materials_that_are_alike_to_the_bit():
    mesh, texture = fh.Mesh(SQUARE, HALVES, uvs=UVS), fh.Texture(TEXELS)
    scene = fh.Scene()

    def added(**look):
        scene.add(mesh, **look)
        return scene.objects[-1].materials[0]

    class Name(str):
        __slots__ = ()

    class Own(fh.Material):
        pass

    assert added(color="red") is added(color=(1, 0, 0))
    assert added(material=fh.Material(texture=texture)) is added(
        material=fh.Material("white", texture=texture)
    )
    several = [
        {"color": (0.0, 1, 1)},
        {"color": (-0.0, 1, 1)},
        {"material": fh.Material(texture=texture, cutoff=0.25)},
        {"material": fh.Material(texture=fh.Texture(TEXELS), cutoff=0.25)},
        {"material": fh.Material(alpha_texture=texture)},
        {"material": fh.Material("blue", name="a")},
        {"material": fh.Material("blue", name=Name("a"))},
        {"material": Own("blue", name="a")},
        {"material": fh.Material("blue", name="a", normal_scale=0.0)},
        {"material": fh.Material("blue", name="a", normal_scale=-0.0)},
    ]
    looks = [added(**look) for look in several]
    assert len({*map(id, looks)}) == len(looks)
    assert math.copysign(1, looks[1].color[0]) == -1
    for look, made in zip(several[2:], looks[2:], strict=True):
        assert made is look["material"]


def test_materials_that_no_object_has_any_more_are_not_kept():
    scene = fh.Scene()
    for look in ({"color": (0.123, 0.5, 0.25)}, {"material": fh.Material("red", name="one")}):
        scene.add(fh.Mesh(SQUARE, HALVES), **look)
    known = [weakref.ref(made.materials[0]) for made in scene.objects]
    del scene, look
    gc.collect()
    assert [made() for made in known] == [None, None]


def test_alpha_masks_cut_surfaces_out():
    texture = fh.Texture(TEXELS, filter="nearest")
    for mode, hits in [("opaque", 4), ("blend", 4), ("mask", 3)]:
        scene = scene_of(fh.Material(texture=texture, alpha_mode=mode), uvs=UVS)
        origins = np.column_stack([CENTRES, np.ones(4)])
        assert np.isfinite(scene.shoot(origins, [0, 0, -1]).t).sum() == hits
        assert scene.occluded(origins, [0, 0, -1]).sum() == hits


def test_alphas_of_vertices_cut_surfaces_out_too():
    scene = scene_of(fh.Material(alpha_mode="mask"), alphas=[[0], [0], [1], [1]])
    t = scene.shoot([[0.5, 0.2, 1], [0.5, 0.8, 1]], [0, 0, -1]).t
    assert t.tolist() == [np.inf, 1]


def test_slots_choose_materials():
    red, blue = fh.Material((1, 0, 0)), fh.Material((0, 0, 1))
    scene = scene_of([red, blue], slots=[1, 0])
    # Pixel centres lie on the diagonal only at the first and last.
    assert colors_at(scene, CENTRES)[[0, 3]].tolist() == [[1, 0, 0], [0, 0, 1]]
    assert scene.objects[0].materials == (red, blue)


def test_unlit_materials_are_seen_as_they_are():
    camera = fh.Camera.look_at((0.5, 0.5, 2), (0.5, 0.5, 0), (0, 1, 0), 20, 3, 3)
    seen = fh.render(scene_of(fh.Material((0.25, 0.5, 1), unlit=True)), camera)["color"]
    assert seen[1, 1].tolist() == [0.25, 0.5, 1]


def test_attributes_may_belong_to_corners():
    corners = UVS[HALVES] + [[[0, 0]], [[1, 0]]]
    scene = scene_of(None, uvs=corners)
    hits = scene.shoot([[0.75, 0.25, 1], [0.25, 0.75, 1]], [0, 0, -1])
    assert hits.uv.tolist() == [[0.75, 0.25], [1.25, 0.75]]


@pytest.mark.parametrize("again", [copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))])
def test_all_of_a_scene_copies_and_pickles(again):
    alpha = fh.Texture(TEXELS, wrap=("mirror", "clamp"))
    texture = fh.Texture(TEXELS[..., :3], filter="nearest", picture_from_uv=np.eye(2, 3))
    material = fh.Material(
        (0.5, 1, 1), 0.75, texture, alpha, alpha_mode="mask", cutoff=0.25, double_sided=False
    )
    normals = np.float32([[0, 0, 1]] * 4)
    attributes = {"uvs": UVS[HALVES], "normals": normals, "alphas": np.ones((4, 1))}
    scene = scene_of([material], **attributes, faces=[7, 7], slots=[0, 0])
    scene.background = fh.Sky((1, 1, 1), (0, 0, 1))
    made = again(scene)
    mesh, before = made.objects[0].shape, scene.objects[0].shape
    for name in ("vertices", "triangles", "normals", "uvs", "alphas", "faces", "slots"):
        assert np.array_equal(getattr(mesh, name), getattr(before, name)), name
    assert mesh.colors is None
    assert made.background == scene.background
    (look,) = made.objects[0].materials
    assert (look.color, look.alpha, look.cutoff) == ((0.5, 1, 1), 0.75, 0.25)
    assert np.array_equal(look.texture.texels[..., :3], TEXELS[..., :3])
    assert look.alpha_texture.wrap == ("mirror", "clamp")
    assert look.texture.picture_from_uv.tolist() == np.eye(2, 3).tolist()
    assert np.array_equal(colors_at(made, CENTRES), colors_at(scene, CENTRES))


def test_a_file_s_meshes_keep_their_attributes(tmp_path):
    path = tmp_path / "square.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\n")
    scene = fh.load(path)
    again = pickle.loads(pickle.dumps(scene))
    for made in (scene, again):
        assert made.objects[0].shape.uvs.tolist() == [[[0, 0], [1, 0], [1, 1]]]
        assert made.objects[0].materials == ()
        assert made.cameras == ()
        with pytest.raises(KeyError, match="there is no camera 'Front'; there are: none"):
            made.camera("Front")


def test_skies_are_seen_by_rays_that_miss():
    camera = fh.Camera((0, 0, 0), (0, 0, 1), (0, 1, 0), 1, 1, 1, 1, 1)
    scene = fh.Scene()
    program_s = np.float32([0.12, 0.17, 0.24])
    np.testing.assert_array_equal(fh.render(scene, camera, samples=1)["color"], [[program_s]])
    scene.background = fh.Sky(horizon=(1, 1, 1), zenith=(0, 0, 1))
    assert fh.render(scene, camera, samples=1)["color"].tolist() == [[[0, 0, 1]]]
    assert fh.render(scene, camera, background=(1, 0, 0))["color"].tolist() == [[[1, 0, 0]]]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: fh.Texture(np.zeros((2, 2, 3))), "texels must be uint8"),
        (lambda: fh.Texture(np.zeros((0, 2, 3), np.uint8)), "texels must be"),
        (lambda: fh.Texture(TEXELS, wrap="tile"), "wrap must be one of repeat, mirror, clamp"),
        (lambda: fh.Texture(TEXELS, filter="cubic"), "filter must be one of nearest, linear"),
        (
            lambda: fh.Texture(TEXELS, picture_from_uv=np.eye(3)),
            "picture_from_uv must be",
        ),
        (lambda: fh.Material(alpha_mode="clip"), "alpha_mode must be one of opaque, mask, blend"),
        (lambda: fh.Material(color=1), "color must be three numbers"),
        (lambda: fh.Mesh(SQUARE, HALVES, slots=[0]), "slots must be 2 whole numbers"),
        (lambda: fh.Mesh(SQUARE, HALVES, uvs=np.zeros((2, 3, 3))), r"uvs must have the shape"),
    ],
)
def test_what_makes_no_sense_is_refused_by_name(make, words):
    with pytest.raises(ValueError, match=words):
        make()


def test_numbers_by_name_come_along(tmp_path):
    path = tmp_path / "scan.ply"
    path.write_text(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nproperty uchar quality\nelement face 1\n"
        "property list uchar int vertex_indices\nproperty int label\nend_header\n"
        "0 0 0 1\n1 0 0 2\n0 1 0 3\n3 0 1 2 1073741825\n"
    )
    mesh = fh.load(path).objects[0].shape
    for made in (mesh, pickle.loads(pickle.dumps(mesh))):
        assert made.vertex_properties["quality"].tolist() == [1, 2, 3]
        assert made.face_properties["label"].tolist() == [1073741825]
    with pytest.raises(ValueError, match="as many as vertices"):
        fh.Mesh(SQUARE, HALVES, vertex_properties={"quality": [1, 2]})


@pytest.mark.parametrize(
    ("text", "linear"),
    [
        ("white", (1, 1, 1)),
        ("Black", (0, 0, 0)),
        ("#ff0000", (1, 0, 0)),
        # IEC 61966-2-1: 0x80 is 128 / 255.
        ("#808080", (((128 / 255 + 0.055) / 1.055) ** 2.4,) * 3),
    ],
)
def test_colours_are_css_names_and_srgb_too(text, linear):
    scene = fh.Scene()
    scene.add(fh.Sphere((0, 0, 0), 1), color=text)
    scene.background = text
    for color in (
        scene.objects[0].color,
        scene.background,
        fh.Material(text).color,
        fh.Sky(text, "white").horizon,
        fh.Shading(ambient=text).shade["ambient"],
        fh.DirectionalLight((0, 0, -1), text).color,
        fh.PointLight((0, 0, 9), text).intensity,
    ):
        np.testing.assert_allclose(color, linear, rtol=1e-12)
    camera = fh.Camera.framing(scene, rows=3, columns=4)
    frame = fh.render(scene, camera, background=text, samples=1)
    np.testing.assert_allclose(frame["color"][0, 0], linear, rtol=1e-6)


@pytest.mark.parametrize(
    ("color", "message"),
    [
        ("tomatoe", "'#rrggbb' or a CSS name, got 'tomatoe'; did you mean 'tomato'"),
        ("#f6", "'#rrggbb' or a CSS name, got '#f6'"),
        ("transparent", "got 'transparent'"),
        ((np.nan, 0, 0), "finite and not negative"),
        ((-1, 0, 0), r"finite and not negative, got \(-1.0, 0.0, 0.0\)"),
        ((np.inf, 0, 0), "finite and not negative"),
    ],
)
def test_what_is_no_colour_is_refused_where_it_is_given(color, message):
    with pytest.raises(ValueError, match=message):
        fh.Scene().add(fh.Sphere((0, 0, 0), 1), color=color)
    with pytest.raises(ValueError, match=r"transparant.*did you mean 'transparent'"):
        fh.Scene().background = "transparant"


def test_levels_up_to_255_are_a_warning_but_for_lights():
    with pytest.warns(fh.FirsthitWarning, match="written '#ff8000'"):
        fh.Material((255, 128, 0))
    assert fh.PointLight((0, 0, 9), (255, 128, 0)).intensity == (255, 128, 0)


def test_a_material_is_matte_unless_it_says_more():
    assert fh.Material("red").kind == "matte"
    assert fh.Material("red").metallic is None
    gold = fh.Material("gold", metallic=1, roughness=0.3)
    assert (gold.kind, gold.metallic, gold.roughness, gold.ior) == ("metal-rough", 1.0, 0.3, 1.5)
    glass = fh.Material(kind="glass", absorption=(0.1, 0.2, 0.3))
    assert (glass.ior, glass.absorption, glass.metallic) == (1.5, (0.1, 0.2, 0.3), None)
    assert gold == fh.Material("gold", metallic=1, roughness=0.3) != fh.Material("gold", metallic=1)
    assert "roughness=0.3" in repr(gold)
    assert repr(fh.Material((1, 0, 0))) == "Material(color=(1.0, 0.0, 0.0))"


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: fh.Material(roughness=2), "roughness must be"),
        (lambda: fh.Material(kind="matte", roughness=0.5), "setting must be"),
        (lambda: fh.Material(kind="wood"), "material must be one of matte"),
        (lambda: fh.Material(emission=(-1, 0, 0)), "emission must be"),
        (lambda: fh.Material(occlusion_strength=2), "occlusion_strength must be"),
        (lambda: fh.Material(alpha=np.nan), "alpha must be from 0 to 1"),
        (lambda: fh.Material(alpha=-1), "alpha must be from 0 to 1"),
        (lambda: fh.Material(cutoff=np.nan), "cutoff must be finite"),
        (lambda: fh.Material(normal_scale=np.nan), "normal_scale must be"),
    ],
)
def test_numbers_of_a_material_that_make_no_sense_are_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_what_surfaces_are_made_of_survives_files_and_pickling(tmp_path):
    bumps = fh.Texture(np.full((2, 2, 3), 128, np.uint8), second_uvs=True)
    look = fh.Material(
        (0.5, 0.25, 1),
        metallic=0.5,
        solid=True,
        attenuation_distance=2,
        emission=(3, 2, 1),
        normal_texture=bumps,
        normal_scale=0.5,
    )
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    uvs, tangents = np.float32([[0, 0], [1, 0], [0, 1]]), np.float32([[1, 0, 0, -1]] * 3)
    mesh = fh.Mesh(corners, [[0, 1, 2]], second_uvs=uvs, tangents=tangents)
    again = pickle.loads(pickle.dumps(mesh))
    assert np.array_equal(again.tangents, tangents)
    assert np.array_equal(again.second_uvs, uvs)
    scene = fh.Scene()
    scene.add(mesh, material=look)
    scene.save(tmp_path / "scene.fhs")
    (read,) = fh.open(tmp_path / "scene.fhs").objects[0].materials
    assert (read.metallic, read.solid, read.emission) == (0.5, True, (3.0, 2.0, 1.0))
    assert read.normal_texture.second_uvs
    assert (read.normal_scale, read.attenuation_distance) == (0.5, 2.0)
    assert pickle.loads(pickle.dumps(look)).metallic == 0.5


def test_lights_and_emissions_below_zero_are_refused_with_their_names():
    for make, name in [
        (lambda dark: fh.PointLight((0, 0, 1), dark), "intensity"),
        (lambda dark: fh.SpotLight((0, 0, 1), (0, 0, -1), dark), "intensity"),
        (lambda dark: fh.DirectionalLight((0, 0, -1), dark), "color"),
        (lambda dark: fh.SphereLight((0, 0, 1), 1, dark), "emission"),
        (lambda dark: fh.DiscLight((0, 0, 1), (0, 0, -1), 1, dark), "emission"),
        (lambda dark: fh.RectangleLight((0, 0, 1), (1, 0, 0), (0, 1, 0), dark), "emission"),
        (lambda dark: fh.Material(emission=dark), "emission"),
        (lambda dark: fh.Material(kind="glass", absorption=dark), "absorption"),
        (lambda dark: fh.Environment.uniform(dark), "color"),
        (lambda dark: fh.Environment.hemispheres(dark, (1, 1, 1)), "above"),
        (lambda dark: fh.Environment.gradient((1, 1, 1), dark), "zenith"),
    ]:
        for dark in [(-1, -1, -1), (1, -1e-9, 1), (1, np.nan, 1)]:
            with pytest.raises(ValueError, match=f"^{name} must be finite and not negative, got "):
                make(dark)
        make((2, 3, 4))
    with pytest.raises(ValueError, match="strength"):
        fh.Environment.uniform((1, 1, 1), strength=-1)
