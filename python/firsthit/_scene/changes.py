"""Scenes that change: objects move, hide, go, and are replaced."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit._base.arrays import table
from firsthit._objects.foreign_kinds import WANTED, reader_of
from firsthit._objects.object import (
    NOTHING,
    Object,
    affine,
    affines,
    chosen,
    identified,
    identified_each,
    is_several,
)
from firsthit._objects.shapes import Mesh, Shape
from firsthit._objects.traceable import Traceable

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from firsthit._base.turn import Turn
    from firsthit._base.types import ForeignMesh, ObjectKey, Selection

#: After so many changes their list begins anew, and the next build starts from all objects; but not
#: before so many calls that move many.
_MOST_MOVES, _STEPS = 1 << 16, 16


class Changes(Traceable):
    """The part of `Scene` that changes objects. Their identifiers stay.

    A change takes microseconds, but for `update_vertices`, which copies and checks the vertices.
    The next call that needs the trees makes all changes since the last one together: it converts
    only what changed, and builds only the trees of new meshes. Its results are those of a scene
    that is built anew. Calls that are running see the scene as it was.
    """

    _objects: list[Object]
    #: The identifiers of the objects that changed. A change replaces the object, then adds it here.
    _moves: list[int]
    #: Two threads must not change the same object at once: one of the changes would be lost.
    _changing: Turn

    def move(
        self,
        identifier: ObjectKey | Sequence[ObjectKey] | npt.NDArray[np.integer[Any]],
        transform: npt.ArrayLike | None,
    ) -> None:
        """Move an object, or several: replace their transforms.

        Later calls give the results of a scene that is built anew. The move itself takes
        microseconds. The next call that needs the trees copies the list of objects, once for all
        moves since the last one, and refits the boxes above the moved objects: among a thousand
        objects some 100 microseconds, whatever the size of their meshes. If many have moved, and
        now and then, it builds the tree over the objects anew. Meshes in one space share a tree:
        one that is moved for the first time gets its own, in the time of a build. Calls that are
        running see the scene as it was. `Scene.bounds`, and with it `Camera.framing`, then visits
        the vertices of turned meshes once.

        Parameters
        ----------
        identifier : int or str, or (n,) array_like of them
            The object's identifier, of Python's or NumPy's; or its name, if no other object has it.
            Of several, one that is there twice has the last of its transforms.
        transform : (4, 4) or (3, 4) array_like, or None
            The affine map from object space to world space, for columns; it must be invertible.
            ``None`` is the identity. For several objects (n, 4, 4) or (n, 3, 4), or one for all.

        Raises
        ------
        IndexError
            For an identifier that no object has, or one that was removed.
        ValueError
            For a transform of a wrong shape, and for one that is not invertible; for a name that no
            object has, or several. Then nothing has moved.
        TypeError
            For an identifier that is no int and no name.

        Examples
        --------
        >>> import numpy as np
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> ball = scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        >>> up = np.eye(4)
        >>> up[2, 3] = 2
        >>> scene.move(ball, up)
        >>> float(scene.shoot((0, 0, 9), (0, 0, -1)).t)
        6.0
        >>> scene.move([ball], up[None])
        """
        if not is_several(identifier):
            one = identified(self._objects, identifier)
            self._change(one, _transform=np.eye(4) if transform is None else affine(transform))
            return
        several = identified_each(self._objects, identifier)
        matrices = affines(np.eye(4) if transform is None else transform, len(several))
        with self._changing.taken():
            for one, matrix in zip(several, matrices, strict=True):
                self._put(one, _transform=matrix)
            self._note(several)

    def hide(self, objects: Selection) -> None:
        """Hide objects from all rays, until `show`. They keep their identifiers.

        Parameters
        ----------
        objects : int, str, or sequence of them
            Their identifiers, or their names; a name means all objects that have it.

        Raises
        ------
        IndexError
            For an identifier that no object has, or one that was removed.
        ValueError
            For a name that no object has.
        TypeError
            For what is no identifier and no name.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> ball = scene.add(fh.Sphere(center=(0, 0, 0), radius=1), name="ball")
        >>> scene.hide("ball")
        >>> bool(scene.occluded((0, 0, 5), (0, 0, -1)))
        False
        >>> scene.show(ball)
        >>> bool(scene.occluded((0, 0, 5), (0, 0, -1)))
        True
        """
        for identifier in chosen(self._objects, objects):
            self._change(identifier, _is_hidden=True)

    def show(self, objects: Selection) -> None:
        """Show objects again that were hidden.

        Parameters
        ----------
        objects : int, str, or sequence of them
            As for `hide`.

        Raises
        ------
        IndexError, ValueError, TypeError
            As `hide`.
        """
        for identifier in chosen(self._objects, objects):
            self._change(identifier, _is_hidden=False)

    def remove(self, objects: Selection) -> None:
        """Remove objects for good; no other object gets their identifiers.

        Parameters
        ----------
        objects : int, str, or sequence of them
            As for `hide`. They stay in `Scene.objects`, where `Object.removed` tells them.

        Raises
        ------
        IndexError, ValueError, TypeError
            As `hide`.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> for x in (0, 3):
        ...     ball = scene.add(fh.Sphere(center=(x, 0, 0), radius=1))
        >>> scene.remove(0)
        >>> scene.shoot([[0, 0, 5], [3, 0, 5]], [0, 0, -1]).object
        array([-1,  1], dtype=int32)
        """
        for identifier in chosen(self._objects, objects):
            gone: dict[str, Any] = {"_shape": NOTHING, "_name": "", "_materials": ()}
            gone["_labels"] = (None, None)
            self._change(identifier, **gone, _is_removed=True, _is_hidden=True)

    def replace(self, identifier: ObjectKey, shape: Shape | ForeignMesh) -> None:
        """Give an object another shape; its name, transform, materials and mask stay.

        Parameters
        ----------
        identifier : int or str
            The object's identifier or name, as for `move`.
        shape : Shape, or another package's mesh
            As for `Scene.add`. Of another package's mesh the shape is taken, not the material.

        Raises
        ------
        IndexError, TypeError, ValueError
            As `move` for the identifier, and as `Scene.add` for the shape.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> part = scene.add(fh.Sphere(center=(0, 0, 0), radius=1), name="part")
        >>> scene.replace(part, fh.Box(low=(-2, -2, -2), high=(2, 2, 2)))
        >>> float(scene.shoot((0, 0, 5), (0, 0, -1)).t)
        3.0
        """
        identifier = identified(self._objects, identifier)
        if not isinstance(shape, Shape):
            if reader_of(shape) is None:
                raise TypeError(f"shape must be a shape, or {WANTED}, got {shape!r}")
            shape = Mesh(shape)
        # It stays where it is in the file's tree, but is no longer that mesh.
        node, _ = self._objects[identifier]._labels
        self._change(identifier, _shape=shape, _labels=(node, None))

    def update_vertices(self, identifier: ObjectKey, vertices: npt.ArrayLike) -> None:
        """Move the vertices of an object's mesh; its triangles and attributes stay.

        The mesh's tree is not built anew, but its boxes are fitted to the new vertices, which takes
        a fraction of the time. It is built anew where a ray would cost half as much again as when
        the tree was built, by the surface area heuristic, and where vertices that were in one place
        have parted too much. The results are the same. Vertex normals stay as they are too: give
        `replace` a mesh with others.

        Parameters
        ----------
        identifier : int or str
            The object's identifier or name, as for `move`.
        vertices : (n, 3) array_like
            As many vertices as the mesh has, in object space.

        Raises
        ------
        IndexError
            As `move`.
        TypeError
            For an object that is no mesh.
        ValueError
            For another number of vertices, and for vertices that are not finite.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
        >>> sail = scene.add(fh.Mesh(corners, [[0, 1, 2]]))
        >>> scene.update_vertices(sail, [[0, 0, 1], [1, 0, 2], [0, 1, 2]])
        >>> float(scene.shoot((0.25, 0.25, 5), (0, 0, -1)).t)
        3.5
        """
        identifier = identified(self._objects, identifier)
        shape = self._objects[identifier].shape
        if not isinstance(shape, Mesh):
            raise TypeError(f"object {identifier} must be a mesh, it is {shape!r}")
        points = table("vertices", vertices, 3, np.float64)
        self._change(identifier, _shape=Mesh._wrap(shape._mesh.moved(points)))

    def _change(self, identifier: int, **others: Any) -> None:
        # The object is replaced before the change is noted: a build that knows of the change then
        # has the object there. A signal's handler may change and build at any step, and waits for
        # nobody: where it was faster, begin again.
        with self._changing.taken():
            self._put(identifier, **others)
            self._note([identifier])

    def _put(self, identifier: int, **others: Any) -> None:
        while True:
            old = self._objects[identifier]
            new = old._but(**others)
            if self._objects[identifier] is old:
                self._objects[identifier] = new
                return

    def _note(self, identifiers: list[int]) -> None:
        # Where many move at once, a few steps together are still fewer than the list would hold.
        most = max(_MOST_MOVES, _STEPS * len(identifiers) * (len(identifiers) > 1))
        if len(self._moves) + len(identifiers) > most:
            self._moves = []
        self._moves.extend(identifiers)
