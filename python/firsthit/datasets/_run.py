"""Making a data set: the frames that are missing, and then what is of all of them."""

from __future__ import annotations

import os
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from firsthit._arrays import count, flag, threads_or_all
from firsthit._errors import FileError, FileFormatError

from ._frame import FrameMaker
from ._frames import Frames
from ._job import claim
from ._mark import Mark, mark_of
from ._merge import merge
from ._part import remove_leftovers, writing
from ._plan import Plan
from ._scenes import Loaded
from ._time_left import following

if TYPE_CHECKING:
    from collections.abc import Iterator

    from firsthit._types import Progress

    from ._time_left import Report


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
    ImportError
        For clouds as ``.laz`` or ``.parquet`` where the package is missing that they take.
    MemoryError
        If memory is short.

    Warns
    -----
    FirsthitWarning
        For what is doubtful in scenes.

    Examples
    --------
    >>> import firsthit as fh
    >>> scene = fh.Scene()
    >>> ball = scene.add(fh.Sphere(center=(0, 0, 0), radius=1), name="ball")
    >>> scene.save("ball.fhs")
    >>> plan = fh.Plan.from_dict({
    ...     "scenes": [{"file": "ball.fhs"}],
    ...     "sensors": [{"kind": "camera", "rows": 12, "columns": 16}],
    ...     "poses": {"kind": "sphere", "count": 2, "radius": 5, "elevation": 30},
    ... })
    >>> first = fh.dataset(plan, "balls", part=(1, 2))
    >>> rest = fh.dataset(plan, "balls")
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
        self._frames = Frames(out / "frames", plan.digest, plan.frames)

    def go(self, wanted: range, progress: Progress | None) -> Made:
        loaded = Loaded(self._plan._scenes)
        marks = claim(self._out, self._plan, loaded, self._threads)
        remove_leftovers(self._out)
        self._frames.open()
        kept = self._frames.whole(wanted, verify=self._verify)
        with following(progress, len(wanted), len(kept)) as report:
            made = self._make(wanted, kept, loaded, marks, report)
        missing, digest = self._frames.state()
        if digest is not None:
            merge(self._out, self._plan, self._frames.records, digest)
        return Made(self._plan.frames, made, len(kept), missing, digest)

    def _make(
        self,
        wanted: range,
        kept: set[int],
        loaded: Loaded,
        marks: list[Mark],
        report: Report | None,
    ) -> int:
        """Make the frames that are not there; return how many these were."""
        maker, made, last = FrameMaker(self._plan, self._threads), 0, -1
        for frame in wanted:
            if frame in kept:
                continue
            number = self._plan.scene_of(frame).scene
            scene = loaded.scene(number)
            if number != last:
                self._check(number, mark_of(scene), marks[number])
                last = number
            with writing(self._frames.path(frame)) as folder, _of(frame):
                maker.make(folder, frame, scene, marks[number])
            made += 1
            if report is not None:
                report(len(kept) + made)
        return made

    def _check(self, number: int, found: Mark, wanted: Mark) -> None:
        for name, value in found._asdict().items():
            if value != getattr(wanted, name):
                path = os.fspath(self._plan._scenes[number].path)
                why = f"its {name} is {value}, not {getattr(wanted, name)}"
                raise FileFormatError(f"{path}: not what it was when the job began: {why}", path)
