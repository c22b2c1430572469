"""The viewer's page in a notebook, answered by this process over the kernel's own channel."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import anywidget
import traitlets

if TYPE_CHECKING:
    from firsthit import _firsthit

#: The page runs in a frame of its own, apart from the notebook, and asks through a port. Several
#: outputs may show one widget, so each has a name.
_FRAME = """
function render({ model, el }) {
    const own = crypto.randomUUID();
    const frame = document.createElement("iframe");
    frame.setAttribute("sandbox", "allow-scripts allow-downloads");
    frame.allow = "clipboard-write";
    frame.srcdoc = model.get("page");
    Object.assign(frame.style, { width: "100%", height: `${model.get("height")}px`, border: "0" });
    let port = null;
    // A frame that is moved within the notebook is loaded again, and asks for another port.
    const start = (event) => {
        if (event.source !== frame.contentWindow || event.data !== "firsthit") return;
        const { port1, port2 } = new MessageChannel();
        port = port1;
        port.onmessage = ({ data }) => model.send({ own, ...data });
        frame.contentWindow.postMessage("firsthit", "*", [port2]);
    };
    addEventListener("message", start);
    const answered = (message, buffers) => {
        if (message.own !== own) return;
        const [view] = buffers;
        const end = view && view.byteOffset + view.byteLength;
        const pixels = view?.buffer.slice(view.byteOffset, end);
        port?.postMessage({ ...message, pixels });
    };
    model.on("msg:custom", answered);
    // As long as the page is there, the picture before it is not.
    const style = document.createElement("style");
    style.textContent = `[data-firsthit="${model.get("picture")}"] { display: none; }`;
    el.append(style, frame);
    return () => {
        removeEventListener("message", start);
        model.off("msg:custom", answered);
    };
}
export default { render };
"""


class PageWidget(anywidget.AnyWidget):
    """A page, and the viewer that answers it."""

    _esm = _FRAME
    page = traitlets.Unicode().tag(sync=True)
    height = traitlets.Int().tag(sync=True)
    picture = traitlets.Unicode().tag(sync=True)

    def __init__(self, viewer: _firsthit.Viewer, height: int, picture: str) -> None:
        """Show a viewer's page in the place of the picture of that name."""
        super().__init__(page=viewer.embedded_page(), height=height, picture=picture)
        self._viewer = viewer
        self.on_msg(self._answer)

    def _answer(self, _widget: object, asked: dict[str, Any], _buffers: object) -> None:
        """Answer a question of the page; what is refused is told there."""
        about = {"own": asked.get("own"), "id": asked.get("id")}
        try:
            json, pixels = self._viewer.answer(str(asked["question"]), str(asked["about"]))
        except (KeyError, ValueError, RuntimeError, MemoryError) as error:
            self.send({**about, "error": str(error)})
        else:
            self.send({**about, "json": json}, [pixels] if pixels else [])
