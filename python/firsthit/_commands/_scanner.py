"""The options of a scanner, its place or drive, and its times, and the scanner they make."""

from __future__ import annotations

import math
import re
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, get_args

import numpy as np

from firsthit import Lidar, Trajectory, _firsthit
from firsthit._base.errors import FileError, FileFormatError
from firsthit._base.types import (
    BodyName,
    Extrapolation,
    Interpolation,
    TrajectoryFormat,
    Turn,
)
from firsthit._lidar.lidar import MODELS

from ._program import UsageError
from ._values import numbers, positive, whole

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable, Sequence

    import numpy.typing as npt

    from ._program import Parser

#: Options of a scanner that scans again and again. A table of beams has times of its own.
_OF_TURNS = ("start", "turns", "duration")
#: Options of a scanner that draws a curve of points.
_OF_POINTS = ("frequencies", "points", "point_rate", *_OF_TURNS)
#: Which options each of the scanners takes.
_OPTIONS = {
    "lidar": ("columns", "rate", *_OF_TURNS),
    "elevations": ("columns", "rate", "azimuth_start", "azimuth_end", "direction", *_OF_TURNS),
    "raster": ("rows", "columns", "rate", "serpentine", "flash", *_OF_TURNS),
    "rosette": ("share", *_OF_POINTS),
    "lissajous": ("phase", *_OF_POINTS),
    "pattern": (),
}
#: Options of a trajectory.
_OF_TRAJECTORY = ("trajectory_format", "body", "interpolation", "extrapolation")


class Scanner(NamedTuple):
    """A scanner, turn by turn: of a head, a picture of a raster, or all points of a curve."""

    #: Makes the scanner in one of its turns.
    at: Callable[[int], Lidar]
    turns: int


class _Period(NamedTuple):
    """The length of a turn."""

    #: Turns in a second.
    rate: float
    #: The time of the first turn's first firing, in seconds.
    start: float
    #: What is longer than too short a time, and what to say instead.
    too_long: str


def add_scanner(parser: Parser) -> None:
    """Add the options that say which scanner it is, and how long it scans."""
    group = parser.add_argument_group("Scanner")
    which = group.add_mutually_exclusive_group(required=True)
    which.add_argument(
        "--lidar", metavar="NAME", help=f"a scanner by its maker's name: {', '.join(MODELS)}"
    )
    which.add_argument(
        "--elevations",
        metavar="LOW,HIGH,N",
        type=numbers(3),
        help="a head that turns, with N lasers from LOW to HIGH degrees above level",
    )
    which.add_argument(
        "--raster",
        metavar="H,V",
        type=numbers(2),
        help="rows and columns of equal angles ahead, H degrees wide and V degrees high, with "
        "--rows and --columns",
    )
    which.add_argument(
        "--rosette",
        metavar="FOV",
        type=numbers(1),
        help="two prisms that turn, whose beam draws a rose in a circle of FOV degrees, with "
        "--frequencies, --points and --point-rate",
    )
    which.add_argument(
        "--lissajous",
        metavar="H,V",
        type=numbers(2),
        help="a mirror that swings about two axes, H degrees wide and V degrees high, with "
        "--frequencies, --points and --point-rate",
    )
    which.add_argument(
        "--pattern",
        metavar="FILE",
        type=Path,
        help="a table of beams (CSV): the columns azimuth and elevation in degrees and, where "
        "there are some, time in seconds and ring",
    )
    _add_spinning(group.add_argument)
    _add_ahead(group.add_argument)
    group.add_argument(
        "--start",
        metavar="SECONDS",
        type=numbers(1),
        help="the time of the first firing [default: the trajectory's first time, else 0]",
    )
    how_long = group.add_mutually_exclusive_group()
    how_long.add_argument(
        "--turns",
        metavar="N",
        type=whole(1),
        help="how often the head turns, or how many pictures a raster has, or how often the "
        "--points of a rose or a Lissajous figure follow [default: as often as fits into the "
        "trajectory, else once]",
    )
    how_long.add_argument(
        "--duration",
        metavar="SECONDS",
        type=positive,
        help="as many whole turns as fit into this time",
    )


