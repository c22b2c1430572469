"""The page with other engines: as a file, with a file that is opened in it, and in a notebook."""

from __future__ import annotations

import base64
import gzip
import json
import subprocess
import sys
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import TYPE_CHECKING

import numpy as np
import pytest
from conftest import CUBE, PROGRAM, Page, Viewer
from PIL import Image
from test_view import camera, hover, line, pixels, shape

if TYPE_CHECKING:
    from pathlib import Path

    from selenium import webdriver

SQUARE = "o lonely\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"


def made(folder: Path, *arguments: str) -> Path:
    """Write a report of the cube."""
    (folder / "cube.obj").write_text(CUBE)
    command = [PROGRAM, "view", "cube.obj", "-o", "cube.html", *arguments]
    told = subprocess.run(command, cwd=folder, check=False, capture_output=True, text=True)
    assert told.returncode == 0, told.stderr
    return folder / "cube.html"


@pytest.fixture
def report(driver: webdriver.Chrome, tmp_path: Path) -> Page:
    """Open a report of the cube, from its file."""
    path = made(tmp_path, "--size", "320x240")
    page = Page(driver)
    page.open(path.as_uri())
    page.unfold()
    return page


def test_a_report_asks_nobody_for_anything(report: Page) -> None:
    address = report.driver.current_url
    report.driver.get_log("performance")
    report.complaints()
    report.open(address)
    report.finish()
    assert report.complaints() == []
    entries: list[dict[str, str]] = report.driver.get_log("performance")
    messages = [json.loads(entry["message"])["message"] for entry in entries]
    requests = [
        m["params"]["request"] for m in messages if m["method"] == "Network.requestWillBeSent"
    ]
    urls = {request["url"] for request in requests}
    assert address in urls
    assert {url for url in urls if not url.startswith(("data:", "blob:"))} == {address}
    # Its policy would not let it.
    refused = report.driver.execute_async_script(
        "const done = arguments[0];"
        "fetch('http://127.0.0.1:9/').then(() => done('sent'), (error) => done(String(error)))"
    )
    assert "Failed to fetch" in refused
    assert any("Content Security Policy" in said for said in report.complaints())


