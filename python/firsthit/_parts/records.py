"""Records that runs leave in a folder, read with care: the folder may be shared."""

from __future__ import annotations

import json
import os
import re
import stat
from typing import TYPE_CHECKING, Any, BinaryIO

if TYPE_CHECKING:
    from pathlib import Path

#: A frame's record has its annotations; more than this is none.
_MOST_BYTES = 1 << 28

#: No link is followed, and no pipe is waited for.
FLAGS = (
    os.O_RDONLY
    | getattr(os, "O_NOFOLLOW", 0)
    | getattr(os, "O_NONBLOCK", 0)
    | getattr(os, "O_BINARY", 0)
)


def open_regular(path: Path) -> BinaryIO:
    """Open a regular file; no link is followed, and no pipe is waited for.

    An ``OSError`` if it cannot be opened, a ``ValueError`` for what is no regular file.
    """
    opened = os.open(path, FLAGS)
    try:
        if not stat.S_ISREG(os.fstat(opened).st_mode):
            raise ValueError("a device, a pipe or a folder, not a regular file")
        return os.fdopen(opened, "rb")
    except BaseException:
        os.close(opened)
        raise


def read(path: Path) -> Any:
    """Return the JSON of a record; errors as those of `open_regular`, and for what is no JSON."""
    with open_regular(path) as file:
        content = file.read(_MOST_BYTES + 1)
    if len(content) > _MOST_BYTES:
        raise ValueError(f"larger than {_MOST_BYTES >> 20} MiB")
    try:
        return json.loads(content)
    except RecursionError:
        raise ValueError("nested too deeply") from None


def size_of(folder: Path, name: str) -> int:
    """Return how many bytes a regular file below a folder has.

    An ``OSError`` if it is not there, a ``ValueError`` for a name that leads out of the folder, a
    link, or what is no regular file.
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
