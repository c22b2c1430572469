"""Questions about a scene's objects and about one ray: sections, likely faults, explanations."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from firsthit._base.arrays import count, threads_or_all, vector
from firsthit._base.errors import warn
from firsthit._objects.traceable import Traceable

from .explain import explained
from .lint import LintReport
from .section import Section

if TYPE_CHECKING:
    from collections.abc import Iterable

    import numpy.typing as npt

    from firsthit._sensors.camera import Camera
    from firsthit.typing import FillRule, Progress, Selection, Side

    from .explain import Explanation
    from .leaving import LeavingRays


class Inspections(Traceable):
    """The part of a `Scene` that looks into its objects."""

    def section(
        self,
        origin: npt.ArrayLike,
        normal: npt.ArrayLike,
        *,
        rule: FillRule = "nonzero",
        objects: Selection | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
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
            The rule of the inside, see `inside`.
        objects : int, str, or sequence of them, optional
            Cut these only, by identifiers or names; all but hidden ones if left out.
        threads : int, optional
            The number of threads; all cores if left out. The result is the same for any number.
        progress : bool or callable, optional
            As for `load`.

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
            For objects that are left out, since they are no meshes, and a plane that cuts nothing.

        Examples
        --------
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
        built, use = self._ready(progress).seen(None, objects), threads_or_all(threads)
        plane = vector("origin", origin), vector("normal", normal)
        section = Section(built, *plane, rule, use, progress)
        for doubt in section._native.warnings():
            warn(doubt)
        return section

    def lint(
        self,
        *,
        ignore: Iterable[str] = (),
        places: int = 10,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> LintReport:
        """Look for what may be wrong with the meshes.

        Holes, flipped faces, shells inside out, degenerate and duplicate faces, non-manifold edges,
        self-intersections, vertices that are not finite or not used, digits lost far from the
        origin, and unlikely sizes. Areas, volumes and whether faces meet are decided in exact
        arithmetic. Vertices in one place are one, whether or not faces share them. Hidden objects
        are looked at too.

        Parameters
        ----------
        ignore : iterable of str
            Names of kinds that are not looked for, such as ``"units"``; `LintReport.kinds` has all.
        places : int
            How many places of each kind the report has.
        threads : int, optional
            The number of threads; all cores if left out. The result is the same for any number.
        progress : bool or callable, optional
            As for `load`.

        Returns
        -------
        LintReport
            Findings with counts and places.

        Raises
        ------
        ValueError
            For a kind that there is not.
        MemoryError
            If there is too little memory.

        Examples
        --------
        >>> scene = fh.Scene()
        >>> corners = [[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2]]
        >>> scene.add(fh.Mesh(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3]]))
        0
        >>> scene.lint()
        LintReport(hole: 3)
        """
        if isinstance(ignore, str):
            raise TypeError(f"ignore must be several names, got {ignore!r}")
        use = threads_or_all(threads)
        built, most = self._ready(progress), count("places", places)
        return LintReport(built, tuple(ignore), most, use, progress)

    def explain(
        self,
        origin: npt.ArrayLike | Camera | LeavingRays,
        direction: npt.ArrayLike | None = None,
        *,
        pixel: tuple[int, int] | None = None,
        t_min: float = 0.0,
        t_max: float = math.inf,
        mask: int | None = None,
        cull: Side | None = None,
        skip: tuple[int, int] | None = None,
        objects: Selection | None = None,
        blend_below: float | None = None,
        behind: int = 10,
    ) -> Explanation:
        """Explain one ray.

        The first hit and the surface there, why each other object is not that, and what lies
        behind. It agrees to the bit with `shoot` and `shoot_all`.

        Parameters
        ----------
        origin, direction : (3,) array_like
            The ray, in world space. Instead of both, a `Camera` with a ``pixel``, or
            `LeavingRays` (`Hits.leave`) of the shape ``()``.
        pixel : pair of int, optional
            Of a camera: the row from the top and the column from the left, both from 0. The ray
            goes through the pixel's centre.
        t_min, t_max, mask, cull, skip, objects, blend_below
            As for `shoot`, for this ray.
        behind : int
            How many crossings behind the hit are listed; the others are counted.

        Returns
        -------
        Explanation
            ``print`` shows it as ``firsthit probe`` does.

        Raises
        ------
        ValueError
            For a pixel outside of the picture, for more than one ray, and as `shoot`.
        MemoryError
            If there is too little memory.

        Examples
        --------
        >>> scene = fh.Scene()
        >>> scene.add(fh.Plane(point=(0, 0, 0), normal=(0, 0, 1)), name="ground")
        0
        >>> scene.add(fh.Sphere(center=(0, 0, 1), radius=1), name="ball")
        1
        >>> story = scene.explain((0, 0, 5), (0, 0, -1))
        >>> story.hit["name"], story.hit["t"]
        ('ball', 3.0)
        >>> [(one.name, one.reason) for one in story.candidates]
        [('ground', 'behind_hit'), ('ball', 'hit')]
        >>> [(place.t, place.name) for place in story.behind]
        [(5.0, 'ground'), (5.0, 'ball')]
        """
        given = origin, direction, t_min, t_max, mask, cull, skip
        built = self._ready().seen(None, None, blend_below)
        return explained(built, given, pixel, objects, behind)
