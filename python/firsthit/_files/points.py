"""Points of clouds, of whatever format."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from firsthit import _firsthit
from firsthit._base.errors import warn

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt


class Points(NamedTuple):
    """Points with whatever else their file says of each.

    Attributes
    ----------
    positions : (n, 3) array of float
        Where they are, in the file's coordinates and in its order. Those of rays that met nothing
        are not finite.
    columns : dict of str to (n,) or (n, k) array
        All other fields, by name, in the types of the file: ``intensity``, ``normal``, ...
    """

    positions: npt.NDArray[np.float64]
    columns: dict[str, npt.NDArray[Any]]


def read_points(path: str | os.PathLike[str]) -> Points:
    r"""Read points from a file.

    Parameters
    ----------
    path : path-like
        A PLY (of a mesh the vertices), a PCD, a LAS or LAZ, an ``.npy`` of the shape (n, 3), an
        ``.npz`` or ``.exr`` with an array ``points`` or a channel ``position``, or text: a line for
        each point, with commas, semicolons, tabs or blanks between its numbers, and with or without
        a line of names before. Its first bytes tell the format. ``docs/nearest.md`` has more.

    Returns
    -------
    Points
        The positions and the other columns.

    Raises
    ------
    FileReadError
        If the system refuses to read it; also an `OSError`.
    FileFormatError
        For content that has no points, with the line; also a `ValueError`.

    Warns
    -----
    FirsthitWarning
        For what is doubtful in the file.

    Examples
    --------
    >>> from pathlib import Path
    >>> scene = fh.Scene()
    >>> ball = scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
    >>> _ = Path("scan.xyz").write_text("0 0 3 17\n0 2 0 42\n")
    >>> points, columns = fh.read_points("scan.xyz")
    >>> scene.signed_distance(points)
    array([2., 1.])
    >>> columns
    {'column_3': array([17., 42.])}
    """
    positions, arrays, doubts = _firsthit.read_points(Path(path))
    for doubt in doubts:
        warn(f"{os.fspath(path)}: {doubt}")
    columns = {
        name: values.astype(kind, copy=False).reshape(shape)
        for name, shape, values, kind in arrays
        if name is not None
    }
    return Points(positions.reshape(-1, 3), columns)
