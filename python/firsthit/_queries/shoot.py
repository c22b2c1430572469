"""Queries of rays in a scene."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeVar, overload

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import count, fits, numbers, threads_or_all
from firsthit._base.progress import following, later
from firsthit._base.region import check_pixels
from firsthit._base.rounding import is_single
from firsthit._objects.traceable import Traceable
from firsthit._sensors.camera import warn_before_viewplane
from firsthit._sensors.sensor import Sensor

from .all_hits import shoot_all, shoot_nearest
from .hits import Hits
from .leaving import rays_of
from .source import Source, hits_arrays

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy.typing as npt

    from firsthit._base.progress import Report
    from firsthit._base.types import Progress, Selection, Side
    from firsthit._objects.traceable import Built

    from .all_hits import AllHits
    from .leaving import LeavingRays
    from .rays import Rays

_Scalar = TypeVar("_Scalar", bound=np.generic)


class Queries(Traceable):
    """The part of `Scene` that shoots."""

    def shoot(
        self,
        origins: npt.ArrayLike | Sensor | LeavingRays,
        directions: npt.ArrayLike | None = None,
        *,
        t_min: npt.ArrayLike = 0.0,
        t_max: npt.ArrayLike = math.inf,
        mask: npt.ArrayLike | None = None,
        cull: Side | None = None,
        skip: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
        objects: Selection | None = None,
        blend_below: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
        dtype: npt.DTypeLike | None = None,
    ) -> Hits:
        """Find the first hit of each ray.

        Parameters
        ----------
        origins, directions : (..., 3) array_like
            The rays, in world space, of any real type; they broadcast against each other.
            Directions have any length but zero, and ``t`` is in units of that length. Instead of
            both, a `Camera` or another sensor alone stands for the rays of its pixels, and
            `LeavingRays` (`Hits.leave`) for rays that start on surfaces. The hits keep copies, so
            that arrays may be changed afterwards.
        t_min, t_max : (...) array_like
            Limits of the rays: hits have ``t_min < t <= t_max``. With a ``t_min`` of zero, a ray
            does not meet a surface on which its origin lies exactly; a rounded origin is to one
            side of the surface (see `Hits.leave`). With a negative ``t_min`` it does, and it meets
            what is behind the origin, down to ``t_min``. A camera's rays with limits, a ``cull`` or
            a ``skip`` are shot one by one, which takes longer than in tiles.
        mask : (...) array_like of int, optional
            A ray meets the objects whose mask (`add`) has a bit in common with its own, of 32 bits;
            every object if left out. One mask for all rays costs nothing.
        cull : {"front", "back"}, optional
            The side of surfaces that rays pass through: the front is where the normal points.
        skip : pair of (...) array_like of int, optional
            The object and primitive that each ray passes through, -1 where there is none: a
            triangle wholly; of any other shape only the crossing nearest to the ray's origin. To go
            on from a hit, `Hits.leave` is the exact way.
        objects : int, str, or sequence of them, optional
            The identifiers or names of the only objects that the rays meet; all if left out.
        blend_below : float, optional
            Take the materials of meshes with the alpha mode ``blend`` as alpha masks with this
            cutoff, from 0 to 1: where their alpha is below it, rays pass. If left out, rays meet
            translucent surfaces as if they were opaque.
        threads : int, optional
            The number of threads, here and for the attributes of the hits; all cores if left out.
            The result is the same for any number.
        progress : bool or callable, optional
            ``True`` shows a bar, by tqdm if that is installed. A function is called with the number
            of rays that are done and the number of all rays, in the calling thread, about twenty
            times a second and at the end. An exception that it raises ends the work.
        dtype : {float64, float32}, optional
            The type of ``t``, ``range`` and ``z``; float64 if left out, whatever the rays' type.
            Everything is computed in float64 in any case. The float32 is the nearest one, with two
            exceptions. The distance of a hit stays finite, and zero only if it is zero. And if
            rounding takes ``t`` out of its limits, it is the next float32 within them; if there is
            none, the one below ``t_max``. Rays that go on from a hit need its float64 ``t``: a
            float32 may lie before the surface.

        Returns
        -------
        Hits
            Of the rays' shape. A ray with a zero direction, a NaN or an infinite component, or
            ``t_min >= t_max`` is a miss; other rays are not affected.

        Raises
        ------
        ValueError
            For arrays whose shapes or types do not fit, with their names, for another dtype, and
            for a name in ``objects`` that no object has.
        IndexError
            For an identifier in ``objects`` that no object has, or one that was removed.
        TypeError
            For ``objects`` that are no identifiers and no names, and for a progress that is no bool
            and no function.
        MemoryError
            If the hits do not fit into memory.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> hits = scene.shoot([[0, 0, 3], [0.6, 0, 3]], [0, 0, -1])
        >>> hits.t
        array([2. , 2.2])
        >>> hits.normal[0]
        array([0., 0., 1.])
        """
        use = threads_or_all(threads)
        single = dtype is not None and is_single(dtype)
        masks = mask if mask is None or np.ndim(mask) else None
        built = self._seen(self._ready(), mask, objects, blend_below)
        if isinstance(origins, Sensor):
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
                if is_open and all(option is None for option in (masks, cull, skip)):
                    hits = shoot_camera(built, origins, use, report)
                    if not (hits.object >= 0).any():
                        warn_before_viewplane(built.native, origins)
                else:
                    rays = rays_of(origins, None, *limits, masks=masks, cull=cull, skip=skip)
                    limits = list(rays.arrays[2:])
                    hits = shoot_rays(built, rays, use, report, Source(origins))
            return hits._rounded(*limits) if single else hits
        rays = rays_of(origins, directions, t_min, t_max, masks=masks, cull=cull, skip=skip)
        limits = list(rays.arrays[2:])
        if progress is None:
            # Without a context manager, which takes 1 us of the 11 of a call with one ray.
            hits = shoot_rays(built, rays, use, None)
        else:
            with following(progress, rays.length) as report:
                hits = shoot_rays(built, rays, use, report)
        return hits._rounded(*limits) if single else hits

    def occluded(
        self,
        origins: npt.ArrayLike | Sensor | LeavingRays,
        directions: npt.ArrayLike | None = None,
        *,
        t_min: npt.ArrayLike = 0.0,
        t_max: npt.ArrayLike = math.inf,
        mask: npt.ArrayLike | None = None,
        cull: Side | None = None,
        skip: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
        objects: Selection | None = None,
        blend_below: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> npt.NDArray[np.bool_]:
        """Tell whether each ray meets anything: faster than `shoot`, for shadows and visibility.

        Parameters
        ----------
        origins, directions, t_min, t_max, mask, cull, skip, objects
            As for `shoot`.
        blend_below, threads, progress
            As for `shoot`. The rays of a camera have the shape (rows, columns).

        Returns
        -------
        (...) array of bool
            Whether there is a hit with ``t_min < t <= t_max``.

        Raises
        ------
        ValueError, IndexError, TypeError
            As `shoot`.
        MemoryError
            If the answers do not fit into memory.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> eye, target = (0, 0, 5), (0, 0, 2)
        >>> bool(scene.occluded(eye, [0, 0, -3], t_max=1.0))  # is the target seen?
        False
        """
        masks = mask if mask is None or np.ndim(mask) else None
        rays = rays_of(origins, directions, t_min, t_max, masks=masks, cull=cull, skip=skip)
        # Once: what others add meanwhile is for the next call.
        native = self._seen(self._ready(), mask, objects, blend_below).native
        return _answers(_firsthit.occluded, np.bool_, native, rays, threads, progress)

    def count(
        self,
        origins: npt.ArrayLike | Sensor | LeavingRays,
        directions: npt.ArrayLike | None = None,
        *,
        t_min: npt.ArrayLike = 0.0,
        t_max: npt.ArrayLike = math.inf,
        mask: npt.ArrayLike | None = None,
        cull: Side | None = None,
        skip: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
        objects: Selection | None = None,
        blend_below: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> npt.NDArray[np.int64]:
        """Count how often each ray crosses a surface.

        Each crossing counts once: at an edge or a corner, the triangles that a ray infinitely
        little beside it would cross. So a ray enters a closed mesh as often as it leaves, and one
        that only grazes it counts none or two. A solid that is not a mesh is crossed at both ends.
        Surfaces in the same place count each.

        Parameters
        ----------
        origins, directions, t_min, t_max, mask, cull, skip, objects
            As for `shoot`.
        blend_below, threads, progress
            As for `shoot`. The rays of a camera have the shape (rows, columns).

        Returns
        -------
        (...) array of int64
            The number of crossings with ``t_min < t <= t_max``.

        Raises
        ------
        ValueError, IndexError, TypeError
            As `shoot`.
        MemoryError
            If the answers do not fit into memory.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> scene.count([[0, 0, 5], [0, 0, 0], [0, 2, 5]], [0, 0, -1])
        array([2, 1, 0])
        """
        masks = mask if mask is None or np.ndim(mask) else None
        rays = rays_of(origins, directions, t_min, t_max, masks=masks, cull=cull, skip=skip)
        # Once: what others add meanwhile is for the next call.
        native = self._seen(self._ready(), mask, objects, blend_below).native
        counts = _answers(_firsthit.count, np.uint32, native, rays, threads, progress)
        # Of unsigned numbers, one less than none is four billion.
        return counts.astype(np.int64)

    @overload
    def shoot_all(
        self,
        origins: npt.ArrayLike | Sensor | LeavingRays,
        directions: npt.ArrayLike | None = None,
        k: None = None,
        *,
        t_min: npt.ArrayLike = 0.0,
        t_max: npt.ArrayLike = math.inf,
        mask: npt.ArrayLike | None = None,
        cull: Side | None = None,
        skip: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
        objects: Selection | None = None,
        blend_below: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> AllHits: ...

    @overload
    def shoot_all(
        self,
        origins: npt.ArrayLike | Sensor | LeavingRays,
        directions: npt.ArrayLike | None,
        k: int,
        *,
        t_min: npt.ArrayLike = 0.0,
        t_max: npt.ArrayLike = math.inf,
        mask: npt.ArrayLike | None = None,
        cull: Side | None = None,
        skip: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
        objects: Selection | None = None,
        blend_below: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Hits: ...

    @overload
    def shoot_all(
        self,
        origins: npt.ArrayLike | Sensor | LeavingRays,
        directions: npt.ArrayLike | None = None,
        *,
        k: int,
        t_min: npt.ArrayLike = 0.0,
        t_max: npt.ArrayLike = math.inf,
        mask: npt.ArrayLike | None = None,
        cull: Side | None = None,
        skip: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
        objects: Selection | None = None,
        blend_below: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Hits: ...

    def shoot_all(
        self,
        origins: npt.ArrayLike | Sensor | LeavingRays,
        directions: npt.ArrayLike | None = None,
        k: int | None = None,
        *,
        t_min: npt.ArrayLike = 0.0,
        t_max: npt.ArrayLike = math.inf,
        mask: npt.ArrayLike | None = None,
        cull: Side | None = None,
        skip: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
        objects: Selection | None = None,
        blend_below: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> AllHits | Hits:
        """Find every hit of each ray, or the first ``k``, in order.

        Each crossing of a surface is there once, as `count` counts them: a ray enters and leaves
        every closed mesh in turn. At an edge `shoot` may see a surface that the ray only touches
        and that is not among these.

        Parameters
        ----------
        origins, directions, t_min, t_max, mask, cull, skip, objects
            As for `shoot`.
        blend_below, threads, progress
            As for `shoot`. The rays of a camera have the shape (rows, columns); their hits have
            neither ``range`` nor ``z``.
        k : int, optional
            How many hits of each ray are wanted at most; all if left out.

        Returns
        -------
        AllHits or Hits
            Without ``k`` an `AllHits` of the rays' shape. With ``k`` a `Hits` of shape (..., k):
            ``t[..., j]`` is that of the hit ``j`` of each ray; after the last hit come misses.
            Hits are in the order of ``t``, the float64 nearest to the exact one where others are
            close; of equal ones in that of the object. Within a mesh those are in the order of
            their exact ``t``, then in that in which a ray infinitely little beside enters and
            leaves, then in that of the primitive.

        Raises
        ------
        ValueError
            For arrays whose shapes or types do not fit, with their names, and for a ``k`` that is
            not positive.
        ValueError, IndexError, TypeError
            As `shoot`.
        MemoryError
            If the hits do not fit into memory.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=3))
        1
        >>> met = scene.shoot_all([[0, 0, 5], [0, 2, 0]], [0, 0, -1])
        >>> met.counts, met.object
        (array([4, 1]), array([1, 0, 0, 1, 1], dtype=int32))
        >>> met[0].t, met[0].front
        (array([2., 4., 6., 8.]), array([ True,  True, False, False]))
        >>> scene.shoot_all([[0, 0, 5], [0, 2.9, 0]], [0, 0, -1], k=2).object
        array([[ 1,  0],
               [ 1, -1]], dtype=int32)
        """
        wanted = None if k is None else count("k", k, 1)
        use = threads_or_all(threads)
        masks = mask if mask is None or np.ndim(mask) else None
        rays = rays_of(origins, directions, t_min, t_max, masks=masks, cull=cull, skip=skip)
        built = self._seen(self._ready(), mask, objects, blend_below)
        with following(progress, rays.length) as report:
            if wanted is None:
                return shoot_all(built, rays, use, report)
            return shoot_nearest(built, rays, wanted, use, report)


def _answers(
    ask: Callable[..., None],
    dtype: type[_Scalar],
    native: _firsthit.Scene,
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
            ask(native, rays.part(part), use, answers[part], told)
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
            t, identifiers, primitive, barycentric = out
            pieces = t[part], identifiers[part], primitive[part], barycentric[part]
            told = later(report, part.start)
            _firsthit.shoot(native, rays.part(part), copies, threads, pieces, told)
    kept = rays.keep(copies)
    return Hits._of(built, out, source or Source(None, None, kept), rays.shape, threads)
