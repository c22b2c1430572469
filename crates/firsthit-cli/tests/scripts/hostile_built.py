"""Built scenes that are truncated or changed, for hostile.py."""

import random
import subprocess
from pathlib import Path


def files(program: Path, folder: Path) -> list[tuple[str, bytes]]:
    """Build scenes of small models, and damage them."""
    testdata = Path(__file__).resolve().parents[4] / "testdata"
    changed = [(".fhs", b""), (".fhs", b"\x89fhs\r\n\x1a\n"), (".fhs", b"\x89fhs\r\n\x1a\n" + bytes(99))]
    for model in ("cube_quads_le.ply", "torus_draco.glb", "prism_64gon.obj"):
        built = folder / f"{model}.fhs"
        subprocess.run([program, "build", testdata / model, "-q", "-o", built], check=True)
        changed += damaged(built.read_bytes(), 40)
    return changed


def damaged(content: bytes, count: int) -> list[tuple[str, bytes]]:
    """Return the content as it is, and with a few bytes changed or cut off."""
    chance = random.Random(5)
    made = [content, content[:-64], content + bytes(64), content[: len(content) // 2]]
    start = 64 * (int.from_bytes(content[24:32], "little") + 1)
    start += int.from_bytes(content[80:88], "little")
    for k in range(count):
        wrong = bytearray(content)
        # Mostly beyond the record, whose checksum is always compared.
        first = 0 if k % 8 == 0 else start
        for _ in range(chance.randint(1, 9)):
            at = chance.randrange(first, len(wrong))
            if chance.random() < 0.5:
                wrong[at] = chance.randrange(256)
            else:
                wrong[at : at + 4] = chance.choice([b"\xff" * 4, bytes(4), b"\x00\x00\xc0\x7f"])
        made.append(bytes(wrong[: len(content)]))
    return [(".fhs", wrong) for wrong in made]
