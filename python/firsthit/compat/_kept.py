"""Scenes of meshes that may change."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit._objects.foreign_mesh import is_mesh
from firsthit._objects.mesh import Mesh
from firsthit._scene.scene import Scene

from ._foreign_meshes import is_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from firsthit.typing import MeshLike


class Kept:
    """A scene made of a mesh, as long as the mesh stays the same."""

    def __init__(self, mesh: MeshLike, make: Callable[[MeshLike], Scene]) -> None:
        if not is_mesh(mesh):
            what = type(mesh).__name__
            raise TypeError(
                f"mesh must have vertices and faces, got a {what}; scenes of trimesh have to_mesh()"
            )
        self._mesh, self._make = mesh, make
        self._made: tuple[object, Scene] | None = None

    def scene(self) -> Scene:
        """Return the scene of the mesh as it is now."""
        key, made = _fingerprint(self._mesh), self._made
        if made is None or made[0] != key:
            made = key, self._make(self._mesh)
            self._made = made
        return made[1]

    def __getstate__(self) -> dict[str, Any]:
        """Pickle without the trees.

        The mesh may hold what holds this, as ``mesh.ray`` does. Unpickling then makes this before
        the mesh has its vertices, so that nothing may be asked of it here.
        """
        return {**self.__dict__, "_made": None}


def _fingerprint(mesh: MeshLike) -> object:
    """Return something that is another if a mesh has changed."""
    # trimesh's hash is that of the contents, and kept until they change.
    if is_of("trimesh", mesh):
        return hash(mesh)
    digest = hashlib.blake2b()
    for array in (np.asarray(mesh.vertices), np.asarray(mesh.faces)):
        digest.update(f"{array.shape} {array.dtype.str} ".encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.digest()


def surface(mesh: MeshLike) -> Scene:
    """Return a scene of a mesh's faces, without its colours."""
    scene = Scene()
    faces = np.asarray(mesh.faces)
    if len(faces):
        scene.add(Mesh(np.asarray(mesh.vertices), faces))
    return scene


def vertices_alone(mesh: MeshLike) -> Scene:
    """Return a scene of a mesh's vertices: triangles whose corners are in one place."""
    scene = Scene()
    vertices = np.asarray(mesh.vertices)
    if len(vertices):
        scene.add(Mesh(vertices, np.arange(len(vertices)).repeat(3).reshape(-1, 3)))
    return scene
