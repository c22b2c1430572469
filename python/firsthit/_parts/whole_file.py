"""Files that are written bit by bit, and appear whole or not at all."""

from __future__ import annotations

import os
import secrets
from contextlib import contextmanager
from typing import TYPE_CHECKING, BinaryIO

from firsthit._base.errors import FileError, FileWriteError, refuse_input

from .sync import sync

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@contextmanager
def writing_file(path: Path) -> Iterator[BinaryIO]:
    """Yield a file to write, which is synced to the disk and gets its name when it is full.

    Raises
    ------
    FileWriteError
        If the system refuses, and over a file that was read.
    """
    refuse_input(path)
    # `remove_leftovers` knows this name.
    beside = path.with_name(f".{path.name}.{secrets.token_hex(16)}")
    try:
        try:
            with beside.open("xb") as file:
                yield file
                file.flush()
                os.fsync(file.fileno())
            beside.replace(path)
            sync(path.parent)
        finally:
            beside.unlink(missing_ok=True)
    except FileError:
        raise
    except OSError as error:
        raise FileWriteError(f"{path}: {error.strerror or error}", os.fspath(path)) from error
