"""``firsthit dataset``: the frames and annotations of a plan."""

from __future__ import annotations

import argparse
import re
import time
from typing import TYPE_CHECKING, Any

from firsthit import _firsthit
from firsthit.datasets import Plan, dataset
from firsthit.datasets._job import checked
from firsthit.many import processes

from ._program import Parser, UsageError, output_of, progress_of, run
from ._words import count, direction, size

if TYPE_CHECKING:
    from collections.abc import Sequence

    from firsthit.datasets._job import Checked

_ABOUT = """\
Make the frames and annotations of a plan: scenes, sensors and poses.

Frames that are there are kept, so a run that was stopped or killed goes on
where it was. The bytes are the same for any number of runs, parts, workers and
threads."""

_EXAMPLES = """\
Examples:
  firsthit dataset plan.toml --check
  firsthit dataset plan.toml -o out/
  firsthit dataset plan.toml -o out/ --part 3/8
  firsthit dataset plan.toml -o out/ --workers 4

docs/datasets.md has the plan's keys, and what is in the folder.

Exit codes: 0 done, 2 wrong usage, 3 bad input, 4 the output could not be
written, or the folder is another job's, 5 a limit was reached, 70 a bug in
firsthit, 130 interrupted."""


def main(argv: Sequence[str]) -> int:
    """Run the command with the arguments behind its name; return the exit code."""
    return run(argv, _parser(), _work)


def _parser() -> Parser:
    parser = Parser("dataset", _ABOUT, _EXAMPLES)
    add = parser.add_argument
    add("plan", metavar="PLAN", help="the plan (TOML)")
    add("-o", "--output", metavar="FOLDER", help="where to write; it is made if it is not there")
    add(
        "--check",
        action="store_true",
        help="make nothing: check the plan and its scenes, and say what the frames come to",
    )
    add(
        "--part",
        metavar="K/N",
        type=_part,
        help="make the K-th of N parts only, K from 1; parts may be made at the same time, on "
        "machines that share the folder, and in any order",
    )
    add(
        "--verify",
        action="store_true",
        help="compare the bytes of frames that are there with their sha256, not only their sizes",
    )
    add(
        "--workers",
        metavar="N",
        type=_threads,
        help="make frames in N processes at the same time, each with the scene; pays where a frame "
        "does not keep all cores busy",
    )
    add(
        "--threads",
        metavar="N",
        type=_threads,
        help="the number of threads, with --workers of each; the result is the same for any "
        "[default: all cores, with --workers cores / N]",
    )
    return parser


def _work(arguments: argparse.Namespace) -> tuple[str | None, dict[str, Any]]:
    if arguments.check:
        for name in ("output", "part", "verify", "workers"):
            if getattr(arguments, name):
                raise UsageError(f"--check makes nothing: leave out --{name}")
        return _checked(Plan.load(arguments.plan), arguments)
    output, began = output_of(arguments, "dataset"), time.monotonic()
    threads, workers = arguments.threads, arguments.workers
    if workers is not None and threads is None:
        threads = max(1, _firsthit.all_threads() // workers)
    made = dataset(
        arguments.plan,
        output,
        on=None if workers is None else processes(workers),
        part=arguments.part,
        threads=threads,
        verify=arguments.verify,
        progress=progress_of(arguments),
    )
    text = f"{output}: {count(made.made, 'frame')} made, {made.kept} kept"
    text += f", {made.missing} missing" if made.missing else f", all {made.frames} there"
    if made.digest is not None:
        text += f"\ndigest {made.digest}"
    seconds = round(time.monotonic() - began, 3)
    report = {"output": output, **made._asdict(), "seconds": seconds}
    return None if arguments.quiet else text, report


def _checked(plan: Plan, arguments: argparse.Namespace) -> tuple[str | None, dict[str, Any]]:
    scenes = checked(plan, arguments.threads)
    cost = plan.cost()
    lines = [
        f"{count(plan.frames, 'frame')}: {count(len(plan.scenes), 'scene')}, "
        f"{count(plan.poses_per_scene, 'pose')} each",
        f"sensors: {', '.join(plan.sensors)}",
        f"rays: {cost.rays}",
        f"bytes: at most about {size(cost.bytes)} without annotations",
        *_ups(plan, scenes),
    ]
    report = {
        "frames": plan.frames,
        "poses_per_scene": plan.poses_per_scene,
        "scenes": [
            {"name": name, **one.mark._asdict(), "up": list(one.up), "up_source": one.up_source}
            for name, one in zip(plan.scenes, scenes, strict=True)
        ],
        "sensors": list(plan.sensors),
        "rays": cost.rays,
        "bytes": cost.bytes,
        "plan": plan.digest,
    }
    return "\n".join(lines), report


def _ups(plan: Plan, scenes: Sequence[Checked]) -> list[str]:
    """Return lines on which way is up: one if it is the same in all scenes, else one for each."""
    said = [f"{direction(one.up)} ({one.up_source})" for one in scenes]
    if len(set(said)) == 1:
        return [f"up: {said[0]}"]
    return [f"up in {name}: {words}" for name, words in zip(plan.scenes, said, strict=True)]


def _part(text: str) -> tuple[int, int]:
    found = re.fullmatch(r"([0-9]{1,9})/([0-9]{1,9})", text)
    k, n = (int(each) for each in found.groups()) if found else (0, 0)
    if not 1 <= k <= n:
        raise argparse.ArgumentTypeError(f"{text!r} is not K/N with K from 1 to N, such as 3/8")
    return k, n


def _threads(text: str) -> int:
    if not re.fullmatch(r"[0-9]{1,4}", text) or not 1 <= int(text) <= 1024:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from 1 to 1024")
    return int(text)
