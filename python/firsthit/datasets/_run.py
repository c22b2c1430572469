"""Making a data set: the frames that are missing, and then what is of all of them."""

from __future__ import annotations

import os
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from firsthit._arrays import count, flag, threads_or_all
from firsthit._errors import FileError, FileFormatError, FileWriteError

from ._digest import of_digests
from ._frame import FrameMaker
from ._job import claim, fingerprint
from ._merge import merge
from ._part import discard, name_of, record_of, remove_leftovers, writing
from ._plan import Plan
from ._scenes import Loaded
from ._time_left import following

if TYPE_CHECKING:
    from collections.abc import Iterator

    from firsthit._types import Progress


class Made(NamedTuple):
    """What a run came to.

    Attributes
    ----------
    frames : int
        How many frames the plan has.
    made : int
        How many this run made.
    kept : int
        How many it found, whole.
    missing : int
        How many other parts still have to make.
    digest : str or None
        The sha256 over the digests of all frames in their order; ``None`` while some are missing.
        It is the same for any number of runs, parts, threads and machines.
    """

    frames: int
    made: int
    kept: int
    missing: int
    digest: str | None


def dataset(
    plan: Plan | str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    part: tuple[int, int] | None = None,
    threads: int | None = None,
    verify: bool = False,
    progress: Progress | None = None,
) -> Made:
    """Make the frames and annotations of a plan.

    Frames that are there are kept, so a run that was killed goes on where it was. Each frame has a
    folder in ``frames``, which is there when it is whole. When all are there, the annotations of
    all are put together. ``docs/datasets.md`` says what is in the folder.

    Parameters
    ----------
    plan : Plan or path-like
        The plan, or its file.
    out : path-like
        The folder; it is made.
    part : pair of int, optional
        ``(k, n)``, k from 1 to n: make the k-th of n parts of the frames only. The parts of a plan
        may be made in any order, at the same time, and on several machines that share the folder.
        The run that finds all frames there puts the annotations together.
    threads : int, optional
        The number of threads; all cores if left out. The bytes are the same for any number.
    verify : bool
        Whether to compare the bytes of frames that are there with their sha256, not only the sizes
        of their files. Frames that do not fit are made again in either case.
    progress : bool or callable, optional
        ``True`` for a line on standard error with the time left, or a function that is called with
        the frames that are done and those of this part. An exception that it raises ends the run.

    Returns
    -------
    Made
        How many frames were made and kept, and the digest.

    Raises
    ------
    FileReadError, FileFormatError
        As `Plan.load` and `load`, and for a scene that is not what it was when the job began.
    ValueError
        For a plan that does not fit its scenes, a frame without a place for the rig, values that a
        format cannot hold, and a part that there is not.
    FileWriteError
        If the system refuses to write, and if the folder is another job's.
    MemoryError
        If memory is short.

    Warns
    -----
    FirsthitWarning
        For what is doubtful in scenes.

    Examples
    --------
    >>> import firsthit as fh
    >>> import tempfile
    >>> plan = fh.Plan.from_dict({
    ...     "scenes": [{"file": "docs/scenes/shapes.toml"}],
    ...     "sensors": [{"kind": "camera", "rows": 12, "columns": 16}],
    ...     "poses": {"kind": "sphere", "count": 2, "radius": 5, "elevation": 30},
    ... })
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     first = fh.dataset(plan, folder, part=(1, 2))
    ...     rest = fh.dataset(plan, folder)
    >>> (first.made, first.missing), (rest.made, rest.kept)
    ((1, 1), (1, 1))
    """
    made = plan if isinstance(plan, Plan) else Plan.load(plan)
    threads_or_all(threads)
    run = _Run(made, Path(out), threads, verify=flag("verify", verify))
    return run.go(_range(part, made.frames), progress)


def _range(part: tuple[int, int] | None, frames: int) -> range:
    """Return the frames of a part: as many as of any other, or one less."""
    if part is None:
        return range(frames)
    if not isinstance(part, tuple | list) or len(part) != 2:
        raise ValueError(f"part must be two whole numbers, k of n, got {part!r}")
    parts = count("part", part[1], 1)
    k = count("part", part[0], 1, parts)
    return range((k - 1) * frames // parts, k * frames // parts)


@contextmanager
def _of(frame: int) -> Iterator[None]:
    """Say which frame it is that a format cannot hold, or that has no place for the rig."""
    try:
        yield
    except FileError:
        raise
    except ValueError as error:
        raise ValueError(f"frame {frame}: {error}") from None


class _Run:
    def __init__(self, plan: Plan, out: Path, threads: int | None, *, verify: bool) -> None:
        self._plan, self._out, self._threads, self._verify = plan, out, threads, verify
        self._frames = out / "frames"

    def go(self, wanted: range, progress: Progress | None) -> Made:
        plan, loaded = self._plan, Loaded(self._plan._scenes)
        marks = claim(self._out, plan, loaded, self._threads)
        try:
            self._frames.mkdir(exist_ok=True)
        except OSError as error:
            name = os.fspath(self._frames)
            raise FileWriteError(f"{name}: {error.strerror or error}", name) from error
        remove_leftovers(self._out)
        remove_leftovers(self._frames)
        missing = self._missing(wanted)
        maker, made = FrameMaker(plan, self._threads), 0
        checked: set[int] = set()
        with following(progress, len(wanted), len(wanted) - len(missing)) as report:
            for frame in missing:
                number = plan.scene_of(frame).scene
                scene = loaded.scene(number)
                if number not in checked:
                    self._check(number, fingerprint(scene), marks[number])
                    checked.add(number)
                with writing(self._path(frame)) as folder, _of(frame):
                    maker.make(folder, frame, scene, marks[number])
                made += 1
                if report is not None:
                    report(len(wanted) - len(missing) + made)
        rest, digests = self._found()
        digest = None if rest else of_digests(digests)
        if digest is not None:
            merge(self._out, plan, self._records, digest)
        return Made(plan.frames, made, len(wanted) - made, rest, digest)

    def _path(self, frame: int) -> Path:
        return self._frames / name_of(frame, self._plan.frames)

    def _missing(self, wanted: range) -> list[int]:
        """Return the frames that are not there, or not whole; the latter are removed."""
        there = {entry.name for entry in os.scandir(self._frames)}
        missing = []
        for frame in wanted:
            path = self._path(frame)
            if path.name in there:
                if record_of(path, self._plan.digest, verify=self._verify) is not None:
                    continue
                discard(path)
            missing.append(frame)
        return missing

    def _check(self, number: int, found: str, wanted: str) -> None:
        if found != wanted:
            planned = self._plan._scenes[number]
            path = os.fspath(planned.path)
            why = f"not the scene that the job began with: its fingerprint is {found}, not {wanted}"
            raise FileFormatError(f"{path}: {why}", path)

    def _found(self) -> tuple[int, list[str]]:
        """Return how many frames are missing, and if none is, the digests in their order."""
        there = {entry.name for entry in os.scandir(self._frames)}
        paths = [self._path(frame) for frame in range(self._plan.frames)]
        missing = sum(path.name not in there for path in paths)
        if missing:
            # Nothing is read: with many parts each would read all the others.
            return missing, []
        records = [record_of(path, self._plan.digest) for path in paths]
        digests = [record["digest"] for record in records if record is not None]
        return len(paths) - len(digests), digests

    def _records(self) -> Iterator[dict[str, Any]]:
        for frame in range(self._plan.frames):
            path = self._path(frame)
            record = record_of(path, self._plan.digest)
            if record is None:
                raise FileFormatError(f"{path}: damaged while it was read", os.fspath(path))
            yield record
