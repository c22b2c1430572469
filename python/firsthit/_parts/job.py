"""The file of a job in its folder: of what the parts are."""

from __future__ import annotations

import json
import os
import secrets
from typing import TYPE_CHECKING, Any

from firsthit._base.arrays import count as whole_number
from firsthit._base.errors import FileFormatError, FileReadError, FileWriteError

from .digest import of_json
from .files import sync, writing_file
from .records import read

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

#: The file in the folder.
JOB = "job.json"


def known_job(path: Path) -> dict[str, Any] | None:
    """Return what the file of a job says; ``None`` if it is not there."""
    try:
        said = read(path)
        if not isinstance(said, dict):
            raise TypeError("a table was expected")
        if said.pop("check", None) != of_json(said):
            raise ValueError("its check does not fit what it says")
    except (FileNotFoundError, NotADirectoryError):
        return None
    except OSError as error:
        raise FileReadError._of(path, str(error.strerror or error)) from error
    except (ValueError, TypeError) as error:
        raise FileFormatError._of(path, f"no job of firsthit: {error}") from None
    return said


def job_in(folder: Path, parts: str) -> dict[str, Any] | None:
    """Return what the file of a folder's job says; ``None`` if a new job may begin there.

    A `FileWriteError` where none may: there are parts of an unknown job, or a file.
    """
    path = folder / JOB
    known = known_job(path)
    if known is not None:
        return known
    if folder.exists() and not folder.is_dir():
        raise FileWriteError._of(folder, "a file, not a folder")
    if (folder / parts).exists():
        # The file comes before the parts: another run may have begun since it was looked for.
        known = known_job(path)
        if known is None:
            why = f"there are {parts} without a {JOB}, of which nobody knows the job"
            raise FileWriteError._of(folder, f"{why}; take another folder")
    return known


def begin_job(path: Path, said: Mapping[str, Any]) -> dict[str, Any]:
    """Write the file of a job unless another run was first; return what is there now."""
    beside = path.with_name(f".{path.name}.{secrets.token_hex(16)}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            with beside.open("xb") as file:
                file.write(_content(said))
                file.flush()
                os.fsync(file.fileno())
            try:
                os.link(beside, path)
            except FileExistsError:
                pass
            except OSError:
                # A file system without second names: two runs at once may both be first.
                if not path.exists():
                    beside.replace(path)
            sync(path.parent)
        finally:
            beside.unlink(missing_ok=True)
    except OSError as error:
        raise FileWriteError._of(path, f"{error.strerror or error}") from error
    known = known_job(path)
    if known is None:
        raise FileWriteError._of(path, "it was removed while the job began")
    return known


def write_job(path: Path, said: Mapping[str, Any]) -> None:
    """Write the file of a job anew, whole or not at all."""
    with writing_file(path) as file:
        file.write(_content(said))


def _content(said: Mapping[str, Any]) -> bytes:
    """Return what a job says, with a check of all of it."""
    checked = {**said, "check": of_json(said)}
    return (json.dumps(checked, indent=2) + "\n").encode()


def refuse_other(path: Path, known: Mapping[str, Any], wanted: Mapping[str, Any]) -> None:
    """Refuse a folder whose job is another one."""
    for key, value in wanted.items():
        if known.get(key) != value:
            other, own = _shown(known.get(key)), _shown(value)
            why = f"the folder is another job's: its {key} is {other}, this one's {own}"
            raise FileWriteError._of(path, f"{why}; take another folder")


def _shown(value: object) -> str:
    return "not given" if value is None else str(value)


def range_of(part: tuple[int, int] | None, count: int) -> range:
    """Return the numbers that are the k-th of n parts of all: as many as any other, or one less."""
    k, n = checked_part(part)
    return range((k - 1) * count // n, k * count // n)


def checked_part(part: tuple[int, int] | None) -> tuple[int, int]:
    """Return which of how many parts a user asked for; the only one by default."""
    if part is None:
        return 1, 1
    if not isinstance(part, tuple | list) or len(part) != 2:
        raise ValueError(f"part must be two whole numbers, k of n, got {part!r}")
    n = whole_number("part", part[1], 1)
    return whole_number("part", part[0], 1, n), n