def _add_spinning(add: Callable[..., object]) -> None:
    """Add the options of heads that turn, some of which a raster has too."""
    add(
        "--columns",
        metavar="N",
        type=whole(1),
        help="how often each laser fires in a turn [default: as often as the scanner of --lidar "
        "does, else 1024]; with --raster: points across, without a default",
    )
    add(
        "--rate",
        metavar="HZ",
        type=positive,
        help="turns in a second, or pictures of a raster [default: 10]",
    )
    add(
        "--azimuth-start",
        metavar="DEGREES",
        type=numbers(1),
        help="with --elevations: where the head starts to turn [default: 180, behind]",
    )
    add(
        "--azimuth-end",
        metavar="DEGREES",
        type=numbers(1),
        help="with --elevations: where the turn ends [default: -180]",
    )
    add(
        "--direction",
        choices=get_args(Turn),
        help="with --elevations: which way the head turns, seen from above [default: clockwise]",
    )


def _add_ahead(add: Callable[..., object]) -> None:
    """Add the options of scanners that look ahead."""
    add("--rows", metavar="N", type=whole(1), help="with --raster: points down")
    # Flags without a default are None, as options that are not given.
    add(
        "--serpentine",
        action="store_true",
        default=None,
        help="with --raster: scan every other row from the right",
    )
    add(
        "--flash",
        action="store_true",
        default=None,
        help="with --raster: all points of a picture are at its first time",
    )
    add(
        "--frequencies",
        metavar="F1,F2",
        type=numbers(2),
        help="turns of the prisms, or swings of the mirror, in a second; a prism with a negative "
        "number turns the other way",
    )
    add("--points", metavar="N", type=whole(1), help="how many points a turn has")
    add("--point-rate", metavar="HZ", type=positive, help="points in a second")
    add(
        "--share",
        metavar="SHARE",
        type=numbers(1),
        help="with --rosette: the first prism's share of the deflection, from 0 to 1 "
        "[default: 0.5]",
    )
    add(
        "--phase",
        metavar="DEGREES",
        type=numbers(1),
        help="with --lissajous: the phase of the upward swing at the time 0 [default: 90]",
    )


def add_place(parser: Parser) -> None:
    """Add the options that say where the scanner stands, or how it moves."""
    add = parser.add_argument_group("Place").add_argument
    add(
        "--position",
        metavar="X,Y,Z",
        type=numbers(3),
        help="where the scanner is, in scene units; with --trajectory in the body's coordinates "
        "[default: the origin]",
    )
    add(
        "--aim",
        metavar="X,Y,Z",
        type=numbers(3),
        help="the direction that is forwards, azimuth 0 [default: 1,0,0, or 0,1,0 where up is "
        "along x]",
    )
    add(
        "--up",
        metavar="X,Y,Z",
        type=numbers(3),
        help="the direction that is upwards, as far as --aim allows [default: as the 3D file says; "
        "OBJ has 0,1,0 and PLY and STL have 0,0,1, unless the model clearly stands on a flat base "
        "along the other of the two]",
    )
    add(
        "--pose",
        metavar="FILE",
        type=Path,
        help="a text file with the 3 x 4 or 4 x 4 matrix that takes the scanner's coordinates "
        "(forwards, left, up) to the world's, or with --trajectory to the body's: row by row, "
        "with blanks or commas between",
    )
    add(
        "--trajectory",
        metavar="FILE",
        type=Path,
        help="how the body moves that carries the scanner: a table with the columns "
        "time,x,y,z,qx,qy,qz,qw, in seconds and scene units",
    )
    add(
        "--trajectory-format",
        choices=get_args(TrajectoryFormat),
        help="the format of --trajectory [default: csv]",
    )
    add(
        "--body",
        choices=get_args(BodyName),
        help="which ways the axes of the body in --trajectory point [default: forwards-left-up "
        "for csv and ros; tum and kitti need it]",
    )
    add(
        "--interpolation",
        choices=get_args(Interpolation),
        help="what is between the poses [default: linear]",
    )
    add(
        "--extrapolation",
        choices=get_args(Extrapolation),
        help="whether beams before and after the trajectory are refused, or it stays where it is "
        "(hold) [default: refuse]",
    )


def with_values(argv: Sequence[str], parser: Parser) -> list[str]:
    """Join options with values that begin with a minus, which argparse takes for options."""
    takes_value = {
        name for action in parser._actions if action.nargs is None for name in action.option_strings
    }
    joined: list[str] = []
    for word in argv:
        before = joined[-1] if joined else ""
        if "--" not in joined and before in takes_value and re.match(r"-[\d.]", word):
            joined[-1:] = [f"{before}={word}"] if before.startswith("--") else [before + word]
        else:
            joined.append(word)
    return joined


