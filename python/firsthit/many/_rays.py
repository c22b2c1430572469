"""The source of a job's rays: arrays, sensors, or files."""

from __future__ import annotations

import bisect
import itertools
import json
import math
import os
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import cast, numbers
from firsthit._parts.digest import Digests, of_arrays, of_json
from firsthit._scene.scene import Scene
from firsthit._sensors.sensor import Sensor

from ._ray_files import RayFile, ray_files
from ._shared_arrays import SharedArrays

if TYPE_CHECKING:
    from pathlib import Path

    import numpy.typing as npt


def digest_of(cameras: Sequence[Sensor]) -> str:
    """Return the sha256 of cameras and other sensors, in their order."""
    made, nothing = Digests(), Scene()._ready().native
    for camera in cameras:
        if not isinstance(camera, Sensor):
            raise TypeError(f"cameras must be cameras or other sensors, got {camera!r}")
        said = json.loads(_firsthit.origin(nothing, camera._native, []))
        made.add(of_json([said.get("camera"), said.get("sensor")]))
    return made.text()


class Batch(NamedTuple):
    """Rays in arrays: (n, 3) origins and directions, and limits for all or (n,) for each."""

    origins: npt.NDArray[np.float64]
    directions: npt.NDArray[np.float64]
    t_min: npt.NDArray[np.float64]
    t_max: npt.NDArray[np.float64]

    @classmethod
    def of(cls, rays: Any) -> Batch:
        """Return rays that a user gave: a pair, or arrays by name.

        Raises
        ------
        ValueError, TypeError
            For what is neither, and arrays that do not fit together.
        """
        if isinstance(rays, Mapping):
            named = dict(rays)
        elif isinstance(rays, tuple | list) and len(rays) == 2:
            named = {"origins": rays[0], "directions": rays[1]}
        else:
            raise TypeError(f"rays must be (origins, directions) or arrays by name, got {rays!r}")
        unknown = set(named) - set(cls._fields)
        if unknown or not {"origins", "directions"} <= set(named):
            known = ", ".join(cls._fields)
            raise ValueError(f"rays must have {known}, got {', '.join(map(str, named))}")
        arrays = {name: numbers(name, array) for name, array in named.items()}
        for name in ("origins", "directions"):
            if arrays[name].shape[-1:] != (3,):
                raise ValueError(f"{name} must have the shape (..., 3), got {arrays[name].shape}")
        lengths = [arrays["origins"].shape[:-1], arrays["directions"].shape[:-1]]
        lengths += [arrays[name].shape for name in ("t_min", "t_max") if name in arrays]
        try:
            shape = np.broadcast_shapes(*lengths)
        except ValueError:
            raise ValueError(f"rays must broadcast against each other, got {lengths}") from None
        flat = {name: _flat(array, shape, name) for name, array in arrays.items()}
        return cls(
            flat["origins"],
            flat["directions"],
            flat.get("t_min", np.zeros(())),
            flat.get("t_max", np.full((), math.inf)),
        )

    def take(self, first: int, last: int) -> Batch:
        """Return some of them."""
        return Batch(
            self.origins[first:last],
            self.directions[first:last],
            *(each if each.ndim == 0 else each[first:last] for each in self[2:]),
        )

    def digest(self) -> str:
        """Return the sha256 of the rays."""
        return of_arrays(self._asdict())


def _flat(array: npt.NDArray[Any], shape: tuple[int, ...], name: str) -> npt.NDArray[np.float64]:
    """Return vectors as (n, 3), and limits as (n,) or, where one is for all, as ()."""
    plain = cast(array, np.float64)
    if name in ("origins", "directions"):
        return np.broadcast_to(plain, (*shape, 3)).reshape(-1, 3)
    return plain.reshape(()) if plain.size == 1 else np.broadcast_to(plain, shape).reshape(-1)


