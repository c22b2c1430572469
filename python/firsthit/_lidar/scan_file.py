"""Reading what `LidarScan.save` wrote."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit import _firsthit
from firsthit._base.errors import FileFormatError

from .scan_metadata import ARRAYS, OPTIONAL, ORIGIN_KEYS

if TYPE_CHECKING:
    import numpy.typing as npt

#: The kinds of sensors that scans are of: scanners, and rays of one's own.
_KINDS = ("lidar", "rays")


def read_scan(
    path: str | os.PathLike[str],
) -> tuple[dict[str, npt.NDArray[Any]], tuple[int, int], str]:
    """Return the arrays of a scan's file, the rows and columns of its beams, and its origin.

    Raises
    ------
    FileReadError, FileFormatError
        If the file cannot be read, is not that of a scan, or its arrays do not fit together.
    """
    text = os.fspath(path)
    if Path(path).suffix.lower() != ".npz":
        raise FileFormatError(f"{text}: a scan is read from an .npz", text)
    found, said, _ = _firsthit.read(Path(path))
    try:
        return _fitting(found, said)
    except ValueError as error:
        raise FileFormatError(f"{text}: not a scan of a lidar: {error}", text) from None


def _fitting(
    found: list[tuple[str | None, list[int], npt.NDArray[Any], str]], said: str | None
) -> tuple[dict[str, npt.NDArray[Any]], tuple[int, int], str]:
    about = json.loads(said or "{}")
    sensor = about.get("sensor")
    if not isinstance(sensor, dict) or sensor.get("kind") not in _KINDS or "scene" not in about:
        raise ValueError("its metadata lack a lidar or a scene")
    rows, columns = sensor.get("rows"), _columns(about)
    if not (isinstance(rows, int) and rows > 0 and rows * columns < 2**62):
        raise ValueError(f"its lidar has {rows} x {columns} beams")
    # Whole numbers are read as int64, whatever the file has.
    named = {
        name: values.astype(stored, copy=False).reshape(shape)
        for name, shape, values, stored in found
        if name is not None
    }
    missing = [name for name in ARRAYS if name not in named and name not in OPTIONAL]
    if missing:
        raise ValueError(f"it has no {missing[0]}")
    arrays = {}
    for name, kind in ARRAYS.items():
        if name not in named:
            continue
        array, wanted = named[name], (len(named["range"]), *kind.shape)
        if array.shape != wanted or array.dtype != kind.base:
            raise ValueError(
                f"{name} must be {kind.base} of the shape {wanted}, "
                f"got {array.dtype} of {array.shape}"
            )
        arrays[name] = np.ascontiguousarray(array)
    for name, most in (("row", rows), ("column", columns)):
        if ((arrays[name] < 0) | (arrays[name] >= most)).any():
            raise ValueError(f"{name} must be from 0 on and below {most}")
    return (
        arrays,
        (rows, columns),
        json.dumps({name: about[name] for name in ORIGIN_KEYS if name in about}),
    )


def _columns(about: dict[str, Any]) -> int:
    """Return the columns of all scans together."""
    scans = about.get("scans", [about["sensor"]])
    try:
        each = [scan["columns"] for scan in scans]
    except (KeyError, TypeError):
        raise ValueError("its scans have no columns") from None
    if not all(isinstance(count, int) and 0 < count < 2**31 for count in each):
        raise ValueError(f"its scans have {each} columns")
    return sum(each)