def scanner(arguments: argparse.Namespace, up: Sequence[float]) -> Scanner:
    """Return the scanner of the options; ``up`` is that of the 3D file."""
    drive = _drive(arguments)
    where = _place(arguments, up, drive)
    kind = next(kind for kind in _OPTIONS if getattr(arguments, kind) is not None)
    _check_options(arguments, kind)
    try:
        if kind == "pattern":
            beams = Lidar.from_csv(arguments.pattern, **where)
            return Scanner(lambda _: beams, 1)
        made = _turning(arguments, kind, where, drive)
        # What is wrong with the first and the last turn is wrong usage, before any is scanned.
        for turn in {0, made.turns - 1}:
            made.at(turn)
    except FileError:
        raise
    except ValueError as error:
        raise UsageError(str(error)) from None
    return made


def _check_options(arguments: argparse.Namespace, kind: str) -> None:
    """Refuse options of other scanners."""
    for name in dict.fromkeys(name for names in _OPTIONS.values() for name in names):
        if name in _OPTIONS[kind]:
            continue
        if kind == "pattern":
            _refuse(arguments, (name,), "must be left out with --pattern")
        takers = [f"--{each}" for each, names in _OPTIONS.items() if name in names]
        _refuse(arguments, (name,), f"needs {' or '.join(takers)}")


def _turning(
    arguments: argparse.Namespace, kind: str, where: dict[str, Any], drive: Trajectory | None
) -> Scanner:
    start = drive.start if drive is not None else 0.0
    if arguments.start is not None:
        (start,) = arguments.start
    if kind in ("rosette", "lissajous"):
        return _curve(arguments, kind, start, where, drive)
    rate = 10.0 if arguments.rate is None else arguments.rate
    make = {"lidar": _named, "elevations": _spinning, "raster": _raster}[kind](arguments, rate)

    def at(turn: int) -> Lidar:
        return make(start=start + turn / rate, **where)

    noun = "picture" if kind == "raster" else "turn"
    too_long = f"a {noun} of {1.0 / rate:g} s: say --turns or another --rate"
    return Scanner(at, _turns(arguments, _Period(rate, start, too_long), drive))


def _named(arguments: argparse.Namespace, rate: float) -> Callable[..., Lidar]:
    name = arguments.lidar.lower()
    if name not in MODELS:
        raise UsageError(f"--lidar must be one of {', '.join(MODELS)}, got {arguments.lidar}")
    return partial(Lidar.named, name, rate, arguments.columns)


def _spinning(arguments: argparse.Namespace, rate: float) -> Callable[..., Lidar]:
    low, high, lasers = arguments.elevations
    if lasers != int(lasers) or lasers < 1:
        raise UsageError(f"--elevations must have a whole number of lasers, got {lasers:g}")
    if low > high:
        raise UsageError(f"--elevations must be LOW,HIGH,N, got {low:g} above {high:g}")
    elevations = np.linspace(low, high, int(lasers))
    options: dict[str, Any] = {}
    for name in ("columns", "azimuth_start", "azimuth_end", "direction"):
        value = getattr(arguments, name)
        if value is not None:
            options[name] = value[0] if name.startswith("azimuth") else value
    return partial(Lidar.spinning, elevations, rate=rate, **options)


def _raster(arguments: argparse.Namespace, rate: float) -> Callable[..., Lidar]:
    _need(arguments, "raster", ("rows", "columns"))
    if arguments.flash and arguments.serpentine:
        raise UsageError("--serpentine must be left out with --flash, whose points are at once")
    when, is_serpentine = None if arguments.flash else rate, bool(arguments.serpentine)
    across, down = arguments.raster
    size = arguments.rows, arguments.columns
    return partial(Lidar.raster, across, down, *size, rate=when, serpentine=is_serpentine)


def _curve(
    arguments: argparse.Namespace,
    kind: str,
    start: float,
    where: dict[str, Any],
    drive: Trajectory | None,
) -> Scanner:
    """Return a scanner of points; its curve continues from turn to turn."""
    _need(arguments, kind, ("frequencies", "points", "point_rate"))
    points, rate = arguments.points, arguments.point_rate
    option = {"rosette": "share", "lissajous": "phase"}[kind]
    given, frequencies = getattr(arguments, option), tuple(arguments.frequencies)
    how: dict[str, Any] = where if given is None else {**where, option: given[0]}

    def at(turn: int) -> Lidar:
        when = start + turn * points / rate
        if kind == "rosette":
            (fov,) = arguments.rosette
            return Lidar.rosette(fov, frequencies, points, rate, start=when, **how)
        across, down = arguments.lissajous
        return Lidar.lissajous(across, down, frequencies, points, rate, start=when, **how)

    too_long = f"the {points / rate:g} s of {points} points: say --turns or fewer --points"
    period = _Period(rate / points, start, too_long)
    return Scanner(at, _turns(arguments, period, drive))


