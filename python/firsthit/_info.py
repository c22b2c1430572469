"""What is in use."""

import os

from . import _firsthit


def info() -> dict[str, str | int]:
    """Tell the version, the instruction set and the number of threads in use.

    Returns
    -------
    dict
        ``version``; ``instruction_set``, which never changes a result; ``threads``, how many are
        used where ``threads`` is not given.

    Examples
    --------
    >>> import firsthit as fh
    >>> fh.info()["instruction_set"]
    'portable'
    """
    threads = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return {
        "version": _firsthit.version(),
        "instruction_set": "portable",
        "threads": threads or 1,
    }
