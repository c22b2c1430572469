"""Channels of hits, the first or all, and the meshes' attributes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, TypeVar, get_args, overload

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import chunks, filled, lock, one_of, text, threads_or_all
from firsthit._base.hints import channel_hint
from firsthit._base.progress import following, later
from firsthit._base.rounding import singles
from firsthit._files.channels import attribute_of
from firsthit.typing import ChannelName, MatteName, NamedIdentifier

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Self, TypedDict, Unpack

    import numpy.typing as npt

    from firsthit._objects.traceable import Built
    from firsthit.typing import (
        AngleName,
        Asked,
        AttributeOf,
        DistanceName,
        IdentifierName,
        Progress,
        VectorName,
    )

    from .source import Source

    class _How(TypedDict, total=False):
        threads: int | None
        progress: Progress | None


_Out = TypeVar("_Out")

#: How many numbers a channel has for each ray, where that is not one.
_COMPONENTS = {"barycentric": 3, "position": 3, "normal": 3, "uv": 2, "base_color": 3}

#: Channels that only pictures have.
_OF_PICTURES = ("color", "valid", "edge", "alpha", "ao", "samples")

#: Channels of a camera's hits, and of those of other rays.
_OF_A_CAMERA: tuple[ChannelName, ...] = tuple(
    name for name in get_args(ChannelName) if name not in (*_OF_PICTURES, *get_args(MatteName))
)
OF_RAYS = tuple(name for name in _OF_A_CAMERA if name not in ("range", "z"))


class Channels:
    """Hits by channels, each an array of the hits' shape, which is written (...) below."""

    #: The scene as it was shot.
    _built: Built
    _arrays: _firsthit._Hits
    #: The shape of a channel with one number for each hit.
    _shape: tuple[int, ...]
    #: As many as the rays were shot with.
    _threads: int
    #: The channels and attributes that were computed.
    _made: dict[str, npt.NDArray[Any]]
    _source: Source
    #: ``t`` as float32, where distances are to be float32.
    _single: npt.NDArray[np.float32] | None = None

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
        one_of("channel", channel, get_args(NamedIdentifier))
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

        To go on in another direction, shoot `Hits.leave`. To go on along the same ray, ask
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
        """Whether the ray met the front, to which the normal points, (...) bool.

        It enters a solid there, or a closed mesh whose triangles face outwards.
        """
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
    def channels(self) -> tuple[ChannelName, ...]:
        """The names of the channels of these hits.

        ``range`` is among them for those of a camera or another sensor, ``z`` where that has an
        aim.
        """
        sensor = self._source.camera
        if sensor is None:
            return OF_RAYS
        if sensor.has_aim:
            return _OF_A_CAMERA
        return tuple(name for name in _OF_A_CAMERA if name != "z")

    @overload
    def channel(
        self, name: DistanceName, *, out: None = None, **how: Unpack[_How]
    ) -> npt.NDArray[np.floating[Any]]: ...

    @overload
    def channel(
        self, name: AngleName | VectorName, *, out: None = None, **how: Unpack[_How]
    ) -> npt.NDArray[np.float64]: ...

    @overload
    def channel(
        self, name: IdentifierName, *, out: None = None, **how: Unpack[_How]
    ) -> npt.NDArray[np.int32]: ...

    @overload
    def channel(
        self, name: Literal["front", "valid"], *, out: None = None, **how: Unpack[_How]
    ) -> npt.NDArray[np.bool_]: ...

    @overload
    def channel(
        self, name: Asked, *, out: None = None, **how: Unpack[_How]
    ) -> npt.NDArray[Any]: ...

    @overload
    def channel(self, name: Asked, *, out: _Out, **how: Unpack[_How]) -> _Out: ...

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
            meant = channel_hint(name, there)
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

    @property
    def attributes(self) -> tuple[str, ...]:
        """The names of the attributes that the scene's meshes have, sorted."""
        known = _firsthit.attribute_names(self._built.native)
        return tuple(dict.fromkeys(name for name, _, _ in known))

    def attribute(
        self,
        name: str,
        *,
        of: AttributeOf | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
        out: Any = None,
    ) -> npt.NDArray[np.float64]:
        """Return an attribute of the meshes that were hit, at each hit.

        It is one of the numbers by name that a file or a program gave a mesh
        (`Mesh.vertex_properties`, `Mesh.face_properties`, `Mesh.corner_properties`), or the mesh's
        ``normals``, ``uvs``, ``colors`` or ``alphas``.

        Parameters
        ----------
        name : str
            One of `attributes`.
        of : str, optional
            ``"vertices"``, ``"corners"`` or ``"faces"``, where several have an attribute of this
            name. If left out, that of the corners comes before that of the vertices, that before
            the one of the faces, and ``normals``, ``uvs``, ``colors`` and ``alphas`` come last.
        threads : int, optional
            The number of threads; as many as the rays were shot with if left out.
        progress : bool or callable, optional
            As for `Scene.shoot`. An attribute that was looked up before reports nothing.
        out : array, optional
            As for `Hits.channel`.

        Returns
        -------
        (...) or (..., k) array of float64
            Between the corners of a triangle with the weights ``w`` of `barycentric`, numbers
            ``v`` are ``w[0] * v[0] + w[1] * v[1] + w[2] * v[2]``, added from left to right; corners
            of weight zero do not count. Labels, which are the integers of a file and of a
            program, are those of the corner with the largest weight, of equal ones the first.
            Faces have their own. NaN for a miss, for shapes that are no mesh, and for meshes
            without the attribute. There are ``k`` numbers if a mesh of the scene has so many;
            the rest is NaN where a mesh has fewer. The same memory at every call, read-only.

        Raises
        ------
        ValueError
            For a name that no mesh of the scene has, and an ``out`` of another shape.
        MemoryError
            If the array does not fit into memory.

        Examples
        --------
        >>> corners = [[0, 0, 0], [4, 0, 0], [0, 4, 0]]
        >>> heat = {"heat": [10.0, 20.0, 40.0]}
        >>> scene = fh.Scene()
        >>> scene.add(fh.Mesh(corners, [[0, 1, 2]], vertex_properties=heat))
        0
        >>> hits = scene.shoot([[1, 2, 5], [9, 9, 5]], [0, 0, -1])
        >>> hits.attribute("heat")
        array([27.5,  nan])
        >>> hits["heat"]
        array([27.5,  nan])
        """
        use = self._threads if threads is None else threads_or_all(threads)
        name = text("name", name)
        if of is not None:
            text("of", of)
        # No channel is called so.
        key = f"attribute {of} {name}"
        if key not in self._made:
            length = len(self._arrays[0])
            with following(progress, length) as report:
                pieces = []
                for part in list(chunks(length)) or [slice(0, 0)]:
                    hits = tuple(np.ascontiguousarray(array[part]) for array in self._arrays)
                    told = later(report, part.start)
                    pieces.append(
                        _firsthit.attribute(self._built.native, (name, of), hits, use, told)
                    )
            values = [flat.reshape(-1, components) for components, flat in pieces]
            made = values[0] if len(values) == 1 else np.concatenate(values)
            # Another thread may have made it meanwhile: the first array is everyone's.
            self._made.setdefault(key, made)
        found = self._made[key]
        shaped = self._read_only(found, found.shape[1])
        return shaped if out is None else filled(out, shaped)

    def _named(self, name: str) -> npt.NDArray[Any]:
        """Return the channel of that name, or else the attribute."""
        for known in _OF_A_CAMERA:
            if known == name:
                return self.channel(known)
        if name == "depth" and name not in self.attributes:
            raise ValueError(f"depth is no channel{channel_hint(name, self.channels)}")
        return self.attribute(attribute_of(name) or name)

    def __bool__(self) -> bool:
        """Return True, also without rays or hits: the length must not decide."""
        return True

    def __copy__(self) -> Self:
        """Copy: what hits hold does not change, and is shared."""
        other = type(self).__new__(type(self))
        other.__dict__.update(self.__dict__)
        other._made = dict(self._made)
        return other

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        """Copy as `copy.copy` does."""
        return self.__copy__()

    def _read_only(self, array: npt.NDArray[Any], components: int = 1) -> npt.NDArray[Any]:
        """Return one of our arrays in the hits' shape. Only `empty` unlocks it, to use it again."""
        lock(array)
        # Of one ray, a number.
        return array.reshape(self._shape if components == 1 else (*self._shape, components))[()]
