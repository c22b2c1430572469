"""Files that appear whole or not at all."""

from __future__ import annotations

import secrets
from contextlib import contextmanager
from typing import TYPE_CHECKING, BinaryIO

from firsthit._base.errors import FileWriteError, blaming, refuse_input

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@contextmanager
def writing(path: Path) -> Iterator[BinaryIO]:
    """Yield a file to write, which gets its name when it is full; never over one that was read."""
    refuse_input(path)
    # Until it has its name it is beside it, on the same device. `remove_leftovers` knows this name.
    beside = path.with_name(f".{path.name[:100]}.{secrets.token_hex(16)}")
    with blaming(path, FileWriteError):
        try:
            with beside.open("xb") as file:
                yield file
            if path.exists():
                # A file that is replaced leaves its permissions.
                beside.chmod(path.stat().st_mode & 0o777)
            beside.replace(path)
        finally:
            beside.unlink(missing_ok=True)


def write(path: Path, content: bytes) -> None:
    """Write a file, whole or not at all; folders above it are made."""
    with blaming(path, FileWriteError):
        path.parent.mkdir(parents=True, exist_ok=True)
    with writing(path) as file:
        file.write(content)
