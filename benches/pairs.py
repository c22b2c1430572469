"""Measure two builds of firsthit-bench against each other, frame by frame.

    python benches/pairs.py OLD/firsthit-bench NEW/firsthit-bench --scenes bunny --rows primary

For each row it prints the median of the ratios of neighbouring times, new divided by old (below 1:
the new one is faster), and the quartiles. A shared machine may change its speed by a third within
a minute; from one frame to the next it hardly does, so that two hundredths show in half a minute.
"""

import argparse
import os
import statistics
import subprocess
import sys


class Build:
    """A running firsthit-bench that waits to be asked."""

    def __init__(self, program: str, arguments: list[str]) -> None:
        command = [program, "--pairs", *arguments]
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1
        )

    def label(self) -> list[str]:
        """Read what can be timed next, as [scene, row]; an empty list at the end."""
        return self.process.stdout.readline().rsplit(maxsplit=1)

    def time(self) -> float:
        """Time it once: nanoseconds for each ray, or for each triangle built."""
        try:
            self.process.stdin.write("run\n")
            answer = self.process.stdout.readline()
        except BrokenPipeError:
            answer = ""
        if not answer:
            sys.exit(f"pairs.py: error: {self.process.args[0]} has stopped")
        return float(answer)

    def go_on(self) -> None:
        """Go on to the next row."""
        self.process.stdin.write("next\n")

    def end(self) -> int:
        """Wait for its end; return its exit code."""
        self.process.stdin.close()
        return self.process.wait()


def main() -> None:
    """Time all rows of both builds in turns, and print a line for each."""
    parser = argparse.ArgumentParser(description="Two builds of firsthit-bench in turns.")
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("--scenes", help="as for firsthit-bench")
    parser.add_argument("--rows", help="as for firsthit-bench, and: build", default="primary")
    parser.add_argument("--folder", help="as for firsthit-bench")
    parser.add_argument(
        "--pairs", type=int, default=60, help="how often each row is timed; builds at most 12 times"
    )
    arguments = parser.parse_args()
    if arguments.pairs < 2:
        parser.error("--pairs must be at least 2")

    # Both on one processor, so that they are disturbed alike.
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    wanted = arguments.rows.split(",")
    rows = [row for row in wanted if row != "build"]
    options = ["--rows", ",".join(rows or ["primary"])]
    for name in ("scenes", "folder"):
        if value := getattr(arguments, name):
            options += [f"--{name}", value]
    builds = [Build(program, options) for program in (arguments.old, arguments.new)]

    while True:
        labels = [build.label() for build in builds]
        if labels[0] != labels[1]:
            # One that has stopped early has said why.
            sys.exit(f"pairs.py: error: not the same scenes and rows: {labels[0]} and {labels[1]}")
        if not labels[0]:
            break
        scene, row = labels[0]
        if row in wanted:
            pairs = min(arguments.pairs, 12) if row == "build" else arguments.pairs
            times = ([], [])
            for pair in range(pairs):
                for k in (0, 1) if pair % 2 == 0 else (1, 0):
                    times[k].append(builds[k].time())
            ratios = [new / old for old, new in zip(*times, strict=True)]
            low, middle, high = statistics.quantiles(ratios, n=4)
            old, new = (min(of_build) for of_build in times)
            print(
                f"{scene:<12}{row:<14}{middle:.3f} ({low:.3f} to {high:.3f})"
                f"   smallest: {old:.1f}, {new:.1f} ns",
                flush=True,
            )
        for build in builds:
            build.go_on()
    sys.exit(max(build.end() for build in builds))


if __name__ == "__main__":
    main()
