"""Change job folders at random, and go on with the job: it is refused, or has the same digest.

python mutations.py 10000
"""

from __future__ import annotations

import os
import random
import shutil
import sys
import tempfile
import warnings
from collections import Counter
from pathlib import Path

import firsthit as fh

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))
from many_support import cameras, rays, scene

#: What is in the file that links lead to.
DECOY = "not part of any job\n"

#: What may happen to a file.
CHANGES = (
    *("flip", "flip", "cut", "insert", "digits", "swap"),
    *("empty", "remove", "link", "pipe", "folder"),
)


def jobs() -> dict[str, object]:
    """Return what makes a small job of each kind in a folder."""
    world, views, (origins, directions) = scene(), cameras(3), rays(30)
    return {
        "render": lambda out: fh.render_many(world, views, out, channels="z", verify=True),
        "shoot": lambda out: fh.shoot_many(
            world, (origins, directions), out, part_size=10, verify=True
        ),
        "fold": lambda out: fh.shoot_many(
            world, (origins, directions), out, fold=fh.many.Bits(), part_size=16, verify=True
        ),
        "visible": lambda out: fh.visible_many(
            world, origins, directions, out, block=(16, 16), verify=True
        ),
    }


def mutate(out: Path, decoy: Path, chance: random.Random) -> str:
    """Change something in a folder; return what.

    Links lead to the decoy, which is outside of the job's folder and inside of the test's. What is
    a link already is left alone: nothing is written through it.
    """
    paths = sorted(path for path in out.rglob("*") if path.is_file() and not path.is_symlink())
    if not paths:
        return "nothing"
    path = chance.choice(paths)
    content = bytearray(path.read_bytes())
    what = chance.choice(CHANGES)
    at = chance.randrange(len(content)) if content else 0
    if what == "flip" and content:
        content[at] ^= 1 << chance.randrange(8)
    elif what == "cut":
        del content[at : at + chance.randrange(1, 40)]
    elif what == "insert":
        content[at:at] = chance.randbytes(chance.randrange(1, 40))
    elif what == "digits":
        places = [k for k, byte in enumerate(content) if 48 <= byte < 58]
        if places:
            content[chance.choice(places)] = 48 + chance.randrange(10)
    elif what == "swap":
        other = chance.choice(paths)
        content, mine = bytearray(other.read_bytes()), content
        other.write_bytes(mine)
    elif what == "empty":
        content.clear()
    if what == "remove":
        path.unlink()
    elif what == "link":
        path.unlink()
        path.symlink_to(chance.choice((decoy, Path("part.json"), Path("none"))))
    elif what == "pipe":
        path.unlink()
        os.mkfifo(path)
    elif what == "folder":
        path.unlink()
        path.mkdir()
    else:
        path.write_bytes(content)
    return what


def main(count: int) -> None:
    """Try so many changes."""
    chance, outcomes = random.Random(5), Counter()
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as folder:
        clean, digests = Path(folder) / "clean", {}
        decoy = Path(folder) / "decoy"
        decoy.write_text(DECOY)
        made = jobs()
        for name, do in made.items():
            digests[name] = do(clean / name).digest  # type: ignore[operator]
        for number in range(count):
            name = chance.choice(list(made))
            out = Path(folder) / "out"
            shutil.rmtree(out, ignore_errors=True)
            shutil.copytree(clean / name, out)
            what = [mutate(out, decoy, chance) for _ in range(chance.choice((1, 1, 2, 4)))]
            try:
                state = fh.parts(out, verify=True)
                assert state.digest in (None, digests[name]), (number, name, what, state)
            except fh.FileError:
                pass
            try:
                found = made[name](out)  # type: ignore[operator]
            except fh.FileError:
                outcomes["refused"] += 1
                continue
            assert found.digest == digests[name], (number, name, what, found)
            outcomes["made again" if found.made else "untouched"] += 1
        assert decoy.read_text() == DECOY, "something was written through a link"
    print(f"{count} changed folders: {dict(outcomes)}")


if __name__ == "__main__":
    main(int(sys.argv[1]))
