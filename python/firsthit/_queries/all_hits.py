"""Everything that rays met."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import chosen, chunks, lock
from firsthit._base.progress import later
from firsthit._files.channels import stored

from .hits import Hits
from .rays import NO_MAXIMUM, NO_MINIMUM, Rays
from .source import Source, some_of
from .tables import Tables

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator, Mapping, Sequence

    import numpy.typing as npt

    from firsthit._base.progress import Report
    from firsthit._objects.traceable import Built
    from firsthit.typing import Asked

    from .hits import Index

#: So many hits no memory holds, and NumPy's error for such shapes is another one.
_MOST = 1 << 48


class AllHits(Tables):
    """Every hit of rays, one after the other: the hits of each ray in order, ray by ray.

    A channel has the shape (m,) or (m, k), where m is the number of all hits, and `Hits` have (...)
    and (..., k). The rays' shape is written (...) in what is not a channel. ``all[k]`` is what the
    ray ``k`` met, a `Hits` of shape (n,); of rays of more axes it takes an index for each of them,
    such as ``all[2, 3]``. Any other index, such as a mask or a slice, leads to the `AllHits` of
    some of the rays. Iterating goes along the first axis.

    All arrays are read-only.

    Examples
    --------
    >>> scene = fh.Scene()
    >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
    0
    >>> met = scene.shoot_all([[0, 0, 5], [0, 3, 5], [0, 0, 0]], [0, 0, -1])
    >>> met.t, met.ray
    (array([4., 6., 1.]), array([0, 0, 2]))
    >>> [hits.t.tolist() for hits in met]
    [[4.0, 6.0], [], [1.0]]
    """

    def __init__(self) -> None:
        raise TypeError("AllHits are made by Scene.shoot_all")

    #: The rays without their limits.
    _rays: Rays
    _offsets: npt.NDArray[np.int64]

    @classmethod
    def _of(
        cls,
        built: Built,
        arrays: _firsthit._Hits,
        rays: Rays,
        offsets: npt.NDArray[np.int64],
        threads: int,
    ) -> AllHits:
        """Return the hits in ``arrays`` of rays, those of each between two offsets."""
        made = cls.__new__(cls)
        made._built, made._arrays, made._rays = built, arrays, rays
        made._offsets, made._threads, made._made = offsets, threads, {}
        made._shape = (len(arrays[0]),)
        return made

    @cached_property
    def _source(self) -> Source:  # type: ignore[override]
        return Source(None, None, self._rays.take(self.ray, self._shape))

    @property
    def shape(self) -> tuple[int, ...]:
        """The rays' shape."""
        return self._rays.shape

    @property
    def offsets(self) -> npt.NDArray[np.int64]:
        """The index of each ray's first hit, and last m: (n + 1,) int64 for n rays, row by row."""
        lock(self._offsets)
        return self._offsets

    @property
    def counts(self) -> npt.NDArray[np.int64]:
        """The number of each ray's hits, (...) int64."""
        counts = np.diff(self._offsets).reshape(self.shape)
        lock(counts)
        return counts

    @property
    def ray(self) -> npt.NDArray[np.int64]:
        """The number of each hit's ray, (m,) int64; rays are counted row by row."""
        numbers = np.repeat(np.arange(self._rays.length), np.diff(self._offsets))
        lock(numbers)
        return numbers

    @property
    def hits(self) -> Hits:
        """All hits in a row, a `Hits` of shape (m,), each with its ray: for channels and files."""
        flat = Hits._of(self._built, self._arrays, self._source, self._shape, self._threads)
        flat._made = self._made
        return flat

    @property
    def t(self) -> npt.NDArray[np.float64]:
        """The ray parameters of the hits, (m,) float64, in units of the direction's length."""
        lock(self._arrays[0])
        return self._arrays[0]

    @property
    def origin(self) -> npt.NDArray[Any]:
        """The origins of the rays, in world space, (..., 3), of the type that was given."""
        return self._rays.origins()

    @property
    def direction(self) -> npt.NDArray[Any]:
        """The directions of the rays, in world space, (..., 3), of the type that was given."""
        return self._rays.directions()

    def save(
        self,
        path: str | os.PathLike[str],
        channels: Asked | Sequence[Asked] | None = None,
        *,
        own: Mapping[str, npt.ArrayLike] | None = None,
        compress: bool = False,
    ) -> None:
        """Write all hits to a file, whole or not at all; see `Hits.save`.

        A file that takes several channels has the number of each hit's ray first, as ``ray``.

        Parameters
        ----------
        path : path-like
            As for `Hits.save`.
        channels : str or sequence of str, optional
            As for `Hits.save`.
        own : mapping of str to (m,) or (m, k) array_like, optional
            As for `Hits.save`, for each hit.
        compress : bool
            As for `Frame.save`.

        Raises
        ------
        ValueError, FileWriteError
            As `Hits.save`.
        """
        others = {"ray": self.ray.astype(np.int32), **self._own(path, own)}
        self._save(path, channels, others, stored(compress=compress))

    def to_dict(
        self, channels: Asked | Sequence[Asked] | None = None, *, copy: bool = False
    ) -> dict[str, npt.NDArray[Any]]:
        """Return the hits as a table: its columns by name.

        Parameters
        ----------
        channels : str or sequence of str, optional
            Some of `channels`, or ``"attribute:NAME"`` for an `attribute`; all channels if left
            out.
        copy : bool
            As for `Hits.to_dict`.

        Returns
        -------
        dict of str to (m,) array
            A row for each hit: first ``ray``, then the columns of `Hits.to_dict`.

        Raises
        ------
        ValueError
            As `channel`.
        """
        ray = self.ray.copy() if copy else self.ray
        return {"ray": ray, **super().to_dict(channels, copy=copy)}

    def __getitem__(self, index: Index | str) -> Any:
        """Return the `Hits` of one ray, or the `AllHits` of some of the rays.

        By a name, return the channel or the attribute of all hits, as `Hits` do.
        """
        if isinstance(index, str):
            return self._named(index)
        numbers = chosen(index, self.shape)
        row = np.ascontiguousarray(numbers.reshape(-1))
        starts = self._offsets[row]
        counts = self._offsets[row + 1] - starts
        if numbers.ndim == 0:
            return self._hits_of(row, slice(int(starts[0]), int(starts[0] + counts[0])))
        offsets = _offsets(counts)
        places = np.arange(offsets[-1]) + np.repeat(starts - offsets[:-1], counts)
        arrays = some_of(self._arrays, places)
        rays = self._rays.take(row, numbers.shape)
        return AllHits._of(self._built, arrays, rays, offsets, self._threads)

    def _hits_of(self, ray: npt.NDArray[np.int64], part: slice) -> Hits:
        """Return the hits of a single ray."""
        arrays = some_of(self._arrays, part)
        shape = (len(arrays[0]),)
        source = Source(None, None, Rays(self._rays.take(ray, ()).arrays, shape))
        return Hits._of(self._built, arrays, source, shape, self._threads)

    def __len__(self) -> int:
        """Return the number of rays along the first axis."""
        if not self.shape:
            raise TypeError("the hits of one ray have no length; their number is counts")
        return self.shape[0]

    def __iter__(self) -> Iterator[Any]:
        """Yield what each ray met, along the first axis."""
        return (self[k] for k in range(len(self)))

    def __repr__(self) -> str:
        return f"AllHits(shape={self.shape}, {len(self._arrays[0]):,} hits)"

    def __getstate__(self) -> dict[str, Any]:
        """Pickle with the scene as it was shot, and without what can be computed again."""
        kept = {**self.__dict__, "_made": {}}
        kept.pop("_source", None)
        return kept


