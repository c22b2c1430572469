"""Triangle meshes, in object space. They are immutable, and many objects can share one."""

from __future__ import annotations

import copyreg
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import cast, numbers, table

from .foreign_kinds import WANTED, reader_of
from .mesh_file import save
from .polygons import Polygons, cut, indices, polygons_of
from .properties import given, shaped
from .shapes import Shape

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping, Sequence

    import numpy.typing as npt

    from firsthit.typing import ForeignMesh


class Mesh(Shape):
    """Triangles over shared vertices, counter-clockwise seen from the front.

    Parameters
    ----------
    vertices : (n, 3) array_like, or a mesh of another package
        The vertices in object space, of any real type. They are stored as float32 if that loses
        nothing, else as float64.
    triangles : (m, 3) or (m, k) array_like of int, or sequence of sequences of int
        The indices of each triangle's vertices, or of polygons of any numbers of corners, concave
        ones too, which are cut into triangles; ``faces`` are then the polygons. May be left out if
        ``vertices`` is a mesh of another package, see `of`.
    normals : (n, 3) or (m, 3, 3) array_like, optional
        Normals for shading, of any length. These and the next three are given for each vertex, or
        for each corner of each triangle, and stored as float32.
    uvs : (n, 2) or (m, 3, 2) array_like, optional
        Texture coordinates.
    colors : (n, 3) or (m, 3, 3) array_like, optional
        Linear colours, multiplied by the object's colour.
    alphas : (n, 1) or (m, 3, 1) array_like, optional
        Alphas, multiplied by the material's alpha.
    faces : (m,) array_like of int, optional
        The polygon that each triangle was part of, for the channel ``face``; the triangle's own
        index if left out.
    slots : (m,) array_like of int, optional
        The index of each triangle's or polygon's material among those of the object.
    vertex_properties : dict of str to (n,) or (n, k) array_like, optional
        Numbers of the vertices by name, such as the quality of a scan. Where a ray meets the mesh,
        `Hits.attribute` interpolates floats; integers and bool are labels, taken from the nearest
        corner. They are kept as floats, so that integers are at most 2^53; (n, 1) counts as (n,).
    face_properties : dict of str to (f,) or (f, k) array_like, optional
        The same for the polygons that ``faces`` counts.
    corner_properties : dict of str to (m, 3) or (m, 3, k) array_like, optional
        The same for the corners of the triangles.
    second_uvs : (n, 2) or (m, 3, 2) array_like, optional
        Texture coordinates for textures that take the second ones.
    tangents : (n, 4) or (m, 3, 4) array_like, optional
        For normal maps: the direction in which the map's columns run, and 1, or -1 where the map is
        mirrored. Without them the texture coordinates tell.

    Raises
    ------
    ValueError
        For arrays of a wrong shape or type, an index without a vertex, and a corner that is not
        finite.
    TypeError
        For properties that are no dict.

    Warns
    -----
    FirsthitWarning
        For what is left out of another package's mesh.

    Examples
    --------
    >>> fh.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    Mesh(3 vertices, 1 triangle)
    """

    def __init__(
        self,
        vertices: npt.ArrayLike | ForeignMesh,
        triangles: npt.ArrayLike | Sequence[npt.ArrayLike] | None = None,
        normals: npt.ArrayLike | None = None,
        uvs: npt.ArrayLike | None = None,
        colors: npt.ArrayLike | None = None,
        alphas: npt.ArrayLike | None = None,
        faces: npt.ArrayLike | None = None,
        slots: npt.ArrayLike | None = None,
        vertex_properties: Mapping[str, npt.ArrayLike] | None = None,
        face_properties: Mapping[str, npt.ArrayLike] | None = None,
        corner_properties: Mapping[str, npt.ArrayLike] | None = None,
        *,
        second_uvs: npt.ArrayLike | None = None,
        tangents: npt.ArrayLike | None = None,
    ) -> None:
        if triangles is None:
            read = reader_of(vertices)
            if read is None:
                raise ValueError("triangles must be given with an array of vertices")
            vertices, triangles, own = read(vertices)
            normals = own.get("normals") if normals is None else normals
            uvs = own.get("uvs") if uvs is None else uvs
            colors = own.get("colors") if colors is None else colors
            if vertex_properties is None:
                vertex_properties = own.get("vertex_properties")
            if face_properties is None:
                face_properties = own.get("face_properties")
        points = table("vertices", vertices, 3, np.float64)
        polygons = polygons_of(triangles)
        if polygons is None:
            corners = _triangles(triangles, len(points))
        else:
            if faces is not None:
                raise ValueError("faces must be left out with polygons, which are the faces")
            corners, faces = cut(points, polygons)
            if slots is not None:
                slots = _labels("slots", slots, len(polygons))[faces]
        optional = [("normals", normals, 3), ("uvs", uvs, 2), ("colors", colors, 3)]
        optional += [
            ("alphas", alphas, 1),
            ("second_uvs", second_uvs, 2),
            ("tangents", tangents, 4),
        ]
        attributes = tuple(
            None if value is None else _attribute(name, value, columns)
            for name, value, columns in optional
        )
        labels = [
            None if value is None else _labels(name, value, len(corners))
            for name, value in [("faces", faces), ("slots", slots)]
        ]
        properties = [
            *given("vertex_properties", vertex_properties, "vertices"),
            *given("face_properties", face_properties, "faces"),
            *given("corner_properties", corner_properties, "corners"),
        ]
        self._mesh = _firsthit.Mesh(points, corners, attributes, labels, properties)

    @classmethod
    def of(cls, mesh: ForeignMesh) -> Mesh:
        """Return a mesh of another package, which is known by what it has, and not imported.

        Parameters
        ----------
        mesh : mesh of another package, or pair
            With ``vertices`` and ``faces``, such as a ``trimesh.Trimesh``; ``points`` and
            ``faces``, a ``pyvista.PolyData``; ``vertices`` and ``triangles``, an
            ``open3d.geometry.TriangleMesh``; ``vertex`` and ``triangle``, one of ``open3d.t``; or
            ``points`` and ``cells``, a ``meshio.Mesh``. Or a pair of vertices and faces, as `Mesh`
            takes both. Polygons are cut into triangles.

        Returns
        -------
        Mesh
            With its texture coordinates, with its colours, which are sRGB, and with its attributes
            of vertices and faces (`vertex_properties`, `face_properties`); from PyVista and Open3D
            with the normals of its vertices, if it has some. Lines and points are left out. The
            material is for objects, see `Scene.add`.

        Raises
        ------
        TypeError
            For anything else.
        ValueError
            As `Mesh`.

        Warns
        -----
        FirsthitWarning
            For what is left out.

        Examples
        --------
        >>> corners = [[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]]
        >>> fh.Mesh.of((corners, [[0, 1, 2, 3]]))
        Mesh(4 vertices, 2 triangles)
        """
        if reader_of(mesh) is None:
            raise TypeError(f"mesh must be {WANTED}, got {mesh!r}")
        return cls(mesh)

    @classmethod
    def _wrap(cls, mesh: _firsthit.Mesh) -> Mesh:
        wrapped = cls.__new__(cls)
        wrapped._mesh = mesh
        return wrapped

    def _native(self) -> _firsthit.Shape:
        return _firsthit.Shape.mesh(self._mesh)

    @property
    def vertices(self) -> npt.NDArray[np.float64]:
        """The vertices in object space, (n, 3) float64: a copy."""
        return self._mesh.vertices()

    @property
    def triangles(self) -> npt.NDArray[np.uint32]:
        """The indices of each triangle's vertices, (m, 3) uint32: a copy."""
        return self._mesh.triangles()

    @property
    def is_closed(self) -> bool:
        """Whether every edge belongs to an even number of triangles, as `Scene.inside` wants it.

        An edge is where its two ends are: vertices in one place count as one.
        """
        return self._mesh.is_closed()

    @property
    def area(self) -> float:
        """The area of all triangles, in squares of object space."""
        return self._mesh.area()

    @property
    def volume(self) -> float:
        """The volume inside, in cubes of object space; NaN for a mesh that has no inside.

        It does not matter whether the triangles face outwards, and a flipped one counts as its
        neighbours do. Where shells overlap, each counts, and the volume of one that faces the other
        way than most, as a cavity does, is taken off.
        """
        volume = self._mesh.volume()
        return math.nan if volume is None else volume

    def split(self) -> list[Mesh]:
        """Split the mesh into its parts.

        Triangles that have an edge in common are of one part; an edge is where its two ends are, so
        vertices in one place count as one.

        Returns
        -------
        list of Mesh
            The parts, in the order of their first triangles, each with its vertices alone and with
            all attributes. ``faces`` are counted anew.

        Raises
        ------
        MemoryError
            If there is too little memory.

        Examples
        --------
        >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 0, 0], [6, 0, 0], [5, 1, 0]]
        >>> fh.Mesh(corners, [[0, 1, 2], [3, 4, 5]]).split()
        [Mesh(3 vertices, 1 triangle), Mesh(3 vertices, 1 triangle)]
        """
        return [Mesh._wrap(part) for part in self._mesh.split()]

    @property
    def normals(self) -> npt.NDArray[np.float32] | None:
        """The shading normals in object space, (n, 3) or (m, 3, 3) float32: a copy."""
        return self._mesh.attributes()[0]

    @property
    def uvs(self) -> npt.NDArray[np.float32] | None:
        """The texture coordinates, (n, 2) or (m, 3, 2) float32: a copy."""
        return self._mesh.attributes()[1]

    @property
    def colors(self) -> npt.NDArray[np.float32] | None:
        """The linear colours, (n, 3) or (m, 3, 3) float32: a copy."""
        return self._mesh.attributes()[2]

    @property
    def alphas(self) -> npt.NDArray[np.float32] | None:
        """The alphas, (n, 1) or (m, 3, 1) float32: a copy."""
        return self._mesh.attributes()[3]

    @property
    def second_uvs(self) -> npt.NDArray[np.float32] | None:
        """The second texture coordinates, (n, 2) or (m, 3, 2) float32: a copy."""
        return self._mesh.attributes()[4]

    @property
    def tangents(self) -> npt.NDArray[np.float32] | None:
        """The tangents in object space, (n, 4) or (m, 3, 4) float32: a copy."""
        return self._mesh.attributes()[5]

    @property
    def faces(self) -> npt.NDArray[np.uint32] | None:
        """The polygon that each triangle was part of, (m,) uint32: a copy."""
        return self._mesh.labels()[0]

    @property
    def slots(self) -> npt.NDArray[np.uint32] | None:
        """The index of each triangle's material among the object's, (m,) uint32: a copy."""
        return self._mesh.labels()[1]

    @property
    def vertex_properties(self) -> dict[str, npt.NDArray[Any]]:
        """The numbers of the vertices by name, each (n,) or (n, k) float32 or float64: a copy.

        They hold a PLY file's properties that have no meaning to firsthit, and of a glTF file the
        attributes that begin with an underscore, and ``COLOR_1`` and so on.
        """
        return self._properties("vertices")

    @property
    def face_properties(self) -> dict[str, npt.NDArray[Any]]:
        """The numbers of the polygons by name, each (f,) or (f, k) float32 or float64: a copy.

        ``values[frame["face"]]`` is a picture of them, where every pixel hits this mesh.
        """
        return self._properties("faces")

    @property
    def corner_properties(self) -> dict[str, npt.NDArray[Any]]:
        """The numbers of the corners by name, each (m, 3) or (m, 3, k) float: a copy."""
        return self._properties("corners")

    def save(
        self,
        path: str | os.PathLike[str],
        *,
        vertex_properties: Mapping[str, npt.ArrayLike] | None = None,
        face_properties: Mapping[str, npt.ArrayLike] | None = None,
    ) -> None:
        """Write the mesh to a PLY file, whole or not at all.

        The file has vertices, triangles, normals, texture coordinates, colours, alphas and the
        properties of vertices and faces. Lengths are exact, colours are bytes of sRGB. `load` reads
        all of it again.

        Parameters
        ----------
        path : path-like
            The file, whose name ends in ``.ply``.
        vertex_properties : dict of str to (n,) or (n, k) array_like, optional
            More numbers of the vertices by name, as `Mesh` takes them, such as how thick the part
            is there; in place of the mesh's own of that name.
        face_properties : dict of str to (f,) or (f, k) array_like, optional
            The same for the polygons; in the file each of their triangles has them.

        Raises
        ------
        ValueError
            For another extension, arrays of a wrong length, and two properties that would have one
            name in the file, where ``_`` stands for every character but letters, digits, ``.``,
            ``-`` and ``_`` of ASCII.
        FileWriteError
            If the system refuses to write it; an old file is as it was. Also an `OSError`.

        Examples
        --------
        >>> scene = fh.load("part.stl")  # doctest: +SKIP
        >>> part = scene.objects[0].shape  # doctest: +SKIP
        >>> thick = scene.thickness(part.vertices)  # doctest: +SKIP
        >>> part.save("thick.ply", vertex_properties={"thickness": thick})  # doctest: +SKIP
        """
        save(self, path, vertex_properties, face_properties)

    def _properties(self, of: str) -> dict[str, npt.NDArray[Any]]:
        all_of_them = self._mesh.properties()
        return {
            name: shaped(of, values, components)
            for whose, name, components, _, values in all_of_them
            if whose == of
        }

    def __repr__(self) -> str:
        vertices, triangles = self._mesh.counts()
        plural = "" if triangles == 1 else "s"
        return f"Mesh({vertices:,} vertices, {triangles:,} triangle{plural})"


