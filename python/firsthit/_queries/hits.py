"""The first hits of rays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit._base.arrays import chosen
from firsthit._base.hints import channel_hint
from firsthit._base.rounding import singles_within
from firsthit._files.channels import stored
from firsthit._files.plot import Plottable

from .leaving import leaving
from .source import some_of
from .tables import Tables

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator, Mapping, Sequence
    from types import EllipsisType

    import numpy.typing as npt

    from firsthit import _firsthit
    from firsthit._objects.traceable import Built
    from firsthit.typing import (
        Asked,
        Far,
    )

    from .leaving import LeavingRays
    from .source import Source

    # No ArrayLike, which text is too.
    Index = (
        npt.NDArray[Any]
        | np.integer[Any]
        | np.bool_
        | int
        | list[Any]
        | slice
        | EllipsisType
        | None
        | tuple[Any, ...]
    )


class Hits(Tables, Plottable):
    """The first hits of rays, as arrays of the rays' shape, which is written (...) below.

    ``t, o = hits`` unpacks distances and objects. ``hits[mask]`` and ``len(hits)`` work as for an
    array of the rays' shape. ``hits["normal"]`` is a channel, and ``hits["quality"]`` an attribute
    of the meshes that were hit. ``hits.to_dict()`` is a table.

    A miss has ``t``, ``range`` and ``z`` of infinity; identifiers of -1; a false ``front``; and NaN
    elsewhere. ``t``, ``object`` and ``primitive`` are there at once; the
    others are computed when they are first read, from the rays and the scene as they were shot.

    All arrays are read-only, because hits compute from them and return the same memory at every
    read. A copy, such as ``hits.t.copy()``, can be written, and `channel` fills an array of yours.
    Of one ray, of the shape (), a channel is a number of NumPy's, or a vector.
    """

    def __init__(self) -> None:
        raise TypeError("Hits are made by Scene.shoot")

    @classmethod
    def _of(
        cls,
        built: Built,
        arrays: _firsthit._Hits,
        source: Source,
        shape: tuple[int, ...],
        threads: int,
    ) -> Hits:
        """Return hits of rays with that source and shape; ``built`` is what was shot at."""
        hits = cls.__new__(cls)
        hits._built, hits._arrays, hits._source = built, arrays, source
        hits._shape, hits._threads, hits._made = shape, threads, {}
        return hits

    def _rounded(self, t_min: npt.NDArray[Any], t_max: npt.NDArray[Any]) -> Hits:
        """Return these hits with distances of float32; the limits are the rays'."""
        t = self._arrays[0].reshape(self._shape)
        self._single = singles_within(t, t_min, t_max).reshape(-1)
        return self

    def __array__(self, dtype: Any = None, copy: Any = None) -> npt.NDArray[Any]:
        """Refuse: hits are several arrays, and one would be taken for points or numbers."""
        raise TypeError("hits are no array: say which is meant, hits.position or hits.t")

    @property
    def shape(self) -> tuple[int, ...]:
        """The rays' shape; (rows, columns) for a camera."""
        return self._shape

    @property
    def range(self) -> npt.NDArray[np.floating[Any]]:
        """The distance from the camera's position along the ray, (...) float64, in scene units.

        Of a sensor that moves, from where it is at the time of the ray. It is float32 if `t` is. An
        ``AttributeError`` for rays that no camera or other sensor made.
        """
        return self.channel("range")

    @property
    def z(self) -> npt.NDArray[np.floating[Any]]:
        """The distance from the camera's position along its aim, (...) float64, in scene units.

        It is negative behind the camera, which only a panorama sees. It is float32 if `t` is. An
        ``AttributeError`` for rays that no camera made, and for a sensor without an aim.
        """
        return self.channel("z")

    def leave(self, directions: npt.ArrayLike) -> LeavingRays:
        """Return rays that start at these hits, and do not meet what they leave.

        On a triangle a ray starts at the point that `barycentric` gives, exactly, not at a rounded
        one. It meets what is ahead of that point: not its own triangle, nor those around that only
        touch it at the start, but everything else, however near. There is no epsilon. Of another
        shape it does not meet the surface where it starts, but the far side if it goes inwards.

        At an edge or a vertex of an open mesh a ray may leave its triangle and go into another one
        around that point, as from the bottom of a valley into a slope. It is stopped there, at a
        ``t`` next to 0. One that goes against all of these triangles goes through, as in a face.

        Between objects of different transforms, and from shapes that are no mesh, positions round:
        what is nearer than 2^-40 of the largest coordinate is not met.

        Parameters
        ----------
        directions : (..., 3) array_like
            Directions in world space, of any length but zero; they broadcast against the hits.

        Returns
        -------
        LeavingRays
            For `Scene.shoot`, `Scene.occluded`, `Scene.count`, `Scene.shoot_all` and
            `Scene.explain`, in place of origins and directions. The ray of a miss meets nothing.

        Raises
        ------
        ValueError
            For directions of a wrong shape or type.

        Examples
        --------
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> hits = scene.shoot([[0.1, 0.2, 5], [0.3, 0, 5]], [0, 0, -1])
        >>> scene.occluded(hits.leave(hits.normal))
        array([False, False])
        >>> scene.shoot(hits.leave(-hits.normal)).t
        array([2., 2.])
        """
        _, identifiers, primitive, weights = self._arrays
        along = (self.direction * self.normal).sum(-1)
        places = (
            identifiers.reshape(self._shape),
            primitive.reshape(self._shape),
            weights.reshape(*self._shape, 2),
            np.where(along < 0, 1, -1).astype(np.int8),
        )
        return leaving(self.position, places, directions)

    @property
    def origin(self) -> npt.NDArray[Any]:
        """The origins of the rays, in world space, (..., 3), of the type that was given."""
        return self._read_only(self._source.both()[0], 3)

    @property
    def direction(self) -> npt.NDArray[Any]:
        """The directions of the rays, in world space, (..., 3), of the type that was given."""
        return self._read_only(self._source.both()[1], 3)

    def save(
        self,
        path: str | os.PathLike[str],
        channels: Asked | Sequence[Asked] | None = None,
        *,
        own: Mapping[str, npt.ArrayLike] | None = None,
        png_scale: float | None = None,
        far: Far | None = None,
        png_labels: bool = False,
        compress: bool = False,
    ) -> None:
        """Write the hits to a file, whole or not at all.

        Parameters
        ----------
        path : path-like
            ``.ply`` and ``.pcd`` are point clouds of what was hit: misses are left out, and
            ``position`` is always among the channels. The numbers of a PLY are exact, those of a
            PCD float32, as `Frame.save` has them. ``.npz`` takes all rays and several channels,
            ``.npy`` one channel; hits of the shape of a picture can be ``.exr`` and ``.png`` too,
            as `Frame.save` writes them. With ``{channel}`` in the name each channel has a file of
            its own. The metadata name the camera where the hits are those of all its pixels, or a
            point cloud.
        channels : str or sequence of str, optional
            Some of `channels`, or ``"attribute:NAME"`` for an `attribute`; a name counts once. If
            left out, ``t``, ``object`` and ``primitive``, for a point cloud ``position`` and
            ``normal`` too, and for a file that takes one channel ``t`` alone.
        own : mapping of str to (...) or (..., k) array_like, optional
            Numbers of one's own for each ray, under names that are no channels, for a file that
            takes several. See `Frame` for their types and names.
        png_scale, far, png_labels, compress
            As for `Frame.save`.

        Raises
        ------
        ValueError
            For an unknown extension, no channel, one that is none of `channels`, several for a file
            that takes one, two whose names in the file are the same, ``{channel}`` in the name of a
            point cloud, numbers that the format cannot hold, and ``own`` of another shape, with the
            name of a channel, or for a file that takes one.
        FileWriteError
            The system refused; an old file is as it was.

        Examples
        --------
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> hits = scene.shoot([[0, 0, 5], [0, 3, 5]], [0, 0, -1])
        >>> hits.save("cloud.ply", ["position", "normal", "object"], own={"quality": [0.5, 1]})
        """
        how = stored(png_scale, far, png_labels, compress)
        self._save(path, channels, self._own(path, own), how)

    # Names are not in the annotation: NumPy's types make Any of ``hits.object == 0``, for which a
    # checker would no longer know what comes out. `attribute` and `channel` have types.
    def __getitem__(self, index: Index) -> Hits:
        """Return some of the hits, as for an array of their shape: by a mask, a slice, ...

        By a name, return the channel that is called so, or else the `attribute`, which
        ``"attribute:NAME"`` is in any case.
        """
        name: Any = index
        if isinstance(name, str):
            named: Any = self._named(name)
            return named  # type: ignore[no-any-return]
        numbers = chosen(index, self._shape)
        # The native half takes contiguous arrays only; a column of an index array has gaps.
        row = np.ascontiguousarray(numbers.reshape(-1))
        some = Hits.__new__(Hits)
        some.__dict__.update(self.__dict__)
        some._arrays = some_of(self._arrays, row)
        some._shape, some._made = numbers.shape, {}
        some._single = None if self._single is None else self._single[row]
        some._source = self._source.take(row, some._shape)
        return some

    def __len__(self) -> int:
        """Return the number of hits along the first axis, as for an array."""
        if not self._shape:
            raise TypeError("the hit of one ray has no length")
        return self._shape[0]

    def __iter__(self) -> Iterator[npt.NDArray[Any]]:
        """Yield ``t`` and ``object``, for ``t, o = hits``."""
        yield self.t
        yield self.object

    if not TYPE_CHECKING:  # A checker would believe that there is any attribute.

        def __getattr__(self, name: str) -> Any:
            """Refuse an attribute that there is not; of depth, say what it is called."""
            if name != "depth":
                # It was tried, and says once more why there is none, as z without an aim does.
                return self.__getattribute__(name)
            said = f"{type(self).__name__!r} object has no attribute {name!r}"
            raise AttributeError(said + channel_hint(name, self.channels), name=name, obj=self)

    def __repr__(self) -> str:
        met = int(np.count_nonzero(self._arrays[1] >= 0))
        return f"Hits(shape={self._shape}, {met:,} of {len(self._arrays[1]):,} rays hit)"

    def _repr_html_(self) -> str:
        """Show it at a glance, for notebooks."""
        from firsthit._files.glance import of_hits

        return of_hits(self)

    def __getstate__(self) -> dict[str, Any]:
        """Pickle with the scene as it was shot, and without what can be computed again."""
        return {**self.__dict__, "_made": {}}
