"""Polygons of any number of corners, which meshes have as triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import numbers

if TYPE_CHECKING:
    import numpy.typing as npt


class Polygons(NamedTuple):
    """The corners of polygons, one after the other, and how many each has."""

    corners: npt.NDArray[Any]
    sizes: npt.NDArray[np.integer[Any]]

    def __len__(self) -> int:
        """Return the number of polygons."""
        return len(self.sizes)


def joined(rows: Any) -> Polygons:
    """Return lists of corners as polygons: an array of them, or lists of any lengths."""
    if isinstance(rows, np.ndarray) and rows.ndim == 2:
        return Polygons(rows.reshape(-1), np.full(len(rows), rows.shape[1]))
    lists = [np.asarray(row) for row in rows]
    wrong = next((k for k, row in enumerate(lists) if row.ndim != 1), None)
    if wrong is not None:
        raise ValueError(f"polygon {wrong} must be a list of corners, got {rows[wrong]!r}")
    corners = np.concatenate(lists) if lists else np.empty(0, np.int64)
    return Polygons(corners, np.array([len(row) for row in lists], np.int64))


def polygons_of(given: Any) -> Polygons | None:
    """Return what is given as polygons; ``None`` for triangles, and for what is neither."""
    if isinstance(given, Polygons):
        return None if (given.sizes == 3).all() else given
    if isinstance(given, list | tuple) and all(hasattr(row, "__len__") for row in given):
        sizes = {len(row) for row in given}
        return joined(given) if sizes - {3} else None
    shape: tuple[int, ...] = getattr(given, "shape", ())
    if len(shape) == 2 and shape[0] and shape[1] > 3:
        return joined(numbers("triangles", given))
    return None


def indices(name: str, value: Any, vertices: int) -> npt.NDArray[np.uint32]:
    """Return the indices of vertices, checked, in the shape in which they are given."""
    array = numbers(name, value)
    with np.errstate(invalid="ignore"):
        is_whole = array.dtype.kind != "f" or np.all(array == np.floor(array))
    if not is_whole:
        raise ValueError(f"{name} must be whole numbers, got dtype {array.dtype}")
    if array.size and not 0 <= array.min() <= array.max() < max(vertices, 1):
        span = f"from {array.min()} to {array.max()}"
        raise ValueError(f"{name} must be indices of {vertices} vertices, got {span}")
    return array.astype(np.uint32, copy=False)


def cut(
    points: npt.NDArray[np.float64], polygons: Polygons
) -> tuple[npt.NDArray[np.uint32], npt.NDArray[np.uint32]]:
    """Return the triangles of polygons, (m, 3), and of each the polygon that it is part of."""
    short = np.flatnonzero(polygons.sizes < 3)
    if short.size:
        few = int(polygons.sizes[short[0]])
        raise ValueError(f"polygons must have three corners or more, polygon {short[0]} has {few}")
    corners = indices("triangles", polygons.corners, len(points))
    sizes = polygons.sizes.astype(np.uint32)
    return _firsthit.polygons(points, np.ascontiguousarray(corners), sizes)
