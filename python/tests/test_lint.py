"""Defects of meshes, beside trimesh."""

import pickle

import firsthit as fh
import numpy as np
import pytest
from support import bumpy_sphere

CORNERS = [[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2]]
FACES = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]


def of(points, triangles):
    scene = fh.Scene()
    scene.add(fh.Mesh(points, triangles))
    return scene.lint()


def test_clean_and_open_meshes_are_what_trimesh_says():
    trimesh = pytest.importorskip("trimesh")
    points, triangles = bumpy_sphere(16, 2)
    rng = np.random.default_rng(5)
    for dropped in (0, 1, 9):
        kept = np.sort(rng.permutation(len(triangles))[dropped:])
        faces = triangles[kept]
        other = trimesh.Trimesh(points, faces, process=False)
        report = of(points, faces)
        assert report.is_clean == other.is_watertight == (dropped == 0)
        edges, uses = np.unique(other.edges_sorted, axis=0, return_counts=True)
        found = {finding.kind: finding.count for finding in report}
        assert found.get("hole", 0) == np.sum(uses == 1)
        assert len(edges) > 0


def test_findings_have_places():
    report = of(CORNERS, FACES[:3])
    (hole,) = report.findings
    assert (hole.kind, hole.count, hole.note) == ("hole", 3, "around 1 hole")
    identifier, primitive, position = hole.places[0]
    assert (identifier, primitive, position.tolist()) == (0, 0, [0.0, 1.0, 0.0])
    with pytest.raises(ValueError, match="read-only"):
        position += 1
    assert hole.kind in report.kinds
    assert set(report.checked) == set(report.kinds)
    np.testing.assert_array_equal(report.marked(0), [True, True, True])
    assert repr(report) == "LintReport(hole: 3)"
    assert (len(report), list(report)) == (1, [hole])
    clean = of(CORNERS, FACES)
    assert (len(clean), list(clean)) == (0, [])
    for either in (clean, report):
        with pytest.raises(TypeError, match="ask for its is_clean"):
            bool(either)
    with pytest.raises(IndexError, match="there is no object 1"):
        report.marked(1)


def test_triangles_are_marked_by_an_object_s_name_too():
    scene = fh.Scene()
    scene.add(fh.Mesh(CORNERS, FACES), name="whole")
    scene.add(fh.Mesh(CORNERS, FACES[:3]), name="open")
    scene.add(fh.Sphere((0, 0, 0), 1), name="ball")
    report = scene.lint()
    assert report.marked("open").tolist() == report.marked(np.int32(1)).tolist() == [True] * 3
    assert not report.marked("whole").any()
    with pytest.raises(IndexError, match="'ball' is no mesh"):
        report.marked("ball")
    with pytest.raises(ValueError, match="no object with the name 'shut'"):
        report.marked("shut")


def test_kinds_are_ignored_by_name():
    scene = fh.Scene()
    scene.add(fh.Mesh(CORNERS, FACES[:3]))
    assert scene.lint(ignore=["hole"]).is_clean
    assert [len(finding.places) for finding in scene.lint(places=1)] == [1]
    with pytest.raises(ValueError, match="got leak"):
        scene.lint(ignore=["leak"])
    with pytest.raises(TypeError, match="several names"):
        scene.lint(ignore="hole")


def test_files_are_read_and_marked(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    flipped = [*FACES[:3], FACES[3][::-1]]
    trimesh.Trimesh(CORNERS, flipped, process=False).export(tmp_path / "part.ply")
    report = fh.lint(tmp_path / "part.ply")
    assert [(finding.kind, finding.count) for finding in report] == [("winding", 3)]
    report.save(tmp_path / "marked.ply")
    marked = trimesh.load(tmp_path / "marked.ply", process=False)
    np.testing.assert_array_equal(marked.vertices[marked.faces], np.float64(CORNERS)[flipped])
    assert (marked.visual.face_colors[:, :3] == [230, 200, 20]).all()
    with pytest.raises(ValueError, match=r"\.ply"):
        report.save(tmp_path / "marked.stl")


def test_lengths_of_a_file_are_in_the_unit_that_is_said(tmp_path):
    lines = [*("v {} {} {}".format(*corner) for corner in CORNERS)]
    lines += ["f {} {} {}".format(*(k + 1 for k in face)) for face in FACES]
    (tmp_path / "part.obj").write_text("\n".join(lines))
    assert fh.lint(tmp_path / "part.obj").is_clean
    small = fh.lint(tmp_path / "part.obj", units="um", scale=2.0, build="fast")
    assert [finding.kind for finding in small] == ["units"]
    with pytest.raises(ValueError, match="variant must be one of the file's"):
        fh.lint(tmp_path / "part.obj", variant="red", resources=tmp_path)


def test_what_is_about_the_whole_scene_is_about_no_object():
    (units,) = of(np.multiply(CORNERS, 1e-4), FACES).findings
    assert units.kind == "units"
    assert units.places[0][:2] == (None, None)


def test_reports_pickle():
    report = of(CORNERS, FACES[:3])
    assert pickle.loads(pickle.dumps(report)).findings == report.findings


def test_files_are_taken_alike_and_several_have_a_report_each(tmp_path):
    whole, holed = tmp_path / "whole.ply", tmp_path / "holed.ply"
    fh.Mesh(CORNERS, FACES).save(whole)
    fh.Mesh(CORNERS, FACES[:3]).save(holed)
    assert fh.lint(whole).is_clean
    assert fh.lint(str(whole)).is_clean
    reports = fh.lint([whole, str(holed)], ignore=["units"])
    assert [report.is_clean for report in reports] == [True, False]
    assert fh.lint(iter(())) == ()


def test_a_stop_iteration_of_the_callers_is_no_end_of_the_files(tmp_path):
    """It was taken for one, and the findings were lost without a word."""
    scene = fh.Scene()
    scene.add(fh.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]))
    scene.save(tmp_path / "part.fhs")

    def stop(done, total):
        raise StopIteration

    with pytest.raises(StopIteration):
        fh.lint([tmp_path / "part.fhs"], progress=stop)
