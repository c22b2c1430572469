"""Files of scans: what they say of themselves, and reading them."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit import _firsthit
from firsthit._base.errors import FileFormatError

if TYPE_CHECKING:
    import numpy.typing as npt


#: The version of the form, which is that of frames.
_VERSION = 1

#: The arrays of a scan, with their types.
ARRAYS = {
    "point": np.dtype((np.float64, 3)),
    "sensor_point": np.dtype((np.float64, 3)),
    "range": np.dtype(np.float64),
    "object": np.dtype(np.int32),
    "primitive": np.dtype(np.int32),
    "incidence": np.dtype(np.float64),
    "ring": np.dtype(np.int32),
    "row": np.dtype(np.int32),
    "column": np.dtype(np.int32),
    "time": np.dtype(np.float64),
    "return_number": np.dtype(np.int32),
    "number_of_returns": np.dtype(np.int32),
    "intensity": np.dtype(np.float64),
    "classification": np.dtype(np.int32),
}

#: The arrays that a scan has only if they were asked for.
OPTIONAL = ("intensity", "classification")

#: The entries that say where a scan comes from; the last two need not be there.
ORIGIN_KEYS = ("scene", "sensor", "scan", "scans")

#: What each array is, in which unit and frame.
_ABOUT: dict[str, tuple[str, str | None, str | None]] = {
    "point": ("where the return is: along the middle of the beam", "scene length", "world"),
    "sensor_point": (
        "the same from the scanner, forwards, left and up",
        "scene length",
        "sensor",
    ),
    "range": ("distance along the beam", "scene length", "sensor"),
    "object": ("identifier of the object that was met", None, None),
    "primitive": ("index of the triangle that was met in its mesh", None, None),
    "incidence": ("angle between the beam and the normal", "radian", None),
    "ring": ("number of the laser", None, None),
    "row": ("row of the beam", None, None),
    "column": ("column of the beam", None, None),
    "time": ("time of the beam", "second", None),
    "return_number": ("number of the return in its beam, from 1", None, None),
    "number_of_returns": ("returns of the beam, kept or not; max_returns at most", None, None),
    "intensity": ("share of the light that comes back", None, None),
    "classification": ("class of the object that was met", None, None),
}


def metadata(origin: str, arrays: dict[str, npt.NDArray[Any]]) -> dict[str, Any]:
    """Return what files say of a scan with these arrays; ``origin``: of what, and how."""
    said: dict[str, Any] = json.loads(origin)
    channels = []
    for name, array in arrays.items():
        about, unit, frame = _ABOUT[name]
        channels.append(
            {
                "name": name,
                "about": about,
                "dtype": array.dtype.name,
                "components": array.shape[1] if array.ndim == 2 else 1,
                "unit": unit,
                "frame": frame,
                "miss": "none",
            }
        )
    count = len(next(iter(arrays.values())))
    kept = {name: said[name] for name in ("scan", "scans") if said.get(name) is not None}
    return {
        "metadata_version": _VERSION,
        "firsthit": _firsthit.version(),
        "scene": said["scene"],
        "shape": [count],
        "pixels": None,
        "camera": None,
        "sensor": said["sensor"],
        "samples": None,
        "channels": channels,
        **kept,
    }


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
