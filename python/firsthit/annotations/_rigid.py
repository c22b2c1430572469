"""Poses as rotations and lengths: what formats of rigid objects hold."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

    Floats = npt.NDArray[np.float64]

#: By how much axes may be off a right angle, or lengths differ, and still be rounding.
_ROUNDING = 1e-9


def rotation_and_scale(pose: Floats) -> tuple[Floats, Floats] | str:
    """Take a pose apart: a rotation, (3, 3), after a scale along the object's axes, (3,).

    Return why that cannot be, where it cannot.
    """
    scale = np.linalg.norm(pose[:3, :3], axis=0)
    rotation = pose[:3, :3] / scale
    if np.abs(rotation.T @ rotation - np.eye(3)).max() > _ROUNDING:
        return "its transform shears"
    if np.linalg.det(rotation) < 0.0:
        return "its transform mirrors"
    return rotation, scale


def is_uniform(scale: Floats) -> bool:
    """Tell whether a scale is the same along all axes."""
    return bool(scale.max() - scale.min() <= _ROUNDING * scale.max())
