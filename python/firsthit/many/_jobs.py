"""Shared steps of all kinds of jobs: claim a folder, share the scene, make what is missing."""

from __future__ import annotations

import copy
import os
import uuid
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from firsthit import _firsthit
from firsthit._base.errors import FileWriteError
from firsthit._parts.digest import of_json
from firsthit._parts.drive import Work, drive, is_here, make
from firsthit._parts.engine import Task
from firsthit._parts.folder import Parts
from firsthit._parts.job import (
    JOB,
    begin_job,
    checked_part,
    job_in,
    refuse_other,
    write_job,
)
from firsthit._parts.part import PARTS, remove_leftovers
from firsthit._parts.scene_store import BUILT, SharedScene, forget, mark_of, read
from firsthit._scene.scene import Scene

if TYPE_CHECKING:
    from collections.abc import Callable

    from firsthit._looks.environment import Environment
    from firsthit._parts.drive import Maker, RunSettings
    from firsthit.typing import Selection

    from ._rays import Batch


class JobResult(NamedTuple):
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
        The result of a ``fold``; ``None`` while parts are missing, and without one.
    """

    parts: int
    made: int
    kept: int
    missing: int
    digest: str | None
    result: Any = None


#: Counts up when the same job makes other bytes.
ANSWER = 1

#: So many parts may come one after the other, whose number nobody knows before.
MOST_IN_A_STREAM = 10**9

#: The scene that workers open, where no file was given that they can.
_SCENE = f"scene{BUILT}"


def shared(scene: Scene | str | os.PathLike[str]) -> SharedScene:
    """Return a scene for workers, of a scene or its file."""
    run = uuid.uuid4().hex
    if isinstance(scene, Scene):
        # Changes during the run are not in the job.
        kept = copy.copy(scene)
        return SharedScene(run, None, mark_of(kept), kept)
    path = Path(scene).absolute()
    opened = read(path)
    return SharedScene(run, path, mark_of(opened), opened)


def lit(share: SharedScene, environment: Environment) -> SharedScene:
    """Return a scene for workers in an environment, as `render` takes one."""
    kept = copy.copy(share.get())
    kept.environment, kept.shading = environment, kept.shading._without_light()
    sun = environment._sun(kept.up)
    if sun is not None:
        kept.add_light(sun)
    return SharedScene(share.run, None, mark_of(kept), kept)


def settled(objects: Selection | None) -> Selection | None:
    """Return a selection that can be read more than once."""
    return list(objects) if isinstance(objects, Iterator) else objects


def _as_read(said: Any) -> Any:
    """Return what a job says as its file gives it back: lists, and Python's own numbers."""
    if isinstance(said, dict):
        return {name: _as_read(value) for name, value in said.items()}
    if isinstance(said, tuple | list):
        return [_as_read(value) for value in said]
    if isinstance(said, np.generic | np.ndarray):
        return said.tolist()
    return said


def listed(objects: Selection | None) -> Any:
    """Return a selection as the file of a job has it."""
    if objects is None or isinstance(objects, str):
        return objects
    if isinstance(objects, int | np.integer):
        return int(objects)
    return [one if isinstance(one, str) else int(one) for one in cast("list[Any]", objects)]


class Job:
    """A job in a folder; ``said`` is what it is of, beside the scene, as JSON."""

    def __init__(
        self, out: str | os.PathLike[str], scene: SharedScene, said: dict[str, Any], count: int
    ) -> None:
        if not os.fspath(out):
            raise ValueError("out must be the name of a folder, got an empty one")
        self.out, self.scene, self.count = Path(out).absolute(), scene, count
        about = {
            "answer": ANSWER,
            "firsthit": _firsthit.version(),
            **_as_read(said),
            "scene": scene.mark._asdict(),
        }
        self.digest = of_json(about)
        self._said = {**about, "job": self.digest, "parts": count}
        self.parts = Parts(self.out, PARTS, self.digest, count)
        #: The content of the job's file, once the folder is claimed.
        self._known: dict[str, Any] = {}

    def claim(self) -> None:
        """Make the folder that of this job, or find that it is.

        Raises
        ------
        FileWriteError
            If the folder is another job's, or cannot be written to.
        """
        path = self.out / JOB
        known = job_in(self.out, PARTS.folder) or begin_job(path, self._said)
        not_given = dict.fromkeys(name for name in known if name not in self._said)
        wanted = {**self._compared(), **not_given}
        # The contents of the digest tell more.
        wanted["job"] = wanted.pop("job")
        refuse_other(path, known, wanted)
        remove_leftovers(self.out)
        self._known = known

    def _compared(self) -> dict[str, Any]:
        """Return what the folder's job must say to be this one."""
        return self._said

    def do(
        self,
        maker: Maker,
        how: RunSettings,
        unit: str,
        given: Callable[[int], Any] | None = None,
    ) -> tuple[int, int]:
        """Make what is missing; return how many parts were made, and how many kept."""
        if not is_here(how.on):
            self.scene.save(self.out / _SCENE)
        try:
            return drive(self.parts, maker, how, unit, given)
        finally:
            forget(self.scene.run)

    def made(self, counts: tuple[int, int], result: Any = None) -> JobResult:
        """Return what a run came to."""
        missing, digest = self.parts.state()
        return JobResult(self.count, *counts, missing, digest, result)


class Stream(Job):
    """A job whose parts come one after the other, in a number unknown beforehand.

    Only when all have come does ``job.json`` say how many.
    """

    def __init__(
        self, out: str | os.PathLike[str], scene: SharedScene, said: dict[str, Any]
    ) -> None:
        super().__init__(out, scene, said, MOST_IN_A_STREAM)
        self._said["parts"] = None

    def _compared(self) -> dict[str, Any]:
        return {name: value for name, value in self._said.items() if name != "parts"}

    def do_all(self, maker: Maker, how: RunSettings, batches: Iterator[Batch]) -> tuple[int, int]:
        """Make the parts that are missing, one of each batch of rays."""
        if not is_here(how.on):
            self.scene.save(self.out / _SCENE)
        self.parts.open()
        k, n = checked_part(how.part)
        kept = total = 0

        def tasks() -> Iterator[Task]:
            nonlocal kept, total
            for number, batch in enumerate(batches):
                if number >= MOST_IN_A_STREAM:
                    raise ValueError(f"rays must come in fewer than {MOST_IN_A_STREAM} batches")
                total = number + 1
                if number % n != k - 1:
                    continue
                digest, record = batch.digest(), self.parts.record(number, verify=how.verify)
                if record is None:
                    yield Task(number, (batch, digest))
                elif record.get("rays_digest") == digest:
                    kept += 1
                else:
                    why = "it has other rays than those that came now; take another folder"
                    raise FileWriteError._of(self.parts.path(number), why)

        work = Work(maker, self.parts)
        try:
            made = make(work, tasks(), how.on, how.progress, (None, 0, "parts"))
        finally:
            forget(self.scene.run)
        self._end(total)
        return made, kept

    def _end(self, total: int) -> None:
        """Say how many parts there are, or find that it was said before."""
        path, before = self.out / JOB, self._known["parts"]
        if before is None:
            write_job(path, {**self._said, "parts": total})
        elif before != total:
            why = f"rays came in {total} batches, and in {before} before; take another folder"
            raise FileWriteError._of(path, why)
        self.count = total

    def made(self, counts: tuple[int, int], result: Any = None) -> JobResult:
        missing, digest = self.parts.first(self.count).state()
        return JobResult(self.count, *counts, missing, digest, result)
