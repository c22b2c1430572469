"""Scenes that change: objects move, hide, go, and are replaced. Their identifiers stay.

A change takes microseconds, but for `update_vertices`, which copies and checks the vertices. The
next call that needs the trees makes all changes since the last one together: it converts only what
changed, and builds only the trees of new meshes. Its results are those of a scene that is built
anew. Calls that are running see the scene as it was.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, get_args

import numpy as np

from firsthit._base.arrays import one_of, table
from firsthit._base.errors import warn
from firsthit._base.log import DEBUG, timed
from firsthit._base.progress import following
from firsthit._base.turn import Turn
from firsthit._objects.foreign_kinds import WANTED, reader_of
from firsthit._objects.mesh import Mesh
from firsthit._objects.object import (
    NOTHING,
    affine,
    affines,
    chosen,
    identified,
    identified_each,
    is_several,
)
from firsthit._objects.object_list import ObjectList
from firsthit._objects.shapes import Shape
from firsthit._objects.traceable import Built, Traceable
from firsthit.typing import Build

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from firsthit import _firsthit
    from firsthit._base.progress import Report
    from firsthit._looks.environment import Environment
    from firsthit._looks.lights import Light
    from firsthit._objects.traceable import Surroundings
    from firsthit.typing import ForeignMesh, ObjectKey, Progress, Selection, Vector

    from .objects import Objects

#: After so many changes their list begins anew, and the next build starts from all objects; but not
#: before so many calls that move many.
_MOST_MOVES, _STEPS = 1 << 16, 16


class Last(NamedTuple):
    """The scene that was built last."""

    built: Built
    #: Changes since something was built from all objects, by identifiers; more may come.
    moves: list[int]
    #: How many of them are in ``built``.
    known: int


class Changes(Traceable):
    """The part of a `Scene` that changes its objects, and builds what rays are shot at."""

    def __init__(self, build: Build) -> None:
        self._build_as = one_of("build", build, get_args(Build))
        self._objects = ObjectList()
        #: The identifiers of changed objects. A change replaces the object, then adds it here.
        self._moves: list[int] = []
        #: The objects as they were last asked for, with the changes that there were before.
        self._listed: tuple[list[int], int, Objects] | None = None
        self._lights: list[Light] = []
        self._environment: Environment | None = None
        self._up: Vector = (0.0, 0.0, 1.0)
        #: Whether that is only the convention of the file's format.
        self._up_is_guessed = False
        self._last: Last | None = None
        #: Two threads must not change the same object at once: one change would be lost.
        self._turn, self._changing = Turn(), Turn()

    def move(
        self,
        identifier: ObjectKey | Sequence[ObjectKey] | npt.NDArray[np.integer[Any]],
        transform: npt.ArrayLike | None,
    ) -> None:
        """Move an object, or several: replace their transforms.

        Later calls give the results of a scene that is built anew. The move itself takes
        microseconds. The next call that needs the trees copies the list of objects, once for all
        moves since the last one, and refits the boxes above the moved objects: among a thousand
        objects some 100 microseconds, whatever the size of their meshes. Now and then, when
        refitted boxes overlap too much, it builds the tree over the objects anew. Meshes in one
        space share a tree: one that is moved for the first time gets its own, in the time of a
        build. Calls that are running see the scene as it was. `Scene.bounds`, and with it
        `Camera.framing`, then visits the vertices of turned meshes once.

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
        >>> scene = fh.Scene()
        >>> ball = scene.add(fh.Sphere(center=(0, 0, 0), radius=1), name="ball")
        >>> scene.hide("ball")
        >>> bool(scene.occluded((0, 0, 5), (0, 0, -1)))
        False
        >>> scene.show(ball)
        >>> bool(scene.occluded((0, 0, 5), (0, 0, -1)))
        True
        """
        self._change_each(objects, _is_hidden=True)

    def show(self, objects: Selection | None = None) -> None:
        """Show objects again that were hidden. To look at the scene, see `Scene.view`.

        Parameters
        ----------
        objects : int, str, or sequence of them, optional
            As for `hide`. If left out, all that are hidden.

        Raises
        ------
        IndexError, ValueError, TypeError
            As `hide`.

        Warns
        -----
        FirsthitWarning
            If no object is hidden.
        """
        if objects is None:
            each = enumerate(self._objects)
            objects = [k for k, made in each if made._is_hidden and not made._is_removed]
            if not objects:
                where = "scene.view() in a notebook, firsthit.view(scene) elsewhere"
                warn(f"show: no object is hidden; to look at the scene: {where}")
        self._change_each(objects, _is_hidden=False)

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
        >>> scene = fh.Scene()
        >>> for x in (0, 3):
        ...     ball = scene.add(fh.Sphere(center=(x, 0, 0), radius=1))
        >>> scene.remove(0)
        >>> scene.shoot([[0, 0, 5], [3, 0, 5]], [0, 0, -1]).object
        array([-1,  1], dtype=int32)
        """
        gone: dict[str, Any] = {"_shape": NOTHING, "_name": "", "_materials": ()}
        gone["_labels"] = (None, None)
        for identifier in chosen(self._objects, objects):
            self._objects.note_name(identifier)
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

    def _change_each(self, objects: Selection, **others: Any) -> None:
        """Change some objects alike."""
        for identifier in chosen(self._objects, objects):
            self._change(identifier, **others)

    def _change(self, identifier: int, **others: Any) -> None:
        """Replace an object by one that differs in some attributes."""
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
        most = max(_MOST_MOVES, _STEPS * len(identifiers) * (len(identifiers) > 1))
        if len(self._moves) + len(identifiers) > most:
            self._moves = []
        self._moves.extend(identifiers)

    def _take_built(self, native: _firsthit.Scene) -> None:
        """Take a scene built from the present objects and lights, so that none is built again."""
        built = Built(self._objects[:], self._lights[:], self._around(), native)
        self._last = Last(built, self._moves, len(self._moves))

    def _ready(self, progress: Progress | None = None) -> Built:
        """Return what rays are shot at: the objects and lights there are now, built."""
        current = self._current()
        if current is not None:
            return current
        with self._turn.taken():
            # Another thread may have built it while this one waited.
            current = self._current()
            if current is None:
                what = "built %d objects", len(self._objects)
                # A caller's function is told of what it asked for alone, whose total it knows.
                shown = None if callable(progress) else progress
                with following(shown) as report, timed(*what, level=DEBUG):
                    current = self._build(report)
            return current

    def _current(self) -> Built | None:
        """Return what was built last, unless something was added or moved since."""
        last = self._last
        if last is None or last.moves is not self._moves or last.known != len(last.moves):
            return None
        is_all = len(last.built.objects) == len(self._objects)
        return last.built if is_all and self._is_lit_as(last.built) else None

    def _is_lit_as(self, built: Built) -> bool:
        """Tell whether lights and surroundings are those of something that was built."""
        return len(built.lights) == len(self._lights) and built.around == self._around()

    def _around(self) -> Surroundings:
        """Return what is around; which way is up counts only for an environment."""
        if self._environment is None:
            return None, (0.0, 0.0, 1.0), False
        return self._environment, self._up, self._up_is_guessed

    def _build(self, report: Report | None) -> Built:
        """Build what there is now, and remember it.

        A signal's handler or another thread may add and move objects at any step. Changes that this
        build lacks must make it out of date for `_current`. A move that is in and counts as new
        does no harm: it is made again.
        """
        last = self._last
        if last is not None and last.moves is self._moves and self._is_lit_as(last.built):
            # Moves are counted before the objects are copied: a later one is then beyond the count.
            known = len(last.moves)
            # A copy, which shows all objects at one moment.
            objects = self._objects[:]
            new = range(len(last.built.objects), len(objects))
            changed = {k: objects[k] for k in last.moves[last.known :] if k < new.start}
            changed |= {k: objects[k] for k in new}
            built = last.built.changed(changed, report)
            self._last = Last(built, last.moves, known)
            return built
        # The list is replaced before the objects are copied: a later move is then in the new list.
        moves: list[int] = []
        self._moves = moves
        around = self._around()
        lights, objects = self._lights[:], self._objects[:]
        while len(lights) < len(self._lights):
            lights, objects = self._lights[:], self._objects[:]
        before = None if last is None else last.built.native
        built = Built(objects, lights, around, None, before, self._build_as, report)
        self._last = Last(built, moves, 0)
        return built
