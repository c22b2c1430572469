"""The view of a scene for code that only traces or looks at it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import share
from firsthit._base.memory import uncollected
from firsthit._looks.lights import light_native

from .filters import ALL, one_mask
from .object import chosen
from .object_list import ObjectList, natives

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import numpy.typing as npt

    from firsthit._base.progress import Report
    from firsthit._looks.environment import Environment
    from firsthit._looks.lights import Light
    from firsthit.typing import Build, Progress, Selection, Vector

    from .object import Object

#: The environment of a scene, which way is up, and whether that is guessed.
Surroundings: TypeAlias = "tuple[Environment | None, Vector, bool]"
#: A mask, the objects that are there, and the alpha below which what is translucent is cut out.
SeenKey: TypeAlias = "tuple[int, tuple[int, ...] | None, float | None]"


_IDENTITY = np.eye(4)


class Built:
    """A built scene that rays are shot at, with what it was built from; immutable.

    It is pickled as what it was built from.
    """

    def __init__(
        self,
        objects: ObjectList,
        lights: Sequence[Light],
        around: Surroundings,
        native: _firsthit.Scene | None = None,
        previous: _firsthit.Scene | None = None,
        build: Build = "auto",
        report: Report | None = None,
    ) -> None:
        """Build it, unless ``native`` is that already; ``previous`` lends what did not change."""
        self.objects, self.lights, self.around = objects, lights, around
        #: The scenes that rays of one mask, or of some objects, were last shot at.
        self._seen: _Seen | None = None
        #: The environment that it was last lit by, which way is up there, and what that is.
        self._lit: tuple[Environment, Vector, _firsthit.Scene] | None = None
        environment, up, is_guessed = around
        with uncollected():
            self.native = native or _firsthit.Scene(
                natives(objects),
                [light_native(light) for light in lights],
                None if environment is None else environment._native(),
                (up, is_guessed),
                previous,
                build,
                report,
            )

    @uncollected()
    def changed(self, changed: Mapping[int, Object], report: Report | None) -> Built:
        """Return the built scene with other objects at some identifiers, or new ones at the end.

        Only what changed is converted: where an object only moved, its transform.
        """
        objects = self.objects[:]
        replaced, moved, hidden = [], [], []
        looks: dict[tuple[int, ...], list[_firsthit._Material]] = {}
        count = len(objects)
        objects.extend(made for identifier, made in changed.items() if identifier >= count)
        for identifier, made in changed.items():
            old, objects[identifier] = objects[identifier], made
            if identifier >= count or not made._is_made_of(old):
                replaced.append((identifier, made._native(looks)))
                continue
            if made._transform is not old._transform:
                moved.append(identifier)
            if made._is_hidden != old._is_hidden:
                hidden.append((identifier, made._is_hidden))
        transforms = np.empty((len(moved), 4, 4))
        for k, identifier in enumerate(moved):
            matrix = objects[identifier]._transform
            transforms[k] = _IDENTITY if matrix is None else matrix
        places = np.array(moved, np.int64), transforms
        native = self.native.changed(replaced, places, hidden, report)
        environment, _, is_guessed = self.around
        if is_guessed and environment is not None:
            # Which way is up may be another one now, and the environment lies by it.
            return Built(objects, self.lights, self.around, previous=native)
        return Built(objects, self.lights, self.around, native)

    def seen(
        self,
        mask: npt.ArrayLike | None,
        objects: Selection | None,
        blend_below: float | None = None,
    ) -> Built:
        """Return what rays of one mask are shot at, where there is one, and of some objects.

        All objects are in it, and those that are not met are hidden. A translucent surface is cut
        out below an alpha, if there is one.
        """
        if objects is None and blend_below is None and (mask is None or np.ndim(mask)):
            return self
        bits = ALL if mask is None or np.ndim(mask) else one_mask("mask", mask)
        only = None if objects is None else tuple(chosen(self.objects, objects))
        alpha = None if blend_below is None else share("blend_below", blend_below)
        return self.seen_by((bits, only, alpha))

    def seen_by(self, key: SeenKey) -> Built:
        """Return what is seen by a mask, of objects by identifiers, below an alpha."""
        mask, only, blend_below = key
        last = self._seen
        if last is None or last.key != key:
            native = self.native.seen_by(mask, None if only is None else list(only), blend_below)
            last = _Seen(self.objects, self.lights, self.around, native, key)
            # The last one alone is kept: it is asked for again and again, or never.
            self._seen = last
        return last

    def lit_by(self, environment: Environment, up: Vector) -> _firsthit.Scene:
        """Return what pictures in another environment are of, with its sun if it has one."""
        last = self._lit
        if last is None or last[0] is not environment or last[1] != up:
            native = self.native.lit_by(environment._native(), up)
            last = environment, up, native
            # The last one alone is kept: many pictures are of the same.
            self._lit = last
        return last[2]

    def __reduce__(self) -> tuple[Any, ...]:
        return Built, (self.objects, self.lights, self.around)


class _Seen(Built):
    """A built scene for rays of one mask, or of some objects; it does not hold all as built."""

    def __init__(
        self,
        objects: ObjectList,
        lights: Sequence[Light],
        around: Surroundings,
        native: _firsthit.Scene,
        key: SeenKey,
    ) -> None:
        super().__init__(objects, lights, around, native)
        self.key = key

    def __reduce__(self) -> tuple[Any, ...]:
        return _seen_again, (self.objects, self.lights, self.around, self.key)


def _seen_again(
    objects: ObjectList,
    lights: Sequence[Light],
    around: Surroundings,
    key: SeenKey,
) -> Built:
    return Built(objects, lights, around).seen_by(key)


class Traceable:
    """A scene to trace rays through, with its direction upwards: a `Scene`."""

    def _ready(self, progress: Progress | None = None) -> Built:
        """Return what rays are shot at, with what it was built from."""
        raise NotImplementedError

    def _native(self) -> _firsthit.Scene:
        """Return what rays are shot at."""
        return self._ready().native

    @property
    def up(self) -> Vector:
        """The direction upwards in the world, of any length."""
        raise NotImplementedError
