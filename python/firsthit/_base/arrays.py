"""Arguments to arrays, with errors that say what came and what was wanted."""

from __future__ import annotations

import math
import operator
from dataclasses import fields
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from firsthit import _firsthit

from .errors import warn
from .hints import hint

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator

    import numpy.typing as npt

_PLAIN = (np.ndarray, list, tuple)
_T = TypeVar("_T")
_Number = TypeVar("_Number", bound=np.generic)
_NO_ARRAYS = (list, tuple, float, int)
_FLOAT64 = np.dtype(np.float64)

#: How many rays go to the native half at a time where they are copied for it: what is made beside
#: the result stays below 64 MB.
CHUNK = 1 << 19


def settle(immutable: object, **values: object) -> None:
    """Give something its attributes that cannot be changed later."""
    for name, value in values.items():
        object.__setattr__(immutable, name, value)


def settle_numbers(immutable: Any, **values: npt.ArrayLike) -> None:
    """Give a dataclass attributes that cannot be changed: one number, or else three."""
    ones = [field.name for field in fields(immutable) if field.type == "float"]
    for name, value in values.items():
        settle(immutable, **{name: (number if name in ones else vector)(name, value)})


def direction(name: str, value: npt.ArrayLike) -> tuple[float, float, float]:
    """Return three numbers that are finite, and not all zero."""
    way = vector(name, value)
    if not (any(way) and all(map(math.isfinite, way))):
        raise ValueError(f"{name} must be a finite direction, not zero, got {way}")
    return way


def vector(name: str, value: npt.ArrayLike) -> tuple[float, float, float]:
    """Return three numbers; whether they make sense is for others to say."""
    array = numbers(name, value)
    if array.shape != (3,):
        raise ValueError(f"{name} must be three numbers, got an array of shape {array.shape}")
    x, y, z = cast(array, np.float64).tolist()
    return x, y, z


def color_of(
    name: str, value: npt.ArrayLike, *, is_light: bool = False, others: tuple[str, ...] = ()
) -> tuple[float, float, float]:
    """Return a linear colour: of three numbers, sRGB as ``#rrggbb``, or a CSS name.

    Only lights are brighter than white on purpose.
    """
    if isinstance(value, str):
        named, meant = _firsthit.named_color(text(name, value).strip(), others)
        if named is None:
            hint = "" if meant is None else f"; did you mean {meant!r}?"
            forms = ", ".join(("three linear numbers", "'#rrggbb'", *map(repr, others)))
            raise ValueError(f"{name} must be {forms} or a CSS name, got {value!r}{hint}")
        red, green, blue = named
        return red, green, blue
    made = vector(name, value)
    if not all(map(math.isfinite, made)) or min(made) < 0.0:
        raise ValueError(f"{name} must be finite and not negative, got {made}")
    levels = None if is_light else _firsthit.meant_as_levels(made)
    if levels is not None:
        warn(
            f"{name} {made} is brighter than white: colours are linear, from 0 to 1; "
            f"levels from 0 to 255 are written {levels!r}"
        )
    return made


def number(name: str, value: npt.ArrayLike) -> float:
    """Return one number."""
    if isinstance(value, str | bytes | bool):
        raise ValueError(f"{name} must be a number, got {value!r}")
    array = numbers(name, value)
    if array.shape != ():
        raise ValueError(f"{name} must be a number, got an array of shape {array.shape}")
    return float(array)


def share(name: str, value: npt.ArrayLike) -> float:
    """Return a number from 0 to 1."""
    made = number(name, value)
    if not 0.0 <= made <= 1.0:
        raise ValueError(f"{name} must be from 0 to 1, got {made}")
    return made


def count(name: str, value: object, least: int = 0, most: int | None = None) -> int:
    """Return a whole number that is not negative, or within its bounds."""
    try:
        whole = index(name, value)
    except TypeError:
        raise ValueError(f"{name} must be a whole number, got {value!r}") from None
    if most is None and whole >= 2**63:
        raise ValueError(f"{name} must be below 2^63, got {whole}")
    if not least <= whole <= (whole if most is None else most):
        span = f"{least or 'zero'} or more" if most is None else f"from {least} to {most}"
        raise ValueError(f"{name} must be {span}, got {whole}")
    return whole


def fits(shape: tuple[int, ...], wanted: tuple[int, ...]) -> bool:
    """Tell whether an array of a shape can be broadcast to another shape."""
    try:
        return np.broadcast_shapes(shape, wanted) == wanted
    except ValueError:
        return False


