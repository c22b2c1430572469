"""Meshes of other packages, by what they have: PyVista's, Open3D's, meshio's, trimesh's, and pairs.

None of these packages is imported.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from firsthit._base.errors import warn

from . import foreign_mesh
from .foreign_mesh import linear, properties
from .polygons import Polygons, joined

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import numpy.typing as npt

#: The attributes of a mesh, one for each kind that is known.
WANTED = (
    "a mesh with vertices and faces (trimesh), points and faces (PyVista), vertices and triangles "
    "or vertex and triangle (Open3D), or points and cells (meshio), or a pair (vertices, faces)"
)

#: The cells of meshio that are polygons.
_SURFACES = ("triangle", "quad", "polygon")


class Foreign(NamedTuple):
    """A mesh of another package: its arrays, and what else it has as arguments of `Mesh`."""

    vertices: Any
    #: As `Mesh` takes ``triangles``.
    polygons: Any
    others: dict[str, Any]


def reader_of(thing: object) -> Callable[[Any], Foreign] | None:
    """Return what reads a mesh of another package, by what it has; ``None`` for anything else."""
    if isinstance(thing, tuple | list):
        return _of_pair if len(thing) == 2 and not isinstance(thing[0], str) else None
    if foreign_mesh.is_mesh(thing):
        return _of_faces
    if _has(thing, "vertex", "triangle"):
        return _of_tensors
    if _has(thing, "vertices", "triangles"):
        return _of_triangles
    if _has(thing, "points", "cells") and isinstance(getattr(thing, "cells", None), list):
        return _of_cells
    return _of_poly_data if _has(thing, "points", "faces") else None


def _has(thing: object, *names: str) -> bool:
    return all(hasattr(thing, name) for name in names)


def _of_pair(pair: Any) -> Foreign:
    vertices, faces = pair
    return Foreign(vertices, faces, {})


def _of_faces(mesh: Any) -> Foreign:
    return Foreign(mesh.vertices, mesh.faces, foreign_mesh.attributes(mesh))


def _of_triangles(mesh: Any) -> Foreign:
    """Read an ``open3d.geometry.TriangleMesh``."""
    vertices, triangles = np.asarray(mesh.vertices), np.asarray(mesh.triangles)
    others: dict[str, Any] = {}
    for name, of in (("normals", "vertex_normals"), ("colors", "vertex_colors")):
        values = np.asarray(getattr(mesh, of, ()))
        if values.size:
            others[name] = values
    if "colors" in others:
        others["colors"] = _levels(others["colors"])
    uvs = np.asarray(getattr(mesh, "triangle_uvs", ()))
    if uvs.size:
        others["uvs"] = uvs.reshape(-1, 3, 2)
    return Foreign(vertices, triangles, others)


def _of_tensors(mesh: Any) -> Foreign:
    """Read an ``open3d.t.geometry.TriangleMesh``."""
    vertex = {name: _array(values) for name, values in mesh.vertex.items()}
    triangle = {name: _array(values) for name, values in mesh.triangle.items()}
    vertices = vertex.pop("positions", np.empty((0, 3)))
    triangles = triangle.pop("indices", np.empty((0, 3), np.int64))
    others: dict[str, Any] = {}
    if "normals" in vertex:
        others["normals"] = vertex.pop("normals")
    # Those of flat triangles are what their corners say.
    triangle.pop("normals", None)
    if "colors" in triangle:
        colors = _levels(triangle.pop("colors"))
        others["colors"] = np.repeat(colors[:, None], 3, axis=1)
    if "colors" in vertex:
        others["colors"] = _levels(vertex.pop("colors"))
    if "texture_uvs" in triangle:
        others["uvs"] = triangle.pop("texture_uvs")
    others |= _named(vertex, len(vertices), triangle, len(triangles))
    return Foreign(vertices, triangles, others)


def _of_poly_data(mesh: Any) -> Foreign:
    """Read a ``pyvista.PolyData``, whose faces are one list: how many corners, and these."""
    polygons = _unpacked(np.asarray(mesh.faces))
    before = sum(int(getattr(mesh, name, 0) or 0) for name in ("n_verts", "n_lines"))
    after = int(getattr(mesh, "n_strips", 0) or 0)
    for count, what in ((before, "vertices and lines"), (after, "strips")):
        if count:
            warn(f"{count} cells of a mesh are left out: {what} are no polygons")
    # Before the polygons come vertices and lines, behind them strips.
    cells = {
        name: np.asarray(values)[before : before + len(polygons)]
        for name, values in dict(getattr(mesh, "cell_data", {})).items()
        if name != "Normals"
    }
    data = getattr(mesh, "point_data", {})
    points = dict(data)
    others: dict[str, Any] = {}
    for ours, theirs, usual in (
        ("normals", "active_normals_name", "Normals"),
        ("uvs", "active_texture_coordinates_name", "Texture Coordinates"),
    ):
        values = points.pop(getattr(data, theirs, None) or usual, None)
        if values is not None:
            others[ours] = np.asarray(values)
    vertices = np.asarray(mesh.points)
    others |= _named(points, len(vertices), cells, len(polygons))
    return Foreign(vertices, polygons, others)


def _of_cells(mesh: Any) -> Foreign:
    """Read a ``meshio.Mesh``."""
    vertices = np.asarray(mesh.points)
    if vertices.ndim == 2 and vertices.shape[1] == 2:
        vertices = np.column_stack([vertices, np.zeros(len(vertices))])
    kept = [k for k, block in enumerate(mesh.cells) if block.type.startswith(_SURFACES)]
    lost = {block.type for k, block in enumerate(mesh.cells) if k not in kept}
    if lost - {"vertex", "line"}:
        warn(f"the cells of {', '.join(sorted(lost))} are left out: they are no polygons")
    pieces = [joined(np.empty((0, 3), np.int64))]
    for block in (mesh.cells[k] for k in kept):
        # Of curved cells the corners come first.
        corners = {"triangle": 3, "quad": 4}.get(block.type.rstrip("0123456789"))
        data = block.data
        pieces.append(joined(data if corners is None else np.asarray(data)[:, :corners]))
    polygons = Polygons(*(np.concatenate(arrays) for arrays in zip(*pieces, strict=True)))
    cells = {
        name: np.concatenate([np.asarray(blocks[k]) for k in kept])
        for name, blocks in dict(getattr(mesh, "cell_data", {})).items()
        if kept
    }
    points = dict(getattr(mesh, "point_data", {}))
    others = _named(points, len(vertices), cells, len(polygons))
    return Foreign(vertices, polygons, others)


def _unpacked(faces: npt.NDArray[Any]) -> Polygons:
    """Return the polygons of VTK's list: each is how many corners it has, and these."""
    if faces.ndim == 2:
        return joined(faces)
    size = int(faces[0]) if faces.size else 3
    if faces.size % (size + 1) == 0:
        rows = faces.reshape(-1, size + 1)
        if (rows[:, 0] == size).all():
            return joined(rows[:, 1:])
    starts, numbers, at = [], faces.tolist(), 0
    while at < len(numbers):
        starts.append(at)
        at += 1 + max(numbers[at], 0)
    return Polygons(np.delete(faces, starts), faces[starts])


def _named(
    vertex: Mapping[str, Any], vertices: int, face: Mapping[str, Any], faces: int
) -> dict[str, Any]:
    return {
        "vertex_properties": properties(vertex, "the vertices", vertices),
        "face_properties": properties(face, "the faces", faces),
    }


def _levels(colors: Any) -> npt.NDArray[np.float64]:
    """Return linear colours of sRGB ones, from 0 to 1 or in bytes."""
    array = np.asarray(colors)
    if array.dtype != np.uint8:
        array = np.rint(255.0 * np.clip(np.nan_to_num(array.astype(np.float64)), 0.0, 1.0))
    return linear(array)


def _array(values: Any) -> npt.NDArray[Any]:
    """Return a tensor as an array, whatever device it is on."""
    return np.asarray(values.cpu().numpy() if hasattr(values, "cpu") else values)
