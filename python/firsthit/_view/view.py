"""The viewer in the browser."""

from __future__ import annotations

import html
import time
import webbrowser
from typing import TYPE_CHECKING, Any

from firsthit import _firsthit
from firsthit._pictures.picture import Picture
from firsthit._sensors.camera import Camera

if TYPE_CHECKING:
    from types import TracebackType

    import numpy.typing as npt

    from firsthit._looks.environment import Environment
    from firsthit._looks.lights import Sky
    from firsthit._looks.shading import Shader
    from firsthit._scene.scene import Scene
    from firsthit.typing import LightName, Selection, ShaderName


#: The arguments of `render` that a page does not take: it asks for pictures itself.
_NOT_GIVEN = dict.fromkeys(
    (
        "ambient", "blend_below", "color_by", "color_map", "color_range", "cull",
        "edges", "noise", "region", "resume", "samples", "shadows", "threads",
    )
)  # fmt: skip


def viewer_of(scene: Scene, camera: Camera | None, title: str, **given: Any) -> _firsthit.Viewer:
    """Check what a user gave: some of the arguments of `render`, of which ``None`` are left out."""
    if camera is not None and not isinstance(camera, Camera):
        raise TypeError("view takes a Scene and a Camera")
    if callable(given["shade"]):
        raise TypeError("view takes a shader by its name or a Shader, no function")
    picture = Picture.of(scene, camera, "color", **_NOT_GIVEN, **given)
    seen = picture.camera if isinstance(picture.camera, Camera) else Camera.framing(scene)
    lines = None if picture.lines is None else picture.lines._native()
    return _firsthit.Viewer(
        (picture.native, seen._native),
        picture.look._native(),
        picture.background,
        picture.up,
        (picture.display._native, lines),
        title,
    )


#: Pages that are served: nobody needs to hold them.
_RUNNING: set[View] = set()


class View:
    """A page that shows a scene, served on this machine until it is stopped.

    Made by `view`. It is a context manager, which stops it at the end. Notebooks show its address.

    Attributes
    ----------
    address : str
        The page's address, on 127.0.0.1. The part behind ``#`` is the token that lets a page
        ask: whoever has the whole address can look.
    """

    def __init__(self, server: _firsthit.PageServer, title: str) -> None:
        """Hold a server; `view` makes one."""
        self._server = server
        self._title = title

    @property
    def address(self) -> str:
        """The page's address."""
        return self._server.address

    def stop(self) -> None:
        """End the server. The page says so; its port is free afterwards."""
        self._server.stop()
        _RUNNING.discard(self)

    def wait(self) -> None:
        """Wait until Ctrl-C, and stop: at the end of a script, which would end the page."""
        try:
            while not self._server.is_over:
                time.sleep(0.05)
        except KeyboardInterrupt:
            pass
        self.stop()

    def __enter__(self) -> View:
        """Return itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Stop it."""
        self.stop()

    def __repr__(self) -> str:
        """Show the address without its token."""
        place, _, _ = self.address.partition("#")
        state = "stopped" if self._server.is_over else "running"
        return f"View({self._title!r}, {place}, {state})"

    def _repr_html_(self) -> str:
        """Link to the page, for notebooks."""
        title, address = html.escape(self._title), html.escape(self.address)
        return f'<a href="{address}" target="_blank" rel="noopener">{title}</a>'


def view(
    scene: Scene,
    camera: Camera | None = None,
    *,
    background: Sky | npt.ArrayLike | None = None,
    environment: Environment | None = None,
    objects: Selection | None = None,
    shade: ShaderName | Shader | None = None,
    light: LightName | None = None,
    ground: bool | None = None,
    title: str = "scene",
    port: int = 0,
    browser: bool = True,
) -> View:
    """Show a scene in the browser: turn it, ask pixels, measure, copy the camera.

    In a notebook, `Scene.view` shows the same without a server. The page shows the scene as it is
    at the call. Its server runs in a thread, listens on 127.0.0.1 alone, and answers the pages that
    have its token; see docs/view.md.

    Parameters
    ----------
    scene : Scene
        The scene.
    camera : Camera, optional
        Where the page begins. If left out, the first camera of a scene file, else `Camera.framing`.
        Of a camera without a flat viewplane around its aim the page takes that of `Camera.framing`.
    background, environment, objects, shade, light, ground
        As for `render`. ``shade`` is no function of one's own.
    title : str
        The page's name for it.
    port : int
        The port, up to 65535; of 0 the system chooses one that is free.
    browser : bool
        Whether the page is opened in the browser.

    Returns
    -------
    View
        The page that is served, with its ``address``. It ends with `View.stop`, and with the
        program: a script waits by `View.wait`.

    Raises
    ------
    TypeError
        For what is no scene, and for a sensor that is no `Camera`.
    ValueError
        For numbers that make no sense, as `render`.
    OSError
        If the port is taken.

    Examples
    --------
    >>> scene = fh.Scene()
    >>> ball = scene.add(fh.Sphere((0, 0, 0), 1))
    >>> with fh.view(scene, browser=False) as page:
    ...     page.address.startswith("http://127.0.0.1:")
    True
    """
    if isinstance(port, bool) or not isinstance(port, int) or not 0 <= port <= 65535:
        raise ValueError(f"port must be from 0 to 65535, got {port!r}")
    viewer = viewer_of(
        scene, camera, title, background=background, environment=environment, objects=objects,
        shade=shade, light=light, ground=ground,
    )  # fmt: skip
    page = View(_firsthit.PageServer(viewer, port), title)
    _RUNNING.add(page)
    if browser:
        webbrowser.open(page.address)
    return page
