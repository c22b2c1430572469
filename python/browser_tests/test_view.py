"""The viewer's page, as a hand and an eye have it."""

from __future__ import annotations

import base64
import json
import subprocess
import threading
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from conftest import PROGRAM, Page, Viewer
from PIL import Image
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.actions.wheel_input import ScrollOrigin
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from selenium import webdriver

Shape = tuple[int, int]


def program(viewer: Viewer, *arguments: str) -> str:
    """Run the program beside the viewer's file."""
    command = [PROGRAM, *arguments]
    return subprocess.run(
        command, cwd=viewer.folder, check=True, capture_output=True, text=True
    ).stdout


def shape(page: Page) -> Shape:
    """Rows and columns of the picture."""
    found = page.run(
        "const c = document.getElementById('picture'); return [c.clientHeight, c.clientWidth]"
    )
    assert isinstance(found, list)
    return found[0], found[1]


def pixels(page: Page) -> NDArray[np.uint8]:
    """What the canvas shows."""
    packed = page.run(
        "const c = document.getElementById('picture');"
        "const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
        "let s = '';"
        "for (let k = 0; k < d.length; k += 4) s += String.fromCharCode(d[k], d[k + 1], d[k + 2]);"
        "return [c.height, c.width, btoa(s)]"
    )
    assert isinstance(packed, list)
    rows, columns, text = packed
    return np.frombuffer(base64.b64decode(text), np.uint8).reshape(rows, columns, 3)


def camera(page: Page) -> list[str]:
    """The camera as options of the program."""
    said: list[str] = []
    if page["say-as"].get_property("value") != "command":
        page.choose("say-as", "command")

    def is_said() -> bool:
        said[:] = page["said"].get_property("textContent").split()
        return said[:1] == ["--position"]

    page.wait(is_said)
    return said


def new_camera(page: Page, before: list[str]) -> list[str]:
    """The camera after it has moved."""
    page.wait(lambda: camera(page) != before)
    page.settle()
    return camera(page)


def vector(options: list[str], name: str) -> NDArray[np.float64]:
    """One of the camera's vectors."""
    return np.array([float(x) for x in options[options.index(name) + 1].split(",")])


#: Names and what is said of them, in order; numbers with all digits, and commas between.
Told = list[tuple[str, str]]


def told_by(page: Page, name: str) -> Told:
    """Read a list of names and numbers, with all digits."""
    if page["digits"].get_attribute("aria-pressed") == "false":
        page.run("document.getElementById('digits').click()")
    found = page.run(
        "return [...document.getElementById(arguments[0]).children].map((line) =>"
        " [...line.children].map((part) => part.textContent))",
        name,
    )
    assert isinstance(found, list)
    return [(title, ", ".join(values)) for title, *values in found]


