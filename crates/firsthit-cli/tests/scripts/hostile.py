"""Feed the program hundreds of files that attack: each is read or refused in one line, and opens nothing else."""

import gzip
import math
import random
import re
import shutil
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

import hostile_built
import hostile_gltf
import hostile_outputs
import hostile_scenes
from program import Ended, arguments, run

MEMORY = 1 << 30
SECONDS = 60
XYZ = "property float x\nproperty float y\nproperty float z\n"
LIST = "property list uchar int vertex_indices\n"
TRIANGLE = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
OUTSIDE = [
    "/etc/passwd", "../../../../etc/passwd", "file:///etc/passwd", "http://localhost/x",
    "a/../../../etc/passwd", "\\\\host\\share", "C:\\x", "C:/x", "%2e%2e/%2e%2e/etc/passwd",
    "/dev/zero", "/dev/stdin", "/proc/self/environ", "./../x", "a\0/etc/passwd", "~/.profile",
    "data:,x", "//host/x", "link", "loop", "pipe", ".", "", "sub/", "\x1b[2J", "\u202egnp.exe",
]  # fmt: skip


def ply(header: str, body: bytes = b"", kind: str = "binary_little_endian") -> bytes:
    """Put a PLY file together."""
    return f"ply\nformat {kind} 1.0\n{header}end_header\n".encode() + body


def square(face: str, kind: str = "ascii") -> bytes:
    """Four vertices, and a row of a face as text."""
    header = f"element vertex 4\n{XYZ}element face 1\n{LIST}"
    return ply(header, f"0 0 0\n1 0 0\n1 1 0\n0 1 0\n{face}\n".encode(), kind)


def stl(count: int, facets: bytes) -> bytes:
    """Make a binary STL with the count that it claims."""
    return bytes(80) + struct.pack("<I", count % (1 << 32)) + facets


