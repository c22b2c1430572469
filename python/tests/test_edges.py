"""Lines along edges."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import firsthit as fh
import numpy as np
import pytest

if TYPE_CHECKING:
    from pathlib import Path

ROWS, COLUMNS = 60, 80


def scene() -> fh.Scene:
    made = fh.Scene()
    made.add(fh.Box((-1, -1, -1), (1, 1, 1)))
    return made


def camera() -> fh.Camera:
    return fh.Camera.look_at((5, -4, 3), (0, 0, 0), (0, 0, 1), 40, rows=ROWS, columns=COLUMNS)


def test_a_number_is_the_width_of_the_usual_lines() -> None:
    one = fh.render(scene(), camera(), channels=("color", "edge"), edges=2.5)
    other = fh.render(scene(), camera(), channels=("color", "edge"), edges=fh.Edges(width=2.5))
    for name in ("color", "edge"):
        np.testing.assert_array_equal(one[name], other[name])
    assert one["edge"].dtype == np.float32
    assert one["edge"].shape == (ROWS, COLUMNS)


@pytest.mark.parametrize("samples", [1, 3])
def test_lines_are_over_the_colours_of_shaders_and_of_functions(samples: int) -> None:
    red = fh.Edges(width=2, color="red")
    everything = {"channels": ("color", "edge"), "samples": samples, "edges": red}
    for shade in ("unlit", lambda hits: np.full((*hits.t.shape, 3), 0.25)):
        plain = fh.render(scene(), camera(), samples=samples, shade=shade)["color"]
        drawn = fh.render(scene(), camera(), shade=shade, **everything)
        share = drawn["edge"][..., np.newaxis]
        expected = (1 - share) * plain + share * np.array([1, 0, 0])
        np.testing.assert_allclose(drawn["color"], expected, atol=1e-6)
        assert share.max() == 1


def test_a_region_is_that_part_of_the_whole() -> None:
    whole = fh.render(scene(), camera(), channels="edge", edges=fh.Edges(hidden=(3, 2)))
    part = np.s_[7:51, 20:63]
    made = fh.render(scene(), camera(), channels="edge", edges=fh.Edges(hidden=(3, 2)), region=part)
    np.testing.assert_array_equal(made["edge"], whole["edge"][part])


def test_a_scene_says_what_lines_its_pictures_have_and_files_keep_it(tmp_path: Path) -> None:
    made = scene()
    assert made.edges is None
    made.edges = fh.Edges(
        width=0.5, angle=20, kinds=("crease", "object"), hidden=True, color="blue"
    )
    assert made.edges.hidden == (6, 4)
    without = fh.render(made, camera(), edges=False)
    np.testing.assert_array_equal(without["color"], fh.render(scene(), camera())["color"])
    picture = fh.render(made, camera(), channels="edge")
    explicit = fh.render(scene(), camera(), channels="edge", edges=made.edges)
    np.testing.assert_array_equal(picture["edge"], explicit["edge"])
    made.save(tmp_path / "scene.fhs")
    assert fh.open(tmp_path / "scene.fhs").edges == made.edges
    text = "[edges]\nwidth = 2\nkinds = ['object']\n"
    text += "[[objects]]\nshape = 'sphere'\ncenter = [0, 0, 0]\nradius = 1\n"
    (tmp_path / "scene.toml").write_text(text)
    assert fh.load(tmp_path / "scene.toml").edges == fh.Edges(width=2, kinds="object")
    # A lidar has none; it is no reason to refuse it.
    sensor = fh.RaySensor(np.zeros((1, 1, 3)), np.ones((1, 1, 3)))
    fh.render(made, sensor)
    with pytest.raises(ValueError, match="edges must be left out for a sensor that is no camera"):
        fh.render(made, sensor, edges=1)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"width": 0}, "a width above 0 and up to 1000 pixels, got 0"),
        ({"width": math.nan}, "a width above 0 and up to 1000 pixels, got NaN"),
        ({"angle": 200}, "edge angle must be from 0 to 180 degrees, got 200"),
        ({"kinds": "ridge"}, "kinds must be one of silhouette, .*, got 'ridge'"),
        ({"kinds": 5}, "kinds must be a sequence, got 5"),
        ({"kinds": ()}, "edge kinds must be at least one, got none"),
        ({"hidden": (1, 2, 3)}, "hidden must be True, False, or a dash and a gap"),
        ({"hidden": 3}, "hidden must be a sequence, got 3"),
        ({"hidden": (1, 0)}, "hidden edges must be finite dashes and gaps of at least 0.1 pixels"),
        ({"color": "reddish"}, "color must be"),
    ],
)
def test_what_cannot_be_drawn_is_refused(values: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        fh.Edges(**values)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="edges must be an Edges or None"):
        scene().edges = 3  # type: ignore[assignment]
