"""The source of a plan: its folder, and the lines of its keys."""

from __future__ import annotations

import os
import re
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from firsthit import _firsthit
from firsthit._base.errors import FileFormatError, FileReadError, blaming

if TYPE_CHECKING:
    from collections.abc import Mapping

#: The largest plan that is read. Poses of more belong into files of their own.
MOST_BYTES = 16 << 20

#: What may be a key, with its dots and blanks; and how many parts a key may have.
_KEY = re.compile(r"""[A-Za-z0-9_\-."' \t]+""")
_DOT = re.compile(r"""[A-Za-z0-9_\-"'][ \t]*\.(?=[ \t]*[A-Za-z0-9_\-"'])""")
_MOST_PARTS = 64

#: How many bytes are parsed again at most to find the line of a mistake.
_MOST_PARSED = 4 << 20

#: The way to a value: keys, and indices of arrays.
Way = tuple[str | int, ...]


class Document(NamedTuple):
    """A plan as it was written.

    Attributes
    ----------
    data : mapping
        What it says.
    folder : Path
        Where the files are that it names.
    path : str
        The plan's file; empty for a plan that is a dict.
    text : str
        The file's content; empty for a dict.
    """

    data: Mapping[str, Any]
    folder: Path
    path: str = ""
    text: str = ""

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Document:
        """Read a plan from a file."""
        file, name = Path(path), os.fspath(path)
        try:
            with blaming(path, FileReadError):
                if file.exists() and not file.is_file():
                    what = "a folder" if file.is_dir() else "a device or a pipe"
                    raise FileReadError(f"{name}: {what}, not a file", name)
                with file.open("rb") as opened:
                    content = opened.read(MOST_BYTES + 1)
            _firsthit.note_input(file)
        except ValueError as error:  # a name with a zero byte
            raise FileReadError(f"{name!r}: {error}", name) from error
        if len(content) > MOST_BYTES:
            raise FileFormatError(f"{name}: a plan may have {MOST_BYTES >> 20} MiB at most", name)
        try:
            text = content.decode()
            _check_keys(text)
            data = tomllib.loads(text)
        except UnicodeDecodeError as error:
            place = f"byte {error.start}"
            raise FileFormatError(f"{name}: {place}: not UTF-8", name, place) from None
        except ValueError as error:  # also of an integer with thousands of digits
            raise FileFormatError(f"{name}: {error}", name) from None
        except RecursionError:
            why = "tables and arrays are nested too deeply"
            raise FileFormatError(f"{name}: {why}", name) from None
        return cls(data, file.parent, name, text)

    def refused(self, way: Way, message: str) -> ValueError:
        """Return the error about a value, with its line if there is one."""
        if not self.path:
            return ValueError(f"plan: {message}")
        line = self._line(way)
        place = "" if line is None else f"line {line}"
        at = self.path if line is None else f"{self.path}:{line}"
        return FileFormatError(f"{at}: {message}", self.path, place)

    def _line(self, way: Way) -> int | None:
        """Return the line at which the statement begins that gives a value.

        Of all beginnings of the file that are TOML, the longest without the value ends before it.
        They are searched by halving: one beginning of the file is part of the next.
        """
        lines = self.text.splitlines(keepends=True)
        left, first, last = _MOST_PARSED, 1, len(lines)
        while first < last:
            middle = end = (first + last) // 2
            while True:
                piece = "".join(lines[:end])
                left -= len(piece)
                if left < 0:
                    return None
                try:
                    holds = _holds(tomllib.loads(piece), way)
                    break
                except ValueError:
                    # Within a statement of several lines.
                    end += 1
                    if end > last:
                        holds = True
                        break
            if holds:
                last = middle
            else:
                first = end + 1
        return first


def _check_keys(text: str) -> None:
    """Refuse keys of very many parts: `tomllib` takes the square of their number."""
    for found in _KEY.finditer(text):
        if len(_DOT.findall(found[0])) > _MOST_PARTS:
            raise ValueError(f"a key has more than {_MOST_PARTS} parts")


def _holds(data: Any, way: Way) -> bool:
    for key in way:
        try:
            data = data[key]
        except (KeyError, IndexError, TypeError):
            return False
    return True
