"""Hits of a part in a file."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from pathlib import Path

    import numpy.typing as npt

    Arrays = dict[str, npt.NDArray[Any]]

#: The extensions of files of hits.
EXTENSIONS = (".npz", ".parquet")


def check_package(extension: str) -> None:
    """Refuse a format whose package is missing, before anything is shot."""
    if extension == ".parquet":
        _pyarrow()


def write_hits(path: Path, arrays: Arrays, table: Arrays) -> None:
    """Write arrays by channel, or as a table with a column for each number."""
    if path.suffix == ".npz":
        with path.open("wb") as file:
            np.savez(file, **arrays)  # type: ignore[arg-type] # the names are those of channels
        return
    pyarrow, parquet = _pyarrow()
    floats = [name for name, column in table.items() if column.dtype.kind == "f"]
    others = [name for name in table if name not in floats]
    # The bytes of floating-point numbers, sorted by their place, are what compresses.
    parquet.write_table(
        pyarrow.table(table),
        path,
        compression="zstd",
        use_byte_stream_split=floats or False,
        use_dictionary=others or False,
    )


def _pyarrow() -> tuple[Any, Any]:
    try:
        return importlib.import_module("pyarrow"), importlib.import_module("pyarrow.parquet")
    except ImportError:
        raise ImportError("a .parquet takes the package pyarrow: pip install pyarrow") from None
