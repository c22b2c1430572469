"""Hostile glTF and GLB files: lengths, counts, references and numbers that lie, and little that asks for much."""

import base64
import copy
import json
import struct
import zlib

FLOATS = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
INDICES = struct.pack("<3H", 0, 1, 2)
HUGE = [-1, 0.5, 1 << 31, 1 << 32, (1 << 53) + 1, (1 << 63) - 1, 1 << 64, 1e300, "3", None]


def uri(content: bytes, kind: str = "application/octet-stream") -> str:
    """Make a data URI."""
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"


def good() -> dict:
    """Make a document of one triangle."""
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": 42, "uri": uri(FLOATS + INDICES)}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 6},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"},
        ],
    }


def changed(path: str, value: object) -> bytes:
    """Change or add one value of the good document."""
    document = copy.deepcopy(good())
    *parents, last = path.split("/")
    place = document
    for key in parents:
        place = place[int(key) if isinstance(place, list) else key]
    place[int(last) if isinstance(place, list) else last] = value
    return text(document)


def text(document: dict) -> bytes:
    """Write a document as JSON; Python writes NaN and Infinity too, which JSON does not have."""
    return json.dumps(document).encode()


def glb(content: bytes, binary: bytes = b"", *, length: int = 0, sizes: tuple = ()) -> bytes:
    """Make a binary container with the lengths that it claims."""
    content += b" " * (-len(content) % 4)
    sizes = sizes or (len(content), len(binary))
    length = length or 12 + 8 + len(content) + 8 + len(binary)
    header = struct.pack("<4sII", b"glTF", 2, length)
    return header + struct.pack("<I4s", sizes[0], b"JSON") + content + struct.pack("<I4s", sizes[1], b"BIN\0") + binary


def containers() -> list[bytes]:
    """Containers whose lengths lie, or that end early."""
    document = good()
    del document["buffers"][0]["uri"]
    content, binary = text(document), FLOATS + INDICES + bytes(2)
    whole = glb(content, binary)
    most = (1 << 32) - 1
    files = [whole[:end] for end in (0, 3, 4, 8, 11, 12, 19, 20, 60, len(whole) - 1)]
    files += [glb(content, binary, length=length) for length in (1, 12, 20, most)]
    files += [glb(content, binary, sizes=sizes) for sizes in ((most, 0), (0, most), (8, 8), (most - 11, 1))]
    files += [whole + bytes(1 << 20), whole[:12] * 1000, b"glTF" + bytes(100), glb(b"", binary), glb(b"{}")]
    return files


def numbers() -> list[bytes]:
    """Make counts, offsets and indices beyond what is there."""
    places = [
        "scene", "nodes/0/mesh", "scenes/0/nodes/0", "meshes/0/primitives/0/indices",
        "meshes/0/primitives/0/mode", "meshes/0/primitives/0/attributes/POSITION",
        "buffers/0/byteLength", "bufferViews/0/buffer", "bufferViews/0/byteLength",
        "bufferViews/0/byteOffset", "bufferViews/0/byteStride", "accessors/0/count",
        "accessors/0/byteOffset", "accessors/0/bufferView", "accessors/0/componentType",
        "accessors/0/type", "accessors/1/count",
    ]  # fmt: skip
    files = [changed(place, value) for place in places for value in HUGE]
    document = good()
    del document["accessors"][0]["bufferView"]
    for count in (0, 1 << 20, 1 << 31, 1 << 40, 1 << 62):
        document["accessors"][0]["count"] = count
        files.append(text(document))
    for count in (4, 1 << 31, 1 << 62):
        for index in (b"\x00\x00", b"\xff\xff"):
            document = good()
            document["buffers"].append({"byteLength": 2, "uri": uri(index)})
            document["bufferViews"].append({"buffer": 1, "byteLength": 2})
            document["accessors"][0]["sparse"] = {
                "count": count if index[0] else 1,
                "indices": {"bufferView": 2, "componentType": 5123},
                "values": {"bufferView": 0, "byteOffset": 24 if index[0] else 30},
            }
            files.append(text(document))
    strides = [1, 3, 4, 11, 12, 13, 252, 256, 1 << 40]
    return files + [changed("bufferViews/0/byteStride", stride) for stride in strides]


