"""Fill fuzz/corpus with real files: those of testdata and, if it is there, of ../shared/refdata.

The corpora are not committed: the files' licences differ.
"""

import gzip
import hashlib
import re
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
FOLDERS = [
    HERE.parent / "testdata",
    HERE.parent / "docs",
    HERE.parent.parent / "shared" / "refdata" / "public",
]
PROGRAM = HERE.parent / "target" / "release" / "firsthit"
#: Larger files make each run of a fuzzer slow, and teach it little.
LARGEST = 64 << 10

#: For each target the extensions of its files.
TARGETS = {
    "ply": {"ply"},
    "stl": {"stl"},
    "off": {"off"},
    "obj": {"obj"},
    "texture": {"png", "jpg", "jpeg", "webp", "bmp", "tga", "tif", "tiff", "gif"},
    "environment": {"hdr", "exr"},
    "gzip": {"stl"},
    "gltf": {"gltf", "glb"},
    "scene_file": {"toml"},
    "fhs": {"fhs"},
    "output": {"exr", "png", "npz", "npy"},
    "points": {"ply", "pcd", "las", "xyz", "txt", "asc", "csv", "npz", "npy"},
    "http": {"http"},
}


def with_library(path: Path, content: bytes) -> bytes:
    """Append the material library that an OBJ file names, as the target expects it."""
    named = re.search(rb"^mtllib[ \t]+(.+?)\s*$", content, re.MULTILINE)
    library = path.parent / named[1].decode(errors="replace") if named else path
    if named is None or not library.is_file():
        return content
    start, end = named.span()
    return b"".join(
        [content[:start], b"mtllib a.mtl", content[end:], b"\n#mtl\n", library.read_bytes()]
    )


def built(folder: Path) -> None:
    """Build small files of several formats, if the program is built."""
    if not PROGRAM.is_file():
        print("fhs: no target/release/firsthit to make seeds with")
        return
    for folder_of in FOLDERS[:2]:
        for path in folder_of.rglob("*"):
            if path.suffix in {".glb", ".obj", ".ply", ".stl", ".toml"}:
                output = folder / f"{path.name}.fhs"
                subprocess.run([PROGRAM, "build", path, "-q", "-o", output], check=False)


def outputs(folder: Path) -> None:
    """Render small outputs of every format, if the program is built."""
    if not PROGRAM.is_file():
        print("output: no target/release/firsthit to make seeds with")
        return
    demo = [PROGRAM, "demo", "--quiet", "--size", "9x7", "--samples", "1"]
    channels = ["--channels", "color,z,object,normal,front"]
    for name in ("a.exr", "a.npz"):
        subprocess.run([*demo, "--output", folder / name, *channels], check=True)
    for name in ("a.npy", "a.png"):
        subprocess.run([*demo, "--output", folder / name], check=True)
    depth = [*demo, "--channels", "z", "--output"]
    subprocess.run([*depth, folder / "z.png", "--png-scale", "0.001"], check=True)
    subprocess.run([*depth, folder / "z.npy"], check=True)


def environments(folder: Path) -> None:
    """Write small environment maps: packed in the new way, in the old one, and not at all."""
    head = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n"
    new = bytes([2, 2, 0, 9, 137, 7, 9, *range(9), 137, 0, 137, 129])
    old = bytes([7, 7, 7, 129, 1, 1, 1, 2, 1, 1, 1, 1])
    plain = bytes(range(60, 84))
    for name, size, content in (
        ("new.hdr", b"-Y 2 +X 9\n", 2 * new),
        ("old.hdr", b"-Y 1 +X 259\n", old),
        ("plain.hdr", b"+X 3 -Y 2\n", plain),
    ):
        (folder / name).write_bytes(head + size + content)


def requests(folder: Path) -> None:
    """Write requests as a page sends them, alone and one after the other."""
    get = b"GET /main.js HTTP/1.1\r\nHost: 127.0.0.1:80\r\nSec-Fetch-Site: same-origin\r\n\r\n"
    head = b"POST /probe HTTP/1.1\r\nHost: localhost:80\r\nX-Firsthit-Token: 0\r\nContent-Length: 2"
    for number, bytes_ in enumerate((get, head + b"\r\n\r\n{}", get + head + b"\r\n\r\n{}" + get)):
        (folder / f"{number}.http").write_bytes(bytes_)


def main() -> None:
    """Write the seeds of all targets, or of those that are named."""
    with tempfile.TemporaryDirectory() as made:
        outputs(Path(made))
        built(Path(made))
        environments(Path(made))
        requests(Path(made))
        seed([*FOLDERS, Path(made)])


def seed(folders: list[Path]) -> None:
    """Copy the files of these folders into the corpora that take their extensions."""
    files = [path for folder in folders for path in folder.rglob("*") if path.is_file()]
    for target in sys.argv[1:] or TARGETS:
        corpus = HERE / "corpus" / target
        corpus.mkdir(parents=True, exist_ok=True)
        for path in files:
            if path.suffix[1:].lower() not in TARGETS[target] or path.stat().st_size > LARGEST:
                continue
            content = path.read_bytes()
            if target == "obj":
                content = with_library(path, content)
            if target == "gzip":
                content = gzip.compress(content, mtime=0)
            (corpus / hashlib.sha256(content).hexdigest()[:16]).write_bytes(content)
        print(f"{target}: {len(list(corpus.iterdir()))} seeds")


if __name__ == "__main__":
    main()
