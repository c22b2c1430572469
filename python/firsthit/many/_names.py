"""Names of files and of functions."""

from __future__ import annotations

import re
from typing import Any

#: What a file may be called, on every system.
_FILE = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,199}")


def file_name(given: Any) -> str:
    """Return the name of a file without its extension.

    Raises
    ------
    ValueError
        For one that leads elsewhere, or that a system does not allow.
    """
    if not isinstance(given, str) or not _FILE.fullmatch(given):
        raise ValueError(
            "names must be of letters, digits, '_', '-' and '.', and not begin with '.', "
            f"got {given!r}"
        )
    return given


def function_name(argument: str, given: Any) -> str:
    """Return what a function is called, for the file of a job."""
    if not callable(given):
        raise TypeError(f"{argument} must be a name or a function, got {given!r}")
    kind = given if hasattr(given, "__qualname__") else type(given)
    return f"{kind.__module__}.{kind.__qualname__}"
