"""The logger ``firsthit``: what takes time, and which files are read and written.

It is silent unless a program sets up logging. Warnings are Python's, and not logged here: who wants
them in a log has ``logging.captureWarnings``.
"""

from __future__ import annotations

import logging
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

DEBUG = logging.DEBUG
LOGGER = logging.getLogger("firsthit")
LOGGER.addHandler(logging.NullHandler())


def log_steps() -> None:
    """Write what is logged to standard error, as the program does by ``-v``."""
    lines = logging.StreamHandler()
    lines.setFormatter(logging.Formatter("firsthit: %(message)s"))
    LOGGER.addHandler(lines)
    LOGGER.setLevel(DEBUG)


@contextmanager
def timed(what: str, *about: object, level: int = logging.INFO) -> Iterator[None]:
    """Log something when it is done, with its seconds; what fails says so by its exception."""
    if not LOGGER.isEnabledFor(level):
        yield
        return
    start = time.perf_counter()
    yield
    LOGGER.log(level, f"{what} in %.3f s", *about, time.perf_counter() - start)
