"""Work on tasks in this process, or by whatever has `concurrent.futures.Executor`'s ``submit``.

The order in which tasks end is nobody's promise: results come with their tasks' numbers.
"""

from __future__ import annotations

import pickle
import traceback
import warnings
from collections import deque
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    wait,
)
from typing import TYPE_CHECKING, Any, NamedTuple, cast

from firsthit._base.errors import FirsthitWarning, warn

if TYPE_CHECKING:
    from collections.abc import Iterable

#: The executor of the work, or what makes one; nothing for this process.
On = Executor | Callable[[], Executor] | None

#: How often a task is tried whose worker was lost.
_TRIES = 3

#: How many tasks are with a worker or wait before it: enough that none is idle, few enough that a
#: driver of a million tasks stays small.
_WAITING = 4

#: How many workers there may be where an executor does not say it.
_MANY = 64


class Task(NamedTuple):
    """A task: its number, what its work needs beside the number, and how often it was lost.

    Dask takes equal calls for the same, and says again that it was lost: a second try differs.
    """

    number: int
    given: Any = None
    losses: int = 0


#: Does a task and returns its result. Both must be picklable for workers in other processes.
Work = Callable[[Task], Any]


def results(work: Work, tasks: Iterable[Task], on: On) -> Generator[tuple[int, Any], None, None]:
    """Yield the number and the result of each task, when it is done.

    A task that was lost with its worker, by a kill or a crash, is tried three times; then, and
    where a pool broke that nobody can make anew, there is a ``RuntimeError``. An error of the work
    itself is raised at once. Tasks are drawn as they are needed.
    """
    if on is None:
        for task in tasks:
            yield task.number, work(task)
        return
    pool = _TaskPool(work, on)
    try:
        yield from pool.results(iter(tasks))
    finally:
        pool.close()


class _Outcome(NamedTuple):
    """The result of a task that was not lost."""

    result: Any = None
    error: Exception | None = None
    trace: str = ""
    warnings: tuple[str, ...] = ()


#: Warnings in this process since its last task, if its driver is to tell them.
_heard: list[str] | None = None


def keep_warnings() -> None:
    """Have the driver show this process's warnings, which would be lost here."""
    global _heard
    _heard = heard = []
    told = warnings.showwarning

    def hear(message: Warning | str, category: type[Warning], *rest: Any, **named: Any) -> None:
        if issubclass(category, FirsthitWarning):
            heard.append(str(message))
        else:
            told(message, category, *rest, **named)

    warnings.showwarning = hear


def _tried(work: Work, task: Task) -> _Outcome:
    """Do a task, and return what it came to with what it warned of."""
    outcome = _done(work, task)
    if not _heard:
        return outcome
    told = tuple(_heard)
    _heard.clear()
    return outcome._replace(warnings=told)


def _done(work: Work, task: Task) -> _Outcome:
    """Do a task. Its errors are results, so that what an executor raises is a loss."""
    try:
        return _Outcome(work(task))
    except Exception as error:
        try:
            pickle.loads(pickle.dumps(error))
        except Exception:
            other = RuntimeError(f"{type(error).__name__}: {error}")
            return _Outcome(error=other, trace=traceback.format_exc())
        return _Outcome(error=error, trace=traceback.format_exc())


