"""Hostile outputs, as `info` and `diff` are given them: damaged, claiming much, or packing much."""

import io
import random
import struct
import subprocess
import zipfile
import zlib
from pathlib import Path

FORMATS = ("exr", "png", "npz", "npy")


def made(program: Path, folder: Path) -> dict[str, bytes]:
    """Make a small picture in each format."""
    files = {}
    for extension in FORMATS:
        channels = ["--channels", "z"] if extension in {"png", "npy"} else ["--channels", "z,normal,object"]
        path = folder / f"good.{extension}"
        command = [program, "demo", "--size", "24x16", "-q", *channels, "-o", path]
        done = subprocess.run(command, capture_output=True, check=False)
        if not path.exists():
            raise SystemExit(f"no {extension} to damage: {done.stderr.decode()}")
        files[extension] = path.read_bytes()
    return files


def npy(descr: str, shape: str, body: bytes = b"", *, length: int = 0) -> bytes:
    """Make an NPY file with the type and shape that it claims."""
    header = f"{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}\n".encode()
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", (length or len(header)) & 0xFFFF) + header + body


def npys() -> list[bytes]:
    """NPY files: shapes, types, pickles."""
    shapes = [
        "(4,)", "()", "(0,)", "(-1,)", "(2147483648, 2147483648)", "(18446744073709551616,)", "(1,)" * 100,
        "(4294967296, 4294967296, 4294967296)", "(1e9,)", "(" + "1," * 60_000 + ")", "(0, 18446744073709551615)", "x",
        "",
    ]  # fmt: skip
    types = [
        "'|O'", "'O8'", "[('a', '<f4')]", "[" * 20_000, "'<f3'", "'<f0'", "'|S9999999999'", "'<U4'", "'<M8[ns]'",
        "'<f16'", "'<c8'", "'|b1'", "'>f8'", "'<f2'", "''", "None", "'|V0'", "'<f4\\x00'",
    ]  # fmt: skip
    files = [npy("'<f4'", shape, bytes(16)) for shape in shapes] + [npy(kind, "(4,)", bytes(64)) for kind in types]
    files.append(npy("'|O'", "(1,)", b"\x80\x03cos\nsystem\nq\x00X\x02\x00\x00\x00idq\x01\x85q\x02Rq\x03."))
    files += [npy("'<f4'", "(4,)", bytes(k)) for k in (0, 15, 17)] + [
        npy("'<f4'", "(4,)", length=k) for k in (1, 65535)
    ]
    return [*files, b"\x93NUMPY", b"\x93NUMPY\x09\x00", b"\x93NUMPY\x02\x00\xff\xff\xff\xff", b"", bytes(100)]


def archive(entries: dict[str, bytes]) -> bytes:
    """Make a ZIP archive."""
    held = io.BytesIO()
    with zipfile.ZipFile(held, "w", zipfile.ZIP_DEFLATED) as packed:
        for name, content in entries.items():
            packed.writestr(name, content)
    return held.getvalue()


def npzs() -> list[bytes]:
    """NPZ files: bombs, names that lead elsewhere, sizes that lie."""
    array = npy("'<f4'", "(4,)", bytes(16))
    bomb = archive({"a.npy": npy("'<f4'", "(134217728,)", bytes(512 << 20))})
    names = ["../x.npy", "/etc/passwd", "a\x1b[2J.npy", "x" * 60_000 + ".npy", "C:\\x.npy", "metadata.json"]
    files = [archive({name: array}) for name in names]
    files += [bomb, archive({f"{k}.npy": array for k in range(20_000)}), archive({"a.npy": bomb}), archive({})]
    files += [archive({"firsthit.json": b"[" * 100_000, "a.npy": array}), archive({"a.npy": b"x"})]
    whole = bytearray(archive({"a.npy": array}))
    for mark, offset in (
        (b"PK\x03\x04", 18),
        (b"PK\x03\x04", 22),
        (b"PK\x01\x02", 20),
        (b"PK\x01\x02", 24),
        (b"PK\x01\x02", 42),
    ):
        lie = bytearray(whole)
        at = lie.index(mark) + offset
        lie[at : at + 4] = b"\xfe\xff\xff\xff"
        files.append(bytes(lie))
    return [*files, bytes(whole[:-1]), b"PK\x05\x06" + b"\xff" * 18, b"PK\x03\x04", b""]


