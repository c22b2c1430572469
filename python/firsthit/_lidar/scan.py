"""Scans of a laser scanner."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple, get_args

import numpy as np

from firsthit._base.arrays import count, flag, number, numbers, threads_or_all
from firsthit._base.errors import warn
from firsthit._base.progress import following, later
from firsthit._base.types import Returns, Rings
from firsthit._objects.traceable import Traceable

from .lidar_scan import LidarScan, ScanOrigin
from .scan_labels import classes_of, from_lowest

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    import numpy.typing as npt

    from firsthit._base.types import ObjectKey, Progress
    from firsthit._queries.hits import Hits
    from firsthit._scene.scene import Scene

    from .lidar import Lidar

#: About how many lines of cones are shot at a time.
_BATCH = 1 << 20

#: How bright linear red, green and blue are (Rec. 709).
_LUMINANCE = (0.2126, 0.7152, 0.0722)

#: No noise is as large: ranges go to 1e150, and their product must be a number.
_MOST_NOISE = 1e100

#: The two streams of random numbers of a seed.
_NOISE, _DROPOUT = 0, 1


class ScanSettings(NamedTuple):
    """The settings of a scan, checked; see `Lidar.scan`."""

    returns: Returns
    divergence: float | None
    subrays: int
    range_gate: float
    max_returns: int | None
    limits: tuple[float, float]
    intensity: bool
    noise: tuple[float, float] | None
    dropout: float | None
    seed: int | None
    rings: Rings

    @classmethod
    def of(
        cls,
        *,
        returns: Returns,
        divergence: float | None,
        subrays: int,
        range_gate: float,
        max_returns: int | None,
        limits: tuple[float, float],
        intensity: bool,
        noise: float | tuple[float, float] | None,
        dropout: float | None,
        seed: int | None,
        rings: Rings = "maker",
    ) -> ScanSettings:
        """Check what a user gave."""
        if returns not in get_args(Returns):
            known = ", ".join(get_args(Returns))
            raise ValueError(f"returns must be one of {known}, got {returns!r}")
        if rings not in get_args(Rings):
            raise ValueError(f"rings must be one of {', '.join(get_args(Rings))}, got {rings!r}")
        angle = None if divergence is None else _within("divergence", divergence, 0.0, math.pi)
        gate = _within("range_gate", range_gate, 0.0, math.inf)
        near, far = number("min_range", limits[0]), number("max_range", limits[1])
        if not 0.0 <= near < far:
            raise ValueError(
                f"min_range and max_range must be from 0 on and increase, got {near} and {far}"
            )
        spread = None
        if noise is not None:
            given = numbers("noise", noise)
            if given.shape not in ((), (2,)):
                raise ValueError(f"noise must be one number or two, got shape {given.shape}")
            first, second = float(given.flat[0]), float(given[1]) if given.ndim else 0.0
            spread = (
                _within("noise", first, 0.0, _MOST_NOISE),
                _within("noise", second, 0.0, _MOST_NOISE),
            )
        lost = None
        if dropout is not None:
            lost = number("dropout", dropout)
            if not 0.0 <= lost <= 1.0:
                raise ValueError(f"dropout must be from 0 to 1, got {lost}")
        key = None if seed is None else count("seed", seed)
        if key is None and (spread is not None or lost is not None):
            raise ValueError("seed must be given with noise or dropout, which are random")
        most = None if max_returns is None else count("max_returns", max_returns, 1)
        if most is not None and returns != "all":
            raise ValueError(f"max_returns is about returns='all', got returns={returns!r}")
        return cls(
            returns,
            angle,
            count("subrays", subrays, 1),
            gate,
            most,
            (near, far),
            flag("intensity", intensity),
            spread,
            lost,
            key,
            rings,
        )

    def record(self) -> dict[str, Any]:
        """Return them for metadata: lengths in scene units, the divergence in radians."""
        near, far = self.limits
        return {
            "returns": self.returns,
            "divergence": self.divergence,
            "subrays": self.subrays if self.divergence is not None else None,
            "range_gate": self.range_gate,
            "max_returns": self.max_returns,
            "min_range": near,
            # JSON has no infinity.
            "max_range": None if math.isinf(far) else far,
            "noise": self.noise,
            "dropout": self.dropout,
            "seed": self.seed,
            **({} if self.rings == "maker" else {"rings": self.rings}),
        }

    @property
    def splits(self) -> bool:
        """Whether a cone's lines end as returns of their own, which no receiver does."""
        is_cone = self.divergence is not None and self.subrays > 1
        is_told = self.returns != "first" or self.intensity
        return is_cone and is_told and self.range_gate == 0.0

    @property
    def needs_surfaces(self) -> bool:
        """Whether it matters how bright each hit is."""
        return self.intensity or self.returns == "strongest"


