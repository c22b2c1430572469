"""Making a data set: the frames that are missing, and then what is of all of them."""

from __future__ import annotations

import uuid
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from firsthit._base.errors import FileError
from firsthit._base.log import timed
from firsthit._parts.drive import RunSettings, drive
from firsthit._parts.folder import Parts
from firsthit._parts.part import FRAMES, remove_leftovers
from firsthit._parts.scene_store import forget, opened

from ._frame import FrameMaker
from ._job import claim
from ._merge import merge
from ._plan import Plan

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator

    from firsthit._parts.engine import On, Task
    from firsthit._parts.scene_store import Mark
    from firsthit.typing import Progress


class DatasetResult(NamedTuple):
    """The result of a run.

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
    on: On = None,
    part: tuple[int, int] | None = None,
    threads: int | None = None,
    verify: bool = False,
    progress: Progress | None = None,
) -> DatasetResult:
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
    on : executor, or function that makes one, optional
        The maker of the frames: anything with ``submit`` as `concurrent.futures.Executor` has it,
        of processes or of machines that share the folder, as for `render_many`. This process if
        left out.
    part : pair of int, optional
        ``(k, n)``, k from 1 to n: make the k-th of n parts of the frames only. The parts of a plan
        may be made in any order, at the same time, and on several machines that share the folder.
        The run that finds all frames there puts the annotations together.
    threads : int, optional
        The number of threads of each process; all cores if left out. The bytes are the same for
        any number.
    verify : bool
        Whether to compare the bytes of frames that are there with their sha256, not only the sizes
        of their files. Frames that do not fit are made again in either case.
    progress : bool or callable, optional
        ``True`` for a line on standard error with the time left, or a function that is called with
        the frames that are done and those of this part. An exception that it raises ends the run.

    Returns
    -------
    DatasetResult
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
    RuntimeError
        As `render_many`.

    Warns
    -----
    FirsthitWarning
        For what is doubtful in scenes.

    Examples
    --------
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
    how = RunSettings.of(on, part, threads, verify, progress)
    folder, run = Path(out).absolute(), uuid.uuid4().hex
    marks = claim(run, folder, made, threads)
    remove_leftovers(folder)
    frames = Parts(folder, FRAMES, made.digest, made.frames)
    maker = _Frames(run, made, marks, threads)
    try:
        count, kept = drive(frames, maker, how, "frames")
        missing, digest = frames.state()
        if digest is not None and count < made.frames:
            maker.refuse_changed()
    finally:
        forget(run)
    if digest is not None:
        merge(folder, made, frames.records, digest)
    return DatasetResult(made.frames, count, kept, missing, digest)


@contextmanager
def _of(frame: int) -> Iterator[None]:
    """Say which frame it is that a format cannot hold, or that has no place for the rig."""
    try:
        yield
    except FileError:
        raise
    except ValueError as error:
        raise ValueError(f"frame {frame}: {error}") from None


class _Frames(NamedTuple):
    """Makes the frames of a plan, also in other processes: each reads the scenes of its frames."""

    run: str
    plan: Plan
    marks: list[Mark]
    threads: int | None

    def refuse_changed(self) -> None:
        """Refuse frames that an earlier run made of scenes that are others by now.

        A scene whose file is gone is none that somebody could take them for.
        """
        for planned, mark in zip(self.plan._scenes, self.marks, strict=True):
            if planned.path.exists():
                opened(self.run, planned.path, mark, planned.up)

    def make(self, folder: Path, task: Task) -> dict[str, Any]:
        number = self.plan.scene_of(task.number).scene
        planned, mark = self.plan._scenes[number], self.marks[number]
        scene = opened(self.run, planned.path, mark, planned.up)
        with _of(task.number), timed("made frame %d", task.number):
            return FrameMaker(self.plan, self.threads).make(folder, task.number, scene, mark)
