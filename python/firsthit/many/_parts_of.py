"""The content of the folder of a job."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from firsthit._base.arrays import flag
from firsthit._base.errors import FileFormatError
from firsthit._parts.folder import Parts
from firsthit._parts.job import JOB, known_job
from firsthit._parts.part import FRAMES, PARTS

from ._jobs import MOST_IN_A_STREAM

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator

    from firsthit._parts.part import Form

#: More parts than this no folder has.
_MOST = 10**12


class JobState(NamedTuple):
    """The content of the folder of a job.

    Attributes
    ----------
    job : dict
        The contents of ``job.json``: the scene, what the parts are of, the version that makes them.
    parts : int
        How many parts the job has.
    done : int
        How many of them are whole.
    missing : tuple of range
        The numbers of the others.
    digest : str or None
        The digest of the job; ``None`` while parts are missing.
    """

    job: dict[str, Any]
    parts: int
    done: int
    missing: tuple[range, ...]
    digest: str | None


def parts(folder: str | os.PathLike[str], *, verify: bool = False) -> JobState:
    """Say which parts of a job are there; nothing is changed.

    Parameters
    ----------
    folder : path-like
        The folder of `render_many`, `shoot_many`, `visible_many` or `dataset`.
    verify : bool
        Whether to compare the bytes of all files with their sha256, not only their sizes.

    Returns
    -------
    JobState
        The parts that are there and those that are missing.

    Raises
    ------
    FileReadError, FileFormatError
        For a folder that cannot be read, or is that of no job.
    TypeError
        For ``verify`` that is not ``True`` or ``False``.

    Examples
    --------
    >>> scene = fh.Scene()
    >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
    0
    >>> rays = [(0, 0, 5)] * 10, [(0, 0, -1)] * 10
    >>> made = fh.shoot_many(scene, rays, "hits", part_size=4, part=(2, 3))
    >>> state = fh.parts("hits")
    >>> (state.parts, state.done, state.missing)
    (3, 1, (range(0, 1), range(2, 3)))
    """
    return found(Path(folder), verify=flag("verify", verify)).state


class Found(NamedTuple):
    """The parts of a folder."""

    #: The parts that are there.
    state: JobState
    #: Where.
    parts: Parts
    #: The digest of the job: of what the parts are, not of what is in them.
    digest: str
    #: Whether the number of parts is known.
    is_ended: bool

    @property
    def missing(self) -> tuple[range, ...]:
        """The missing parts, without the rest of a stream, whose end is unknown."""
        known = self.state.missing
        return known if self.is_ended or not known else known[:-1]

    def numbers(self) -> Iterator[int]:
        """Yield the numbers of the parts that are whole."""
        last = 0
        for one in (*self.state.missing, range(self.state.parts, self.state.parts)):
            yield from range(last, one.start)
            last = one.stop

    def records(self) -> Iterator[dict[str, Any]]:
        """Yield their records."""
        for number in self.numbers():
            yield self.parts.whole_record(number)


def found(out: Path, *, verify: bool) -> Found:
    """Return the parts of a folder, with the errors of `parts`."""
    said = known_job(out / JOB)
    if said is None:
        raise FileFormatError._of(out, f"there is no {JOB}, so no job of firsthit")
    form, job, count = _form_of(out, said)
    there = Parts(out, form, job, count)
    if _is_stream(said):
        there = Parts(out, form, job, MOST_IN_A_STREAM).first(count)
    if (out / form.folder).is_symlink():
        # The target of a link may be anything.
        raise FileFormatError._of(out / form.folder, "a link, not the folder of a job")
    whole = sorted(
        number
        for number in (there.there() if (out / form.folder).is_dir() else ())
        if there.record(number, verify=verify) is not None
    )
    missing, last = [], 0
    for number in (*whole, count):
        if number > last:
            missing.append(range(last, number))
        last = number + 1
    digest = None if missing else there.state()[1]
    state = JobState(said, count, len(whole), tuple(missing), digest)
    is_ended = not (_is_stream(said) and said.get("parts") is None)
    return Found(state, there, job, is_ended)


def _is_stream(said: dict[str, Any]) -> bool:
    rays = said.get("rays")
    return isinstance(rays, dict) and rays.get("kind") == "stream"


def _form_of(out: Path, said: dict[str, Any]) -> tuple[Form, str, int]:
    """Return what the parts of a job are called, its digest, and how many parts it has."""
    for form, key in ((PARTS, "parts"), (FRAMES, "frames")):
        job, count = said.get(form.job), said.get(key)
        if count is None and _is_stream(said):
            # Nobody knows before it has come to its end.
            count = MOST_IN_A_STREAM
        if isinstance(job, str) and type(count) is int and 0 <= count <= _MOST:
            return form, job, count
    raise FileFormatError._of(out / JOB, "no job of firsthit: it does not say how many parts")