def _offsets(counts: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """Return where each of several lists begins that lie one after the other, and their end."""
    offsets = np.zeros(len(counts) + 1, np.int64)
    np.cumsum(counts, out=offsets[1:])
    return offsets


def shoot_all(built: Built, rays: Rays, threads: int, report: Report | None) -> AllHits:
    """Find every hit of rays; the rays' arrays are copied."""
    rays = rays.copied()
    pieces: list[_firsthit._Hits] = []
    counts = np.zeros(rays.length, np.int64)
    for part in chunks(rays.length):
        met = _shot(built.native, rays, part, None, threads, report)
        counts[part] = np.diff(met[0])
        pieces.append(met[1])
    return AllHits._of(built, _joined(pieces), rays.unlimited(), _offsets(counts), threads)


def shoot_nearest(built: Built, rays: Rays, k: int, threads: int, report: Report | None) -> Hits:
    """Find the first ``k`` hits of each ray; the rays' arrays are copied."""
    rays = rays.copied()
    length = rays.length
    if length * k >= _MOST:
        raise MemoryError(f"{length} times {k} hits do not fit into memory")
    t, identifiers = np.full((length, k), np.inf), np.full((length, k), -1, np.int32)
    primitive, weights = identifiers.copy(), np.full((length, k, 2), np.nan)
    for part in chunks(length):
        offsets, met = _shot(built.native, rays, part, k, threads, report)
        counts = np.diff(offsets)
        row = np.repeat(np.arange(part.start, part.stop), counts)
        column = np.arange(offsets[-1]) - np.repeat(offsets[:-1], counts)
        for all_of_it, found in zip((t, identifiers, primitive, weights), met, strict=True):
            all_of_it[row, column] = found
    arrays = t.reshape(-1), identifiers.reshape(-1), primitive.reshape(-1), weights.reshape(-1, 2)
    # An axis more, along which rays are repeated.
    ends = [array[..., None, :] if array.ndim > 1 else array for array in rays.arrays[:2]]
    shape = (*rays.shape, k)
    source = Source(None, None, Rays((*ends, NO_MINIMUM, NO_MAXIMUM), shape))
    return Hits._of(built, arrays, source, shape, threads)


def _shot(
    native: _firsthit.Scene,
    rays: Rays,
    part: slice,
    k: int | None,
    threads: int,
    report: Report | None,
) -> tuple[npt.NDArray[np.int64], _firsthit._Hits]:
    """Return the offsets and the hits of some of the rays."""
    told, count = later(report, part.start), part.stop - part.start
    some = rays.part(part)
    offsets, t, identifiers, primitive, weights = _firsthit.shoot_all(
        native, some, count, k, threads, told
    )
    return offsets.astype(np.int64), (t, identifiers, primitive, weights.reshape(-1, 2))


def _joined(pieces: list[_firsthit._Hits]) -> _firsthit._Hits:
    """Return one set of arrays in place of several; each array's pieces go once it is made."""
    if len(pieces) == 1:
        return pieces[0]
    if not pieces:
        empty = np.empty(0, np.int32)
        return np.empty(0), empty, empty.copy(), np.empty((0, 2))
    columns: list[list[npt.NDArray[Any]]] = [list(column) for column in zip(*pieces, strict=True)]
    pieces.clear()
    made = []
    for column in columns:
        made.append(np.concatenate(column))
        column.clear()
    t, identifiers, primitive, weights = made
    return t, identifiers, primitive, weights