def index(name: str, value: Any) -> int:
    """Return a whole number, of Python's or NumPy's, that says which of several is meant."""
    if not isinstance(value, bool | np.bool_):
        try:
            return operator.index(value)
        except TypeError:
            pass
    raise TypeError(f"{name} must be an int, got {value!r}")


def numbers(name: str, value: Any) -> npt.NDArray[Any]:
    """Return an array of real numbers, not copied where it is one already."""
    # Asked first what it mostly is: a call with one ray takes little longer than this.
    if type(value) not in _PLAIN:
        if hasattr(value, "__array__"):
            if np.ma.is_masked(value):
                gaps = np.count_nonzero(value.mask)
                raise ValueError(f"{name} must not be masked, got {gaps} masked elements")
        elif hasattr(value, "__dlpack__"):
            value = np.from_dlpack(value)
        elif isinstance(value, dict | set | str | bytes):
            raise ValueError(f"{name} must be an array of numbers, got {type(value).__name__}")
    try:
        array = np.asarray(value)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} must be an array of numbers: {error}") from None
    if array.size == 0 and array.dtype == np.float64:
        return array
    if array.dtype.kind not in "fiu":
        raise ValueError(f"{name} must be an array of real numbers, got dtype {array.dtype}")
    return array


def one_of(name: str, value: _T, known: Collection[object]) -> _T:
    """Return a word that is one of those that are known."""
    if not isinstance(value, str) or value not in known:
        words = [str(word) for word in known]
        meant = hint(value, words)
        raise ValueError(f"{name} must be one of {', '.join(words)}, got {value!r}{meant}")
    return value


def listed(name: str, value: Any) -> tuple[Any, ...]:
    """Return what a list or another sequence has."""
    try:
        return tuple(value)
    except TypeError:
        raise ValueError(f"{name} must be a sequence, got {value!r}") from None


def vectors(name: str, value: Any, length: int = 3) -> npt.NDArray[Any]:
    """Return an array of vectors, (..., length)."""
    array = numbers(name, value)
    if array.ndim == 0 or array.shape[-1] != length:
        raise ValueError(f"{name} must have the shape (..., {length}), got {array.shape}")
    return array


def is_own(value: Any) -> bool:
    """Tell whether `numbers` makes a new array of a value, without other references."""
    return type(value) in _NO_ARRAYS


def locked(value: Any) -> npt.NDArray[np.float64]:
    """Return numbers in a read-only array of our own; ``None`` among them becomes NaN."""
    array = np.array(value, np.float64)
    array.flags.writeable = False
    return array


def copied(table: dict[str, npt.NDArray[Any]]) -> dict[str, npt.NDArray[Any]]:
    """Return a table with columns of its own, which can be written."""
    return {name: column.copy() for name, column in table.items()}


def lock(array: Any) -> None:
    """Make an array and its bases read-only, so that no view can be made writable again."""
    while isinstance(array, np.ndarray):
        array.setflags(write=False)
        array = array.base


def table(name: str, value: Any, columns: int, dtype: npt.DTypeLike) -> npt.NDArray[Any]:
    """Return an array of shape (n, columns), C-contiguous and of one type."""
    array = numbers(name, value)
    if array.ndim != 2 or array.shape[1] != columns:
        if array.size == 0:
            array = array.reshape(0, columns)
        else:
            raise ValueError(f"{name} must have the shape (n, {columns}), got {array.shape}")
    return cast(array, dtype)


def cast(array: npt.NDArray[Any], dtype: npt.DTypeLike) -> npt.NDArray[Any]:
    """Return an array as C-contiguous numbers of a type, itself where it is that already.

    NumPy would warn of signalling NaNs and of numbers that become infinite. Both are for those to
    refuse who do not take numbers that are not finite.
    """
    with np.errstate(all="ignore"):
        return np.asarray(array, dtype=dtype, order="C")


def text(name: str, value: _T) -> _T:
    """Return a text that the native half takes: one that UTF-8 can hold."""
    if not isinstance(value, str):
        raise TypeError(f"{name} must be a str, got {value!r}")
    if any("\ud800" <= character <= "\udfff" for character in value):
        raise ValueError(f"{name} must be text without lone surrogates, got {value!r}")
    return value


