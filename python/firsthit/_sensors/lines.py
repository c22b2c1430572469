"""Projecting points into the pictures of cameras that move.

Each line of such a picture, a row or a column, has a time and a pose of its own. A point appears in
line s if the camera, at the time of line s, projects it into line s. So s is a root of v(s) - s,
where v(s) is the line into which the camera projects the point at the time of s. The root is
bracketed between lines and refined by the Illinois method (Dowell and Jarratt, "A modified regula
falsi method for computing the root of an equation", BIT 11, 1971).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .camera import Camera
from .moving import Pushbroom, RollingShutter
from .project import Reach, in_camera, picture, project, starts_towards

if TYPE_CHECKING:
    import numpy.typing as npt

    from .trajectory import Trajectory

    Floats = npt.NDArray[np.float64]
    Bools = npt.NDArray[np.bool_]
    Integers = npt.NDArray[np.intp]

#: A sensor whose pictures have lenses, and places for points.
PictureSensor = Camera | RollingShutter | Pushbroom

#: How many lines are sampled to see whether the residual v(s) - s is monotonic.
_PROBES = 17
#: How many projections are kept at a time.
_MOST_VALUES = 1 << 22
#: The tolerance of a root, in lines; and the residual above which a bracket holds a jump, no root.
_PRECISION, _NO_ROOT = 1e-10, 1e-3
#: Steps of the refinement. Those after the first few bisect.
_STEPS, _FALSE_POSITIONS = 60, 20


class Projected(NamedTuple):
    """Projections of points by a sensor; NaN where it does not see them."""

    #: Columns from the picture's left edge and rows from its upper edge, (..., 2).
    pixels: Floats
    #: Where the rays to the points start, in world space, (..., 3).
    starts: Floats
    #: How far they are from the camera's position along its aim, (...).
    z: Floats


def sight(sensor: PictureSensor, points: Floats) -> Projected:
    """Project points of the world, (..., 3), whether or not anything hides them.

    Of a moving camera it is the pose of the first line, in time, in which the picture shows the
    point; if none does, that of the first line's straight continuation beyond the border.
    """
    if isinstance(sensor, Camera):
        pixels, z = project(sensor, points), in_camera(sensor, points)[..., 2]
        return Projected(pixels, starts_towards(sensor, points), z)
    lines, flat = Lines(sensor), points.reshape(-1, 3)
    found = Projected(*(np.full((len(flat), *shape), np.nan) for shape in ((2,), (3,), ())))
    for part in _parts(len(flat), _MOST_VALUES // (2 * _PROBES)):
        at = lines.coordinates(flat[part])
        for whole, one in zip(found, lines.project_into(flat[part], at), strict=True):
            whole[part] = one
    leading = points.shape[:-1]
    return Projected(*(each.reshape(*leading, *each.shape[1:]) for each in found))


def sight_at(sensor: RollingShutter | Pushbroom, points: Floats, times: Floats) -> Projected:
    """Project points by a moving camera as it stands at a time for each, (...).

    Of a `Pushbroom` the rows are those of its camera, of which there is one.
    """
    flat = points.reshape(-1, 3)
    seen = _project_at(sensor.camera, sensor.trajectory, flat, times.reshape(-1))
    leading = points.shape[:-1]
    return Projected(*(each.reshape(*leading, *each.shape[1:]) for each in seen))


def at_middle_line(sensor: PictureSensor) -> Camera:
    """Return the camera as it stands at the time of the middle line, number ``lines // 2``."""
    if isinstance(sensor, Camera):
        return sensor
    times = sensor.times
    return sensor.camera.moved(sensor.trajectory.at(times[len(times) // 2]))


def _project_at(camera: Camera, trajectory: Trajectory, points: Floats, times: Floats) -> Projected:
    """Project each point, (n, 3), at a time of its own, (n,)."""
    poses = trajectory.at(times)
    turns, places = poses[:, :3, :3], poses[:, :3, 3]
    # The difference first: far from the origin the rest would be all rounding.
    own = np.einsum("nji,nj->ni", turns, points - places)
    starts = np.einsum("nij,nj->ni", turns, starts_towards(camera, own)) + places
    return Projected(project(camera, own), starts, in_camera(camera, own)[:, 2])


class Lines:
    """The lines of a moving camera.

    A line coordinate counts lines in the order of time: line k, from 0, has its middle at
    ``k + 0.5``. There the camera stands where it is at the line's time; between two middles time
    goes on evenly, and before the first and after the last it stands still.
    """

    def __init__(self, sensor: RollingShutter | Pushbroom) -> None:
        self._sensor, self._camera, self._trajectory = sensor, sensor.camera, sensor.trajectory
        self._shape = sensor.rows, sensor.columns
        times = sensor.times
        self._is_pushbroom = isinstance(sensor, Pushbroom)
        if isinstance(sensor, RollingShutter):
            self._axis = 1 if sensor.reads_rows else 0
            self._is_backwards = sensor.direction in ("bottom_up", "right_left")
        else:
            self._axis, self._is_backwards = 1, bool((np.diff(times) < 0.0).any())
        self._times = times[::-1] if self._is_backwards else times
        self._count = len(times)

    def part(self, corners: Floats) -> Reach:
        """Return pixels outside which no ray meets what the hull of points holds, (n, 3)."""
        whole = picture(self._sensor)
        if self._camera.projection not in ("perspective", "orthographic"):
            return whole
        poses = self._trajectory.at(self._sensor.times)
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

    def coordinates(self, points: Floats) -> Floats:
        """Return the line coordinate at which each of some points is seen, (n,): NaN if at none.

        Raises
        ------
        ValueError
            For a `Pushbroom` whose times neither increase nor decrease from row to row.
        """
        if self._is_pushbroom and (np.diff(self._times) <= 0.0).any():
            raise ValueError(
                "times of a Pushbroom must increase from row to row, or decrease, to tell in "
                "which row a point is"
            )
        probes = self._probes()
        found = np.full(len(points), np.nan)
        known = np.flatnonzero(np.isfinite(points).all(axis=1))
        if len(known) == 0:
            return found
        residuals = self._residuals(points[known], probes)
        steps = np.diff(residuals, axis=0)
        is_plain = np.asarray((steps > 0.0).all(axis=0) | (steps < 0.0).all(axis=0))
        if len(probes) == self._count:
            is_plain = np.ones_like(is_plain)
        plain = known[is_plain]
        found[plain], is_sure = self._first_root(points[plain], probes, residuals[:, is_plain])
        # A point that goes to and fro, or is not always seen, is looked for in every line.
        rough = np.concatenate((known[~is_plain], plain[~is_sure]))
        if len(probes) < self._count:
            every = np.arange(self._count)
            for part in _parts(len(rough), max(1, _MOST_VALUES // self._count)):
                some = points[rough[part]]
                of_every = self._residuals(some, every)
                found[rough[part]], _ = self._first_root(some, every, of_every)
        return found

    def project_into(self, points: Floats, coordinates: Floats) -> Projected:
        """Project each point at its line coordinate; NaN where that is."""
        found = Projected(*(np.full((len(points), *shape), np.nan) for shape in ((2,), (3,), ())))
        is_there = np.isfinite(coordinates)
        if is_there.any():
            times = self._time(coordinates[is_there])
            some = _project_at(self._camera, self._trajectory, points[is_there], times)
            for whole, one in zip(found, some, strict=True):
                whole[is_there] = one
            if self._is_pushbroom and self._count > 1:
                across, rows = found.pixels[:, 0], coordinates
                found.pixels[:, 1] = self._count - rows if self._is_backwards else rows
                found.pixels[np.isnan(across), 1] = np.nan
        return found

    def _probes(self) -> Integers:
        """Return lines between which the camera moves smoothly: some, and those beside poses."""
        last = self._count - 1
        even = np.linspace(0, last, _PROBES).round().astype(np.intp)
        at = np.interp(self._trajectory.times, self._times, np.arange(self._count))
        at = at[(at > 0) & (at < last)]
        ends = np.array([0, 1, last - 1, last])
        lines = np.concatenate((even, np.floor(at), np.ceil(at), ends))
        return np.unique(lines.clip(0, last).astype(np.intp))

    def _time(self, coordinates: Floats) -> Floats:
        middles = np.arange(self._count) + 0.5
        times = np.interp(coordinates, middles, self._times)
        # Rounding must not leave the trajectory.
        return np.clip(times, self._times.min(), self._times.max())

    def _residuals(self, points: Floats, lines: Integers) -> Floats:
        """Return v(s) - s at the middles of lines, (lines, points)."""
        residuals = np.empty((len(lines), len(points)))
        for row, line in enumerate(lines.tolist()):
            pose = self._trajectory.at(self._times[line])
            own = (points - pose[:3, 3]) @ pose[:3, :3]
            residuals[row] = self._residual(project(self._camera, own), line + 0.5)
        return residuals

    def _residual(self, pixels: Floats, coordinates: Floats | float) -> Floats:
        """Return v(s) - s of pixels that were projected at the line coordinates s."""
        across: Floats = pixels[..., self._axis]
        if self._is_pushbroom:
            # All rows are the camera's only one.
            return across - 0.5
        if self._is_backwards:
            across = self._shape[1 - self._axis] - across
        return across - coordinates

    def _first_root(
        self, points: Floats, lines: Integers, residuals: Floats
    ) -> tuple[Floats, Bools]:
        """Return the first line coordinate at which each point is seen, and whether it is certain.

        The first one in the picture is taken; or else the first one, beyond the picture's border.
        """
        found, is_done = np.full(len(points), np.nan), np.zeros(len(points), np.bool_)
        is_sure = np.ones(len(points), np.bool_)

        def settle(which: Integers, roots: Floats) -> None:
            pixels = self.project_into(points[which], roots).pixels
            with np.errstate(invalid="ignore"):
                is_in = (pixels >= 0.0).all(axis=1) & (pixels < self._shape[::-1]).all(axis=1)
            takes = which[is_in | np.isnan(found[which])]
            found[takes] = roots[is_in | np.isnan(found[which])]
            is_done[which[is_in]] = True

        if self._count == 1 and self._is_pushbroom:
            # One row is the picture of a camera that stands.
            return residuals[0] + 0.5, is_sure
        settle(*self._beyond(residuals[:2], 1.0))
        is_above = residuals > 0.0
        is_known = np.isfinite(residuals)
        brackets = (is_above[1:] != is_above[:-1]) & is_known[1:] & is_known[:-1]
        ranks = np.cumsum(brackets, axis=0)
        for rank in range(1, int(ranks.max(initial=0)) + 1):
            which = np.flatnonzero(~is_done & (ranks[-1] >= rank))
            low = np.argmax(ranks[:, which] == rank, axis=0)
            ends = np.stack((lines[low], lines[low + 1])) + 0.5
            at_ends = np.stack((residuals[low, which], residuals[low + 1, which]))
            roots, is_root = self._refined(points[which], ends, at_ends)
            is_sure[which[~is_root]] = False
            settle(which[is_root], roots[is_root])
        which, roots = self._beyond(residuals[:-3:-1], -1.0)
        is_open = ~is_done[which]
        settle(which[is_open], self._count - roots[is_open])
        return found, is_sure

    def _beyond(self, residuals: Floats, sign: float) -> tuple[Integers, Floats]:
        """Return which points are seen before the middle of the first line, and where.

        ``residuals`` are those of the first line and the second one. With the sign -1 they are
        those of the last line and the last but one, and line coordinates count backwards.
        """
        with np.errstate(invalid="ignore", divide="ignore"):
            if self._is_pushbroom:
                # As far as half a row points go on as from the one row to the other.
                roots = 0.5 - residuals[0] / (residuals[1] - residuals[0])
                which = np.flatnonzero((roots >= 0.0) & (roots <= 0.5))
            else:
                # The camera stands, and sees the point where it sees it at the line's time.
                roots = 0.5 + sign * residuals[0]
                which = np.flatnonzero(roots <= 0.5)
        return which, roots[which]

    def _refined(self, points: Floats, ends: Floats, at_ends: Floats) -> tuple[Floats, Bools]:
        """Return the roots within brackets, (2, n), and whether they are roots.

        The method of false position keeps the root between two ends. The residual of an end that
        stays a second time in a row counts for half, so that the other end moves soon (Illinois).
        Where that is slow, bisection takes over. A jump, as at the seam of a panorama, is no root.
        """
        roots, is_root = np.full(len(points), np.nan), np.zeros(len(points), np.bool_)
        scale = np.abs(at_ends[1] - at_ends[0]) / (ends[1] - ends[0])
        open_, moved = np.arange(len(points)), np.zeros(len(points), np.int8)
        (a, b), (at_a, at_b) = ends.copy(), at_ends.copy()
        for step in range(_STEPS):
            if len(open_) == 0:
                break
            with np.errstate(invalid="ignore", divide="ignore"):
                middle = (a * at_b - b * at_a) / (at_b - at_a)
            if step >= _FALSE_POSITIONS:
                middle = 0.5 * (a + b)
            middle = np.clip(middle, a, b)
            at = self._residual(self._pixels(points[open_], middle), middle)
            roots[open_] = middle
            # Of NaN no comparison holds: such a point is no root, and its search is over.
            is_root[open_] = np.abs(at) <= _NO_ROOT * scale[open_]
            goes_on = np.abs(at) > _PRECISION * scale[open_]
            goes_on &= b - a > _PRECISION
            is_left = (at > 0.0) == (at_a > 0.0)
            moves = np.where(is_left, 1, -1).astype(np.int8)
            half = np.where(moves == moved, 0.5, 1.0)
            at_a, at_b = np.where(is_left, at, half * at_a), np.where(is_left, half * at_b, at)
            a, b = np.where(is_left, middle, a), np.where(is_left, b, middle)
            open_, moved = open_[goes_on], moves[goes_on]
            a, b, at_a, at_b = a[goes_on], b[goes_on], at_a[goes_on], at_b[goes_on]
        return roots, is_root

    def _pixels(self, points: Floats, coordinates: Floats) -> Floats:
        """Return where the camera projects each point at its line coordinate."""
        poses = self._trajectory.at(self._time(coordinates))
        own = np.einsum("nji,nj->ni", poses[:, :3, :3], points - poses[:, :3, 3])
        return project(self._camera, own)


def _parts(length: int, most: int) -> list[slice]:
    """Return parts of a list that are not longer than ``most``."""
    return [slice(first, min(first + most, length)) for first in range(0, length, most)]
