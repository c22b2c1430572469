"""Meshes of other packages by what they have: stand-ins, and the real ones."""

from types import SimpleNamespace

import firsthit as fh
import numpy as np
import pytest

BOX = fh.Box((0, 0, 0), (1, 1, 1))
CORNERS = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
#: The sides of the box as quads, outwards.
QUADS = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
TRIANGLES = [t for a, b, c, d in QUADS for t in ([a, b, c], [a, c, d])]
HEAT = np.arange(8.0)
PARTS = np.arange(6)


class TensorMap(dict):
    """As Open3D's: a dict of tensors."""


class Tensor:
    """As Open3D's: an array behind ``numpy``, which may be on another device."""

    def __init__(self, values):
        self._values = np.asarray(values)

    def cpu(self):
        return self

    def numpy(self):
        return self._values

    def __array__(self, *_, **__):
        raise TypeError("a tensor of another device is no array")


def block(kind, data):
    return SimpleNamespace(type=kind, data=np.array(data))


def poly_data(**others):
    packed = np.concatenate([[4, *quad] for quad in QUADS])
    return SimpleNamespace(points=CORNERS.astype(np.float32), faces=packed, **others)


STAND_INS = {
    "pyvista": poly_data(point_data={"heat": HEAT}, cell_data={"part": PARTS}),
    "open3d": SimpleNamespace(
        vertices=CORNERS, triangles=TRIANGLES, vertex_colors=[], vertex_normals=[], triangle_uvs=[]
    ),
    "open3d.t": SimpleNamespace(
        vertex=TensorMap(positions=Tensor(CORNERS.astype(np.float32)), heat=Tensor(HEAT)),
        triangle=TensorMap(indices=Tensor(TRIANGLES)),
    ),
    "meshio": SimpleNamespace(
        points=CORNERS,
        cells=[block("quad", QUADS[:2]), block("line", [[0, 1]]), block("quad", QUADS[2:])],
        point_data={"heat": HEAT},
        cell_data={"part": [PARTS[:2], np.array([9]), PARTS[2:]]},
    ),
    "trimesh": SimpleNamespace(vertices=CORNERS, faces=np.array(TRIANGLES)),
    "quads": SimpleNamespace(vertices=CORNERS, faces=QUADS),
    "a pair": (CORNERS, QUADS),
    "a pair in a list": [CORNERS.tolist(), np.array(TRIANGLES)],
}


@pytest.mark.parametrize("name", STAND_INS)
def test_a_mesh_is_known_by_what_it_has_and_is_the_box_that_it_says(name):
    mesh = STAND_INS[name]
    made, scene = fh.Mesh.of(mesh), fh.Scene()
    assert scene.add(mesh, name="other") == 0
    other = fh.Scene()
    other.add(BOX)
    rng = np.random.default_rng(1)
    rays = rng.uniform(-2, 3, (500, 3)), rng.normal(size=(500, 3))
    np.testing.assert_allclose(scene.shoot(*rays).t, other.shoot(*rays).t, rtol=1e-12)
    for one in (made, scene.objects[0].shape, fh.Mesh(mesh)):
        assert (one.is_closed, len(one.vertices), len(one.triangles)) == (True, 8, 12)
    scene.replace(0, mesh)
    assert isinstance(scene.objects[0].shape, fh.Mesh)


@pytest.mark.parametrize("name", ["pyvista", "meshio", "open3d.t"])
def test_numbers_of_vertices_and_faces_come_along(name):
    scene = fh.Scene()
    scene.add(STAND_INS[name])
    hits = scene.shoot([[0.25, 0.5, 5], [0.25, 0.5, -5]], [[0, 0, -1], [0, 0, 1]])
    np.testing.assert_allclose(hits["heat"], [4 + 0.25 + 2 * 0.5, 0.25 + 2 * 0.5])
    if name != "open3d.t":
        assert hits["part"].tolist() == [1, 0]
        assert hits.face.tolist() == [1, 0]


def test_colours_normals_and_texture_coordinates_come_along():
    levels = np.tile([1.0, 188 / 255, 0.0], (8, 1))
    up = np.tile([0.0, 0.0, 1.0], (8, 1))
    uvs = np.tile([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], (12, 1))
    legacy = SimpleNamespace(
        vertices=CORNERS,
        triangles=TRIANGLES,
        vertex_colors=levels,
        vertex_normals=up,
        triangle_uvs=uvs,
    )
    tensors = SimpleNamespace(
        vertex={
            "positions": Tensor(CORNERS),
            "colors": Tensor(np.uint8(255 * levels)),
            "normals": Tensor(up),
        },
        triangle={"indices": Tensor(TRIANGLES), "texture_uvs": Tensor(uvs.reshape(12, 3, 2))},
    )
    for mesh in (legacy, tensors):
        made = fh.Mesh.of(mesh)
        np.testing.assert_allclose(made.colors[0], [1, 0.5029, 0], atol=1e-4)
        np.testing.assert_array_equal(made.normals, up)
        np.testing.assert_array_equal(made.uvs, uvs.reshape(12, 3, 2))
    vista = fh.Mesh.of(poly_data(point_data={"Normals": up, "heat": HEAT}))
    np.testing.assert_array_equal(vista.normals, up)
    assert {*vista.vertex_properties} == {"heat"}


