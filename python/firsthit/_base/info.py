"""Version, instruction set and threads."""

from firsthit import _firsthit


def info() -> dict[str, str | int]:
    """Tell the version, the instruction set and the number of threads in use.

    Returns
    -------
    dict
        ``version``; ``instruction_set``, the fastest that the machine has, or the one that the
        environment variable ``FIRSTHIT_ISA`` names (``portable``, ``neon``, ``avx2`` or
        ``avx512``; it never changes a result); ``threads``, how many are used where ``threads`` is
        not given, which the affinity of the process and the limits of a control group (cgroup)
        decide.

    Raises
    ------
    ValueError
        If ``FIRSTHIT_ISA`` names no instruction set of this machine.

    Examples
    --------
    >>> import firsthit as fh
    >>> fh.info()["instruction_set"] in {"portable", "neon", "avx2", "avx512"}
    True
    """
    return {
        "version": _firsthit.version(),
        "instruction_set": _firsthit.instruction_set(),
        "threads": _firsthit.all_threads(),
    }