def plys() -> list[bytes]:
    """PLY files that lie about counts, types and indices."""
    counts = [-1, 1 << 31, (1 << 31) - 1, 1 << 32, 1 << 40, (1 << 63) - 1, 1 << 63, 1 << 64, 10**30]
    files = []
    for count in counts:
        for kind in ("ascii", "binary_little_endian", "binary_big_endian"):
            files.append(ply(f"element vertex {count}\n{XYZ}", bytes(24), kind))
            files.append(ply(f"element nothing {count}\nelement vertex 1\n{XYZ}", bytes(12), kind))
        files.append(ply(f"element vertex 0\n{XYZ}element face {count}\n{LIST}", bytes(64)))
        files.append(ply(f"element x {count}\nproperty list uint double y\n{XYZ}", b"\xff" * 64))
    faces = [
        "3 0 1 4", "3 0 1 -1", "-1", "3 0 1", "3 0 1 1e300", "3 0 1 nan", "3 0 1 1.5", "255 0 1 2",
        "3 0 1 99999999999999999999", "4294967295 0 1 2", "3 0x0 1 2", "", "3 0 1 2 3 4 5", "0",
        "1 0", "2 0 1", "1e9 0 1 2", "3 0 0 0", "nan 0 1 2", "inf",
    ]  # fmt: skip
    files += [square(face) for face in faces]
    files += [square("3 0 1 2", kind) for kind in ("binary_little_endian", "", "ebcdic")]
    files += [ply(f"element vertex 1\n{XYZ}" * 2, bytes(24)), ply("property float x\n"), b"ply\n"]
    files += [ply(f"element vertex 1\nproperty {kind} x\n", bytes(9)) for kind in ("", "list", "int128")]
    files.append(ply("comment " + "end_header " * 9 + "\n" + f"element vertex 1\n{XYZ}", bytes(12)))
    files.append(ply("".join(f"element e{k} 0\n" for k in range(50_000)) + f"element vertex 1\n{XYZ}", bytes(12)))
    files.append(ply("element vertex 1\n" + XYZ + "".join(f"property uchar p{k}\n" for k in range(50_000)), bytes(99)))
    for name in OUTSIDE:
        header = f"comment TextureFile {name}\nelement vertex 3\n{XYZ}element face 1\n{LIST}"
        files.append(ply(header, b"0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "ascii"))
    return files


def offs() -> list[bytes]:
    """OFF files that lie about counts and indices."""
    counts = [-1, 1 << 31, (1 << 31) - 1, 1 << 32, 1 << 40, (1 << 63) - 1, 1 << 63, 1 << 64, 10**30]
    files = [
        f"{kind}\n{count} {other} 0\n0 0 0\n".encode()
        for count in counts
        for kind in ("OFF", "STCN4nOFF")
        for other in (0, 1, count)
    ]
    faces = [
        "3 0 1 4", "3 0 1 -1", "-1", "3 0 1", "3 0 1 nan", "3 0 1 1.5", "255 0 1 2", "4294967295 0 1 2",
        "3 0 1 99999999999999999999",
        "", "0", "1 0", "2 0 1", "1e9 0 1 2", "3 0 0 0", "3 0 1 2 7", "3 0 1 2 1e300 -1 nan", "3 0 1 2 # 3",
    ]  # fmt: skip
    files += [f"OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n{face}\n".encode() for face in faces]
    ring = "\n".join(f"{math.cos(k)} {math.sin(k)} 0" for k in range(65_536))
    files.append(f"OFF\n65536 1 0\n{ring}\n65536 {' '.join(map(str, range(65_536)))}\n".encode())
    return [
        *files,
        b"OFF",
        b"OFF BINARY\n" + b"\xff" * 99,
        b"OFF\n" + b"#" * 99,
        b"OFF" * 999,
        b"OFF 0 0 0",
        b"OFF\n1 1\n",
    ]


def stls() -> list[bytes]:
    """STL files, binary and text."""
    facet = struct.pack("<12fH", *([0] * 4), 1, 0, 0, 0, 1, 0, 0, 0, 0)[:50].ljust(50, b"\0")
    files = [stl(count, facet) for count in (0, 2, 1 << 31, (1 << 32) - 1, 85899346)]
    files += [stl(1, facet[:k]) for k in range(0, 50, 7)]
    for value in (math.nan, math.inf, -math.inf, 1e30, 3e38, 1e-45):
        files.append(stl(1, struct.pack("<12fH", 0, 0, 1, value, 0, 0, 1, 0, 0, 0, 1, 0, 0)))
    texts = [
        "solid", "solid x\nfacet", "solid\nfacet\nvertex 1 2 3\nendfacet", "solid\nvertex 1 2 3",
        "solid\nfacet\nfacet", "solid\nendfacet", "solid\nfacet\n" + "vertex 0 0 0\n" * 17 + "endfacet",
        "solid\nfacet\nvertex 1 2\nendfacet", "solid\nfacet\nvertex 1 2 x\n", "solid " + "x" * 100_000,
        "solid \x1b[2J\nendsolid", "facet\n" * 1000, "\n" * 100_000, " " * 100_000,
    ]  # fmt: skip
    return files + [text.encode() for text in texts] + [b"", b"s", bytes(83), bytes(84), b"\xff\xfes\0"]


def objs() -> list[bytes]:
    """OBJ files: indices, names, statements that never end, and material libraries elsewhere."""
    words = [
        "0", "5", "-5", "99999999999999999999", "-99999999999999999999", "1e3", "x", "1/", "1/1", "1//1",
        "1/2/3/4", "//", "/", "1/-1", "2147483648", "4294967296", "4294967297", "-9223372036854775808",
        "\x00", "\u0661", "1.0", "+1", "0x1", "",
    ]  # fmt: skip
    files = [TRIANGLE + f"f 1 2 {word}\n".encode() for word in words]
    files += [TRIANGLE + f"v 0 0 {word}\nf 1 2 4\n".encode() for word in ("nan", "-inf", "1e30", "1e999", "x", "")]
    files += [b"\\\n" * 100_000, b"f " + b"1 " * 100_000, b"v 0 0 0\nf " + b"1 " * 100_000 + b"\n"]
    files += [b"#" * 1_000_000, b"v" * 1_000_000, b"v 1 2\n", b"f", b"\0" * 10_000, b"\r" * 10_000, b"f 1 2 3\n"]
    files += [TRIANGLE.decode().encode("utf-16"), TRIANGLE[:-1], b"\xff\xfe" + b"v\0", b"\xef\xbb\xbf"]
    for name in OUTSIDE:
        files.append(f"mtllib {name}\n".encode() + TRIANGLE)
        files.append(b"mtllib own.mtl\nusemtl m\n" + TRIANGLE + f"#mtl\nnewmtl m\nmap_Kd {name}\n".encode())
    many = "".join(f"o n{k}\nusemtl m{k}\nf 1 2 3\n" for k in range(90_000))
    corners = 65_536
    ring = "".join(
        f"v {math.cos(2 * math.pi * k / corners) * (1 + k % 2)} {math.sin(2 * math.pi * k / corners) * (1 + k % 2)} 0\n"
        for k in range(corners)
    )
    star = ring + "f " + " ".join(str(k + 1) for k in range(corners)) + "\n"
    return [*files, TRIANGLE + many.encode(), star.encode(), b"mtllib a\n" * 90_000 + TRIANGLE]


def packed() -> list[bytes]:
    """Gzipped files that are cut, damaged, or larger than they look."""
    whole = gzip.compress(TRIANGLE)
    files = [whole[:k] for k in range(2, len(whole), 5)]
    files += [whole + b"garbage", whole + bytes(100), whole * 3, gzip.compress(whole), b"\x1f\x8b" * 9]
    return [*files, gzip.compress(bytes(300 << 20), 1)]


def damaged(count: int) -> list[tuple[str, bytes]]:
    """Good files with a few bytes changed, cut or repeated."""
    chance = random.Random(4)
    folder = Path(__file__).resolve().parents[4] / "testdata"
    good = sorted(path for path in folder.iterdir() if path.suffix in {".ply", ".stl", ".obj"})
    files = []
    for k in range(count):
        path = good[k % len(good)]
        content = bytearray(path.read_bytes())
        for _ in range(chance.randint(1, 6)):
            at = chance.randrange(len(content))
            match chance.randrange(4):
                case 0:
                    content[at] = chance.randrange(256)
                case 1:
                    content[at : at + 4] = b"\xff" * 4
                case 2:
                    del content[at : at + chance.randint(1, 40)]
                case 3:
                    content[at:at] = content[at : at + 40]
            if not content:
                break
        files.append((path.suffix, bytes(content)))
    return files


def prepared(folder: Path, suffix: str, content: bytes) -> Path:
    """Write a file among the traps: links out of the folder, a loop, a pipe."""
    scene = folder / f"a{suffix}"
    if b"#mtl\n" in content:
        content, library = content.split(b"#mtl\n")
        (folder / "own.mtl").write_bytes(library)
    scene.write_bytes(content)
    (folder / "tri.obj").write_bytes(TRIANGLE)
    (folder / "link").symlink_to("/etc/passwd")
    (folder / "loop").symlink_to("loop")
    (folder / "sub").mkdir()
    subprocess.run(["mkfifo", folder / "pipe"], check=True)
    return scene


#: What the program and the system's libraries read of themselves.
OWN = re.compile(r"^(/etc/ld\.so|/lib|/usr/lib|/proc/(self|thread-self|\d+|sys/vm)/|/sys/|/dev/(null|tty)$)")


def strangers(trace: Path, folder: Path) -> set[str]:
    """List the files that were opened outside the folder, by a trace of system calls."""
    opened = re.findall(r'open(?:at)?\([^"]*"([^"]*)"[^\n]*= \d+', trace.read_text(errors="replace"))
    inside = str(folder)
    paths = {path if path.startswith("/") else f"{inside}/{path}" for path in opened}
    return {path for path in paths if not path.startswith(inside) and not OWN.match(path)}


def attack(program: Path, folder: Path, suffix: str, content: bytes) -> tuple[Ended, str]:
    """Give the program a hostile file; say how it ended and what is wrong with that."""
    scene = prepared(folder, suffix, content)
    names = {path.name for path in folder.iterdir()}
    trace = folder.parent / "trace"
    is_output = suffix[1:] in hostile_outputs.FORMATS
    command = [program, "render", scene.name, "--size", "16x12", "-q", "-o", "out.png"]
    if suffix == ".toml":
        command = [program, "render", scene.name, "-q", "-o", "out.png"]
    if is_output:
        command = [program, "info", scene.name]
        if len(content) % 2:
            command = [program, "diff", scene.name, scene.name]
    if shutil.which("strace"):
        tracer = ["strace", "-f", "--seccomp-bpf", "-qq", "-e", "trace=open,openat,connect,socket"]
        command = [*tracer, "-o", trace, *command]
    ended = run(command, folder, memory=MEMORY, seconds=SECONDS)
    left = {path.name for path in folder.iterdir()} - names
    problem = ended.disorder()
    if not problem and left != ({"out.png"} if ended.code == 0 and not is_output else set()):
        problem = f"left behind: {left}"
    if not problem and ended.code != 0 and scene.name not in ended.lines[-1]:
        problem = f"the file is not named: {ended.lines}"
    if not problem and trace.exists():
        text = trace.read_text(errors="replace")
        found = strangers(trace, folder)
        if found or "AF_INET" in text:
            problem = f"opened {found or 'the network'}"
    return ended, problem


def main() -> int:
    """Run it; return 1 if anything ended in disorder."""
    given = arguments(__doc__)
    files = [(".ply", content) for content in plys()]
    files += [(".stl", content) for content in stls()]
    files += [(".off", content) for content in offs()]
    files += [(".obj", content) for content in objs()]
    files += [(".obj.gz", content) for content in packed()]
    files += damaged(100)
    files += hostile_gltf.files(OUTSIDE)
    files += hostile_scenes.files(OUTSIDE)
    with tempfile.TemporaryDirectory() as name:
        files += hostile_outputs.files(given.program, Path(name))
        files += hostile_built.files(given.program, Path(name))
    if given.quick:
        files = files[::8]
    if not shutil.which("strace"):
        print("hostile: skipped: what is opened (strace is not there)")
    wrong, codes = 0, {}
    for index, (suffix, content) in enumerate(files):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name).resolve() / "scene"
            folder.mkdir()
            ended, problem = attack(given.program, folder, suffix, content)
        codes[ended.code] = codes.get(ended.code, 0) + 1
        if problem:
            wrong += 1
            print(f"file {index} ({suffix}, {content[:60]!r}...): {problem}")
    print(f"hostile: {len(files)} files, exit codes {codes}, {wrong} wrong")
    return min(wrong, 1)


if __name__ == "__main__":
    sys.exit(main())
