"""Classes of a scan's returns, by the scene's objects."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from firsthit._base.arrays import count
from firsthit._objects.object import chosen

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from firsthit._objects.object import Object
    from firsthit.typing import ObjectKey

#: The largest class of LAS 1.4.
_MOST = 255


def classes_of(
    objects: Sequence[Object], classes: Mapping[ObjectKey, int]
) -> npt.NDArray[np.int32]:
    """Return the class of each object, 0 for those that are given none."""
    if not isinstance(classes, Mapping):
        raise TypeError(f"classes must be a dict of numbers by object, got {classes!r}")
    made = np.zeros(len(objects), np.int32)
    for key, number in classes.items():
        made[list(chosen(objects, key))] = count(f"classes[{key!r}]", number, 0, _MOST)
    return made
