"""Objects: shapes with a transform and materials."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeGuard

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import cast, index, numbers
from firsthit._base.hints import hint
from firsthit._looks.material import Material, colored, shared

from .filters import ALL
from .mesh import Mesh

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    import numpy.typing as npt

    from firsthit._firsthit import _Labels as Labels
    from firsthit.typing import Selection, Vector

    from .foreign import Part
    from .object_list import ObjectList
    from .shapes import Shape

#: The shape of an object that was removed.
NOTHING = Mesh(np.empty((0, 3)), np.empty((0, 3), np.uint32))
#: The last row of every transform.
_LAST_ROW = np.array([0.0, 0.0, 0.0, 1.0])


class Object:
    """A shape with its name, transform and materials, as `Scene.add` made it. Read-only."""

    # Without a dictionary for each: a scene may have a million.
    __slots__ = (
        "_is_hidden",
        "_is_removed",
        "_labels",
        "_mark",
        "_mask",
        "_materials",
        "_name",
        "_shape",
        "_transform",
    )

    def __init__(
        self,
        shape: Shape,
        name: str,
        transform: npt.NDArray[np.float64] | None,
        materials: tuple[Material, ...],
        mask: int = ALL,
        *,
        is_hidden: bool = False,
        is_removed: bool = False,
        labels: Labels = (None, None),
    ) -> None:
        self._shape, self._name, self._transform = shape, name, transform
        self._materials, self._mask, self._is_hidden = materials, mask, is_hidden
        self._is_removed = is_removed
        #: The node and the mesh of a file that it comes from.
        self._labels = labels
        #: By which it is known wherever it moves.
        self._mark = object()

    @property
    def shape(self) -> Shape:
        """The shape, in object space."""
        return self._shape

    @property
    def name(self) -> str:
        """The name; may be empty."""
        return self._name

    @property
    def node(self) -> str | None:
        """The node of a file that it comes from, as a path from the root; ``None`` if none."""
        return None if self._labels[0] is None else self._labels[0][1]

    @property
    def mesh_name(self) -> str | None:
        """The name of the file's mesh that it is, or is a part of; ``None`` if it has none."""
        return None if self._labels[1] is None else self._labels[1][1]

    @property
    def transform(self) -> npt.NDArray[np.float64]:
        """The transform from object space to world space, for columns, (4, 4) float64: a copy."""
        return np.eye(4) if self._transform is None else self._transform.copy()

    @property
    def color(self) -> Vector | None:
        """The linear colour of its first material; ``None`` if it has no material."""
        return self._materials[0].color if self._materials else None

    @property
    def materials(self) -> tuple[Material, ...]:
        """The materials, in the order of a mesh's ``slots``; empty if it was given none."""
        return self._materials

    @property
    def triangles(self) -> int:
        """The number of its triangles; 0 for a shape that is not a mesh."""
        return self._shape._mesh.counts()[1] if isinstance(self._shape, Mesh) else 0

    @property
    def mask(self) -> int:
        """The mask of 32 bits: a ray meets the object if their masks have a bit in common."""
        return self._mask

    @property
    def hidden(self) -> bool:
        """Whether no ray meets it: after `Scene.hide`, or with a mask of 0."""
        return self._is_hidden or self._mask == 0

    @property
    def removed(self) -> bool:
        """Whether `Scene.remove` took it away; only its identifier is left."""
        return self._is_removed

    def _but(self, **others: Any) -> Object:
        """Return the same object with other attributes."""
        made = Object.__new__(Object)
        for name in Object.__slots__:
            setattr(made, name, getattr(self, name))
        for name, value in others.items():
            setattr(made, name, value)
        return made

    def _is_made_of(self, other: Object) -> bool:
        """Tell whether it differs from another at most in place, and in being hidden."""
        is_same = self._shape is other._shape and self._materials is other._materials
        is_named_alike = self._name == other._name and self._labels == other._labels
        return is_same and is_named_alike and self._mask == other._mask

    def __repr__(self) -> str:
        return f"Object({self._name!r}, {self._shape!r})"

    def _native(self, looks: dict[tuple[int, ...], list[_firsthit._Material]]) -> _firsthit._Object:
        """Return what it is made from; objects with the same materials share those of ``looks``."""
        same = tuple(map(id, self._materials))
        materials = looks.get(same)
        if materials is None:
            materials = [material._native() for material in self._materials]
            looks[same] = materials
        seen = self._is_hidden, self._is_removed
        shape, labels = self._shape._native(), self._labels
        return shape, self._name, self._transform, materials, self._mask, seen, labels


def placed(
    part: Part,
    matrix: npt.NDArray[np.float64] | None,
    color: npt.ArrayLike | None,
    material: Material | Sequence[Material] | None,
    mask: int,
) -> Object:
    """Return a part as an object: where it is moved to, and as it is to look."""
    if color is None and material is None:
        material = part.material
    where = part.transform
    if where is not None:
        where = affine(where if matrix is None else matrix @ where)
    looks = materials_of(part.shape, color, material)
    return Object(part.shape, part.name, matrix if where is None else where, looks, mask=mask)


