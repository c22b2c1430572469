"""The viewer in a real browser: `make test-browser` says where the program and the browser are."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import time
from typing import TYPE_CHECKING

import pytest
from selenium import webdriver
from selenium.webdriver.common.by import By

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from selenium.webdriver.remote.webelement import WebElement

PROGRAM = os.environ.get("FIRSTHIT", "firsthit")
BROWSER = shutil.which("chromium") or shutil.which("google-chrome") or ""
DRIVER = shutil.which("chromedriver") or ""
#: The browser asks nobody anything of its own.
QUIET = [
    "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
]  # fmt: skip
#: A picture is there in less; the rest is for a machine that is busy with other things.
PATIENCE = 30.0

CUBE = """v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1
o cube\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8
v 3 0 0\nv 4 0 0\nv 3 1 0\no <img src=x onerror=document.title='taken'>\nf 9 10 11
"""


class Viewer:
    """A running `firsthit view`."""

    def __init__(self, folder: Path, *arguments: str) -> None:
        """Start it and wait for the address that it prints."""
        command = [PROGRAM, "view", *arguments, "--no-browser"]
        self.folder = folder
        self.process = subprocess.Popen(
            command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        assert self.process.stdout is not None
        found = None
        while not found:
            line = self.process.stdout.readline()
            assert line, "it ended without an address"
            found = re.search(r"http://127\.0\.0\.1:(\d+)/#([0-9a-f]+)", line)
        self.address, self.port, self.token = found[0], int(found[1]), found[2]

    def stop(self) -> int:
        """Interrupt it; return its exit code."""
        self.process.send_signal(signal.SIGINT)
        with self.process:
            return self.process.wait(10)


class Page:
    """A page in the browser, and what is asked of it."""

    def __init__(self, driver: webdriver.Chrome) -> None:
        """Look at what the driver shows."""
        self.driver = driver

    def open(self, address: str) -> None:
        """Open the address and wait for the first picture."""
        self.driver.get("about:blank")
        self.driver.get(address)
        self.wait(lambda: self.data("ready") == "yes" and self.data("painted"))

    def wait(self, is_so: Callable[[], object], patience: float = PATIENCE) -> None:
        """Wait until a function says yes."""
        end = time.monotonic() + patience
        while not is_so():
            assert time.monotonic() < end, f"{self.message()!r}"
            time.sleep(0.02)

    def settle(self) -> None:
        """Wait until the picture is there in full size."""
        self.wait(lambda: self.data("busy") in {"refining", "no"})

    def finish(self) -> None:
        """Wait until the picture is as good as it gets."""
        self.wait(lambda: self.data("busy") == "no")

    def data(self, name: str) -> str | None:
        """Say what the page says of itself."""
        return self.driver.find_element(By.TAG_NAME, "body").get_attribute(f"data-{name}")

    def __getitem__(self, name: str) -> WebElement:
        """Find an element by its id."""
        return self.driver.find_element(By.ID, name)

    def message(self) -> str:
        """Read the line below the picture."""
        return self["message"].text

    def run(self, script: str, *arguments: object) -> object:
        """Run a script in the page."""
        return self.driver.execute_script(script, *arguments)

    def unfold(self) -> None:
        """Open all sections of the panel but the chapter."""
        self.run(
            "for (const part of document.querySelectorAll('details:not(#chapter)'))"
            "  part.open = true"
        )

    def choose(self, name: str, value: str) -> None:
        """Choose from a list, as a hand would."""
        self.run(
            "const list = document.getElementById(arguments[0]); list.value = arguments[1];"
            "list.dispatchEvent(new Event('input', {bubbles: true}));"
            "list.dispatchEvent(new Event('change', {bubbles: true}))",
            name,
            value,
        )

    def complaints(self) -> list[str]:
        """List what the browser's console says."""
        entries: list[dict[str, str]] = self.driver.get_log("browser")
        return [entry["message"] for entry in entries]


def browser(width: int = 1000, height: int = 700) -> webdriver.Chrome:
    """Start a browser with a window of that size."""
    options = webdriver.ChromeOptions()
    options.binary_location = BROWSER
    for argument in [*QUIET, f"--window-size={width},{height}"]:
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    return webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))


@pytest.fixture(scope="session")
def driver() -> Iterator[webdriver.Chrome]:
    """Share one browser between all tests."""
    driver = browser()
    yield driver
    driver.quit()


@pytest.fixture(scope="session")
def viewer(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Viewer]:
    """Serve a cube from -1 to 1 with a triangle beside it."""
    folder = tmp_path_factory.mktemp("cube")
    (folder / "cube.obj").write_text(CUBE)
    viewer = Viewer(folder, "cube.obj", "--size", "320x240")
    yield viewer
    assert viewer.stop() == 0


@pytest.fixture
def page(driver: webdriver.Chrome, viewer: Viewer) -> Page:
    """Open the cube's page anew."""
    page = Page(driver)
    driver.get("about:blank")
    driver.get(viewer.address)
    page.run("sessionStorage.clear()")
    page.open(viewer.address)
    page.complaints()
    page.unfold()
    return page
