"""Progress of long computations: a line with the time that is left, or the caller's function."""

from __future__ import annotations

import shutil
import sys
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from firsthit.typing import Progress

    #: Takes how much is done; of work in steps also the step's total, its name and its unit.
    Report = Callable[..., object]

#: How often the line changes, in seconds.
_PAUSE = 0.1


def check(progress: Progress | None) -> None:
    """Refuse a value that is no progress."""
    if not (progress is None or isinstance(progress, bool) or callable(progress)):
        raise TypeError(f"progress must be True or a function of two numbers, got {progress!r}")


@contextmanager
def following(
    progress: Progress | None,
    total: int | None = None,
    kept: int | None = None,
    unit: str = "rays",
    name: str = "",
) -> Iterator[Report | None]:
    """Yield the report for ``progress`` out of ``total``; ``None`` if none is wanted.

    ``kept`` is what was done before, which is told at once. Where nobody knows the total it is what
    is done. ``name`` is that of the step on the line.
    """
    check(progress)
    if progress is None or progress is False:
        yield None
        return
    line = _Line(total, kept or 0, unit, name)

    def tell(done: int, total: int | None = total, *_: str) -> None:
        total = done if total is None else total
        # Of nothing there is no share.
        if callable(progress) and total:
            progress(done, total)

    report: Report = line.to if progress is True else tell
    try:
        if kept is not None:
            report(kept)
        yield report
    finally:
        line.close()


def later(report: Report | None, before: int) -> Report | None:
    """Return a report that counts on from ``before``."""
    return None if report is None else lambda done, *step: report(before + done, *step)


class _Line:
    """A line on standard error that is written anew, from its start for each step."""

    def __init__(self, total: int | None, kept: int, unit: str, name: str) -> None:
        self._step, self._kept = (total, name, unit), kept
        self._began, self._shown = time.monotonic(), -1.0
        self._width = 0

    def to(self, done: int, total: int | None = None, name: str = "", unit: str = "") -> None:
        now = time.monotonic()
        if name and self._step != (total, name, unit):
            self._step, self._kept = (total, name, unit), 0
            self._began, self._shown = now, -1.0
        total, name, unit = self._step
        if now - self._shown < _PAUSE and (total is None or done < total):
            return
        self._shown = now
        text = f"{name}: {done}" if name else str(done)
        if total is None:
            self._write(f"{text} {unit}")
            return
        text += f" of {total} {unit}, {100 * done // max(total, 1)} %"
        if self._kept < done < total:
            left = (now - self._began) / (done - self._kept) * (total - done)
            text += f", {_in_words(left)} left"
        self._write(text)

    def close(self) -> None:
        if self._width:
            self._write("")
            self._write_plain("\r")

    def _write(self, text: str) -> None:
        # A line that wraps cannot be written anew. Its end says how much is done.
        if sys.stderr is not None and sys.stderr.isatty():
            columns = shutil.get_terminal_size().columns
            text = text if len(text) < columns else f"...{text[4 - columns :]}"
        self._write_plain("\r" + text.ljust(self._width))
        self._width = len(text)

    def _write_plain(self, text: str) -> None:
        try:
            sys.stderr.write(text)
            sys.stderr.flush()
        except (OSError, ValueError, AttributeError):
            pass  # That nobody listens, or that there is no stream, is no reason to stop.


def _in_words(seconds: float) -> str:
    """Return a time as people say it: ``40 s``, ``3 min``, ``5 h``."""
    if seconds < 99.5:
        return f"{seconds:.0f} s"
    if seconds < 99.5 * 60:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.0f} h"
