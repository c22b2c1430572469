"""Names of files and of functions."""

from __future__ import annotations

import re
from typing import Any

#: The names that a file may have on every system.
_FILE = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,199}")


def file_name(given: Any) -> str:
    """Return the name of a file, if it leads nowhere else and every system allows it."""
    if not isinstance(given, str) or not _FILE.fullmatch(given):
        raise ValueError(
            "names must be of letters, digits, '_', '-' and '.', and not begin with '.', "
            f"got {given!r}"
        )
    return given


def identity(argument: str, given: Any) -> list[str]:
    """Return what tells a function or an object that is called from others, for a job's file.

    A ``ValueError`` for what has no name of its own, by which a later run could know it again: a
    lambda, a function within another, an object whose ``repr`` does not say what it is made of.
    """
    if not callable(given):
        raise TypeError(f"{argument} must be a name or a function, got {given!r}")
    if hasattr(given, "__qualname__"):
        name = f"{given.__module__}.{given.__qualname__}"
        if "<" in name:
            raise ValueError(
                f"{argument} must be a function of a module, by whose name a later run knows the "
                f"job again, got {name}"
            )
        return [name]
    kind = type(given)
    if " at 0x" in repr(given):
        raise ValueError(
            f"{argument} must have a __repr__ that says its parameters, by which a later run knows "
            f"the job again, got {given!r}"
        )
    return [f"{kind.__module__}.{kind.__qualname__}", repr(given)]
