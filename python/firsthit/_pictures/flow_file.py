"""Files of optical flow and disparity, as Middlebury and KITTI have them.

Baker and others, "A Database and Evaluation Methodology for Optical Flow", IJCV 92, 2011; Menze and
Geiger, "Object Scene Flow for Autonomous Vehicles", CVPR 2015, and KITTI's development kit.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from firsthit import _firsthit
from firsthit._base.log import timed
from firsthit._files.png import as_png

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy.typing as npt

    Floats = npt.NDArray[np.float64]
    Bools = npt.NDArray[np.bool_]

#: Numbers of a ``.flo`` beyond 1e9 are unknown to its readers.
_UNKNOWN = np.float32(1e10)

#: How many steps of KITTI's flow and disparity are a pixel, and the flow's zero.
_FLOW_STEPS, _ZERO, _STEPS = 64.0, 1 << 15, 256.0

_MOST = 65535


def save_flow(path: str | os.PathLike[str], flow: Floats) -> None:
    """Write a flow, see `Flow.save`."""
    _save(path, flow, {".flo": _flo, ".png": _kitti_flow})


def save_disparity(path: str | os.PathLike[str], disparity: Floats) -> None:
    """Write a disparity, see `Disparity.save`."""
    _save(path, disparity, {".pfm": _pfm, ".png": _kitti_disparity})


def _save(
    path: str | os.PathLike[str], values: Floats, formats: dict[str, Callable[[Floats], bytes]]
) -> None:
    suffix = Path(path).suffix.lower()
    if suffix not in formats:
        raise ValueError(f"path must end in {' or '.join(formats)}, got {os.fspath(path)}")
    with timed("wrote %s", path):
        _firsthit.write_bytes(Path(path), formats[suffix](values))


def _flo(flow: Floats) -> bytes:
    rows, columns = flow.shape[:2]
    known: Bools = np.asarray(np.isfinite(flow).all(axis=-1))
    if (np.abs(flow[known]) >= 1e9).any():
        raise ValueError("a .flo takes what is beyond 1e9 for unknown, and a pixel flows so far")
    values = np.where(known[..., None], flow, _UNKNOWN).astype("<f4")
    sides = np.array([columns, rows], "<i4")
    return b"PIEH" + sides.tobytes() + values.tobytes()


def _kitti_flow(flow: Floats) -> bytes:
    known: Bools = np.asarray(np.isfinite(flow).all(axis=-1))
    steps = np.rint(np.where(known[..., None], flow, 0.0) * _FLOW_STEPS) + _ZERO
    _refuse("flow", flow, (steps < 0) | (steps > _MOST), "-512 to 511.98 pixels")
    levels = np.where(known[..., None], steps, 0.0)
    return as_png(np.concatenate([levels, known[..., None]], axis=-1).astype(np.uint16))


def _kitti_disparity(disparity: Floats) -> bytes:
    known = np.isfinite(disparity)
    # 0 is unknown, so a disparity that rounds to it is the least there is.
    steps = np.maximum(np.rint(np.where(known, disparity, 0.0) * _STEPS), known)
    _refuse("disparity", disparity, steps > _MOST, "0 to 255.99 pixels")
    return as_png(steps.astype(np.uint16))


def _pfm(disparity: Floats) -> bytes:
    rows, columns = disparity.shape
    # From the bottom row up; unknown is infinity, as Middlebury's readers have it.
    values = np.where(np.isfinite(disparity), disparity, np.inf)[::-1].astype("<f4")
    return f"Pf\n{columns} {rows}\n-1.0\n".encode() + values.tobytes()


def _refuse(what: str, values: Floats, wrong: Bools, span: str) -> None:
    if wrong.any():
        row, column = (int(k) for k in np.argwhere(wrong)[0][:2])
        raise ValueError(
            f"a .png of KITTI's holds a {what} of {span}, got {values[row, column].tolist()} "
            f"at row {row}, column {column}; the other format holds it"
        )
