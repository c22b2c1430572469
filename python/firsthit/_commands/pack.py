"""``firsthit pack``: the parts of a job as tar files for training."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from firsthit.many import pack

from ._program import Parser, output_of, progress_of, run
from ._words import count, size, whole

if TYPE_CHECKING:
    import argparse
    from collections.abc import Sequence

_ABOUT = """\
Pack the parts of a job, or the frames of a data set, into tar files that
WebDataset reads: shard-000000.tar and so on.

A sample is a picture, the hits of a part, or what one sensor sees in a frame.
Its files have one key and follow each other, with its record as KEY.json.
The same parts come to the same bytes, and the sha256 of every file is compared
with its record. A run that was stopped goes on."""

_EXAMPLES = """\
Examples:
  firsthit pack out/ -o shards/
  firsthit pack out/ -o shards/ --size 300
  firsthit pack out/ -o shards/ --parts 100 --partial

docs/datasets.md has what is in a tar file.

Exit codes: 0 done, 2 wrong usage, 3 a folder that is that of no job, or parts
that are missing or damaged, 4 the output could not be written, or its folder
has something else in it, 70 a bug in firsthit, 130 interrupted."""

_MEGABYTE = 1_000_000


def main(argv: Sequence[str]) -> int:
    """Run the command with the arguments behind its name; return the exit code."""
    return run(argv, _parser(), _work)


def _parser() -> Parser:
    parser = Parser("pack", _ABOUT, _EXAMPLES)
    add = parser.add_argument
    add("folder", metavar="FOLDER", help="the folder of the job")
    add(
        "-o",
        "--output",
        metavar="SHARDS",
        help="the folder of the tar files; it is made if it is not there",
    )
    how = parser.add_mutually_exclusive_group()
    how.add_argument(
        "--size",
        metavar="MB",
        type=whole(1),
        default=1000,
        help="the most megabytes, of 10^6 bytes, of a tar file with more than one sample "
        "[default: 1000]",
    )
    how.add_argument(
        "--parts", metavar="N", type=whole(1), help="how many parts, or frames, a tar file is of"
    )
    add(
        "--partial",
        action="store_true",
        help="pack what is there while other parts are missing",
    )
    return parser


def _work(arguments: argparse.Namespace) -> tuple[str | None, dict[str, Any]]:
    output = output_of(arguments, "pack")
    made = pack(
        arguments.folder,
        output,
        size=arguments.size * _MEGABYTE,
        parts=arguments.parts,
        partial=arguments.partial,
        progress=progress_of(arguments),
    )
    text = f"{output}: {count(made.samples, 'sample')} of {count(made.parts, 'part')}"
    text += f" in {count(len(made.shards), 'tar file')}, {size(made.bytes)}"
    if made.missing:
        text += f"; {count(made.missing, 'part')} missing"
    report = {
        "output": output,
        **made._asdict(),
        "shards": [path.name for path in made.shards],
    }
    return None if arguments.quiet else text, report
