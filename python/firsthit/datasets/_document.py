"""The source of a plan: its text, its values, and the places of its mistakes."""

from __future__ import annotations

import datetime
import json
import os
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from firsthit import _firsthit
from firsthit._base.errors import FileError, FileFormatError, FileReadError, blaming

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

#: The largest plan that is read. Poses of more belong into files of their own.
MOST_BYTES = 16 << 20


class PlanSource(NamedTuple):
    """A plan as it was written."""

    #: The plan as TOML.
    text: bytes
    #: Where the files are that it names.
    folder: Path
    #: The plan's file; ``None`` for a plan that is a dict.
    path: Path | None = None

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> PlanSource:
        """Read a plan from a file."""
        file, name = Path(path), os.fspath(path)
        try:
            with blaming(path, FileReadError):
                if file.exists() and not file.is_file():
                    what = "a folder" if file.is_dir() else "a device or a pipe"
                    raise FileReadError._of(path, f"{what}, not a file")
                with file.open("rb") as opened:
                    content = opened.read(MOST_BYTES + 1)
            _firsthit.note_input(file)
        except ValueError as error:  # a name with a zero byte
            raise FileReadError(f"{name!r}: {error}", name) from error
        if len(content) > MOST_BYTES:
            raise FileFormatError._of(path, f"a plan may have {MOST_BYTES >> 20} MiB at most")
        return cls(content, file.parent, file)

    @classmethod
    def of(cls, data: Mapping[str, Any], folder: Path) -> PlanSource:
        """Return a plan that is a dict."""
        if not isinstance(data, dict):
            raise ValueError(f"plan: it must be a table, got {data!r}")
        try:
            lines = [f"{_key(key)} = {_toml(value)}\n" for key, value in data.items()]
        except RecursionError:
            raise ValueError("plan: tables and arrays are nested too deeply") from None
        return cls("".join(lines).encode(), folder)

    def table(self) -> Table:
        """Return what it says, checked."""
        return Table(self, (), json.loads(_firsthit.read_plan(self.text, self.path)))

    def refused(self, way: tuple[str, ...], message: str) -> ValueError:
        """Return the error about a value, with its place if there is one."""
        place = self.path and _firsthit.place_in_plan(self.text, way)
        if not place:
            parts = (f"[{part}]" if part.isdigit() else f".{part}" for part in way)
            said = "".join(parts).removeprefix(".")
            return ValueError(f"plan: {said}: {message}" if said else f"plan: {message}")
        line, column = place
        words = f"line {line}, column {column}"
        return FileFormatError(f"{self.path}:{line}:{column}: {message}", str(self.path), words)


class Table(dict[str, Any]):
    """A table of a plan, whose keys and values have the form that they must have."""

    def __init__(self, document: PlanSource, way: tuple[str, ...], data: dict[str, Any]) -> None:
        super().__init__(data)
        self._document, self._way = document, way

    def refused(self, key: str | None, message: str) -> ValueError:
        """Return an error about a key, or about the whole table."""
        way = self._way
        if key is not None and key in self and self._document.path is not None:
            way = (*way, key)
        return self._document.refused(way, message)

    @contextmanager
    def blaming(self, key: str | None = None) -> Iterator[None]:
        """Say where in the plan something is that other code refuses."""
        try:
            yield
        except FileError:
            raise
        except (ValueError, TypeError) as error:
            raise self.refused(key, str(error)) from None

    def need(self, key: str, why: str) -> None:
        """Refuse a table without a key that others need."""
        if key not in self:
            raise self.refused(None, f"missing key `{key}`: {why}")

    def number(self, key: str, default: float | None = None) -> Any:
        """Return a number as float."""
        value = self.get(key, default)
        return None if value is None else float(value)

    def numbers(self, key: str, default: Any = None) -> Any:
        """Return an array of numbers, or of arrays of them, as lists of float."""
        return _floats(self.get(key, default))

    def span(self, key: str, default: float | tuple[float, float] = 0.0) -> tuple[float, float]:
        """Return the two ends of a range; one number stands for a range without a length."""
        ends = _floats(self.get(key, default))
        return (ends[0], ends[1]) if isinstance(ends, list) else (ends, ends)

    def texts(self, key: str, default: Any = ()) -> list[str]:
        """Return several texts, each once; one alone need not be in an array."""
        value = self.get(key, default)
        given = [value] if isinstance(value, str) else list(value)
        if len(set(given)) != len(given):
            raise self.refused(key, f"`{key}` must be different texts, got {given}")
        return given

    def table(self, key: str) -> Table:
        """Return a table within this one; an empty one if it is left out."""
        return Table(self._document, (*self._way, key), self.get(key, {}))

    def tables(self, key: str) -> list[Table]:
        """Return the tables of an array."""
        way = (*self._way, key)
        if not self[key]:
            raise self.refused(key, f"`{key}` must be one table [[{key}]] or several, got none")
        return [Table(self._document, (*way, str(k)), each) for k, each in enumerate(self[key])]


def _floats(value: Any) -> Any:
    if isinstance(value, list | tuple):
        return [_floats(each) for each in value]
    return None if value is None else float(value)


def _toml(value: Any) -> str:
    """Return a value as TOML."""
    match value:
        case bool():
            return "true" if value else "false"
        case str():
            return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
        case int():
            return int.__repr__(value)
        case float():
            return float.__repr__(value)
        case datetime.date() | datetime.time():
            return value.isoformat()
        case list() | tuple():
            return f"[{', '.join(map(_toml, value))}]"
        case dict():
            entries = (f"{_key(key)} = {_toml(each)}" for key, each in value.items())
            return f"{{{', '.join(entries)}}}"
    raise ValueError(f"plan: a value must be one of TOML's, got {value!r:.80}")


def _key(key: Any) -> str:
    if not isinstance(key, str):
        raise ValueError(f"plan: keys must be texts, got {key!r}")
    return _toml(key)
