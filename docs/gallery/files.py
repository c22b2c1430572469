"""Write what docs/gallery/models.py makes: PLY, STL, and glTF with materials and textures."""

from __future__ import annotations

import json
import struct
import zlib
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pathlib import Path

    from models import Mesh


def write_ply(path: Path, mesh: Mesh) -> None:
    """Write a binary PLY with float32."""
    columns, names = [mesh.vertices.astype("<f4")], ["float x", "float y", "float z"]
    kinds = [("p", "<f4", 3)]
    if mesh.normals is not None:
        columns.append(mesh.normals.astype("<f4"))
        names += ["float nx", "float ny", "float nz"]
        kinds.append(("n", "<f4", 3))
    if mesh.colors is not None:
        columns.append(np.round(mesh.colors * 255).astype("u1"))
        names += ["uchar red", "uchar green", "uchar blue"]
        kinds.append(("c", "u1", 3))
    rows = np.empty(len(mesh.vertices), kinds)
    for (name, *_), column in zip(kinds, columns, strict=True):
        rows[name] = column
    faces = mesh.triangles() if mesh.colors is not None else mesh.faces
    lists = np.empty(len(faces), [("n", "u1"), ("i", "<i4", faces.shape[1])])
    lists["n"], lists["i"] = faces.shape[1], faces
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(rows)}"]
    header += [*("property " + name for name in names), f"element face {len(faces)}"]
    header += ["property list uchar int vertex_indices", "end_header\n"]
    path.write_bytes("\n".join(header).encode() + rows.tobytes() + lists.tobytes())


def write_stl(path: Path, mesh: Mesh) -> None:
    """Write a binary STL."""
    corners = mesh.triangles()
    rows = np.zeros(len(corners), [("n", "<f4", 3), ("p", "<f4", (3, 3)), ("a", "<u2")])
    rows["p"] = mesh.vertices[corners]
    header = b"firsthit's gallery".ljust(80) + struct.pack("<I", len(rows))
    path.write_bytes(header + rows.tobytes())


def png(pixels: np.ndarray) -> bytes:
    """Return an 8 bit picture, from numbers from 0 to 1 as they are stored."""
    rows, columns = pixels.shape[:2]
    data = np.round(np.clip(pixels, 0, 1) * 255).astype("u1").reshape(rows, -1)
    lines_of = np.hstack([np.zeros((rows, 1), "u1"), data]).tobytes()
    chunks = [
        (b"IHDR", struct.pack(">IIBBBBB", columns, rows, 8, 2, 0, 0, 0)),
        (b"IDAT", zlib.compress(lines_of, 9)),
        (b"IEND", b""),
    ]
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        for kind, data in chunks
    )


class Glb:
    """A glTF file in one: meshes with materials, placed by translations, y up."""

    def __init__(self) -> None:
        """Begin with a node that turns z up to y up."""
        self.data = b""
        turned = {"rotation": [-(0.5**0.5), 0, 0, 0.5**0.5], "children": []}
        self.tree = {
            "asset": {"version": "2.0", "generator": "docs/gallery/models.py"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [turned],
            "meshes": [],
            "materials": [],
            "accessors": [],
            "bufferViews": [],
            "buffers": [],
        }

    def view(self, data: bytes) -> int:
        """Add bytes, and return their view's number."""
        self.data += b"\0" * (-len(self.data) % 4)
        self.tree["bufferViews"].append(
            {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data)}
        )
        self.data += data
        return len(self.tree["bufferViews"]) - 1

    def accessor(self, array: np.ndarray, kind: str, component: int) -> int:
        """Add an array, and return its number."""
        told = {
            "bufferView": self.view(array.tobytes()),
            "componentType": component,
            "count": array.size // (3 if kind == "VEC3" else 2 if kind == "VEC2" else 1),
            "type": kind,
        }
        if kind == "VEC3":
            told |= {"min": array.min(0).tolist(), "max": array.max(0).tolist()}
        self.tree["accessors"].append(told)
        return len(self.tree["accessors"]) - 1

    def material(
        self, name: str, color: tuple, metallic: float = 0.0, roughness: float = 0.5, **more: object
    ) -> int:
        """Add a material; words with KHR_ are extensions."""
        extensions = {key: value for key, value in more.items() if key.startswith("KHR_")}
        told = {
            "name": name,
            "pbrMetallicRoughness": {
                "baseColorFactor": [*color, 1][:4],
                "metallicFactor": metallic,
                "roughnessFactor": roughness,
            },
        }
        for key, value in more.items():
            if key in ("baseColorTexture", "metallicRoughnessTexture"):
                told["pbrMetallicRoughness"][key] = value
            elif key not in extensions:
                told[key] = value
        if extensions:
            told["extensions"] = extensions
            used = {*self.tree.get("extensionsUsed", []), *extensions}
            self.tree["extensionsUsed"] = sorted(used)
        self.tree["materials"].append(told)
        return len(self.tree["materials"]) - 1

    def texture(self, pixels: np.ndarray) -> dict:
        """Add a picture, and return what a material says of it."""
        self.tree.setdefault("images", []).append(
            {"bufferView": self.view(png(pixels)), "mimeType": "image/png"}
        )
        self.tree.setdefault("textures", []).append({"source": len(self.tree["images"]) - 1})
        return {"index": len(self.tree["textures"]) - 1}

    def mesh(self, mesh: Mesh, material: int) -> int:
        """Add a mesh, and return its number."""
        told = {"POSITION": self.accessor(mesh.vertices.astype("<f4"), "VEC3", 5126)}
        if mesh.normals is not None:
            told["NORMAL"] = self.accessor(mesh.normals.astype("<f4"), "VEC3", 5126)
        if mesh.uvs is not None:
            told["TEXCOORD_0"] = self.accessor(mesh.uvs.astype("<f4"), "VEC2", 5126)
        indices = self.accessor(mesh.triangles().astype("<u4").reshape(-1), "SCALAR", 5125)
        self.tree["meshes"].append(
            {"primitives": [{"attributes": told, "indices": indices, "material": material}]}
        )
        return len(self.tree["meshes"]) - 1

    def put(self, name: str, mesh: int, at: tuple = (0, 0, 0), degrees: float = 0.0) -> None:
        """Place a mesh, turned about z."""
        half = np.radians(degrees) / 2
        node = {
            "name": name,
            "mesh": mesh,
            "translation": [float(x) for x in at],
            "rotation": [0, 0, float(np.sin(half)), float(np.cos(half))],
        }
        self.tree["nodes"].append(node)
        self.tree["nodes"][0]["children"].append(len(self.tree["nodes"]) - 1)

    def write(self, path: Path) -> None:
        """Write the file."""
        self.tree["buffers"] = [{"byteLength": len(self.data)}]
        text = json.dumps(self.tree).encode()
        text += b" " * (-len(text) % 4)
        data = self.data + b"\0" * (-len(self.data) % 4)
        total = 28 + len(text) + len(data)
        head = struct.pack("<4sIII4s", b"glTF", 2, total, len(text), b"JSON")
        path.write_bytes(head + text + struct.pack("<I4s", len(data), b"BIN\0") + data)
