"""Lines along edges."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

from firsthit import _firsthit
from firsthit._base.arrays import color_of, listed, number, one_of, settle

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from firsthit.typing import EdgeKind, Vector

_KINDS, _USUAL = _firsthit.edge_defaults()
_WIDTH, _ANGLE, _USUAL_KINDS, _DASH, _COLOR = _USUAL


@dataclass(frozen=True, init=False)
class Edges:
    """Lines along edges: see `render`. Immutable.

    They are found on surfaces, not in pixels: which edges of triangles there are follows from the
    triangles, and what of them is seen from rays to the eye. They are antialiased whatever the
    number of samples.

    Parameters
    ----------
    width : float
        How wide a line is, in pixels; below 1 it is fainter. Up to 1000.
    angle : float
        Neighbours whose own normals are more than so many degrees apart meet in a crease.
    kinds : str or sequence of str
        Which edges have lines: ``"silhouette"``, where a surface turns away from the eye;
        ``"crease"``; ``"boundary"``, where a surface ends; ``"object"``, the part of both behind
        which there is another object, or nothing; ``"material"``, between two materials; and
        ``"wireframe"``, between all polygons. By default silhouettes, creases, boundaries and
        materials.
    hidden : bool or (dash, gap)
        Whether lines that something hides are drawn too, dashed: 6 pixels and a gap of 4, or as
        long as it says.
    color : (3,) array_like or str
        Their colour: linear numbers, or sRGB as ``"#rrggbb"`` or a CSS name.

    Raises
    ------
    ValueError
        For values out of range, unknown kinds, and no kinds.

    Examples
    --------
    >>> fh.Edges(width=1.5, kinds="silhouette").kinds
    ('silhouette',)
    """

    width: float
    angle: float
    kinds: tuple[EdgeKind, ...]
    hidden: tuple[float, float] | None
    color: Vector

    def __init__(
        self,
        width: float = _WIDTH,
        angle: float = _ANGLE,
        kinds: EdgeKind | Sequence[EdgeKind] = _USUAL_KINDS,
        hidden: bool | Sequence[float] | None = None,  # noqa: FBT001 - mostly given by name
        color: npt.ArrayLike = _COLOR,
    ) -> None:
        names = (kinds,) if isinstance(kinds, str) else listed("kinds", kinds)
        for name in names:
            one_of("kinds", name, _KINDS)
        settle(self, width=number("width", width), angle=number("angle", angle))
        settle(self, kinds=names, hidden=_dash(hidden), color=color_of("color", color))
        _firsthit.check_edges(self._native())

    def _native(self) -> _firsthit._Edges:
        return self.width, self.angle, self.kinds, self.hidden, self.color

    @classmethod
    def _of(cls, edges: Edges | float | None) -> Edges | None:
        """Return what a user gave, of which a number is a width and ``False`` is none at all."""
        if edges is None or edges is False:
            return None
        return edges if isinstance(edges, Edges) else cls(number("edges", edges))


def _dash(hidden: bool | Sequence[float] | None) -> tuple[float, float] | None:  # noqa: FBT001
    if hidden is None or hidden is False:
        return None
    if hidden is True:
        return cast("tuple[float, float]", tuple(cast("Sequence[float]", _DASH)))
    lengths = listed("hidden", hidden)
    if len(lengths) != 2:
        raise ValueError(f"hidden must be True, False, or a dash and a gap, got {hidden!r}")
    return number("hidden", lengths[0]), number("hidden", lengths[1])