class _Found(NamedTuple):
    """Hits of beams, by beam and then by range, and what they are worth.

    ``at`` is the index of the hit among those from which channels are computed.
    """

    beam: npt.NDArray[np.int64]
    range: npt.NDArray[Any]
    at: npt.NDArray[np.int64]
    echo: npt.NDArray[np.float64]


class _Returned(NamedTuple):
    """Returns of beams, by beam and then by range."""

    beam: npt.NDArray[Any]
    range: npt.NDArray[Any]
    object: npt.NDArray[Any]
    primitive: npt.NDArray[Any]
    incidence: npt.NDArray[Any]
    number: npt.NDArray[Any]
    total: npt.NDArray[Any]
    intensity: npt.NDArray[Any]


def scanned(
    lidar: Lidar,
    scene: Scene,
    settings: ScanSettings,
    classes: Mapping[ObjectKey, int] | None,
    threads: int | None,
    progress: Progress | None,
) -> LidarScan:
    """Scan a scene."""
    if not isinstance(scene, Traceable):
        raise TypeError(f"scan takes a Scene, got {scene!r}")
    if classes is not None:
        # Before the work, so that a wrong name is said at once.
        classes_of(scene.objects, classes)
    beams = lidar.rows * lidar.columns
    if settings.splits:
        warn(
            f"each of the {settings.subrays} lines of a beam is a return of its own: give a "
            "range_gate, what the receiver resolves"
        )
    if settings.divergence is None:
        parts = [_of_lines(lidar, scene, settings, threads, progress)]
    else:
        cones = _of_cones(lidar, scene, settings, settings.divergence, threads, progress)
        parts = list(cones)
    if len(parts) == 1:
        (returned,) = parts
    else:
        returned = _Returned(*(np.concatenate(column) for column in zip(*parts, strict=True)))
    made = _with_noise(returned, settings, beams)
    beam = np.ascontiguousarray(made.beam, np.int64)
    far = np.ascontiguousarray(made.range)
    point, own, ring, row, column, time = lidar._native.returns(beam, far, threads_or_all(threads))
    if settings.rings == "lowest-first":
        places = from_lowest(lidar.ring, lidar.elevation)
        ring = np.array([places[number_] for number_ in ring.tolist()], np.int32)
    return LidarScan._of(
        {
            "point": point.reshape(-1, 3),
            "sensor_point": own.reshape(-1, 3),
            "range": far,
            "object": made.object,
            "primitive": made.primitive,
            "incidence": made.incidence,
            "ring": ring,
            "row": row,
            "column": column,
            "time": time,
            "return_number": made.number.astype(np.int32),
            "number_of_returns": made.total.astype(np.int32),
            **({"intensity": made.intensity} if settings.intensity else {}),
            **({} if classes is None else _classified(scene, classes, made.object)),
        },
        lidar.shape,
        ScanOrigin(scene._native(), lidar._native, settings.record()),
    )


def _classified(
    scene: Scene, classes: Mapping[ObjectKey, int], objects: npt.NDArray[Any]
) -> dict[str, npt.NDArray[Any]]:
    # Objects may have been added meanwhile, which were met.
    return {"classification": classes_of(scene.objects, classes)[objects]}


