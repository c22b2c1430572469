"""Processes of this machine that end with the one that began them."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import sys
import threading
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager, nullcontext
from multiprocessing.context import SpawnContext, SpawnProcess
from types import ModuleType
from typing import TYPE_CHECKING, Any, TypeVar

from firsthit._base.arrays import count
from firsthit._parts.engine import keep_warnings

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from concurrent.futures import Executor, Future

_T = TypeVar("_T")


def processes(workers: int) -> Callable[[], Executor]:
    """Return a maker of a pool of ``workers`` processes, to be given as ``on``.

    Each is started anew, and none is forked: it opens the scene's file for itself. Ctrl-C ends the
    job when the parts that were begun are whole. If the driver is killed, its workers end too. If a
    worker is killed, the pool is made anew. A script needs no ``if __name__ == "__main__":``,
    unless its own functions are part of the work.

    Parameters
    ----------
    workers : int
        How many. Each uses all cores unless ``threads`` says otherwise.

    Returns
    -------
    callable
        Makes a `concurrent.futures.ProcessPoolExecutor`.

    Examples
    --------
    >>> pool = fh.many.processes(2)
    >>> pool
    processes(2)
    """
    return _Processes(count("workers", workers, 1, 1024))


class _Processes:
    def __init__(self, workers: int) -> None:
        self._workers = workers

    def __call__(self) -> Executor:
        return _ProcessPool(self._workers)

    def __repr__(self) -> str:
        return f"processes({self._workers})"


class _ProcessPool(ProcessPoolExecutor):
    """A pool whose workers run the user's script again only where the work is defined in it.

    Else a script without ``if __name__ == "__main__":`` would begin its job in each worker.
    """

    def __init__(self, workers: int) -> None:
        self._context, self._is_known = _Context(), False
        # An interrupt between the creation of a semaphore and its registration would leak it.
        with _deferred_interrupts():
            super().__init__(workers, mp_context=self._context, initializer=_begin)

    def submit(self, fn: Callable[..., _T], /, *args: Any, **named: Any) -> Future[_T]:
        # All tasks do the same work.
        if not self._is_known:
            self._context.needs_script = b"__main__" in pickle.dumps((fn, args, named))
            self._is_known = True
        # An interrupt between the start of a worker and its registration would leave it running.
        with _deferred_interrupts():
            return super().submit(fn, *args, **named)


class _Process(SpawnProcess):
    """A process that runs the user's script again only where the work is defined in it."""

    needs_script = True

    def start(self) -> None:
        with nullcontext() if self.needs_script else _without_script():
            super().start()


@contextmanager
def _deferred_interrupts() -> Iterator[None]:
    """Defer Ctrl-C to the end of the block; a process that starts within it never receives it."""
    with _interrupts_masked(), _interrupts_recorded():
        yield


@contextmanager
def _interrupts_masked() -> Iterator[None]:
    """Block SIGINT in this thread, and in processes that it starts, which inherit the mask.

    A worker could ignore nothing yet while Python starts and imports what it needs.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _interrupts_recorded() -> Iterator[None]:
    """Raise SIGINT at the end of the block if it has come meanwhile.

    The mask alone does not defer it: another thread, such as one of numpy's, receives it, and
    Python runs the handler in the main thread.
    """
    handler = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(handler):
        yield
        return
    received = []
    signal.signal(signal.SIGINT, lambda *_: received.append(True))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, handler)
    if received:
        signal.raise_signal(signal.SIGINT)


@contextmanager
def _without_script() -> Iterator[None]:
    """Have a process that starts now find no script to run again."""
    script = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = script


class _Context(SpawnContext):
    needs_script = True

    def Process(self, *given: Any, **named: Any) -> _Process:  # type: ignore[override]
        """Return a process that is not started yet."""
        made = _Process(*given, **named)
        made.needs_script = self.needs_script
        return made


def _begin() -> None:
    """Begin a worker: Ctrl-C is the driver's to handle, and no worker outlives its driver."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    keep_warnings()
    threading.Thread(target=_end_with_driver, daemon=True).start()


def _end_with_driver() -> None:
    driver = multiprocessing.parent_process()
    assert driver is not None
    driver.join()
    os._exit(1)
