"""First hits of many rays."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from firsthit._base.arrays import count, one_of
from firsthit._base.errors import FileFormatError
from firsthit._base.optional import optional
from firsthit._files.channels import distinct
from firsthit._files.whole import write
from firsthit._parts.digest import of_arrays
from firsthit._parts.drive import RunSettings, is_here
from firsthit._parts.records import open_inside
from firsthit._queries.channels import OF_RAYS

from ._fold import Bits, Fold, Histogram, Minimum, Sum, checked
from ._hit_files import EXTENSIONS, write_hits
from ._jobs import Job, Stream, listed, settled, shared
from ._names import identity
from ._rays import Batch, source_of

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    import numpy.typing as npt

    from firsthit._parts.engine import On, Task
    from firsthit._parts.scene_store import SharedScene
    from firsthit._scene.scene import Scene
    from firsthit._sensors.sensor import Sensor
    from firsthit.typing import Asked, Progress, Selection, Side

    from ._fold import Arrays
    from ._jobs import JobResult
    from ._rays import RaySource

    Rays = (
        tuple[npt.ArrayLike, npt.ArrayLike]
        | Mapping[str, npt.ArrayLike]
        | Sensor
        | Sequence[Sensor]
        | str
        | os.PathLike[str]
        | Sequence[str]
        | Sequence[os.PathLike[str]]
    )

#: The file of a fold's result over all parts.
RESULT = "fold.npz"


def shoot_many(
    scene: Scene | str | os.PathLike[str],
    rays: Rays | Iterator[Any],
    out: str | os.PathLike[str],
    *,
    channels: Asked | Sequence[Asked] = ("t", "object", "primitive"),
    save: str = ".npz",
    fold: Fold | None = None,
    part_size: int = 1_000_000,
    cull: Side | None = None,
    objects: Selection | None = None,
    blend_below: float | None = None,
    on: On = None,
    part: tuple[int, int] | None = None,
    threads: int | None = None,
    verify: bool = False,
    progress: Progress | None = None,
) -> JobResult:
    """Find the first hits of many rays, on one machine or on many, and resume after any kill.

    A part is a range of rays. Each has a folder in ``out/parts`` with its hits, which is there when
    it is whole; a run makes those that are missing. The bytes are those of `Scene.shoot`, whoever
    makes them.

    Parameters
    ----------
    scene : Scene or path-like
        As for `render_many`.
    rays : tuple, mapping, sensors, paths, or iterator
        ``(origins, directions)``, arrays as `Scene.shoot` takes them; or arrays by the names
        ``origins``, ``directions``, ``t_min`` and ``t_max``. A sensor or a list of them: the rays
        of all pixels. Files, by a path, a pattern with ``*``, or a list of paths: ``.npz`` with
        arrays of these names, ``.npy`` of the shape (n, 6), ``.parquet`` with the columns ``ox``,
        ``oy``, ``oz``, ``dx``, ``dy``, ``dz`` and ``t_min``, ``t_max`` where the rays have them; no
        part has rays of two files. Or an iterator of batches, each a part of its own, as a
        generator is: it must yield the same rays in every run.
    out : path-like
        The folder; it is made. A folder of another job is refused.
    channels : str or sequence of str
        Channels of `Hits`. With a ``fold`` they are not asked for.
    save : {".npz", ".parquet"}
        The file of each part's hits: ``hits.npz`` has an array for each channel, ``hits.parquet``
        a column for each number, and takes the package ``pyarrow``.
    fold : callable with a method ``merge``, optional
        The fold to keep instead of the hits: `many.Sum`, `Minimum`, `Histogram`, `Bits`, or a class
        of your own, see `many.Fold`. The result, over all rays, is in ``out/fold.npz`` and
        returned.
    part_size : int
        How many rays are a part. A part should take a second or more.
    cull, objects, blend_below
        As for `Scene.shoot`.
    on, part, threads, verify, progress
        As for `render_many`.

    Returns
    -------
    JobResult
        How many parts were made and kept, the digest, and the result of a fold.

    Raises
    ------
    ValueError, TypeError, IndexError
        As `Scene.shoot`; also for an extension that is none.
    FileReadError, FileFormatError
        If a file of rays or the scene's file cannot be read, or is not what it was.
    FileWriteError
        If the system refuses to write, and if the folder is another job's.
    ImportError
        For ``.parquet`` without the package pyarrow.
    RuntimeError
        As `render_many`.

    Examples
    --------
    >>> scene = fh.Scene()
    >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
    0
    >>> origins = np.stack([np.linspace(-2, 2, 1000), np.zeros(1000), np.full(1000, 5.0)], axis=-1)
    >>> rays = origins, (0, 0, -1)
    >>> made = fh.shoot_many(scene, rays, "sums", fold=fh.many.Sum(), part_size=400)
    >>> made.parts, int(made.result["count"])
    (3, 500)
    """
    how = RunSettings.of(on, part, threads, verify, progress)
    size = count("part_size", part_size, 1)
    one_of("save", save, EXTENSIONS)
    if fold is not None and not isinstance(fold, Fold):
        raise TypeError(f"fold must be callable and have a method merge, got {fold!r}")
    if fold is None and save == ".parquet":
        # Before anything is shot.
        optional("pyarrow.parquet", "a .parquet")
    wanted = [] if fold is not None else distinct(channels, OF_RAYS)
    share, objects = shared(scene), settled(objects)
    met = {"cull": cull, "objects": objects, "blend_below": blend_below}
    _try(share, wanted, fold, met)
    common = {
        "kind": "shoot",
        "channels": wanted,
        "save": None if fold is not None else save,
        "fold": None if fold is None else identity("fold", fold),
        "cull": cull,
        "objects": listed(objects),
        **({} if blend_below is None else {"blend_below": float(blend_below)}),
    }
    maker = _Shots(share, wanted, save, fold, met, how.threads)
    job: Job
    if isinstance(rays, Iterator):
        stream = Stream(out, share, {**common, "rays": {"kind": "stream"}})
        stream.claim()
        batches = map(Batch.of, rays)
        job, counts = stream, stream.do_all(maker.of(stream.digest, None), how, batches)
    else:
        source = source_of(rays, size)
        said = {**common, "rays": source.said(), "part_size": size}
        job = Job(out, share, said, source.parts)
        job.claim()
        if not is_here(on):
            source.share(job.out)
        counts = job.do(maker.of(job.digest, source), how, "parts", source.given)
    made = job.made(counts)
    if fold is None or made.digest is None:
        return made
    return made._replace(result=_folded(job, fold))


def _try(
    scene: SharedScene, channels: list[Any], fold: Fold | None, filters: dict[str, Any]
) -> None:
    """Refuse what no hits have, before a folder is made: no ray is shot.

    A fold of one's own need not expect to get no hits.
    """
    hits = scene.get().shoot(np.empty((0, 3)), np.empty((0, 3)), **filters)
    for name in channels:
        hits.channel(name)
    if isinstance(fold, Sum | Minimum | Histogram | Bits):
        fold(hits)


class _Shots(NamedTuple):
    """Makes the hits of a part."""

    scene: SharedScene
    channels: list[Any]
    save: str
    fold: Fold | None
    filters: dict[str, Any]
    threads: int | None
    job: str = ""
    source: RaySource | None = None

    def of(self, job: str, source: RaySource | None) -> _Shots:
        """Return the same for a job; without a source, tasks come with their rays."""
        return self._replace(job=job, source=source)

    def _batch(self, task: Task) -> tuple[Batch, str | None]:
        """Return the rays of a part, and their digest unless the job says which rays they are."""
        if self.source is None:
            batch, digest = task.given
            return batch, digest
        return self.source.batch(task.number, task.given), None

    def make(self, folder: Path, task: Task) -> dict[str, Any]:
        batch, digest = self._batch(task)
        hits = self.scene.get().shoot(
            batch.origins,
            batch.directions,
            t_min=batch.t_min,
            t_max=batch.t_max,
            threads=self.threads,
            **self.filters,
        )
        if self.fold is not None:
            arrays = checked(self.fold(hits))
            write_hits(folder / RESULT, arrays, {})
        else:
            arrays = {name: hits.channel(name) for name in self.channels}
            table = hits.to_dict(self.channels) if self.save == ".parquet" else {}
            write_hits(folder / f"hits{self.save}", arrays, table)
        return {
            "job": self.job,
            "part": task.number,
            "rays": len(batch.origins),
            **({} if digest is None else {"rays_digest": digest}),
            "digest": of_arrays(arrays),
        }


def _arrays_in(folder: Path, record: dict[str, Any]) -> Arrays:
    path = folder / RESULT
    try:
        if RESULT not in record["files"]:
            raise ValueError(f"its record has no {RESULT}")
        with (
            open_inside(folder, RESULT) as content,
            np.load(content, allow_pickle=False) as file,
        ):
            return {name: file[name] for name in file.files}
    except (OSError, ValueError, EOFError, KeyError, zipfile.BadZipFile) as error:
        why = f"damaged: {error}; with verify=True it is made again"
        raise FileFormatError._of(path, why) from None


def _folded(job: Job, fold: Fold) -> Arrays | None:
    """Return what a fold came to over all parts, and write it."""
    total: Arrays | None = None
    for number in range(job.count):
        one = _arrays_in(job.parts.path(number), job.parts.whole_record(number))
        total = one if total is None else checked(fold.merge(total, one))
    if total is not None:
        out = io.BytesIO()
        np.savez(out, **total)  # type: ignore[arg-type]
        write(job.out / RESULT, out.getvalue())
    return total
