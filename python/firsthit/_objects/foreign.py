"""Meshes and scenes of other packages, trimesh's above all, without importing any."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, TypeGuard

import numpy as np

from firsthit._base.arrays import text
from firsthit._base.errors import warn

from .foreign_kinds import WANTED, reader_of
from .foreign_mesh import material
from .mesh import Mesh
from .shapes import Shape

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy.typing as npt

    from firsthit._looks.material import Material
    from firsthit.typing import SceneLike


class Part(NamedTuple):
    """A shape with its name, look and place, of which an object is made."""

    name: str
    shape: Shape
    material: Material | None = None
    transform: npt.NDArray[np.float64] | None = None


def is_scene(thing: object) -> TypeGuard[SceneLike]:
    """Tell whether something is a scene like trimesh's."""
    return hasattr(thing, "geometry") and hasattr(getattr(thing, "graph", None), "nodes_geometry")


def parts(thing: object, name: str) -> list[Part]:
    """Return what a shape, a mesh or a scene consists of. A scene has names of its own."""
    if is_scene(thing):
        if name:
            raise ValueError(f"name must be left out with a scene, got {name!r}")
        return list(_objects(thing))
    if isinstance(thing, Shape):
        return [Part(name, thing)]
    if reader_of(thing) is not None:
        return [Part(name, *_mesh(thing))]
    raise TypeError(f"shape must be a shape, or {WANTED}, got {thing!r}")


def _objects(scene: SceneLike) -> Iterator[Part]:
    """Yield a scene's nodes that have meshes. Nodes that share a mesh still share it."""
    made: dict[str, tuple[Mesh, Material | None]] = {}
    for node in scene.graph.nodes_geometry:
        matrix, name = scene.graph.get(node)
        thing = scene.geometry[name]
        if reader_of(thing) is None:
            warn(f"node {node!r} is left out: a {type(thing).__name__} has no triangles")
            continue
        if name not in made:
            made[name] = _mesh(thing)
        shape, material = made[name]
        placed = np.asarray(matrix, np.float64)
        if not np.linalg.det(placed[:3, :3]):
            warn(f"node {node!r} is left out: its transform flattens space")
            continue
        yield Part(text("node", str(node)), shape, material, placed)


def _mesh(thing: Any) -> tuple[Mesh, Material | None]:
    """Return a mesh with its colours, and its look if it has one."""
    return Mesh(thing), material(thing)
