"""The classes of objects, and their grouping into instances."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from contextvars import ContextVar
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Literal, NamedTuple

from firsthit._base.arrays import text
from firsthit._base.errors import warn
from firsthit._base.hints import hint

if TYPE_CHECKING:
    from collections.abc import Sequence

    from firsthit._objects.object import Object

#: A table of names or patterns to classes, or a function of an object; ``None`` for no class.
Classes = Mapping[str, str | None] | Callable[["Object"], str | None]
#: The thing that the objects of one instance have in common.
By = Literal["object", "node"] | Callable[["Object"], Hashable]


#: The beginning of a warning of keys without an object, such as the scene of a data set; ``None``
#: for no warning: a data set tells of a scene once, not for each frame.
TOLD_OF: ContextVar[str | None] = ContextVar("TOLD_OF", default="")


class Group(NamedTuple):
    """The objects of an instance."""

    objects: tuple[int, ...]
    class_name: str | None


def grouped(
    objects: Sequence[tuple[int, Object]], classes: Classes | None, by: By
) -> tuple[list[Group], tuple[str, ...]]:
    """Return the instances among objects in the order of their first ones, and all classes.

    Those of a table are all classes that it names, in its order, and else those that there are.
    """
    used: set[str] = set()
    named = _classify(classes, used)
    key_of = _key(by)
    groups: dict[Hashable, list[int]] = {}
    of_group: dict[Hashable, str | None] = {}
    for identifier, made in objects:
        if made.removed or made.hidden:
            if isinstance(classes, Mapping):
                # Its key is not mistyped.
                named(made)
            continue
        name = named(made)
        if name is None and classes is not None:
            continue
        key = key_of(identifier, made)
        if key is None:
            continue
        if of_group.setdefault(key, name) != name and classes is not None:
            others = ", ".join(map(repr, groups[key]))
            raise ValueError(
                f"objects of one instance must have one class, got {of_group[key]!r} for object "
                f"{others} and {name!r} for object {identifier}"
            )
        groups.setdefault(key, []).append(identifier)
    found = [Group(tuple(group), of_group[key]) for key, group in groups.items()]
    of = TOLD_OF.get()
    if isinstance(classes, Mapping) and of is not None:
        _tell(of, [key for key in classes if key not in used], objects)
    there = (group.class_name for group in found if group.class_name is not None)
    told = [*classes.values()] if isinstance(classes, Mapping) else []
    names = dict.fromkeys([*(name for name in told if name is not None), *there])
    return found, tuple(names)


def _tell(of: str, unused: Sequence[str], objects: Sequence[tuple[int, Object]]) -> None:
    """Warn of keys that no object is called by: with a mistyped one there are no annotations."""
    if not unused:
        return
    names = list({name for _, made in objects for name in (made.name, made.node) if name})
    for key in unused:
        meant = hint(key, (name for name in names if name != key))
        warn(f"{of}classes: no object has its class by {key!r}{meant}")


def _classify(classes: Classes | None, used: set[str]) -> Callable[[Object], str | None]:
    if classes is None:
        return lambda made: made.name or None
    if isinstance(classes, Mapping):
        table = {
            text("a key of classes", key): None if name is None else _class_name(name)
            for key, name in classes.items()
        }

        def looked_up(made: Object) -> str | None:
            key = _key_among(table, made)
            if key is None:
                return None
            used.add(key)
            return table[key]

        return looked_up
    if not callable(classes):
        raise TypeError(f"classes must be a dict or a function, got {classes!r}")
    function = classes

    def asked(made: Object) -> str | None:
        name = function(made)
        return None if name is None else _class_name(name)

    return asked


def _class_name(name: str) -> str:
    if not text("the name of a class", name):
        raise ValueError("the name of a class must not be empty; None is for no class")
    return name


def _key_among(table: Mapping[str, str | None], made: Object) -> str | None:
    # The names themselves before patterns: a name may have brackets.
    names = [name for name in (made.node, made.name) if name]
    for name in reversed(names):
        if name in table:
            return name
    for pattern in table:
        # A pattern with a slash is of paths, which names are not; a name may have one, too.
        candidates = names if "/" in pattern else [made.name]
        if any(fnmatchcase(name, pattern) for name in candidates):
            return pattern
    return None


def _key(by: By) -> Callable[[int, Object], Hashable]:
    if by == "object":
        return lambda identifier, _: identifier
    if by == "node":
        # An object in no node is an instance by itself.
        return lambda identifier, made: made._labels[0] or identifier
    if not callable(by):
        raise ValueError(f"by must be 'object', 'node' or a function, got {by!r}")
    function = by
    return lambda _, made: function(made)
