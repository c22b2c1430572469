"""Turns: one thread does something while others wait for what comes of it."""

from __future__ import annotations

import os
import threading
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator


class _Here(threading.local):
    """The state of this thread."""

    has_turn = False


_here = _Here()


class Turn:
    """A lock that only saves work: two threads that did it at once would both be right.

    A thread that already has a turn, of any lock, does not wait. It would be a signal's handler or
    a finaliser that interrupts the work, and the work would wait for it. A process that is forked
    while a thread has its turn does not have that thread, and begins anew.
    """

    def __init__(self) -> None:
        #: The process that it belongs to, and its lock.
        self._owned = os.getpid(), threading.Lock()

    @contextmanager
    def taken(self) -> Iterator[None]:
        """Wait for the turn, and give it back in the end."""
        if _here.has_turn:
            yield
            return
        process, lock = self._owned
        if process != os.getpid():
            _, lock = self._owned = os.getpid(), threading.Lock()
        # Before the lock is taken, lest a handler come in between.
        _here.has_turn = True
        try:
            with lock:
                yield
        finally:
            _here.has_turn = False
