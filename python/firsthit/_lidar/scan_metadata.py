"""The metadata of a laser scan in files, in the form that files of frames have."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit import _firsthit

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
