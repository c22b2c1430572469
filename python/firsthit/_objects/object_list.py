"""Lists of a scene's objects: those of a file, perhaps a million, are made when asked for."""

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
    """The objects of a scene, in which those of a file are numbers until they are asked for.

    A copy made at one moment holds numbers too. Copies share what is known of names.
    """

    __slots__ = ("_names", "of_file")

    def __init__(
        self,
        held: Iterable[int | Object] = (),
        of_file: OfFile | None = None,
        names: _Names | None = None,
    ) -> None:
        super().__init__(cast("Iterable[Object]", held))
        self.of_file = of_file
        self._names = _Names() if names is None else names

    @overload
    def __getitem__(self, key: SupportsIndex) -> Object: ...
    @overload
    def __getitem__(self, key: slice) -> ObjectList: ...
    def __getitem__(self, key: SupportsIndex | slice) -> Object | ObjectList:
        held: Any = super().__getitem__(key)
        if isinstance(key, slice):
            return ObjectList(held, self.of_file, self._names)
        return self.of_file[held] if self.of_file and isinstance(held, int) else held

    def __iter__(self) -> Iterator[Object]:
        file: Any = self.of_file
        return (file[each] if isinstance(each, int) else each for each in self.held())

    def held(self) -> Iterator[int | Object]:
        """Go through the list as it is, with numbers."""
        return super().__iter__()

    def called(self, name: str) -> list[int]:
        """Return the identifiers of the objects of that name that were not removed."""
        known = self._names
        # Two threads here at once note the same names, or one of them more.
        for k in range(known.count, len(self)):
            known.note(self[k]._name, k)
        known.count = max(known.count, len(self))
        there = [k for k in list(known.found.get(name, ())) if k < len(self)]
        return [k for k in there if self[k]._name == name and not self[k]._is_removed]

    def names(self) -> Iterator[str]:
        """Yield the names of the objects that are there, as far as `called` has looked."""
        return (name for name in list(self._names.found) if self.called(name))

    def note_name(self, identifier: int) -> None:
        """Remember the name of an object that will be removed: earlier copies still have it."""
        self._names.note(self[identifier]._name, identifier)

    def triangles(self) -> int:
        """Return the number of triangles, those of a shared mesh once for each object."""
        native: Any = self.of_file and self.of_file.native
        held = self.held()
        return sum(native.triangles(k) if isinstance(k, int) else k.triangles for k in held)

    def __reduce__(self) -> tuple[Any, ...]:
        return ObjectList, (list(self),)


class _Names:
    """The identifiers of objects by name. No name changes: objects come, and are removed."""

    __slots__ = ("count", "found")

    def __init__(self) -> None:
        #: How many objects are in it.
        self.count = 0
        self.found: dict[str, dict[int, None]] = {}

    def note(self, name: str, identifier: int) -> None:
        self.found.setdefault(name, {})[identifier] = None


def natives(
    objects: ObjectList,
) -> tuple[list[int | _firsthit._Object], _firsthit.Objects | None]:
    """Return what objects are made from, with the file that numbers among them are of."""
    looks: dict[tuple[int, ...], list[_firsthit._Material]] = {}
    made = [each if isinstance(each, int) else each._native(looks) for each in objects.held()]
    return made, None if objects.of_file is None else objects.of_file.native


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
