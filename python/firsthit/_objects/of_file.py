"""The objects of a file, of which there may be a million: each is made when it is asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, SupportsIndex, cast, overload

from .object import Object, materials_of
from .shapes import Box, Cone, Cylinder, Disc, Plane, Sphere

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from firsthit import _firsthit
    from firsthit._looks.material import Material

    from .mesh import Mesh
    from .shapes import Shape

    _List = list[Object]
else:
    _List = list


class OfFile:
    """The objects of a file by their numbers there, and what they share."""

    __slots__ = ("_looks", "_made", "_meshes", "native")

    def __init__(
        self,
        native: _firsthit.Objects,
        meshes: Sequence[Mesh],
        looks: Sequence[tuple[Material, ...]],
    ) -> None:
        self.native, self._meshes, self._looks = native, meshes, looks
        self._made: dict[int, Object] = {}

    def __getitem__(self, number: int) -> Object:
        """Return an object, the same one whenever it is asked for."""
        made = self._made.get(number)
        if made is not None:
            return made
        shape, name, transform, look, mask, (is_hidden, is_removed), labels = self.native.get(
            number
        )
        is_mesh = isinstance(shape, int)
        held = self._meshes[cast("int", shape)] if is_mesh else _analytic(*cast("Any", shape))
        made = Object(
            held,
            name,
            transform,
            self._looks[look] or materials_of(held, None, None),
            mask=mask,
            is_hidden=is_hidden,
            is_removed=is_removed,
            labels=labels,
        )
        return self._made.setdefault(number, made)


class ObjectList(_List):
    """A list of objects in which those of a file are numbers until they are asked for.

    Whatever copies it at one moment copies the numbers.
    """

    __slots__ = ("of_file",)

    def __init__(self, of_file: OfFile, held: Iterable[int | Object]) -> None:
        super().__init__(cast("Iterable[Object]", held))
        self.of_file = of_file

    @overload
    def __getitem__(self, key: SupportsIndex) -> Object: ...
    @overload
    def __getitem__(self, key: slice) -> ObjectList: ...
    def __getitem__(self, key: SupportsIndex | slice) -> Object | ObjectList:
        held: Any = super().__getitem__(key)
        if isinstance(key, slice):
            return ObjectList(self.of_file, held)
        return self.of_file[held] if isinstance(held, int) else held

    def __iter__(self) -> Iterator[Object]:
        return (self.of_file[each] if isinstance(each, int) else each for each in self.held())

    def held(self) -> Iterator[int | Object]:
        """Go through the list as it is, with numbers."""
        return super().__iter__()

    def __reduce__(self) -> tuple[Any, ...]:
        return list, (list(self),)


def natives(
    objects: Sequence[Object],
) -> tuple[list[int | _firsthit._Object], _firsthit.Objects | None]:
    """Return what objects are made from, with the file that numbers among them are of."""
    looks: dict[tuple[int, ...], list[_firsthit._Material]] = {}
    if not isinstance(objects, ObjectList):
        return [made._native(looks) for made in objects], None
    made = [each if isinstance(each, int) else each._native(looks) for each in objects.held()]
    return made, objects.of_file.native


def held(objects: Sequence[Object]) -> Sequence[Object]:
    """Return the list as it is, with numbers, for a list that has them too."""
    return list(cast("Any", objects.held())) if isinstance(objects, ObjectList) else objects


def triangles(objects: Sequence[Object]) -> int:
    """Return the number of triangles, those of a shared mesh once for each object."""
    if not isinstance(objects, ObjectList):
        return sum(made.triangles for made in objects)
    of_file = objects.of_file.native.triangles
    held = objects.held()
    return sum(of_file(each) if isinstance(each, int) else each.triangles for each in held)


def _analytic(kind: str, numbers: Sequence[float]) -> Shape:
    # Every one of them is made from one vector, perhaps a second, and radii.
    kinds: dict[str, tuple[Callable[..., Shape], int]] = {
        "sphere": (Sphere, 1),
        "plane": (Plane, 2),
        "disc": (Disc, 2),
        "box": (Box, 2),
        "cylinder": (Cylinder, 2),
        "cone": (Cone, 2),
    }
    make, vectors = kinds[kind]
    return make(*(numbers[3 * k : 3 * k + 3] for k in range(vectors)), *numbers[3 * vectors :])
