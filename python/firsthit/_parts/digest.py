"""Digests of what frames hold: of arrays, never of files, whose writers change."""

from __future__ import annotations

import hashlib
import json
import math
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    import numpy.typing as npt

#: How much of a file is read at a time.
_PIECE = 1 << 20


def of_arrays(arrays: Mapping[str, npt.NDArray[Any]]) -> str:
    """Return the sha256 of arrays in their order, as text.

    Of each it takes the line ``["name", "dtype", [shape]]`` as JSON, and the elements in C order,
    little-endian.
    """
    made = hashlib.sha256()
    for name, array in arrays.items():
        plain = np.ascontiguousarray(array, array.dtype.newbyteorder("<"))
        head = json.dumps([name, plain.dtype.str, list(array.shape)])
        made.update(head.encode() + b"\n")
        # Its bytes without a copy.
        made.update(plain.reshape(-1).view(np.uint8).data)
    return made.hexdigest()


class Digests:
    """The sha256 of digests in their order, each as text and a new line."""

    def __init__(self) -> None:
        self._made = hashlib.sha256()

    def add(self, digest: str) -> None:
        """Take the next digest."""
        self._made.update(digest.encode() + b"\n")

    def text(self) -> str:
        """Return the digest of those that were taken."""
        return self._made.hexdigest()


def of_json(value: Any) -> str:
    """Return the sha256 of a value as `canonical` has it."""
    return hashlib.sha256(canonical(value)).hexdigest()


def finite(value: Any) -> Any:
    """Return a value in which infinities and NaN are texts, since JSON has no such numbers."""
    if isinstance(value, dict):
        return {name: finite(each) for name, each in value.items()}
    if isinstance(value, tuple | list):
        return [finite(each) for each in value]
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value


def of_file(path: Path) -> str:
    """Return the sha256 of a file's bytes."""
    with path.open("rb") as file:
        return of_stream(file)


def of_stream(file: BinaryIO) -> str:
    """Return the sha256 of the bytes that an open file still has."""
    made = hashlib.sha256()
    while piece := file.read(_PIECE):
        made.update(piece)
    return made.hexdigest()


def canonical(value: Any) -> bytes:
    """Return a value as JSON without blanks, its keys in their order; a ``ValueError`` for NaN.

    A value read from it has them in the same order, and gives the same text again.
    """
    try:
        text = json.dumps(value, separators=(",", ":"), allow_nan=False)
    except RecursionError:
        raise ValueError("nested too deeply") from None
    return text.encode()