def chosen(objects: ObjectList, given: Selection) -> tuple[int, ...]:
    """Return the identifiers of objects, each once and in order; removed ones are not there."""
    if isinstance(given, bytes | bytearray):
        raise TypeError(f"objects must be identifiers or names, got {given!r}")
    several: Any = given
    if isinstance(given, str) or (hasattr(given, "__index__") and np.ndim(several) == 0):
        several = [given]
    try:
        wanted = list(several)
    except TypeError:
        raise TypeError(f"objects must be identifiers or names, got {given!r}") from None
    found = set()
    for one in wanted:
        if isinstance(one, str):
            named = objects.called(one)
            if not named:
                meant = hint(one, objects.names())
                raise ValueError(f"there is no object with the name {str(one)!r}{meant}")
            found.update(named)
        else:
            found.add(identified(objects, one))
    return tuple(sorted(found))


def identified(objects: ObjectList, given: object) -> int:
    """Return the identifier of an object that is there, by that or by a name that no other has."""
    if isinstance(given, str):
        several = chosen(objects, given)
        if len(several) > 1:
            raise ValueError(f"{len(several)} objects have the name {given!r}: {several}")
        return several[0]
    identifier = index("object", given)
    if not 0 <= identifier < len(objects):
        raise IndexError(f"there is no object {identifier!r}; there are {len(objects)}")
    if objects[identifier].removed:
        raise IndexError(f"object {identifier!r} was removed")
    return identifier


def is_several(given: object) -> TypeGuard[Iterable[object]]:
    """Tell whether several objects are meant, in an order, and not one."""
    is_array = isinstance(given, np.ndarray) and given.ndim > 0
    return is_array or isinstance(given, list | tuple | range)


def identified_each(objects: ObjectList, given: Iterable[object]) -> list[int]:
    """Return the identifiers of objects that are there, in their order and as often as given."""
    if isinstance(given, np.ndarray) and given.dtype.kind in "iu" and given.ndim == 1:
        whole: list[int] = given.tolist()
        count = len(objects)
        if all(0 <= k < count and not objects[k]._is_removed for k in whole):
            return whole
    return [identified(objects, one) for one in given]


def affine(transform: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return a transform as (4, 4), if it can be undone."""
    # A copy, which nobody else can change.
    matrix = np.array(cast(numbers("transform", transform), np.float64))
    if matrix.shape == (3, 4):
        matrix = np.vstack([matrix, [0.0, 0.0, 0.0, 1.0]])
    if matrix.shape != (4, 4):
        raise ValueError(f"transform must have the shape (4, 4) or (3, 4), got {matrix.shape}")
    refuse(matrix[None], lambda _: "transform")
    return matrix


def affines(transforms: npt.ArrayLike, count: int) -> npt.NDArray[np.float64]:
    """Return ``count`` invertible transforms as (n, 4, 4), of one each or one for all."""
    given = cast(numbers("transform", transforms), np.float64)
    one_for_all = given.shape in ((4, 4), (3, 4))
    if not one_for_all and given.shape not in ((count, 4, 4), (count, 3, 4)):
        wanted = f"({count}, 4, 4), ({count}, 3, 4), (4, 4) or (3, 4)"
        raise ValueError(f"transform must have the shape {wanted}, got {given.shape}")
    matrices = np.array(np.broadcast_to(given, (count, *given.shape[-2:])), order="C")
    if matrices.shape[1] == 3:
        last = np.broadcast_to(_LAST_ROW, (count, 1, 4))
        matrices = np.concatenate([matrices, last], axis=1)
    refuse(matrices, lambda k: "transform" if one_for_all else f"transform {k}")
    return matrices


def refuse(matrices: npt.NDArray[np.float64], named: Callable[[int], str]) -> None:
    """Refuse transforms, (n, 4, 4), that cannot be undone: here, and not at the first shot."""
    if not np.isfinite(matrices).all():
        k = int(np.argmin(np.isfinite(matrices).all(axis=(1, 2))))
        raise ValueError(f"{named(k)} must be finite, got {matrices[k].tolist()}")
    ends = matrices[:, 3] == _LAST_ROW
    if not ends.all():
        k = int(np.argmin(ends.all(axis=1)))
        raise ValueError(f"{named(k)} must have the last row 0, 0, 0, 1, got {matrices[k, 3]}")
    wrong = _firsthit.check_transforms(matrices)
    if wrong is not None:
        k, why = wrong
        raise ValueError(why.replace("transform", named(k), 1))


def materials_of(
    shape: Shape, color: npt.ArrayLike | None, material: Material | Sequence[Material] | None
) -> tuple[Material, ...]:
    """Return an object's materials, where it is given a colour, one or several of them, or none."""
    if material is not None:
        if color is not None:
            raise ValueError("color must be left out with a material, which has its own")
        try:
            made = (material,) if isinstance(material, Material) else tuple(material)
        except TypeError:
            raise TypeError(f"material must be a Material or several, got {material!r}") from None
        for each in made:
            if not isinstance(each, Material):
                raise TypeError(f"material must be a Material or several, got {each!r}")
        return tuple(map(shared, made))
    if color is None:
        painted = isinstance(shape, Mesh) and shape.colors is not None
        return (colored((1.0, 1.0, 1.0)),) if painted else ()
    return (colored(color),)
