"""What a scene is to those who only shoot at it or look at it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import _firsthit

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ._lights import Light
    from ._object import Object
    from ._types import Vector


class Built:
    """What rays are shot at, and what it was built from, none of which changes.

    It is pickled as what it was built from.
    """

    def __init__(
        self,
        objects: Sequence[Object],
        lights: Sequence[Light],
        native: _firsthit.Scene | None = None,
        previous: _firsthit.Scene | None = None,
    ) -> None:
        """Build it, unless ``native`` is that already; ``previous`` lends what did not change."""
        self.objects, self.lights = objects, lights
        self.native = native or _firsthit.Scene(
            [made._native() for made in objects], [light._native() for light in lights], previous
        )

    def moved(self, moved: Mapping[int, Object]) -> Built:
        """Return what is built when some objects, given by identifier, are elsewhere."""
        objects = list(self.objects)
        for identifier, made in moved.items():
            objects[identifier] = made
        places = [(identifier, made.transform.tolist()) for identifier, made in moved.items()]
        return Built(objects, self.lights, self.native.moved(places))

    def __reduce__(self) -> tuple[Any, ...]:
        return Built, (self.objects, self.lights)


class Traceable:
    """What rays can be traced through, and which way is up there: a `Scene`."""

    def _ready(self) -> Built:
        """Return what rays are shot at, with what it was built from."""
        raise NotImplementedError

    def _native(self) -> _firsthit.Scene:
        """Return what rays are shot at."""
        return self._ready().native

    @property
    def up(self) -> Vector:
        """Which way is up in the world, of any length."""
        raise NotImplementedError