def _reduced(mesh: _firsthit.Mesh) -> tuple[Any, ...]:
    """Pickle by value; which properties are labels does not show in their arrays."""
    arrays = mesh.vertices(), mesh.triangles(), tuple(mesh.attributes())
    return _firsthit.Mesh, (*arrays, list(mesh.labels()), mesh.properties())


copyreg.pickle(_firsthit.Mesh, _reduced)


def _attribute(name: str, value: Any, columns: int) -> npt.NDArray[np.float32]:
    array = numbers(name, value)
    if array.ndim == 3 and array.shape[1:] == (3, columns):
        return cast(array, np.float32)
    if array.ndim == 3:
        raise ValueError(f"{name} must have the shape (m, 3, {columns}), got {array.shape}")
    return table(name, array, columns, np.float32)


def _labels(name: str, value: Any, triangles: int) -> npt.NDArray[np.uint32]:
    array = numbers(name, value)
    if array.shape != (triangles,) or array.dtype.kind not in "iu":
        raise ValueError(
            f"{name} must be {triangles} whole numbers, got {array.dtype} of shape {array.shape}"
        )
    if array.size and not 0 <= array.min() <= array.max() < 2**31:
        raise ValueError(f"{name} must be from 0 to 2**31 - 1, got {array.min()} to {array.max()}")
    return np.ascontiguousarray(array, dtype=np.uint32)


def _triangles(value: Any, vertices: int) -> npt.NDArray[np.uint32]:
    if isinstance(value, Polygons):
        value = value.corners.reshape(-1, 3)
    return table("triangles", indices("triangles", value, vertices), 3, np.uint32)