def _of_lines(
    lidar: Lidar,
    scene: Scene,
    settings: ScanSettings,
    threads: int | None,
    progress: Progress | None,
) -> _Returned:
    """Return the returns of beams that are lines."""
    near, far = settings.limits
    how: dict[str, Any] = {"t_max": far, "threads": threads, "progress": progress}
    if settings.returns == "first" and settings.range_gate == 0.0:
        return _of_first_hits(scene.shoot(lidar, **how), settings)
    met = scene.shoot_all(lidar, **how)
    hits, beam, t = met.hits, met.ray, met.t
    blocked = np.zeros(lidar.rows * lidar.columns, np.bool_)
    blocked[beam[t <= near]] = True
    index = np.flatnonzero(~blocked[beam])
    found = _Found(beam[index], t[index], index, _echoes(hits, index, len(index), settings, 1))
    return _clustered(found, hits, settings)


def _of_first_hits(shot: Hits, settings: ScanSettings) -> _Returned:
    """Return the returns of beams that end at their first hit: what `_clustered` would, sooner."""
    beam = _seen(shot, settings)
    one = np.ones(len(beam), np.int32)
    return _Returned(
        beam,
        shot.t.reshape(-1)[beam],
        shot.object.reshape(-1)[beam],
        shot.primitive.reshape(-1)[beam],
        shot.incidence.reshape(-1)[beam],
        one,
        one,
        _echoes(shot, np.divmod(beam, shot.shape[1]), len(beam), settings, 1),
    )


def _seen(hits: Hits, settings: ScanSettings) -> npt.NDArray[np.intp]:
    """Return the numbers of the rays whose first hit is not so near that it blocks them."""
    return np.flatnonzero(
        (hits.object.reshape(-1) >= 0) & (hits.t.reshape(-1) > settings.limits[0])
    )


