"""A check whether distances fit into PNGs, as far as bounds tell before anything is rendered."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from firsthit._base.errors import warn
from firsthit._files.channels import DISTANCES
from firsthit._objects.shapes import Plane

from ._lidars import LidarSensor

if TYPE_CHECKING:
    from firsthit._scene.scene import Scene

    from ._plan import Plan
    from ._sensors import PictureSensor

#: The largest number in a PNG of 16 bits.
_MOST_STEPS = 65535


def warn_of_distances(plan: Plan, number: int, scene: Scene) -> None:
    """Warn where a surface of a scene may be farther off than PNGs of distances can say.

    The writer refuses such a picture, which may be that of the last frame. Bounds know only how far
    surfaces may be: whether a pixel shows them is another question.
    """
    output = plan._output
    names = [name for name in output.pictures if name in DISTANCES]
    sensors = [one for one in plan._sensors if not isinstance(one, LidarSensor)]
    if not names or output.png_scale is None or output.far is not None:
        return
    most = _MOST_STEPS * output.png_scale
    ends = f"PNGs of {', '.join(names)} end at {most:g}, {_MOST_STEPS} steps of `png_scale`"
    there = f"scene {plan.scenes[number]!r}:"
    shown = [made for made in scene.objects if not (made.hidden or made.removed)]
    endless = next((made for made in shown if isinstance(made.shape, Plane)), None)
    if endless is not None:
        warn(f"{there} {ends}, and object {endless.name!r} has no end: a pixel may show it beyond")
        return
    far, sensor = max((_farthest(plan, one, scene), one.name) for one in sensors)
    # Rounding alone is no overflow.
    if far > most * (1.0 + 1e-9):
        enough = _rounded_up(far / _MOST_STEPS)
        warn(
            f"{there} {ends}, and a surface may be {far:.4g} from sensor {sensor!r}; a scale of "
            f"{enough:g} is enough for all"
        )


def _farthest(plan: Plan, sensor: PictureSensor, scene: Scene) -> float:
    """Return how far a surface may be from a sensor in any frame; 0 if there is none."""
    bounds = scene.bounds
    if not np.isfinite(bounds).all():
        return 0.0
    places, beside = plan._poses.places(scene, sensor.seeing(0.0)[1])
    corners = np.stack(np.meshgrid(*bounds.T), axis=-1).reshape(-1, 3)
    # The farthest point of a box, and of the hull of places, is a corner.
    away = max(float(np.linalg.norm(places - corner, axis=1).max()) for corner in corners)
    return away + beside + float(np.linalg.norm(sensor.camera.position))


def _rounded_up(number: float) -> float:
    """Return a number with three digits that is not smaller."""
    unit = float(10.0 ** (math.floor(math.log10(number)) - 2))
    return math.ceil(number / unit) * unit
