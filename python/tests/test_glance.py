"""Answers as notebooks show them, at one glance."""

import base64
import re

import firsthit as fh
import numpy as np
import pytest


@pytest.fixture
def scene():
    scene = fh.Scene()
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    scene.add(fh.Mesh(corners, faces), name="<b>corner</b>")
    scene.add(fh.Mesh(np.add(corners, [3, 0, 0]), faces[:1] + faces[2:]), name="open")
    return scene


@pytest.fixture
def camera(scene):
    return fh.Camera.framing(scene, rows=30, columns=700)


def pictures(shown):
    """The sizes of the pictures, rows and columns, as their files say."""
    found = re.findall(r'src="data:image/png;base64,([^"]+)"', shown)
    heads = [base64.b64decode(each)[16:24] for each in found]
    return [(int.from_bytes(head[4:]), int.from_bytes(head[:4])) for head in heads]


def cells(shown):
    """The table, as names and what is said of them."""
    return dict(re.findall(r"<th[^>]*>([^<]*)</th><td[^>]*>([^<]*)</td>", shown))


def test_names_of_files_are_text(scene, camera):
    for each in (scene.shoot(camera), fh.render(scene, camera, samples=1), scene.lint()):
        assert "<b>" not in each._repr_html_()


def test_hits_have_ranges_objects_and_pictures_that_are_small(scene, camera):
    hits = scene.shoot(camera)
    shown = hits._repr_html_()
    assert pictures(shown) == [(10, 234), (10, 234)]
    told = cells(shown)
    near, far = hits.t[np.isfinite(hits.t)].min(), hits.t[np.isfinite(hits.t)].max()
    assert told["t"] == f"{near:.6g} to {far:.6g}"
    assert told["object 1"] == f"open: {(hits.object == 1).sum():,} rays"


@pytest.mark.parametrize("shape", [(3,), (0, 3), (0, 4, 3)])
def test_one_ray_few_and_none_have_no_picture(scene, shape):
    assert pictures(scene.shoot(np.ones(shape), (0, 0, -1.0))._repr_html_()) == []


def test_of_many_objects_the_most_frequent_are_told():
    scene = fh.Scene()
    for k in range(20):
        scene.add(fh.Sphere((k, 0, 0), 0.4), name=f"ball {k}")
    x = np.concatenate([np.arange(20), np.full(5, 7)])
    told = cells(scene.shoot(np.stack([x, 0 * x, 0 * x + 9], -1), (0, 0, -1))._repr_html_())
    assert list(told) == ["t", "object 7", *(f"object {k}" for k in range(7)), ""]
    assert told["object 7"] == "ball 7: 6 rays"
    assert told[""] == "and 12 more objects"


def test_a_frame_has_its_picture_and_the_ranges_of_its_channels(scene, camera):
    frame = fh.render(scene, camera, channels=("color", "z", "object"), samples=1)
    shown = frame._repr_html_()
    assert pictures(shown) == [(30, 700)]
    assert cells(shown)["object"] == "int32 -1 to 1"
    assert cells(shown)["z"].startswith("float64 ")
    assert "inf" not in cells(shown)["z"]


def test_a_section_is_drawn_with_its_open_curves_apart(scene):
    with pytest.warns(fh.FirsthitWarning, match="1 of 2 curves is open"):
        shown = scene.section((0, 0, 0.25), (0, 0, 1))._repr_html_()
    closed = re.findall(r'<path d="([^"]*)"[^>]*fill-rule="evenodd"', shown)
    curves = re.findall(r'<path d="([^"]*)" fill="none"', shown)
    assert [each.count("Z") for each in closed] == [1]
    assert [each.count("Z") for each in curves] == [0]
    # 0 to 3.75 is drawn from 4 to 324, and of two objects as high as wide each is a fifth of it.
    numbers = np.array(re.findall(r"[\d.]+", closed[0] + curves[0]), float).reshape(-1, 2)
    assert numbers.min(axis=0) == pytest.approx([4, 4])
    assert numbers.max(axis=0) == pytest.approx([324, 4 + 0.75 / 3.75 * 320], abs=0.01)
    assert cells(shown)["area"] == "0.28125"


