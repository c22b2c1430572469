"""Scenes: objects and lights."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, overload

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import color_of, count, text, vector
from firsthit._base.log import DEBUG, timed
from firsthit._base.turn import Turn
from firsthit._looks.display import Display, as_display
from firsthit._looks.edges import Edges
from firsthit._looks.environment import Environment
from firsthit._looks.lights import TRANSPARENT, Light, Sky, background_native, is_transparent
from firsthit._looks.shading import Shading
from firsthit._objects import foreign
from firsthit._objects.filters import ALL, of_each_ray, one_mask
from firsthit._objects.foreign_kinds import WANTED, reader_of
from firsthit._objects.object import Object, affine, placed
from firsthit._objects.shapes import Shape
from firsthit._objects.traceable import Built, Traceable
from firsthit._queries import explain, lint, measures, nearest, section, shoot, sights
from firsthit._queries.leaving import rays_of
from firsthit._sensors.camera import Camera
from firsthit._sensors.named_camera import NamedCamera, find
from firsthit._view import notebook

from . import changes
from .objects import Objects

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable, Sequence

    import numpy.typing as npt

    from firsthit._base.types import (
        Build,
        FillRule,
        ForeignMesh,
        LightName,
        ObjectKey,
        Progress,
        Rule,
        SceneLike,
        Selection,
        Side,
        Vector,
    )
    from firsthit._looks.material import Material
    from firsthit._looks.shading import Shader
    from firsthit._objects.traceable import Surroundings
    from firsthit._queries.all_hits import AllHits
    from firsthit._queries.explain import Explanation
    from firsthit._queries.hits import Hits
    from firsthit._queries.leaving import LeavingRays
    from firsthit._queries.lint import LintReport
    from firsthit._queries.nearest import ClosestPoints
    from firsthit._queries.section import Section
    from firsthit._queries.sights import Pair
    from firsthit._sensors.sensor import Sensor
    from firsthit._view.notebook import NotebookView
    from firsthit.typing import ShaderName

#: How trees may be built.
_BUILDS: tuple[Build, ...] = ("auto", "fast", "best")


class _Last(NamedTuple):
    """The scene that was built last."""

    built: Built
    #: What changed since something was built from all objects, by identifiers; more may come.
    moves: list[int]
    #: How many of them are in ``built``.
    known: int


class Scene(Traceable):
    """Objects and lights. Any number of threads may use it at once.

    An object's identifier is its index in the order of insertion. Coordinates and lengths have any
    unit, the scene unit. Adding is cheap: the trees for rays are built by the first call that needs
    them, and later calls build only what has changed. Ctrl-C ends queries at once, but not a
    build: it is raised when that is done.

    Parameters
    ----------
    build : {"auto", "fast", "best"}
        How the trees over meshes are built: ``"fast"`` in a third of the time or less, ``"best"``
        so that each ray takes least. No answer depends on it. ``"auto"`` is ``"best"``, since
        nobody knows how many rays will be shot. `save` writes the best ones.

    Examples
    --------
    >>> import firsthit as fh
    >>> scene = fh.Scene()
    >>> scene.add(fh.Plane(point=(0, 0, 0), normal=(0, 0, 1)), name="ground")
    0
    >>> scene.add(fh.Sphere(center=(0, 0, 1), radius=1), name="ball")
    1
    >>> scene
    Scene(2 objects, 0 triangles)
    """

    def __init__(self, *, build: Build = "auto") -> None:
        if build not in _BUILDS:
            expected = ", ".join(repr(name) for name in _BUILDS)
            raise ValueError(f"build must be one of {expected}, got {build!r}")
        self._build_as: Build = build
        self._objects: list[Object] = []
        #: Those that changed, by identifiers. A change replaces the object, then adds it here.
        self._moves: list[int] = []
        self._lights: list[Light] = []
        self._environment: Environment | None = None
        self._cameras: tuple[NamedCamera, ...] = ()
        self._background: Sky | Vector | str | None = None
        self._shading = Shading()
        self._display = Display()
        self._edges: Edges | None = None
        self._up: Vector = (0.0, 0.0, 1.0)
        #: Whether that is only the convention of the file's format.
        self._up_is_guessed = False
        #: Whether the first camera is the one to look through, as in scene files.
        self._has_view = False
        self._last: _Last | None = None
        #: Two threads must not change the same object at once: one change would be lost.
        self._turn, self._changing = Turn(), Turn()

    @overload
    def add(
        self,
        shape: Shape | ForeignMesh,
        *,
        name: str = "",
        transform: npt.ArrayLike | None = None,
        color: npt.ArrayLike | None = None,
        material: Material | Sequence[Material] | None = None,
        mask: int = ALL,
    ) -> int: ...

    @overload
    def add(
        self,
        shape: SceneLike,
        *,
        transform: npt.ArrayLike | None = None,
        color: npt.ArrayLike | None = None,
        material: Material | Sequence[Material] | None = None,
        mask: int = ALL,
    ) -> tuple[int, ...]: ...

    def add(
        self,
        shape: Shape | ForeignMesh | SceneLike,
        *,
        name: str = "",
        transform: npt.ArrayLike | None = None,
        color: npt.ArrayLike | None = None,
        material: Material | Sequence[Material] | None = None,
        mask: int = ALL,
    ) -> int | tuple[int, ...]:
        """Add an object, or all objects of another package's scene.

        Parameters
        ----------
        shape : Shape, or another package's mesh or scene
            A `Mesh`, `Sphere`, ...; objects may share it, and nothing is copied. Or what `Mesh.of`
            takes: a mesh of trimesh, PyVista, Open3D or meshio, or a pair of vertices and faces. Or
            a ``trimesh.Scene``: each of its nodes with a mesh becomes an object with the node's
            name and transform, and nodes that share a mesh go on sharing it. The colours of
            vertices and faces are taken, as sRGB, and so are the colour and the image of trimesh's
            materials, and attributes of vertices and faces, see `Hits.attribute`. What is no mesh
            is left out, with a warning.
            Scenes of other packages do not say which way is up: set `up` if it is not +z, as for a
            glTF file that trimesh has read, where it is +y.
        name : str
            A name, which need not be unique; not for a scene, whose objects have their own.
        transform : (4, 4) or (3, 4) array_like, optional
            The affine map from object space to world space, for columns; it must be invertible. For
            a scene, from its world space to that of this one. The identity if left out.
        color : (3,) array_like or str, optional
            The colour: linear numbers, or sRGB as ``"#rrggbb"`` or a CSS name. If left out, light
            grey, or white for a mesh with colours of its own.
        material : Material or sequence of Material, optional
            A material in place of ``color``, or one for each of a mesh's ``slots``.
        mask : int
            32 bits: a ray meets the object if their masks have a bit in common, see `shoot`.

        Returns
        -------
        int or tuple of int
            The object's identifier; for a scene those of its objects, in the order of its nodes.

        Raises
        ------
        ValueError
            For a transform that is not invertible, values of a wrong shape or type, a color beside
            a material, and a name with lone surrogates, which no file can hold.
        TypeError
            For something that is not a shape, a material or a name.

        Warns
        -----
        FirsthitWarning
            For what is left out of another package's scene.
        """
        name = text("name", name)
        matrix = None if transform is None else affine(transform)
        if foreign.is_scene(shape):
            if name:
                raise ValueError(f"name must be left out with a scene, got {name!r}")
            parts = list(foreign.objects(shape))
        elif isinstance(shape, Shape):
            parts = [foreign.Part(name, shape)]
        elif reader_of(shape) is not None:
            parts = [foreign.Part(name, *foreign.mesh(shape))]
        else:
            raise TypeError(f"shape must be a shape, or {WANTED}, got {shape!r}")
        bits = one_mask("mask", mask)
        made = [placed(part, matrix, color, material, bits) for part in parts]
        # One bytecode, in which nothing can intervene. A lock would deadlock in a signal's handler.
        self._objects.extend(made)
        if foreign.is_scene(shape):
            first = self._identifier(made[0]) if made else 0
            return tuple(range(first, first + len(made)))
        return self._identifier(made[0])

    def _identifier(self, made: Object) -> int:
        """Return the identifier of an object that was just added; it may have moved since."""
        places = reversed(range(len(self._objects)))
        return next(k for k in places if self._objects[k]._mark is made._mark)

    def add_light(self, light: Light) -> None:
        """Add a light. Pictures of a scene without lights have automatic light, see `render`.

        Parameters
        ----------
        light : DirectionalLight, PointLight, SpotLight, SphereLight, DiscLight or RectangleLight
            The light, in world space.

        Raises
        ------
        TypeError
            For anything else.
        """
        if not isinstance(light, Light):
            raise TypeError(f"light must be a light, got {light!r}")
        self._lights.append(light)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Save the scene, built, to a ``.fhs`` file, which `open` maps into memory as it is.

        The file holds objects, meshes with their trees, materials, textures, lights, cameras, names
        and what pictures are made with by default. It appears whole or not at all. A file of that
        name is replaced; those who have it open keep theirs.

        Parameters
        ----------
        path : path-like
            The file; its name must end with ``.fhs``.

        Raises
        ------
        FileWriteError
            If the system refuses to write it; also an `OSError`.
        ValueError
            For another name, and for a `shading` with more than 65,536 samples.
        MemoryError
            If memory is short.

        Examples
        --------
        See `open`.
        """
        # Under another name it would be read as something else.
        if Path(path).suffix.lower() != ".fhs":
            raise ValueError(f"path must end in .fhs, got {path}")
        built, shading, background = self._ready(), self._shading, self._background
        with timed("wrote %s", path):
            _firsthit.save(
                Path(path),
                built.native,
                [(made.name, made.camera._native, made.has_size) for made in self._cameras],
                None if background is None else background_native(background),
                shading._native(),
                self._display._native,
                None if self._edges is None else self._edges._native(),
                self._has_view,
                self._up,
                self._up_is_guessed,
            )

    def _take_built(self, native: _firsthit.Scene) -> None:
        """Take a scene built from the present objects and lights, so that none is built again."""
        built = Built(self._objects[:], self._lights[:], self._around(), native)
        self._last = _Last(built, self._moves, len(self._moves))

    @property
    def objects(self) -> tuple[Object, ...]:
        """The objects, in the order of their identifiers."""
        return Objects(self._objects)

    @property
    def lights(self) -> tuple[Light, ...]:
        """The lights, in the order in which they were added."""
        return tuple(self._lights)

    @property
    def environment(self) -> Environment | None:
        """The light from all around, or None; a ``TypeError`` for what is no `Environment`."""
        return self._environment

    @environment.setter
    def environment(self, environment: Environment | None) -> None:
        if not (environment is None or isinstance(environment, Environment)):
            raise TypeError(f"environment must be an Environment or None, got {environment!r}")
        self._environment = environment

    @property
    def cameras(self) -> tuple[NamedCamera, ...]:
        """The cameras of the file that the scene was read from, in its order."""
        return self._cameras

    def camera(
        self, name: str | int = 0, *, rows: int | None = None, columns: int | None = None
    ) -> Camera:
        """Return a camera of the file that the scene was read from.

        Parameters
        ----------
        name : str or int
            Its name, or its index in `cameras`.
        rows, columns : int, optional
            Pixels down and across; both must be given if the file has no size.

        Returns
        -------
        Camera
            As `NamedCamera.at` makes it.

        Raises
        ------
        KeyError
            For a name or an index that no camera has.
        ValueError
            For a size that is incomplete or missing.
        """
        return find(self._cameras, name).at(rows=rows, columns=columns)

    @property
    def up(self) -> Vector:
        """The direction upwards in world space, for `Camera.framing` and `render`; of any length.

        A scene file says it, and for glTF it is +y. OBJ, STL and PLY files do not say it: it is +y
        for OBJ and +z for STL and PLY, unless the meshes clearly stand on a flat base along the
        other of the two axes. For other scenes it is +z. Setting zero, or numbers that are not
        finite, is a ``ValueError``.
        """
        return vector("up", self._native().likely_up(self._up)) if self._up_is_guessed else self._up

    @up.setter
    def up(self, up: npt.ArrayLike) -> None:
        direction = vector("up", up)
        if not (any(direction) and all(map(math.isfinite, direction))):
            raise ValueError(f"up must be a finite direction, not zero, got {direction}")
        self._up, self._up_is_guessed = direction, False

    @property
    def background(self) -> Sky | Vector | str | None:
        """The default background of `render`: a sky, a linear colour, "transparent", or None.

        It is set to a `Sky`, to any colour that `render` takes, or to ``None``; anything else is a
        ``ValueError``.
        """
        return self._background

    @background.setter
    def background(self, background: Sky | npt.ArrayLike | None) -> None:
        if background is None or isinstance(background, Sky):
            self._background = background
        elif is_transparent(background):
            self._background = "transparent"
        else:
            self._background = color_of("background", background, others=(TRANSPARENT,))

    @property
    def shading(self) -> Shading:
        """The default shading of `render`; a ``TypeError`` for what is no `Shading`."""
        return self._shading

    @shading.setter
    def shading(self, shading: Shading) -> None:
        if not isinstance(shading, Shading):
            raise TypeError(f"shading must be a Shading, got {shading!r}")
        self._shading = shading

    @property
    def display(self) -> Display:
        """The default display of PNGs of the scene's pictures, see `Frame.display`.

        A ``TypeError`` for what is no `Display`.
        """
        return self._display

    @display.setter
    def display(self, display: Display) -> None:
        self._display = as_display(display)

    @property
    def edges(self) -> Edges | None:
        """The default lines along edges of `render`; a ``TypeError`` for what is no `Edges`."""
        return self._edges

    @edges.setter
    def edges(self, edges: Edges | None) -> None:
        if not isinstance(edges, Edges | None):
            raise TypeError(f"edges must be an Edges or None, got {edges!r}")
        self._edges = edges

    @property
    def bounds(self) -> npt.NDArray[np.float64]:
        """The box around all finite objects in world space: its low and its high corner.

        (2, 3) float64, in scene units; NaN without finite objects. Hidden ones do not count.
        """
        bounds = self._native().bounds()
        return np.full((2, 3), np.nan) if bounds is None else np.array(bounds)

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
        changes.move(self, identifier, transform)

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
        changes.change_each(self, objects, _is_hidden=True)

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
        changes.change_each(self, objects, _is_hidden=False)

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
        changes.remove(self, objects)

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
        changes.replace(self, identifier, shape)

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
        changes.update_vertices(self, identifier, vertices)

    def shoot(
        self,
        origins: npt.ArrayLike | Sensor | LeavingRays,
        directions: npt.ArrayLike | None = None,
        *,
        t_min: npt.ArrayLike = 0.0,
        t_max: npt.ArrayLike = math.inf,
        mask: npt.ArrayLike | None = None,
        cull: Side | None = None,
        skip: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
        objects: Selection | None = None,
        blend_below: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
        dtype: npt.DTypeLike | None = None,
    ) -> Hits:
        """Find the first hit of each ray.

        Parameters
        ----------
        origins, directions : (..., 3) array_like
            The rays, in world space, of any real type; they broadcast against each other.
            Directions have any length but zero, and ``t`` is in units of that length. Instead of
            both, a `Camera` or another sensor alone stands for the rays of its pixels, and
            `LeavingRays` (`Hits.leave`) for rays that start on surfaces. The hits keep copies, so
            that arrays may be changed afterwards.
        t_min, t_max : (...) array_like
            Limits of the rays: hits have ``t_min < t <= t_max``. With a ``t_min`` of zero, a ray
            does not meet a surface on which its origin lies exactly; a rounded origin is to one
            side of the surface (see `Hits.leave`). With a negative ``t_min`` it does, and it meets
            what is behind the origin, down to ``t_min``. A camera's rays with limits, a ``cull`` or
            a ``skip`` are shot one by one, which takes longer than in tiles.
        mask : (...) array_like of int, optional
            A ray meets the objects whose mask (`add`) has a bit in common with its own, of 32 bits;
            every object if left out. One mask for all rays costs nothing.
        cull : {"front", "back"}, optional
            The side of surfaces that rays pass through: the front is where the normal points.
        skip : pair of (...) array_like of int, optional
            The object and primitive that each ray passes through, -1 where there is none: a
            triangle wholly; of any other shape only the crossing nearest to the ray's origin. To go
            on from a hit, `Hits.leave` is the exact way.
        objects : int, str, or sequence of them, optional
            The identifiers or names of the only objects that the rays meet; all if left out.
        blend_below : float, optional
            Take the materials of meshes with the alpha mode ``blend`` as alpha masks with this
            cutoff, from 0 to 1: where their alpha is below it, rays pass. If left out, rays meet
            translucent surfaces as if they were opaque.
        threads : int, optional
            The number of threads, here and for the attributes of the hits; all cores if left out.
            The result is the same for any number.
        progress : bool or callable, optional
            ``True`` shows a bar, by tqdm if that is installed. A function is called with the number
            of rays that are done and the number of all rays, in the calling thread, about twenty
            times a second and at the end. An exception that it raises ends the work.
        dtype : {float64, float32}, optional
            The type of ``t``, ``range`` and ``z``; float64 if left out, whatever the rays' type.
            Everything is computed in float64 in any case. The float32 is the nearest one, with two
            exceptions. The distance of a hit stays finite, and zero only if it is zero. And if
            rounding takes ``t`` out of its limits, it is the next float32 within them; if there is
            none, the one below ``t_max``. Rays that go on from a hit need its float64 ``t``: a
            float32 may lie before the surface.

        Returns
        -------
        Hits
            Of the rays' shape. A ray with a zero direction, a NaN or an infinite component, or
            ``t_min >= t_max`` is a miss; other rays are not affected.

        Raises
        ------
        ValueError
            For arrays whose shapes or types do not fit, with their names, for another dtype, and
            for a name in ``objects`` that no object has.
        IndexError
            For an identifier in ``objects`` that no object has, or one that was removed.
        TypeError
            For ``objects`` that are no identifiers and no names, and for a progress that is no bool
            and no function.
        MemoryError
            If the hits do not fit into memory.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> hits = scene.shoot([[0, 0, 3], [0.6, 0, 3]], [0, 0, -1])
        >>> hits.t
        array([2. , 2.2])
        >>> hits.normal[0]
        array([0., 0., 1.])
        """
        given = origins, directions, t_min, t_max, of_each_ray(mask), cull, skip
        built = self._ready().seen(mask, objects, blend_below)
        return shoot.first_hits(built, given, threads, progress, dtype)

    def occluded(
        self,
        origins: npt.ArrayLike | Sensor | LeavingRays,
        directions: npt.ArrayLike | None = None,
        *,
        t_min: npt.ArrayLike = 0.0,
        t_max: npt.ArrayLike = math.inf,
        mask: npt.ArrayLike | None = None,
        cull: Side | None = None,
        skip: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
        objects: Selection | None = None,
        blend_below: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> npt.NDArray[np.bool_]:
        """Tell whether each ray meets anything: faster than `shoot`, for shadows and visibility.

        Parameters
        ----------
        origins, directions, t_min, t_max, mask, cull, skip, objects
            As for `shoot`.
        blend_below, threads, progress
            As for `shoot`. The rays of a camera have the shape (rows, columns).

        Returns
        -------
        (...) array of bool
            Whether there is a hit with ``t_min < t <= t_max``.

        Raises
        ------
        ValueError, IndexError, TypeError
            As `shoot`.
        MemoryError
            If the answers do not fit into memory.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> eye, target = (0, 0, 5), (0, 0, 2)
        >>> bool(scene.occluded(eye, [0, 0, -3], t_max=1.0))  # is the target seen?
        False
        """
        rays = rays_of(origins, directions, t_min, t_max, of_each_ray(mask), cull, skip)
        built = self._ready().seen(mask, objects, blend_below)
        return shoot.answers(_firsthit.occluded, np.bool_, built, rays, threads, progress)

    def count(
        self,
        origins: npt.ArrayLike | Sensor | LeavingRays,
        directions: npt.ArrayLike | None = None,
        *,
        t_min: npt.ArrayLike = 0.0,
        t_max: npt.ArrayLike = math.inf,
        mask: npt.ArrayLike | None = None,
        cull: Side | None = None,
        skip: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
        objects: Selection | None = None,
        blend_below: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> npt.NDArray[np.int64]:
        """Count how often each ray crosses a surface.

        Each crossing counts once: at an edge or a corner, the triangles that a ray infinitely
        little beside it would cross. So a ray enters a closed mesh as often as it leaves, and one
        that only grazes it counts none or two. A solid that is not a mesh is crossed at both ends.
        Surfaces in the same place count each.

        Parameters
        ----------
        origins, directions, t_min, t_max, mask, cull, skip, objects
            As for `shoot`.
        blend_below, threads, progress
            As for `shoot`. The rays of a camera have the shape (rows, columns).

        Returns
        -------
        (...) array of int64
            The number of crossings with ``t_min < t <= t_max``.

        Raises
        ------
        ValueError, IndexError, TypeError
            As `shoot`.
        MemoryError
            If the answers do not fit into memory.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> scene.count([[0, 0, 5], [0, 0, 0], [0, 2, 5]], [0, 0, -1])
        array([2, 1, 0])
        """
        rays = rays_of(origins, directions, t_min, t_max, of_each_ray(mask), cull, skip)
        built = self._ready().seen(mask, objects, blend_below)
        counts = shoot.answers(_firsthit.count, np.uint32, built, rays, threads, progress)
        # Of unsigned numbers, one less than none is four billion.
        return counts.astype(np.int64)

    @overload
    def shoot_all(
        self,
        origins: npt.ArrayLike | Sensor | LeavingRays,
        directions: npt.ArrayLike | None = None,
        k: None = None,
        *,
        t_min: npt.ArrayLike = 0.0,
        t_max: npt.ArrayLike = math.inf,
        mask: npt.ArrayLike | None = None,
        cull: Side | None = None,
        skip: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
        objects: Selection | None = None,
        blend_below: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> AllHits: ...

    @overload
    def shoot_all(
        self,
        origins: npt.ArrayLike | Sensor | LeavingRays,
        directions: npt.ArrayLike | None,
        k: int,
        *,
        t_min: npt.ArrayLike = 0.0,
        t_max: npt.ArrayLike = math.inf,
        mask: npt.ArrayLike | None = None,
        cull: Side | None = None,
        skip: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
        objects: Selection | None = None,
        blend_below: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Hits: ...

    @overload
    def shoot_all(
        self,
        origins: npt.ArrayLike | Sensor | LeavingRays,
        directions: npt.ArrayLike | None = None,
        *,
        k: int,
        t_min: npt.ArrayLike = 0.0,
        t_max: npt.ArrayLike = math.inf,
        mask: npt.ArrayLike | None = None,
        cull: Side | None = None,
        skip: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
        objects: Selection | None = None,
        blend_below: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Hits: ...

    def shoot_all(
        self,
        origins: npt.ArrayLike | Sensor | LeavingRays,
        directions: npt.ArrayLike | None = None,
        k: int | None = None,
        *,
        t_min: npt.ArrayLike = 0.0,
        t_max: npt.ArrayLike = math.inf,
        mask: npt.ArrayLike | None = None,
        cull: Side | None = None,
        skip: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
        objects: Selection | None = None,
        blend_below: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> AllHits | Hits:
        """Find every hit of each ray, or the first ``k``, in order.

        Each crossing of a surface is there once, as `count` counts them: a ray enters and leaves
        every closed mesh in turn. At an edge `shoot` may see a surface that the ray only touches
        and that is not among these.

        Parameters
        ----------
        origins, directions, t_min, t_max, mask, cull, skip, objects
            As for `shoot`.
        blend_below, threads, progress
            As for `shoot`. The rays of a camera have the shape (rows, columns); their hits have
            neither ``range`` nor ``z``.
        k : int, optional
            How many hits of each ray are wanted at most; all if left out.

        Returns
        -------
        AllHits or Hits
            Without ``k`` an `AllHits` of the rays' shape. With ``k`` a `Hits` of shape (..., k):
            ``t[..., j]`` is that of the hit ``j`` of each ray; after the last hit come misses.
            Hits are in the order of ``t``, the float64 nearest to the exact one where others are
            close; of equal ones in that of the object. Within a mesh those are in the order of
            their exact ``t``, then in that in which a ray infinitely little beside enters and
            leaves, then in that of the primitive.

        Raises
        ------
        ValueError
            For arrays whose shapes or types do not fit, with their names, and for a ``k`` that is
            not positive.
        ValueError, IndexError, TypeError
            As `shoot`.
        MemoryError
            If the hits do not fit into memory.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=3))
        1
        >>> met = scene.shoot_all([[0, 0, 5], [0, 2, 0]], [0, 0, -1])
        >>> met.counts, met.object
        (array([4, 1]), array([1, 0, 0, 1, 1], dtype=int32))
        >>> met[0].t, met[0].front
        (array([2., 4., 6., 8.]), array([ True,  True, False, False]))
        >>> scene.shoot_all([[0, 0, 5], [0, 2.9, 0]], [0, 0, -1], k=2).object
        array([[ 1,  0],
               [ 1, -1]], dtype=int32)
        """
        wanted = None if k is None else count("k", k, 1)
        rays = rays_of(origins, directions, t_min, t_max, of_each_ray(mask), cull, skip)
        built = self._ready().seen(mask, objects, blend_below)
        return shoot.all_hits(built, rays, wanted, threads, progress)

    def visible(
        self,
        a: npt.ArrayLike | Hits,
        b: npt.ArrayLike | Hits,
        *,
        skip_a: Pair | None = None,
        skip_b: Pair | None = None,
        tolerance: float = 0.0,
        objects: Selection | None = None,
        blend_below: float | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> npt.NDArray[np.bool_]:
        """Tell whether points see each other: whether nothing is on the line between them.

        The answer does not depend on which of the two comes first, to the bit. What is at an end
        hides nothing, for points of a surface are rounded to one side of it or the other: what is
        nearer to an end than 2^-40 of the ends' largest coordinate, some 1e-12 of it, and the
        surfaces of ends that are `Hits`. So two points of a solid's surface see each other through
        the solid, and the far side of a surface sees a lamp; whether an end faces the other is
        another question: ``((lamp - hits.position) * hits.normal).sum(-1) > 0``.

        Parameters
        ----------
        a, b : (..., 3) array_like, or Hits
            The points, in world space; they broadcast against each other. All pairs of two lists
            are ``visible(a[:, None], b)``, worked off in blocks. Of `Hits` they are the positions,
            and the surfaces there do not hide them; a miss sees nothing.
        skip_a, skip_b : pair of (...) array_like of int, optional
            The object and primitive on which each point of an array lies, -1 where there is none.
            It hides nothing, also where the line is nearly along it.
        tolerance : float
            What is nearer to either end than this hides nothing, in scene units: the error of
            points that are rounded, as to float32.
        objects : int, str, or sequence of them, optional
            What may be in the way, by identifiers or names: no other object hides anything.
        blend_below : float, optional
            As for `shoot`.
        threads, progress
            As for `shoot`; pairs are counted.

        Returns
        -------
        (...) array of bool
            Whether they see each other. A point sees itself. One that is not finite sees nothing.

        Raises
        ------
        ValueError
            For arrays whose shapes or types do not fit, with their names, and for a tolerance that
            is negative or not finite.
        ValueError, IndexError, TypeError
            For ``objects``, as `shoot`.
        MemoryError
            If the answers do not fit into memory.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> scene.visible([[0, 0, 5], [0, 2, 0]], [0, 0, -5])
        array([False,  True])
        >>> hits = scene.shoot((0, 0, 5), (0, 0, -1))
        >>> bool(scene.visible(hits, (0, 3, 5)))
        True
        """
        built = self._ready().seen(None, objects, blend_below)
        return sights.visible(built, (a, skip_a), (b, skip_b), tolerance, threads, progress)

    def thickness(
        self,
        points: npt.ArrayLike | Hits,
        directions: npt.ArrayLike | None = None,
        *,
        rule: FillRule = "nonzero",
        objects: Selection | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> npt.NDArray[np.float64]:
        """Measure how thick objects are at points of their surfaces.

        It is the distance along a ray from the surface to where the ray comes out of the same
        object, or if it starts outside, into it. What is inside is as for `inside`; of an open mesh
        it is where the ray next meets it. The ray leaves the surface exactly, as `Hits.leave` has
        it. Other objects do not count.

        Parameters
        ----------
        points : (..., 3) array_like, or Hits
            Points in world space, each in place of the surface point nearest to it; or hits of this
            scene, before it changes.
        directions : (..., 3) array_like, optional
            The directions to measure along, of any length; they broadcast against the points. If
            left out, inwards: against the geometric normal, or along it in a mesh that is turned
            inside out.
        rule : {"nonzero", "parity"}
            What is inside of closed meshes, see `inside`.
        objects : int, str, or sequence of them, optional
            The only objects that are there, by identifiers or names; all by default. Points are
            brought to their surfaces, and hits on other objects have the thickness ``inf``.
        threads, progress
            As for `shoot`.

        Returns
        -------
        (...) array of float64
            Lengths in scene units. ``inf`` where the ray does not meet the object again; without
            ``directions`` 0 where neither side of a closed mesh is inside. NaN for a miss, for a
            direction that is zero or not finite, inwards from a triangle without an area, and for a
            point that is not finite or has no surface to be near to.

        Raises
        ------
        ValueError
            For arrays whose shapes or types do not fit, and another ``rule``.
        ValueError, IndexError, TypeError
            For ``objects``, as `shoot`.
        MemoryError
            If the lengths do not fit into memory.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Box(low=(0, 0, 0), high=(4, 4, 0.5)))
        0
        >>> scene.thickness([[1, 1, 0.5], [0, 2, 0.25]])
        array([0.5, 4. ])
        """
        built = self._ready().seen(None, objects)
        return sights.thickness(built, points, directions, rule, threads, progress)

    @overload
    def inside(
        self,
        points: npt.ArrayLike,
        by: Literal["object"] | None = None,
        *,
        rule: FillRule = "nonzero",
        return_rules: Literal[False] = False,
        objects: Selection | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> npt.NDArray[np.bool_]: ...

    @overload
    def inside(
        self,
        points: npt.ArrayLike,
        by: Literal["object"] | None = None,
        *,
        rule: FillRule = "nonzero",
        return_rules: Literal[True],
        objects: Selection | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> tuple[npt.NDArray[np.bool_], tuple[Rule, ...]]: ...

    def inside(
        self,
        points: npt.ArrayLike,
        by: Literal["object"] | None = None,
        *,
        rule: FillRule = "nonzero",
        return_rules: bool = False,
        objects: Selection | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> npt.NDArray[np.bool_] | tuple[npt.NDArray[np.bool_], tuple[Rule, ...]]:
        """Tell which points are inside the scene's objects.

        A closed mesh (`Mesh.is_closed`) holds the points that it goes around, once or more often,
        either way around; which for a mesh without a transform is decided exactly. So it holds what
        its shells have in common, and a shell within another is a hollow if it faces inwards. With
        ``rule="parity"`` it holds the points that it goes around an odd number of times. A flipped
        triangle counts as its neighbours do. An open mesh, or one with parts that its material cuts
        out, holds the points in its box around which its winding number is above one half or below
        minus one half. A plane and a disc hold nothing.

        A point exactly on the surface is inside if what is just ahead of it along (7, 10, 10.5) is:
        of closed objects without a gap between them, exactly one holds each point that they share.

        Parameters
        ----------
        points : (..., 3) array_like
            The points, in world space, of any real type.
        by : {None, "object"}
            ``None`` asks about all objects together, ``"object"`` about each. `path_length` has
            the other default.
        rule : {"nonzero", "parity"}
            Which points closed meshes hold; the same for `path_length`, `thickness`, `section` and
            `signed_distance`.
        return_rules : bool
            Whether to tell, too, how it is known for each object.
        objects : int, str, or sequence of them, optional
            Ask about these only, by identifiers or names; the others are not there.
        threads, progress
            As for `shoot`; points are counted.

        Returns
        -------
        inside : (...) array of bool
            Whether each point is inside any object; with ``by="object"`` (..., n), whether it is
            inside each of the n objects of the scene, in the order of their identifiers: False for
            those that are hidden or not among ``objects``. False for a point that is not finite.
        rules : tuple of str
            Only with ``return_rules``, for each object: ``"nonzero"``, ``"parity"``, ``"winding"``
            or ``"none"``. A closed mesh whose triangles cannot all face alike goes by parity.

        Raises
        ------
        ValueError
            For points of a wrong shape or type, and another ``by`` or ``rule``.
        ValueError, IndexError, TypeError
            For ``objects``, as `shoot`.
        MemoryError
            If the answers do not fit into memory.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> scene.add(fh.Box(low=(0, 0, 0), high=(3, 3, 3)))
        1
        >>> points = [[0, 0, 0.5], [2, 2, 2], [0, 0, 9]]
        >>> scene.inside(points)
        array([ True,  True, False])
        >>> scene.inside(points, by="object")
        array([[ True,  True],
               [False,  True],
               [False, False]])
        """
        built = self._ready().seen(None, objects)
        return measures.inside(built, points, by, rule, return_rules, threads, progress)

    def path_length(
        self,
        origins: npt.ArrayLike | Sensor,
        directions: npt.ArrayLike | None = None,
        by: Literal["object"] | None = "object",
        *,
        t_min: npt.ArrayLike = 0.0,
        t_max: npt.ArrayLike = math.inf,
        rule: FillRule = "nonzero",
        objects: Selection | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> npt.NDArray[np.float64]:
        """Measure how much of each ray is inside the scene's objects.

        Each crossing of a closed object is there once, at edges and corners too. What is inside is
        as for `inside`.

        Parameters
        ----------
        origins, directions, t_min, t_max, threads, progress
            As for `shoot`, but for `LeavingRays`: a length does not depend on which surface the ray
            leaves. What lies outside the limits does not count.
        by : {"object", None}
            ``"object"`` measures each object by itself; ``None`` measures all together, where a
            stretch in several objects counts once.
        rule, objects
            As for `inside`.

        Returns
        -------
        (..., n) or (...) array of float64
            Lengths in scene units, whatever the direction's length: for each of the n objects of
            the scene (0 for those that are hidden or not among ``objects``), or with ``by=None``
            for all together. NaN where an open mesh is crossed in a way that does
            not say where the ray is inside; 0 in planes and discs, and for rays that cannot meet
            anything.

        Raises
        ------
        ValueError
            For arrays whose shapes or types do not fit, with their names, for `LeavingRays`, and
            another ``by`` or ``rule``.
        ValueError, IndexError, TypeError
            For ``objects``, as `shoot`.
        MemoryError
            If the lengths do not fit into memory.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=3))
        1
        >>> scene.path_length([[0, 0, 5], [0, 0, 0]], [0, 0, -2])
        array([[2., 6.],
               [1., 3.]])
        >>> scene.path_length([[0, 0, 5], [0, 0, 0]], [0, 0, -2], by=None)
        array([6., 3.])
        """
        given, built = (origins, directions, t_min, t_max), self._ready().seen(None, objects)
        return measures.path_length(built, given, by, rule, threads, progress)

    def closest_point(
        self,
        points: npt.ArrayLike,
        *,
        k: int | None = None,
        radius: float = math.inf,
        objects: Selection | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> ClosestPoints:
        """Find the points of the scene that are nearest to points.

        Distances are those of world space, also to objects whose transforms stretch. At the same
        distance the lower (object, primitive) is nearer: the squares of the distances are compared,
        as float64. The distance to a mesh is off by a few units in the last place; that to other
        shapes by a few 2^-53 of the shape's size. What a material cuts out is measured like any
        other surface.

        Parameters
        ----------
        points : (..., 3) array_like
            Points in world space. Those that are not finite or beyond 1e150 have no answer, and
            distances below 1e-150 have few digits.
        k : int, optional
            Find that many for each point, each of another (object, primitive), in order.
        radius : float
            The largest distance that counts, itself included.
        objects : int, str, or sequence of them, optional
            Search these only, by identifiers or names; the others are not there.
        threads : int, optional
            How many threads to use; all cores if left out. The answers are the same.
        progress : bool or callable, optional
            As for `shoot`, in points.

        Returns
        -------
        ClosestPoints
            With ``k`` its arrays have one more axis.

        Raises
        ------
        ValueError
            For arrays of a wrong shape or type, a ``k`` below 1, a ``radius`` that is negative or
            NaN, and for a cone or a cylinder whose transform does not stretch by the same in all
            directions.
        ValueError, IndexError, TypeError
            For ``objects``, as `shoot`.
        MemoryError
            If the answers do not fit into memory.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> nearest = scene.closest_point([[0, 0, 3], [0, 0.5, 0]])
        >>> nearest.distance
        array([2. , 0.5])
        >>> nearest.point
        array([[0., 0., 1.],
               [0., 1., 0.]])
        """
        built = self._ready().seen(None, objects)
        return nearest.closest_points(built, points, k, radius, threads, progress)

    def signed_distance(
        self,
        points: npt.ArrayLike,
        *,
        rule: FillRule = "nonzero",
        allow_open: bool = False,
        objects: Selection | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> npt.NDArray[np.float64]:
        """Measure how far points are from the nearest surface, negative inside.

        A point is inside if it is inside any object, as `inside` has it; of closed meshes without a
        transform that is exact. Where objects or shells overlap, the surface of one within the
        other counts too.

        Parameters
        ----------
        points, objects, threads, progress
            As for `closest_point`.
        rule : {"nonzero", "parity"}
            What is inside of closed meshes, see `inside`.
        allow_open : bool
            Take open meshes and those with parts cut out, too: their winding number gives the sign,
            which is not exact near gaps. Planes and discs have no inside.

        Returns
        -------
        (...) array of float
            The distances: 0 on a surface, ``inf`` where there is none.

        Raises
        ------
        ValueError
            For another ``rule``, and unless ``allow_open`` for an object that is not closed, or of
            which a material cuts parts out.
        ValueError, IndexError, TypeError
            As `closest_point`.
        MemoryError
            If the answers do not fit into memory.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> scene.signed_distance([[0, 0, 3], [0, 0.75, 0]])
        array([ 2.  , -0.25])
        """
        built = self._ready().seen(None, objects)
        return nearest.signed_distances(built, points, rule, allow_open, threads, progress)

    def section(
        self,
        origin: npt.ArrayLike,
        normal: npt.ArrayLike,
        *,
        rule: FillRule = "nonzero",
        objects: Selection | None = None,
        threads: int | None = None,
    ) -> Section:
        """Cut all meshes by a plane.

        The side of each vertex is decided in exact arithmetic; one on the plane counts as on the
        side to which the normal points. Curves are joined by the edges that triangles share. So the
        curves of a closed mesh are closed, whatever lies on the plane. A face in the plane is cut
        if the solid is below it, and not if it is above. Where all curves of a mesh are closed,
        they are the outlines of what is inside, see `inside`: shells that overlap have one in
        common.

        Parameters
        ----------
        origin : (3,) array_like
            A point of the plane, in world space.
        normal : (3,) array_like
            The direction at right angles to it, of any length but zero.
        rule : {"nonzero", "parity"}
            What is inside, see `inside`.
        objects : int, str, or sequence of them, optional
            Cut these only, by identifiers or names; all but hidden ones if left out.
        threads : int, optional
            The number of threads; all cores if left out. The result is the same for any number.

        Returns
        -------
        Section
            The curves with objects and primitives, area and perimeter. An object with a transform
            is cut as its vertices are in the world, rounded to float64.

        Raises
        ------
        ValueError
            For an origin or a normal that is not finite, a normal that is zero, another ``rule``,
            and a name that no object has.
        IndexError, TypeError
            For ``objects`` that are not there, or are no identifiers and no names.
        MemoryError
            If there is too little memory.

        Warns
        -----
        FirsthitWarning
            For objects that are left out, since they are no meshes, and a plane that cuts nothing.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> corners = [[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2]]
        >>> scene.add(fh.Mesh(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]))
        0
        >>> cut = scene.section((0, 0, 1), (0, 0, 1))
        >>> cut.area
        0.5
        >>> cut.polylines
        (Polyline(object 0, closed, 3 points),)
        """
        return section.cut(self._ready().seen(None, objects), origin, normal, rule, threads)

    def lint(
        self, *, ignore: Iterable[str] = (), places: int = 10, threads: int | None = None
    ) -> LintReport:
        """Look for what may be wrong with the meshes.

        Holes, flipped faces, shells inside out, degenerate and duplicate faces, non-manifold edges,
        self-intersections, vertices that are not finite or not used, digits lost far from the
        origin, and unlikely sizes. Areas, volumes and whether faces meet are decided in exact
        arithmetic. Vertices in one place are one, whether or not faces share them. Hidden objects
        are looked at too.

        Parameters
        ----------
        ignore : iterable of str
            Names of kinds that are not looked for, such as ``"units"``; `LintReport.kinds` has all.
        places : int
            How many places of each kind the report has.
        threads : int, optional
            The number of threads; all cores if left out. The result is the same for any number.

        Returns
        -------
        LintReport
            Findings with counts and places.

        Raises
        ------
        ValueError
            For a kind that there is not.
        MemoryError
            If there is too little memory.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> corners = [[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2]]
        >>> scene.add(fh.Mesh(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3]]))
        0
        >>> scene.lint()
        LintReport(hole: 3)
        """
        return lint.report(self._ready(), ignore, places, threads)

    def explain(
        self,
        origin: npt.ArrayLike | Camera | LeavingRays,
        direction: npt.ArrayLike | None = None,
        *,
        pixel: tuple[int, int] | None = None,
        t_min: float = 0.0,
        t_max: float = math.inf,
        mask: int | None = None,
        cull: Side | None = None,
        skip: tuple[int, int] | None = None,
        objects: Selection | None = None,
        blend_below: float | None = None,
        behind: int = 10,
    ) -> Explanation:
        """Explain one ray.

        What it meets first and the surface there, why each other object is not that, and what lies
        behind. It agrees to the bit with `shoot` and `shoot_all`.

        Parameters
        ----------
        origin, direction : (3,) array_like
            The ray, in world space. Instead of both, a `Camera` with a ``pixel``, or
            `LeavingRays` (`Hits.leave`) of the shape ``()``.
        pixel : pair of int, optional
            Of a camera: the row from the top and the column from the left, both from 0. The ray
            goes through the pixel's centre.
        t_min, t_max, mask, cull, skip, objects, blend_below
            As for `shoot`, for this ray.
        behind : int
            How many crossings behind the hit are listed; the others are counted.

        Returns
        -------
        Explanation
            ``print`` shows it as ``firsthit probe`` does.

        Raises
        ------
        ValueError
            For a pixel outside of the picture, for more than one ray, and as `shoot`.
        MemoryError
            If there is too little memory.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> scene.add(fh.Plane(point=(0, 0, 0), normal=(0, 0, 1)), name="ground")
        0
        >>> scene.add(fh.Sphere(center=(0, 0, 1), radius=1), name="ball")
        1
        >>> story = scene.explain((0, 0, 5), (0, 0, -1))
        >>> story.hit["name"], story.hit["t"]
        ('ball', 3.0)
        >>> [(one.name, one.reason) for one in story.candidates]
        [('ground', 'behind_hit'), ('ball', 'hit')]
        >>> [(place.t, place.name) for place in story.behind]
        [(5.0, 'ground'), (5.0, 'ball')]
        """
        given = origin, direction, t_min, t_max, mask, cull, skip
        built = self._ready().seen(None, None, blend_below)
        return explain.explained(built, given, pixel, objects, behind)

    def view(
        self,
        camera: Camera | None = None,
        *,
        background: Sky | npt.ArrayLike | None = None,
        environment: Environment | None = None,
        objects: Selection | None = None,
        shade: ShaderName | Shader | None = None,
        light: LightName | None = None,
        ground: bool | None = None,
        title: str = "scene",
        engine: Literal["page", "kernel"] | None = None,
        height: int = 560,
    ) -> NotebookView:
        """Show the scene in a notebook: turn it, ask pixels, measure, copy the camera.

        From a script, `firsthit.view` shows the same in the browser. The page shows the scene as it
        is at the call.

        Parameters
        ----------
        camera : Camera, optional
            Where the page begins, as for `firsthit.view`.
        background, environment, objects, shade, light, ground
            As for `render`. ``shade`` is no function of one's own.
        title : str
            What the page calls it.
        engine : {"page", "kernel"}, optional
            Who computes the pictures. ``"page"``: firsthit in the page itself, as a WebAssembly
            module, with the scene; it works without a kernel, and the notebook is a few megabytes
            larger. ``"kernel"``: this process with all its threads; it takes anywidget, ``pip
            install firsthit[notebook]``, and needs no port. If left out, the kernel for more than
            500,000 triangles where anywidget is there, else the page.
        height : int
            Of what is shown, in pixels of the notebook.

        Returns
        -------
        NotebookView
            What notebooks show. Its ``save`` writes the page to a file.

        Raises
        ------
        TypeError, ValueError
            As `firsthit.view`.
        ImportError
            For the engine ``"kernel"`` without anywidget.

        Examples
        --------
        >>> import firsthit as fh
        >>> scene = fh.Scene()
        >>> ball = scene.add(fh.Sphere((0, 0, 0), 1))
        >>> scene.view(title="a ball", engine="page")
        NotebookView('a ball', engine='page')
        """
        return notebook.notebook_view(
            self, camera, title, engine, height, background=background, environment=environment,
            objects=objects, shade=shade, light=light, ground=ground,
        )  # fmt: skip

    def _repr_html_(self) -> str:
        """Show a picture of it, for notebooks."""
        return notebook.picture_html(self)

    def _ready(self) -> Built:
        """Return what rays are shot at: the objects and lights there are now, built."""
        current = self._current()
        if current is not None:
            return current
        with self._turn.taken():
            # Another thread may have built it while this one waited.
            current = self._current()
            if current is None:
                with timed("built %d objects", len(self._objects), level=DEBUG):
                    current = self._build()
            return current

    def _current(self) -> Built | None:
        """Return what was built last, unless something was added or moved since."""
        last = self._last
        if last is None or last.moves is not self._moves or last.known != len(last.moves):
            return None
        return last.built if self._is_all_in(last.built) else None

    def _is_all_in(self, built: Built) -> bool:
        """Tell whether nothing was added since something was built."""
        counts = len(built.objects), len(built.lights)
        is_all = counts == (len(self._objects), len(self._lights))
        return is_all and built.around == self._around()

    def _around(self) -> Surroundings:
        """Return what is around; which way is up counts only for an environment."""
        if self._environment is None:
            return None, (0.0, 0.0, 1.0), False
        return self._environment, self._up, self._up_is_guessed

    def _build(self) -> Built:
        """Build what there is now, and remember it.

        A signal's handler or another thread may add and move objects at any step. What this build
        lacks must make it out of date for `_current`. A move that is in and counts as new does no
        harm: it is made again.
        """
        last = self._last
        if last is not None and last.moves is self._moves and self._is_all_in(last.built):
            # Moves are counted before the objects are copied: a later one is then beyond the count.
            known = len(last.moves)
            # A copy, which shows all objects at one moment.
            objects = self._objects[:]
            count = len(last.built.objects)
            changed = {k: objects[k] for k in last.moves[last.known :] if k < count}
            built = last.built.changed(changed)
            self._last = _Last(built, last.moves, known)
            return built
        # The list is replaced before the objects are copied: a later move is then in the new list.
        moves: list[int] = []
        self._moves = moves
        around = self._around()
        lights, objects = self._lights[:], self._objects[:]
        while len(lights) < len(self._lights):
            lights, objects = self._lights[:], self._objects[:]
        previous = None if last is None else last.built.native
        built = Built(objects, lights, around, previous=previous, build=self._build_as)
        self._last = _Last(built, moves, 0)
        return built

    def _view(self) -> Camera:
        """Return the default camera."""
        return self._cameras[0].camera if self._has_view else Camera.framing(self)

    def _triangles(self) -> int:
        return sum(made.triangles for made in self._objects)

    def __repr__(self) -> str:
        plural = "" if len(self._objects) == 1 else "s"
        return f"Scene({len(self._objects):,} object{plural}, {self._triangles():,} triangles)"

    def __getstate__(self) -> dict[str, Any]:
        """Pickle the objects; what is built from them is built again."""
        return {name: self.__dict__[name] for name in _KEPT}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__init__()  # type: ignore[misc]
        self.__dict__.update(state)

    def __copy__(self) -> Scene:
        """Copy: the shapes are shared, the lists are not."""
        other = Scene()
        other.__dict__.update({name: self.__dict__[name] for name in _KEPT})
        other._objects, other._lights = list(self._objects), list(self._lights)
        built = self._current()
        if built is not None:
            # Where the objects were when it was built, lest a move come in between.
            other._objects[: len(built.objects)] = built.objects
            other._last = _Last(built, other._moves, 0)
        return other


#: What a scene is, beside what is built from it.
_KEPT = (
    "_build_as",
    "_objects",
    "_lights",
    "_environment",
    "_cameras",
    "_has_view",
    "_background",
    "_shading",
    "_display",
    "_edges",
    "_up",
    "_up_is_guessed",
)
