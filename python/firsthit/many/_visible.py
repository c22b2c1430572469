"""Visibility among many points: a matrix of bits, by blocks."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from firsthit._base.arrays import count, number, vectors
from firsthit._base.errors import FileFormatError, FileReadError, FileWriteError, blaming
from firsthit._files.whole import write
from firsthit._parts.digest import of_arrays
from firsthit._parts.drive import RunSettings, is_here
from firsthit._parts.files import link
from firsthit._parts.records import open_inside, read

from ._jobs import Job, listed, settled, shared
from ._shared_arrays import SharedArrays

if TYPE_CHECKING:
    import os

    import numpy.typing as npt

    from firsthit._parts.engine import On, Task
    from firsthit._parts.scene_store import SharedScene
    from firsthit._scene.scene import Scene
    from firsthit.typing import Progress, Selection

    from ._jobs import JobResult

#: The matrix in the folder of a job, once all blocks are there.
MATRIX = "visible.zarr"

#: The file of a block in its part.
BLOCK = "block.bin"


def visible_many(
    scene: Scene | str | os.PathLike[str],
    a: npt.ArrayLike,
    b: npt.ArrayLike,
    out: str | os.PathLike[str],
    *,
    block: tuple[int, int] = (4096, 32768),
    tolerance: float = 0.0,
    objects: Selection | None = None,
    blend_below: float | None = None,
    on: On = None,
    part: tuple[int, int] | None = None,
    threads: int | None = None,
    verify: bool = False,
    progress: Progress | None = None,
) -> JobResult:
    """Tell which points see which, as a matrix of bits, on one machine or on many.

    A part is a block of the matrix. When all are there, ``out/visible.zarr`` is the matrix, in the
    format Zarr v3: an array of bytes of the shape (n, ceil(m / 8)) whose chunks are the blocks. In
    row i, bit j of a row's bytes, the lowest of a byte first, is whether ``a[i]`` sees ``b[j]``.

    Parameters
    ----------
    scene : Scene or path-like
        As for `render_many`.
    a, b : (n, 3) and (m, 3) array_like
        The points, in world space.
    out : path-like
        The folder; it is made. A folder of another job is refused.
    block : pair of int
        The rows and columns of a block; the columns are a multiple of eight. A block should take a
        second or more.
    tolerance, objects, blend_below
        As for `Scene.visible`.
    on, part, threads, verify, progress
        As for `render_many`.

    Returns
    -------
    JobResult
        How many blocks were made and kept, and the digest.

    Raises
    ------
    ValueError, TypeError, IndexError
        As `Scene.visible`; also for a block that is none.
    FileWriteError
        If the system refuses to write, and if the folder is another job's.
    RuntimeError
        As `render_many`.

    Examples
    --------
    >>> scene = fh.Scene()
    >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
    0
    >>> ring = [(5, 0, 0), (0, 5, 0), (-5, 0, 0), (0, -5, 0)]
    >>> fh.visible_many(scene, ring, ring, "seen").parts
    1
    >>> fh.many.bits("seen")
    array([[ True,  True, False,  True],
           [ True,  True,  True, False],
           [False,  True,  True,  True],
           [ True, False,  True,  True]])
    """
    how = RunSettings.of(on, part, threads, verify, progress)
    ends = {name: vectors(name, given) for name, given in (("a", a), ("b", b))}
    for name, array in ends.items():
        if array.ndim != 2 or len(array) == 0:
            raise ValueError(f"{name} must be one point or more, (n, 3), got {array.shape}")
    if not isinstance(block, tuple | list) or len(block) != 2:
        raise ValueError(f"block must be two whole numbers, got {block!r}")
    rows, columns = count("block", block[0], 1), count("block", block[1], 8)
    if columns % 8:
        raise ValueError(f"block must have a multiple of 8 columns, got {columns}")
    share, objects = shared(scene), settled(objects)
    near = number("tolerance", tolerance)
    looking: dict[str, Any] = {"tolerance": near, "objects": objects, "blend_below": blend_below}
    points = SharedArrays(
        {name: np.ascontiguousarray(array, np.float64) for name, array in ends.items()}
    )
    shape = len(ends["a"]), len(ends["b"])
    across = math.ceil(shape[1] / columns)
    said = {
        "kind": "visible",
        "shape": list(shape),
        "block": [rows, columns],
        "points": points.digest(),
        "objects": listed(objects),
        # Jobs from before these were there keep their folders.
        **({} if near == 0 else {"tolerance": near}),
        **({} if blend_below is None else {"blend_below": float(blend_below)}),
    }
    share.get().visible(ends["a"][:1], ends["b"][:1], **looking)
    job = Job(out, share, said, math.ceil(shape[0] / rows) * across)
    job.claim()
    if not is_here(on):
        points.share(job.out)
    maker = _Blocks(job.scene, job.digest, points, (rows, columns), across, looking, how.threads)
    made = job.made(job.do(maker, how, "blocks"))
    if made.digest is not None:
        _join(job, shape, (rows, columns), across)
    return made


class _Blocks(NamedTuple):
    """Makes the blocks of a matrix."""

    scene: SharedScene
    job: str
    points: SharedArrays
    block: tuple[int, int]
    across: int
    looking: dict[str, Any]
    threads: int | None

    def make(self, folder: Path, task: Task) -> dict[str, Any]:
        (rows, columns), (down, right) = self.block, divmod(task.number, self.across)
        a = self.points["a"][down * rows : (down + 1) * rows]
        b = self.points["b"][right * columns : (right + 1) * columns]
        seen = self.scene.get().visible(a[:, None], b, **self.looking, threads=self.threads)
        # A chunk has its full size at the matrix's ends too.
        bits = np.zeros((rows, columns // 8), np.uint8)
        packed = np.packbits(seen, axis=1, bitorder="little")
        bits[: packed.shape[0], : packed.shape[1]] = packed
        (folder / BLOCK).write_bytes(bits.tobytes())
        return {
            "job": self.job,
            "part": task.number,
            "block": [down, right],
            "digest": of_arrays({"bits": packed}),
        }


def bits(folder: str | os.PathLike[str], *, rows: slice = slice(None)) -> npt.NDArray[np.bool_]:
    """Return rows of the matrix of `visible_many`.

    Parameters
    ----------
    folder : path-like
        The folder of the job, all of whose blocks are there.
    rows : slice
        Which rows; all if left out.

    Returns
    -------
    (n, m) array of bool
        Whether each of these points sees each of the others.

    Raises
    ------
    FileReadError, FileFormatError
        If the matrix is not there, or is not whole.
    ValueError
        For rows with steps.
    """
    into = Path(folder) / MATRIX
    try:
        said = read(into / "zarr.json")
        count, columns = said["shape"][0], said["attributes"]["columns"]
        deep, wide = said["chunk_grid"]["configuration"]["chunk_shape"]
        across = math.ceil(columns / (8 * wide))
        if min(deep, wide, count, columns) < 1:
            raise ValueError(f"it has {count} x {columns} bits in blocks of {deep} x {wide} bytes")
    except OSError as error:
        why = f"{error.strerror or error}; are all blocks there?"
        raise FileReadError._of(into, why) from None
    except (ValueError, KeyError, TypeError, IndexError, ArithmeticError) as error:
        raise FileFormatError._of(into, f"no matrix of firsthit: {error}") from None
    first, last, step = rows.indices(count)
    if step != 1:
        raise ValueError(f"rows must be a slice without steps, got {rows!r}")
    made = np.empty((max(last - first, 0), columns), np.bool_)
    for down in range(first // deep, math.ceil(max(last, first) / deep)):
        top = down * deep
        begin, end = max(first, top), min(last, top + deep)
        for right in range(across):
            path = into / "c" / str(down) / str(right)
            try:
                with blaming(path, FileReadError), open_inside(into, f"c/{down}/{right}") as file:
                    chunk = np.frombuffer(file.read(deep * wide + 1), np.uint8)
            except ValueError as error:
                raise FileFormatError._of(into, f"{error}") from None
            if chunk.size != deep * wide:
                raise FileFormatError._of(path, f"it has {chunk.size} bytes")
            seen = np.unpackbits(chunk.reshape(deep, wide), axis=1, bitorder="little")
            left = right * 8 * wide
            width = min(8 * wide, columns - left)
            made[begin - first : end - first, left : left + width] = seen[
                begin - top : end - top, :width
            ]
    return made


def _join(job: Job, shape: tuple[int, int], block: tuple[int, int], across: int) -> None:
    """Give the blocks their names in the matrix, and write what it is."""
    into = job.out / MATRIX
    if into.is_symlink():
        raise FileWriteError._of(into, "a link, not a folder of the job")
    for part in range(job.count):
        if BLOCK not in job.parts.whole_record(part)["files"]:
            raise FileFormatError._of(job.parts.path(part), f"its record has no {BLOCK}")
        down, right = divmod(part, across)
        link(job.parts.path(part) / BLOCK, into / "c" / str(down) / str(right))
    said = {
        "zarr_format": 3,
        "node_type": "array",
        "shape": [shape[0], math.ceil(shape[1] / 8)],
        "data_type": "uint8",
        "chunk_grid": {
            "name": "regular",
            "configuration": {"chunk_shape": [block[0], block[1] // 8]},
        },
        "chunk_key_encoding": {"name": "default", "configuration": {"separator": "/"}},
        "fill_value": 0,
        "codecs": [{"name": "bytes"}],
        "attributes": {"columns": shape[1], "bitorder": "little"},
    }
    write(into / "zarr.json", json.dumps(said, indent=2).encode() + b"\n")
