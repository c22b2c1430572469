"""``firsthit scan``: the returns of a laser scanner, as a point cloud."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

import firsthit as fh
from firsthit import _firsthit
from firsthit._base.errors import FileWriteError, warn
from firsthit._base.progress import following, later
from firsthit._base.types import Returns, Rings
from firsthit._lidar.lidar_scan import lacking
from firsthit._lidar.scan import ScanSettings

from ._program import Parser, UsageError, run
from ._scanner import add_place, add_scanner, scanner, with_values
from ._values import memory, named_number, numbers, whole
from ._words import direction, place

if TYPE_CHECKING:
    import argparse
    from collections.abc import Sequence

    from firsthit import Lidar, LidarScan, Scene

    from ._scanner import Scanner

_ABOUT = """\
Scan a 3D file with a laser scanner: points, ranges, rings, times and more of
all returns, as a point cloud."""

_EXAMPLES = """\
Examples:
  firsthit scan city.glb --lidar VLP-16 --position 0,1.8,0
  firsthit scan city.ply --lidar os1-64 --trajectory drive.csv -o drive.las
  firsthit scan part.stl --elevations -25,15,64 --columns 2048 -o part.pcd
  firsthit scan hall.ply --raster 70,40 --rows 96 --columns 160 -o hall.npz
  firsthit scan yard.ply --rosette 38.4 --frequencies 121.6,-77.7 \\
      --points 10000 --point-rate 100000 --turns 5 -o yard.pcd
  firsthit scan wood.obj --lidar HDL-32E --divergence 0.003 --range-gate 0.3 --returns all \\
      --noise 0.02 --seed 1 -o wood.laz -o wood.npz

Lengths are in the unit of the 3D file. Azimuths count from forwards to the
left. docs/sensors.md has the scanners' sources, and what each number of a
return means.

