"""Parts: a folder each, which has its name when it is whole.

A part is written to a folder beside it, ``.NUMBER.UUID``, synced to the disk and renamed. So
whoever finds the name finds all of the part, whatever was killed, and two that make the same part
do no harm: the second to come leaves the first one's.
"""

from __future__ import annotations

import errno
import os
import re
import shutil
import time
import uuid
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from firsthit._base.errors import FileError, FileReadError, FileWriteError, blaming

from .digest import canonical, of_file, of_json, of_stream
from .files import sync
from .records import open_inside, read, size_of

if TYPE_CHECKING:
    from collections.abc import Iterator

#: Names that killed runs leave behind, and the age at which these are removed: somebody else may
#: still be at younger ones.
_LEFT = re.compile(r"\..*\.[0-9a-f]{32}")
_OLD_SECONDS = 24 * 3600


#: Errors that say nothing of a part, which may be whole.
_PASSING = (
    *(errno.EIO, errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.EACCES, errno.EPERM),
    *(errno.EAGAIN, errno.ETIMEDOUT, getattr(errno, "ESTALE", errno.EIO)),
)


class Form(NamedTuple):
    """The names of the parts of a kind of job."""

    #: The folder that has them.
    folder: str
    #: The file of a part that says what is in it.
    record: str
    #: The record's key that says of which job it is.
    job: str


#: Of jobs with pictures, hits or sights, and of data sets.
PARTS, FRAMES = Form("parts", "part.json", "job"), Form("frames", "frame.json", "plan")


def name_of(number: int, count: int) -> str:
    """Return the name of a part's folder: its number, as wide as the last one's."""
    return f"{number:0{max(6, len(str(count - 1)))}d}"


class Writing:
    """A part that is being written: its folder, and at the end whether it has its name."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.is_placed = folder, False


@contextmanager
def writing(path: Path) -> Iterator[Writing]:
    """Yield a folder to fill, which becomes ``path`` when it is full.

    Where there is a part of this name by then, that one stays.
    """
    beside = path.with_name(f".{path.name}.{uuid.uuid4().hex}")
    part = Writing(beside)
    try:
        try:
            # The folder above it is there: a worker without it would write to a place of its own.
            beside.mkdir()
            yield part
            for file in _files(beside):
                sync(beside / file)
            for folder in (beside, *(each for each in beside.rglob("*") if each.is_dir())):
                sync(folder)
            try:
                beside.rename(path)
            except OSError:
                if not path.is_dir():
                    raise
            else:
                part.is_placed = True
                sync(path.parent)
        finally:
            shutil.rmtree(beside, ignore_errors=True)
    except FileError:
        raise
    except OSError as error:
        if _is_of_others(error, beside):
            raise
        raise FileWriteError._of(path, f"{error.strerror or error}") from error


def _is_of_others(error: OSError, beside: Path) -> bool:
    """Tell whether an error names a file that is none of a part: the user's own code may fail."""
    if not isinstance(error.filename, str | os.PathLike):
        return False
    return not Path(os.fspath(error.filename)).is_relative_to(beside.parent)


def seal(folder: Path, record: dict[str, Any], name: str) -> None:
    """Write the record ``name``: what is given, sizes and sha256 of the files, and a check."""
    files = {
        file: {"bytes": (folder / file).stat().st_size, "sha256": of_file(folder / file)}
        for file in _files(folder)
    }
    said = {**record, "files": files}
    (folder / name).write_bytes(canonical({**said, "check": of_json(said)}) + b"\n")


def _files(folder: Path) -> list[str]:
    there = (path for path in folder.rglob("*") if path.is_file())
    return sorted(path.relative_to(folder).as_posix() for path in there)


def record_of(path: Path, form: Form, job: str, *, verify: bool = False) -> dict[str, Any] | None:
    """Return the record of a part that is whole; ``None`` if it is not, or of another job.

    A record proves itself by its check. Files must be there with their sizes; with ``verify`` their
    bytes are compared as well. Nothing outside the part's folder is looked at, whatever the record
    says: neither by a name nor through a link.
    """
    if path.is_symlink():
        return None
    try:
        said = read(path / form.record)
        check = said.pop("check")
        if said[form.job] != job or check != of_json(said):
            return None
        if not (isinstance(said["digest"], str) and said["digest"].isascii()):
            return None
        for name, known in said["files"].items():
            size, sha256 = known["bytes"], known["sha256"]
            if size_of(path, name) != size or not isinstance(sha256, str):
                return None
            if verify:
                with open_inside(path, name) as file:
                    if of_stream(file) != sha256:
                        return None
    except (ValueError, KeyError, TypeError, AttributeError):
        return None
    except OSError as error:
        if error.errno in _PASSING:
            raise FileReadError._of(path, f"{error.strerror}") from error
        return None
    return dict(said)


def discard(path: Path) -> None:
    """Remove a damaged part. It loses its name first, so that it is never half there."""
    aside = path.with_name(f".{path.name}.{uuid.uuid4().hex}")
    # Somebody else may be faster.
    with blaming(path, FileWriteError), suppress(FileNotFoundError):
        path.rename(aside)
        if aside.is_dir() and not aside.is_symlink():
            shutil.rmtree(aside)
        else:
            aside.unlink()


def remove_leftovers(folder: Path) -> None:
    """Remove what runs left behind that were killed more than a day ago."""
    try:
        there = list(os.scandir(folder))
    except OSError:
        return
    for entry in there:
        if not _LEFT.fullmatch(entry.name):
            continue
        try:
            age = time.time() - entry.stat(follow_symlinks=False).st_mtime
        except OSError:
            continue
        if age > _OLD_SECONDS:
            if entry.is_dir(follow_symlinks=False):
                shutil.rmtree(entry.path, ignore_errors=True)
            else:
                Path(entry.path).unlink(missing_ok=True)