def nodes() -> list[bytes]:
    """Nodes in circles, in long chains, in crowds, and where there is no place."""
    files = [changed("nodes/0/children", [0]), changed("nodes/0/children", [1 << 40])]
    circle = good()
    circle["nodes"] = [{"children": [1]}, {"children": [2]}, {"children": [0], "mesh": 0}]
    files.append(text(circle))
    twice = good()
    twice["nodes"] = [{"children": [1, 1]}, {"mesh": 0}]
    files.append(text(twice))
    chain = good()
    chain["nodes"] = [{"children": [k + 1], "scale": [1.1] * 3} for k in range(1_000_000)] + [{"mesh": 0}]
    files.append(text(chain))
    levels = good()
    levels["nodes"] = [{"children": [k + 1, k + 1]} for k in range(60)] + [{"mesh": 0}]
    files.append(text(levels))
    crowd = good()
    crowd["meshes"] = [{"primitives": good()["meshes"][0]["primitives"] * 20_000}]
    crowd["nodes"] = [{"mesh": 0}] * 20_000
    crowd["scenes"] = [{"nodes": list(range(20_000))}]
    files.append(text(crowd))
    unseen = copy.deepcopy(crowd)
    unseen["meshes"] = [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 0}] * 100_000, "name": "x" * 100_000}]
    files.append(text(unseen))
    for values in ([float("nan")] * 16, [1e308] * 16, [0] * 16, [1] * 15, [None] * 16):
        files.append(changed("nodes/0/matrix", values))
    for key in ("translation", "scale", "rotation"):
        files += [changed(f"nodes/0/{key}", value) for value in ([1e308] * 4, [1e308] * 3, [float("inf")] * 3, "x", {})]
    return files


def instances() -> list[bytes]:
    """More instances than memory has room for, in a few bytes."""
    files = []
    for count in (1 << 20, 1 << 24, 1 << 32, 1 << 60):
        for name in ("TRANSLATION", "_ID"):
            document = good()
            document["accessors"].append({"componentType": 5126, "count": count, "type": "VEC3"})
            instancing = {"EXT_mesh_gpu_instancing": {"attributes": {name: 2}}}
            document["nodes"] = [{"mesh": 0, "extensions": instancing}] * 1000
            document["scenes"] = [{"nodes": list(range(1000))}]
            files.append(text(document))
    return files


def skins() -> list[bytes]:
    """Skins that name too much, too little, or each other."""
    document = good()
    document["accessors"] += [
        {"componentType": 5121, "count": 3, "type": "VEC4"},
        {"componentType": 5126, "count": 3, "type": "VEC4"},
    ]
    primitive = document["meshes"][0]["primitives"][0]
    primitive["attributes"] |= {"JOINTS_0": 2, "WEIGHTS_0": 3}
    count = 50_000
    document["skins"] = [{"joints": [0]}] * count
    document["nodes"] = [{"mesh": 0, "skin": k} for k in range(count)]
    document["scenes"] = [{"nodes": list(range(count))}]
    files = [text(document)]
    document["nodes"], document["scenes"] = [{"mesh": 0, "skin": 0}], [{"nodes": [0]}]
    for skin in ({"joints": []}, {"joints": [7]}, {"joints": [0], "inverseBindMatrices": 1}, {}):
        document["skins"] = [skin]
        files.append(text(document))
    morphs = good()
    morphs["meshes"][0]["primitives"][0]["targets"] = [{"POSITION": 0}] * 100_000
    morphs["meshes"][0]["weights"] = [1e300] * 100_000
    return [*files, text(morphs)]


def png(columns: int, rows: int, packed: bytes) -> bytes:
    """Make a PNG with the size that it claims."""
    header = struct.pack(">IIBBBBB", columns, rows, 8, 6, 0, 0, 0)
    chunks = [(b"IHDR", header), (b"IDAT", packed), (b"IEND", b"")]
    words = [struct.pack(">I", len(c)) + k + c + struct.pack(">I", zlib.crc32(k + c)) for k, c in chunks]
    return b"\x89PNG\r\n\x1a\n" + b"".join(words)


