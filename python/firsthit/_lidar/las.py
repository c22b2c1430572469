"""LAS 1.4 files: https://www.asprs.org/wp-content/uploads/2019/07/LAS_1_4_r15.pdf."""

from __future__ import annotations

import importlib
import io
import json
import struct
from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit import _firsthit

if TYPE_CHECKING:
    import numpy.typing as npt

    from .lidar_scan import LidarScan

#: The sizes of the header, of that of a variable length record, of a description of extra bytes.
_HEADER, _RECORD_HEADER, _DESCRIPTION = 375, 54, 192

#: Whose the record of the metadata is, and its number.
_METADATA = (b"firsthit", 1)

#: A point of format 6.
_POINT = [
    ("X", "<i4"),
    ("Y", "<i4"),
    ("Z", "<i4"),
    ("intensity", "<u2"),
    ("returns", "u1"),
    ("flags", "u1"),
    ("classification", "u1"),
    ("user_data", "u1"),
    ("scan_angle", "<i2"),
    ("point_source_id", "<u2"),
    ("gps_time", "<f8"),
]

#: What follows each point: its name, its type here and there, and what it is.
_EXTRA = [
    ("range", "<f8", 10, "distance along the beam"),
    ("incidence", "<f4", 9, "angle to the normal, rad"),
    ("object", "<i4", 6, "identifier of the object"),
    ("ring", "<i4", 6, "number of the laser"),
    ("row", "<i4", 6, "row of the beam"),
    ("column", "<i4", 6, "column of the beam"),
]

#: Where the header has the day and the year.
_DAY = slice(90, 94)

#: The most returns of a pulse that four bits hold.
_MOST_RETURNS = 15

#: The bit that says that coordinate systems, of which there is none, are in WKT: format 6 asks for
#: it.
_WKT = 1 << 4


def encode(scan: LidarScan) -> bytes:
    """Return the bytes of a file of a scan."""
    points = scan.point
    # What LAS cannot count says that it is the last that LAS can.
    returned = np.minimum(scan.return_number, _MOST_RETURNS)
    total = np.minimum(scan.number_of_returns, _MOST_RETURNS)
    low, high = _bounds(points)
    offset, scale = np.floor(low), _scale(low, high)
    records = np.zeros(len(scan), [*_POINT, *((name, kind) for name, kind, _, _ in _EXTRA)])
    steps = np.rint((points - offset) / scale)
    for axis, name in enumerate("XYZ"):
        records[name] = steps[:, axis]
    if scan.intensity is not None:
        records["intensity"] = np.rint(np.clip(scan.intensity, 0.0, 1.0) * 65535.0)
    records["returns"] = returned | total << 4
    records["gps_time"] = scan.time
    if scan.classification is not None:
        records["classification"] = scan.classification
    for name, *_ in _EXTRA:
        records[name] = scan[name]
    length = _DESCRIPTION * len(_EXTRA)
    start = _HEADER + _RECORD_HEADER + length
    stored = steps * scale + offset
    box = _bounds(stored)
    content = records.tobytes()
    header = _header(
        len(scan),
        (start, start + len(content)),
        records.dtype.itemsize,
        returned,
        (scale, offset, box),
    )
    about = struct.pack("<H16sHH32s", 0, b"LASF_Spec", 4, length, b"firsthit")
    # Behind the points a record may be longer than 64 KiB, as that of a long drive is.
    said = json.dumps(scan.metadata).encode()
    after = struct.pack("<H16sHQ32s", 0, *_METADATA, len(said), b"metadata, JSON")
    return header + about + b"".join(map(_described, _EXTRA)) + content + after + said


def compress(content: bytes) -> bytes:
    """Return the same file as LAZ."""
    try:
        laspy: Any = importlib.import_module("laspy")
    except ImportError:
        raise ImportError(_NEEDED) from None
    if not laspy.LazBackend.detect_available():
        raise ImportError(_NEEDED)
    out = io.BytesIO()
    laspy.read(io.BytesIO(content)).write(out, do_compress=True)
    compressed = bytearray(out.getvalue())
    # laspy writes the day: the same scan has the same bytes.
    compressed[_DAY] = bytes(4)
    return bytes(compressed)


_NEEDED = "a .laz takes the packages laspy and lazrs: pip install 'laspy[lazrs]'; a .las takes none"


def _bounds(points: npt.NDArray[np.float64]) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
    if len(points) == 0:
        return np.zeros(3), np.zeros(3)
    return points.min(axis=0), points.max(axis=0)


def _scale(low: npt.NDArray[np.float64], high: npt.NDArray[np.float64]) -> float:
    """Return the length of a step: 1e-4, or ten times as much until int32 holds all."""
    extent = float((high - np.floor(low)).max())
    for exponent in range(4, -12, -1):
        scale = 10.0**-exponent
        if extent / scale < 2**31 - 1:
            return scale
    raise ValueError(f"LAS must hold points within 1e20, got an extent of {extent:g}")


def _header(
    count: int,
    places: tuple[int, int],
    record: int,
    returned: npt.NDArray[np.int32],
    place: tuple[float, npt.NDArray[Any], tuple[npt.NDArray[Any], npt.NDArray[Any]]],
) -> bytes:
    """Return the header of a file whose points begin and end at ``places``."""
    start, end = places
    scale, offset, (low, high) = place
    by_return = [int(np.count_nonzero(returned == k)) for k in range(1, _MOST_RETURNS + 1)]
    software = f"firsthit {_firsthit.version()}".encode()
    # The day is none: the same scan has the same bytes.
    header = struct.pack(
        "<4sHH16sBB32s32sHHHIIBHI5I",
        b"LASF", 0, _WKT, bytes(16), 1, 4, b"firsthit", software, 0, 0, _HEADER, start, 1, 6,
        record, 0, 0, 0, 0, 0, 0,
    )  # fmt: skip
    header += struct.pack("<6d", scale, scale, scale, *offset)
    header += struct.pack("<6d", *(x for axis in range(3) for x in (high[axis], low[axis])))
    return header + struct.pack("<QQIQ15Q", 0, end, 1, count, *by_return)


def _described(extra: tuple[str, str, int, str]) -> bytes:
    """Return the description of some extra bytes."""
    name, _, kind, about = extra
    made = struct.pack("<2sBB32s4s", b"", kind, 0, name.encode(), b"")
    return made + bytes(_DESCRIPTION - len(made) - 32) + about.encode().ljust(32, b"\0")
