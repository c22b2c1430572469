"""PNGs of whole numbers, without a library."""

from __future__ import annotations

import struct
import zlib
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt


def as_png(values: npt.NDArray[Any]) -> bytes:
    """Return a PNG of (rows, columns) or (rows, columns, 3) numbers of 8 or 16 bits."""
    rows, columns = values.shape[:2]
    depth, kind = 8 * values.dtype.itemsize, 0 if values.ndim == 2 else 2
    flat = np.ascontiguousarray(values, values.dtype.newbyteorder(">")).reshape(rows, -1)
    # Every row begins with the number of its filter: none.
    lines = np.zeros((rows, 1 + flat.dtype.itemsize * flat.shape[1]), np.uint8)
    lines[:, 1:] = flat.view(np.uint8)
    header = struct.pack(">IIBBBBB", columns, rows, depth, kind, 0, 0, 0)
    chunks = (
        (b"IHDR", header),
        (b"IDAT", zlib.compress(lines.tobytes(), 6)),
        (b"IEND", b""),
    )
    made = [b"\x89PNG\r\n\x1a\n"]
    for name, data in chunks:
        check = zlib.crc32(name + data)
        made.append(struct.pack(">I", len(data)) + name + data + struct.pack(">I", check))
    return b"".join(made)
