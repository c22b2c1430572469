"""Scenes of trimesh."""

import firsthit as fh
import numpy as np
import pytest

trimesh = pytest.importorskip("trimesh")


def moved(*by):
    return trimesh.transformations.translation_matrix(by)


def painted(mesh, **colors):
    for name, value in colors.items():
        setattr(mesh.visual, name, value)
    return mesh


def test_a_scene_s_nodes_become_objects_with_their_names_places_and_one_mesh_for_all():
    made = trimesh.Scene()
    box = trimesh.creation.box()
    made.add_geometry(box, node_name="left", geom_name="box", transform=moved(-3, 0, 0))
    made.graph.update(frame_to="right", matrix=moved(3, 0, 1), geometry="box")
    scene = fh.Scene()
    ground = scene.add(fh.Plane((0, 0, -9), (0, 0, 1)))
    numbers = scene.add(made, transform=moved(0, 0, 10))
    assert (ground, numbers) == (0, (1, 2))
    left, right = (scene.objects[number] for number in numbers)
    assert (left.name, right.name) == ("left", "right")
    assert left.shape is right.shape
    np.testing.assert_array_equal(right.transform[:3, 3], [3, 0, 11])
    hits = scene.shoot([[-3, 0, 20], [3, 0, 20], [0, 0, 20]], [0, 0, -1])
    np.testing.assert_array_equal(hits.object, [1, 2, 0])
    np.testing.assert_array_equal(hits.t, [9.5, 8.5, 29])
    assert scene.add(trimesh.Scene()) == ()


def test_what_is_no_mesh_is_left_out_with_a_warning():
    made = trimesh.Scene()
    made.add_geometry(trimesh.PointCloud(np.zeros((3, 3))), node_name="dots")
    made.add_geometry(trimesh.creation.box(), node_name="box")
    scene = fh.Scene()
    with pytest.warns(fh.FirsthitWarning, match="node 'dots' is left out: a PointCloud has no"):
        assert scene.add(made) == (0,)
    assert scene.objects[0].name == "box"


def test_warnings_are_of_the_line_that_led_to_them(tmp_path):
    box = trimesh.creation.box()
    box.vertex_attributes["note"] = np.array(["a"] * 8)
    scene = trimesh.Scene([trimesh.PointCloud(np.zeros((3, 3))), box])
    scene.add_geometry(box)
    open_ball = fh.Scene()
    open_ball.add(fh.Sphere((0, 0, 0), 1))
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl none\nf 1 2 3\n")
    for call in (
        lambda: fh.Scene().add(box),
        lambda: fh.Scene().add(scene),
        lambda: fh.Mesh(box),
        lambda: open_ball.section((0, 0, 0), (0, 0, 1)),
        lambda: fh.load(tmp_path / "a.obj"),
        lambda: fh.lint(tmp_path / "a.obj"),
        lambda: fh.Material(color=(255, 128, 0)),
    ):
        with pytest.warns(fh.FirsthitWarning) as told:
            call()
        assert {warning.filename for warning in told} == {__file__}


def test_a_mesh_is_made_with_the_colours_uvs_and_attributes_that_an_object_gets():
    box = painted(trimesh.creation.box(), vertex_colors=[0, 188, 255, 255])
    box.vertex_attributes["heat"] = np.arange(8.0)
    box.face_attributes["part"] = np.arange(12)
    look = trimesh.visual.TextureVisuals(uv=np.eye(8, 2))
    textured = trimesh.Trimesh(box.vertices, box.faces, process=False, visual=look)
    for thing in (box, textured):
        scene = fh.Scene()
        scene.add(thing)
        made, added = fh.Mesh(thing), scene.objects[0].shape
        for name in ("colors", "uvs", "vertices", "triangles"):
            np.testing.assert_array_equal(getattr(made, name), getattr(added, name))
        assert (made.colors is None, made.uvs is None) == (thing is textured, thing is box)
    made = fh.Mesh(box)
    assert made.vertex_properties["heat"].tolist() == [*range(8)]
    assert made.face_properties["part"].tolist() == [*range(12)]
    own = fh.Mesh(box, colors=np.ones((8, 3)), vertex_properties={"mine": np.zeros(8)})
    assert ({*own.vertex_properties}, own.colors.min()) == ({"mine"}, 1)


def seen(scene, at=(0, 0)):
    """The colour straight below a point."""
    camera = fh.Camera((*at, 9), (0, 0, -1), (0, 1, 0), 1, 0.1, 0.1, 1, 1, "orthographic")
    return fh.render(scene, camera, shade="unlit", samples=1)["color"][0, 0]


def test_colours_come_along():
    face = painted(trimesh.creation.box(), face_colors=[188, 0, 255, 255])
    vertex = painted(trimesh.creation.box(), vertex_colors=[0, 188, 255, 255])
    for mesh, expected in ((face, (0.503, 0, 1)), (vertex, (0, 0.503, 1))):
        for thing in (mesh, trimesh.Scene([mesh])):
            scene = fh.Scene()
            scene.add(thing)
            np.testing.assert_allclose(seen(scene), expected, atol=1e-3)
            scene = fh.Scene()
            scene.add(thing, material=fh.Material((0.5, 0.5, 0.5)))
            np.testing.assert_allclose(seen(scene), np.multiply(expected, 0.5), atol=1e-3)
    plain = fh.Scene()
    plain.add(trimesh.Scene([trimesh.creation.box()]), color=(1, 0.5, 0))
    np.testing.assert_array_equal(seen(plain), [1, 0.5, 0])


