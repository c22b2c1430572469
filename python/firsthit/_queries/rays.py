"""Rays in arrays of any kind, and as the native half takes them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit._base.arrays import (
    CHUNK,
    at_numbers,
    chunks,
    flat,
    is_flat,
    is_own,
    lock,
    numbers,
    plain,
    vectors,
)
from firsthit._base.memory import SMALL, empty

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from firsthit import _firsthit
    from firsthit._objects.filters import Filters


def _constant(value: float) -> npt.NDArray[np.float64]:
    array = np.array(value)
    array.flags.writeable = False
    return array


#: The limits of rays where nobody says.
NO_MINIMUM, NO_MAXIMUM = _constant(0.0), _constant(math.inf)


class Rays:
    """Origins, directions and both limits, as they came. They broadcast against each other.

    ``arrays`` are origins and directions (..., 3), ``t_min`` and ``t_max`` (...); ``shape`` is the
    rays', and ``length`` how many there are. They do not meet what ``filters`` say.
    """

    __slots__ = ("_are_own", "arrays", "filters", "length", "shape")

    def __init__(
        self,
        arrays: Sequence[npt.NDArray[Any]],
        shape: tuple[int, ...],
        are_own: tuple[bool, bool] = (True, True),
        filters: Filters | None = None,
    ) -> None:
        self.arrays, self.shape, self.length = tuple(arrays), shape, math.prod(shape)
        self.filters = filters
        #: Whether the memory of origins and directions is ours alone.
        self._are_own = are_own

    def __reduce__(self) -> tuple[Any, ...]:
        return Rays, (self.arrays, self.shape, self._are_own, self.filters)

    @classmethod
    def of(
        cls,
        origins: Any,
        directions: Any,
        t_min: Any = 0.0,
        t_max: Any = math.inf,
        *,
        filters: Filters | None = None,
        are_own: bool = False,
    ) -> Rays:
        """Check what a user gave."""
        if directions is None:
            raise ValueError("directions must be given with an array of origins")
        starts, ways = vectors("origins", origins), vectors("directions", directions)
        begins = NO_MINIMUM if _is(t_min, 0.0) else numbers("t_min", t_min)
        ends = NO_MAXIMUM if _is(t_max, math.inf) else numbers("t_max", t_max)
        own = (True, True) if are_own else (is_own(origins), is_own(directions))
        arrays = starts, ways, begins, ends
        leading = [starts.shape[:-1], ways.shape[:-1], begins.shape, ends.shape]
        if filters is not None:
            leading += filters.shapes()
        # NumPy's own way takes longer than to shoot a ray.
        different = {shape for shape in leading if shape}
        if len(different) <= 1:
            return cls(arrays, different.pop() if different else (), own, filters)
        try:
            shape = np.broadcast_shapes(*leading)
        except ValueError:
            beside = "" if filters is None else ", and masks and surfaces,"
            raise ValueError(
                f"origins {starts.shape}, directions {ways.shape}, t_min {begins.shape} and "
                f"t_max {ends.shape}{beside} must broadcast against each other"
            ) from None
        return cls(arrays, shape, own, filters)

    def own(self) -> _firsthit._Copies:
        """Copy what the caller could change, for hits to keep.

        Large arrays of float64 stay as they are: the native half copies them to what is returned,
        in all its threads and into memory that is used again. Elsewhere, copying takes as long as
        finding some of the hits.
        """
        if all(self._are_own):
            return None, None
        copies: list[npt.NDArray[np.float64] | None] = [None, None]
        arrays = list(self.arrays)
        for k in (0, 1):
            array = arrays[k]
            if self._are_own[k]:
                continue
            if array.nbytes >= SMALL and len(self.parts()) == 1 and self._is_native(array, 1):
                copies[k] = empty(array.shape, np.float64)
            else:
                arrays[k] = _copied(array)
        self.arrays = tuple(arrays)
        return copies[0], copies[1]

    def keep(self, copies: _firsthit._Copies) -> Rays:
        """Take the copies that the native half made, and forget limits and filters."""
        origins, directions = copies
        self.arrays = (
            self.arrays[0] if origins is None else origins,
            self.arrays[1] if directions is None else directions,
            NO_MINIMUM,
            NO_MAXIMUM,
        )
        self._are_own, self.filters = (True, True), None
        return self

    def copied(self) -> Rays:
        """Return the rays with limits and filters; their origins and directions are copies."""
        limits, filters = self.arrays[2:], self.filters
        copies = self.own()
        for copy, array in zip(copies, self.arrays[:2], strict=True):
            if copy is not None:
                np.copyto(copy, array)
        return Rays((*self.keep(copies).arrays[:2], *limits), self.shape, filters=filters)

    def unlimited(self) -> Rays:
        """Return the same rays without limits and filters."""
        return Rays((*self.arrays[:2], NO_MINIMUM, NO_MAXIMUM), self.shape, self._are_own)

    def origins(self) -> npt.NDArray[Any]:
        """Return the starts as a read-only view of the shape (..., 3)."""
        return self._view(self.arrays[0])

    def directions(self) -> npt.NDArray[Any]:
        """Return the directions as a read-only view of the shape (..., 3)."""
        return self._view(self.arrays[1])

    def _view(self, array: npt.NDArray[Any]) -> npt.NDArray[Any]:
        lock(array)
        return np.broadcast_to(array, (*self.shape, 3))

    def take(self, chosen: npt.NDArray[np.int64], shape: tuple[int, ...]) -> Rays:
        """Return some of the rays in another shape, without limits and filters."""
        taken = []
        for array in self.arrays[:2]:
            if array.size == 3:
                taken.append(array.reshape(3))
            else:
                view = np.broadcast_to(array, (*self.shape, 3))
                taken.append(view[at_numbers(chosen, self.shape)].reshape(*shape, 3))
        return Rays((*taken, NO_MINIMUM, NO_MAXIMUM), shape)

    def parts(self) -> list[slice]:
        """Return what goes to the native half at a time: all, where little of it is copied."""
        is_native = self.filters is None and all(map(self._is_native, self.arrays, _TRAILING))
        if self.length <= CHUNK or is_native:
            return [slice(0, self.length)]
        return list(chunks(self.length))

    def part(self, part: slice, *, limits: bool = True) -> _firsthit._Rays:
        """Return a part of the rays as the native half takes them: one for all, or one for each."""
        is_whole = part.stop - part.start == self.length
        arrays = self.arrays if limits else (*self.arrays[:2], NO_MINIMUM, NO_MAXIMUM)
        made = []
        for array, trailing in zip(arrays, _TRAILING, strict=True):
            is_one = array.size == 1 + 2 * trailing
            if is_one or (is_whole and array.shape[: array.ndim - trailing] == self.shape):
                made.append(plain(array))
            else:
                view = np.broadcast_to(array, self.shape + array.shape[array.ndim - trailing :])
                made.append(flat(view, part, trailing))
        filters = self.filters.part(part, self.shape) if limits and self.filters else None
        return made[0], made[1], made[2], made[3], filters

    def _is_native(self, array: npt.NDArray[Any], trailing: int) -> bool:
        if array.size == 1 + 2 * trailing:
            return True
        return array.shape[: array.ndim - trailing] == self.shape and is_flat(array)


#: How many axes each of the four arrays has beside those of the rays.
_TRAILING = (1, 1, 0, 0)


def _copied(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Copy an array; what was broadcast stays so."""
    if 0 not in array.strides or array.size == 0:
        return array.copy(order="C")
    one = tuple(slice(0, 1) if stride == 0 else slice(None) for stride in array.strides)
    return np.broadcast_to(array[one].copy(order="C"), array.shape)


def _is(given: Any, number: float) -> bool:
    return type(given) is float and given == number
