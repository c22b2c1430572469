"""The viewer behind a page that shows a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from firsthit import _firsthit
from firsthit._pictures.picture import Picture
from firsthit._sensors.camera import Camera

if TYPE_CHECKING:
    from firsthit._scene.scene import Scene

#: What of `render`'s arguments a page does not take: it asks for pictures itself.
_NOT_GIVEN = dict.fromkeys(
    (
        "ambient", "blend_below", "color_bar", "color_by", "color_map", "color_range", "cull",
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
