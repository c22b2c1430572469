"""Sections: the curves in which a plane cuts meshes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from firsthit import _firsthit
from firsthit._base.arrays import lock, locked, threads_or_all, vector
from firsthit._base.errors import warn
from firsthit._objects.traceable import Traceable

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator

    import numpy as np
    import numpy.typing as npt

    from firsthit._base.types import FillRule, Selection, Vector
    from firsthit._objects.traceable import Built


@dataclass(frozen=True, eq=False, repr=False)
class Polyline:
    """A curve of a `Section`. Its arrays are read-only.

    A closed one runs so that the inside of a solid is on its left, seen from where the plane's
    normal points: counter-clockwise around material, clockwise around holes. An open one runs as
    its triangle of the lowest number says.
    """

    #: The object's identifier.
    object: int
    #: Whether the last point joins the first. It does so where the mesh is closed.
    is_closed: bool
    #: (n, 3) float64, world space: crossings of edges, or vertices exactly on the plane; and where
    #: curves of a mesh cross each other, points on both.
    points: npt.NDArray[np.float64]
    #: (n, 2) float64: the same in the plane's coordinates.
    points_2d: npt.NDArray[np.float64]
    #: (n,) or, if it is open, (n - 1,) int32: the triangle of each segment, of several the lowest.
    primitives: npt.NDArray[np.int32]
    #: The area inside: positive around material, negative around holes; ``None`` if it is open.
    area: float | None
    #: The length of all segments.
    length: float

    def __repr__(self) -> str:
        kind = "closed" if self.is_closed else "open"
        return f"Polyline(object {self.object}, {kind}, {len(self.points)} points)"


class Section:
    """The curves in which a plane cuts the meshes of a scene, from `Scene.section`. Read-only."""

    def __init__(
        self, built: Built, origin: Vector, normal: Vector, rule: FillRule, threads: int
    ) -> None:
        self._made_from = built, origin, normal, rule
        self._native = _firsthit.Section(built.native, origin, normal, rule, threads)
        self._polylines: tuple[Polyline, ...] | None = None

    @property
    def polylines(self) -> tuple[Polyline, ...]:
        """The curves, by objects and, of each object, by the lowest primitive."""
        if self._polylines is None:
            made = tuple(Polyline(*each) for each in self._native.polylines())
            for polyline in made:
                for array in (polyline.points, polyline.points_2d, polyline.primitives):
                    lock(array)
            self._polylines = made
        return self._polylines

    @property
    def origin(self) -> npt.NDArray[np.float64]:
        """The point of the plane where its coordinates are zero, in world space, (3,) float64."""
        return locked(self._native.frame()[0])

    @property
    def normal(self) -> npt.NDArray[np.float64]:
        """The plane's normal, of length one, (3,) float64."""
        return locked(self._native.frame()[1])

    @property
    def u(self) -> npt.NDArray[np.float64]:
        """The direction of the plane's first coordinate, of length one, (3,) float64.

        The world axis with the smallest component along the normal (of equal ones the first),
        projected to the plane. For a normal of +z it is x.
        """
        return locked(self._native.frame()[2])

    @property
    def v(self) -> npt.NDArray[np.float64]:
        """The direction of the second coordinate: the cross product of normal and `u`."""
        return locked(self._native.frame()[3])

    @property
    def area(self) -> float:
        """The area of all closed curves, in squares of scene units: outlines less their holes.

        Where objects overlap, both count.
        """
        return self._native.totals()[0]

    @property
    def perimeter(self) -> float:
        """The length of all curves, in scene units."""
        return self._native.totals()[1]

    @property
    def left_out(self) -> tuple[int, ...]:
        """The identifiers of objects that could not be cut, such as spheres."""
        return tuple(self._native.left_out())

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the section to a file, whole or not at all.

        Parameters
        ----------
        path : path-like
            ``.svg``, a drawing in the plane's coordinates, one scene unit a millimetre; ``.dxf``,
            polylines for CAD; or ``.json``, all numbers.

        Raises
        ------
        ValueError
            For an unknown extension.
        FileWriteError
            If the system refuses to write it; an old file is as it was. Also an `OSError`.
        """
        self._native.save(Path(path))

    def __len__(self) -> int:
        """Return the number of curves."""
        return len(self.polylines)

    def __iter__(self) -> Iterator[Polyline]:
        """Yield the curves."""
        return iter(self.polylines)

    def __bool__(self) -> bool:
        """Return True, also without curves: the length must not decide."""
        return True

    def __repr__(self) -> str:
        closed = sum(polyline.is_closed for polyline in self.polylines)
        return f"Section({closed} closed, {len(self) - closed} open, area {self.area:.6g})"

    def __reduce__(self) -> tuple[Any, ...]:
        return Section, (*self._made_from, 0)


class Cuttable(Traceable):
    """The part of `Scene` that planes cut."""

    def section(
        self,
        origin: npt.ArrayLike,
        normal: npt.ArrayLike,
        *,
        rule: FillRule = "nonzero",
        objects: Selection | None = None,
        threads: int | None = None,
    ) -> Section:
        """Cut all meshes by a plane.

        The side of each vertex is decided in exact arithmetic; one on the plane counts as on the
        side to which the normal points. Curves are joined by the edges that triangles share. So the
        curves of a closed mesh are closed, whatever lies on the plane. A face in the plane is cut
        if the solid is below it, and not if it is above. Where all curves of a mesh are closed,
        they are the outlines of what is inside, see `inside`: shells that overlap have one in
        common.

        Parameters
        ----------
        origin : (3,) array_like
            A point of the plane, in world space.
        normal : (3,) array_like
            The direction at right angles to it, of any length but zero.
        rule : {"nonzero", "parity"}
            What is inside, see `inside`.
        objects : int, str, or sequence of them, optional
            Cut these only, by identifiers or names; all but hidden ones if left out.
        threads : int, optional
            The number of threads; all cores if left out. The result is the same for any number.

        Returns
        -------
        Section
            The curves with objects and primitives, area and perimeter. An object with a transform
            is cut as its vertices are in the world, rounded to float64.

        Raises
        ------
        ValueError
            For an origin or a normal that is not finite, a normal that is zero, another ``rule``,
            and a name that no object has.
        IndexError, TypeError
            For ``objects`` that are not there, or are no identifiers and no names.
        MemoryError
            If there is too little memory.

        Warns
        -----
        FirsthitWarning
            For objects that are left out, since they are no meshes.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> corners = [[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2]]
        >>> scene.add(fh.Mesh(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]))
        0
        >>> cut = scene.section((0, 0, 1), (0, 0, 1))
        >>> cut.area
        0.5
        >>> cut.polylines
        (Polyline(object 0, closed, 3 points),)
        """
        use = threads_or_all(threads)
        plane = vector("origin", origin), vector("normal", normal)
        section = Section(self._seen(self._ready(), None, objects), *plane, rule, use)
        for doubt in section._native.warnings():
            warn(doubt)
        return section
