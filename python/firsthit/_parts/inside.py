"""Files that a record names, opened with care: the record's author may mean harm."""

from __future__ import annotations

import os
import re
import stat
from typing import TYPE_CHECKING, BinaryIO

from .records import open_regular

if TYPE_CHECKING:
    from pathlib import Path


def size_of(folder: Path, name: str) -> int:
    """Return how many bytes a regular file below a folder has.

    Raises
    ------
    OSError
        If it is not there.
    ValueError
        For a name that leads out of the folder, a link, or what is no regular file.
    """
    found = _path(folder, name).lstat()
    if not stat.S_ISREG(found.st_mode):
        raise ValueError(f"{name}: not a regular file")
    return found.st_size


def open_inside(folder: Path, name: str) -> BinaryIO:
    """Open a regular file below a folder; the errors are those of `size_of`."""
    return open_regular(_path(folder, name))


def _path(folder: Path, name: str) -> Path:
    """Return the path of a file whose folders, from the given one on, are no links."""
    *above, last = re.split(r"[/\\]" if os.name == "nt" else "/", name)
    if any(each in ("", ".", "..") for each in (*above, last)) or (os.name == "nt" and ":" in name):
        raise ValueError(f"{name}: not a file of this folder")
    for each in above:
        folder = folder / each
        if not stat.S_ISDIR(folder.lstat().st_mode):
            raise ValueError(f"{name}: {each} is not a folder")
    return folder / last
