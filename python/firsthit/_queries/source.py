"""The source of hits' rays, and the quantities that are computed from them later."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import chunks
from firsthit._base.memory import SMALL, empty
from firsthit._base.progress import later
from firsthit._sensors.camera import Camera

from .rays import Rays

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy.typing as npt

    from firsthit._base.progress import Report
    from firsthit._objects.traceable import Built
    from firsthit._sensors.sensor import Sensor

#: Channels that are neither float64 nor one of the arrays.
_DTYPES: dict[str, type[np.generic]] = {
    "front": np.bool_,
    "valid": np.bool_,
    **dict.fromkeys(("face", "node", "mesh", "material"), np.int32),
}

#: Below so many rays, four arrays of theirs are nothing to the system.
_FEW = SMALL // 16


def hits_arrays(length: int) -> _firsthit._Hits:
    """Return uninitialised arrays for ``length`` hits."""
    # `empty` would do the same for few, but its checks take 1 us of the 11 of a call with one ray.
    make: Callable[..., npt.NDArray[Any]] = np.empty if length < _FEW else empty
    return (
        make((length,), np.float64),
        make((length,), np.int32),
        make((length,), np.int32),
        make((length, 2), np.float64),
    )


def some_of(arrays: _firsthit._Hits, rows: slice | npt.NDArray[np.int64]) -> _firsthit._Hits:
    """Return some of the hits."""
    t, identifiers, primitive, barycentric = arrays
    return t[rows], identifiers[rows], primitive[rows], barycentric[rows]


class Source:
    """The rays of some hits: the centres of all or some pixels of a camera, or rays in arrays.

    ``pixels`` are the camera's, counted row by row, (n,) int64, where they are not all. ``rays``
    are there where no camera makes them, or they are not the centres of pixels.
    """

    __slots__ = ("_made", "camera", "pixels", "rays")

    def __init__(
        self,
        camera: Sensor | None = None,
        pixels: npt.NDArray[np.int64] | None = None,
        rays: Rays | None = None,
    ) -> None:
        self.camera, self.pixels, self.rays = camera, pixels, rays
        #: Origins and directions of pixels, once they were asked for.
        self._made: dict[str, tuple[npt.NDArray[Any], npt.NDArray[Any]]] = {}

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle without what can be computed again."""
        return Source, (self.camera, self.pixels, self.rays)

    @property
    def is_whole(self) -> bool:
        """Whether these are the centres of all pixels of a camera, in their places."""
        return self.rays is None and self.pixels is None

    def rows_and_columns(self, length: int) -> tuple[npt.NDArray[Any], npt.NDArray[Any]] | None:
        """Return the rows and columns of the pixels of ``length`` rays, if they are known."""
        if self.camera is None or (self.rays is not None and self.pixels is None):
            return None
        pixels = np.arange(length) if self.pixels is None else self.pixels
        return np.divmod(pixels, self.camera.columns)

    def take(self, chosen: npt.NDArray[np.intp], shape: tuple[int, ...]) -> Source:
        """Return the source of some of the rays, by their numbers, in another shape."""
        if self.is_whole:
            return Source(self.camera, chosen)
        pixels = None if self.pixels is None else self.pixels[chosen]
        rays = None if self.rays is None else self.rays.take(chosen, shape)
        return Source(self.camera, pixels, rays)

    def both(self) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
        """Return origins and directions."""
        if self.rays is not None:
            return self.rays.origins(), self.rays.directions()
        if "both" not in self._made:
            camera, pixels = self._camera_of("origin"), self.pixels
            if pixels is None:
                both = camera.rays()
            else:
                both = _firsthit.rays_of_pixels(camera._native, pixels)
            # Another thread may have made them meanwhile: the first are everyone's.
            self._made.setdefault("both", both)
        return self._made["both"]

    def compute(
        self, name: str, built: Built, arrays: _firsthit._Hits, threads: int, report: Report | None
    ) -> npt.NDArray[Any]:
        """Compute a channel of the hits in ``arrays``, flat."""
        if self.is_whole:
            camera = self._camera_of(name)._native
            return _firsthit.channel(built.native, name, None, camera, arrays, threads, report)
        if name in ("range", "z"):
            distances = self._distances(name, built, arrays, threads)
            if report is not None:
                report(len(distances))
            return distances
        return self._compute_of_rays(name, built, arrays, threads, report)

    def _camera_of(self, name: str) -> Sensor:
        if self.camera is None:
            raise AttributeError(f"{name} is for hits of a camera: rays alone do not know of one")
        if name == "z" and not self.camera.has_aim:
            kind = type(self.camera).__name__
            raise AttributeError(f"z is along the aim of a camera, and this {kind} has none")
        return self.camera

    def _distances(
        self, name: str, built: Built, arrays: _firsthit._Hits, threads: int
    ) -> npt.NDArray[np.float64]:
        camera, (t, identifiers, *_) = self._camera_of(name), arrays
        if self.rays is None and self.pixels is not None:
            is_range = name == "range"
            return _firsthit.distances_of_pixels(camera._native, is_range, self.pixels, t)
        if not isinstance(camera, Camera):
            return self._distances_of_places(name, camera, t)
        if name == "z" or camera.projection == "orthographic":
            flat = self._compute_of_rays("position", built, arrays, threads, None)
            along = (flat.reshape(-1, 3) - camera.position) @ camera.aim
            return np.where(identifiers < 0, np.inf, along)
        start = self.both()[0].reshape(-1, 3)
        behind = np.linalg.norm(start - camera.position, axis=-1)
        distances: npt.NDArray[np.float64] = t + behind
        return distances

    def _distances_of_places(
        self, name: str, sensor: Sensor, t: npt.NDArray[np.float64]
    ) -> npt.NDArray[np.float64]:
        """Return distances from where a sensor is at the time of each pixel's ray."""
        starts, ways = (array.reshape(-1, 3) for array in self.both())
        pixels = np.arange(len(t)) if self.pixels is None else self.pixels
        places = sensor._native.places(pixels).reshape(-1, 6)  # type: ignore[union-attr]
        length = np.linalg.norm(ways, axis=-1)
        with np.errstate(all="ignore"):
            along = ways / length[:, None]
            behind = ((starts - places[:, :3]) * along).sum(axis=-1)
            far = t * length + behind
            if name == "z":
                far = far * (along * places[:, 3:]).sum(axis=-1)
        distances: npt.NDArray[np.float64] = np.where(np.isinf(t), np.inf, far)
        return distances

    def _compute_of_rays(
        self, name: str, built: Built, arrays: _firsthit._Hits, threads: int, report: Report | None
    ) -> npt.NDArray[Any]:
        rays = self.rays if self.rays is not None else Rays.of(*self.both())
        pieces = []
        for part in chunks(rays.length):
            hits = tuple(np.ascontiguousarray(array[part]) for array in arrays)
            told = later(report, part.start)
            native = rays.part(part, limits=False)
            pieces.append(_firsthit.channel(built.native, name, native, None, hits, threads, told))
        if len(pieces) == 1:
            return pieces[0]
        return np.concatenate(pieces) if pieces else np.empty(0, _DTYPES.get(name, np.float64))
