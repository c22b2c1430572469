"""The first hits of rays."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal, TypeVar, get_args, overload

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import chosen, filled, flag, lock, text, threads_or_all
from firsthit._base.channel_hints import hint
from firsthit._base.log import timed
from firsthit._base.progress import following
from firsthit._base.rounding import singles, singles_within
from firsthit._base.types import ChannelName, MatteName, NamedIdentifier
from firsthit._files.channels import attribute_of, distinct, files, is_cloud, is_of_several
from firsthit._files.frame import in_file
from firsthit._files.stored import stored

from .attributes import Attributed
from .leaving import leaving

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from types import EllipsisType

    import numpy.typing as npt

    from firsthit._base.types import (
        AngleName,
        Asked,
        DistanceName,
        Far,
        IdentifierName,
        Progress,
        VectorName,
    )
    from firsthit._objects.traceable import Built

    from .leaving import LeavingRays
    from .source import Arrays, Source

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

_Out = TypeVar("_Out")

#: How many numbers a channel has for each ray, where that is not one.
_COMPONENTS = {"barycentric": 3, "position": 3, "normal": 3, "uv": 2, "base_color": 3}

#: What the columns of a table end in, where that is not x, y, z.
_LETTERS = {"barycentric": "012", "uv": "uv", "base_color": "rgb"}

#: Channels that only pictures have.
_OF_PICTURES = ("color", "valid", "edge", "alpha", "ao", "samples")

#: What can be asked about a camera's hits, and about those of other rays.
_OF_A_CAMERA: tuple[ChannelName, ...] = tuple(
    name for name in get_args(ChannelName) if name not in (*_OF_PICTURES, *get_args(MatteName))
)
_OF_RAYS = tuple(name for name in _OF_A_CAMERA if name not in ("range", "z"))


class Hits(Attributed):
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

    #: The scene as it was shot.
    _built: Built
    _arrays: Arrays
    _shape: tuple[int, ...]
    #: As many as the rays were shot with.
    _threads: int
    _made: dict[str, npt.NDArray[Any]]
    _source: Source
    #: ``t`` as float32, where distances are to be float32.
    _single: npt.NDArray[np.float32] | None = None

    @classmethod
    def _of(
        cls, built: Built, arrays: Arrays, source: Source, shape: tuple[int, ...], threads: int
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
    def t(self) -> npt.NDArray[np.floating[Any]]:
        """The ray parameters of the hits, (...) float64; infinity for a miss.

        A hit is at ``origin + t * direction``. ``t`` is in units of the direction's length; a
        camera's directions have length one, so that it is a distance from the ray's start in scene
        units. It is float32 if `Scene.shoot` was asked for that.
        """
        return self._read_only(self._arrays[0] if self._single is None else self._single)

    @property
    def object(self) -> npt.NDArray[np.int32]:
        """The identifiers of the objects, (...) int32; -1 for a miss."""
        return self._read_only(self._arrays[1])

    @property
    def primitive(self) -> npt.NDArray[np.int32]:
        """The identifiers of the objects' parts, such as triangles, (...) int32; -1 for a miss."""
        return self._read_only(self._arrays[2])

    @property
    def face(self) -> npt.NDArray[np.int32]:
        """The identifiers of the polygons that became triangles, (...) int32; -1 for a miss."""
        return self.channel("face")

    @property
    def node(self) -> npt.NDArray[np.int32]:
        """The identifiers of the file's nodes that objects come from, (...) int32; -1 for none."""
        return self.channel("node")

    @property
    def mesh(self) -> npt.NDArray[np.int32]:
        """The identifiers of the meshes that objects are, or are parts of, (...) int32.

        Objects of one mesh are its instances. -1 for a miss and for other shapes.
        """
        return self.channel("mesh")

    @property
    def material(self) -> npt.NDArray[np.int32]:
        """The identifiers of the materials, (...) int32; -1 for a miss and where there is none.

        Materials that are alike in name and look are one.
        """
        return self.channel("material")

    def names(self, channel: NamedIdentifier) -> tuple[str, ...]:
        """Return the names of what the identifiers of a channel stand for.

        Parameters
        ----------
        channel : {"object", "node", "mesh", "material"}
            The channel.

        Returns
        -------
        tuple of str
            The name of each identifier, from 0 on; empty for what has none. A node's is its path
            from the root of the file's tree, such as ``truck/wheel``.

        Raises
        ------
        ValueError
            For another channel.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> for x in (0, 3):
        ...     steel = fh.Material(color="gray", name="steel")
        ...     ball = scene.add(fh.Sphere(center=(x, 0, 0), radius=1), material=steel)
        >>> hits = scene.shoot([[0, 0, 5], [3, 0, 5], [9, 0, 5]], [0, 0, -1])
        >>> hits.material
        array([ 0,  0, -1], dtype=int32)
        >>> hits.names("material")
        ('steel',)
        """
        if channel not in get_args(NamedIdentifier):
            known = ", ".join(get_args(NamedIdentifier))
            raise ValueError(f"channel must be one of {known}, got {channel!r}")
        return tuple(self._built.native.names(channel))

    @property
    def barycentric(self) -> npt.NDArray[np.float64]:
        """The weights of the triangle's corners, (..., 3) float64; NaN for other shapes."""
        return self.channel("barycentric")

    @property
    def position(self) -> npt.NDArray[np.float64]:
        """The points that are hit, in world space and scene units, (..., 3) float64.

        They are on the surface, however far away the ray starts. On a triangle the point is the
        mean of its corners by the weights of `barycentric`; on any other shape it is
        ``origin + t * direction``, moved onto the shape. Rounding leaves it a few 2^-53 of the
        largest coordinate off the surface, on either side, so a ray from there may meet the same
        surface again.

        To go on in another direction, shoot `leave`. To go on along the same ray, ask
        `Scene.shoot_all`; or shoot it with ``t_min=hits.t``, which is exact too, but passes over
        a second surface at the same ``t``.
        """
        return self.channel("position")

    @property
    def normal(self) -> npt.NDArray[np.float64]:
        """The geometric normals, in world space, (..., 3) float64, of length one.

        A triangle's points to its front, from which its corners are counter-clockwise; a solid's
        points outwards.
        """
        return self.channel("normal")

    @property
    def incidence(self) -> npt.NDArray[np.float64]:
        """The angles between rays and normals, (...) float64, radians: 0 head on, pi / 2 grazing.

        It is the same on both sides of a surface.
        """
        return self.channel("incidence")

    @property
    def front(self) -> npt.NDArray[np.bool_]:
        """Whether the ray met the front, to which the normal points, (...) bool."""
        return self.channel("front")

    @property
    def uv(self) -> npt.NDArray[np.float64]:
        """The texture coordinates, (..., 2) float64; NaN where there are none."""
        return self.channel("uv")

    @property
    def base_color(self) -> npt.NDArray[np.float64]:
        """The linear colours of the surfaces, without light, (..., 3) float64.

        That of the material, times its texture there, times the mesh's own between its corners.
        """
        return self.channel("base_color")

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
        >>> import firsthit as fh
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

    @property
    def channels(self) -> tuple[ChannelName, ...]:
        """The names of the channels of these hits.

        ``range`` is among them for those of a camera or another sensor, ``z`` where that has an
        aim.
        """
        sensor = self._source.camera
        if sensor is None:
            return _OF_RAYS
        if sensor.has_aim:
            return _OF_A_CAMERA
        return tuple(name for name in _OF_A_CAMERA if name != "z")

    @overload
    def channel(
        self,
        name: DistanceName,
        *,
        threads: int | None = None,
        progress: Progress | None = None,
        out: None = None,
    ) -> npt.NDArray[np.floating[Any]]: ...

    @overload
    def channel(
        self,
        name: AngleName | VectorName,
        *,
        threads: int | None = None,
        progress: Progress | None = None,
        out: None = None,
    ) -> npt.NDArray[np.float64]: ...

    @overload
    def channel(
        self,
        name: IdentifierName,
        *,
        threads: int | None = None,
        progress: Progress | None = None,
        out: None = None,
    ) -> npt.NDArray[np.int32]: ...

    @overload
    def channel(
        self,
        name: Literal["front", "valid"],
        *,
        threads: int | None = None,
        progress: Progress | None = None,
        out: None = None,
    ) -> npt.NDArray[np.bool_]: ...

    @overload
    def channel(
        self,
        name: Asked,
        *,
        threads: int | None = None,
        progress: Progress | None = None,
        out: None = None,
    ) -> npt.NDArray[Any]: ...

    @overload
    def channel(
        self,
        name: Asked,
        *,
        threads: int | None = None,
        progress: Progress | None = None,
        out: _Out,
    ) -> _Out: ...

    def channel(
        self,
        name: Asked,
        *,
        threads: int | None = None,
        progress: Progress | None = None,
        out: Any = None,
    ) -> Any:
        """Return a channel, as the attribute of its name, with a choice of threads and progress.

        Parameters
        ----------
        name : str
            One of `channels`, or ``"attribute:NAME"`` for an `attribute`.
        threads : int, optional
            The number of threads; as many as the rays were shot with if left out.
        progress : bool or callable, optional
            As for `Scene.shoot`. A channel that was computed before reports nothing.
        out : array, optional
            Where to put the numbers, and what is returned then: an array of the channel's shape
            that can be written, or a tensor of another package in the memory of the CPU
            (``__dlpack__``). Its type is the channel's or one of the same kind, such as float32.

        Returns
        -------
        (...) or (..., k) array
            As the attribute: the same memory at every call, read-only; or ``out``.

        Raises
        ------
        ValueError
            For a name that is none of `channels`, an attribute that no mesh has, and an ``out`` of
            another shape or kind, or that is read-only.
        AttributeError
            For ``range`` and ``z`` of rays that no camera made.
        MemoryError
            If the array does not fit into memory.

        Examples
        --------
        >>> import numpy as np
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> hits = scene.shoot([[0, 0, 5], [0, 0.6, 5]], [0, 0, -1])
        >>> hits.channel("normal", out=np.empty((2, 3), np.float32))
        array([[0. , 0. , 1. ],
               [0. , 0.6, 0.8]], dtype=float32)
        """
        if out is not None:
            return filled(out, self.channel(name, threads=threads, progress=progress))
        attribute = attribute_of(name) if isinstance(name, str) else None
        if attribute is not None:
            return self.attribute(attribute, threads=threads, progress=progress)
        use = self._threads if threads is None else threads_or_all(threads)
        if name in ("t", "object", "primitive"):
            return getattr(self, name)
        # About pixels more than about hits, so not in every table of them.
        if name not in (*_OF_A_CAMERA, "valid"):
            there = self.channels
            meant = hint(name, there)
            raise ValueError(f"channel must be among {', '.join(there)}, got {name!r}{meant}")
        if name not in self._made:
            with following(progress, len(self._arrays[0])) as report:
                made = self._source.compute(name, self._built, self._arrays, use, report)
            is_single = self._single is not None and name in ("range", "z")
            # Another thread may have made it meanwhile: the first array is everyone's.
            self._made.setdefault(name, singles(made) if is_single else made)
        return self._read_only(self._made[name], _COMPONENTS.get(name, 1))

    def items(self) -> Iterator[tuple[ChannelName, npt.NDArray[Any]]]:
        """Yield the name and the array of each channel, computed when it is reached."""
        for name in self.channels:
            yield name, self.channel(name)

    def to_dict(
        self, channels: Asked | Sequence[Asked] | None = None, *, copy: bool = False
    ) -> dict[str, npt.NDArray[Any]]:
        """Return the hits as a table: its columns by name.

        ``pandas.DataFrame(hits.to_dict())`` and its like take it.

        Parameters
        ----------
        channels : str or sequence of str, optional
            Some of `channels`, or ``"attribute:NAME"`` for an `attribute`; all channels if left
            out.
        copy : bool
            Whether the columns are copies, which can be written, and not views of the hits.

        Returns
        -------
        dict of str to (n,) array
            A row for each ray, in the order of the rays. For a camera's hits the first columns are
            ``row`` and ``column``, their pixel. A channel of several numbers has as many columns,
            called as in the program's CSV: ``position_x``, ``barycentric_0``, ``uv_u``,
            ``attribute:NAME_0``, and so on.

        Raises
        ------
        ValueError, AttributeError
            As `channel`.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> hits = scene.shoot([[0, 0, 5], [0, 3, 5]], [0, 0, -1])
        >>> hits.to_dict(["t", "normal"])
        {'t': array([ 4., inf]), 'normal_x': array([ 0., nan]), 'normal_y': array([ 0., nan]),
        'normal_z': array([ 1., nan])}
        """
        table: dict[str, npt.NDArray[Any]] = {}
        pixels = self._source.rows_and_columns(len(self._arrays[0]))
        if pixels is not None:
            table["row"], table["column"] = pixels
        names = [channels] if isinstance(channels, str) else channels
        for name in self.channels if names is None else names:
            array = self.channel(name)
            if array.ndim == len(self._shape):
                table[name] = array.reshape(-1)
                continue
            columns = array.reshape(-1, array.shape[-1])
            letters: Sequence[object] = _LETTERS.get(name, "xyz")
            if attribute_of(name) is not None:
                letters = range(array.shape[-1])
            for k, letter in enumerate(letters):
                table[f"{name}_{letter}"] = columns[:, k]
        return (
            {name: column.copy() for name, column in table.items()} if flag("copy", copy) else table
        )

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
            PCD float32. ``.npz`` takes all rays and several channels, ``.npy`` one channel; hits of
            the shape of a picture can be ``.exr`` and ``.png`` too, as `Frame.save` writes them.
            With ``{channel}`` in the name each channel has a file of its own. The metadata name the
            camera where the hits are those of all its pixels, or a point cloud.
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
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> hits = scene.shoot([[0, 0, 5], [0, 3, 5]], [0, 0, -1])
        >>> hits.save("cloud.ply", ["position", "normal", "object"], own={"quality": [0.5, 1]})
        """
        how = stored(png_scale, far, png_labels, compress)
        self._save(path, channels, self._own(path, own), how)

    def _own(
        self, path: str | os.PathLike[str], own: Mapping[str, npt.ArrayLike] | None
    ) -> dict[str, npt.NDArray[Any]]:
        """Return numbers of the user's own as files hold them."""
        if not isinstance(own, Mapping | None):
            raise TypeError(f"own must be a dict of arrays, got {own!r}")
        if own and not is_of_several(path):
            raise ValueError(f"own must be left out for {os.fspath(path)}, which takes one channel")
        made = {}
        for name, given in (own or {}).items():
            if name in (*get_args(ChannelName), "ray"):
                raise ValueError(f"own must have names that are no channels, got {name!r}")
            array = np.asarray(given)
            if array.dtype.kind not in "fiub":
                raise ValueError(f"{name} must be bool or real numbers, got dtype {array.dtype}")
            if array.shape[: len(self._shape)] != self._shape or array.ndim > len(self._shape) + 1:
                wanted = f"{self._shape} or {(*self._shape, 'k')}".replace("'", "")
                raise ValueError(f"{name} must have the shape {wanted}, got {array.shape}")
            made[text("a name of own", name)] = in_file(name, array)
        return made

    def _save(
        self,
        path: str | os.PathLike[str],
        channels: Asked | Sequence[Asked] | None,
        others: dict[str, npt.NDArray[Any]],
        how: _firsthit._Stored,
    ) -> None:
        """Write channels, and before them ``others`` to a file that takes several."""
        names: list[str]
        if channels is not None:
            names = list(distinct(channels, self.channels))
        else:
            names = ["t", "object", "primitive"] if is_of_several(path) else ["t"]
            names = ["normal", *names] if is_cloud(path) else names
        if is_cloud(path) and "position" not in names:
            names = ["position", *names]
        wanted = files(path, [*others, *names] if is_of_several(path) else names)
        camera = self._source.camera
        says_camera = is_cloud(path) or self._source.is_whole
        native = camera._native if camera is not None and says_camera else None
        origin = _firsthit.origin(self._built.native, native, names)
        for file, held in wanted:
            made = ((name, others[name] if name in others else self._named(name)) for name in held)
            arrays = [(name, np.ascontiguousarray(array).ravel()) for name, array in made]
            with timed("wrote %s", file):
                _firsthit.write(file, list(self._shape), arrays, origin, how, None)

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
        t, identifiers, primitive, barycentric = self._arrays
        some._arrays = t[row], identifiers[row], primitive[row], barycentric[row]
        some._shape, some._made = numbers.shape, {}
        some._single = None if self._single is None else self._single[row]
        some._source = self._source.take(row, some._shape)
        return some

    def _named(self, name: str) -> npt.NDArray[Any]:
        """Return the channel of that name, or else the attribute."""
        for known in _OF_A_CAMERA:
            if known == name:
                return self.channel(known)
        return self.attribute(attribute_of(name) or name)

    def __len__(self) -> int:
        """Return the number of hits along the first axis, as for an array."""
        if not self._shape:
            raise TypeError("the hit of one ray has no length")
        return self._shape[0]

    def __bool__(self) -> bool:
        """Return True, also if no ray hit anything: the length must not decide."""
        return True

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
            raise AttributeError(said + hint(name, self.channels), name=name, obj=self)

    def __repr__(self) -> str:
        met = int(np.count_nonzero(self._arrays[1] >= 0))
        return f"Hits(shape={self._shape}, {met:,} of {len(self._arrays[1]):,} rays hit)"

    def __getstate__(self) -> dict[str, Any]:
        """Pickle with the scene as it was shot, and without what can be computed again."""
        return {**self.__dict__, "_made": {}}

    def __copy__(self) -> Hits:
        """Copy: what hits hold does not change, and is shared."""
        other = Hits.__new__(Hits)
        other.__dict__.update(self.__dict__)
        other._made = dict(self._made)
        return other

    def __deepcopy__(self, memo: dict[int, Any]) -> Hits:
        """Copy as `copy.copy` does."""
        return self.__copy__()

    def _read_only(self, array: npt.NDArray[Any], components: int = 1) -> npt.NDArray[Any]:
        """Return one of our arrays in the rays' shape. Only `empty` unlocks it, to use it again."""
        lock(array)
        # Of one ray, a number.
        return array.reshape(self._shape if components == 1 else (*self._shape, components))[()]
