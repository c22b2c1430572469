"""Colours that a user's function gives."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from firsthit import _firsthit
from firsthit._base.progress import later
from firsthit._base.region import Region
from firsthit._queries.rays import Rays
from firsthit._queries.shoot import shoot_camera, shoot_rays
from firsthit._queries.source import Source

from .draws import Draws, takes_draws

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    import numpy.typing as npt

    from firsthit._base.progress import Report
    from firsthit._objects.filters import Filters
    from firsthit._objects.traceable import Built
    from firsthit._queries.hits import Hits
    from firsthit._sensors.sensor import Sensor
    from firsthit.typing import OwnShade

#: About how many rays an own shader sees at a time when there are several samples.
_BATCH = 1 << 18


class OwnShading(NamedTuple):
    """The colours that a user's function gives to the pixels of a region."""

    built: Built
    filters: Filters | None
    camera: Sensor
    region: Region
    shade: OwnShade
    threads: int

    def centres(self, report: Report | None) -> npt.NDArray[np.float32]:
        """Return the colours of the pixels' centres."""
        camera = self.camera
        is_whole = self.region == Region(0, camera.rows, 0, camera.columns)
        if is_whole and self.filters is None:
            hits = shoot_camera(self.built, camera, self.threads, report)
        else:
            source = Source(camera, self._pixels(self.region.top, self.region.bottom).reshape(-1))
            grids = (array.reshape(*self.region.shape, 3) for array in source.both())
            rays = Rays.of(*grids, filters=self.filters)
            hits = shoot_rays(self.built, rays, self.threads, report, source)
        pixels = self._pixels(self.region.top, self.region.bottom)
        return np.ascontiguousarray(self._colors(hits, pixels, 0), np.float32)

    def means(self, samples: int, report: Report | None) -> npt.NDArray[np.float32]:
        """Return the means of the colours of ``samples`` points of each pixel."""
        colors = np.empty((*self.region.shape, 3), np.float32)
        done = 0
        for row, last in self._batches():
            total = np.zeros((last - row, self.region.shape[1], 3))
            done = self._add(total, row, range(samples), report, done)
            colors[row - self.region.top : last - self.region.top] = total / samples
        return colors

    def add(
        self, sums: npt.NDArray[np.float64], samples: range, report: Report | None
    ) -> npt.NDArray[np.float32]:
        """Add some samples to the sums of those before, and return the means of all."""
        colors = np.empty(sums.shape, np.float32)
        done = 0
        for row, last in self._batches():
            part = slice(row - self.region.top, last - self.region.top)
            done = self._add(sums[part], row, samples, report, done)
            colors[part] = sums[part] / samples.stop
        return colors

    def _batches(self) -> Iterator[tuple[int, int]]:
        """Yield rows, and those behind the last, that are shaded together."""
        # The rays of whole rows are made, of which those of the region are shot.
        step = max(1, _BATCH // self.camera.columns)
        for row in range(self.region.top, self.region.bottom, step):
            yield row, min(row + step, self.region.bottom)

    def _add(
        self,
        total: npt.NDArray[np.float64],
        row: int,
        samples: range,
        report: Report | None,
        done: int,
    ) -> int:
        """Add samples of some rows to their sums; return how many rays are done then."""
        last, camera = row + len(total), self.camera
        pixels = self._pixels(row, last)
        for sample in samples:
            both = _firsthit.rays_of_rows(camera._native, (row, last), sample)
            grids = (array.reshape(last - row, camera.columns, 3) for array in both)
            grids = (grid[:, self.region.left : self.region.right] for grid in grids)
            rays = Rays.of(*grids, filters=self.filters)
            source = Source(camera, pixels.reshape(-1), rays)
            hits = shoot_rays(self.built, rays, self.threads, later(report, done), source)
            total += self._colors(hits, pixels, sample)
            done += rays.length
        return done

    def _pixels(self, row: int, last: int) -> npt.NDArray[np.int64]:
        """Return the numbers of the region's pixels in some rows."""
        columns = np.arange(self.region.left, self.region.right)
        return np.arange(row, last)[:, None] * self.camera.columns + columns

    def _colors(
        self, hits: Hits, pixels: npt.NDArray[np.int64], sample: int
    ) -> npt.NDArray[np.float64]:
        shade: Callable[..., npt.ArrayLike] = self.shade
        given = shade(hits, Draws(pixels, sample)) if takes_draws(shade) else shade(hits)
        colors = np.asarray(given)
        wanted = (*hits.shape, 3)
        if colors.dtype.kind not in "fiub":
            raise ValueError(f"shade must return real numbers, got dtype {colors.dtype}")
        if colors.shape != wanted:
            raise ValueError(f"shade must return colours of shape {wanted}, got {colors.shape}")
        return colors.astype(np.float64, copy=False)