Exit codes: 0 done, 2 wrong usage, 3 bad input, 4 the output could not be
written, 5 a limit was reached, 70 a bug in firsthit, 130 interrupted."""


def main(argv: Sequence[str]) -> int:
    """Run the command with the arguments behind its name; return the exit code."""
    parser = _parser()
    return run(with_values(argv, parser), parser, _work)


def _parser() -> Parser:
    parser = Parser("scan", _ABOUT, _EXAMPLES)
    parser.add_argument(
        "file",
        metavar="FILE",
        help="the 3D file: glTF, GLB, OBJ, PLY, STL or FHS, or a scene file (TOML)",
    )
    add_scanner(parser)
    add_place(parser)
    _add_returns(parser)
    _add_general(parser)
    return parser


def _add_returns(parser: Parser) -> None:
    add = parser.add_argument_group("Returns").add_argument
    add(
        "--returns",
        choices=get_args(Returns),
        default="first",
        help="which returns of a beam are kept; a beam without --divergence has the surfaces that "
        "its line crosses [default: first]",
    )
    add(
        "--max-returns",
        metavar="N",
        type=whole(1),
        help="with --returns all: how many of a beam, the nearest [default: all]",
    )
    add(
        "--divergence",
        metavar="RADIANS",
        type=numbers(1),
        help="the full angle of a beam's cone, such as 0.003 [default: a beam is a line]",
    )
    add(
        "--subrays",
        metavar="N",
        type=whole(1),
        help="how many lines fill the cone of --divergence [default: 16]",
    )
    add(
        "--range-gate",
        metavar="LENGTH",
        type=numbers(1),
        default=[0.0],
        help="hits up to this far behind the nearest of a return belong to it, in scene units "
        "[default: 0]",
    )
    add(
        "--min-range",
        metavar="LENGTH",
        type=numbers(1),
        default=[0.0],
        help="ranges are longer than this, and what is nearer blocks its line, in scene units "
        "[default: 0]",
    )
    add(
        "--max-range",
        metavar="LENGTH",
        type=numbers(1),
        help="the longest range, in scene units [default: no limit]",
    )
    add(
        "--intensity",
        action="store_true",
        help="add an intensity: the surface's luminance times the cosine of incidence",
    )
    add(
        "--rings",
        choices=get_args(Rings),
        default="maker",
        help="how rings count: the maker's numbers, or from the lowest laser on, as drivers of ROS "
        "count [default: maker]",
    )
    add(
        "--class",
        dest="classes",
        metavar="NAME=N",
        type=named_number,
        action="append",
        help="the class of the objects of a name, from 0 to 255, as LAS has it: 2 is ground, 6 a "
        "building; may be given several times",
    )
    add(
        "--noise",
        metavar="SIGMA[,SHARE]",
        type=numbers(1, 2),
        help="the standard deviation of ranges: SIGMA in scene units, plus SHARE of the range; "
        "needs --seed",
    )
    add(
        "--dropout",
        metavar="SHARE",
        type=numbers(1),
        help="the probability that a return is lost, from 0 to 1; needs --seed",
    )
    add(
        "--seed",
        metavar="N",
        type=whole(0),
        help="the seed of --noise and --dropout; turn k, from 0, has the seed N + k",
    )


def _add_general(parser: Parser) -> None:
    add = parser.add_argument_group("General").add_argument
    known = ", ".join(fh.LidarScan.EXTENSIONS)
    add(
        "-o",
        "--output",
        metavar="FILE",
        type=Path,
        action="append",
        help=f"where to write: {known}; may be given several times [default: the name of the 3D "
        "file with -scan.ply]",
    )
    add(
        "--strict",
        action="store_true",
        help="fail where there would be a warning for unusable triangles, or for a text file that "
        "seems to be truncated",
    )
    add(
        "--max-memory",
        metavar="SIZE",
        type=memory,
        default=8 << 30,
        help="the memory that the 3D file's content may take once it is unpacked, in bytes, or "
        "with K, M, G or T for powers of 1024 [default: 8G]",
    )
    add(
        "--threads",
        metavar="N",
        type=whole(1),
        help="the number of threads; the result is the same for any [default: all cores]",
    )
    add("-q", "--quiet", action="store_true", help="print only warnings and errors")


def _work(arguments: argparse.Namespace) -> tuple[str | None, dict[str, Any]]:
    outputs = _outputs(arguments)
    how = _settings(arguments)
    scene = fh.load(arguments.file, strict=arguments.strict, max_memory=arguments.max_memory)
    made, guessed = scanner(arguments, scene.up), _guessed(arguments, scene)
    for output in outputs:
        if _firsthit.is_input(output):
            raise UsageError(f"{output} is an input; it will not be overwritten")
    _check_turns(made, how["seed"])
    scan = _turns(scene, made, how, arguments)
    for output in outputs:
        scan.save(output)
    rows, columns = scan.shape
    what = f"{len(scan):,} returns of {rows} x {columns} beams"
    if made.turns > 1:
        what += f" in {made.turns} turns"
    if guessed:
        what += f"; guessed: {', '.join(guessed)}"
    lines = [f"{output}: {what}" for output in outputs]
    if not len(scan):
        warn(_why_none(scene, made.at(0), how))
    report = {
        "file": arguments.file,
        "outputs": [str(output) for output in outputs],
        "lidar": made.at(0).name,
        "turns": made.turns,
        "rows": rows,
        "columns": columns,
        "returns": len(scan),
        "guessed": guessed,
        "scene": scan.metadata["scene"],
    }
    return None if arguments.quiet else "\n".join(lines), report


def _guessed(arguments: argparse.Namespace, scene: Scene) -> list[str]:
    """Return what was guessed, in words, each with the option that says otherwise."""
    is_placed = arguments.pose is not None or arguments.trajectory is not None
    if is_placed or arguments.up is not None or not scene._up_is_guessed:
        return []
    return [f"up {direction(scene.up)} (--up)"]


def _why_none(scene: Scene, lidar: Lidar, how: dict[str, Any]) -> str:
    """Return where things are, for a scan that met nothing."""
    low, high = scene.bounds
    start, extent = lidar.poses()[0, 0, :3, 3], float(max(high - low))
    limits = f"{how['min_range']:g} to {how['max_range']:g}"
    return (
        f"no beam met anything: the scanner starts at {place(start, extent)}, the scene goes from "
        f"{place(low, extent)} to {place(high, extent)}, and ranges of {limits} count"
    )


def _check_turns(made: Scanner, seed: int | None) -> None:
    """Refuse more turns than a scan can have, before any is scanned."""
    columns = made.at(0).columns
    if made.turns * columns >= 2**31:
        raise UsageError(
            f"all turns must have fewer than 2^31 columns, got {made.turns} turns of {columns}"
        )
    if seed is not None and seed + made.turns > 2**63:
        raise UsageError(f"--seed must leave a number below 2^63 to each turn, got {seed}")


def _turns(
    scene: Scene, made: Scanner, how: dict[str, Any], arguments: argparse.Namespace
) -> LidarScan:
    """Scan turn by turn."""
    first = made.at(0)
    beams = first.rows * first.columns
    shows = not arguments.quiet and sys.stderr.isatty()
    lines = beams * (how["subrays"] if how["divergence"] is not None else 1)
    classes = None if arguments.classes is None else dict(arguments.classes)
    scans = []
    with following(True if shows else None, made.turns * lines) as report:
        for turn in range(made.turns):
            told = later(report, turn * lines)
            scans.append(
                (made.at(turn) if turn else first).scan(
                    scene,
                    **{**how, "seed": None if how["seed"] is None else how["seed"] + turn},
                    classes=classes,
                    threads=arguments.threads,
                    progress=None if told is None else lambda done, _, told=told: told(done),
                )
            )
    return scans[0] if made.turns == 1 else fh.LidarScan.joined(scans)


def _settings(arguments: argparse.Namespace) -> dict[str, Any]:
    """Return what `Lidar.scan` takes, checked before anything is read."""
    if arguments.subrays is not None and arguments.divergence is None:
        raise UsageError("--subrays needs --divergence")
    if arguments.max_returns is not None and arguments.returns != "all":
        raise UsageError("--max-returns needs --returns all")
    if arguments.seed is not None and arguments.noise is None and arguments.dropout is None:
        raise UsageError("--seed needs --noise or --dropout")
    given: dict[str, Any] = {
        name: None if value is None else value[0]
        for name in ("divergence", "range_gate", "min_range", "max_range", "dropout")
        for value in [getattr(arguments, name)]
    }
    if given["max_range"] is None:
        given["max_range"] = float("inf")
    noise = arguments.noise
    how = {
        **given,
        "returns": arguments.returns,
        "subrays": 16 if arguments.subrays is None else arguments.subrays,
        "max_returns": arguments.max_returns,
        "intensity": arguments.intensity,
        "rings": arguments.rings,
        "noise": None if noise is None else (noise[0], noise[1] if len(noise) > 1 else 0.0),
        "seed": arguments.seed,
    }
    limits = how["min_range"], how["max_range"]
    checked = {name: how[name] for name in how if name not in ("min_range", "max_range")}
    try:
        ScanSettings.of(**checked, limits=limits)
    except ValueError as error:
        raise UsageError(str(error)) from None
    return how


def _outputs(arguments: argparse.Namespace) -> list[Path]:
    """Return the files to write, of formats that can be written."""
    outputs: list[Path] = arguments.output or [Path(f"{Path(arguments.file).stem}-scan.ply")]
    for output in outputs:
        suffix = output.suffix.lower()
        if suffix not in fh.LidarScan.EXTENSIONS:
            known = ", ".join(fh.LidarScan.EXTENSIONS)
            raise UsageError(f"--output must end in one of {known}, got {output}")
        if why := lacking(suffix):
            raise FileWriteError(f"{output}: {why}", str(output))
        if not output.absolute().parent.is_dir():
            raise FileWriteError(f"{output}: no such folder", str(output))
    if len({output.resolve() for output in outputs}) < len(outputs):
        raise UsageError("--output must not be given twice with the same file")
    return outputs
