"""Progress of long computations: a bar, a line of percents, or the caller's function."""

from __future__ import annotations

import importlib
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from .types import Progress

    #: Takes how many rays are done.
    Report = Callable[[int], object]


class _Bar(Protocol):
    def to(self, done: int) -> object: ...

    def close(self) -> object: ...


def check(progress: Progress | None) -> None:
    """Refuse a value that is no progress."""
    if not (progress is None or isinstance(progress, bool) or callable(progress)):
        raise TypeError(f"progress must be True or a function of two numbers, got {progress!r}")


@contextmanager
def following(progress: Progress | None, total: int) -> Iterator[Report | None]:
    """Yield the report for ``progress`` out of ``total``; ``None`` if none is wanted."""
    check(progress)
    if progress is None or progress is False:
        yield None
    elif progress is True:
        bar = _bar(total)
        try:
            yield bar.to
        finally:
            bar.close()
    else:
        yield lambda done: progress(done, total)


def later(report: Report | None, before: int) -> Report | None:
    """Return a report that counts on from ``before``."""
    return None if report is None else lambda done: report(before + done)


def _bar(total: int) -> _Bar:
    try:
        made = importlib.import_module("tqdm.auto").tqdm
    except ImportError:
        return _Percents(total)
    return _Tqdm(made(total=total, unit=" rays", unit_scale=True))


class _Tqdm:
    """A bar of tqdm, whose updates are increments."""

    def __init__(self, bar: object) -> None:
        self._bar = bar

    def to(self, done: int) -> None:
        bar = self._bar
        bar.update(done - bar.n)  # type: ignore[attr-defined]

    def close(self) -> None:
        self._bar.close()  # type: ignore[attr-defined]


class _Percents:
    """A line of percents, for when tqdm is not installed."""

    def __init__(self, total: int) -> None:
        self._total, self._shown = total, -1

    def to(self, done: int) -> None:
        percents = 100 * done // max(self._total, 1)
        if percents != self._shown:
            self._shown = percents
            sys.stderr.write(f"\r{percents:3d} %")
            sys.stderr.flush()

    def close(self) -> None:
        sys.stderr.write("\n")
