"""Processes of this machine that end with the one that began them."""

from __future__ import annotations

import os
import signal
import threading
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing.context import SpawnContext, SpawnProcess
from typing import TYPE_CHECKING

from firsthit._arrays import count
from firsthit._parts._engine import keep_warnings

if TYPE_CHECKING:
    from collections.abc import Callable
    from concurrent.futures import Executor

#: How often a worker looks whether its driver is there, in seconds.
_LOOKS = 1.0


def processes(workers: int) -> Callable[[], Executor]:
    """Return what makes a pool of so many processes, to be given as ``on``.

    Each is started anew, and none is forked: it opens the scene's file for itself. Ctrl-C ends the
    job when the parts that were begun are whole. If the driver is killed, its workers end within a
    second or two. If a worker is killed, the pool is made anew.

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
    >>> import firsthit as fh
    >>> pool = fh.many.processes(2)
    >>> pool
    processes(2)
    """
    return _Processes(count("workers", workers, 1, 1024))


class _Processes:
    def __init__(self, workers: int) -> None:
        self._workers = workers

    def __call__(self) -> Executor:
        return ProcessPoolExecutor(
            self._workers,
            mp_context=_Context(),
            initializer=_begin,
            initargs=(os.getpid(),),
        )

    def __repr__(self) -> str:
        return f"processes({self._workers})"


class _Process(SpawnProcess):
    """A process that Ctrl-C does not reach from its first instruction on.

    While Python starts, and imports what it needs, nothing could be ignored yet.
    """

    def start(self) -> None:
        if not hasattr(signal, "pthread_sigmask"):
            super().start()
            return
        # The mask is inherited.
        before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
        try:
            super().start()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


class _Context(SpawnContext):
    Process = _Process


def _begin(driver: int) -> None:
    """Begin a worker: Ctrl-C is the driver's to hear, and nobody works for one that is dead."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    keep_warnings()
    threading.Thread(target=_end_with, args=(driver,), daemon=True).start()


def _end_with(driver: int) -> None:
    while os.getppid() == driver:
        time.sleep(_LOOKS)
    os._exit(1)
