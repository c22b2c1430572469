"""Render every file of the reference data with little memory: it works, or says in a line why not."""

import csv
import sys
import tempfile
from pathlib import Path

from program import PUBLIC, ROOT, arguments, run

#: So many threads find no room below the largest of these.
MANY_THREADS = [mebibytes << 20 for mebibytes in (40, 72, 147, 210, 330, 570, 1100)]

LIMITS = [64 << 20, 96 << 20, 128 << 20, 192 << 20, 256 << 20, 512 << 20, 1 << 30, 2 << 30]


def main() -> int:
    """Run it; return how many runs ended in disorder."""
    given = arguments(__doc__)
    crowded = threads_that_find_no_room(given.program) + built_scenes(given.program)
    manifest = PUBLIC / "MANIFEST.tsv"
    if not manifest.is_file():
        print("skipped: ../shared is missing")
        return min(crowded, 1)
    with manifest.open(newline="") as lines:
        rows = list(csv.reader((line for line in lines if line[0] != "#"), delimiter="\t"))
    files = [PUBLIC / row[0] for row in rows if (PUBLIC / row[0]).is_file()]
    files = sorted(set(files), key=lambda file: file.stat().st_size)
    if given.quick:
        files = files[::12] + files[-1:]
    limits = LIMITS[::3] if given.quick else LIMITS
    wrong, codes = 0, {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file in files:
            for limit in limits:
                command = [given.program, "render", file, "--size", "48x32", "-q", "-o", "out.png"]
                ended = run(command, folder, memory=limit)
                left = {path.name for path in folder.iterdir()}
                expected = {"out.png"} if ended.code == 0 else set()
                problem = ended.disorder() or (left != expected and f"left behind: {left}")
                if problem:
                    wrong += 1
                    print(f"{file.name} with {limit >> 20} MiB: {problem}")
                codes[ended.code] = codes.get(ended.code, 0) + 1
                for path in folder.iterdir():
                    path.unlink()
    print(f"memory: {len(files)} files x {len(limits)} limits, exit codes {codes}, {wrong} wrong")
    return min(wrong + crowded, 1)


def threads_that_find_no_room(program: Path) -> int:
    """Render with many threads and little address space; return how many runs ended in disorder."""
    wrong = 0
    with tempfile.TemporaryDirectory() as name:
        for limit in MANY_THREADS:
            command = [program, "demo", "--size", "64x48", "--samples", "1", "--threads", "64", "-q"]
            ended = run(command, Path(name), memory=limit)
            if ended.disorder():
                wrong += 1
                print(f"64 threads with {limit >> 20} MiB: {ended.disorder()}")
    return wrong


def built_scenes(program: Path) -> int:
    """Build, open and show a built scene under each limit; return how many runs ended in disorder."""
    wrong = 0
    model = ROOT / "testdata" / "torus_draco.glb"
    for limit in LIMITS:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            for command in (
                ["build", model, "-q", "-o", "a.fhs"],
                ["info", "a.fhs"],
                ["render", "a.fhs", "--size", "48x32", "-q", "-o", "out.png"],
            ):
                ended = run([program, *command], folder, memory=limit)
                if ended.disorder():
                    wrong += 1
                    print(f"{command[0]} of a built scene with {limit >> 20} MiB: {ended.disorder()}")
                if ended.code != 0:
                    break
    return wrong


if __name__ == "__main__":
    sys.exit(main())