def test_a_section_of_nothing_has_no_drawing(scene):
    with pytest.warns(fh.FirsthitWarning, match="cuts nothing"):
        nothing = scene.section((0, 0, 9), (0, 0, 1))
    assert "<svg" not in nothing._repr_html_()


def test_lint_tells_kinds_and_first_places(scene):
    assert cells(scene.lint()._repr_html_())["hole"].startswith("3, the first at ")
    scene.remove(1)
    assert list(cells(scene.lint()._repr_html_())) == ["clean"]


def test_a_scan_is_a_picture_of_its_ranges(scene):
    lidar = fh.Lidar.spinning(range(-60, 61, 10), columns=36, position=(0.2, 0.2, 0.2))
    scan = lidar.scan(scene)
    assert pictures(scan._repr_html_()) == [(13, 36)]
    assert cells(scan._repr_html_())["objects"] == "1"
    none = lidar.scan(scene, dropout=1.0, seed=1)
    assert len(none) == 0
    assert pictures(none._repr_html_()) == []


def test_a_channel_is_plotted_with_its_unit_and_without_misses(scene, camera):
    pyplot = pytest.importorskip("matplotlib.pyplot")
    pyplot.switch_backend("agg")
    hits = scene.shoot(camera)
    axes = hits.plot("z")
    (image,) = axes.images
    shown = image.get_array()
    assert (shown.mask == np.isinf(hits.z)).all()
    assert (shown.compressed() == hits.z[np.isfinite(hits.z)]).all()
    assert image.colorbar.ax.get_ylabel() == "z (scene units)"
    # Row 0 is at the top.
    assert axes.get_ylim() == (29.5, -0.5)
    frame = fh.render(scene, camera, channels=("color", "object"), samples=1)
    assert frame.plot("object", ax=axes) is axes
    assert (axes.images[1].get_array().mask == (frame["object"] < 0)).all()
    found = [label.get_text() for label in axes.images[1].colorbar.ax.get_yticklabels()]
    assert found == [str(each) for each in np.unique(frame["object"]) if each >= 0]
    far = fh.Frame((1, 3), {"t": np.array([[1.0, 2.0, 4800.0]])})
    assert type(far.plot("t").images[0].norm).__name__ == "LogNorm"
    with pytest.raises(ValueError, match=r"color must have rows and columns of one number each"):
        frame.plot("color")
    with pytest.raises(ValueError, match=r"got the shape \(2,\)"):
        scene.shoot([[0, 0, 9], [1, 0, 9]], [0, 0, -1]).plot("t")
    with pytest.raises(KeyError, match="no channel 'z'"):
        frame.plot("z")


def test_a_plot_without_matplotlib_says_what_is_missing(scene, camera, without):
    without("matplotlib")
    with pytest.raises(ImportError, match="plot takes the package matplotlib"):
        scene.shoot(camera).plot("t")


def test_many_objects_are_a_line_and_a_short_table():
    scene = fh.Scene()
    assert repr(scene.objects) == "Objects(0)"
    for k in range(1000):
        scene.add(fh.Sphere((k, 0, 0), 1), name=f"<b>{k}</b>")
    objects = scene.objects
    assert isinstance(objects, tuple)
    assert objects == tuple(objects)
    assert repr(objects) == (
        "Objects(1,000: '<b>0</b>', '<b>1</b>', '<b>2</b>', '<b>3</b>', '<b>4</b>', and 995 more)"
    )
    shown = objects._repr_html_()
    assert "<b>" not in shown
    assert len(cells(shown)) == 9
    assert cells(shown)[""] == "and 992 more"