class _TaskPool:
    """An executor, and the tasks that are with it."""

    def __init__(self, work: Work, on: Executor | Callable[[], Executor]) -> None:
        self._work = work
        self._make: Callable[[], Executor] | None = None
        self._executor: Executor
        if hasattr(on, "submit") and not isinstance(on, type):
            self._executor = cast("Executor", on)
        else:
            self._make = on
            self._executor = self._made()
        #: In the order in which they were given.
        self._waiting: dict[Future[_Outcome], Task] = {}
        self._again: deque[Task] = deque()
        #: Tasks that were with a pool that broke, and had not begun.
        self._later: deque[Task] = deque()
        self._has_broken = False

    def _made(self) -> Executor:
        assert self._make is not None
        executor = self._make()
        if not hasattr(executor, "submit"):
            expected = "an executor or a function that makes one"
            raise TypeError(f"on must be {expected}, got {executor!r}")
        return executor

    @property
    def _workers(self) -> int | None:
        found = getattr(self._executor, "_max_workers", None)
        return found if isinstance(found, int) and found > 0 else None

    def results(self, tasks: Iterator[Task]) -> Iterator[tuple[int, Any]]:
        while True:
            self._fill(tasks)
            if not self._waiting:
                return
            done, _ = wait(self._waiting, return_when=FIRST_COMPLETED)
            if any(isinstance(_failure(future), BrokenExecutor) for future in done):
                yield from self._mended()
                continue
            for future in done:
                task = self._waiting.pop(future)
                failure = _failure(future)
                if failure is None:
                    yield task.number, _result(future)
                else:
                    self._lose(task, failure)

    def _fill(self, tasks: Iterator[Task]) -> None:
        most = _WAITING * (self._workers or _MANY)
        while len(self._waiting) < most:
            if self._again:
                if self._must_be_alone(self._again[0]) and self._waiting:
                    return
                task = self._again.popleft()
            elif self._has_broken and any(one.losses for one in self._waiting.values()):
                return
            elif self._later:
                task = self._later.popleft()
            else:
                found = next(tasks, None)
                if found is None:
                    return
                task = found
            try:
                future = self._executor.submit(_tried, self._work, task)
            except BrokenExecutor:
                # Those that wait are told of it as well, and all are given to the next pool.
                (self._again if task.losses else self._later).appendleft(task)
                if not self._waiting:
                    self._remake()
                    continue
                return
            self._waiting[future] = task
            if self._must_be_alone(task):
                return

    def _must_be_alone(self, task: Task) -> bool:
        """Whether a task has its last try in a pool that breaks as a whole.

        Which task broke it nobody knows: those that were with a worker are tried again before any
        other begins, and at last one by one, so that none is blamed for its neighbour.
        """
        return self._has_broken and task.losses == _TRIES - 1

    def _mended(self) -> Iterator[tuple[int, Any]]:
        """Take the tasks out of a broken pool, and make another."""
        self._has_broken = True
        waiting, self._waiting = self._waiting, {}
        broken = [task for future, task in waiting.items() if _failure(future) is not None]
        for future, task in waiting.items():
            if _failure(future) is None:
                yield task.number, _result(future)
        # Workers take tasks in their order: only the first ones were with a worker that was lost.
        began = broken[: self._workers]
        self._later.extendleft(reversed(broken[len(began) :]))
        for task in reversed(began):
            self._lose(task, BrokenExecutor("a worker was killed or has crashed"))
        self._remake()

    def _lose(self, task: Task, failure: BaseException) -> None:
        if isinstance(failure, pickle.PicklingError | AttributeError | TypeError):
            # It never was with a worker: what it is made of cannot be sent.
            raise failure
        lost = task.losses + 1
        if lost >= _TRIES:
            what = f"part {task.number} was lost {lost} times with its worker"
            why = (
                "it was killed, crashed, or could not import the work (a script whose own "
                'functions are part of it needs `if __name__ == "__main__":`)'
            )
            said = f"{type(failure).__name__}: {failure}"
            raise RuntimeError(f"{what}: {why}; the last loss: {said}") from failure
        self._again.appendleft(task._replace(losses=lost))

    def _remake(self) -> None:
        if self._make is None:
            raise RuntimeError(
                "the pool is broken, since a worker was killed or has crashed; what is done is "
                "kept. With a function that makes a pool, `on` goes on with another"
            )
        broken = self._executor
        broken.shutdown(wait=False)
        self._executor = self._made()
        if self._executor is broken:
            raise RuntimeError("the pool is broken, and `on` gives the same one again")

    def close(self) -> None:
        """Have nothing begin any more. Of a pool that was made here, wait for what has begun.

        A second Ctrl-C does not wait: it kills the workers, whose parts are not there then.
        """
        workers = getattr(self._executor, "_processes", None) if self._make is not None else None
        processes = list((workers or {}).values())
        try:
            for future in self._waiting:
                future.cancel()
            if self._make is not None:
                self._executor.shutdown(wait=True, cancel_futures=True)
        except BaseException:
            for process in processes:
                process.kill()
            raise


def _failure(future: Future[_Outcome]) -> BaseException | None:
    """Return why there is no outcome; waits for one."""
    try:
        return future.exception()
    except CancelledError as error:
        return error


def _result(future: Future[_Outcome]) -> Any:
    outcome = future.result()
    for text in outcome.warnings:
        warn(text)
    if outcome.error is not None:
        outcome.error.add_note(f"In the worker:\n{outcome.trace}")
        raise outcome.error
    return outcome.result
