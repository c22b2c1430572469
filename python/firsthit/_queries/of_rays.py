"""Questions about rays: what they meet, how often, and how far they go inside."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal, overload

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import count as whole
from firsthit._base.arrays import threads_or_all
from firsthit._base.progress import following
from firsthit._objects.filters import of_each_ray
from firsthit._objects.traceable import Traceable

from .all_hits import shoot_all, shoot_nearest
from .leaving import LeavingRays, rays_of
from .measures import in_parts, is_by_object
from .shoot import answers, first_hits

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit._sensors.sensor import Sensor
    from firsthit.typing import FillRule, Progress, Selection, Side

    from .all_hits import AllHits
    from .hits import Hits


class RayQueries(Traceable):
    """The part of a `Scene` that shoots rays."""

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
            ``True`` shows a line with the time that is left. A function is called with the number
            of rays that are done and the number of all rays, in the calling thread, about twenty
            times a second and at the end; before that with those of triangles, where trees are
            built. An exception that it raises ends the work.
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
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> hits = scene.shoot([[0, 0, 3], [0.6, 0, 3]], [0, 0, -1])
        >>> hits.t
        array([2. , 2.2])
        >>> hits.normal[0]
        array([0., 0., 1.])
        """
        given = origins, directions, t_min, t_max, of_each_ray(mask), cull, skip
        built = self._ready(progress).seen(mask, objects, blend_below)
        return first_hits(built, given, threads, progress, dtype)

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
        ValueError, IndexError, TypeError, MemoryError
            As `shoot`.

        Examples
        --------
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> eye, target = (0, 0, 5), (0, 0, 2)
        >>> bool(scene.occluded(eye, [0, 0, -3], t_max=1.0))  # is the target seen?
        False
        """
        rays = rays_of(origins, directions, t_min, t_max, of_each_ray(mask), cull, skip)
        built = self._ready(progress).seen(mask, objects, blend_below)
        return answers(_firsthit.occluded, np.bool_, built, rays, threads, progress)

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
        ValueError, IndexError, TypeError, MemoryError
            As `shoot`.

        Examples
        --------
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> scene.count([[0, 0, 5], [0, 0, 0], [0, 2, 5]], [0, 0, -1])
        array([2, 1, 0])
        """
        rays = rays_of(origins, directions, t_min, t_max, of_each_ray(mask), cull, skip)
        built = self._ready(progress).seen(mask, objects, blend_below)
        counts = answers(_firsthit.count, np.uint32, built, rays, threads, progress)
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
        directions: npt.ArrayLike | None = None,
        k: int = ...,
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
        ValueError, IndexError, TypeError, MemoryError
            As `shoot`.

        Examples
        --------
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
        wanted = None if k is None else whole("k", k, 1)
        rays = rays_of(origins, directions, t_min, t_max, of_each_ray(mask), cull, skip)
        built = self._ready(progress).seen(mask, objects, blend_below)
        use = threads_or_all(threads)
        with following(progress, rays.length) as report:
            if wanted is None:
                return shoot_all(built, rays, use, report)
            return shoot_nearest(built, rays, wanted, use, report)

    def path_length(
        self,
        origins: npt.ArrayLike | Sensor,
        directions: npt.ArrayLike | None = None,
        by: Literal["object"] | None = "object",
        *,
        t_min: npt.ArrayLike = 0.0,
        t_max: npt.ArrayLike = math.inf,
        rule: FillRule = "nonzero",
        objects: Selection | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> npt.NDArray[np.float64]:
        """Measure how much of each ray is inside the scene's objects.

        Each crossing of a closed object is there once, at edges and corners too. The inside is
        that of `inside`.

        Parameters
        ----------
        origins, directions, t_min, t_max, threads, progress
            As for `shoot`, but for `LeavingRays`: a length does not depend on which surface the ray
            leaves. The ray outside the limits does not count.
        by : {"object", None}
            ``"object"`` measures each object by itself; ``None`` measures all together, where a
            stretch in several objects counts once.
        rule, objects
            As for `inside`.

        Returns
        -------
        (..., n) or (...) array of float64
            Lengths in scene units, whatever the direction's length: for each of the n objects of
            the scene (0 for those that are hidden or not among ``objects``), or with ``by=None``
            for all together. NaN where an open mesh is crossed in a way that does
            not say where the ray is inside; 0 in planes and discs, and for rays that cannot meet
            anything.

        Raises
        ------
        ValueError
            For arrays whose shapes or types do not fit, with their names, for `LeavingRays`, and
            another ``by`` or ``rule``.
        ValueError, IndexError, TypeError, MemoryError
            For ``objects`` and for too little memory, as `shoot`.

        Examples
        --------
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=3))
        1
        >>> scene.path_length([[0, 0, 5], [0, 0, 0]], [0, 0, -2])
        array([[2., 6.],
               [1., 3.]])
        >>> scene.path_length([[0, 0, 5], [0, 0, 0]], [0, 0, -2], by=None)
        array([6., 3.])
        """
        built, how = self._ready(progress).seen(None, objects), (is_by_object(by), rule)
        if isinstance(origins, LeavingRays):
            raise ValueError("origins must not be LeavingRays: give their origin and direction")
        rays = rays_of(origins, directions, t_min, t_max)
        use, own = threads_or_all(threads), (len(built.objects),) if how[0] else ()
        found = in_parts(_firsthit.path_lengths, built, rays, how, use, progress)
        return found.reshape((*rays.shape, *own))[()]
