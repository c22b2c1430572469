"""Hits of a part in a file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit._base.optional import optional

if TYPE_CHECKING:
    from pathlib import Path

    import numpy.typing as npt

    Arrays = dict[str, npt.NDArray[Any]]

#: The extensions of files of hits.
EXTENSIONS = (".npz", ".parquet")


def write_hits(path: Path, arrays: Arrays, table: Arrays) -> None:
    """Write arrays by channel, or as a table with a column for each number."""
    if path.suffix == ".npz":
        with path.open("wb") as file:
            np.savez(file, **arrays)  # type: ignore[arg-type] # the names are those of channels
        return
    floats = [name for name, column in table.items() if column.dtype.kind == "f"]
    others = [name for name in table if name not in floats]
    # The bytes of floating-point numbers, sorted by their place, are what compresses.
    optional("pyarrow.parquet", "a .parquet").write_table(
        optional("pyarrow", "a .parquet").table(table),
        path,
        compression="zstd",
        use_byte_stream_split=floats or False,
        use_dictionary=others or False,
    )
