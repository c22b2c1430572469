"""Sections: the curves in which a plane cuts meshes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from firsthit import _firsthit
from firsthit._base.arrays import lock, locked
from firsthit._base.progress import following

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator

    import numpy as np
    import numpy.typing as npt

    from firsthit._objects.traceable import Built
    from firsthit.typing import FillRule, Progress, Vector


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
        self,
        built: Built,
        origin: Vector,
        normal: Vector,
        rule: FillRule,
        threads: int,
        progress: Progress | None = None,
    ) -> None:
        self._made_from = built, origin, normal, rule
        with following(progress) as report:
            self._native = _firsthit.Section(built.native, origin, normal, rule, threads, report)
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

    def _repr_html_(self) -> str:
        """Show it at a glance, for notebooks."""
        from firsthit._files.glance import of_section

        return of_section(self)

    def __reduce__(self) -> tuple[Any, ...]:
        return Section, (*self._made_from, 0)