def flag(name: str, value: object) -> bool:
    """Return a truth value, of Python's or NumPy's."""
    if not isinstance(value, bool | np.bool_):
        raise TypeError(f"{name} must be True or False, got {value!r}")
    return bool(value)


def threads_or_all(threads: int | None) -> int:
    """Return the number of threads, 0 for all there are."""
    return 0 if threads is None else count("threads", threads, 1, 1024)


def filled(out: Any, values: Any) -> Any:
    """Return an array of the caller's, or a tensor of the CPU's, with these values in it."""
    array = out
    if not isinstance(out, np.ndarray):
        if not hasattr(out, "__dlpack__"):
            raise TypeError(f"out must be an array that can be written, got {out!r}")
        array = np.from_dlpack(out)
    shape = np.shape(values)
    if array.shape != shape:
        raise ValueError(f"out must have the shape {shape}, got {array.shape}")
    if not array.flags.writeable:
        raise ValueError("out must be an array that can be written, got a read-only one")
    try:
        np.copyto(array, values, casting="same_kind")
    except TypeError:
        kind = np.asarray(values).dtype
        raise ValueError(f"out must take {kind}, got an array of {array.dtype}") from None
    return out


def is_flat(view: npt.NDArray[Any]) -> bool:
    """Tell whether `flat` need not copy the whole of an array."""
    return view.dtype == np.float64 and view.flags.c_contiguous and view.flags.aligned


def chunks(length: int) -> Iterator[slice]:
    """Cut a length into pieces of at most ``CHUNK``."""
    for start in range(0, length, CHUNK):
        yield slice(start, min(start + CHUNK, length))


def flat(view: npt.NDArray[Any], part: slice, trailing: int) -> npt.NDArray[np.float64]:
    """Return elements ``part`` of an array, counted over all but its ``trailing`` last axes.

    They come as C-contiguous float64; copied only where the memory is not that already, and never
    more than the part.
    """
    return plain(_piece(view, part, trailing))


def elements(
    array: npt.NDArray[_Number], shape: tuple[int, ...], part: slice, trailing: int = 0
) -> npt.NDArray[_Number]:
    """Return elements ``part`` of an array that is broadcast to a shape, or the one for all."""
    rest = array.shape[array.ndim - trailing :]
    if array.size == math.prod(rest):
        return array.reshape(1, *rest)
    view = np.broadcast_to(array, shape + rest)
    return np.ascontiguousarray(_piece(view, part, trailing))


def at_numbers(numbers: npt.NDArray[np.int64], shape: tuple[int, ...]) -> tuple[Any, ...]:
    """Return the index of elements of an array that are counted row by row."""
    # NumPy has no index of nothing but axes that are not there.
    return np.unravel_index(numbers, shape) if shape else ()


def chosen(index: Any, shape: tuple[int, ...]) -> npt.NDArray[np.int64]:
    """Return the numbers, counted row by row, of the elements that an index leads to.

    They have the shape that an array of ``shape`` has at that index. Whole numbers take a time that
    does not depend on how many elements there are.
    """
    parts = index if isinstance(index, tuple) else (index,)
    if len(parts) > len(shape) or not all(map(_is_whole, parts)):
        everything: Any = np.arange(math.prod(shape)).reshape(shape)
        return np.asarray(everything[index])
    first = 0
    for axis, (part, length) in enumerate(zip(map(int, parts), shape, strict=False)):
        if not -length <= part < length:
            raise IndexError(f"index {part} is out of bounds for axis {axis} with size {length}")
        first = first * length + part % length
    rest = shape[len(parts) :]
    count = math.prod(rest)
    return np.arange(first * count, (first + 1) * count).reshape(rest)


def _is_whole(part: object) -> bool:
    return isinstance(part, int | np.integer) and not isinstance(part, bool)


def _piece(view: npt.NDArray[_Number], part: slice, trailing: int) -> npt.NDArray[_Number]:
    leading = view.shape[: view.ndim - trailing]
    rest = view.shape[view.ndim - trailing :]
    if len(leading) == 1:
        return view[part]
    if view.flags.c_contiguous or not leading:
        return view.reshape(-1, *rest)[part]
    return view[np.unravel_index(np.arange(part.start, part.stop), leading)]


def plain(view: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
    """Return an array as C-contiguous, aligned float64: itself where it is that already."""
    if view.dtype != _FLOAT64:
        return cast(view, _FLOAT64)
    flags = view.flags
    return view if flags.c_contiguous and flags.aligned else view.copy(order="C")