class RaySource(ABC):
    """Rays of a job, of which a worker makes those of a part."""

    #: How many parts there are.
    parts: int

    @abstractmethod
    def said(self) -> dict[str, Any]:
        """Return what the file of the job says of them."""

    def share(self, folder: Path) -> None:  # noqa: B027 - most share nothing
        """Write what workers in other processes read, to a folder."""

    def given(self, part: int) -> Any:
        """Return what a worker needs for a part beside this source, if anything."""
        return None

    @abstractmethod
    def batch(self, part: int, given: Any) -> Batch:
        """Return the rays of a part, in a worker."""


def source_of(rays: Any, size: int) -> RaySource:
    """Return the source of what a user gave, in parts of ``size`` rays."""
    is_one = isinstance(rays, Sensor | str | os.PathLike)
    several: list[Any] = [rays] if is_one else list(rays) if isinstance(rays, Sequence) else []
    if several and all(isinstance(one, Sensor) for one in several):
        return _OfSensors(several, size)
    if several and all(isinstance(one, str | os.PathLike) for one in several):
        return _OfFiles(ray_files(rays), size)
    return _OfArrays(Batch.of(rays), size)


class _OfArrays(RaySource):
    """Rays that are in memory here, and for other processes in files that they map."""

    def __init__(self, rays: Batch, size: int) -> None:
        self._arrays, self._size = SharedArrays(rays._asdict()), size
        self._length = len(rays.origins)
        self.parts = math.ceil(self._length / size)

    def said(self) -> dict[str, Any]:
        return {"kind": "arrays", "rays": self._length, "digest": self._arrays.digest()}

    def share(self, folder: Path) -> None:
        self._arrays.share(folder)

    def batch(self, part: int, given: Any) -> Batch:
        rays = Batch(*(self._arrays[name] for name in Batch._fields))
        return rays.take(part * self._size, (part + 1) * self._size)


class _OfSensors(RaySource):
    """The rays of the pixels of sensors, one sensor after the other, row by row."""

    def __init__(self, sensors: list[Sensor], size: int) -> None:
        self._sensors, self._size = sensors, size
        counts = (sensor.rows * sensor.columns for sensor in sensors)
        self._ends = list(itertools.accumulate(counts))
        self.parts = math.ceil(self._ends[-1] / size)

    def said(self) -> dict[str, Any]:
        digest = digest_of(self._sensors)
        return {"kind": "sensors", "rays": self._ends[-1], "digest": digest}

    def given(self, part: int) -> list[tuple[Sensor, int, int]]:
        """Return the sensors of a part, each with its first pixel and the one behind its last."""
        first, last = part * self._size, min((part + 1) * self._size, self._ends[-1])
        pieces = []
        while first < last:
            k = bisect.bisect_right(self._ends, first)
            before = self._ends[k - 1] if k else 0
            end = min(last, self._ends[k])
            pieces.append((self._sensors[k], first - before, end - before))
            first = end
        return pieces

    def batch(self, part: int, given: Any) -> Batch:
        made = [
            _firsthit.rays_of_pixels(one._native, np.arange(first, end))
            for one, first, end in given
        ]
        origins, directions = (
            np.concatenate(both).reshape(-1, 3) for both in zip(*made, strict=True)
        )
        return Batch(origins, directions, np.zeros(()), np.full((), math.inf))

    def __getstate__(self) -> dict[str, Any]:
        """Pickle without the sensors: each part gets its own."""
        return {**self.__dict__, "_sensors": [], "_ends": []}


class _OfFiles(RaySource):
    """Rays in files. No part has rays of two of them."""

    def __init__(self, files: list[RayFile], size: int) -> None:
        self._files, self._size = files, size
        counts = (math.ceil(file.rows / size) for file in files)
        self._ends = list(itertools.accumulate(counts))
        self.parts = self._ends[-1]

    def said(self) -> dict[str, Any]:
        files = [[file.path.name, file.rows, *file.ends()] for file in self._files]
        return {
            "kind": "files",
            "rays": sum(file.rows for file in self._files),
            "digest": of_json(files),
        }

    def batch(self, part: int, given: Any) -> Batch:
        k = bisect.bisect_right(self._ends, part)
        file = self._files[k]
        first = (part - (self._ends[k - 1] if k else 0)) * self._size
        return Batch.of(file.rays(first, min(first + self._size, file.rows)))
