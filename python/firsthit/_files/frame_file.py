"""The channels of pictures and of hits as files hold them."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit import _firsthit
from firsthit._base.errors import FileFormatError, warn
from firsthit._base.log import timed

from .channels import is_cloud

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

#: The types of channels, as metadata name them, and those that an EXR holds as uint32.
_DTYPES = ("float64", "float32", "int32", "bool")
_AS_UINT32 = _DTYPES[2:]


def read_metadata(path: str | os.PathLike[str]) -> dict[str, Any] | None:
    """Read what an output says of itself.

    Parameters
    ----------
    path : path-like
        ``.exr``, ``.npz``, ``.npy`` (whose metadata are in ``NAME.npy.json``), ``.png``, ``.ply``
        or ``.pcd``.

    Returns
    -------
    dict or None
        As `Frame.metadata`, and how the file stores each channel; ``None`` for a file without
        metadata. ``docs/outputs.md`` and the JSON Schema beside it say what every entry means.

    Raises
    ------
    FileReadError, FileFormatError
        As `Frame.load`.
    ValueError
        For an unknown extension.

    Warns
    -----
    FirsthitWarning
        For what is doubtful in the file.
    """
    _, said = _read(path)
    return None if said is None else json.loads(said)


def _read(path: str | os.PathLike[str]) -> tuple[list[Any], str | None]:
    """Return the arrays in a file and the text of its metadata; warn of what is doubtful."""
    arrays, said, doubts = _firsthit.read(Path(path))
    for doubt in doubts:
        warn(f"{os.fspath(path)}: {doubt}")
    return arrays, said


def read_channels(
    path: str | os.PathLike[str],
) -> tuple[dict[str, npt.NDArray[Any]], str | None]:
    """Return the channels of a picture in a file, and the text of its metadata."""
    if is_cloud(path):
        raise ValueError(
            f"{os.fspath(path)} must hold a picture, got a point cloud, which is a list of "
            "points; read_points reads them, and read_metadata its metadata"
        )
    arrays, said = _read(path)
    records = {} if said is None else {c["name"]: c for c in json.loads(said)["channels"]}
    channels = {}
    for name, shape, values, stored_as in arrays:
        if len(shape) < 2:
            raise ValueError(
                f"{os.fspath(path)} must hold a picture, got the shape {shape}; numpy.load "
                "reads arrays, and read_metadata what is said of them"
            )
        dtype = str(values.dtype) if values.dtype.kind == "f" else stored_as
        if name in records:
            # Any file can say anything, and NumPy would take names of huge types or of objects.
            computed = records[name]["dtype"]
            possible = _AS_UINT32 if stored_as == "uint32" else _DTYPES
            if computed not in possible:
                wanted = f"{', '.join(possible[:-1])} or {possible[-1]}"
                what = f"metadata of channel {name!r}: dtype must be {wanted}, got {computed!r}"
                raise FileFormatError._of(path, what)
            said_stored = records[name].get("stored") or {}
            # How an EXR holds int32 and bool, and a PNG labels.
            if stored_as == "uint32" or said_stored.get("encoding") == "labels":
                dtype = computed
        channels[name or "array"] = values.astype(dtype, copy=False).reshape(shape)
    return channels, said


def write_channels(
    path: Path,
    shape: Sequence[int],
    channels: list[tuple[str, npt.NDArray[Any]]],
    origin: str,
    how: _firsthit._Stored,
    display: tuple[float, str] | None,
) -> None:
    """Write flat channels to a file; warn of what it holds too coarsely."""
    with timed("wrote %s", path):
        doubt = _firsthit.write(path, list(shape), channels, origin, how, display)
    if doubt is not None:
        warn(f"{path}: {doubt}")


def channel_array(what: str, given: Any, shape: tuple[int, ...]) -> npt.NDArray[Any]:
    """Return the array of a channel of one's own, with one number or several at each place."""
    try:
        array = np.asarray(given)
    except ValueError as error:
        raise ValueError(f"{what} must be an array: {error}") from None
    if array.dtype.kind not in "fiub":
        raise ValueError(f"{what} must be bool or real numbers, got dtype {array.dtype}")
    axes = len(shape)
    if array.ndim not in (axes, axes + 1) or array.shape[:axes] != shape:
        wanted = f"{shape} or {(*shape, 'k')}".replace("'", "")
        raise ValueError(f"{what} must have the shape {wanted}, got {array.shape}")
    return array


def in_file(name: str, array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return a channel, flat, in the type in which files hold it."""
    if array.dtype.kind in "iu" and array.dtype != np.int32:
        low, high = (int(array.min()), int(array.max())) if array.size else (0, 0)
        if low < -(2**31) or high >= 2**31:
            span = f"{low} to {high}"
            raise ValueError(f"channel {name!r} must be int32 to be written, got {span}")
        array = array.astype(np.int32)
    elif array.dtype.kind == "f" and array.dtype not in (np.float64, np.float32):
        array = array.astype(np.float32 if array.dtype.itemsize < 4 else np.float64)
    return np.ascontiguousarray(array).ravel()