def hover(page: Page, row: int, column: int, *, click: bool = False) -> Told:
    """Point at a pixel; return what the page says of it."""
    rows, columns = shape(page)
    actions = ActionChains(page.driver, duration=0)
    # An offset is from the element's middle.
    actions.move_to_element_with_offset(page["picture"], column - columns // 2, row - rows // 2)
    if click:
        actions.click()
    actions.perform()
    page.wait(lambda: page.data("probed") == f"{row},{column}")
    return told_by(page, "probe")


def line(told: Told, name: str) -> str:
    """What is said of the first of that name."""
    return next(said for title, said in told if title == name)


def test_the_page_is_quiet_and_asks_nobody_else(page: Page, viewer: Viewer) -> None:
    page.driver.get_log("performance")
    page.open(viewer.address)
    page.settle()
    assert page.complaints() == []
    assert "error" not in str(page["message"].get_attribute("class"))
    entries: list[dict[str, str]] = page.driver.get_log("performance")
    messages = [json.loads(entry["message"])["message"] for entry in entries]
    sent = [
        m["params"]["request"]["url"]
        for m in messages
        if m["method"] == "Network.requestWillBeSent"
    ]
    assert len(sent) > 10
    own = (f"http://127.0.0.1:{viewer.port}/", "data:", "blob:")
    assert [url for url in sent if not url.startswith(own)] == []


def test_the_token_leaves_the_address_bar(page: Page, viewer: Viewer) -> None:
    assert page.driver.current_url == f"http://127.0.0.1:{viewer.port}/"
    page.driver.refresh()
    page.wait(lambda: page.data("ready") == "yes")
    page.driver.execute_script("sessionStorage.clear()")
    page.driver.refresh()
    page.wait(lambda: "token" in page.message())


def test_names_are_text(page: Page) -> None:
    names = [element.text for element in page["objects"].find_elements(By.TAG_NAME, "span")]
    assert names == ["cube", "<img src=x onerror=document.title='taken'>"]
    assert page.driver.title == "cube.obj - firsthit"
    assert page["objects"].find_elements(By.TAG_NAME, "img") == []


def test_a_pixel_says_what_probe_says(page: Page, viewer: Viewer) -> None:
    page.settle()
    rows, columns = shape(page)
    for row, column in [(rows // 2, columns // 2), (rows // 2 + 31, columns // 2 - 40), (1, 1)]:
        told = hover(page, row, column)
        said = program(
            viewer, "probe", "cube.obj", *camera(page), "--pixel", f"{row},{column}", "--json"
        )
        expected = json.loads(said)
        assert line(told, "pixel") == f"({row}, {column})"
        if expected["hit"] is None:
            assert line(told, "object") == "none: the ray meets nothing"
            continue
        assert float(line(told, "t")) == expected["hit"]["t"]
        assert line(told, "object") == f"{expected['hit']['name']} ({expected['hit']['object']})"
        assert line(told, "primitive").startswith(f"{expected['hit']['primitive']}, its ")


def test_the_picture_is_the_one_that_render_makes(page: Page, viewer: Viewer) -> None:
    page.finish()
    program(viewer, "render", "cube.obj", *camera(page), "-o", "again.png", "-q")
    again = np.asarray(Image.open(viewer.folder / "again.png").convert("RGB"))
    assert np.array_equal(pixels(page), again)


@pytest.mark.parametrize("channel", ["t", "object", "normal", "position", "front", "incidence"])
def test_channels_are_shown(page: Page, channel: str) -> None:
    page.finish()
    before = pixels(page)
    page.choose("channel", channel)
    page.wait(lambda: page.data("busy") == "no" and not np.array_equal(before, pixels(page)))
    assert page["map-label"].is_displayed() == (channel in {"t", "incidence"})
    assert page["legend"].is_displayed() == (channel in {"t", "incidence"})


def test_identifiers_have_the_colours_of_pngs(page: Page, viewer: Viewer) -> None:
    page.choose("channel", "object")
    page.settle()
    program(
        viewer,
        "render",
        "cube.obj",
        *camera(page),
        "--channels",
        "object",
        "-o",
        "object.png",
        "-q",
    )
    again = np.asarray(Image.open(viewer.folder / "object.png").convert("RGB"))
    assert np.array_equal(pixels(page), again)


def test_a_range_can_be_fixed(page: Page) -> None:
    page.choose("channel", "t")
    page.settle()
    page["fix-range"].click()
    fixed = page["legend-numbers"].text
    assert len(fixed.split()) == 5
    page.settle()
    page["picture"].send_keys("+" * 3)
    page.settle()
    assert page["legend-numbers"].text == fixed
    for name in ("low", "high"):
        page[name].clear()
        page[name].send_keys(Keys.TAB)
    page.wait(lambda: page["legend-numbers"].text != fixed)


def test_drags_turn_and_move(page: Page) -> None:
    first = camera(page)
    actions = ActionChains(page.driver, duration=20)
    actions.move_to_element(page["picture"]).click_and_hold().move_by_offset(
        90, 30
    ).release().perform()
    turned = new_camera(page, first)
    # It turns about the scene's middle, at one distance.
    distances = []
    for options in (first, turned):
        way = np.array([1.5, 0.0, 0.0]) - vector(options, "--position")
        distances.append(np.linalg.norm(way))
        aim = vector(options, "--aim")
        assert np.allclose(np.cross(way, aim), 0, atol=0.2)
    assert np.isclose(distances[0], distances[1], rtol=1e-2)
    assert not np.allclose(vector(first, "--aim"), vector(turned, "--aim"))
    actions = ActionChains(page.driver, duration=20)
    actions.key_down(Keys.SHIFT).move_to_element(page["picture"]).click_and_hold()
    actions.move_by_offset(50, 0).release().key_up(Keys.SHIFT).perform()
    shifted = new_camera(page, turned)
    assert np.allclose(vector(turned, "--aim"), vector(shifted, "--aim"))
    way = vector(shifted, "--position") - vector(turned, "--position")
    assert abs(way @ vector(turned, "--aim")) < 1e-9
    assert np.linalg.norm(way) > 0.1


def test_the_wheel_keeps_what_is_under_the_cursor(page: Page) -> None:
    page["picture"].send_keys("1o")
    page.settle()
    rows, columns = shape(page)
    row, column = rows // 2 - 60, columns // 2 - 90
    before = line(hover(page, row, column), "position")
    first = camera(page)
    origin = ScrollOrigin.from_element(page["picture"], column - columns // 2, row - rows // 2)
    ActionChains(page.driver).scroll_from_origin(origin, 0, -240).perform()
    new_camera(page, first)
    hover(page, row + 1, column)
    after = line(hover(page, row, column), "position")
    places = [np.array([float(x) for x in text.split(",")]) for text in (before, after)]
    assert np.abs(places[0] - places[1]).max() < 0.02


def test_keys_do_what_they_say(page: Page) -> None:
    first = camera(page)
    seen = [first]
    for key in ["1", "2", "3", "4", "5", "6", "o", Keys.ARROW_LEFT, Keys.ARROW_UP, "+", "-", "f"]:
        page["picture"].send_keys(key)
        seen.append(new_camera(page, seen[-1]))
    aims = [tuple(np.round(vector(options, "--aim"), 9) + 0.0) for options in seen[1:7]]
    assert aims == [(0, 0, -1), (0, 0, 1), (1, 0, 0), (-1, 0, 0), (0, -1, 0), (0, 1, 0)]
    assert "--orthographic" in seen[7]
    page["picture"].send_keys("0")
    assert new_camera(page, seen[-1]) == first
    page["picture"].send_keys("?")
    assert page["keys"].is_displayed()
    page["close-keys"].click()
    assert not page["keys"].is_displayed()


def test_a_turntable_turns_until_it_is_told(page: Page) -> None:
    first = camera(page)
    page["picture"].send_keys("t")
    second = []
    page.wait(lambda: second.append(camera(page)) or second[-1] != first)
    page["picture"].send_keys("t")
    page.finish()
    stopped = camera(page)
    time.sleep(0.3)
    assert camera(page) == stopped


def test_two_corners_of_a_cube_are_measured(page: Page) -> None:
    page["picture"].send_keys("1o")
    page.settle()
    rows, columns = shape(page)
    options = camera(page)
    height = float(options[options.index("--viewplane") + 1].split("x")[1])
    position = vector(options, "--position")
    pixel = height / rows
    marks = []
    for x, y in [(-1, -1), (1, -1)]:
        inside = 1.5 * pixel
        column = int(columns / 2 + (x * (1 - inside) - position[0]) / pixel)
        row = int(rows / 2 - (y * (1 - inside) - position[1]) / pixel)
        told = hover(page, row, column, click=True)
        marks.append(np.array([float(w) for w in line(told, "position").split(",")]))
    page.wait(lambda: page["measure"].is_displayed())
    told = told_by(page, "measure")
    assert abs(float(line(told, "distance")) - 2.0) < 4 * pixel
    assert abs(float(line(told, "distance")) - np.linalg.norm(marks[1] - marks[0])) < 1e-5
    assert line(told, "angle of normals, in degrees") == "0"
    # A third makes a path of it.
    hover(page, rows // 2, columns // 2 - 60, click=True)
    page.wait(lambda: "path" in page["measure"].text)
    assert len(page["marks"].find_elements(By.TAG_NAME, "li")) == 3
    page["picture"].send_keys(Keys.ESCAPE)
    assert not page["measure"].is_displayed()
    # Cleared by mistake, they come back.
    page["picture"].send_keys("u")
    assert len(page["marks"].find_elements(By.TAG_NAME, "li")) == 3
    page["picture"].send_keys(Keys.ESCAPE)


def test_notes_stay_when_the_page_is_loaded_again(page: Page) -> None:
    page.settle()
    rows, columns = shape(page)
    hover(page, rows // 2, columns // 2, click=True)
    page.wait(lambda: page["marks"].find_elements(By.TAG_NAME, "input"))
    page["marks"].find_element(By.TAG_NAME, "input").send_keys("<b>here</b>")
    page.driver.refresh()
    page.wait(lambda: page.data("ready") == "yes")
    note = page["marks"].find_element(By.TAG_NAME, "input")
    assert note.get_property("value") == "<b>here</b>"


def test_objects_are_hidden_and_shown_alone(page: Page) -> None:
    page.settle()
    rows, columns = shape(page)
    boxes = page["objects"].find_elements(By.CSS_SELECTOR, "input[type=checkbox]")
    page["picture"].send_keys("1")
    page.settle()
    # The triangle stands at z = 0, beside the cube.
    row, column = rows // 2, columns // 2 - 100
    assert line(hover(page, row, column), "object") == "cube (0)"
    boxes[0].click()
    page.settle()
    hover(page, row, column + 1)
    assert line(hover(page, row, column), "object").startswith("none")
    page["show-all"].click()
    page["objects"].find_elements(By.TAG_NAME, "button")[1].click()
    assert [box.is_selected() for box in boxes] == [False, True]
    page["show-all"].click()
    assert [box.is_selected() for box in boxes] == [True, True]


def test_objects_are_coloured_and_have_their_own_colours_again(page: Page) -> None:
    page.finish()
    before = pixels(page)
    rows, columns = before.shape[:2]
    page.run(
        "const field = document.querySelector('#objects input[type=color]');"
        "field.value = '#ff0000';"
        "field.dispatchEvent(new Event('input', {bubbles: true}))"
    )
    page.wait(lambda: page.data("busy") == "no" and not np.array_equal(before, pixels(page)))
    red, green, blue = pixels(page)[rows // 2, columns // 2]
    assert red > 60
    assert max(green, blue) < red / 4
    page["own-colors"].click()
    page.wait(lambda: page.data("busy") == "no" and np.array_equal(before, pixels(page)))


def test_the_camera_stays_when_the_page_is_loaded_again(page: Page) -> None:
    page["picture"].send_keys("2")
    page.finish()
    moved = camera(page)
    page.driver.refresh()
    page.wait(lambda: page.data("ready") == "yes")
    assert camera(page) == moved


def test_what_is_shown_stays_when_the_page_is_loaded_again(page: Page) -> None:
    page["objects"].find_elements(By.CSS_SELECTOR, "input[type=checkbox]")[1].click()
    page.run(
        "const field = document.querySelector('#objects input[type=color]');"
        "field.value = '#ff0000';"
        "field.dispatchEvent(new Event('input', {bubbles: true}))"
    )
    page.choose("light", "studio")
    page.choose("ground", "without")
    page.choose("cut-axis", "x")
    page.finish()
    before = pixels(page)
    page.driver.refresh()
    page.wait(lambda: page.data("ready") == "yes" and page.data("busy") == "no")
    assert np.array_equal(before, pixels(page))
    boxes = page["objects"].find_elements(By.CSS_SELECTOR, "input[type=checkbox]")
    assert [box.is_selected() for box in boxes] == [True, False]
    assert page["cut-axis"].get_property("value") == "x"


@pytest.mark.parametrize(
    "change",
    ["text = '{'", "text = 'null'", "saved.camera.aim = [0, 0, 0]", "saved.objects.hidden = [2]",
     "saved.fields.channel = 'nope'; saved.fields.nosuch = 'x'", "delete saved.ball"],
)  # fmt: skip
def test_what_is_damaged_is_not_taken(page: Page, change: str) -> None:
    page["picture"].send_keys("2")
    page.finish()
    page.run(
        "const key = Object.keys(sessionStorage).find((key) => key.startsWith('firsthit-look'));"
        "let text = sessionStorage.getItem(key);"
        f"const saved = JSON.parse(text); {change};"
        "if (text === sessionStorage.getItem(key)) text = JSON.stringify(saved);"
        "sessionStorage.setItem(key, text)"
    )
    page.driver.refresh()
    page.wait(lambda: page.data("ready") == "yes" and page.data("busy") == "no")
    assert "error" not in str(page["message"].get_attribute("class"))
    assert pixels(page).std() > 0


def test_options_say_what_else_is_shown(page: Page, viewer: Viewer) -> None:
    page["objects"].find_elements(By.CSS_SELECTOR, "input[type=checkbox]")[1].click()
    page.choose("light", "studio")
    page.choose("ground", "without")
    page["edges"].click()
    page.finish()
    page.wait(lambda: "--edges 1.5" in str(page["said"].get_property("textContent")))
    options = str(page["said"].get_property("textContent"))
    assert options.endswith(" --light studio --no-ground --edges 1.5 --hide 1")
    assert page["unsaid"].get_property("textContent") == ""
    program(viewer, "render", "cube.obj", *options.split(), "-o", "looked.png", "-q")
    looked = np.asarray(Image.open(viewer.folder / "looked.png").convert("RGB"))
    assert np.array_equal(pixels(page), looked)
    page.choose("cut-axis", "x")
    page.finish()
    unsaid = "Not said here: the section plane."
    page.wait(lambda: page["unsaid"].get_property("textContent") == unsaid)
    assert page["save-rendered"].get_attribute("aria-disabled") == "true"


def test_a_framed_scene_fills_the_picture(page: Page) -> None:
    page["objects"].find_elements(By.CSS_SELECTOR, "input[type=checkbox]")[1].click()
    for key in ["1", "o"]:
        page["picture"].send_keys(key)
        page["frame"].click()
        page.choose("channel", "object")
        page.finish()
        painted = pixels(page)
        seen = (painted != painted[0, 0]).any(-1)
        rows = np.flatnonzero(seen.any(1))
        # The box is as wide as 5 and as high as 2: the cube is seen in its left two fifths.
        columns = np.flatnonzero(seen.any(0))
        share = 2.5 * (columns[-1] - columns[0] + 1) / painted.shape[1]
        assert 0.8 < share < 1.05
        assert columns[0] > 0
        assert 0 < rows[0] <= rows[-1] < painted.shape[0] - 1
        page.choose("channel", "color")


def test_a_sky_lights_the_scene_and_the_ball_moves_its_sun(page: Page) -> None:
    page.finish()
    before = pixels(page)
    page.choose("environment", "clear sky")
    page.wait(lambda: page.data("busy") == "no" and not np.array_equal(before, pixels(page)))
    sky = pixels(page)
    page["ball"].send_keys(Keys.ARROW_RIGHT * 3)
    page.wait(lambda: page.data("busy") == "no" and not np.array_equal(sky, pixels(page)))
    assert "error" not in str(page["message"].get_attribute("class"))
    # It does not set.
    low = pixels(page)
    page["ball"].send_keys(Keys.ARROW_DOWN * 25)
    page.wait(lambda: page.data("busy") == "no" and not np.array_equal(low, pixels(page)))
    assert "error" not in str(page["message"].get_attribute("class"))
    page.choose("environment", "as rendered")
    page.choose("light", "as rendered")
    page.wait(lambda: page.data("busy") == "no" and np.array_equal(before, pixels(page)))


def test_a_click_beside_everything_says_so(page: Page) -> None:
    page.settle()
    hover(page, 1, 1, click=True)
    page.wait(lambda: "meets nothing" in page.message())
    assert page["marks"].find_elements(By.TAG_NAME, "li") == []


def test_a_section_plane_looks_into_the_cube(page: Page) -> None:
    page["picture"].send_keys("1o")
    page.settle()
    rows, columns = shape(page)
    row, column = rows // 2, columns // 2 - 90
    assert float(line(hover(page, row, column), "position").split(",")[2]) == 1.0
    page.choose("cut-axis", "z")
    page.settle()
    hover(page, row, column + 1)
    told = hover(page, row, column)
    face, inside = told[: (behind := told.index(("behind it", "")))], told[behind:]
    assert line(face, "cut face") == "cube (0)"
    assert float(line(face, "position").split(",")[2]) == 0.0
    assert float(line(inside, "position").split(",")[2]) == -1.0
    assert line(inside, "primitive").endswith("its back")
    hover(page, row, column, click=True)
    page.wait(lambda: page["marks"].find_elements(By.TAG_NAME, "small"))
    assert page["marks"].find_element(By.TAG_NAME, "small").text.endswith(", 0.00000")
    page.finish()
    page.wait(lambda: page["faces"].is_displayed())
    # The triangle beside it lies in the plane.
    assert told_by(page, "faces")[:2] == [("area of all faces", "4"), ("cube (0)", "4")]
    page.run(
        "URL.createObjectURL = (blob) => { blob.text().then((text) => { window.saved = text; });"
        " return 'data:,'; }"
    )
    page["save-svg"].click()
    page.wait(lambda: "<path" in str(page.run("return window.saved")))
    seen = pixels(page)[row, column]
    assert seen[0] > 2 * seen[2], "the face is orange"
    page["cut-own"].click()
    page.finish()
    assert np.ptp(pixels(page)[row, column]) < 30, "the cube is grey"
    page["cut-turned"].click()
    page.settle()
    hover(page, row, column + 1)
    assert float(dict(hover(page, row, column))["position"].split(",")[2]) == 1.0


def test_a_ball_moves_the_sun(page: Page) -> None:
    page.finish()
    before = pixels(page)
    page["ball"].send_keys(Keys.ARROW_RIGHT)
    page.wait(lambda: page.data("busy") == "yes")
    page.finish()
    once = pixels(page)
    assert not np.array_equal(before, once)
    page["ball"].send_keys(Keys.ARROW_RIGHT * 4)
    page.wait(lambda: page.data("busy") == "yes")
    page.finish()
    assert not np.array_equal(once, pixels(page))
    page.choose("light", "as rendered")
    page.finish()
    assert np.array_equal(before, pixels(page))


def test_two_pictures_are_compared(page: Page) -> None:
    page.finish()
    page["keep-picture"].click()
    assert page["difference"].text == "No pixel differs."
    page["edges"].click()
    page.finish()
    page.wait(lambda: "pixels differ" in page["difference"].text)
    assert page["before"].is_displayed()
    page["forget-picture"].click()
    assert not page["before"].is_displayed()
    # One that is not done is kept when it is.
    page["picture"].send_keys("2")
    page["keep-picture"].click()
    page.finish()
    page.wait(lambda: page["difference"].text == "No pixel differs.")


def test_what_is_copied_is_taken_back(page: Page) -> None:
    page["picture"].send_keys(Keys.ARROW_LEFT)
    page.settle()
    options = camera(page)
    forms = {"command": "--", "python": "fh.", "toml": "[cam", "opencv": "{", "colmap": "1 PIN"}
    for words, start in forms.items():
        page.choose("say-as", words)

        def is_said(start: str = start) -> bool:
            return str(page["said"].get_property("textContent")).startswith(start)

        page.wait(is_said)
        text = str(page["said"].get_property("textContent"))
        page["picture"].send_keys("0")
        page.wait(lambda: camera(page) != options)
        page.run("document.getElementById('heard').value = arguments[0]", text)
        page["take-camera"].click()
        page.settle()
        page.wait(lambda: is_near(camera(page), options))
    page.run("document.getElementById('heard').value = 'a cat'")
    page["take-camera"].click()
    assert "no camera" in page.message()


def is_near(a: list[str], b: list[str]) -> bool:
    """Say whether two cameras are the same but for rounding."""
    names = ["--position", "--aim"]
    return all(
        np.allclose(vector(a, name), vector(b, name), rtol=1e-9, atol=1e-9) for name in names
    )


def test_the_chapter_follows_a_ray(page: Page, viewer: Viewer) -> None:
    page.settle()
    page.run("document.getElementById('chapter').open = true")
    page.wait(lambda: page["chapter-size"].text == "12 \N{MULTIPLICATION SIGN} 16")
    vectors = {"x_c": "0 0 5", "u_c": "0 0 -1", "v_up": "0 1 0"}
    numbers = {"z_p": "2", "w": "4", "h": "3", "M": "3", "N": "5"}
    for name, value in vectors.items():
        numbers |= zip((f"{name}-{axis}" for axis in "xyz"), value.split(), strict=True)
    for name, value in numbers.items():
        field = page[f"chapter-{name}"]
        field.clear()
        field.send_keys(value + Keys.TAB)
    page.wait(lambda: page.data("painted") == "3x5")
    assert page["chapter-size"].text == "3 \N{MULTIPLICATION SIGN} 5"
    page.settle()
    rows, columns = shape(page)
    assert abs(columns / rows - 4 / 3) < 0.01
    ActionChains(page.driver, duration=0).move_to_element(page["picture"]).perform()
    page.wait(lambda: page.data("probed") == "1,2")
    told = told_by(page, "chapter-words")
    assert line(told, "pixel (row, column)") == "(1, 2)"
    assert line(told, "i = M \N{MINUS SIGN} 1 \N{MINUS SIGN} row,  j = column") == "(1, 2)"
    assert line(told, "c0 = xc + zp uc") == "0, 0, 3"
    assert line(told, "t, o = shoot(p, ur)") == "2"
    assert line(told, "o") == "cube (0)"
    assert line(told, "x = p + t ur") == "0, 0, 1"
    # The same camera by the program: rays start on the viewplane.
    options = camera(page)
    assert options[options.index("--focal-length") + 1] == "2"
    told = json.loads(program(viewer, "probe", "cube.obj", *options, "--pixel", "1,2", "--json"))
    assert told["hit"]["t"] == 2.0
    page["chapter-orthographic"].click()
    page.settle()
    assert page["orthographic"].is_selected()
    page.wait(lambda: ("ur = uc", "0, 0, -1") in told_by(page, "chapter-words"))
    page["chapter-v_up-y"].clear()
    page["chapter-v_up-y"].send_keys("0" + Keys.TAB)
    assert page["chapter-v_up-y"].get_attribute("aria-invalid") == "true"
    drawn = page.run(
        "const c = document.getElementById('chapter-scene');"
        "return c.getContext('2d').getImageData(0, 0, c.width, c.height).data.some((x) => x > 0)"
    )
    assert drawn


def test_the_chapter_opens_where_one_looks(page: Page) -> None:
    page.settle()
    page.run("document.getElementById('chapter').open = true")
    page.wait(lambda: page.data("painted") == "12x16")
    top = page.run("return document.getElementById('chapter').getBoundingClientRect().top")
    assert isinstance(top, int | float)
    assert -1 <= top < 60


def test_what_does_nothing_says_why(page: Page) -> None:
    page.settle()
    for name, why in {"clear": "No point is kept", "own-colors": "scene's colours"}.items():
        assert page[name].get_attribute("aria-disabled") == "true"
        page[name].click()
        assert why in page.message()
        assert why in str(page[name].get_attribute("title"))
    page.choose("cut-axis", "x")
    page["edges"].click()
    assert not page["edges"].is_selected()
    assert page.message() == "Not in a section."
    page.choose("cut-axis", "none")
    page["edges"].click()
    assert page["edges"].is_selected()


def test_numbers_have_digits_that_a_person_reads_and_all_of_them_on_a_click(page: Page) -> None:
    page.settle()
    rows, columns = shape(page)
    exact = hover(page, rows // 2 + 31, columns // 2 - 40)
    page["digits"].click()
    number = page["probe"].find_element(By.XPATH, "div[dt = 't']/dd")
    assert len(number.text) == 7
    assert abs(float(number.text) - float(line(exact, "t"))) < 1e-5
    number.click()
    number = page["probe"].find_element(By.XPATH, "div[dt = 't']/dd")
    assert number.text == line(exact, "t")


def test_a_pointer_moves_nothing_but_numbers(page: Page) -> None:
    rows, columns = shape(page)
    tops = set()
    for row, column in [(rows // 2, columns // 2), (1, 1), (rows // 2, columns // 2 + 1)]:
        hover(page, row, column)
        tops.add(page["copy-probe"].rect["y"])
    assert len(tops) == 1


@pytest.mark.parametrize("size", [(1366, 768), (1280, 720), (390, 844)])
def test_nothing_is_cut(page: Page, size: Shape) -> None:
    width, height = size
    metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500}
    page.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
    try:
        page.settle()
        page.choose("channel", "t")
        page.choose("cut-axis", "view")
        page.run("document.getElementById('chapter').open = true")
        page.wait(lambda: page["faces"].is_displayed())
        cut = page.run(
            "const kinds = '#panel :is(input, button, dd, dt, label, p)';"
            "const isCut = (one) => one.getBoundingClientRect().right > innerWidth ||"
            " one.scrollWidth > one.clientWidth + 1 && getComputedStyle(one).display !== 'inline';"
            "return [...document.querySelectorAll(kinds)]"
            ".filter((one) => one.checkVisibility() && one.type !== 'file' && isCut(one))"
            ".map((one) => one.outerHTML)"
        )
        assert cut == []
        assert page.run("return document.documentElement.scrollWidth") == width
    finally:
        page.driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def test_colours_by_numbers_have_a_legend(driver: webdriver.Chrome, tmp_path: Path) -> None:
    (tmp_path / "one.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 2\nf 1 2 3\n")
    look = ["--color-by", "height", "--color-range", "0,1", "--color-above", "red"]
    viewer = Viewer(tmp_path, "one.obj", "--up", "0,0,1", *look)
    page = Page(driver)
    page.open(viewer.address)
    page.settle()
    assert page["legend-name"].text == "height"
    assert page["legend-numbers"].text.split() == ["1.00", "0.75", "0.50", "0.25", "0.00"]
    assert page["legend-above"].is_displayed()
    assert not page["legend-below"].is_displayed()
    page.choose("channel", "object")
    page.finish()
    assert not page["legend"].is_displayed()
    assert viewer.stop() == 0


def test_the_picture_goes_with_the_window(page: Page) -> None:
    page.driver.set_window_size(900, 640)
    try:
        page.settle()
        rows, columns = shape(page)
        page.wait(lambda: page.data("painted") == f"{rows}x{columns}")
    finally:
        page.driver.set_window_size(1000, 700)


def test_fingers_turn_and_pinch(page: Page) -> None:
    first = camera(page)
    box = page["picture"].rect
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

    def touch(kind: str, *places: tuple[float, float]) -> None:
        points = [{"x": px, "y": py, "id": k} for k, (px, py) in enumerate(places)]
        page.driver.execute_cdp_cmd(
            "Input.dispatchTouchEvent", {"type": kind, "touchPoints": points}
        )

    touch("touchStart", (x, y))
    touch("touchMove", (x + 40, y))
    touch("touchMove", (x + 80, y))
    touch("touchEnd")
    turned = new_camera(page, first)
    touch("touchStart", (x - 30, y), (x + 30, y))
    touch("touchMove", (x - 60, y), (x + 60, y))
    touch("touchMove", (x - 90, y), (x + 90, y))
    touch("touchEnd")
    pinched = new_camera(page, turned)
    assert np.allclose(vector(turned, "--aim"), vector(pinched, "--aim"), atol=1e-6)
    assert page["marks"].find_elements(By.TAG_NAME, "li") == []


def test_the_keyboard_alone_reaches_everything(page: Page) -> None:
    page.run("document.activeElement.blur()")
    wanted = page.run(
        "const controls = 'button, select, input, textarea, summary, [tabindex]';"
        "return [...document.querySelectorAll(`#stage [tabindex], #panel :is(${controls})`)]"
        ".filter((e) => e.checkVisibility()).length"
    )
    assert isinstance(wanted, int)
    reached = set()
    for _ in range(wanted + 5):
        ActionChains(page.driver, duration=0).send_keys(Keys.TAB).perform()
        element = page.driver.switch_to.active_element
        if element.tag_name != "body":
            reached.add(element.id)
    assert len(reached) == wanted


def test_the_page_says_that_the_program_has_ended(driver: webdriver.Chrome, tmp_path: Path) -> None:
    (tmp_path / "one.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    viewer = Viewer(tmp_path, "one.obj")
    page = Page(driver)
    page.open(viewer.address)
    page.settle()
    assert viewer.stop() == 0
    page.wait(lambda: "has ended" in page.message())
    assert "error" in str(page["message"].get_attribute("class"))


FOREIGN = """<!doctype html><title>foreign</title><script type=module>
const own = 'http://127.0.0.1:PORT';
const results = [];
const attempt = async (name, act) => {
  try { results.push([name, await act()]); } catch (error) { results.push([name, 'failed']); }
};
for (const path of ['/', '/main.js', '/app.css', '/info', '/frame', '/probe', '/say', '/alive']) {
  for (const method of ['GET', 'POST']) {
    for (const mode of ['cors', 'no-cors']) {
      const body = method === 'POST' ? '{}' : undefined;
      await attempt(`${method} ${mode} ${path}`, async () => {
        const reply = await fetch(own + path, {method, mode, body});
        return (await reply.text()).length > 0 ? 'read' : 'nothing';
      });
      await attempt(`${method} ${mode} ${path} token`, async () => {
        const headers = {'X-Firsthit-Token': 'TOKEN'};
        const reply = await fetch(own + path, {method, mode, body, headers});
        return (await reply.text()).length > 0 ? 'read' : 'nothing';
      });
    }
  }
}
await attempt('import', () => import(own + '/dom.js').then(() => 'read'));
const load = (tag, name, more) => new Promise((good, bad) => {
  const element = document.createElement(tag);
  Object.assign(element, more, {onload: () => good('read'), onerror: () => bad()});
  element[name] = own + (tag === 'link' ? '/app.css' : '/main.js');
  document.head.append(element);
});
await attempt('script', () => load('script', 'src', {}));
await attempt('style', () => load('link', 'href', {rel: 'stylesheet'}));
await attempt('image', () => load('img', 'src', {}));
await attempt('frame', () => new Promise((good) => {
  const frame = document.createElement('iframe');
  frame.src = own + '/';
  const title = () => { try { return frame.contentDocument.title; } catch { return ''; } };
  frame.onload = () => good(title() === 'firsthit' ? 'read' : 'nothing');
  document.body.append(frame);
}));
await attempt('socket', () => new Promise((good, bad) => {
  const socket = new WebSocket(own.replace('http', 'ws') + '/info');
  socket.onopen = () => good('read');
  socket.onerror = () => bad();
}));
window.results = results;
</script><body>"""


def test_a_page_of_another_port_gets_nothing(page: Page, viewer: Viewer) -> None:
    content = FOREIGN.replace("PORT", str(viewer.port)).replace("TOKEN", viewer.token).encode()

    class Foreign(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.send_header("Content-Length", str(len(content)))
            self.end_headers()
            self.wfile.write(content)

        def log_message(self, *_: object) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Foreign)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        page.driver.get(f"http://127.0.0.1:{server.server_port}/")
        page.wait(lambda: page.run("return window.results !== undefined"))
        results = page.run("return window.results")
    finally:
        server.shutdown()
        server.server_close()
    assert isinstance(results, list)
    assert len(results) == 8 * 2 * 2 * 2 + 6
    assert [name for name, result in results if result == "read"] == []


#: What a hand may have opened before somebody looks at the page.
OPENED = {
    "everything": "document.getElementById('chapter').open = true",
    "a section": "",
    "keys": "document.getElementById('help').click()",
}


@pytest.mark.parametrize("opened", OPENED)
def test_axe_finds_nothing(page: Page, opened: str) -> None:
    axe = pytest.importorskip("axe_core_python.base")
    script = Path(axe.__file__).with_name("axe.min.js")
    page.settle()
    page.choose("channel", "t")
    if opened == "a section":
        page.choose("cut-axis", "x")
        page.wait(lambda: page["faces"].is_displayed())
    page.run(OPENED[opened])
    page.settle()
    for scheme in ("light", "dark"):
        features = [{"name": "prefers-color-scheme", "value": scheme}]
        page.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": features})
        # The page's policy lets no foreign script in: the driver's own scripts run beside it.
        page.run(script.read_text() + "; window.axe = axe;")
        found = page.driver.execute_async_script(
            "const done = arguments[arguments.length - 1];"
            "window.axe.run().then((result) => done(result.violations))"
        )
        told = [(v["id"], [node["html"][:120] for node in v["nodes"]]) for v in found]
        assert told == [], scheme
    page.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