def chunk(kind: bytes, content: bytes) -> bytes:
    """Make a part of a PNG file."""
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))


def pngs() -> list[bytes]:
    """PNG files: sizes, texts that unpack to much."""
    files = []
    packed = zlib.compress(bytes(64 << 20), 9)
    for columns, rows in ((1 << 30, 1 << 30), (65535, 65535), (0, 1), ((1 << 31) - 1, 1), (4, 4), (8192, 2047)):
        for depth, color in ((16, 0), (8, 2), (16, 6), (3, 9)):
            header = struct.pack(">IIBBBBB", columns, rows, depth, color, 0, 0, 0)
            parts = [chunk(b"IHDR", header), chunk(b"IDAT", packed), chunk(b"IEND", b"")]
            files.append(b"\x89PNG\r\n\x1a\n" + b"".join(parts))
    header = chunk(b"IHDR", struct.pack(">IIBBBBB", 1, 1, 8, 0, 0, 0, 0))
    body = chunk(b"IDAT", zlib.compress(bytes(2))) + chunk(b"IEND", b"")
    bomb = zlib.compress(bytes(512 << 20), 9)
    texts = [chunk(b"zTXt", b"firsthit\0\0" + bomb), chunk(b"iTXt", b"firsthit\0\1\0\0\0" + bomb)]
    texts += [chunk(b"tEXt", b"firsthit\0" + b"[" * 100_000), chunk(b"tEXt", b"firsthit\0\x1b[2J")]
    texts.append(chunk(b"iCCP", b"x\0\0" + bomb))
    return files + [b"\x89PNG\r\n\x1a\n" + header + words + body for words in texts] + [b"\x89PNG\r\n\x1a\n", b""]


def exrs(good: bytes) -> list[bytes]:
    """EXR files whose windows and tables lie."""
    files = [b"", good[:4], b"v/1\x01" + bytes(100), b"v/1\x01\x02\x00\x00\x00" + b"\xff" * 1000]
    for window in (b"dataWindow\0", b"displayWindow\0"):
        at = good.index(window) + len(window) + len(b"box2i\0") + 4
        for box in ((0, 0, (1 << 31) - 1, (1 << 31) - 1), (0, 0, -1, -1), (-(1 << 31), 0, 9, 9), (0, 0, 65535, 65535)):
            files.append(good[:at] + struct.pack("<4i", *box) + good[at + 16 :])
    at = good.index(b"channels\0") + len(b"channels\0chlist\0")
    files += [good[:at] + struct.pack("<I", size) + good[at + 4 :] for size in (0, 1, 1 << 31, (1 << 32) - 1)]
    for flags in range(0, 32, 2):
        files.append(good[:5] + bytes([flags]) + good[6:])
    return files


def files(program: Path, folder: Path) -> list[tuple[str, bytes]]:
    """All of them, with their extensions."""
    good = made(program, folder)
    lists = {"npy": npys(), "npz": npzs(), "png": pngs(), "exr": exrs(good["exr"])}
    chance = random.Random(5)
    for extension, content in good.items():
        step = max(1, len(content) // 20)
        lists[extension] += [content[:end] for end in range(0, len(content), step)]
        for _ in range(60):
            damaged = bytearray(content)
            for _ in range(chance.randint(1, 4)):
                damaged[chance.randrange(len(damaged))] = chance.randrange(256)
            lists[extension].append(bytes(damaged))
    return [(f".{extension}", content) for extension, several in lists.items() for content in several]
