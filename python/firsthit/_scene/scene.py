"""Scenes: objects and lights."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import color_of, direction, text, vector
from firsthit._base.errors import name_methods
from firsthit._base.log import timed
from firsthit._base.progress import following
from firsthit._looks.display import Display, as_display
from firsthit._looks.edges import Edges
from firsthit._looks.environment import Environment
from firsthit._looks.lights import TRANSPARENT, Light, Sky, background_native, is_transparent
from firsthit._looks.shading import Shading
from firsthit._objects import foreign
from firsthit._objects.filters import ALL, one_mask
from firsthit._objects.object import Object, affine, placed
from firsthit._objects.object_list import ObjectList
from firsthit._objects.traceable import Built
from firsthit._queries.inspections import Inspections
from firsthit._queries.of_points import PointQueries
from firsthit._queries.of_rays import RayQueries
from firsthit._sensors.camera import Camera
from firsthit._sensors.named_camera import NamedCamera, find
from firsthit._view import notebook

from .changes import Changes, Last
from .objects import Objects

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence

    import numpy.typing as npt

    from firsthit._looks.material import Material
    from firsthit._looks.shading import Shader
    from firsthit._objects.shapes import Shape
    from firsthit._view.notebook import NotebookView
    from firsthit.typing import (
        Build,
        ForeignMesh,
        LightName,
        Progress,
        SceneLike,
        Selection,
        ShaderName,
        Vector,
    )


class Scene(Changes, RayQueries, PointQueries, Inspections):
    """Objects and lights. Any number of threads may use it at once.

    An object's identifier is its index in the order of insertion. Coordinates and lengths have any
    unit, the scene unit. Adding is cheap: the trees for rays are built by the first call that needs
    them, and later calls build only what has changed. Ctrl-C ends queries and builds.

    Parameters
    ----------
    build : {"auto", "fast", "best"}
        How the trees over meshes are built: ``"fast"`` in a third of the time or less, ``"best"``
        so that each ray takes least. No answer depends on it. ``"auto"`` is ``"best"``, since
        nobody knows how many rays will be shot. `save` writes the best ones.

    Examples
    --------
    >>> scene = fh.Scene()
    >>> scene.add(fh.Plane(point=(0, 0, 0), normal=(0, 0, 1)), name="ground")
    0
    >>> scene.add(fh.Sphere(center=(0, 0, 1), radius=1), name="ball")
    1
    >>> scene
    Scene(2 objects, 0 triangles)
    """

    def __init__(self, *, build: Build = "auto") -> None:
        super().__init__(build)
        self._cameras: tuple[NamedCamera, ...] = ()
        self._background: Sky | Vector | str | None = None
        self._shading = Shading()
        self._display = Display()
        self._edges: Edges | None = None
        #: Whether the first camera is the one to look through, as in scene files.
        self._has_view = False

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
            materials, and attributes of vertices and faces, see `Hits.attribute`. Anything but
            meshes is left out, with a warning. Scenes of other packages do not say which way is up:
            set `up` if it is not +z, as for a glTF file that trimesh has read, where it is +y.
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
        parts, bits = foreign.parts(shape, name), one_mask("mask", mask)
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

    def save(self, path: str | os.PathLike[str], *, progress: Progress | None = None) -> None:
        """Save the scene, built, to a ``.fhs`` file, which `open` maps into memory as it is.

        The file holds objects, meshes with their trees, materials, textures, lights, cameras, names
        and what pictures are made with by default. It appears whole or not at all. A file of that
        name is replaced; those who have it open keep theirs.

        Parameters
        ----------
        path : path-like
            The file; its name must end with ``.fhs``.
        progress : bool or callable, optional
            As for `load`.

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
        shading, background = self._shading, self._background
        built = self._ready(progress)
        with following(progress) as report, timed("wrote %s", path):
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
                report,
            )

    @property
    def objects(self) -> tuple[Object, ...]:
        """The objects, in the order of their identifiers."""
        changes, known = self._moves, len(self._moves)
        if self._listed is not None:
            of, before, listed = self._listed
            if of is changes and (before, len(listed)) == (known, len(self._objects)):
                return listed
        listed = Objects(self._objects)
        self._listed = changes, known, listed
        return listed

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
        self._up, self._up_is_guessed = direction("up", up), False

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
            The page's name for it.
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
            The view that notebooks show. Its ``save`` writes the page to a file.

        Raises
        ------
        TypeError, ValueError
            As `firsthit.view`.
        ImportError
            For the engine ``"kernel"`` without anywidget.

        Examples
        --------
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

    def _view(self) -> Camera:
        """Return the default camera."""
        return self._cameras[0].camera if self._has_view else Camera.framing(self)

    def __repr__(self) -> str:
        count, triangles = len(self._objects), self._objects.triangles()
        return f"Scene({count:,} object{'' if count == 1 else 's'}, {triangles:,} triangles)"

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
        objects, other._lights = self._objects[:], self._lights[:]
        # From now on the same identifier may be of another name.
        other._objects = ObjectList(objects.held(), objects.of_file)
        built = self._current()
        if built is not None:
            # Where the objects were when it was built, lest a move come in between.
            count = len(built.objects)
            held: Any = built.objects.held()
            other._objects[:count] = list(held)
            own = Built(other._objects[:count], built.lights, built.around, built.native)
            other._last = Last(own, other._moves, 0)
        return other


#: The parts of a scene, without what is built from them.
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

name_methods(Scene, *Scene.__bases__)
