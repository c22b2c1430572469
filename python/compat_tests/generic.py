"""What trimesh's tests about rays and distances take from the module ``generic`` beside them.

trimesh's source distribution has its tests, but neither that module nor the models. Both are in its
repository (``make test-compat TRIMESH=folder``). Without it the shapes that trimesh itself can make
stand in, and a test that needs another model is skipped.
"""

import copy
import json
import logging
import time
import unittest
from collections import deque

import numpy as np
import pytest
import trimesh
from shapely.geometry import Point, Polygon
from trimesh import Trimesh
from trimesh import transformations as tf
from trimesh.constants import tol

__all__ = [
    "Point",
    "Polygon",
    "Trimesh",
    "copy",
    "deque",
    "json",
    "np",
    "tf",
    "time",
    "tol",
    "trimesh",
    "unittest",
]

# trimesh then checks more of what it makes.
tol.strict = True

log = logging.getLogger("trimesh")

has_path = True

#: Models that are shapes of trimesh's own.
MODELS = {
    "unit_cube.STL": trimesh.creation.box,
    "unit_sphere.STL": trimesh.creation.icosphere,
}

#: Rigid motions.
transforms = np.array([tf.euler_matrix(0.8, turn, 0) for turn in np.linspace(0, 6, 50)])


class Absent:
    """Data that only the repository has."""

    def __getitem__(self, name):
        pytest.skip(f"{name} is in trimesh's repository alone")


data = Absent()


def random(shape):
    """Return the same random numbers from 0 to 1 at each call."""
    return np.random.default_rng(1).random(shape)


def random_transforms(count):
    """Yield rigid motions."""
    for turn, shift in zip(random((count, 3)), random((count, 3)) - 0.5, strict=True):
        made = tf.random_rotation_matrix(rand=turn)
        made[:3, 3] = 1000 * shift
        yield made


def get_mesh(name, **options):
    """Return a shape for a model, or skip the test."""
    if name not in MODELS:
        pytest.skip(f"the model {name} is in trimesh's repository alone")
    made = MODELS[name]()
    return Trimesh(made.vertices, made.faces, **options)


def get_meshes(count=5, **_options):
    """Yield closed shapes, at most so many."""
    makers = [
        trimesh.creation.box,
        trimesh.creation.icosphere,
        lambda: trimesh.creation.cylinder(1, 2),
        trimesh.creation.capsule,
        lambda: trimesh.creation.torus(2, 0.5),
    ]
    for make in makers[:count]:
        yield make()
