"""Kill the program at random moments, fill the disk, take away the right to write: the old picture stays whole."""

import contextlib
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from program import arguments, run

#: A small picture, so that much of the time of a run is the writing; its channels fit every format.
PICTURE = ["demo", "--size", "320x200", "--samples", "1", "-q"]
FORMATS = ["png", "npy", "npz", "exr"]
KILLS = 200
#: The name of a file that is not yet complete, as docs/outputs.md promises it.
TEMPORARY = re.compile(r"\.(old\.[a-z]+(?:\.json)?)\.\w{6}\.tmp")


def known_formats(program: Path, folder: Path) -> list[str]:
    """Say which formats this program writes."""
    known = []
    for name in FORMATS:
        ended = run([program, *PICTURE, "-o", f"old.{name}"], folder)
        if ended.code == 0:
            known.append(name)
    return known


def kills(program: Path, folder: Path, count: int) -> list[str]:
    """Kill renders over an old picture; say what was found torn."""
    wrong = []
    seed = int(time.time())
    moments = random.Random(seed)
    for name in known_formats(program, folder):
        picture = folder / f"old.{name}"
        run([program, *PICTURE, "-o", picture], folder)
        new = picture.read_bytes()
        started = time.monotonic()
        run([program, *PICTURE, "-o", picture], folder)
        usual = time.monotonic() - started
        remains = 0
        for _ in range(count):
            picture.write_bytes(b"old")
            child = subprocess.Popen([program, *PICTURE, "-o", picture], cwd=folder)
            time.sleep(moments.uniform(0, 1.1 * usual))
            child.kill()
            child.wait()
            if picture.read_bytes() not in {b"old", new}:
                wrong.append(f"{name}, seed {seed}: torn")
            left = [path for path in folder.iterdir() if path.name.startswith(".")]
            remains += len(left)
            # Where the file system has no nameless files, a kill leaves what was being written: one file for each
            # that the run makes, an array and its metadata.
            of = [match and match[1] for match in (TEMPORARY.fullmatch(path.name) for path in left)]
            if None in of or len(set(of)) < len(of):
                wrong.append(f"{name}, seed {seed}: one kill left {[path.name for path in left]}")
            for path in left:
                path.unlink()
        print(f"torn: {count} kills over a .{name}, {remains} temporary files left")
    return wrong


def contents(folder: Path) -> dict[str, bytes]:
    """Read all old files."""
    return {path.name: path.read_bytes() for path in folder.glob("old.*")}


def refusals(command: list, folder: Path, what: str, prepare=None) -> list[str]:
    """Render over old pictures where that must fail; say what is wrong."""
    wrong = []
    # What stands beside a picture to describe it (`old.npy.json`) must stay as it is too.
    pictures = [picture for picture in sorted(folder.glob("old.*")) if picture.suffix != ".json"]
    for picture in pictures:
        before = contents(folder)
        done = subprocess.run(
            [*command, *PICTURE, "-o", str(picture)],
            cwd="/",
            capture_output=True,
            text=True,
            preexec_fn=prepare,
            check=False,
        )
        if done.returncode != 4 or len(done.stderr.splitlines()) != 1:
            wrong.append(f"{what}, {picture.name}: {done.returncode} {done.stderr!r}")
        if contents(folder) != before:
            wrong.append(f"{what}, {picture.name}: an old file has changed")
        if any(path.name.startswith(".") for path in folder.iterdir()):
            wrong.append(f"{what}, {picture.name}: a temporary file is left")
    print(f"torn: {what}: {len(pictures)} formats")
    return wrong


def short_files() -> None:
    """Let no file grow: to the program that looks like a disk without room."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
    # Ignored, the signal becomes the error that a full disk is.
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)


def full_disk(program: Path, folder: Path) -> list[str]:
    """Fill a small file system; where none can be mounted, limit the files' size only."""
    wrong = refusals([program], folder, "files that cannot grow", short_files)
    disk = folder / "disk"
    disk.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", disk], capture_output=True, check=False)
    if mounted.returncode != 0:
        print("torn: skipped: a full disk (no right to mount one)")
        return wrong
    try:
        for picture in folder.glob("old.*"):
            shutil.copy(picture, disk / picture.name)
            (disk / picture.name).write_bytes(picture.read_bytes()[:100])
        with (disk / "filler").open("wb", buffering=0) as filler, contextlib.suppress(OSError):
            while True:
                filler.write(bytes(4096))
        wrong += refusals([program], disk, "a full disk")
    finally:
        subprocess.run(["umount", disk], check=True)
    return wrong


def read_only(program: Path, folder: Path) -> list[str]:
    """Take the right to write to the folder away; from root it can only be taken by another user."""
    command = [program]
    if os.geteuid() == 0:
        command = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups", program]
        copied = folder / "firsthit"
        shutil.copy(program, copied)
        command[-1] = copied
        if subprocess.run([*command, "--version"], capture_output=True, check=False).returncode:
            print("torn: skipped: a read-only folder (cannot become another user)")
            return []
    folder.chmod(0o555)
    try:
        return refusals(command, folder, "a read-only folder")
    finally:
        folder.chmod(0o755)


def main() -> int:
    """Run it; return 1 if anything was torn."""
    given = arguments(__doc__)
    wrong = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folder.chmod(0o755)
        wrong += kills(given.program, folder, 8 if given.quick else KILLS)
        wrong += full_disk(given.program, folder)
        (folder / "disk").rmdir()
        wrong += read_only(given.program, folder)
    for line in wrong:
        print(line)
    print(f"torn: {len(wrong)} wrong")
    return min(len(wrong), 1)


if __name__ == "__main__":
    sys.exit(main())
