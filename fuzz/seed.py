"""Fill fuzz/corpus with real files: those of testdata and, if it is there, of ../shared/refdata.

The corpora are not committed: the files' licences differ.
"""

import gzip
import hashlib
import re
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
FOLDERS = [HERE.parent / "testdata", HERE.parent.parent / "shared" / "refdata" / "public"]
#: Larger files make each run of a fuzzer slow, and teach it little.
LARGEST = 64 << 10

#: For each target the extensions of its files.
TARGETS = {
    "ply": {"ply"},
    "stl": {"stl"},
    "obj": {"obj"},
    "texture": {"png", "jpg", "jpeg", "webp", "bmp", "tga"},
    "gzip": {"stl"},
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


def main() -> None:
    """Write the seeds of all targets, or of those that are named."""
    files = [path for folder in FOLDERS for path in folder.rglob("*") if path.is_file()]
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