def pictures(outside: list[str]) -> list[bytes]:
    """Images that are bombs, lie, or are elsewhere."""
    bomb = zlib.compress(bytes(64 << 20), 9)
    contents = [
        b"", b"x", png(1 << 30, 1 << 30, b""), png(16384, 16384, bomb), png(4, 4, bomb), png(0, 0, b""),
        b"\xff\xd8\xff\xc0\x00\x11\x08\xff\xff\xff\xff\x03" + bytes(50), b"RIFF\xff\xff\xff\xffWEBPVP8L" + bytes(60),
        b"BM" + b"\xff" * 60, b"\xabKTX 20\xbb\r\n\x1a\n" + b"\xff" * 60,
    ]  # fmt: skip
    sources = [{"uri": uri(content, "image/png")} for content in contents] + [{"uri": name} for name in outside]
    sources += [{"bufferView": 1}, {"bufferView": 9}, {}, {"uri": "data:image/png;base64,!!"}]
    files = []
    for source in sources:
        document = textured([source])
        files.append(text(document))
    many = textured([{"bufferView": 2}] * 2000)
    picture = png(8192, 8192, bomb[: len(bomb) // 2])
    many["buffers"].append({"byteLength": len(picture), "uri": uri(picture)})
    many["bufferViews"].append({"buffer": 1, "byteLength": len(picture)})
    return [*files, text(many)]


def textured(images: list[dict]) -> dict:
    """Make a triangle for each image."""
    document = good()
    primitive = document["meshes"][0]["primitives"][0]
    count = range(len(images))
    document["images"] = images
    document["textures"] = [{"source": k} for k in count]
    document["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": k}}} for k in count]
    document["meshes"][0]["primitives"] = [primitive | {"material": k} for k in count]
    return document


def packed() -> list[bytes]:
    """Garbage in the place of what Draco and meshopt packed."""
    files = []
    garbage = [b"", b"DRACO", b"DRACO\x02\x02\x01\x01\x00\x00" + b"\xff" * 200, b"\xa0" + b"\xff" * 99, bytes(500)]
    for content in garbage:
        document = good()
        document["buffers"].append({"byteLength": len(content), "uri": uri(content)})
        document["bufferViews"].append({"buffer": 1, "byteLength": len(content)})
        draco = {"bufferView": 2, "attributes": {"POSITION": 0}}
        document["meshes"][0]["primitives"][0]["extensions"] = {"KHR_draco_mesh_compression": draco}
        files.append(text(document))
        for mode in ("ATTRIBUTES", "TRIANGLES", "INDICES", "?"):
            for count, stride in ((3, 12), (3, 2), (1 << 24, 256), (1 << 62, 4), (1 << 62, 256)):
                meshopt = {"buffer": 1, "byteLength": len(content), "byteStride": stride, "count": count, "mode": mode}
                document = good()
                document["buffers"].append({"byteLength": len(content), "uri": uri(content)})
                document["bufferViews"][0]["extensions"] = {"EXT_meshopt_compression": meshopt}
                files.append(text(document))
    return files


def documents(outside: list[str]) -> list[bytes]:
    """JSON that is none, that is deep or long, and names that lead elsewhere."""
    files = [b"[" * 100_000, b'{"extras":' * 100_000, b'{"asset":{"version":"2.0"},"extras":' + b"[" * 100_000]
    files += [b"{}", b"null", b"[]", b"1e999", b'"', b"\x00", b"\xef\xbb\xbf{}", b'{"asset":{"version":"2.0"}}']
    files += [text(good()).replace(b'"scene": 0', b'"scene": 0, "scene": 0'), text(good())[:-1], text(good()) + b"{}"]
    files += [text(good()).decode().encode(kind) for kind in ("utf-16", "utf-32")]
    files += [b'{"asset":{"version":"2.0"},"nodes":[' + b"{}," * 3_000_000 + b"{}]}"]
    files += [b'{"asset":{"version":"2.0"},"meshes":[' + b'{"primitives":[]},' * 500_000 + b'{"primitives":[]}]}']
    for value in ("9.0", "", "x" * 100_000, 2.0):
        files.append(changed("asset/version", value))
    for names in (["VENDOR_unknown"], ["x" * 1_000_000], ["\x1b[2J"], [f"A_{k}" for k in range(100_000)]):
        files += [changed("extensionsRequired", names), changed("extensionsUsed", names)]
    names = [*outside, "%2Fetc%2Fpasswd", "%2e%2e%2f%2e%2e%2fetc%2fpasswd", "%00", "%ff", "%"]
    names += ["data:", "data:;base64,%"]
    names += ["data:;base64," + "A" * 5, "data:;base64," + "=" * 100, "DATA:,", "http%3A//localhost/x", "a" * 5000]
    return files + [changed("buffers/0/uri", name) for name in names]


def files(outside: list[str]) -> list[tuple[str, bytes]]:
    """All of them, with their extensions."""
    texts = numbers() + nodes() + instances() + skins() + pictures(outside) + packed() + documents(outside)
    return [(".glb", content) for content in containers()] + [(".gltf", content) for content in texts]
