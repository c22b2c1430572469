"""Meshes as PLY files: vertices and triangles, with what they have by name."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit import _firsthit
from firsthit._base.errors import warn
from firsthit._base.log import timed

from .properties import given, shaped

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

    import numpy.typing as npt

    from .mesh import Mesh

#: The names of an array of vertices, column by column, and the type that is written.
_KNOWN = {
    "normals": ("<f4", ("nx", "ny", "nz")),
    "uvs": ("<f4", ("s", "t")),
    "colors": ("u1", ("red", "green", "blue")),
    "alphas": ("u1", ("alpha",)),
}

_WORDS = {"<f8": "double", "<f4": "float", "<i4": "int", "u1": "uchar"}

_Columns = list[tuple[str, str, "npt.NDArray[Any]"]]


def save(
    mesh: Mesh,
    path: str | os.PathLike[str],
    vertex_properties: Mapping[str, npt.ArrayLike] | None,
    face_properties: Mapping[str, npt.ArrayLike] | None,
) -> None:
    """Write a mesh, see `Mesh.save`."""
    if Path(path).suffix.lower() != ".ply":
        raise ValueError(f"path must end in .ply, got {path}")
    points, triangles = mesh.vertices, mesh.triangles
    exact = points.astype("<f4")
    kind = "<f4" if np.array_equal(exact, points) else "<f8"
    vertex: _Columns = [(axis, kind, points[:, k]) for k, axis in enumerate("xyz")]
    for name, (dtype, letters) in _KNOWN.items():
        values = getattr(mesh, name)
        if values is None:
            continue
        if values.ndim == 3:
            warn(f"{path}: {name} of corners are left out: a .ply has them for each vertex")
            continue
        if name == "colors":
            values = _srgb(values)
        if dtype == "u1":
            values = np.floor(255.0 * np.clip(values, 0.0, 1.0) + 0.5)
        vertex += [(letter, dtype, values[:, k]) for k, letter in enumerate(letters)]
    faces = np.arange(len(triangles)) if mesh.faces is None else mesh.faces
    face: _Columns = []
    own = [
        *given("vertex_properties", vertex_properties, "vertices"),
        *given("face_properties", face_properties, "faces"),
    ]
    named = {name for whose, name, *_ in own}
    kept = [one for one in mesh._mesh.properties() if one[1] not in named]
    count = int(faces.max()) + 1 if len(faces) else 0
    for whose, name, components, is_label, flat in [*kept, *own]:
        if whose == "corners":
            raise ValueError(f"a .ply has no numbers of corners, and {name!r} is such")
        values = shaped(whose, flat, components).reshape(-1, components)
        wanted = len(points) if whose == "vertices" else count
        if len(values) != wanted and not (whose == "faces" and len(values) > wanted):
            raise ValueError(f"{name} must be of {wanted} {whose}, got {len(values)}")
        if whose == "faces":
            values = values[faces]
        dtype = _type_of(values, is_label=is_label)
        plain = re.sub(r"[^A-Za-z0-9._-]", "_", name)
        names = [plain] if components == 1 else [f"{plain}_{k}" for k in range(components)]
        columns = [(each, dtype, values[:, k]) for k, each in enumerate(names)]
        (vertex if whose == "vertices" else face).extend(columns)
    for columns in (vertex, face):
        names = [name for name, *_ in columns]
        if twice := next((name for name in names if names.count(name) > 1), None):
            raise ValueError(f"two properties of a .ply would be called {twice!r}")
    with timed("wrote %s", path):
        _firsthit.write_bytes(Path(path), _encoded(vertex, triangles, face))


def _type_of(values: npt.NDArray[Any], *, is_label: bool) -> str:
    """Return the type of a property's numbers; labels are whole numbers, and stay labels."""
    if is_label and np.isfinite(values).all() and (np.abs(values) < 2.0**31).all():
        return "<i4"
    return "<f4" if values.dtype == np.float32 else "<f8"


def _srgb(linear: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
    levels = np.clip(linear.astype(np.float64), 0.0, 1.0)
    return np.where(levels <= 0.0031308, 12.92 * levels, 1.055 * levels ** (1 / 2.4) - 0.055)


def _encoded(vertex: _Columns, triangles: npt.NDArray[np.uint32], face: _Columns) -> bytes:
    corners: list[tuple[Any, ...]] = [("count", "u1"), ("corners", "<i4", (3,))]
    points = _rows(vertex, [], len(vertex[0][2]))
    rows = _rows(face, corners, len(triangles))
    rows["count"], rows["corners"] = 3, triangles
    lines = [
        "ply",
        "format binary_little_endian 1.0",
        f"comment firsthit {_firsthit.version()}",
        f"element vertex {len(points)}",
        *(f"property {_WORDS[kind]} {name}" for name, kind, _ in vertex),
        f"element face {len(rows)}",
        "property list uchar int vertex_indices",
        *(f"property {_WORDS[kind]} {name}" for name, kind, _ in face),
        "end_header\n",
    ]
    return "\n".join(lines).encode() + points.tobytes() + rows.tobytes()


def _rows(columns: _Columns, before: list[tuple[Any, ...]], count: int) -> npt.NDArray[Any]:
    # By place, since a property may be called as the corners are here.
    kinds = [(f"own {name}", kind) for name, kind, _ in columns]
    rows = np.zeros(count, [*before, *kinds])
    for name, _, values in columns:
        rows[f"own {name}"] = values
    return rows
