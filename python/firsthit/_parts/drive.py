"""The making of a job's missing parts, by this process or by workers."""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from itertools import chain, repeat
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from firsthit._base.arrays import flag, threads_or_all
from firsthit._base.errors import FileWriteError
from firsthit._base.progress import check, following

from .engine import Task, results
from .job import checked_part, range_of
from .part import discard, seal, writing

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from pathlib import Path

    from firsthit.typing import Progress

    from .engine import On
    from .folder import Parts


#: How often a part is made whose place something else takes at the same time.
_TRIES = 2

#: How long, in seconds, a network's file system may hide what another machine has written.
_PATIENCE = 60


class Maker(Protocol):
    """Makes the content of a part. It is pickled for workers in other processes, and is small."""

    def make(self, folder: Path, task: Task) -> dict[str, Any]:
        """Write the files of a part into a folder that is there; return its record."""
        ...


class Work:
    """Makes a part, in whatever process."""

    def __init__(self, maker: Maker, parts: Parts) -> None:
        self.maker, self.parts = maker, parts

    def __call__(self, task: Task) -> bool:
        """Make the part unless it is there; return whether this run made it.

        Its digest is in its record. Arrays are not returned: they would go through the driver.
        """
        path = self.parts.path(task.number)
        for _ in range(_TRIES):
            # Another run may have made it, or a worker of this run that was lost before it said so.
            if self.parts.record(task.number) is not None:
                return task.losses > 0
            if path.exists() or path.is_symlink():
                discard(path)
            with writing(path) as part:
                seal(part.folder, self.maker.make(part.folder, task), self.parts.form.record)
            if part.is_placed:
                return True
        raise FileWriteError._of(path, "something else comes in its place")


class RunSettings(NamedTuple):
    """The settings of doing a job, which change no byte of it."""

    on: On
    part: tuple[int, int] | None
    threads: int | None
    verify: bool
    progress: Progress | None

    @classmethod
    def of(
        cls,
        on: On,
        part: tuple[int, int] | None,
        threads: int | None,
        verify: bool,  # noqa: FBT001 - as it was given
        progress: Progress | None,
    ) -> RunSettings:
        """Check what a user gave."""
        threads_or_all(threads)
        if on is not None and not hasattr(on, "submit") and not callable(on):
            raise TypeError(f"on must be an executor or a function that makes one, got {on!r}")
        checked_part(part)
        check(progress)
        return cls(on, part, threads, flag("verify", verify), progress)


def is_here(on: On) -> bool:
    """Tell whether the work is done in this process, where nothing is pickled."""
    return on is None or isinstance(on, ThreadPoolExecutor)


def drive(
    parts: Parts,
    maker: Maker,
    how: RunSettings,
    unit: str,
    given: Callable[[int], Any] | None = None,
) -> tuple[int, int]:
    """Make the missing ones of a run's parts; return how many were made, and how many kept.

    ``given`` returns what a task needs beside its number, when it is the task's turn.
    """
    wanted = range_of(how.part, parts.count)
    parts.open()
    whole = parts.whole(wanted, verify=how.verify)
    kept = sum(whole)

    def tasks() -> Iterator[Task]:
        for number, is_whole in zip(wanted, chain(whole, repeat(0)), strict=False):
            if not is_whole:
                yield Task(number, None if given is None else given(number))

    made = make(Work(maker, parts), tasks(), how.on, how.progress, (len(wanted), kept, unit))
    return made, kept


def make(
    work: Work,
    tasks: Iterable[Task],
    on: On,
    progress: Progress | None,
    counts: tuple[int | None, int, str],
) -> int:
    """Do the tasks of a job; return how many parts were made by these workers.

    Another run may make some at the same time. ``counts`` are all tasks, if that is known, those
    that were done before, and their unit.
    """
    made, done_before = 0, counts[1]
    with following(progress, *counts) as report, closing(results(work, tasks, on)) as done:
        for ended, (number, is_made) in enumerate(done, 1):
            if ended == 1:
                _look_for(work.parts.path(number))
            made += is_made
            if report is not None:
                report(done_before + ended)
    return made


def _look_for(path: Path) -> None:
    """Refuse workers that write to another place: the first part must be seen here."""
    tries = 0
    while not path.is_dir():
        tries += 1
        if tries > _PATIENCE:
            why = "a worker has made it, and it is not here: do all see the folder by this path?"
            raise FileWriteError._of(path, why)
        time.sleep(1.0)
