"""Shared parts of the replacements: arrays of other packages, and the normals of triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

#: Just below zero. Rays have ``t_min < t``, and a surface at the origin counts for both peers.
TOUCHING = float(np.nextafter(0.0, -1.0))


def is_of(package: str, thing: object) -> bool:
    """Tell whether a package made the class of something, or a class that it inherits from."""
    return any(kind.__module__.split(".")[0] == package for kind in type(thing).__mro__)


def unit_normals(corners: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the normals of triangles (..., 3, 3), to the side where they are counter-clockwise.

    They are (..., 3) and of length one; zero for triangles without an area.
    """
    edges = corners[..., 1:, :] - corners[..., :1, :]
    # Squares of very short or very long edges would leave float64.
    size = np.abs(edges).max(axis=(-2, -1), keepdims=True, initial=0.0)
    edges = edges / np.where(size > 0.0, size, 1.0)
    normals = np.cross(edges[..., 0, :], edges[..., 1, :])
    lengths = np.linalg.norm(normals, axis=-1, keepdims=True)
    unit: npt.NDArray[np.float64] = normals / np.where(lengths > 0.0, lengths, 1.0)
    return unit
