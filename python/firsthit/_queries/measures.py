"""Measures of the inside of a scene's objects."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import chunks, flag, flat, is_flat, threads_or_all, vectors
from firsthit._base.progress import following, later
from firsthit._objects.traceable import Traceable

from .leaving import LeavingRays, rays_of

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit._base.types import FillRule, Progress, Rule, Selection
    from firsthit._sensors.sensor import Sensor


class Measures(Traceable):
    """The part of `Scene` that measures its objects as solids."""

    @overload
    def inside(
        self,
        points: npt.ArrayLike,
        by: Literal["object"] | None = None,
        *,
        rule: FillRule = "nonzero",
        return_rules: Literal[False] = False,
        objects: Selection | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> npt.NDArray[np.bool_]: ...

    @overload
    def inside(
        self,
        points: npt.ArrayLike,
        by: Literal["object"] | None = None,
        *,
        rule: FillRule = "nonzero",
        return_rules: Literal[True],
        objects: Selection | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> tuple[npt.NDArray[np.bool_], tuple[Rule, ...]]: ...

    def inside(
        self,
        points: npt.ArrayLike,
        by: Literal["object"] | None = None,
        *,
        rule: FillRule = "nonzero",
        return_rules: bool = False,
        objects: Selection | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> npt.NDArray[np.bool_] | tuple[npt.NDArray[np.bool_], tuple[Rule, ...]]:
        """Tell which points are inside the scene's objects.

        A closed mesh (`Mesh.is_closed`) holds the points that it goes around, once or more often,
        either way around; which for a mesh without a transform is decided exactly. So it holds what
        its shells have in common, and a shell within another is a hollow if it faces inwards. With
        ``rule="parity"`` it holds the points that it goes around an odd number of times. A flipped
        triangle counts as its neighbours do. An open mesh, or one with parts that its material cuts
        out, holds the points in its box around which its winding number is above one half or below
        minus one half. A plane and a disc hold nothing.

        A point exactly on the surface is inside if what is just ahead of it along (7, 10, 10.5) is:
        of closed objects without a gap between them, exactly one holds each point that they share.

        Parameters
        ----------
        points : (..., 3) array_like
            The points, in world space, of any real type.
        by : {None, "object"}
            ``None`` asks about all objects together, ``"object"`` about each. `path_length` has
            the other default.
        rule : {"nonzero", "parity"}
            Which points closed meshes hold; the same for `path_length`, `thickness`, `section` and
            `signed_distance`.
        return_rules : bool
            Whether to tell, too, how it is known for each object.
        objects : int, str, or sequence of them, optional
            Ask about these only, by identifiers or names; the others are not there.
        threads, progress
            As for `shoot`; points are counted.

        Returns
        -------
        inside : (...) array of bool
            Whether each point is inside any object; with ``by="object"`` (..., n), whether it is
            inside each of the n objects of the scene, in the order of their identifiers: False for
            those that are hidden or not among ``objects``. False for a point that is not finite.
        rules : tuple of str
            Only with ``return_rules``, for each object: ``"nonzero"``, ``"parity"``, ``"winding"``
            or ``"none"``. A closed mesh whose triangles cannot all face alike goes by parity.

        Raises
        ------
        ValueError
            For points of a wrong shape or type, and another ``by`` or ``rule``.
        ValueError, IndexError, TypeError
            For ``objects``, as `shoot`.
        MemoryError
            If the answers do not fit into memory.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> scene.add(fh.Box(low=(0, 0, 0), high=(3, 3, 3)))
        1
        >>> points = [[0, 0, 0.5], [2, 2, 2], [0, 0, 9]]
        >>> scene.inside(points)
        array([ True,  True, False])
        >>> scene.inside(points, by="object")
        array([[ True,  True],
               [False,  True],
               [False, False]])
        """
        array = vectors("points", points)
        is_by_object, with_rules = _is_by_object(by), flag("return_rules", return_rules)
        use, built = threads_or_all(threads), self._ready()
        native, how = self._seen(built, None, objects).native, (is_by_object, rule)
        leading = array.shape[:-1]
        length = math.prod(leading)
        pieces = []
        with following(progress, length) as report:
            for part in [slice(0, length)] if is_flat(array) else chunks(length):
                told, some = later(report, part.start), flat(array, part, 1)
                pieces.append(_firsthit.inside(native, some, how, use, told))
        shape = (*leading, len(built.objects)) if is_by_object else leading
        found = _joined(pieces, np.bool_).reshape(shape)[()]
        if not with_rules:
            return found
        rules: Any = _firsthit.rules(native, rule)
        return found, tuple(rules)

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

        Each crossing of a closed object is there once, at edges and corners too. What is inside is
        as for `inside`.

        Parameters
        ----------
        origins, directions, t_min, t_max, threads, progress
            As for `shoot`, but for `LeavingRays`: a length does not depend on which surface the ray
            leaves. What lies outside the limits does not count.
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
        ValueError, IndexError, TypeError
            For ``objects``, as `shoot`.
        MemoryError
            If the lengths do not fit into memory.

        Examples
        --------
        >>> import firsthit as fh
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
        is_by_object = _is_by_object(by)
        if isinstance(origins, LeavingRays):
            raise ValueError("origins must not be LeavingRays: give their origin and direction")
        rays = rays_of(origins, directions, t_min, t_max)
        use, built = threads_or_all(threads), self._ready()
        native, how = self._seen(built, None, objects).native, (is_by_object, rule)
        pieces = []
        with following(progress, rays.length) as report:
            for part in rays.parts():
                told, count = later(report, part.start), part.stop - part.start
                some = rays.part(part)
                pieces.append(_firsthit.path_lengths(native, some, count, how, use, told))
        shape = (*rays.shape, len(built.objects)) if is_by_object else rays.shape
        return _joined(pieces, np.float64).reshape(shape)[()]


def _is_by_object(by: str | None) -> bool:
    if by is not None and by != "object":
        raise ValueError(f"by must be 'object' or None, got {by!r}")
    return by is not None


def _joined(pieces: list[npt.NDArray[Any]], dtype: type[np.generic]) -> npt.NDArray[Any]:
    if len(pieces) == 1:
        return pieces[0]
    return np.concatenate(pieces) if pieces else np.empty(0, dtype)
