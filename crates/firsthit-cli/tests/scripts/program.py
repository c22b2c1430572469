"""The program under test, for the scripts of this folder, which need nothing but Python and Linux."""

import argparse
import os
import resource
import signal
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[4]
PUBLIC = ROOT.parent / "shared" / "refdata" / "public"

#: The exit codes that a run may end with whatever it is given: done, bad input, output, limit.
ORDERLY = {0, 3, 4, 5}

#: The exit code where memory runs out, or another limit is reached.
LIMIT = 5

#: What the standard library adds to `memory allocation of N bytes failed`; no program can turn it off.
SECOND_LINE = "note: run with `RUST_BACKTRACE=1`"


def arguments(description: str) -> argparse.Namespace:
    """Read the command line that all the scripts share."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("program", type=Path, help="the firsthit program")
    parser.add_argument("--quick", action="store_true", help="a sample instead of everything")
    given = parser.parse_args()
    given.program = given.program.resolve()
    return given


class Ended:
    """How a run of the program ended."""

    def __init__(self, code: int, stderr: str) -> None:
        self.code = code
        self.lines = stderr.splitlines()

    def disorder(self) -> str:
        """Say what is wrong with the ending, if anything."""
        if self.code not in ORDERLY:
            return f"exit code {self.code}: {self.lines[-1:]}"
        others = [line for line in self.lines if not line.startswith("firsthit: warning: ")]
        if self.code == LIMIT:
            others = [line for line in others if not line.startswith(SECOND_LINE)]
        if self.code == 0 and others:
            return f"done, and said {others}"
        if self.code != 0 and len(others) != 1:
            return f"not one line: {others}"
        if any(not char.isprintable() for line in self.lines for char in line):
            return f"control characters: {self.lines}"
        return ""


def run(command: list, folder: Path, *, memory: int = 0, seconds: float = 60) -> Ended:
    """Run a command in a folder, with so many bytes of address space if any number is given."""

    def limit() -> None:
        os.setpgrp()
        if memory:
            resource.setrlimit(resource.RLIMIT_AS, (memory, memory))

    # Where memory runs out, the standard library would print a trace of many lines for this variable.
    environment = {name: value for name, value in os.environ.items() if name != "RUST_BACKTRACE"}
    process = subprocess.Popen(
        [str(word) for word in command],
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        preexec_fn=limit,
    )
    try:
        _, stderr = process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        # The group: what a tracer runs would go on without it.
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        return Ended(-1, f"still running after {seconds} s")
    return Ended(process.returncode, stderr.decode(errors="replace"))
