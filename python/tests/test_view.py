"""The viewer's page from Python: its server, its numbers, and its end."""

import gc
import json
import socket
import subprocess
import sys
import time

import firsthit as fh
import numpy as np
import pytest
from firsthit._view import view as viewing
from page_support import ask
from support import ball


def scene():
    scene = ball()
    scene.add(fh.Box((1.5, -1, -1), (2.5, 1, 1)), name="box")
    return scene


def test_the_page_s_picture_is_render_s(tmp_path):
    camera = fh.Camera.look_at((3, -6, 3), (0.5, 0, 0), (0, 0, 1), 40, 40, 60)
    for options in [{}, {"light": "headlight", "ground": False}, {"shade": "normal"}]:
        with fh.view(scene(), camera, browser=False, **options) as page:
            first = json.loads(ask(page, "/info", {}))["camera"]
            got = ask(page, "/frame", {"camera": first, "is_lit": True})
        fh.render(scene(), camera, **options).save(tmp_path / "a.png")
        assert got == (tmp_path / "a.png").read_bytes(), options


def test_a_camera_that_is_copied_is_the_same():
    camera = fh.Camera((1 / 3, -5, 2), (0.1, 2, -0.7), (0, 0.1, 1), 0.3, 0.4, 0.3, 30, 40)
    with fh.view(scene(), camera, browser=False) as page:
        first = json.loads(ask(page, "/info", {}))["camera"]
        said = json.loads(ask(page, "/camera", {"camera": first}))
    again = eval(said["python"], {"fh": fh})
    for got, expected in zip(again.rays(), camera.rays(), strict=True):
        assert np.array_equal(got, expected)


def test_a_pixel_is_explained():
    camera = fh.Camera.look_at((0, -6, 0), (0, 0, 0), (0, 0, 1), 40, 41, 41)
    with fh.view(scene(), camera, title="two", browser=False) as page:
        info = json.loads(ask(page, "/info", {}))
        told = json.loads(ask(page, "/probe", {"camera": info["camera"], "pixel": [20, 20]}))
    assert (info["title"], info["objects"][1]["name"]) == ("two", "box")
    assert told["hit"]["t"] == scene().explain(camera, pixel=(20, 20)).hit["t"]


def test_the_port_is_free_after_the_end():
    page = fh.view(scene(), browser=False)
    port = int(page.address.split(":")[2].split("/")[0])
    assert repr(page) == f"View('scene', http://127.0.0.1:{port}/, running)"
    assert page.address not in repr(page)
    assert page.address in page._repr_html_()
    with pytest.raises(OSError, match=f"port {port}"):
        fh.view(scene(), port=port, browser=False)
    page.stop()
    page.stop()
    assert "stopped" in repr(page)
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.1", port))
    with fh.view(scene(), port=port, browser=False) as again:
        assert f":{port}/" in again.address


def test_a_page_that_nobody_holds_goes_on():
    address = fh.view(scene(), browser=False).address
    gc.collect()
    pages = [page for page in viewing._RUNNING if page.address == address]
    assert len(pages) == 1
    assert json.loads(ask(pages[0], "/info", {}))["object_count"] == 2
    pages[0].stop()
    assert pages[0] not in viewing._RUNNING


def test_what_makes_no_sense_is_refused():
    with pytest.raises(TypeError, match="Scene"):
        fh.view("part.stl", browser=False)
    with pytest.raises(TypeError, match="Camera"):
        fh.view(scene(), fh.RaySensor(np.zeros((1, 1, 3)), np.ones((1, 1, 3))), browser=False)
    with pytest.raises(TypeError, match="function"):
        fh.view(scene(), shade=lambda *_: 0, browser=False)
    for port in (-1, 65536, 1.5, True):
        with pytest.raises(ValueError, match="port"):
            fh.view(scene(), port=port, browser=False)


@pytest.mark.skipif(sys.platform == "win32", reason="signals are Unix's")
def test_ctrl_c_ends_the_wait(tmp_path):
    script = tmp_path / "look.py"
    script.write_text(
        "import firsthit as fh\n"
        "scene = fh.Scene()\nscene.add(fh.Sphere((0, 0, 0), 1))\n"
        "page = fh.view(scene, browser=False)\n"
        "print(page.address, flush=True)\npage.wait()\nprint('over')\n"
    )
    command = [sys.executable, script]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline().startswith("http://127.0.0.1:")
        time.sleep(0.1)
        process.send_signal(2)
        assert process.communicate(timeout=20)[0] == "over\n"
    assert process.returncode == 0