def test_materials_and_pictures_come_along():
    from PIL import Image

    picture = Image.fromarray(np.uint8([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255] * 3]]))
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    uv = (corners[:, :2] + 1) / 2
    look = trimesh.visual.material.PBRMaterial(
        baseColorTexture=picture, baseColorFactor=[255, 255, 51, 255], alphaMode="MASK"
    )
    simple = trimesh.visual.material.SimpleMaterial(image=picture, diffuse=[255, 255, 51, 255])
    for material in (look, simple):
        visual = trimesh.visual.TextureVisuals(uv=uv, material=material)
        mesh = trimesh.Trimesh(corners, [[0, 1, 2], [0, 2, 3]], visual=visual, process=False)
        scene = fh.Scene()
        scene.add(trimesh.Scene([mesh]))
        for at, expected in [
            ((-0.5, 0.5), (1, 0, 0)),
            ((0.5, 0.5), (0, 1, 0)),
            ((-0.5, -0.5), (0, 0, 0.2)),
            ((0.5, -0.5), (1, 1, 0.2)),
        ]:
            np.testing.assert_allclose(seen(scene, at), expected, atol=1e-6)
    assert scene.objects[0].materials[0].alpha_mode == "opaque"


def test_a_file_by_way_of_trimesh_is_the_file(tmp_path):
    made = trimesh.Scene()
    for k, color in enumerate(([255, 0, 0, 255], [51, 255, 0, 255])):
        ball = trimesh.creation.icosphere(subdivisions=2)
        ball.visual = trimesh.visual.TextureVisuals(
            material=trimesh.visual.material.PBRMaterial(baseColorFactor=color)
        )
        made.add_geometry(ball, node_name=f"ball {k}", transform=moved(3 * k, 0, k))
    (tmp_path / "balls.glb").write_bytes(made.export(file_type="glb"))
    own = fh.load(tmp_path / "balls.glb")
    other = fh.Scene()
    other.add(trimesh.load(tmp_path / "balls.glb"))
    camera = fh.Camera.framing(own, 60, 80)
    ours = fh.render(own, camera, channels=("color", "object", "t"))
    theirs = fh.render(other, camera, channels=("color", "object", "t"))
    np.testing.assert_allclose(theirs["t"], ours["t"], rtol=1e-6)
    np.testing.assert_allclose(theirs["color"], ours["color"], atol=2e-3)
    # trimesh has an order of its own.
    names = [[made.name for made in scene.objects] for scene in (own, other)]
    assert sorted(names[0]) == sorted(names[1]) == ["ball 0", "ball 1"]
    for k, name in enumerate(names[0]):
        same = theirs["object"] == names[1].index(name)
        np.testing.assert_array_equal(same, ours["object"] == k)


def test_flat_nodes_and_several_materials_are_left_out_with_a_warning():
    made = trimesh.Scene()
    flat = np.diag([1.0, 1, 0, 1])
    made.add_geometry(trimesh.creation.box(), node_name="shadow", transform=flat)
    scene = fh.Scene()
    with pytest.warns(fh.FirsthitWarning, match="node 'shadow' is left out: its transform"):
        assert scene.add(made) == ()
    box = trimesh.creation.box()
    red, blue = (
        trimesh.visual.material.SimpleMaterial(diffuse=color)
        for color in ([255, 0, 0, 255], [0, 0, 255, 255])
    )
    box.visual = trimesh.visual.TextureVisuals(
        uv=np.zeros((8, 2)), material=trimesh.visual.material.MultiMaterial([red, blue])
    )
    with pytest.warns(fh.FirsthitWarning, match="several materials are left out"):
        scene.add(box)


def test_a_scene_has_its_own_names():
    with pytest.raises(ValueError, match="name must be left out with a scene, got 'mine'"):
        fh.Scene().add(trimesh.Scene([trimesh.creation.box()]), name="mine")


def test_attributes_come_along():
    box = trimesh.creation.box()
    box.vertex_attributes["height"] = box.vertices[:, 2]
    box.face_attributes["label"] = np.arange(12)
    box.vertex_attributes["note"] = ["a"] * 8
    for thing in (box, trimesh.Scene([box])):
        scene = fh.Scene()
        with pytest.warns(fh.FirsthitWarning, match="'note' of vertex_attributes is left out"):
            scene.add(thing)
        hits = scene.shoot([[0.1, 0.2, 9], [9, 0.1, 0.25]], [[0, 0, -1], [-1, 0, 0]])
        np.testing.assert_allclose(hits.attribute("height"), [0.5, 0.25], atol=1e-12)
        np.testing.assert_array_equal(hits.attribute("label"), hits.primitive)
