"""Poses by chance: on a sphere around a point, or inside of bounds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ._place import Place
from ._sampling import (
    Pose,
    Uniforms,
    combined,
    headed,
    level,
    looking,
    rolled,
    sine_between,
    turn,
)

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    import numpy.typing as npt

    from firsthit._scene.scene import Scene

    from ._document import Table
    from ._sampling import Axes, Vector

_Span = tuple[float, float]


class _Free(NamedTuple):
    """The conditions for a free place, and the number of tries."""

    clearance: float
    outside_objects: bool
    tries: int

    @classmethod
    def read(cls, table: Table) -> _Free:
        return cls(
            table.number("clearance", 0.0),
            table.get("outside_objects", False),
            table.get("tries", 100),
        )

    def first(self, scene: Scene, draw: Callable[[], Pose]) -> Place:
        """Return the first of the tries that is free.

        Every try draws as many numbers, so that no try depends on why another was refused.
        """
        for _ in range(self.tries):
            pose = draw()
            if self._is_free(pose.position, scene):
                return Place(pose.matrix())
        wanted = f"a clearance of {self.clearance:g}" if self.clearance else "no object around it"
        raise ValueError(
            f"none of {self.tries} places has {wanted}: allow more `tries`, a "
            "smaller `clearance` or another range"
        )

    def _is_free(self, position: Vector, scene: Scene) -> bool:
        if self.clearance > 0.0:
            # One thread: a pool for a single point would take longer than the search.
            found = scene.closest_point(position, radius=self.clearance, threads=1)
            if float(found.distance) < self.clearance:
                return False
        return not (self.outside_objects and bool(np.any(scene.inside(position, threads=1))))


@dataclass(frozen=True)
class Sphere:
    """The rig is in a shell around a centre, and looks at it."""

    count: int
    center: Vector | None
    radius: _Span
    azimuth: _Span
    elevation: _Span
    roll: _Span
    up: Vector | None
    free: _Free

    files: tuple[Path, ...] = ()

    @classmethod
    def read(cls, table: Table) -> Sphere:
        """Return what a table of a plan asks for."""
        return cls(
            table["count"],
            _vector(table, "center"),
            table.span("radius"),
            table.span("azimuth", (-180.0, 180.0)),
            table.span("elevation", (-90.0, 90.0)),
            table.span("roll"),
            _vector(table, "up"),
            _Free.read(table),
        )

    def place(self, seed: int, frame: int, index: int, scene: Scene) -> Place:
        """Return where the rig is in a frame."""
        uniforms, ground = Uniforms(seed, frame), level(self.up or scene.up)
        center = self.center or _middle(scene)

        def draw() -> Pose:
            across, along = turn(uniforms.between(self.azimuth))
            cosine, sine = sine_between(uniforms, self.elevation)
            radius = uniforms.between(self.radius)
            ahead = combined(across, ground[0], along, ground[1])
            away = combined(cosine, ahead, sine, ground[2])
            position = combined(1.0, center, radius, away)
            axes = looking(position, center, ground)
            return Pose(position, rolled(axes, uniforms.between(self.roll)))

        return self.free.first(scene, draw)

    def places(self, scene: Scene, seconds: float) -> tuple[npt.NDArray[np.float64], float]:
        """Return the centre, and the largest radius."""
        return np.array([self.center or _middle(scene)]), self.radius[1]


@dataclass(frozen=True)
class Inside:
    """The rig is anywhere in a box, and looks anywhere within limits."""

    count: int
    box: tuple[Vector, Vector] | None
    yaw: _Span
    pitch: _Span
    roll: _Span
    up: Vector | None
    free: _Free

    files: tuple[Path, ...] = ()

    @classmethod
    def read(cls, table: Table) -> Inside:
        """Return what a table of a plan asks for."""
        low, high = _vector(table, "low"), _vector(table, "high")
        box = None if low is None or high is None else (low, high)
        if box is not None and any(a > b for a, b in zip(*box, strict=True)):
            raise table.refused("low", f"`low` must not be above `high`, got {box[0]} and {box[1]}")
        return cls(
            table["count"],
            box,
            table.span("yaw", (-180.0, 180.0)),
            table.span("pitch"),
            table.span("roll"),
            _vector(table, "up"),
            _Free.read(table),
        )

    def place(self, seed: int, frame: int, index: int, scene: Scene) -> Place:
        """Return where the rig is in a frame."""
        uniforms, ground = Uniforms(seed, frame), level(self.up or scene.up)
        low, high = self.box or _bounds(scene)

        def draw() -> Pose:
            x, y, z = (uniforms.between(ends) for ends in zip(low, high, strict=True))
            yaw = uniforms.between(self.yaw)
            axes: Axes = headed(ground, yaw, *sine_between(uniforms, self.pitch))
            return Pose((x, y, z), rolled(axes, uniforms.between(self.roll)))

        return self.free.first(scene, draw)

    def places(self, scene: Scene, seconds: float) -> tuple[npt.NDArray[np.float64], float]:
        """Return the corners of the box."""
        box = np.array(self.box or _bounds(scene))
        return np.stack(np.meshgrid(*box.T), axis=-1).reshape(-1, 3), 0.0


def _vector(table: Table, key: str) -> Vector | None:
    given: Any = table.numbers(key)
    return None if given is None else (given[0], given[1], given[2])


def _bounds(scene: Scene) -> tuple[Vector, Vector]:
    low, high = scene.bounds.tolist()
    if not all(math.isfinite(each) for each in (*low, *high)):
        raise ValueError("the scene has no finite bounds: the plan's poses must give a place")
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def _middle(scene: Scene) -> Vector:
    x, y, z = (0.5 * low + 0.5 * high for low, high in zip(*_bounds(scene), strict=True))
    return x, y, z
