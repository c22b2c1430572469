"""Estimates of a plan's cost without rendering."""

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
    **dict.fromkeys(("crypto_object", "crypto_material"), 48),
    "color": 12,
    **dict.fromkeys(("edge", "alpha", "ao", "samples"), 4),
    "uv": 16,
}

#: Numbers of a pixel in an EXR, each of four bytes at most; others are one.
_NUMBERS = {
    **dict.fromkeys(("color", "normal", "position", "barycentric", "base_color"), 3),
    **dict.fromkeys(("crypto_object", "crypto_material"), 12),
    "uv": 2,
}

#: About how many bytes a return has in files, if nothing can be compressed and without intensity.
_RETURN = {"npz": 100, "ply": 100, "pcd": 68, "csv": 190, "las": 58, "laz": 58, "parquet": 100}


class Cost(NamedTuple):
    """The cost of a plan.

    Attributes
    ----------
    frames : int
        The number of frames.
    rays : int
        The number of pixels and beams of all frames, each counted once.
    bytes : int
        About how many bytes the files of frames have at most: a return for each beam, and all
        as if it could not be compressed. Annotations are not counted.
    """

    frames: int
    rays: int
    bytes: int


def cost(sensors: tuple[PlannedSensor, ...], output: Output, frames: int) -> Cost:
    """Return what frames of these sensors come to."""
    rays = size = 0
    each = 0
    if "npz" in output.frames:
        each += sum(_BYTES.get(name, 8) for name in output.channels)
    if "exr" in output.frames:
        each += sum(4 * _NUMBERS.get(name, 1) for name in output.channels)
    each += sum(2 if name in ("t", "range", "z") else 3 for name in output.pictures)
    moves = {"flo": 8, "png": 6}
    each += sum(moves[form] for form in output.motion.flow)
    for one in sensors:
        if isinstance(one, LidarSensor):
            beams = one.beams[0] * one.beams[1]
            rays += beams
            size += beams * sum(_RETURN[form] for form in output.clouds)
        else:
            pixels = one.shape[0] * one.shape[1]
            rays += pixels
            size += pixels * each
            if output.motion.pair is not None and one is output.motion.pair[0]:
                size += pixels * sum({"png": 2, "pfm": 4}[form] for form in output.motion.disparity)
    return Cost(frames, frames * rays, frames * size)
