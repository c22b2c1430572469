"""Write a GLB file of many objects, its coordinates as they are."""

from __future__ import annotations

import json
import struct
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    import numpy as np


class Placed(NamedTuple):
    """An object: which mesh, and its matrix (4, 4) of float32 numbers if it is moved."""

    mesh: int
    matrix: np.ndarray | None = None


def save_objects(
    file: Path, meshes: Sequence[tuple[np.ndarray, np.ndarray]], placed: list[Placed]
) -> None:
    """Write objects; a mesh is vertices (n, 3) and, of its triangles, three indices each (m, 3)."""
    views, accessors, content = [], [], bytearray()

    def add(array: np.ndarray, **about: object) -> int:
        views.append({"buffer": 0, "byteOffset": len(content), "byteLength": array.nbytes})
        accessors.append({"bufferView": len(views) - 1, **about})
        content.extend(array.tobytes())
        return len(views) - 1

    described = []
    for positions, triangles in meshes:
        vertices, indices = positions.astype("<f4"), triangles.astype("<u4")
        ends = {"min": vertices.min(0).tolist(), "max": vertices.max(0).tolist()}
        count = len(vertices)
        position = add(vertices, componentType=5126, type="VEC3", count=count, **ends)
        corners = add(indices, componentType=5125, type="SCALAR", count=indices.size)
        primitive = {"attributes": {"POSITION": position}, "indices": corners}
        described.append({"primitives": [primitive]})
    nodes = [
        {"mesh": mesh} | ({} if matrix is None else {"matrix": matrix.T.ravel().tolist()})
        for mesh, matrix in placed
    ]
    whole = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(nodes)))}],
        "nodes": nodes,
        "meshes": described,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(content)}],
    }
    text = json.dumps(whole).encode()
    text += b" " * (-len(text) % 4)
    with file.open("wb") as out:
        out.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(content)))
        out.write(struct.pack("<I4s", len(text), b"JSON") + text)
        out.write(struct.pack("<I4s", len(content), b"BIN\0") + content)
