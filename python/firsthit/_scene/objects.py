"""The objects of a scene, and what is shown of many."""

from __future__ import annotations

from typing import TYPE_CHECKING

from firsthit._files.glance import of_objects

if TYPE_CHECKING:
    from firsthit._objects.object import Object

    _Tuple = tuple[Object, ...]
else:
    _Tuple = tuple

#: The most names in one line.
_NAMES = 5


class Objects(_Tuple):
    """The objects of a scene, by their identifiers: a tuple that is short when printed."""

    __slots__ = ()

    def __repr__(self) -> str:
        """Return how many there are, and the names of the first."""
        names = [repr(each.name) for each in self[:_NAMES]]
        if len(self) > _NAMES:
            names.append(f"and {len(self) - _NAMES:,} more")
        return f"Objects({len(self):,}: {', '.join(names)})" if names else "Objects(0)"

    def _repr_html_(self) -> str:
        """Show it at a glance, for notebooks."""
        return of_objects(self)
