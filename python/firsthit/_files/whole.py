"""Files that appear whole or not at all."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from firsthit import _firsthit
from firsthit._base.errors import FileWriteError

if TYPE_CHECKING:
    from pathlib import Path


def write(path: Path, content: bytes) -> None:
    """Write a file, whole or not at all; folders above it are made."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileWriteError(f"{path}: {error.strerror or error}", os.fspath(path)) from error
    _firsthit.write_bytes(path, content)