def test_polygons_of_any_numbers_of_corners_are_cut_and_concave_ones_rightly():
    # A dart, a square and a triangle: the fan of the dart from its first corner would turn over.
    points = [
        [0, 0],
        [3, 1],
        [0, 2],
        [1, 1],
        [5, 0],
        [6, 0],
        [6, 1],
        [5, 1],
        [8, 0],
        [9, 0],
        [8, 1],
    ]
    vertices = [[x, y, 0] for x, y in points]
    polygons = [[0, 1, 2, 3], [4, 5, 6, 7], [8, 9, 10]]
    packed = np.concatenate([[len(one), *one] for one in polygons])
    for mesh in (
        fh.Mesh(vertices, polygons),
        fh.Mesh.of((vertices, polygons)),
        fh.Mesh.of(SimpleNamespace(points=vertices, faces=packed)),
        fh.Mesh.of(
            SimpleNamespace(
                points=np.array(points, float),
                cells=[
                    SimpleNamespace(type="polygon", data=polygons[:2]),
                    block("triangle", polygons[2:]),
                ],
            )
        ),
    ):
        assert mesh.faces.tolist() == [0, 0, 1, 1, 2]
        a, b, c = np.moveaxis(mesh.vertices[mesh.triangles], 1, 0)
        areas = np.cross(b - a, c - a)[:, 2] / 2
        np.testing.assert_allclose(areas, [1, 1, 0.5, 0.5, 0.5])
    quads = fh.Mesh(vertices, np.array(polygons[:2]), slots=[3, 5])
    assert (quads.slots.tolist(), quads.faces.tolist()) == ([3, 3, 5, 5], [0, 0, 1, 1])


def test_what_is_left_out_is_said():
    tetra = SimpleNamespace(
        points=CORNERS, cells=[block("tetra", [[0, 1, 2, 4]]), block("quad", QUADS)]
    )
    with pytest.warns(fh.FirsthitWarning, match="cells of tetra are left out"):
        assert len(fh.Mesh.of(tetra).triangles) == 12
    cells = np.arange(7)
    with pytest.warns(fh.FirsthitWarning, match="1 cells of a mesh are left out: vertices and"):
        made = fh.Mesh.of(poly_data(n_lines=1, cell_data={"part": cells}))
    assert made.face_properties["part"].tolist() == [1, 2, 3, 4, 5, 6]


@pytest.mark.parametrize(
    ("mesh", "error", "message"),
    [
        (3, TypeError, "must be a shape, or a mesh with vertices and faces"),
        ("ab", TypeError, "must be a shape, or a mesh"),
        (SimpleNamespace(points=CORNERS), TypeError, "must be a shape, or a mesh"),
        ((CORNERS, [[0, 1]]), ValueError, "polygon 0 has 2"),
        (
            (CORNERS, [[0, 1, 2], [0, 1, 2, 8]]),
            ValueError,
            "indices of 8 vertices, got from 0 to 8",
        ),
        ((CORNERS, [[0, 1, 2, -1]]), ValueError, "indices of 8 vertices, got from -1"),
        ((CORNERS, [[0, 1, 2, 0.5]]), ValueError, "must be whole numbers"),
        ((CORNERS[:, :2], QUADS), ValueError, r"vertices must have the shape \(n, 3\)"),
        (([[np.nan] * 3] * 4, [[0, 1, 2, 3]]), ValueError, "finite"),
    ],
)
def test_what_is_no_mesh_is_refused(mesh, error, message):
    with pytest.raises(error, match=message):
        fh.Scene().add(mesh)


def test_real_meshes_of_pyvista_come_as_they_are():
    pyvista = pytest.importorskip("pyvista")
    tube = pyvista.Cylinder(resolution=12).clean()
    tube.cell_data["part"] = np.arange(tube.n_cells)
    scene = fh.Scene()
    scene.add(tube)
    made = scene.objects[0].shape
    assert made.is_closed
    # Each of the ends has 12 corners.
    assert len(made.triangles) == 24 + 2 * 10
    hits = scene.shoot([[5, 0, 0]], [[-1, 0, 0]])
    np.testing.assert_allclose(hits.t, 4.5)
    assert tube.get_cell(int(hits["part"][0])).n_points == 12


def test_real_meshes_of_meshio_come_as_they_are():
    meshio = pytest.importorskip("meshio")
    scene = fh.Scene()
    scene.add(meshio.Mesh(CORNERS, [("quad", QUADS)], point_data={"heat": HEAT}))
    assert float(scene.shoot((0.25, 0.5, 5), (0, 0, -1))["heat"]) == 5.25


def test_real_meshes_of_open3d_come_as_they_are():
    open3d = pytest.importorskip("open3d")
    legacy = open3d.geometry.TriangleMesh.create_box()
    legacy.paint_uniform_color([1, 0.5, 0])
    legacy.compute_vertex_normals()
    for mesh in (legacy, open3d.t.geometry.TriangleMesh.from_legacy(legacy)):
        scene = fh.Scene()
        scene.add(mesh)
        made = scene.objects[0].shape
        assert made.is_closed
        np.testing.assert_allclose(made.colors[0], [1, 0.2159, 0], atol=1e-3)
        assert made.normals is not None
        assert float(scene.shoot((0.25, 0.5, 5), (0, 0, -1)).t) == 4
