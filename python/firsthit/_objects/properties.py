"""Numbers of meshes by name: of vertices, corners or faces."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit._base.arrays import cast, numbers, text

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy.typing as npt

    from firsthit.typing import AttributeOf


#: Beyond this, not every whole number is a float64.
_WHOLE = 1 << 53


def is_exact(array: npt.NDArray[Any]) -> bool:
    """Tell whether float64 holds numbers without a loss, as far as they are integers."""
    if array.dtype.kind not in "iu" or array.size == 0:
        return True
    return int(array.min()) >= -_WHOLE and int(array.max()) <= _WHOLE


def given(
    name: str, arrays: Mapping[str, npt.ArrayLike] | None, of: AttributeOf
) -> Iterator[tuple[str, str, int, bool, npt.NDArray[Any]]]:
    """Yield what the native half wants to know of each: whose, name, components, label, numbers."""
    if not isinstance(arrays, Mapping | None):
        raise TypeError(f"{name} must be a dict of arrays, got {arrays!r}")
    for key, value in (arrays or {}).items():
        named, array = text(f"a name of {name}", key), numbers(key, _counted(value))
        axes = 2 if of == "corners" else 1
        is_right = array.ndim in (axes, axes + 1) and (of != "corners" or array.shape[1] == 3)
        if not is_right or 0 in array.shape[axes:]:
            wanted = "(m, 3) or (m, 3, k)" if of == "corners" else "(n,) or (n, k)"
            raise ValueError(f"{key} must have the shape {wanted}, got {array.shape}")
        components = array.shape[axes] if array.ndim > axes else 1
        is_label = array.dtype.kind in "iu"
        if not is_exact(array):
            span = f"{array.min()} to {array.max()}"
            raise ValueError(f"{key} must be at most 2**53, to be exact as floats, got {span}")
        fits = array.dtype in (np.float32, np.float16, np.int8, np.uint8, np.int16, np.uint16)
        values = cast(array, np.float32 if fits else np.float64).reshape(-1)
        yield of, named, components, is_label, values


def _counted(value: Any) -> Any:
    """Return flags as 0 and 1, and anything else as it is."""
    try:
        array = np.asarray(value) if isinstance(value, list | tuple) else value
    except ValueError:
        # For `numbers` to refuse, which names it.
        return value
    return array.astype(np.uint8) if getattr(array, "dtype", None) == np.bool_ else value


def shaped(of: str, values: npt.NDArray[Any], components: int) -> npt.NDArray[Any]:
    """Return the numbers of a property, one for each without an axis of its own."""
    shape = (-1, 3) if of == "corners" else (-1,)
    return values.reshape(shape if components == 1 else (*shape, components))
