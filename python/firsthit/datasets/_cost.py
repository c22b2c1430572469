"""What a plan comes to, before anything is made."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from ._lidars import LidarSensor

if TYPE_CHECKING:
    from ._output import Output
    from ._sensors import PlannedSensor

#: Bytes of a pixel in an NPZ; others are float64.
_BYTES = {
    **dict.fromkeys(("object", "primitive", "face", "node", "mesh", "material"), 4),
    **dict.fromkeys(("front", "valid"), 1),
    **dict.fromkeys(("normal", "position", "barycentric", "base_color"), 24),
    "color": 12,
    "uv": 16,
}

#: Bytes of a return in a file: eighteen numbers, of which some are int32.
_RETURN = 112


class Cost(NamedTuple):
    """What a plan comes to.

    Attributes
    ----------
    frames : int
        The number of frames.
    rays : int
        The number of pixels and beams of all frames, each counted once.
    bytes : int
        About how many bytes the files of frames have: arrays as they are in memory, a return for
        each beam, PNGs as if they could not be compressed. Annotations are not counted.
    """

    frames: int
    rays: int
    bytes: int


def cost(sensors: tuple[PlannedSensor, ...], output: Output, frames: int) -> Cost:
    """Return what frames of these sensors come to."""
    rays = size = 0
    each = sum(_BYTES.get(name, 8) for name in output.channels) * len(output.frames)
    each += sum(2 if name in ("t", "range", "z") else 3 for name in output.pictures)
    for one in sensors:
        if isinstance(one, LidarSensor):
            beams = one.beams[0] * one.beams[1]
            rays += beams
            size += beams * _RETURN * len(output.clouds)
        else:
            pixels = one.shape[0] * one.shape[1]
            rays += pixels
            size += pixels * each
    return Cost(frames, frames * rays, frames * size)
