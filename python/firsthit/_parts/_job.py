"""The file of a job in its folder: of what the parts are."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any

from firsthit._arrays import count as whole_number
from firsthit._errors import FileFormatError, FileReadError, FileWriteError
from firsthit.annotations._files import write

from ._digest import of_json
from ._records import read

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

#: The file in the folder.
JOB = "job.json"


def known_job(path: Path) -> dict[str, Any] | None:
    """Return what the file of a job says; ``None`` if it is not there."""
    name = os.fspath(path)
    try:
        said = read(path)
        if not isinstance(said, dict):
            raise TypeError("a table was expected")
        if said.pop("check", None) != of_json(said):
            raise ValueError("its check does not fit what it says")
    except (FileNotFoundError, NotADirectoryError):
        return None
    except OSError as error:
        raise FileReadError(f"{name}: {error.strerror or error}", name) from error
    except (ValueError, TypeError) as error:
        raise FileFormatError(f"{name}: no job of firsthit: {error}", name) from None
    return said


def refuse_strange(folder: Path, parts: str) -> None:
    """Refuse a folder in which a new job cannot begin."""
    if folder.exists() and not folder.is_dir():
        raise FileWriteError(f"{folder}: a file, not a folder", os.fspath(folder))
    if (folder / parts).exists():
        why = f"there are {parts} without a {JOB}, of which nobody knows the job"
        raise FileWriteError(f"{folder}: {why}; take another folder", os.fspath(folder))


def write_job(path: Path, said: Mapping[str, Any]) -> None:
    """Write the file of a job, whole or not at all, with a check of all that it says."""
    checked = {**said, "check": of_json(said)}
    write(path, (json.dumps(checked, indent=2) + "\n").encode())


def refuse_other(path: Path, known: Mapping[str, Any], wanted: Mapping[str, Any]) -> None:
    """Refuse a folder whose job is another one."""
    for key, value in wanted.items():
        if known.get(key) != value:
            why = f"the folder is another job's: its {key} is {known.get(key)}, this one's {value}"
            raise FileWriteError(f"{path}: {why}; take another folder", os.fspath(path))


def range_of(part: tuple[int, int] | None, count: int) -> range:
    """Return the numbers that are the k-th of n parts of all: as many as any other, or one less."""
    k, n = checked_part(part)
    return range((k - 1) * count // n, k * count // n)


def checked_part(part: tuple[int, int] | None) -> tuple[int, int]:
    """Return which of how many parts a user asked for: the only one where nobody did."""
    if part is None:
        return 1, 1
    if not isinstance(part, tuple | list) or len(part) != 2:
        raise ValueError(f"part must be two whole numbers, k of n, got {part!r}")
    n = whole_number("part", part[1], 1)
    return whole_number("part", part[0], 1, n), n
