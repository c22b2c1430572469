"""The nearest points of a scene."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import count, flag, number, plain, threads_or_all, vectors
from firsthit._base.progress import following
from firsthit._objects.traceable import Traceable

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit._base.types import FillRule, Progress, Selection


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


class NearestQueries(Traceable):
    """The part of `Scene` that measures distances."""

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
        shapes by a few 2^-53 of the shape's size. What a material cuts out is measured like any
        other surface.

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
        >>> nearest = scene.closest_point([[0, 0, 3], [0, 0.5, 0]])
        >>> nearest.distance
        array([2. , 0.5])
        >>> nearest.point
        array([[0., 0., 1.],
               [0., 1., 0.]])
        """
        shape, flat = _flat(points)
        use = threads_or_all(threads)
        many = 1 if k is None else count("k", k, 1, 2**31 - 1)
        within = number("radius", radius)
        if not within >= 0:
            raise ValueError(f"radius must be zero or positive, got {radius!r}")
        with following(progress, len(flat)) as report:
            distance, identifiers, primitive, point, weights = _firsthit.closest_points(
                self._seen(self._ready(), None, objects).native,
                flat,
                (many, within),
                use,
                report,
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
            What is inside of closed meshes, see `inside`.
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
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> scene.signed_distance([[0, 0, 3], [0, 0.75, 0]])
        array([ 2.  , -0.25])
        """
        shape, flat = _flat(points)
        use, how = threads_or_all(threads), (rule, flag("allow_open", allow_open))
        with following(progress, len(flat)) as report:
            native = self._seen(self._ready(), None, objects).native
            signed = _firsthit.signed_distances(native, flat, how, use, report)
        return signed.reshape(shape)[()]


def _flat(points: npt.ArrayLike) -> tuple[tuple[int, ...], npt.NDArray[np.float64]]:
    """Return the points' shape, and them as C-contiguous float64 of shape (n, 3)."""
    array = vectors("points", points)
    return array.shape[:-1], plain(array.reshape(-1, 3))
