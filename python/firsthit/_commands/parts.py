"""``firsthit parts``: which parts of a job are there."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from firsthit._parts.folder import in_words
from firsthit.many._parts_of import found

from ._program import Parser, run

if TYPE_CHECKING:
    import argparse
    from collections.abc import Sequence

_ABOUT = """\
Tell which parts of a job are there, and which are missing: of a data set, or of
pictures, first hits or sights that firsthit.render_many, shoot_many or
visible_many make. Nothing is changed."""

_EXAMPLES = """\
Examples:
  firsthit parts out/
  firsthit parts out/ --verify --json
  firsthit parts out/ -q || sbatch again.sh

The digest is that of the whole job. It is the same for any number of runs,
workers, threads and machines.

Exit codes: 0 all parts are there, 1 some are missing, 2 wrong usage, 3 a folder
that is that of no job, 70 a bug in firsthit, 130 interrupted."""

#: The results of each kind of job.
_KINDS = {
    "render": "pictures of cameras",
    "shoot": "first hits of rays",
    "visible": "which points see which",
}

#: Some parts are missing: as `diff` and `lint` have it, the answer is no.
_MISSING = 1


def main(argv: Sequence[str]) -> int:
    """Run the command with the arguments behind its name; return the exit code."""
    answer = 0

    def work(arguments: argparse.Namespace) -> tuple[str | None, dict[str, Any]]:
        nonlocal answer
        text, report = _told(arguments)
        answer = 0 if report["digest"] is not None else _MISSING
        return text, report

    return run(argv, _parser(), work) or answer


def _parser() -> Parser:
    parser = Parser("parts", _ABOUT, _EXAMPLES)
    add = parser.add_argument
    add("folder", metavar="FOLDER", help="the folder of the job")
    add(
        "--verify",
        action="store_true",
        help="compare the bytes of all files with their sha256, not only their sizes",
    )
    return parser


def _told(arguments: argparse.Namespace) -> tuple[str | None, dict[str, Any]]:
    """Return what is in the folder, for people and for programs."""
    job = found(Path(arguments.folder), verify=arguments.verify)
    state = job.state
    kind, noun = _kind(state.job)
    lines = [f"{arguments.folder}: {kind}"]
    if job.is_ended:
        lines.append(f"{noun}: {state.done} of {state.parts} done")
    else:
        lines.append(f"{noun}: {state.done} done; the rays have not come to their end")
    if job.missing:
        lines.append(f"missing: {in_words(job.missing)}")
    if state.digest is not None:
        lines.append(f"digest {state.digest}")
    report = {
        "folder": arguments.folder,
        "kind": state.job.get("kind") if noun == "parts" else "dataset",
        "parts": state.parts if job.is_ended else None,
        "done": state.done,
        "missing": [[one.start, one.stop - 1] for one in job.missing],
        "digest": state.digest,
    }
    return "\n".join(lines), report


def _kind(said: dict[str, Any]) -> tuple[str, str]:
    """Return what a job is of, and what its parts are called."""
    kind, fold = said.get("kind"), said.get("fold")
    if kind is None and "plan" in said:
        return "frames of a data set", "frames"
    text = _KINDS.get(kind, "results of another kind") if isinstance(kind, str) else "results"
    if isinstance(fold, list) and len(fold) == 2:
        text += f", as {' '.join(str(fold[1]).split())}"
    return text, "parts"
