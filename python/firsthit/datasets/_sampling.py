"""Poses by chance: numbers that depend on the seed and the frame alone, and what is made of them.

Nothing here rounds differently on another machine: sums, products, quotients and square roots are
Python's, one by one, and the sine and cosine of an angle are those of the native half.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from firsthit import _firsthit

Vector = tuple[float, float, float]
Axes = tuple[Vector, Vector, Vector]

#: The stream of the numbers that poses are made from; those of sensors follow it.
POSES = 0


class Uniforms:
    """Numbers from 0 on, below 1: the same for a seed, a frame and a stream on every machine.

    Number i is ``(raw >> 11) * 2.0**-53`` with raw the i-th number of ``random_raw`` of
    ``numpy.random.Philox(key=[seed, frame], counter=[0, 0, 0, stream])``. NumPy promises that
    stream (NEP 19): it is Philox 4x64-10 of Salmon and others (2011).
    """

    def __init__(self, seed: int, frame: int, stream: int = POSES) -> None:
        key = np.array([seed, frame], np.uint64)
        counter = np.array([0, 0, 0, stream], np.uint64)
        self._bits = np.random.Philox(key=key, counter=counter)

    def raw(self) -> int:
        """Return the next 64 bits."""
        return int(self._bits.random_raw())

    def next(self) -> float:
        """Return the next number."""
        return (self.raw() >> 11) * 2.0**-53

    def between(self, ends: tuple[float, float]) -> float:
        """Return a number between two: the first, if they are the same."""
        share = self.next()
        return ends[0] + (ends[1] - ends[0]) * share


class Pose(NamedTuple):
    """The pose of the rig: its origin, and the directions of its axes in the world."""

    position: Vector
    axes: Axes

    def matrix(self) -> list[list[float]]:
        """Return the matrix that takes the rig's coordinates to the world's."""
        forwards, left, up = self.axes
        rows = zip(forwards, left, up, self.position, strict=True)
        return [*map(list, rows), [0.0, 0.0, 0.0, 1.0]]


def turn(degrees: float) -> tuple[float, float]:
    """Return the cosine and the sine of an angle."""
    rows = _firsthit.rotation((0.0, 0.0, math.radians(degrees)))
    return rows[0][0], rows[1][0]


def sine_between(uniforms: Uniforms, degrees: tuple[float, float]) -> tuple[float, float]:
    """Return cosine and sine of an elevation, of which all areas of the sphere are as likely.

    The sine is uniform: Archimedes' map of the cylinder to the sphere keeps areas.
    """
    low, high = (turn(each)[1] for each in degrees)
    sine = min(max(uniforms.between((low, high)), -1.0), 1.0)
    return math.sqrt(max(1.0 - sine * sine, 0.0)), sine


def level(up: Vector) -> Axes:
    """Return three axes at right angles, of which the last is ``up``, for azimuths and elevations.

    The first is the axis of the world that is most level, of equal ones the first, made level.
    """
    z = unit(up)
    steep = [abs(each) for each in z]
    least = steep.index(min(steep))
    axis = tuple(1.0 if k == least else 0.0 for k in range(3))
    along = dot(axis, z)
    x = unit(tuple(a - along * b for a, b in zip(axis, z, strict=True)))
    return x, cross(z, x), z


def looking(position: Vector, target: Vector, ground: Axes) -> Axes:
    """Return the rig's axes where its forwards points to a target, and its left is level."""
    forwards = unit(tuple(b - a for a, b in zip(position, target, strict=True)))
    left = cross(ground[2], forwards)
    if dot(left, left) < 1e-24:
        # Straight up or down: any left is level.
        left = ground[1]
    left = unit(left)
    return forwards, left, cross(forwards, left)


def rolled(axes: Axes, degrees: float) -> Axes:
    """Return axes that are turned about the first, the left one upwards."""
    if degrees == 0.0:
        return axes
    cosine, sine = turn(degrees)
    forwards, left, up = axes
    return forwards, combined(cosine, left, sine, up), combined(cosine, up, -sine, left)


def headed(ground: Axes, yaw: float, cosine: float, sine: float) -> Axes:
    """Return the rig's axes with an azimuth in degrees, and cosine and sine of an elevation."""
    across, along = turn(yaw)
    ahead = combined(across, ground[0], along, ground[1])
    left = combined(across, ground[1], -along, ground[0])
    forwards = combined(cosine, ahead, sine, ground[2])
    return forwards, left, combined(cosine, ground[2], -sine, ahead)


def combined(a: float, first: Vector, b: float, second: Vector) -> Vector:
    """Return ``a * first + b * second``."""
    x, y, z = (a * p + b * q for p, q in zip(first, second, strict=True))
    return x, y, z


def unit(vector: tuple[float, ...]) -> Vector:
    """Return a vector of length one."""
    x, y, z = vector
    largest = max(abs(x), abs(y), abs(z))
    if largest == 0.0:
        raise ValueError("a direction must not be zero")
    x, y, z = x / largest, y / largest, z / largest
    length = math.sqrt(x * x + y * y + z * z)
    return x / length, y / length, z / length


def dot(a: tuple[float, ...], b: tuple[float, ...]) -> float:
    """Return the dot product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Return the cross product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