def _turns(arguments: argparse.Namespace, period: _Period, drive: Trajectory | None) -> int:
    """Return how many turns there are."""
    if arguments.turns is not None:
        turns: int = arguments.turns
        return turns
    if arguments.duration is not None:
        what, seconds = "--duration", arguments.duration
    elif drive is not None:
        what, seconds = "--trajectory, after the start,", drive.end - period.start
    else:
        return 1
    # A turn that is longer by rounding alone fits.
    turns = math.floor(seconds * period.rate + 1e-6)
    if turns < 1:
        raise UsageError(f"{what} has {seconds:g} s, less than {period.too_long}")
    return turns


def _drive(arguments: argparse.Namespace) -> Trajectory | None:
    if arguments.trajectory is None:
        _refuse(arguments, _OF_TRAJECTORY, "needs --trajectory")
        return None
    form: TrajectoryFormat = arguments.trajectory_format or "csv"
    if arguments.body is None and form in ("tum", "kitti"):
        raise UsageError(f"--body must be given with --trajectory-format {form}")
    words = {
        name: getattr(arguments, name)
        for name in ("interpolation", "extrapolation")
        if getattr(arguments, name) is not None
    }
    body: BodyName = arguments.body or "forwards-left-up"
    return Trajectory.load(arguments.trajectory, form, body=body, **words)


def _place(
    arguments: argparse.Namespace, up: Sequence[float], drive: Trajectory | None
) -> dict[str, Any]:
    """Return what says where a `Lidar` is."""
    position, aim = arguments.position, arguments.aim
    where: dict[str, Any] = {"trajectory": drive}
    if arguments.pose is not None:
        _refuse(arguments, ("position", "aim", "up"), "must be left out with --pose")
        return where | {"pose": _matrix(arguments.pose)}
    if drive is not None:
        _refuse(arguments, ("aim", "up"), "must be left out with --trajectory: give a --pose")
        return where | {"position": position}
    upwards = tuple(arguments.up or up)
    if aim is None and upwards == (0.0, 0.0, 1.0):
        return where | {"position": position}
    pose = np.eye(4)
    pose[:3, :3] = _turned(aim, np.array(upwards))
    pose[:3, 3] = 0.0 if position is None else position
    return where | {"pose": pose}


def _turned(aim: list[float] | None, up: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the matrix whose columns are forwards, left and up."""
    is_along_x = abs(up[0]) > 0.9 * np.linalg.norm(up)
    forwards = np.array(aim or ([0.0, 1.0, 0.0] if is_along_x else [1.0, 0.0, 0.0]))
    left = np.cross(up, forwards)
    # Of two that are parallel the product is rounding.
    if not np.linalg.norm(left) > 1e-9 * np.linalg.norm(up) * np.linalg.norm(forwards):
        raise UsageError("--aim and --up must be directions that are not parallel")
    if aim is None:
        # The world's forwards, as far as up allows.
        forwards = np.cross(left, up)
    left, forwards = (each / np.linalg.norm(each) for each in (left, forwards))
    return np.stack([forwards, left, np.cross(forwards, left)], axis=-1)


def _matrix(path: Path) -> npt.NDArray[np.float64]:
    text = path.read_text(encoding="utf-8", errors="replace")
    _firsthit.note_input(path)
    try:
        values = [float(word) for word in re.split(r"[\s,;]+", text.strip())]
    except ValueError:
        values = []
    if len(values) not in (12, 16) or not all(map(math.isfinite, values)):
        expected = "expected the 12 or 16 numbers of a 3 x 4 or 4 x 4 matrix"
        raise FileFormatError(f"{path}: {expected}", str(path))
    return np.array(values).reshape(-1, 4)


def _need(arguments: argparse.Namespace, kind: str, names: Sequence[str]) -> None:
    for name in names:
        if getattr(arguments, name) is None:
            raise UsageError(f"--{kind} needs --{name.replace('_', '-')}")


def _refuse(arguments: argparse.Namespace, names: Sequence[str], why: str) -> None:
    for name in names:
        if getattr(arguments, name) is not None:
            raise UsageError(f"--{name.replace('_', '-')} {why}")
