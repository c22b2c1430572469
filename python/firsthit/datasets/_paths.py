"""The files that a plan may name: those in its folder and below, as scene files have it."""

from __future__ import annotations

import os
import unicodedata
from pathlib import Path


def inside(folder: Path, name: str) -> Path:
    """Return the path of a file that a plan names.

    A ``ValueError`` for every name that is not plainly a relative path downwards, on any system;
    for a link that leads outside the folder; and for what is no regular file.
    """
    why = _refusal(name)
    if why is not None:
        raise ValueError(f"{name!r}: refused: {why}")
    try:
        top = folder.resolve(strict=True)
        # Resolved, so that no symbolic link leads out of the folder.
        path = (top / name).resolve(strict=True)
    except (OSError, RuntimeError) as error:
        raise ValueError(f"{name!r}: {getattr(error, 'strerror', None) or error}") from None
    if not path.is_relative_to(top):
        raise ValueError(f"{name!r}: refused: it leads outside the plan's folder")
    if path.is_dir():
        raise ValueError(f"{name!r}: a folder, not a file")
    if not path.is_file():
        raise ValueError(f"{name!r}: a device or a pipe, not a regular file")
    return Path(os.fspath(path))


def _refusal(name: str) -> str | None:
    if not name:
        return "the name is empty"
    if any(unicodedata.category(each) in ("Cc", "Cs") for each in name):
        return "the name has a control character"
    if "\\" in name:
        return "the name has a backslash; folders are separated by /"
    if ":" in name:
        return "the name has a scheme or a drive; only relative paths are read"
    if name.startswith("/"):
        return "the path is absolute; only relative paths are read"
    if ".." in name.split("/"):
        return "the path has ..; only files under the plan's folder are read"
    return None
