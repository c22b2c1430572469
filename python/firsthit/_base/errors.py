"""Errors and warnings about files, and which built-in errors there are beside them.

A bad value is a ``ValueError``, and so is a name that an argument cannot be: of a channel, an
attribute, an object, a kind of finding. A name that is looked up like a key of a dict is a
``KeyError`` where it is not there: ``frame["z"]``, and a camera of a scene. A number is an
``IndexError`` where nothing has it: the identifier of an object, an index of hits. A value of
another type is a ``TypeError``.
"""

import os
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from inspect import isfunction
from pathlib import Path
from types import FrameType
from typing import Self

from firsthit import _firsthit


class FirsthitWarning(UserWarning):
    """Something doubtful in a file, or an argument that is probably not what was meant."""


def warn(text: str) -> None:
    """Warn of something in the line of the user's that led to it."""
    level, frame = 1, sys._getframe()
    package = _package_of(frame)
    while frame.f_back is not None and _package_of(frame) == package:
        level, frame = level + 1, frame.f_back
    # Names in it may be of anyone's making.
    warnings.warn(_firsthit.escaped(text), FirsthitWarning, stacklevel=level)


def _package_of(frame: FrameType) -> str:
    name: str = frame.f_globals.get("__name__", "")
    return name.partition(".")[0]


class FileError(Exception):
    """A file could not be read or written.

    Attributes
    ----------
    path : str
        The file.
    place : str
        Where in the file, such as ``line 12`` or ``byte 84``; empty if the error has no place.
    """

    def __init__(self, message: str, path: str = "", place: str = "") -> None:
        super().__init__(message)
        self.path = path
        self.place = place

    @classmethod
    def _of(cls, path: str | os.PathLike[str], what: str) -> Self:
        """Return the error about a whole file."""
        return cls(f"{os.fspath(path)}: {what}", os.fspath(path))

    def __reduce__(self) -> tuple[type["FileError"], tuple[str, str, str]]:
        """Pickle with all that was said."""
        return type(self), (str(self), self.path, self.place)


class FileReadError(FileError, OSError):
    """The system refused to read a file; a missing one is a `FileNotFoundError` too."""


class FileMissingError(FileReadError, FileNotFoundError):
    """There is no file of this name."""


class FileWriteError(FileError, OSError):
    """The system refused to write a file; nothing was written, and an old file is as it was."""


class FileFormatError(FileError, ValueError):
    """A file's content is wrong."""


def name_methods(kind: type, *parts: type) -> None:
    """Let errors name the class that users know, not the parts of it that have the methods."""
    for part in parts:
        for name, member in vars(part).items():
            method = getattr(member, "__func__", member)
            if isfunction(method):
                method.__module__, method.__qualname__ = kind.__module__, f"{kind.__name__}.{name}"


@contextmanager
def blaming(
    path: str | os.PathLike[str], kind: type[FileReadError] | type[FileWriteError]
) -> Iterator[None]:
    """Raise what the system says as an error about a path."""
    try:
        yield
    except FileError:
        raise
    except OSError as error:
        if isinstance(error, FileNotFoundError) and kind is FileReadError:
            kind = FileMissingError
        raise kind._of(path, str(error.strerror or error)) from error


def refuse_input(path: str | os.PathLike[str]) -> None:
    """Refuse to write over a file that this process has read.

    Writers in Python ask it; those in Rust do by themselves.
    """
    if _firsthit.is_input(Path(path)):
        why = "is an input; it will not be overwritten (remove it first, or take another name)"
        raise FileWriteError._of(path, why)
