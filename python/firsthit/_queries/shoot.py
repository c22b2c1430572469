"""Queries of rays in a scene."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import fits, numbers, threads_or_all
from firsthit._base.progress import following, later
from firsthit._base.region import check_pixels
from firsthit._base.rounding import is_single
from firsthit._sensors.camera import warn_before_viewplane
from firsthit._sensors.sensor import Sensor

from .hits import Hits
from .leaving import rays_of
from .source import Source, hits_arrays, some_of

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy.typing as npt

    from firsthit._base.progress import Report
    from firsthit._objects.traceable import Built
    from firsthit.typing import Progress

    from .rays import Rays

_Scalar = TypeVar("_Scalar", bound=np.generic)


def first_hits(
    built: Built,
    given: tuple[Any, ...],
    threads: int | None,
    progress: Progress | None,
    dtype: npt.DTypeLike | None,
) -> Hits:
    """Find the first hit of each ray; ``given`` is as `rays_of` has it."""
    use = threads_or_all(threads)
    single = dtype is not None and is_single(dtype)
    if isinstance(given[0], Sensor):
        origins, directions, t_min, t_max, *filters = given
        if directions is not None:
            raise ValueError("directions must be left out with a camera, which has its own")
        check_pixels(*origins.shape)
        limits = [numbers("t_min", t_min), numbers("t_max", t_max)]
        for name, limit in zip(("t_min", "t_max"), limits, strict=True):
            if not fits(limit.shape, (origins.rows, origins.columns)):
                raise ValueError(f"{name} {limit.shape} must broadcast to the camera's pixels")
        is_open = np.all(limits[0] == 0.0) and np.all(limits[1] == math.inf)
        length = origins.rows * origins.columns
        with following(progress, length) as report:
            if is_open and all(option is None for option in filters):
                hits = shoot_camera(built, origins, use, report)
                if not (hits.object >= 0).any():
                    warn_before_viewplane(built.native, origins)
            else:
                rays = rays_of(origins, None, *limits, *filters)
                limits = list(rays.arrays[2:])
                hits = shoot_rays(built, rays, use, report, Source(origins))
        return hits._rounded(*limits) if single else hits
    rays = rays_of(*given)
    # Hits keep the rays without their limits.
    t_limits = rays.arrays[2:]
    if progress is None:
        # Without a context manager, which takes 1 us of the 11 of a call with one ray.
        hits = shoot_rays(built, rays, use, None)
    else:
        with following(progress, rays.length) as report:
            hits = shoot_rays(built, rays, use, report)
    return hits._rounded(*t_limits) if single else hits


def answers(
    ask: Callable[..., None],
    dtype: type[_Scalar],
    built: Built,
    rays: Rays,
    threads: int | None,
    progress: Progress | None,
) -> npt.NDArray[_Scalar]:
    """Return what the native half answers to a query, a number for each ray."""
    use = threads_or_all(threads)
    answers = np.empty(rays.length, dtype)
    with following(progress, rays.length) as report:
        for part in rays.parts():
            told = later(report, part.start)
            ask(built.native, rays.part(part), use, answers[part], told)
    # Of one ray, a number.
    return answers.reshape(rays.shape)[()]


def shoot_camera(built: Built, camera: Sensor, threads: int, report: Report | None) -> Hits:
    """Shoot a sensor's rays at what was built."""
    out = hits_arrays(camera.rows * camera.columns)
    _firsthit.shoot_camera(built.native, camera._native, threads, out, report)
    return Hits._of(built, out, Source(camera), (camera.rows, camera.columns), threads)


def shoot_rays(
    built: Built, rays: Rays, threads: int, report: Report | None, source: Source | None = None
) -> Hits:
    """Shoot rays at what was built. Without a source, the rays are their own."""
    native = built.native
    out = hits_arrays(rays.length)
    # The hits keep the rays, from which they compute what is asked later.
    copies = rays.own()
    parts = rays.parts()
    if len(parts) == 1:
        _firsthit.shoot(native, rays.part(parts[0]), copies, threads, out, report)
    else:
        for part in parts:
            told, pieces = later(report, part.start), some_of(out, part)
            _firsthit.shoot(native, rays.part(part), copies, threads, pieces, told)
    kept = rays.keep(copies)
    return Hits._of(built, out, source or Source(None, None, kept), rays.shape, threads)
