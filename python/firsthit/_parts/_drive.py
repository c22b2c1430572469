"""Making the parts of a job that are missing, whoever makes them."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from itertools import chain, repeat
from typing import TYPE_CHECKING, Any, Protocol

from ._engine import Task, results
from ._part import seal, writing
from ._time_left import following

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from firsthit._types import Progress

    from ._engine import On
    from ._folder import Parts
    from ._part import Form


class Maker(Protocol):
    """Makes the content of a part. It is pickled for workers in other processes, and is small."""

    def make(self, folder: Path, task: Task) -> dict[str, Any]:
        """Write the files of a part into a folder that is there; return its record."""
        ...


class Work:
    """Makes a part, in whatever process."""

    def __init__(self, maker: Maker, parts: Parts, form: Form) -> None:
        self.maker, self.parts, self.form = maker, parts, form

    def __call__(self, task: Task) -> str:
        """Return the digest: never arrays, which would go through the driver."""
        # Some engines do a task again when its result was lost with a worker that had done it.
        there = self.parts.record(task.number)
        if there is not None:
            return str(there["digest"])
        with writing(self.parts.path(task.number)) as folder:
            record = self.maker.make(folder, task)
            seal(folder, record, self.form.record)
        digest: str = record["digest"]
        return digest


def is_here(on: On) -> bool:
    """Tell whether the work is done in this process, where nothing is pickled."""
    return on is None or isinstance(on, ThreadPoolExecutor)


def drive(
    parts: Parts,
    form: Form,
    maker: Maker,
    wanted: range,
    *,
    on: On,
    verify: bool,
    progress: Progress | None,
    unit: str,
    given: Callable[[int], Any] | None = None,
) -> tuple[int, int]:
    """Make those of some parts that are missing; return how many were made, and how many kept.

    Parameters
    ----------
    parts, form
        Where the parts are, and what they are called.
    maker : Maker
        Makes them.
    wanted : range
        Which.
    on
        What does the work, as `results` has it.
    verify : bool
        Whether the bytes of parts that are there are compared.
    progress, unit
        Who is told how many are done, and what they are called.
    given : callable, optional
        Returns what a task needs beside its number, when it is the task's turn.
    """
    parts.open()
    whole = parts.whole(wanted, verify=verify)
    kept = sum(whole)

    def tasks() -> Iterator[Task]:
        for number, is_whole in zip(wanted, chain(whole, repeat(0)), strict=False):
            if not is_whole:
                yield Task(number, None if given is None else given(number))

    made = 0
    with following(progress, len(wanted), kept, unit) as report:
        for _ in results(Work(maker, parts, form), tasks(), on):
            made += 1
            if report is not None:
                report(kept + made)
    return made, kept
