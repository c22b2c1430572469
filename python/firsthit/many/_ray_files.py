"""Rays in files: how many there are, and some of them."""

from __future__ import annotations

import functools
import glob
import hashlib
import os
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from firsthit._base.errors import FileFormatError, FileMissingError, FileReadError, blaming
from firsthit._base.optional import optional

if TYPE_CHECKING:
    import numpy.typing as npt

#: Origins and directions, and limits where the file has them.
Table = dict[str, "npt.NDArray[Any]"]

#: The extensions of files of rays.
FILES = (".npz", ".npy", ".parquet")

#: How many bytes of a file's beginning and end are in a job's digest.
_END = 1 << 16

#: The names of columns, as in the program's CSV of rays.
_COLUMNS = ("ox", "oy", "oz", "dx", "dy", "dz")
_LIMITS = ("t_min", "t_max")


class RayFile(NamedTuple):
    """A file of rays."""

    path: Path
    rows: int

    def ends(self) -> tuple[int, str]:
        """Return its size in bytes, and the sha256 of its beginning and its end.

        They tell one file from another without reading all of it. A change of numbers in the
        middle alone is not told.
        """
        made = hashlib.sha256()
        with blaming(self.path, FileReadError), self.path.open("rb") as file:
            size = file.seek(0, os.SEEK_END)
            for start in (0, max(0, size - _END)):
                file.seek(start)
                made.update(file.read(_END))
        return size, made.hexdigest()

    def rays(self, first: int, last: int) -> Table:
        """Return some of its rays.

        Raises
        ------
        FileReadError, FileFormatError
            If it cannot be read, or is not what it was.
        """
        reader = _READERS[self.path.suffix.lower()]
        table = reader(self.path, first, last, _version(self.path))
        if len(table["origins"]) != last - first:
            raise FileFormatError._of(self.path, f"it has no longer {self.rows} rays")
        return table


def ray_files(given: Any) -> list[RayFile]:
    """Return the files of a path, of a pattern with ``*``, or of a list of paths, in order."""
    listed = [given] if isinstance(given, str | os.PathLike) else list(given)
    paths: list[Path] = []
    for one in listed:
        text = os.fspath(one)
        is_pattern = glob.has_magic(text) and not Path(text).exists()
        found = sorted(glob.glob(text)) if is_pattern else [text]  # noqa: PTH207
        if not found:
            raise FileMissingError(f"{text}: no such files", text)
        paths += (Path(name).absolute() for name in found)
    return [RayFile(path, _rows(path)) for path in paths]


def _rows(path: Path) -> int:
    suffix = path.suffix.lower()
    if suffix not in FILES:
        raise FileFormatError._of(path, f"rays are read from {', '.join(FILES)}")
    if not path.is_file():
        why = "not a regular file" if path.exists() else "No such file or directory"
        raise FileReadError._of(path, why)
    if suffix == ".parquet":
        rows: int = _parquet(path).metadata.num_rows
        return rows
    if suffix == ".npy":
        return len(_memory(path))
    return len(_arrays(path, _version(path))["origins"])


def _version(path: Path) -> tuple[int, int]:
    """Return what tells whether a file was changed since it was read."""
    with blaming(path, FileReadError):
        there = path.stat()
    return there.st_size, there.st_mtime_ns


def _of_npz(path: Path, first: int, last: int, version: object) -> Table:
    arrays = _arrays(path, version)
    return {name: array if array.size == 1 else array[first:last] for name, array in arrays.items()}


@functools.lru_cache(maxsize=1)
def _arrays(path: Path, _: object) -> Table:
    """Return the arrays of an ``.npz``, which parts of it share."""
    try:
        with np.load(path, allow_pickle=False) as file:
            there = {name: file[name] for name in file.files if name in (*_NAMES, *_LIMITS)}
    except (OSError, ValueError, EOFError, KeyError, zipfile.BadZipFile, MemoryError) as error:
        raise FileFormatError._of(path, f"not an .npz of rays: {error}") from None
    for name in _NAMES:
        if name not in there:
            raise FileFormatError._of(path, f"it has no array {name}")
        if (
            there[name].ndim != 2
            or there[name].shape[1] != 3
            or there[name].dtype.kind not in "fiu"
        ):
            raise FileFormatError._of(path, f"{name} must be numbers of the shape (n, 3)")
    rows = len(there["origins"])
    for name, array in there.items():
        if name in _LIMITS and array.size != 1 and array.shape != (rows,):
            raise FileFormatError._of(
                path, f"{name} must be one number or ({rows},), got {array.shape}"
            )
        if name in _NAMES and len(array) != rows:
            raise FileFormatError._of(path, f"{name} must have {rows} rows, got {array.shape}")
    return there


_NAMES = ("origins", "directions")


def _of_npy(path: Path, first: int, last: int, version: object) -> Table:
    del version
    rows = _memory(path)[first:last]
    # Each is copied out of the map at once, in the form in which it is shot.
    return {
        "origins": np.array(rows[:, :3], np.float64, order="C"),
        "directions": np.array(rows[:, 3:], np.float64, order="C"),
    }


def _memory(path: Path) -> npt.NDArray[Any]:
    try:
        made: npt.NDArray[Any] = np.load(path, mmap_mode="r", allow_pickle=False)
    except (OSError, ValueError, EOFError) as error:
        raise FileFormatError._of(path, f"not an .npy of rays: {error}") from None
    if made.ndim != 2 or made.shape[1] != 6 or made.dtype.kind not in "fiu":
        raise FileFormatError._of(
            path, f"rays must be numbers of the shape (n, 6), got {made.shape}"
        )
    return made


def _of_parquet(path: Path, first: int, last: int, version: object) -> Table:
    del version
    file = _parquet(path)
    groups: list[int] = []
    before = start = 0
    for group in range(file.num_row_groups):
        rows = file.metadata.row_group(group).num_rows
        if before < last and before + rows > first:
            start = start if groups else before
            groups.append(group)
        before += rows
    there = [name for name in (*_COLUMNS, *_LIMITS) if name in file.schema_arrow.names]
    table = file.read_row_groups(groups, columns=there).slice(first - start, last - first)
    columns = {name: table.column(name).to_numpy() for name in there}
    made = {
        "origins": np.stack([columns[name] for name in _COLUMNS[:3]], axis=-1),
        "directions": np.stack([columns[name] for name in _COLUMNS[3:]], axis=-1),
    }
    return {**made, **{name: columns[name] for name in _LIMITS if name in columns}}


def _parquet(path: Path) -> Any:
    parquet = optional("pyarrow.parquet", "a .parquet")
    try:
        file = parquet.ParquetFile(path)
        missing = [name for name in _COLUMNS if name not in file.schema_arrow.names]
    except (OSError, ValueError) as error:  # pyarrow's own errors are both
        raise FileFormatError._of(path, f"no Parquet file: {error}") from None
    if missing:
        raise FileFormatError._of(path, f"it has no column {missing[0]}")
    return file


_READERS = {".npz": _of_npz, ".npy": _of_npy, ".parquet": _of_parquet}
