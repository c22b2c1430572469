"""Make the pictures of docs/gallery.md: `make gallery`, or `make gallery ONLY="chess cornell"`.

The commands are those of the page itself. They run in target/gallery, where the models and copies
of the scene files are, and their pictures come back beside this file.
"""

from __future__ import annotations

import re
import shutil
import struct
import subprocess
import sys
import time
import zlib
from pathlib import Path
from typing import NamedTuple

import firsthit as fh
import models
import numpy as np

HERE = Path(__file__).resolve().parent
PAGE = HERE.with_suffix(".md")
TARGET = HERE.parents[1] / "target" / "gallery"


class Picture(NamedTuple):
    """A picture of the page, and the lines that make it."""

    name: str
    language: str
    lines: str

    def make(self, folder: Path) -> None:
        """Run the lines in a folder that has the models."""
        if self.language == "python":
            subprocess.run([sys.executable, "-c", self.lines], cwd=folder, check=True)
        else:
            line = self.lines.replace("firsthit ", f'"{sys.executable}" -m firsthit ', 1)
            subprocess.run(line, shell=True, cwd=folder, check=True)


def pictures(page: str) -> list[Picture]:
    """Return all pictures of the page, with the block of code that follows each."""
    found = re.findall(
        r"!\[[^]]+\]\(gallery/([a-z-]+\.png)\)\n\n```(sh|python)\n(.*?)\n```", page, re.DOTALL
    )
    return [Picture(*each) for each in found]


def prepare(folder: Path) -> None:
    """Put models and scene files into a folder."""
    models.main(folder)
    for scene in HERE.glob("*.toml"):
        shutil.copy(scene, folder)


def packed(path: Path) -> bytes:
    """Return a PNG with the same pixels and texts, in fewer bytes: the program packs quickly."""
    (pixels,) = (channel.astype(int) for _, channel in fh.Frame.load(path).items())
    padded = np.pad(pixels, ((1, 0), (1, 0), (0, 0)))
    left, above, corner = padded[1:, :-1], padded[:-1, 1:], padded[:-1, :-1]
    a, b, c = np.abs(above - corner), np.abs(left - corner), np.abs(left + above - 2 * corner)
    paeth = np.where((a <= b) & (a <= c), left, np.where(b <= c, above, corner))
    guesses = np.stack([0 * left, left, above, (left + above) // 2, paeth])
    tries = (pixels - guesses).astype("u1").reshape(5, len(pixels), -1)
    kinds = np.abs(tries.astype("i1").astype(int)).sum(-1).argmin(0)
    lines = np.column_stack([kinds, tries[kinds, np.arange(len(pixels))]])
    data = path.read_bytes()
    chunks, place = [], 8
    while place < len(data):
        (length,) = struct.unpack_from(">I", data, place)
        chunks.append((data[place + 4 : place + 8], data[place + 8 : place + 8 + length]))
        place += length + 12
    chunks = [chunk for chunk in chunks if chunk[0] != b"IDAT"]
    chunks.insert(-1, (b"IDAT", zlib.compress(lines.astype("u1").tobytes(), 9)))
    return data[:8] + b"".join(
        struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
        for name, body in chunks
    )


def main() -> None:
    """Make them all, or those that are named."""
    prepare(TARGET)
    only = set(sys.argv[1:])
    for picture in pictures(PAGE.read_text(encoding="utf-8")):
        if not only or Path(picture.name).stem in only:
            start = time.perf_counter()
            picture.make(TARGET)
            data = packed(TARGET / picture.name)
            (HERE / picture.name).write_bytes(data)
            told = f"{len(data) / 1024:.0f} KB, {time.perf_counter() - start:.1f} s"
            print(f"{picture.name}: {told}", flush=True)


if __name__ == "__main__":
    main()
