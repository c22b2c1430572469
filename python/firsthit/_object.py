"""Objects: shapes with a transform and materials."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from . import _firsthit
from ._arrays import cast, numbers
from ._material import Material
from ._shapes import Mesh, Shape

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from ._foreign import Part
    from ._types import Vector


class Object:
    """A shape with its name, transform and materials, as `Scene.add` made it. Read-only."""

    def __init__(
        self,
        shape: Shape,
        name: str,
        transform: npt.NDArray[np.float64] | None,
        materials: tuple[Material, ...],
        mark: object | None = None,
    ) -> None:
        self._shape, self._name, self._transform = shape, name, transform
        self._materials = materials
        #: By which it is known wherever it moves.
        self._mark = mark or object()

    @property
    def shape(self) -> Shape:
        """The shape, in object space."""
        return self._shape

    @property
    def name(self) -> str:
        """Its name; may be empty."""
        return self._name

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
        """Its materials, in the order of a mesh's ``slots``; empty if it was given none."""
        return self._materials

    @property
    def triangles(self) -> int:
        """The number of its triangles; 0 for a shape that is not a mesh."""
        return self._shape._mesh.counts()[1] if isinstance(self._shape, Mesh) else 0

    def _moved(self, matrix: npt.NDArray[np.float64]) -> Object:
        """Return the same object elsewhere."""
        return Object(self._shape, self._name, matrix, self._materials, self._mark)

    def __repr__(self) -> str:
        return f"Object({self._name!r}, {self._shape!r})"

    def _native(
        self,
    ) -> tuple[_firsthit.Shape, str, list[list[float]] | None, list[_firsthit._Material]]:
        rows = None if self._transform is None else self._transform.tolist()
        materials = [material._native() for material in self._materials]
        return self._shape._native(), self._name, rows, materials


def placed(
    part: Part,
    matrix: npt.NDArray[np.float64] | None,
    color: npt.ArrayLike | None,
    material: Material | Sequence[Material] | None,
) -> Object:
    """Return a part as an object: where it is moved to, and as it is to look."""
    if color is None and material is None:
        material = part.material
    where = part.transform
    if where is not None:
        where = affine(where if matrix is None else matrix @ where)
    looks = _materials(part.shape, color, material)
    return Object(part.shape, part.name, matrix if where is None else where, looks)


def affine(transform: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return a transform as (4, 4), if it can be undone."""
    # A copy, which nobody else can change.
    matrix = np.array(cast(numbers("transform", transform), np.float64))
    if matrix.shape == (3, 4):
        matrix = np.vstack([matrix, [0.0, 0.0, 0.0, 1.0]])
    if matrix.shape != (4, 4):
        raise ValueError(f"transform must have the shape (4, 4) or (3, 4), got {matrix.shape}")
    if not np.array_equal(matrix[3], [0, 0, 0, 1]):
        raise ValueError(f"transform must have the last row 0, 0, 0, 1, got {matrix[3]}")
    # Refused here, not at the first shot.
    _firsthit.check_transform(matrix.tolist())
    return matrix


def _materials(
    shape: Shape, color: npt.ArrayLike | None, material: Material | Sequence[Material] | None
) -> tuple[Material, ...]:
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
        return made
    if color is None:
        painted = isinstance(shape, Mesh) and shape.colors is not None
        return (Material(),) if painted else ()
    return (Material(color),)
