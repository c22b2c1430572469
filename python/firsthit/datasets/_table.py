"""Tables of plain data, read key by key; what is not asked for is a mistake."""

from __future__ import annotations

import math
from contextlib import contextmanager
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

from firsthit._base.errors import FileError

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from ._document import Document, Way

#: No value, where ``None`` might be one.
_MISSING: Any = object()


class Table:
    """A table of a plan.

    Each method takes a key, and refuses a value of another form with its place, what was expected
    and what came. Without a default the key must be there. `finish` refuses keys that no method was
    asked for.
    """

    def __init__(self, document: Document, way: Way = (), data: Any = _MISSING) -> None:
        self._document, self._way = document, way
        self._data: Mapping[str, Any] = document.data if data is _MISSING else data
        self._known: dict[str, None] = {}
        if not isinstance(self._data, dict):
            name = _said(way) or "it"
            raise document.refused(way, f"{name} must be a table, got {_got(self._data)}")

    def __contains__(self, key: str) -> bool:
        self._known[key] = None
        return key in self._data

    def keys(self) -> list[str]:
        """Return the keys of a table whose keys are names; all are then known."""
        for key in self._data:
            if not isinstance(key, str):
                raise self.refused(None, f"keys must be texts, got {key!r}")
        self._known.update(dict.fromkeys(self._data))
        return list(self._data)

    def refused(self, key: str | None, message: str) -> ValueError:
        """Return an error about a key, or about the whole table."""
        way = self._way if key is None or key not in self._data else (*self._way, key)
        said = _said(self._way)
        return self._document.refused(way, f"{said}: {message}" if said else message)

    def finish(self) -> None:
        """Refuse keys that mean nothing here."""
        for key in self._data:
            if key not in self._known:
                close = get_close_matches(str(key), self._known, 1)
                meant = f", did you mean `{close[0]}`?" if close else ""
                if not close:
                    meant = f"; there are {', '.join(self._known)}"
                raise self.refused(key, f"unknown key `{key}`{meant}")

    @contextmanager
    def blaming(self, key: str | None = None) -> Iterator[None]:
        """Say where in the plan something is that other code refuses."""
        try:
            yield
        except FileError:
            raise
        except (ValueError, TypeError) as error:
            raise self.refused(key, str(error)) from None

    def _get(self, key: str, default: Any) -> Any:
        self._known[key] = None
        if key in self._data:
            return self._data[key]
        if default is _MISSING:
            # One that is spelt a little differently is the more likely mistake.
            others = [str(other) for other in self._data if other not in self._known]
            for close in get_close_matches(key, others, 1, 0.75):
                raise self.refused(close, f"unknown key `{close}`, did you mean `{key}`?")
            raise self.refused(None, f"missing key `{key}`")
        return _MISSING

    def _wrong(self, key: str, wanted: str, value: Any) -> ValueError:
        return self.refused(key, f"`{key}` must be {wanted}, got {_got(value)}")

    def number(
        self,
        key: str,
        default: Any = _MISSING,
        *,
        least: float = -math.inf,
        most: float = math.inf,
        above: float = -math.inf,
    ) -> Any:
        """Return a finite number within limits."""
        value = self._get(key, default)
        if value is _MISSING:
            return default
        wanted = "a finite number"
        if above > -math.inf:
            wanted += f" above {above:g}"
        if least > -math.inf:
            wanted += f" from {least:g} on"
        if most < math.inf:
            wanted += f" up to {most:g}"
        number = _finite(value)
        if number is None or not (least <= number <= most and number > above):
            raise self._wrong(key, wanted, value)
        return number

    def whole(self, key: str, default: Any = _MISSING, *, least: int = 0, most: int = 2**31) -> Any:
        """Return a whole number within limits."""
        value = self._get(key, default)
        if value is _MISSING:
            return default
        is_whole = isinstance(value, int) and not isinstance(value, bool)
        if not is_whole or not least <= value <= most:
            raise self._wrong(key, f"a whole number from {least} to {most}", value)
        return value

    def text(
        self,
        key: str,
        default: Any = _MISSING,
        among: Sequence[str] = (),
        *,
        in_any_case: bool = False,
    ) -> Any:
        """Return a text, one of several if these are given; these are in lower case."""
        value = self._get(key, default)
        if value is _MISSING:
            return default
        if not isinstance(value, str):
            raise self._wrong(key, f"one of {', '.join(among)}" if among else "a text", value)
        if in_any_case:
            value = value.lower()
        if among and value not in among:
            close = get_close_matches(value, among, 1)
            meant = f", did you mean {close[0]!r}?" if close else ""
            raise self.refused(
                key, f"`{key}` must be one of {', '.join(among)}, got {_got(value)}{meant}"
            )
        return value

    def texts(self, key: str, default: Any = _MISSING, among: Sequence[str] = ()) -> Any:
        """Return several texts, each once; one alone need not be in an array."""
        value = self._get(key, default)
        if value is _MISSING:
            return default
        given = [value] if isinstance(value, str) else value
        wanted = "texts" + (f" among {', '.join(among)}" if among else "")
        if not isinstance(given, list) or not all(isinstance(each, str) for each in given):
            raise self._wrong(key, wanted, value)
        for each in given:
            if among and each not in among:
                raise self._wrong(key, wanted, each)
        if len(set(given)) != len(given):
            raise self._wrong(key, "different texts", value)
        return list(given)

    def flag(self, key: str, default: Any = _MISSING) -> Any:
        """Return a truth value."""
        value = self._get(key, default)
        if value is _MISSING:
            return default
        if not isinstance(value, bool):
            raise self._wrong(key, "true or false", value)
        return value

    def numbers(
        self, key: str, default: Any = _MISSING, *, shape: tuple[int | None, ...] = (3,)
    ) -> Any:
        """Return an array of finite numbers as lists of float; ``None`` is any length but 0."""
        value = self._get(key, default)
        if value is _MISSING:
            return default
        made = _array(value, shape)
        if made is None:
            sides = " x ".join("n" if side is None else str(side) for side in shape)
            raise self._wrong(key, f"an array of {sides} finite numbers", value)
        return made

    def span(
        self,
        key: str,
        default: Any = _MISSING,
        *,
        least: float = -math.inf,
        most: float = math.inf,
        above: float = -math.inf,
    ) -> Any:
        """Return the two ends of a range; one number stands for a range without a length."""
        value = self._get(key, default)
        if value is _MISSING:
            return default
        alone = _finite(value)
        ends = [alone, alone] if alone is not None else _array(value, (2,))
        if ends is None or not (least <= ends[0] <= ends[1] <= most and ends[0] > above):
            limits = f" above {above:g}" if above > -math.inf else ""
            if least > -math.inf or most < math.inf:
                limits += f" within {least:g} and {most:g}"
            raise self._wrong(key, f"a number, or two that do not decrease,{limits}", value)
        return ends[0], ends[1]

    def pairs(self, key: str) -> list[tuple[str, str]]:
        """Return an array of pairs of texts, empty if it is left out."""
        value = self._get(key, None)
        if value is _MISSING:
            return []
        pairs = value if isinstance(value, list) else [()]
        for pair in pairs:
            is_pair = isinstance(pair, list | tuple) and len(pair) == 2
            if not is_pair or not all(isinstance(end, str) for end in pair):
                raise self._wrong(key, "an array of pairs of texts", value)
        return [(first, second) for first, second in value]

    def is_text(self, key: str) -> bool:
        """Tell whether a value is a text, where another form is possible, too."""
        return isinstance(self._data.get(key), str)

    def is_flag(self, key: str) -> bool:
        """Tell whether a value is a truth value, where another form is possible, too."""
        return isinstance(self._data.get(key), bool)

    def is_table(self, key: str) -> bool:
        """Tell whether a value is a table, where another form is possible, too."""
        return isinstance(self._data.get(key), dict)

    def is_false(self, key: str) -> bool:
        """Tell whether a value is ``false``, which stands for none."""
        return self._data.get(key) is False

    def table(self, key: str, default: Any = _MISSING) -> Any:
        """Return a table within this one."""
        value = self._get(key, default)
        return default if value is _MISSING else Table(self._document, (*self._way, key), value)

    def tables(self, key: str) -> list[Table]:
        """Return the tables of an array."""
        value = self._get(key, _MISSING)
        if not isinstance(value, list) or not value:
            raise self._wrong(key, f"one table [[{key}]] or several", value)
        way = (*self._way, key)
        return [Table(self._document, (*way, k), each) for k, each in enumerate(value)]


def _finite(value: Any) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if math.isfinite(number) else None


def _array(value: Any, shape: tuple[int | None, ...]) -> Any:
    if not shape:
        return _finite(value)
    side = shape[0]
    if not isinstance(value, list | tuple) or len(value) != (len(value) if side is None else side):
        return None
    made = [_array(each, shape[1:]) for each in value]
    return None if not made or any(each is None for each in made) else made


def _said(way: Way) -> str:
    text = ""
    for part in way:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
    return text


def _got(value: Any) -> str:
    try:
        text = repr(value)
    except (ValueError, RecursionError):  # an int of more digits than Python prints
        text = f"a {type(value).__name__}"
    return text if len(text) <= 80 else f"{text[:77]}..."
