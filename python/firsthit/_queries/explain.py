"""The explanation of one ray."""

from __future__ import annotations

import copy
import json
from typing import TYPE_CHECKING, Any, NamedTuple

from firsthit import _firsthit
from firsthit._base.arrays import count, index, locked, numbers
from firsthit._objects.filters import Filters
from firsthit._objects.object import chosen
from firsthit._sensors.camera import Camera

from .leaving import rays_of

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit._objects.traceable import Built
    from firsthit.typing import Selection


#: The vectors of a hit, (2,) or (3,) float64.
_VECTORS = ("position", "normal", "shading_normal", "barycentric", "uv", "base_color")


class Crossing(NamedTuple):
    """A crossing of a ray with a surface, behind what the ray meets first."""

    #: The ray's parameter.
    t: float
    #: The object's identifier.
    object: int
    #: The primitive, such as the triangle.
    primitive: int
    #: The object's name; may be empty.
    name: str
    #: The name of its shape, such as ``"mesh"``.
    shape: str
    #: Whether the ray goes from the front to the back.
    front: bool


class Candidate(NamedTuple):
    """An object, and why it is or is not what a ray meets first."""

    #: The object's identifier.
    object: int
    #: Its name; may be empty.
    name: str
    #: The name of its shape, such as ``"mesh"``.
    shape: str
    #: Why, such as ``"hit"``, ``"behind_hit"``, ``"culled_back"`` or ``"box_missed"``.
    reason: str
    #: Where the reason is; ``None`` where the line of the ray does not touch the surface.
    t: float | None
    #: Which primitive it is about; ``None`` as before.
    primitive: int | None


class Explanation:
    """The explanation of a ray, from `Scene.explain`. ``print`` shows it. Read-only."""

    __slots__ = ("_record", "_text")

    def __init__(self, text: str, record: dict[str, Any]) -> None:
        self._text, self._record = text, record

    @property
    def hit(self) -> dict[str, Any] | None:
        """The first hit; ``None`` for a miss. Points, directions and weights are arrays.

        The keys are t, object, primitive, name, shape, node, mesh, face, position, normal,
        shading_normal, front, barycentric, uv, base_color, material and attributes. There is
        ``None`` for what the surface does not have. ``node``, ``mesh`` and ``material`` have the
        ``id`` of the channel of that name, and the ``name`` that `Hits.names` gives for it.
        """
        hit: dict[str, Any] | None = copy.deepcopy(self._record["hit"])
        if hit is not None:
            for name in _VECTORS:
                hit[name] = None if hit[name] is None else locked(hit[name])
        return hit

    @property
    def behind(self) -> tuple[Crossing, ...]:
        """The first crossings behind the hit, in order; as many as were asked for."""
        return tuple(
            Crossing(*(place[name] for name in Crossing._fields))
            for place in self._record["behind"]
        )

    @property
    def behind_count(self) -> int:
        """The number of crossings behind the hit."""
        return int(self._record["behind_count"])

    @property
    def candidates(self) -> tuple[Candidate, ...]:
        """Every object, in the order of identifiers, and why it is or is not the hit."""
        return tuple(
            Candidate(*(one[name] for name in Candidate._fields))
            for one in self._record["candidates"]
        )

    @property
    def counts(self) -> dict[str, int]:
        """The number of objects for each reason that occurs."""
        return dict(self._record["counts"])

    @property
    def fault(self) -> str | None:
        """The fault of a ray that cannot meet anything, such as a zero direction."""
        fault: str | None = self._record["fault"]
        return fault

    def to_dict(self) -> dict[str, Any]:
        """Return all of it in dicts, lists, numbers and strings, as ``json.dumps`` takes them.

        Returns
        -------
        dict
            The output of ``firsthit probe --json`` but for warnings and guesses: pixel, ray, fault,
            hit, behind, behind_count, counts, candidates. Numbers that are not finite are ``None``.
        """
        return copy.deepcopy(self._record)

    def __str__(self) -> str:
        return self._text.rstrip("\n")

    def __repr__(self) -> str:
        hit = self._record["hit"]
        met = "miss" if hit is None else f"t={hit['t']}, object={hit['object']}"
        return f"Explanation({met}, {len(self._record['candidates'])} objects)"

    def __reduce__(self) -> tuple[Any, ...]:
        return Explanation, (self._text, self._record)


def explained(
    built: Built,
    given: tuple[Any, ...],
    pixel: tuple[int, int] | None,
    objects: Selection | None,
    behind: int,
) -> Explanation:
    """Explain one ray; ``given`` is as `rays_of` has it."""
    origin, direction, t_min, t_max, mask, cull, skip = given
    ray: _firsthit._Rays | _firsthit._PixelRay
    if isinstance(origin, Camera):
        if direction is not None:
            raise ValueError("direction must be left out with a camera, which has its own")
        ends = _end("t_min", t_min), _end("t_max", t_max)
        filters = _one_filter(Filters.of(mask, cull, skip))
        ray = origin._native, _pixel(pixel), ends, filters
    elif pixel is not None:
        raise ValueError("pixel must be left out without a camera")
    else:
        rays = rays_of(*given)
        if rays.shape != ():
            raise ValueError(f"explain takes one ray, got rays of shape {rays.shape}")
        ray = rays.part(slice(0, 1))
    most = count("behind", behind)
    among = None if objects is None else chosen(built.objects, objects)
    text, record = _firsthit.explain(built.native, ray, among, most)
    return Explanation(text, json.loads(record))


def _end(name: str, given: npt.ArrayLike) -> float:
    """Return a limit of a single ray."""
    limit = numbers(name, given)
    if limit.shape != ():
        raise ValueError(f"{name} must be one number, got an array of shape {limit.shape}")
    return float(limit)


def _one_filter(filters: Filters | None) -> _firsthit._Filters | None:
    """Return what a single ray does not meet."""
    if filters is None:
        return None
    for shape in filters.shapes():
        if shape != ():
            raise ValueError(f"explain takes one ray, got masks or surfaces of shape {shape}")
    return filters.part(slice(0, 1), ())


def _pixel(pixel: tuple[int, int] | None) -> tuple[int, int]:
    """Return a pixel's row and column."""
    if pixel is None:
        raise ValueError("pixel must be given with a camera")
    if not isinstance(pixel, tuple | list) or len(pixel) != 2:
        raise ValueError(f"pixel must be a pair (row, column), got {pixel!r}")
    row, column = (index("pixel", part) for part in pixel)
    if row < 0 or column < 0:
        raise ValueError(f"pixel must be one of the picture, got {pixel!r}")
    return row, column
