"""The viewer in notebooks, and as a file."""

import html
import json
import re

import firsthit as fh
import pytest
from firsthit._view import notebook
from page_support import ask as ask_server


def scene():
    scene = fh.Scene()
    scene.add(fh.Box((-1, -1, -1), (1, 1, 1)), name="box")
    return scene


def test_what_a_notebook_shows_is_the_file_that_is_saved(tmp_path):
    view = scene().view(title="<b>box</b>", engine="page", height=300)
    shown = view._repr_html_()
    assert "<b>" not in shown
    # Where no script runs: a picture.
    assert shown.index("data:image/png;base64,") < 300
    assert "height:300px" in shown
    [inside] = re.findall(r'srcdoc="([^"]*)"', shown)
    view.save(tmp_path / "box.html")
    assert html.unescape(inside) == (tmp_path / "box.html").read_text()


def test_only_pages_are_saved(tmp_path):
    with pytest.raises(ValueError, match=r"must end in \.html"):
        scene().view().save(tmp_path / "box.png")


def test_a_kernel_answers_as_the_server_does():
    widget = pytest.importorskip("firsthit._view.widget")
    page = widget.PageWidget(scene().view(engine="kernel", title="box")._viewer, 300, "1")
    told = []
    page.send = lambda message, buffers=(): told.append((message, buffers))

    def ask(question, about):
        asked = {"own": "me", "id": 7, "question": question, "about": json.dumps(about)}
        page._answer(page, asked, [])
        message, buffers = told.pop()
        assert (message.pop("own"), message.pop("id")) == ("me", 7)
        return message, buffers

    camera = json.loads(ask("info", {})[0]["json"])["camera"] | {"rows": 30, "columns": 40}
    message, buffers = ask("frame", {"camera": camera, "is_lit": True})
    assert json.loads(message["json"])["rows"] == 30
    with fh.view(scene(), title="box", browser=False) as served:
        assert buffers[0] == ask_server(served, "/frame", {"camera": camera, "is_lit": True})
    assert ask("probe", {"camera": camera, "pixel": [99, 0]})[0]["error"].startswith("pixel ")
    assert "there is no question" in ask("open", {})[0]["error"]
    page._answer(page, {"id": 8}, [])
    assert "question" in told.pop()[0]["error"]


def test_the_kernel_takes_anywidget(monkeypatch):
    monkeypatch.setattr(notebook, "has_widgets", lambda: False)
    assert scene().view().engine == "page"
    with pytest.raises(ImportError, match=r"pip install anywidget"):
        scene().view(engine="kernel")


def test_large_scenes_stay_with_the_kernel(monkeypatch):
    monkeypatch.setattr(notebook, "has_widgets", lambda: True)
    monkeypatch.setattr(notebook, "_MOST_TRIANGLES", 0)
    large = scene()
    large.add(fh.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]))
    assert large.view().engine == "kernel"
    assert large.view(engine="page").engine == "page"
    assert scene().view().engine == "page"


def test_what_makes_no_sense_is_refused():
    for options in [{"engine": "gpu"}, {"height": 0}, {"height": True}, {"light": "moon"}]:
        with pytest.raises(ValueError, match=r"engine|height|light"):
            scene().view(**options)
    with pytest.raises(TypeError, match="Camera"):
        scene().view("front")


def test_a_scene_is_a_picture():
    shown = scene()._repr_html_()
    assert shown.startswith('<img alt="Scene(1 object, 0 triangles)" src="data:image/png;base64,')
    # Whatever there is to see.
    assert fh.Scene()._repr_html_().endswith("<p>Scene(0 objects, 0 triangles)</p>")
    endless = fh.Scene()
    endless.add(fh.Plane((0, 0, 0), (0, 0, 1)))
    assert endless._repr_html_().endswith("<p>Scene(1 object, 0 triangles)</p>")


def test_a_kernel_s_view_is_a_picture_where_a_notebook_is_converted():
    pytest.importorskip("anywidget")
    nbformat, nbconvert = pytest.importorskip("nbformat"), pytest.importorskip("nbconvert")
    from IPython.core.interactiveshell import InteractiveShell
    from IPython.utils.capture import RichOutput, capture_output

    InteractiveShell.instance()
    with capture_output() as said:
        scene().view(engine="kernel")._ipython_display_()
    assert [type(each) for each in said.outputs] == [RichOutput] * 2
    picture, page = (each.data for each in said.outputs)
    assert "application/vnd.jupyter.widget-view+json" in page
    assert len(picture["text/html"]) < 1_000_000
    outputs = [nbformat.v4.new_output("display_data", each) for each in (picture, page)]
    cell = nbformat.v4.new_code_cell("scene.view()", outputs=outputs)
    text, _ = nbconvert.HTMLExporter().from_notebook_node(nbformat.v4.new_notebook(cells=[cell]))
    assert 'src="data:image/png;base64,' in text


def test_a_page_s_view_has_no_outputs_of_its_own():
    with pytest.raises(NotImplementedError):
        scene().view(engine="page")._ipython_display_()
