"""Sections, beside trimesh's and as CAD programs read them."""

import json
import pickle
import xml.etree.ElementTree as ET

import firsthit as fh
import numpy as np
import pytest
from support import bumpy_sphere


def bumps(rings=20, seed=3, **where):
    scene = fh.Scene()
    scene.add(fh.Mesh(*bumpy_sphere(rings, seed)), **where)
    return scene


def test_areas_and_lengths_are_trimeshs():
    trimesh = pytest.importorskip("trimesh")
    points, triangles = bumpy_sphere(30, 7)
    other = trimesh.Trimesh(points, triangles, process=False)
    scene = bumps(30, 7)
    rng = np.random.default_rng(4)
    for _ in range(20):
        origin, normal = rng.uniform(-0.3, 0.3, 3), rng.uniform(-1, 1, 3)
        cut = scene.section(origin, normal)
        segments, faces = trimesh.intersections.mesh_plane(other, normal, origin, return_faces=True)
        assert all(polyline.is_closed for polyline in cut.polylines)
        lengths = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
        assert cut.perimeter == pytest.approx(lengths.sum(), rel=1e-9)
        # By Green's theorem, each segment with its face's outside on the right.
        p, q = (segments - origin).transpose(1, 0, 2)
        forward = np.cross(cut.normal, other.face_normals[faces])
        signs = np.sign(np.einsum("ij,ij->i", forward, q - p))
        area = 0.5 * (signs * (np.cross(p, q) @ cut.normal)).sum()
        assert cut.area == pytest.approx(area, rel=1e-9)


def test_points_are_on_the_plane_and_in_its_coordinates():
    normal = np.array([1, -2, 0.5])
    cut = bumps().section((0.1, 0, 0), normal)
    frame = np.array([cut.u, cut.v, cut.normal])
    np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-15)
    np.testing.assert_allclose(cut.normal, normal / np.linalg.norm(normal))
    for polyline in cut.polylines:
        offsets = polyline.points - cut.origin
        np.testing.assert_allclose(offsets @ frame[2], 0, atol=1e-15)
        np.testing.assert_allclose(offsets @ frame[:2].T, polyline.points_2d, atol=1e-15)
        assert polyline.points.shape == (len(polyline.primitives), 3)
        x, y = polyline.points_2d.T
        around = 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)
        assert polyline.area == pytest.approx(around, abs=1e-14)
    assert cut.area == pytest.approx(sum(polyline.area for polyline in cut.polylines))
    assert cut.perimeter == pytest.approx(sum(polyline.length for polyline in cut.polylines))


def test_a_section_is_its_curves_and_true_without_any():
    cut = bumps().section((0, 0, 0.1), (0, 0, 1))
    assert list(cut) == list(cut.polylines)
    with pytest.warns(fh.FirsthitWarning, match="the plane cuts nothing"):
        nothing = bumps().section((0, 0, 9), (0, 0, 1))
    assert (len(nothing), list(nothing), bool(nothing)) == (0, [], True)


def test_transforms_and_several_objects_are_told_apart():
    scene = bumps()
    moved = np.eye(4)
    moved[0, 3] = 10
    scene.add(scene.objects[0].shape, transform=moved)
    cut = scene.section((0, 0, 0.1), (0, 0, 1))
    first, second = (
        [polyline for polyline in cut.polylines if polyline.object == k] for k in (0, 1)
    )
    assert len(first) == len(second) > 0
    for one, other in zip(first, second, strict=True):
        np.testing.assert_allclose(np.add(one.points, (10, 0, 0)), other.points, atol=1e-14)
        np.testing.assert_array_equal(one.primitives, other.primitives)


def test_files_say_what_the_section_says(tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    cut = bumps().section((0, 0, 0.1), (0.1, 0.2, 1))
    for name in ("svg", "dxf", "json"):
        cut.save(tmp_path / f"cut.{name}")
    said = json.loads((tmp_path / "cut.json").read_text())
    assert (said["area"], said["perimeter"]) == (cut.area, cut.perimeter)
    drawing = ezdxf.readfile(tmp_path / "cut.dxf")
    assert not drawing.audit().errors
    curves = drawing.modelspace().query("POLYLINE")
    for polyline, read, curve in zip(cut.polylines, said["polylines"], curves, strict=True):
        np.testing.assert_array_equal(read["points"], polyline.points)
        np.testing.assert_array_equal(read["points_2d"], polyline.points_2d)
        np.testing.assert_array_equal(read["primitives"], polyline.primitives)
        assert (read["area"], read["is_closed"]) == (polyline.area, polyline.is_closed)
        assert (curve.is_closed, curve.dxf.layer) == (polyline.is_closed, "object-0")
        corners = [tuple(vertex.dxf.location)[:2] for vertex in curve.vertices]
        np.testing.assert_array_equal(corners, polyline.points_2d)
    root = ET.parse(tmp_path / "cut.svg").getroot()
    (path,) = root.iter("{http://www.w3.org/2000/svg}path")
    assert path.get("d").count("M") == path.get("d").count("Z") == len(cut)
    first = path.get("d")[1:].split("L")[0].split()
    np.testing.assert_array_equal(np.float64(first), cut.polylines[0].points_2d[0] * (1, -1))
    with pytest.raises(ValueError, match=r"\.svg, \.dxf or \.json"):
        cut.save(tmp_path / "cut.pdf")


def test_only_the_objects_that_are_asked_for_are_cut():
    scene = bumps(name="first")
    scene.add(scene.objects[0].shape, name="second")
    scene.add(fh.Sphere((0, 0, 0), 1))
    cut = scene.section((0, 0, 0.1), (0, 0, 1), objects="second")
    assert ({curve.object for curve in cut}, cut.left_out) == ({1}, ())
    assert {curve.object for curve in pickle.loads(pickle.dumps(cut))} == {1}
    with pytest.raises(IndexError, match="no object 7"):
        scene.section((0, 0, 0), (0, 0, 1), objects=7)


def test_what_is_no_mesh_is_left_out_with_a_warning():
    scene = bumps()
    scene.add(fh.Sphere((0, 0, 0), 1), name="ball")
    with pytest.warns(fh.FirsthitWarning, match="not a mesh: object 1, 'ball'"):
        cut = scene.section((0, 0, 0), (0, 0, 1))
    assert cut.left_out == (1,)


@pytest.mark.parametrize("normal", [(0, 0, 0), (np.nan, 0, 1), (1, 2)])
def test_what_is_no_plane_is_refused(normal):
    with pytest.raises(ValueError, match="normal must be"):
        bumps().section((0, 0, 0), normal)


def test_sections_pickle():
    cut = bumps().section((0, 0, 0.1), (0, 0, 1))
    again = pickle.loads(pickle.dumps(cut))
    assert (again.area, len(again)) == (cut.area, len(cut))
    np.testing.assert_array_equal(again.polylines[0].points, cut.polylines[0].points)
