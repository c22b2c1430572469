"""The result of a run."""

from __future__ import annotations

from typing import Any, NamedTuple


class Made(NamedTuple):
    """The result of a run.

    Attributes
    ----------
    parts : int
        How many parts the job has.
    made : int
        How many this run made.
    kept : int
        How many it found, whole.
    missing : int
        How many parts are still missing.
    digest : str or None
        The sha256 over the digests of all parts in their order; ``None`` while some are missing. It
        is the same for any number of runs, workers, threads and machines.
    result
        What a ``fold`` came to; ``None`` while parts are missing, and without one.
    """

    parts: int
    made: int
    kept: int
    missing: int
    digest: str | None
    result: Any = None
