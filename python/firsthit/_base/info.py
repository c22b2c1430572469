"""Facts of this build of firsthit, and of files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from firsthit import _firsthit

from .errors import FileReadError, blaming

if TYPE_CHECKING:
    import os


def info(path: str | os.PathLike[str] | None = None) -> dict[str, Any]:
    """Tell what is in a file; without one, what this build of firsthit is.

    Parameters
    ----------
    path : path-like, optional
        A 3D file, a scene file (TOML), or an output, as ``firsthit info`` takes them.

    Returns
    -------
    dict
        Of a file what ``firsthit info --json`` prints: of a 3D file its objects, cameras, lights,
        materials, bounds, ...; of an output its format, arrays and metadata. Else ``version``;
        ``instruction_set``, the fastest that the machine has, or the one that the environment
        variable ``FIRSTHIT_ISA`` names (``portable``, ``neon``, ``avx2`` or ``avx512``; it never
        changes a result); ``threads``, how many are used where ``threads`` is not given, which the
        affinity of the process and the limits of a control group (cgroup) decide.

    Raises
    ------
    ValueError
        For a file that is neither a 3D file nor an output; without a file, if ``FIRSTHIT_ISA``
        names no instruction set of this machine.
    FileReadError, FileFormatError, MemoryError
        As `load`.

    Examples
    --------
    >>> fh.info()["instruction_set"] in {"portable", "neon", "avx2", "avx512"}
    True
    """
    if path is not None:
        with blaming(path, FileReadError), Path(path).open("rb"):
            pass
        return dict(json.loads(_firsthit.info(Path(path))))
    return {
        "version": _firsthit.version(),
        "instruction_set": _firsthit.instruction_set(),
        "threads": _firsthit.all_threads(),
    }