def test_a_report_s_picture_and_hits_are_the_program_s(report: Page, tmp_path: Path) -> None:
    report.finish()
    asked = camera(report)
    again = ["render", "cube.obj", *asked, "-o", "again.png", "-q"]
    subprocess.run([PROGRAM, *again], cwd=tmp_path, check=True)
    rendered = np.asarray(Image.open(tmp_path / "again.png").convert("RGB"))
    assert np.array_equal(pixels(report), rendered)
    rows, columns = shape(report)
    told = hover(report, rows // 2, columns // 2)
    probe = ["probe", "cube.obj", *asked, "--pixel", f"{rows // 2},{columns // 2}", "--json"]
    said = subprocess.run([PROGRAM, *probe], cwd=tmp_path, check=True, capture_output=True)
    hit = json.loads(said.stdout)["hit"]
    assert float(line(told, "t")) == hit["t"]
    assert line(told, "object") == f"cube ({hit['object']})"


def test_a_worker_that_fails_is_said(driver: webdriver.Chrome, tmp_path: Path) -> None:
    path = made(tmp_path)
    text = path.read_text()
    start = text.index('id="report-module"')
    start, end = text.index(">", start) + 1, text.index("</script>", start)
    module = gzip.decompress(base64.b64decode(text[start:end]))
    # A module that ends in the middle.
    cut = base64.b64encode(gzip.compress(module[: len(module) // 2])).decode()
    path.write_text(text[:start] + cut + text[end:])
    page = Page(driver)
    driver.get(path.as_uri())
    page.wait(lambda: "error" in str(page["message"].get_attribute("class")))
    assert "WebAssembly" in page.message()


def test_names_in_a_report_are_text(driver: webdriver.Chrome, tmp_path: Path) -> None:
    name = "</script><img src=x onerror=alert(1)>"
    folder = tmp_path / "a"
    folder.mkdir()
    made(folder)
    (folder / "hostile.obj").write_text(SQUARE.replace("lonely", name))
    subprocess.run([PROGRAM, "view", "hostile.obj", "-o", "a.html"], cwd=folder, check=True)
    page = Page(driver)
    page.open((folder / "a.html").as_uri())
    page.unfold()
    assert page["objects"].text.splitlines()[0].startswith(name)
    assert page["objects"].find_elements("css selector", "img") == []


def test_a_file_is_read_in_the_page(page: Page, viewer: Viewer, tmp_path: Path) -> None:
    opened(page, tmp_path / "square.obj", SQUARE)
    page.driver.get_log("performance")
    page.wait(lambda: page["title"].text == "square.obj")
    page.finish()
    page.unfold()
    rows, columns = shape(page)
    assert line(hover(page, rows // 2, columns // 2), "object") == "lonely (0)"
    # A bad file is said, and changes nothing.
    said = opened(page, tmp_path / "bad.obj", "v 0 0\n")
    assert said.startswith("bad.obj:1: ")
    assert page["title"].text == "square.obj"
    # The server was told that the page is there, and nothing else.
    entries: list[dict[str, str]] = page.driver.get_log("performance")
    messages = [json.loads(entry["message"])["message"] for entry in entries]
    sent = [m["params"]["request"] for m in messages if m["method"] == "Network.requestWillBeSent"]
    posts = [request for request in sent if request["method"] == "POST"]
    assert {(post["url"], post["postData"]) for post in posts} <= {
        (f"http://127.0.0.1:{viewer.port}/alive", "{}")
    }


def opened(page: Page, path: Path, content: str) -> str:
    """Open a file as a hand would; return what the page says, if it has an error."""
    path.write_text(content)
    page["open-file"].send_keys(str(path))
    before = page["title"].text

    def error() -> str:
        is_error = "error" in str(page["message"].get_attribute("class"))
        return page.message() if is_error else ""

    page.wait(lambda: error() or page["title"].text != before)
    return error()


def test_an_executed_notebook_shows_the_scene(driver: webdriver.Chrome, tmp_path: Path) -> None:
    pytest.importorskip("firsthit")
    nbformat = pytest.importorskip("nbformat")
    code = [
        "import firsthit as fh\nscene = fh.Scene()\nscene.add(fh.Box((-1, -1, -1), (1, 1, 1)))",
        "scene",
        "scene.view(title='boxed')",
        "fh.render(scene, fh.Camera.framing(scene, rows=40, columns=60))",
    ]
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in code])
    nbformat.write(notebook, tmp_path / "box.ipynb")
    convert = [sys.executable, "-m", "nbconvert", "--execute", "--to", "html", "box.ipynb"]
    subprocess.run(convert, cwd=tmp_path, check=True, capture_output=True)
    page = Page(driver)
    driver.get((tmp_path / "box.html").as_uri())
    pictures = driver.find_elements("css selector", "img[src^='data:image/png']")
    # The scene's, the one behind the page, and the frame's.
    assert len(pictures) == 3
    assert all(picture.get_property("naturalWidth") > 0 for picture in pictures)
    frame = driver.find_element("css selector", "iframe")
    # Browsers draw no frame that is out of sight.
    driver.execute_script("arguments[0].scrollIntoView()", frame)
    driver.switch_to.frame(frame)
    try:
        page.wait(lambda: page.data("ready") == "yes" and page.data("painted"))
        page.finish()
        assert page["title"].text == "boxed"
        assert len(np.unique(pixels(page))) > 5
    finally:
        driver.switch_to.default_content()


#: A notebook's side of a widget: it hands messages on to a server of this test.
HOST = """<!doctype html><title>host</title><main></main><script type="module">
import widget from "./widget.js";
let answer = null;
const page = await (await fetch("page")).text();
const model = {
    get: (name) => ({ page, height: 500 })[name],
    on: (_, act) => { answer = act; },
    off: () => { answer = null; },
    async send(message) {
        const reply = await fetch("ask", { method: "POST", body: JSON.stringify(message) });
        const pixels = await reply.arrayBuffer();
        const told = JSON.parse(decodeURIComponent(reply.headers.get("X-Message")));
        answer?.(told, pixels.byteLength ? [new DataView(pixels)] : []);
    },
};
widget.render({ model, el: document.querySelector("main") });
</script>"""


def test_a_notebook_s_kernel_answers_its_page(driver: webdriver.Chrome) -> None:
    fh = pytest.importorskip("firsthit")
    widgets = pytest.importorskip("firsthit._view.widget")
    from urllib.parse import quote

    scene = fh.Scene()
    scene.add(fh.Box((-1, -1, -1), (1, 1, 1)), name="box")
    widget = widgets.PageWidget(scene.view(title="boxed", engine="kernel")._viewer, 500, "1")
    told: list[tuple[dict[str, object], list[bytes]]] = []
    widget.send = lambda message, buffers=(): told.append((message, list(buffers)))
    turn = threading.Lock()

    class Host(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            files = {"/": (HOST, "text/html"), "/widget.js": (widgets._FRAME, "text/javascript")}
            text, kind = files.get(self.path, (widget.page, "text/plain"))
            self.reply(text.encode(), kind, "")

        def do_POST(self) -> None:
            asked = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
            with turn:
                widget._answer(widget, asked, [])
                message, buffers = told.pop()
            self.reply(b"".join(buffers), "application/octet-stream", quote(json.dumps(message)))

        def reply(self, body: bytes, kind: str, message: str) -> None:
            self.send_response(200)
            self.send_header("Content-Type", f"{kind}; charset=utf-8")
            self.send_header("Content-Length", str(len(body)))
            self.send_header("X-Message", message)
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_: object) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Host)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        page = Page(driver)
        driver.get(f"http://127.0.0.1:{server.server_port}/")
        page.wait(lambda: driver.find_elements("css selector", "iframe"))
        driver.switch_to.frame(driver.find_element("css selector", "iframe"))
        page.wait(lambda: page.data("ready") == "yes" and page.data("painted"))
        page.finish()
        assert page["title"].text == "boxed"
        assert len(np.unique(pixels(page))) > 5
        page.unfold()
        rows, columns = shape(page)
        assert line(hover(page, rows // 2, columns // 2), "object") == "box (0)"
    finally:
        driver.switch_to.default_content()
        server.shutdown()
        server.server_close()
