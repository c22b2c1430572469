"""Questions about points: what they see, what holds them, and what is near."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, overload

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import (
    chunks,
    flag,
    flat,
    is_flat,
    number,
    plain,
    threads_or_all,
    vectors,
)
from firsthit._base.arrays import count as whole
from firsthit._base.progress import following, later
from firsthit._objects.traceable import Traceable

from .hits import Hits
from .measures import in_parts, is_by_object, joined
from .sights import end, end_part, of_length_one, rays_through, surface_points

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit.typing import FillRule, Progress, Rule, Selection

    from .sights import Pair


class ClosestPoints(NamedTuple):
    """The nearest points of a scene, as arrays.

    Their shape is that of the points, and with ``k`` they have one more axis of that length, the
    nearest first. Where there is none, the distance is ``inf``, the identifiers are ``-1``, and the
    rest is ``nan``.

    Attributes
    ----------
    point : (..., 3) array of float
        Where the nearest points are, in world space.
    distance : (...) array of float
        How far away they are.
    object, primitive : (...) array of int32
        The object, and which part of it: a mesh's triangle, a box's face, ...
    barycentric : (..., 3) array of float
        The weights of a triangle's corners 0, 1 and 2; ``nan`` on other shapes.
    """

    point: npt.NDArray[np.float64]
    distance: npt.NDArray[np.float64]
    object: npt.NDArray[np.int32]
    primitive: npt.NDArray[np.int32]
    barycentric: npt.NDArray[np.float64]


class PointQueries(Traceable):
    """The part of a `Scene` that measures from points."""

    def visible(
        self,
        a: npt.ArrayLike | Hits,
        b: npt.ArrayLike | Hits,
        *,
        skip_a: Pair | None = None,
        skip_b: Pair | None = None,
        tolerance: float = 0.0,
        objects: Selection | None = None,
        blend_below: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> npt.NDArray[np.bool_]:
        """Tell whether points see each other: whether nothing is on the line between them.

        The answer does not depend on which of the two comes first, to the bit. A surface at an end
        hides nothing, for points of a surface are rounded to one side of it or the other: what is
        nearer to an end than 2^-40 of the ends' largest coordinate, some 1e-12 of it, and the
        surfaces of ends that are `Hits`. So two points of a solid's surface see each other through
        the solid, and the far side of a surface sees a lamp; whether an end faces the other is
        another question: ``((lamp - hits.position) * hits.normal).sum(-1) > 0``.

        Parameters
        ----------
        a, b : (..., 3) array_like, or Hits
            The points, in world space; they broadcast against each other. All pairs of two lists
            are ``visible(a[:, None], b)``, worked off in blocks. Of `Hits` they are the positions,
            and the surfaces there do not hide them; a miss sees nothing.
        skip_a, skip_b : pair of (...) array_like of int, optional
            The object and primitive on which each point of an array lies, -1 where there is none.
            It hides nothing, also where the line is nearly along it.
        tolerance : float
            Surfaces nearer to either end than this hide nothing, in scene units: the error of
            points that are rounded, as to float32.
        objects : int, str, or sequence of them, optional
            The objects that may be in the way, by identifiers or names: no other object hides
            anything.
        blend_below : float, optional
            As for `shoot`.
        threads, progress
            As for `shoot`; pairs are counted.

        Returns
        -------
        (...) array of bool
            Whether they see each other. A point sees itself. One that is not finite sees nothing.

        Raises
        ------
        ValueError
            For arrays whose shapes or types do not fit, with their names, and for a tolerance that
            is negative or not finite.
        ValueError, IndexError, TypeError, MemoryError
            For ``objects`` and for too little memory, as `shoot`.

        Examples
        --------
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> scene.visible([[0, 0, 5], [0, 2, 0]], [0, 0, -5])
        array([False,  True])
        >>> hits = scene.shoot((0, 0, 5), (0, 0, -1))
        >>> bool(scene.visible(hits, (0, 3, 5)))
        True
        """
        built = self._ready(progress).seen(None, objects, blend_below)
        ends = end("a", a, skip_a), end("b", b, skip_b)
        leading = [array.shape[:-1] for array, _ in ends]
        skipped = [array.shape for _, skip in ends if skip is not None for array in skip]
        try:
            shape = np.broadcast_shapes(*leading, *skipped)
        except ValueError:
            raise ValueError(
                f"a {ends[0][0].shape} and b {ends[1][0].shape} must broadcast against each "
                "other, and so must skip_a and skip_b"
            ) from None
        use, near = threads_or_all(threads), number("tolerance", tolerance)
        length = math.prod(shape)
        seen = np.empty(length, np.bool_)
        with following(progress, length) as report:
            for part in chunks(length):
                told, count = later(report, part.start), part.stop - part.start
                both = end_part(*ends[0], shape, part), end_part(*ends[1], shape, part)
                seen[part] = _firsthit.visible(built.native, both, (count, near), use, told)
        return seen.reshape(shape)[()]

    def thickness(
        self,
        points: npt.ArrayLike | Hits,
        directions: npt.ArrayLike | None = None,
        *,
        rule: FillRule = "nonzero",
        objects: Selection | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> npt.NDArray[np.float64]:
        """Measure how thick objects are at points of their surfaces.

        It is the distance along a ray from the surface to where the ray comes out of the same
        object, or if it starts outside, into it. The inside is that of `inside`; of an open mesh
        it is where the ray next meets it. The ray leaves the surface exactly, as `Hits.leave` has
        it. Other objects do not count.

        Parameters
        ----------
        points : (..., 3) array_like, or Hits
            Points in world space, each in place of the surface point nearest to it; or hits of this
            scene, before it changes.
        directions : (..., 3) array_like, optional
            The directions to measure along, of any length; they broadcast against the points. If
            left out, inwards: against the geometric normal, or along it in a mesh that is turned
            inside out.
        rule : {"nonzero", "parity"}
            The rule of the inside of closed meshes, see `inside`.
        objects : int, str, or sequence of them, optional
            The only objects that are there, by identifiers or names; all by default. Points are
            brought to their surfaces, and hits on other objects have the thickness ``inf``.
        threads, progress
            As for `shoot`.

        Returns
        -------
        (...) array of float64
            Lengths in scene units. ``inf`` where the ray does not meet the object again; without
            ``directions`` 0 where neither side of a closed mesh is inside. NaN for a miss, for a
            direction that is zero or not finite, inwards from a triangle without an area, and for a
            point that is not finite or has no surface to be near to.

        Raises
        ------
        ValueError
            For arrays whose shapes or types do not fit, and another ``rule``.
        ValueError, IndexError, TypeError, MemoryError
            For ``objects`` and for too little memory, as `shoot`.

        Examples
        --------
        >>> scene = fh.Scene()
        >>> scene.add(fh.Box(low=(0, 0, 0), high=(4, 4, 0.5)))
        0
        >>> scene.thickness([[1, 1, 0.5], [0, 2, 0.25]])
        array([0.5, 4. ])
        """
        built, use = self._ready(progress).seen(None, objects), threads_or_all(threads)
        hits = points if isinstance(points, Hits) else surface_points(built, points, use)
        ways = -hits.normal if directions is None else of_length_one(directions)
        rays, how = rays_through(hits, ways), (directions is None, rule)
        found = in_parts(_firsthit.thickness, built, rays, how, use, progress).reshape(rays.shape)
        own = np.broadcast_to(hits.object, rays.shape)
        has_way = np.broadcast_to(np.isfinite(ways).all(axis=-1), rays.shape)
        thick: npt.NDArray[np.float64] = np.where((own < 0) | ~has_way, np.nan, found)
        return thick[()]  # of one point, a number

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
        ValueError, IndexError, TypeError, MemoryError
            For ``objects`` and for too little memory, as `shoot`.

        Examples
        --------
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
        built = self._ready(progress).seen(None, objects)
        array = vectors("points", points)
        each, with_rules = is_by_object(by), flag("return_rules", return_rules)
        use, how = threads_or_all(threads), (each, rule)
        leading = array.shape[:-1]
        length = math.prod(leading)
        pieces = []
        with following(progress, length) as report:
            for part in [slice(0, length)] if is_flat(array) else chunks(length):
                told, some = later(report, part.start), flat(array, part, 1)
                pieces.append(_firsthit.inside(built.native, some, how, use, told))
        shape = (*leading, len(built.objects)) if each else leading
        found = joined(pieces, np.bool_).reshape(shape)[()]
        if not with_rules:
            return found
        rules: Any = _firsthit.rules(built.native, rule)
        return found, tuple(rules)

    def closest_point(
        self,
        points: npt.ArrayLike,
        *,
        k: int | None = None,
        radius: float = math.inf,
        objects: Selection | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> ClosestPoints:
        """Find the points of the scene that are nearest to points.

        Distances are those of world space, also to objects whose transforms stretch. At the same
        distance the lower (object, primitive) is nearer: the squares of the distances are compared,
        as float64. The distance to a mesh is off by a few units in the last place; that to other
        shapes by a few 2^-53 of the shape's size. A part that a material cuts out is measured like
        any other surface.

        Parameters
        ----------
        points : (..., 3) array_like
            Points in world space. Those that are not finite or beyond 1e150 have no answer, and
            distances below 1e-150 have few digits.
        k : int, optional
            Find that many for each point, each of another (object, primitive), in order.
        radius : float
            The largest distance that counts, itself included.
        objects : int, str, or sequence of them, optional
            Search these only, by identifiers or names; the others are not there.
        threads : int, optional
            How many threads to use; all cores if left out. The answers are the same.
        progress : bool or callable, optional
            As for `shoot`, in points.

        Returns
        -------
        ClosestPoints
            With ``k`` its arrays have one more axis.

        Raises
        ------
        ValueError
            For arrays of a wrong shape or type, a ``k`` below 1, a ``radius`` that is negative or
            NaN, and for a cone or a cylinder whose transform does not stretch by the same in all
            directions.
        ValueError, IndexError, TypeError, MemoryError
            For ``objects`` and for too little memory, as `shoot`.

        Examples
        --------
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> nearest = scene.closest_point([[0, 0, 3], [0, 0.5, 0]])
        >>> nearest.distance
        array([2. , 0.5])
        >>> nearest.point
        array([[0., 0., 1.],
               [0., 1., 0.]])
        """
        built, array = self._ready(progress).seen(None, objects), vectors("points", points)
        use, shape = threads_or_all(threads), array.shape[:-1]
        many = 1 if k is None else whole("k", k, 1, 2**31 - 1)
        within = number("radius", radius)
        with following(progress, math.prod(shape)) as report:
            distance, identifiers, primitive, point, weights = _firsthit.closest_points(
                built.native, plain(array.reshape(-1, 3)), (many, within), use, report
            )
        shape = shape if k is None else (*shape, many)
        second, third = weights.reshape(-1, 2).T
        barycentric = np.column_stack((1.0 - second - third, second, third))
        return ClosestPoints(
            point.reshape(*shape, 3),
            distance.reshape(shape)[()],
            identifiers.reshape(shape)[()],
            primitive.reshape(shape)[()],
            barycentric.reshape(*shape, 3),
        )

    def signed_distance(
        self,
        points: npt.ArrayLike,
        *,
        rule: FillRule = "nonzero",
        allow_open: bool = False,
        objects: Selection | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> npt.NDArray[np.float64]:
        """Measure how far points are from the nearest surface, negative inside.

        A point is inside if it is inside any object, as `inside` has it; of closed meshes without a
        transform that is exact. Where objects or shells overlap, the surface of one within the
        other counts too.

        Parameters
        ----------
        points, objects, threads, progress
            As for `closest_point`.
        rule : {"nonzero", "parity"}
            The rule of the inside of closed meshes, see `inside`.
        allow_open : bool
            Take open meshes and those with parts cut out, too: their winding number gives the sign,
            which is not exact near gaps. Planes and discs have no inside.

        Returns
        -------
        (...) array of float
            The distances: 0 on a surface, ``inf`` where there is none.

        Raises
        ------
        ValueError
            For another ``rule``, and unless ``allow_open`` for an object that is not closed, or of
            which a material cuts parts out.
        ValueError, IndexError, TypeError
            As `closest_point`.
        MemoryError
            If the answers do not fit into memory.

        Examples
        --------
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> scene.signed_distance([[0, 0, 3], [0, 0.75, 0]])
        array([ 2.  , -0.25])
        """
        built, array = self._ready(progress).seen(None, objects), vectors("points", points)
        use, how = threads_or_all(threads), (rule, flag("allow_open", allow_open))
        some, shape = plain(array.reshape(-1, 3)), array.shape[:-1]
        with following(progress, len(some)) as report:
            signed = _firsthit.signed_distances(built.native, some, how, use, report)
        return signed.reshape(shape)[()]
