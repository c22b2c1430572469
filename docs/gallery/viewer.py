"""Make the picture of the viewer, docs/images/viewer.png, in Chromium: `make viewer-picture`."""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python" / "browser_tests"))
sys.dont_write_bytecode = True

from conftest import Page, Viewer, browser  # noqa: E402
from make import packed  # noqa: E402
from test_view import hover  # noqa: E402

PICTURE = ROOT / "docs" / "images" / "viewer.png"


def main() -> None:
    """Open a scene, point at a pixel and keep two points, and take the picture of all that."""
    viewer, driver = Viewer(ROOT, "docs/scenes/shapes.toml"), browser(1180, 760)
    try:
        page = Page(driver)
        page.open(viewer.address)
        page.finish()
        rows, columns = (int(page["picture"].get_attribute(name)) for name in ("height", "width"))
        for row, column in ((0.52, 0.21), (0.6, 0.64)):
            hover(page, int(row * rows), int(column * columns), click=True)
        hover(page, int(0.62 * rows), int(0.5 * columns))
        page.finish()
        # `hover` asks for all digits.
        page.run("document.getElementById('digits').click()")
        driver.save_screenshot(str(PICTURE))
        PICTURE.write_bytes(packed(PICTURE))
    finally:
        driver.quit()
        viewer.stop()


if __name__ == "__main__":
    main()
