"""Second names of files."""

from __future__ import annotations

import os
import secrets
import shutil
from typing import TYPE_CHECKING

from firsthit._base.errors import FileWriteError

if TYPE_CHECKING:
    from pathlib import Path


def link(source: Path, path: Path) -> None:
    """Give a file a second name, which takes no room; a copy where that cannot be."""
    beside = path.with_name(f".{path.name}.{secrets.token_hex(16)}")
    try:
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
    except OSError as error:
        raise FileWriteError(f"{path}: {error.strerror or error}", os.fspath(path)) from error
