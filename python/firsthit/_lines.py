"""Where pictures show points: also pictures whose lines are each of a time of its own.

A camera that moves has a pose for each line. Where it shows a point is where a line shows it whose
pose sees it there: one equation for the line, which is solved here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ._camera import Camera
from ._moving import Pushbroom, RollingShutter
from ._project import Reach, in_camera, picture, project, starts_towards

if TYPE_CHECKING:
    import numpy.typing as npt

    Floats = npt.NDArray[np.float64]
    Bools = npt.NDArray[np.bool_]
    Integers = npt.NDArray[np.intp]

#: A sensor whose pictures have lenses, and places for points.
PictureSensor = Camera | RollingShutter | Pushbroom

#: At so many lines it is looked whether a point goes through the picture in one direction.
_PROBES = 17
#: How many projections are kept at a time.
_MOST_VALUES = 1 << 22
#: How far from its line, in lines, a place may be found; and from where on it is none.
_PRECISION, _NO_ROOT = 1e-10, 1e-3
#: Steps of the search, of which all but the first few halve what is left.
_STEPS, _FALSE_POSITIONS = 60, 20


class Sight(NamedTuple):
    """How a sensor sees points; NaN where it does not."""

    #: Columns from the picture's left edge and rows from its upper edge, (..., 2).
    pixels: Floats
    #: Where the rays to the points start, in world space, (..., 3).
    starts: Floats
    #: How far they are from the camera's position along its aim, (...).
    z: Floats


def sight(sensor: PictureSensor, points: Floats) -> Sight:
    """Return how a sensor sees points of the world, (..., 3), whether or not anything hides them.

    Of a moving camera it is the pose of the first line, in time, in which the picture shows the
    point; if none does, that of the first line's straight continuation beyond the border.
    """
    if isinstance(sensor, Camera):
        pixels, z = project(sensor, points), in_camera(sensor, points)[..., 2]
        return Sight(pixels, starts_towards(sensor, points), z)
    lines, flat = Lines(sensor), points.reshape(-1, 3)
    found = Sight(*(np.full((len(flat), *shape), np.nan) for shape in ((2,), (3,), ())))
    for part in _parts(len(flat), _MOST_VALUES // (2 * _PROBES)):
        at = lines.numbers(flat[part])
        for whole, one in zip(found, lines.seen(flat[part], at), strict=True):
            whole[part] = one
    leading = points.shape[:-1]
    return Sight(*(each.reshape(*leading, *each.shape[1:]) for each in found))


def sight_at(sensor: RollingShutter | Pushbroom, points: Floats, times: Floats) -> Sight:
    """Return how a moving camera sees points at times, as a picture of its own at each.

    Of a `Pushbroom` the rows are those of its camera, of which there is one.
    """
    lines, flat = Lines(sensor), points.reshape(-1, 3)
    seen = lines.looked(flat, times.reshape(-1))
    leading = points.shape[:-1]
    return Sight(*(each.reshape(*leading, *each.shape[1:]) for each in seen))


def standing(sensor: PictureSensor) -> Camera:
    """Return the camera as it is when the middle line is seen, number ``lines // 2``."""
    if isinstance(sensor, Camera):
        return sensor
    times = sensor.times
    return sensor.camera.moved(sensor.trajectory.at(times[len(times) // 2]))


class Lines:
    """The lines of a moving camera.

    A place between lines is a number in the order of time: line k, from 0, has its middle at
    ``k + 0.5``. There the camera is where it is at the line's time; between two middles time goes
    on evenly, and before the first and after the last it stands.
    """

    def __init__(self, sensor: RollingShutter | Pushbroom) -> None:
        self._sensor, self._camera, self._trajectory = sensor, sensor.camera, sensor.trajectory
        self._shape = sensor.rows, sensor.columns
        times = sensor.times
        self._is_pushbroom = isinstance(sensor, Pushbroom)
        if isinstance(sensor, RollingShutter):
            direction = sensor._arguments[4]
            self._axis = 1 if direction in ("top_down", "bottom_up") else 0
            self._is_backwards = direction in ("bottom_up", "right_left")
        else:
            steps = np.diff(times)
            self._axis, self._is_backwards = 1, bool((steps < 0.0).any())
            if (steps == 0.0).any() or (self._is_backwards and (steps > 0.0).any()):
                raise ValueError(
                    "times of a Pushbroom must increase from row to row, or decrease, to tell in "
                    "which row a point is"
                )
        self._times = times[::-1] if self._is_backwards else times
        self._count = len(times)

    def poses(self) -> Floats:
        """Return the body's pose at each line, in the order of the picture's lines, (n, 4, 4)."""
        poses = self._trajectory.at(self._times)
        return poses[::-1] if self._is_backwards else poses

    def part(self, corners: Floats) -> Reach:
        """Return pixels outside which no ray meets what the hull of points holds, (n, 3)."""
        whole = picture(self._sensor)
        if self._camera.projection not in ("perspective", "orthographic"):
            return whole
        poses = self.poses()
        own = np.einsum("lji,lnj->lni", poses[:, :3, :3], corners - poses[:, None, :3, 3])
        # A flat picture of a hull is the hull of its corners' places, if it sees all of them.
        pixels = project(self._camera, own)
        low, high = pixels.min(axis=1), pixels.max(axis=1)
        is_cut = np.isnan(low).any(axis=1)
        low[is_cut], high[is_cut] = -np.inf, np.inf
        lines = np.arange(self._count)[:, None]
        first = np.zeros_like(lines) if self._is_pushbroom else lines
        # A pixel more on each side than rounding could ask for.
        meets = (low[:, [self._axis]] <= first + 2.0) & (high[:, [self._axis]] >= first - 1.0)
        seen = np.flatnonzero(meets[:, 0])
        if len(seen) == 0:
            return Reach(0, 0, 0, 0)
        across = 1 - self._axis
        most = (whole.right, whole.bottom)[across]
        start = int(np.clip(np.floor(low[seen, across].min()) - 1.0, 0, most))
        end = int(np.clip(np.ceil(high[seen, across].max()) + 1.0, 0, most))
        spans = {self._axis: (int(seen[0]), int(seen[-1]) + 1), across: (start, end)}
        (left, right), (top, bottom) = spans[0], spans[1]
        return Reach(left, top, max(left, right), max(top, bottom))

    def numbers(self, points: Floats) -> Floats:
        """Return in which line each of some points is seen, (n,): NaN where in none."""
        probes = self._probes()
        found = np.full(len(points), np.nan)
        known = np.flatnonzero(np.isfinite(points).all(axis=1))
        if len(known) == 0:
            return found
        off = self._off(points[known], probes)
        steps = np.diff(off, axis=0)
        is_plain = np.asarray((steps > 0.0).all(axis=0) | (steps < 0.0).all(axis=0))
        if len(probes) == self._count:
            is_plain = np.ones_like(is_plain)
        plain = known[is_plain]
        found[plain], is_sure = self._first(points[plain], probes, off[:, is_plain])
        # A point that goes to and fro, or is not always seen, is looked for in every line.
        rough = np.concatenate((known[~is_plain], plain[~is_sure]))
        if len(probes) < self._count:
            every = np.arange(self._count)
            for part in _parts(len(rough), max(1, _MOST_VALUES // self._count)):
                some = points[rough[part]]
                found[rough[part]], _ = self._first(some, every, self._off(some, every))
        return found

    def seen(self, points: Floats, numbers: Floats) -> Sight:
        """Return how points are seen in their lines; NaN where the line is."""
        found = Sight(*(np.full((len(points), *shape), np.nan) for shape in ((2,), (3,), ())))
        is_there = np.isfinite(numbers)
        if is_there.any():
            some = self.looked(points[is_there], self._time(numbers[is_there]))
            for whole, one in zip(found, some, strict=True):
                whole[is_there] = one
            if self._is_pushbroom and self._count > 1:
                across, rows = found.pixels[:, 0], numbers
                found.pixels[:, 1] = self._count - rows if self._is_backwards else rows
                found.pixels[np.isnan(across), 1] = np.nan
        return found

    def looked(self, points: Floats, times: Floats) -> Sight:
        """Return how the camera sees each point at a time of its own."""
        poses = self._trajectory.at(times)
        turns, places = poses[:, :3, :3], poses[:, :3, 3]
        # The difference first: far from the origin the rest would be all rounding.
        own = np.einsum("nji,nj->ni", turns, points - places)
        starts = np.einsum("nij,nj->ni", turns, starts_towards(self._camera, own)) + places
        return Sight(project(self._camera, own), starts, in_camera(self._camera, own)[:, 2])

    def _probes(self) -> Integers:
        """Return lines between which the camera moves smoothly: some, and those beside poses."""
        last = self._count - 1
        even = np.linspace(0, last, _PROBES).round().astype(np.intp)
        at = np.interp(self._trajectory.times, self._times, np.arange(self._count))
        at = at[(at > 0) & (at < last)]
        ends = np.array([0, 1, last - 1, last])
        lines = np.concatenate((even, np.floor(at), np.ceil(at), ends))
        return np.unique(lines.clip(0, last).astype(np.intp))

    def _time(self, numbers: Floats) -> Floats:
        middles = np.arange(self._count) + 0.5
        times = np.interp(numbers, middles, self._times)
        # Rounding must not leave the trajectory.
        return np.clip(times, self._times.min(), self._times.max())

    def _off(self, points: Floats, lines: Integers) -> Floats:
        """Return how far from each line points are seen at its time, (lines, points)."""
        off = np.empty((len(lines), len(points)))
        for row, line in enumerate(lines.tolist()):
            pose = self._trajectory.at(self._times[line])
            own = (points - pose[:3, 3]) @ pose[:3, :3]
            off[row] = self._from_line(project(self._camera, own), line + 0.5)
        return off

    def _from_line(self, pixels: Floats, numbers: Floats | float) -> Floats:
        """Return how far pixels that are seen at lines' times are from these lines."""
        across: Floats = pixels[..., self._axis]
        if self._is_pushbroom:
            # All rows are the camera's only one.
            return across - 0.5
        if self._is_backwards:
            across = self._shape[1 - self._axis] - across
        return across - numbers

    def _first(self, points: Floats, lines: Integers, off: Floats) -> tuple[Floats, Bools]:
        """Return in which line each point is seen first, and whether that is certain.

        The first one in the picture is taken; or else the first one, beyond the picture's border.
        """
        found, is_done = np.full(len(points), np.nan), np.zeros(len(points), np.bool_)
        is_sure = np.ones(len(points), np.bool_)

        def settle(which: Integers, numbers: Floats) -> None:
            pixels = self.seen(points[which], numbers).pixels
            with np.errstate(invalid="ignore"):
                is_in = (pixels >= 0.0).all(axis=1) & (pixels < self._shape[::-1]).all(axis=1)
            takes = which[is_in | np.isnan(found[which])]
            found[takes] = numbers[is_in | np.isnan(found[which])]
            is_done[which[is_in]] = True

        if self._count == 1 and self._is_pushbroom:
            # One row is the picture of a camera that stands.
            return off[0] + 0.5, is_sure
        settle(*self._beyond(off[:2], 1.0))
        is_above = off > 0.0
        passes = (is_above[1:] != is_above[:-1]) & np.isfinite(off[1:]) & np.isfinite(off[:-1])
        ranks = np.cumsum(passes, axis=0)
        for rank in range(1, int(ranks.max(initial=0)) + 1):
            which = np.flatnonzero(~is_done & (ranks[-1] >= rank))
            low = np.argmax(ranks[:, which] == rank, axis=0)
            ends = np.stack((lines[low], lines[low + 1])) + 0.5
            offs = np.stack((off[low, which], off[low + 1, which]))
            numbers, is_root = self._passed(points[which], ends, offs)
            is_sure[which[~is_root]] = False
            settle(which[is_root], numbers[is_root])
        which, numbers = self._beyond(off[:-3:-1], -1.0)
        is_open = ~is_done[which]
        settle(which[is_open], self._count - numbers[is_open])
        return found, is_sure

    def _beyond(self, off: Floats, sign: float) -> tuple[Integers, Floats]:
        """Return which points are seen before the middle of the first line, and in which line.

        ``off`` are the distances from the first line and the second one. With the sign -1 they are
        those from the last line and the last but one, and lines count backwards.
        """
        with np.errstate(invalid="ignore", divide="ignore"):
            if self._is_pushbroom:
                # As far as half a row points go on as from the one row to the other.
                numbers = 0.5 - off[0] / (off[1] - off[0])
                which = np.flatnonzero((numbers >= 0.0) & (numbers <= 0.5))
            else:
                # The camera stands, and sees the point where it sees it at the line's time.
                numbers = 0.5 + sign * off[0]
                which = np.flatnonzero(numbers <= 0.5)
        return which, numbers[which]

    def _passed(self, points: Floats, ends: Floats, offs: Floats) -> tuple[Floats, Bools]:
        """Return where points pass the line between two, and whether they do.

        It is the method of false position with the change that is called Illinois (Dowell and
        Jarratt, 1971), which keeps the root between two ends; where that is slow, bisection. What
        jumps over its line, as at the seam of a panorama, does not pass it.
        """
        numbers, is_root = np.full(len(points), np.nan), np.zeros(len(points), np.bool_)
        scale = np.abs(offs[1] - offs[0]) / (ends[1] - ends[0])
        open_ = np.arange(len(points))
        (a, b), (at_a, at_b) = ends.copy(), offs.copy()
        for step in range(_STEPS):
            if len(open_) == 0:
                break
            with np.errstate(invalid="ignore", divide="ignore"):
                middle = (a * at_b - b * at_a) / (at_b - at_a)
            if step >= _FALSE_POSITIONS:
                middle = 0.5 * (a + b)
            middle = np.clip(middle, a, b)
            some = points[open_]
            at = self._from_line(self._pixels(some, middle), middle)
            numbers[open_] = middle
            # Of NaN no comparison holds: such a point is no root, and its search is over.
            near = np.abs(at) <= _NO_ROOT * scale[open_]
            is_root[open_] = near
            goes_on = np.abs(at) > _PRECISION * scale[open_]
            goes_on &= b - a > _PRECISION
            is_left = (at > 0.0) == (at_a > 0.0)
            # The end that stays twice counts for half.
            at_a, at_b = np.where(is_left, at, 0.5 * at_a), np.where(is_left, 0.5 * at_b, at)
            a, b = np.where(is_left, middle, a), np.where(is_left, b, middle)
            open_ = open_[goes_on]
            a, b, at_a, at_b = a[goes_on], b[goes_on], at_a[goes_on], at_b[goes_on]
        return numbers, is_root

    def _pixels(self, points: Floats, numbers: Floats) -> Floats:
        """Return where the camera sees each point when it is at a place between lines."""
        poses = self._trajectory.at(self._time(numbers))
        own = np.einsum("nji,nj->ni", poses[:, :3, :3], points - poses[:, :3, 3])
        return project(self._camera, own)


def _parts(length: int, most: int) -> list[slice]:
    """Return parts of a list that are not longer than ``most``."""
    return [slice(first, min(first + most, length)) for first in range(0, length, most)]
