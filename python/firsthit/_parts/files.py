"""Files on the disk: synced, whole or not at all, linked."""

from __future__ import annotations

import errno
import os
import secrets
import shutil
from contextlib import contextmanager
from typing import TYPE_CHECKING, BinaryIO

from firsthit._base.errors import FileWriteError, blaming
from firsthit._files.whole import writing

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


#: The errors of file systems that do not sync folders.
_NOT_FOR_FOLDERS = (errno.EINVAL, errno.ENOTSUP, errno.EBADF)


def sync(path: Path) -> None:
    """Sync a file, or a folder where the system can: the names in it."""
    is_folder = path.is_dir()
    if is_folder and os.name == "nt":
        return
    opened = os.open(path, os.O_RDONLY if os.name != "nt" else os.O_RDWR)
    try:
        os.fsync(opened)
    except OSError as error:
        if not (is_folder and error.errno in _NOT_FOR_FOLDERS):
            raise
    finally:
        os.close(opened)


@contextmanager
def writing_file(path: Path) -> Iterator[BinaryIO]:
    """Yield a file to write, which is synced to the disk and gets its name when it is full."""
    with writing(path) as file:
        yield file
        file.flush()
        os.fsync(file.fileno())
    with blaming(path, FileWriteError):
        sync(path.parent)


def link(source: Path, path: Path) -> None:
    """Give a file a second name, which takes no room; a copy where that cannot be."""
    beside = path.with_name(f".{path.name}.{secrets.token_hex(16)}")
    with blaming(path, FileWriteError):
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.exists() and path.samefile(source):
            return
        try:
            try:
                os.link(source, beside)
            except OSError:
                shutil.copyfile(source, beside)
            beside.replace(path)
        finally:
            # Where somebody else was faster, both are names of one file, and none is replaced.
            beside.unlink(missing_ok=True)