def _of_cones(
    lidar: Lidar,
    scene: Scene,
    settings: ScanSettings,
    divergence: float,
    threads: int | None,
    progress: Progress | None,
) -> Iterator[_Returned]:
    """Yield the returns of beams that are cones, some beams at a time."""
    lines, beams = settings.subrays, lidar.rows * lidar.columns
    origins = lidar.rays()[0].reshape(-1, 3)
    step = max(1, _BATCH // lines)
    with following(progress, beams * lines) as report:
        for first in range(0, beams, step):
            some = np.arange(first, min(first + step, beams))
            ways = lidar._native.spread(some, divergence, lines)
            told = later(report, first * lines)
            hits = scene.shoot(
                np.repeat(origins[some], lines, axis=0),
                ways.reshape(-1, 3),
                t_max=settings.limits[1],
                threads=threads,
            )
            if told is not None:
                told(len(some) * lines)
            index = _seen(hits, settings)
            beam, t = index // lines, hits.t[index]
            order = np.lexsort((t, beam))
            index = index[order]
            found = _Found(
                some[beam[order]],
                t[order],
                index,
                _echoes(hits, index, len(index), settings, lines),
            )
            yield _clustered(found, hits, settings)


def _echoes(
    hits: Hits,
    index: npt.NDArray[np.int64] | tuple[npt.NDArray[np.int64], ...],
    number_: int,
    settings: ScanSettings,
    lines: int,
) -> npt.NDArray[np.float64]:
    """Return the share of the light that each of some hits sends back, without the fall-off."""
    if not settings.needs_surfaces:
        return np.full(number_, 1.0 / lines)
    some = hits[index]
    red, green, blue = some.base_color.T
    # Term by term: a product of matrices adds in another order on other machines.
    luminance = _LUMINANCE[0] * red + _LUMINANCE[1] * green + _LUMINANCE[2] * blue
    echoes: npt.NDArray[np.float64] = luminance * _cosines(some.normal, some.direction) / lines
    return echoes


def _cosines(
    normals: npt.NDArray[np.float64], directions: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    # Component by component: sums over an axis of three are slow.
    (x, y, z), (a, b, c) = directions.T, normals.T
    length = np.sqrt(x * x + y * y + z * z)
    cosine: npt.NDArray[np.float64] = np.abs(x * a + y * b + z * c) / length
    return np.minimum(cosine, 1.0)


def _clustered(found: _Found, hits: Hits, settings: ScanSettings) -> _Returned:
    """Make returns of hits that lie close behind one another, and keep those that are wanted."""
    begins = _begins(found, settings)
    firsts = np.flatnonzero(begins)
    if len(firsts) == 0:
        empty = np.empty(0, np.int64)
        return _Returned(
            empty, np.empty(0), empty.astype(np.int32), empty.astype(np.int32), np.empty(0),
            empty, empty, np.empty(0),
        )  # fmt: skip
    beam = found.beam[firsts]
    size = np.diff(np.append(firsts, len(begins)))
    far = np.add.reduceat(found.range, firsts) / size
    # Of one hit the mean is itself, bit for bit.
    far = np.where(size == 1, found.range[firsts], far)
    echo = np.add.reduceat(found.echo, firsts)
    power = np.add.reduceat(found.echo / np.maximum(found.range, 1e-150) ** 2, firsts)
    is_new = np.append(True, beam[1:] != beam[:-1])
    starts = np.flatnonzero(is_new)
    each = np.diff(np.append(starts, len(beam)))
    number_ = np.arange(len(beam)) - np.repeat(starts, each) + 1
    total = np.repeat(each, each)
    if settings.returns == "first":
        kept = starts
    elif settings.returns == "last":
        kept = starts + each - 1
    elif settings.returns == "strongest":
        # Of equal ones the nearest.
        kept = np.sort(np.lexsort((number_, -power, beam))[starts])
    else:
        kept = np.arange(len(beam))
        if settings.max_returns is not None:
            kept = np.flatnonzero(number_ <= settings.max_returns)
            # As the receiver says it, which has no place for more.
            total = np.minimum(total, settings.max_returns)
    some = hits[found.at[firsts[kept]]]
    return _Returned(
        beam[kept],
        far[kept],
        some.object.copy(),
        some.primitive.copy(),
        some.incidence.copy(),
        number_[kept],
        total[kept],
        echo[kept],
    )


def _begins(found: _Found, settings: ScanSettings) -> npt.NDArray[np.bool_]:
    """Tell which hits are the nearest of a return."""
    begins = np.ones(len(found.beam), np.bool_)
    gate = settings.range_gate
    is_line = settings.divergence is None
    if gate == 0.0 and is_line:
        return begins
    same_beam = np.append(False, found.beam[1:] == found.beam[:-1])
    # Each pass settles the next return of every beam: what is within the gate of its nearest hit.
    nearest = found.range.copy()
    pending = same_beam.copy()
    while pending.any():
        at = np.flatnonzero(pending)
        before = at - 1
        # A hit is settled once the one before is.
        ready = ~pending[before]
        at = at[ready]
        start = nearest[at - 1]
        joins = found.range[at] - start <= gate
        begins[at] = ~joins
        nearest[at] = np.where(joins, start, found.range[at])
        pending[at] = False
    return begins


def _with_noise(returned: _Returned, settings: ScanSettings, beams: int) -> _Returned:
    """Add noise to ranges, and lose some returns: those that it takes out of the limits too."""
    if settings.seed is None or len(returned.beam) == 0:
        return returned
    if settings.noise is not None:
        constant, relative = settings.noise
        normal = _drawn(returned, settings.seed, _NOISE, beams)
        spread = constant + relative * returned.range
        returned = returned._replace(range=returned.range + spread * normal)
    near, far = settings.limits
    kept = (returned.range > near) & (returned.range <= far)
    if settings.dropout is not None:
        kept &= _drawn(returned, settings.seed, _DROPOUT, beams) >= settings.dropout
    return _Returned(*(array[kept] for array in returned))


def _drawn(returned: _Returned, seed: int, stream: int, beams: int) -> npt.NDArray[np.float64]:
    """Return a random number for each return, which depends on its beam and number alone."""
    drawn = np.empty(len(returned.beam))
    for number_ in np.unique(returned.number):
        # A key of 128 bits: the seed, and which return and stream it is.
        key = np.array([seed % 2**64, 2 * int(number_) + stream], np.uint64)
        generator = np.random.Generator(np.random.Philox(key=key))
        make = generator.standard_normal if stream == _NOISE else generator.random
        chosen = returned.number == number_
        drawn[chosen] = make(beams)[returned.beam[chosen]]
    return drawn


def _within(name: str, given: float, least: float, below: float) -> float:
    value = number(name, given)
    if not least <= value < below:
        raise ValueError(f"{name} must be from {least:g} to below {below:g}, got {value}")
    return value
