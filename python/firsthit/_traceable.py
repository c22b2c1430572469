"""What a scene is to those who only shoot at it or look at it."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from . import _firsthit
    from ._types import Vector


class Traceable:
    """What rays can be traced through, and which way is up there: a `Scene`."""

    def _native(self) -> _firsthit.Scene:
        """Return what rays are shot at."""
        raise NotImplementedError

    @property
    def up(self) -> Vector:
        """Which way is up in the world, of any length."""
        raise NotImplementedError
