"""The viewer in notebooks, and as a file."""

from __future__ import annotations

import base64
import html
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from firsthit import _firsthit

from .view import viewer_of

if TYPE_CHECKING:
    import os

    from firsthit._scene.scene import Scene
    from firsthit._sensors.camera import Camera

#: With more triangles inside, an output is more than 25 MB.
_MOST_TRIANGLES = 500_000


class NotebookView:
    """A scene to look at in a notebook: to turn, to probe, to measure, and to save as a file.

    Made by `Scene.view`. A notebook shows it where it is the last line of a cell. With the engine
    ``"page"`` all that is shown is in the notebook itself: it works without a kernel, and where the
    notebook is sent to. With ``"kernel"`` the kernel answers the page. Where no script may run
    there is a picture.
    """

    def __init__(
        self,
        viewer: _firsthit.Viewer,
        title: str,
        engine: Literal["page", "kernel"],
        height: int,
    ) -> None:
        """Hold a viewer; `Scene.view` makes one."""
        self._viewer = viewer
        self._title = title
        self._engine = engine
        self._height = height
        self._widget: Any = None

    @property
    def engine(self) -> Literal["page", "kernel"]:
        """The engine that computes the pictures."""
        return self._engine

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the page to an HTML file, with the scene inside.

        Browsers open it without firsthit and without a network.

        Parameters
        ----------
        path : path-like
            The file, which ends in ``.html``.

        Raises
        ------
        ValueError
            For another extension.
        FileWriteError
            If the system refuses to write it; also an `OSError`.
        """
        path = Path(path)
        if path.suffix.lower() not in (".html", ".htm"):
            raise ValueError(f"{path} must end in .html")
        _firsthit.write_bytes(path, self._viewer.report())

    def __repr__(self) -> str:
        """Say what it shows."""
        return f"NotebookView({self._title!r}, engine={self._engine!r})"

    def _repr_html_(self) -> str:
        picture = base64.b64encode(self._viewer.still()).decode()
        title = html.escape(self._title)
        shown = f'<img alt="{title}" style="height:100%" src="data:image/png;base64,{picture}">'
        if self._engine == "kernel":
            return f'<div data-firsthit="{id(self)}">{shown}</div>'
        # Where no frame may be, what is behind it is seen.
        page = html.escape(self._viewer.report().decode())
        over = "position:absolute;inset:0;width:100%;height:100%;border:0;background:Canvas"
        may = 'sandbox="allow-scripts allow-downloads" allow="clipboard-write"'
        frame = f'<iframe title="{title}" {may} style="{over}" srcdoc="{page}"></iframe>'
        return f'<div style="position:relative;height:{self._height}px">{shown}{frame}</div>'

    def _ipython_display_(self) -> None:
        """Show the kernel's page, and before it a picture, which the page hides.

        One output with both would not do: programs that convert notebooks take the page, which is
        empty without a kernel.
        """
        if self._engine != "kernel":
            # The ordinary way: all of it is HTML.
            raise NotImplementedError
        from .widget import PageWidget

        display = import_module("IPython.display").display

        if self._widget is None:
            self._widget = PageWidget(self._viewer, self._height, str(id(self)))
        display({"text/html": self._repr_html_(), "text/plain": repr(self)}, raw=True)
        display(self._widget)


def notebook_view(
    scene: Scene,
    camera: Camera | None,
    title: str,
    engine: Literal["page", "kernel"] | None,
    height: int,
    **given: Any,
) -> NotebookView:
    """Check what `Scene.view` was given, and make what it returns."""
    if engine not in (None, "page", "kernel"):
        raise ValueError(f'engine must be "page" or "kernel", got {engine!r}')
    if isinstance(height, bool) or not isinstance(height, int) or height < 1:
        raise ValueError(f"height must be a positive number of pixels, got {height!r}")
    if engine is None:
        is_page = scene._objects.triangles() <= _MOST_TRIANGLES
        engine = "page" if is_page or not has_widgets() else "kernel"
    if engine == "kernel" and not has_widgets():
        raise ImportError('the engine "kernel" takes anywidget: pip install anywidget')
    viewer = viewer_of(scene, camera, title, **given)
    return NotebookView(viewer, title, engine, height)


def has_widgets() -> bool:
    """Return whether anywidget is there."""
    return find_spec("anywidget") is not None


def picture_html(scene: Scene) -> str:
    """Show a picture of a scene, for notebooks."""
    said = html.escape(repr(scene))
    try:
        viewer = viewer_of(scene, None, "scene", **dict.fromkeys(_LOOK))
        picture = base64.b64encode(viewer.still()).decode()
    except ValueError:
        # There is nothing to be seen of it.
        return f"<p>{said}</p>"
    return f'<img alt="{said}" src="data:image/png;base64,{picture}"><p>{said}</p>'


#: How a picture looks, of `render`'s arguments.
_LOOK = ("background", "environment", "objects", "shade", "light", "ground")
