"""Digests that tell sensors from others."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from firsthit import _firsthit
from firsthit._parts.digest import Digests, of_json
from firsthit._scene.scene import Scene
from firsthit._sensors.sensor import Sensor

if TYPE_CHECKING:
    from collections.abc import Sequence


def digest_of(cameras: Sequence[Sensor]) -> str:
    """Return the sha256 of cameras and other sensors, in their order."""
    made, nothing = Digests(), Scene()._ready().native
    for camera in cameras:
        if not isinstance(camera, Sensor):
            raise TypeError(f"cameras must be cameras or other sensors, got {camera!r}")
        said = json.loads(_firsthit.origin(nothing, camera._native, []))
        made.add(of_json([said.get("camera"), said.get("sensor")]))
    return made.text()
