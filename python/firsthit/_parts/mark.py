"""A digest that tells whether a scene is as it was when a job began."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, NamedTuple

from firsthit import _firsthit
from firsthit._looks.lights import background_native
from firsthit._sensors.camera import Camera

from .digest import finite, of_json

if TYPE_CHECKING:
    from firsthit._scene.scene import Scene


class Mark(NamedTuple):
    """The digests of all that a scene's frames depend on.

    Attributes
    ----------
    fingerprint : str
        Of its objects and lights, as the metadata of pictures have it.
    setting : str
        The sha256 of what that leaves out, and frames depend on: names, up, background, shading,
        display, and edges if there are any.
    """

    fingerprint: str
    setting: str


def mark_of(scene: Scene) -> Mark:
    """Return the mark of a scene."""
    native = scene._ready().native
    camera = Camera((0, 0, 0), (1, 0, 0), (0, 0, 1), 1, 1, 1, 1, 1)
    fingerprint = json.loads(_firsthit.origin(native, camera._native, ["object"]))["scene"]
    look, background = scene.shading._native(), scene.background
    back = None if background is None else background_native(background)
    names = [(made.name, made.node, made.mesh_name) for made in scene.objects]
    said: list[Any] = [list(scene.up), back, look, scene.display._native, names]
    if scene.edges is not None:
        said.append(scene.edges._native())
    return Mark(fingerprint, of_json(finite(said)))
