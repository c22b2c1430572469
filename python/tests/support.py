"""Helpers of several tests."""

import math
import os
import subprocess
import sys
from pathlib import Path

import firsthit as fh
import numpy as np
import pytest

REFDATA = Path(__file__).parents[3] / "shared" / "refdata" / "public"
ROOT = Path(__file__).parents[2]
TESTDATA = ROOT / "testdata"

#: Whether tests take all cases: FIRSTHIT_TEST=full, which is `make test-full`.
FULL = os.environ.get("FIRSTHIT_TEST", "") == "full"
if os.environ.get("FIRSTHIT_TEST", "") not in ("", "full"):
    raise ValueError("FIRSTHIT_TEST must be full or not be set")
#: Otherwise they take one of so many.
FEWER = 7


def cases(count: int) -> int:
    """Return how many of so many cases a test takes."""
    return count if FULL else -(-count // FEWER)


def some(items: list) -> list:
    """Return the items that a test takes; they are like each other."""
    return items if FULL else items[::FEWER]


needs_refdata = pytest.mark.skipif(not REFDATA.is_dir(), reason="../shared/refdata is not here")

#: pycocotools hands NumPy an array that cannot be asked whether it is copied.
of_pycocotools = pytest.mark.filterwarnings("ignore:__array__ implementation:DeprecationWarning")

#: What scripts of tests begin with.
PRELUDE = f"""
import faulthandler, gc, os, resource, signal, sys, threading, time
sys.path.insert(0, {str(Path(__file__).parent)!r})
import firsthit as fh, numpy as np
"""


def output(script: str, seconds: float = 60) -> list[str]:
    """Run a script in a process of its own, which must say nothing else; return its words."""
    command = [sys.executable, "-c", PRELUDE + script]
    child = subprocess.run(command, capture_output=True, text=True, timeout=seconds, check=False)
    assert child.returncode == 0, child.stderr
    assert child.stderr == ""
    return child.stdout.split()


#: A unit square at z = 0, facing +z.
SQUARE = ([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])


def bumpy_sphere(rings: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A closed star-shaped mesh around the origin, with radii from 0.7 to 1.3."""
    around = 2 * rings
    polar, turn = np.meshgrid(
        np.pi * np.arange(1, rings) / rings, 2 * np.pi * np.arange(around) / around, indexing="ij"
    )
    unit = np.stack([np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar)], -1)
    radii = np.random.default_rng(seed).uniform(0.7, 1.3, polar.shape)
    points = np.vstack([[[0, 0, 1], [0, 0, -1]], (unit * radii[..., None]).reshape(-1, 3)])
    ring, k = np.meshgrid(np.arange(rings - 2), np.arange(around), indexing="ij")
    at = lambda r, c: 2 + r * around + c % around  # noqa: E731
    quads = [at(ring, k), at(ring + 1, k), at(ring + 1, k + 1), at(ring, k + 1)]
    a, b, c, d = (q.ravel() for q in quads)
    c0 = np.arange(around)
    top = np.stack([0 * c0, at(0, c0), at(0, c0 + 1)], 1)
    bottom = np.stack([0 * c0 + 1, at(rings - 2, c0 + 1), at(rings - 2, c0)], 1)
    triangles = np.vstack([top, bottom, np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    return points.astype(np.float32), triangles


class Dlpack:
    """An array as torch has it on the CPU: it shares its memory by DLPack, and is no array."""

    def __init__(self, array):
        self.array = array

    def __dlpack__(self, **options):
        return self.array.__dlpack__(**options)

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()


def ball() -> fh.Scene:
    """A unit sphere at the origin."""
    scene = fh.Scene()
    scene.add(fh.Sphere(center=(0, 0, 0), radius=1), name="ball")
    return scene


def turned(axis, angle, place=(0, 0, 0), scale=1.0):
    """A rotation about an axis, a place, and a scale along the object's axes."""
    x, y, z = np.array(axis, float) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turn = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn * scale, place
    return matrix


def things(count: int, low: tuple[float, ...], high: tuple[float, ...]) -> fh.Scene:
    """Shapes of all kinds within a box, turned and scaled: ``thing 0`` and so on."""
    scene, rng = fh.Scene(), np.random.default_rng(12)
    shapes = [
        fh.Mesh(*bumpy_sphere(8, 3)),
        fh.Sphere((0, 0, 0), 0.9),
        fh.Box((-0.8, -0.5, -0.6), (0.7, 0.9, 0.4)),
        fh.Cylinder((0, 0, -1), (0.3, 0.2, 1), 0.5),
        fh.Cone((0, 0, -1), (0, 0.2, 1), 0.8, 0.2),
        fh.Disc((0, 0, 0), (1, 2, 3), 0.9),
    ]
    for k in range(count):
        place = rng.uniform(low, high)
        matrix = turned(rng.normal(size=3), rng.uniform(0, 6), place, rng.uniform(0.4, 1.2, 3))
        scene.add(shapes[k % len(shapes)], name=f"thing {k}", transform=matrix)
    return scene
