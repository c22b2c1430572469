"""Filters of rays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from firsthit._base.arrays import elements, numbers
from firsthit.typing import Side

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit import _firsthit

#: A ray with this mask meets every object that has any bit.
ALL = 0xFFFFFFFF


class Filters:
    """Filters of rays: the objects they see, the side they pass, the surfaces they skip or leave.

    All arrays are ours, and broadcast against the rays.
    """

    __slots__ = ("cull", "left", "masks", "only", "skip")

    def __init__(
        self,
        masks: npt.NDArray[np.uint32] | None = None,
        cull: Side | None = None,
        skip: _firsthit._Surfaces | None = None,
        left: _firsthit._Places | None = None,
        only: npt.NDArray[np.int32] | None = None,
    ) -> None:
        self.masks, self.cull, self.skip, self.left = masks, cull, skip, left
        #: The object that each ray meets, and no other.
        self.only = only

    @classmethod
    def of(
        cls, masks: Any, cull: Any, skip: Any, left: _firsthit._Places | None = None
    ) -> Filters | None:
        """Check what a user gave; ``None`` where rays meet everything."""
        if masks is None and cull is None and skip is None and left is None:
            return None
        if cull is not None and (not isinstance(cull, str) or cull not in get_args(Side)):
            raise ValueError(f"cull must be 'front', 'back' or None, got {cull!r}")
        side: Side | None = cull  # type: ignore[assignment]
        return cls(
            None if masks is None else _integers("mask", masks, np.uint32),
            side,
            None if skip is None else surfaces("skip", skip),
            left,
        )

    def shapes(self) -> list[tuple[int, ...]]:
        """Return the shapes of the arrays, without the axis of the weights."""
        arrays = [array for array in (self.masks, self.only) if array is not None]
        arrays += [*(self.skip or ()), *(self.left or ())[:2]]
        return [array.shape for array in arrays]

    def part(self, part: slice, shape: tuple[int, ...]) -> _firsthit._Filters:
        """Return those of some of the rays, whose shape is given, as the native half takes them."""
        masks = None if self.masks is None else elements(self.masks, shape, part)
        only = None if self.only is None else elements(self.only, shape, part)
        skip = left = None
        if self.skip is not None:
            identifiers, primitive = self.skip
            skip = elements(identifiers, shape, part), elements(primitive, shape, part)
        if self.left is not None:
            identifiers, primitive, weights, sides = self.left
            both = elements(identifiers, shape, part), elements(primitive, shape, part)
            there = elements(weights, shape, part, 1).reshape(-1, 2)
            left = (*both, there, elements(sides, shape, part))
        return masks, self.cull, skip, left, only


def of_each_ray(mask: Any) -> Any:
    """Return masks that rays have each; one for all is left to `Built.seen`, and costs nothing."""
    return mask if mask is None or np.ndim(mask) else None


def surfaces(name: str, given: Any) -> _firsthit._Surfaces:
    """Return the objects and primitives of surfaces; -1 where there is none."""
    if not isinstance(given, tuple | list) or len(given) != 2:
        raise ValueError(f"{name} must be a pair (object, primitive), got {given!r}")
    identifiers, primitive = given
    return (
        _integers(f"{name}[0]", identifiers, np.int32),
        _integers(f"{name}[1]", primitive, np.int32),
    )


def one_mask(name: str, given: Any) -> int:
    """Return a mask for all rays, or of an object."""
    return int(_integers(name, given, np.uint32, is_one=True))


def _integers(
    name: str, given: Any, dtype: type[np.integer[Any]], *, is_one: bool = False
) -> npt.NDArray[Any]:
    """Return whole numbers of a type as an array of our own."""
    array = numbers(name, given)
    if is_one and array.shape != ():
        raise ValueError(f"{name} must be one number, got an array of shape {array.shape}")
    if array.size > 0:
        low, high = np.iinfo(dtype).min, np.iinfo(dtype).max
        if array.dtype.kind not in "iu":
            raise ValueError(f"{name} must be whole numbers, got dtype {array.dtype}")
        if int(array.min()) < low or int(array.max()) > high:
            raise ValueError(f"{name} must be from {low} to {high}")
    return np.array(array, dtype, order="C")
