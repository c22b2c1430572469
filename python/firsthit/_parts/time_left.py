"""Progress in parts, with the time that is left."""

from __future__ import annotations

import sys
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from firsthit._base.types import Progress

    #: Takes how many parts are done.
    Report = Callable[[int], object]

#: How often the line changes, in seconds.
_PAUSE = 0.1


@contextmanager
def following(
    progress: Progress | None, total: int | None, kept: int, unit: str
) -> Iterator[Report | None]:
    """Yield the report for ``progress``; ``None`` if none is wanted. ``kept`` parts are there.

    Where nobody knows the total it is what is done.
    """
    if progress is None or progress is False:
        yield None
    elif progress is True:
        line = _Line(total, kept, unit)
        try:
            line.to(kept)
            yield line.to
        finally:
            line.close()
    elif callable(progress):
        progress(kept, kept if total is None else total)
        yield lambda done: progress(done, done if total is None else total)
    else:
        checked_progress(progress)


def checked_progress(progress: object) -> None:
    """Refuse what cannot be told of progress."""
    if not (progress is None or isinstance(progress, bool) or callable(progress)):
        raise TypeError(f"progress must be True or a function of two numbers, got {progress!r}")


class _Line:
    """A line on standard error that is written anew."""

    def __init__(self, total: int | None, kept: int, unit: str) -> None:
        self._total, self._kept, self._unit = total, kept, unit
        self._began = time.monotonic()
        self._shown = -1.0
        self._width = 0

    def to(self, done: int) -> None:
        now = time.monotonic()
        if now - self._shown < _PAUSE and (self._total is None or done < self._total):
            return
        self._shown = now
        if self._total is None:
            self._write(f"{done} {self._unit}")
            return
        share = 100 * done // max(self._total, 1)
        text = f"{done} of {self._total} {self._unit}, {share} %"
        if self._kept < done < self._total:
            left = (now - self._began) / (done - self._kept) * (self._total - done)
            text += f", {in_words(left)} left"
        self._write(text)

    def close(self) -> None:
        self._write("")
        self._write_plain("\r")

    def _write(self, text: str) -> None:
        self._write_plain("\r" + text.ljust(self._width))
        self._width = len(text)

    def _write_plain(self, text: str) -> None:
        try:
            sys.stderr.write(text)
            sys.stderr.flush()
        except (OSError, ValueError):
            pass  # That nobody listens is no reason to stop.


def in_words(seconds: float) -> str:
    """Return a time as people say it: ``40 s``, ``3 min``, ``5 h``."""
    if seconds < 99.5:
        return f"{seconds:.0f} s"
    if seconds < 99.5 * 60:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.0f} h"
