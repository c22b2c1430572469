"""Scenes that change: objects move, hide, go, and are replaced. Their identifiers stay.

A change takes microseconds, but for `update_vertices`, which copies and checks the vertices. The
next call that needs the trees makes all changes since the last one together: it converts only what
changed, and builds only the trees of new meshes. Its results are those of a scene that is built
anew. Calls that are running see the scene as it was.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit._base.arrays import table
from firsthit._objects.foreign_kinds import WANTED, reader_of
from firsthit._objects.object import (
    NOTHING,
    affine,
    affines,
    chosen,
    identified,
    identified_each,
    is_several,
)
from firsthit._objects.shapes import Mesh, Shape

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from firsthit._base.types import ForeignMesh, ObjectKey, Selection

    from .scene import Scene

#: After so many changes their list begins anew, and the next build starts from all objects; but not
#: before so many calls that move many.
_MOST_MOVES, _STEPS = 1 << 16, 16


def move(
    scene: Scene,
    identifier: ObjectKey | Sequence[ObjectKey] | npt.NDArray[np.integer[Any]],
    transform: npt.ArrayLike | None,
) -> None:
    """Replace the transform of an object, or of several."""
    if not is_several(identifier):
        one = identified(scene._objects, identifier)
        change(scene, one, _transform=np.eye(4) if transform is None else affine(transform))
        return
    several = identified_each(scene._objects, identifier)
    matrices = affines(np.eye(4) if transform is None else transform, len(several))
    with scene._changing.taken():
        for one, matrix in zip(several, matrices, strict=True):
            _put(scene, one, _transform=matrix)
        _note(scene, several)


def change_each(scene: Scene, objects: Selection, **others: Any) -> None:
    """Change some objects alike."""
    for identifier in chosen(scene._objects, objects):
        change(scene, identifier, **others)


def remove(scene: Scene, objects: Selection) -> None:
    """Leave nothing of some objects but their identifiers."""
    gone: dict[str, Any] = {"_shape": NOTHING, "_name": "", "_materials": ()}
    gone["_labels"] = (None, None)
    change_each(scene, objects, **gone, _is_removed=True, _is_hidden=True)


def replace(scene: Scene, identifier: ObjectKey, shape: Shape | ForeignMesh) -> None:
    """Give an object another shape."""
    identifier = identified(scene._objects, identifier)
    if not isinstance(shape, Shape):
        if reader_of(shape) is None:
            raise TypeError(f"shape must be a shape, or {WANTED}, got {shape!r}")
        shape = Mesh(shape)
    # It stays where it is in the file's tree, but is no longer that mesh.
    node, _ = scene._objects[identifier]._labels
    change(scene, identifier, _shape=shape, _labels=(node, None))


def update_vertices(scene: Scene, identifier: ObjectKey, vertices: npt.ArrayLike) -> None:
    """Move the vertices of an object's mesh."""
    identifier = identified(scene._objects, identifier)
    shape = scene._objects[identifier].shape
    if not isinstance(shape, Mesh):
        raise TypeError(f"object {identifier} must be a mesh, it is {shape!r}")
    points = table("vertices", vertices, 3, np.float64)
    change(scene, identifier, _shape=Mesh._wrap(shape._mesh.moved(points)))


def change(scene: Scene, identifier: int, **others: Any) -> None:
    """Replace an object by one that differs in some attributes."""
    # The object is replaced before the change is noted: a build that knows of the change then
    # has the object there. A signal's handler may change and build at any step, and waits for
    # nobody: where it was faster, begin again.
    with scene._changing.taken():
        _put(scene, identifier, **others)
        _note(scene, [identifier])


def _put(scene: Scene, identifier: int, **others: Any) -> None:
    while True:
        old = scene._objects[identifier]
        new = old._but(**others)
        if scene._objects[identifier] is old:
            scene._objects[identifier] = new
            return


def _note(scene: Scene, identifiers: list[int]) -> None:
    most = max(_MOST_MOVES, _STEPS * len(identifiers) * (len(identifiers) > 1))
    if len(scene._moves) + len(identifiers) > most:
        scene._moves = []
    scene._moves.extend(identifiers)
