"""Scenes from files."""

from __future__ import annotations

from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

from firsthit import _firsthit
from firsthit._base.arrays import count, flag, number, one_of, settle, text
from firsthit._base.arrays import vector as as_vector
from firsthit._base.errors import FileFormatError, warn
from firsthit._base.log import timed
from firsthit._base.memory import uncollected
from firsthit._base.progress import following
from firsthit._looks.colors import from_native as colors_from
from firsthit._looks.display import Display
from firsthit._looks.edges import Edges
from firsthit._looks.environment import environment_of
from firsthit._looks.lights import Sky, light_of
from firsthit._looks.material import Material, Texture
from firsthit._looks.shading import Shader, Shading
from firsthit._objects.mesh import Mesh
from firsthit._objects.object_list import ObjectList, OfFile
from firsthit._sensors import named_camera

from .scene import Scene

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable, Sequence
    from typing import TypedDict, Unpack

    from firsthit._queries.lint import LintReport
    from firsthit.typing import Build, Progress, Unit

    class _How(TypedDict, total=False):
        ignore: Iterable[str]
        places: int
        threads: int | None
        strict: bool
        max_memory: int
        max_texture: int
        units: Unit | None
        scale: float
        resources: str | os.PathLike[str] | Iterable[str | os.PathLike[str]]
        build: Build
        variant: str | None
        progress: Progress | None


def load(
    path: str | os.PathLike[str],
    *,
    strict: bool = False,
    max_memory: int = 8 << 30,
    max_texture: int = 16384,
    units: Unit | None = None,
    scale: float = 1.0,
    resources: str | os.PathLike[str] | Iterable[str | os.PathLike[str]] = (),
    build: Build = "auto",
    variant: str | None = None,
    progress: Progress | None = None,
) -> Scene:
    """Read a 3D file: a mesh, a scene file (TOML), or a built scene (.fhs, see `open`).

    Parameters
    ----------
    path : path-like
        The file; its extension tells the format.
    strict : bool
        Whether unusable triangles, and a text file that seems to be truncated, are errors instead
        of warnings.
    max_memory : int
        How many bytes the file's content may take once it is unpacked. The vertices, triangles and
        objects that it describes may take 256 times its size plus 1/256 of ``max_memory``.
    max_texture : int
        The largest width and height of a texture in texels. Its texels, four bytes each, may take
        the square of this.
    units : {"um", "mm", "cm", "m", "km", "in", "ft"}, optional
        The unit of a mesh file's or a model's lengths: they become metres.
    scale : float
        The factor of all lengths of a mesh file or a model, after ``units``. Its lights
        are as bright on its surfaces as before. Scene files and built scenes have lengths of their
        own: a scene file says ``units`` for each file that it names.
    resources : path-like or iterable of path-like
        Folders whose files the file may name, as textures, beside those of its own folder: one that
        names ``../textures/wood.png`` needs ``resources=".../textures"``. A file not found by its
        whole name is looked for there by the last part of it. Nothing else is opened.
    build : {"auto", "fast", "best"}
        How the trees over meshes are built, see `Scene`. A ``.fhs`` file has its own.
    variant : str, optional
        The variant of a glTF file's materials, by its name (``KHR_materials_variants``); of the
        files that a scene file names, those that have it are read so. If left out, the materials
        are those that the file shows without one.
    progress : bool or callable, optional
        ``True`` shows each step and the time that is left; a function is called with what is done
        of the present step, and its total. An exception that it raises ends the work.

    Returns
    -------
    Scene
        The file's objects with their names, transforms and materials, and its lights, environment,
        cameras, background, shading, display, edges and up. Lengths are in the file's unit, or as
        ``units`` and ``scale`` say.

    Raises
    ------
    FileReadError
        If the system refuses to read it; also an `OSError`.
    FileFormatError
        For an unknown extension and wrong content; also a `ValueError`. Both are `FileError`, with
        path and place.
    ValueError
        For limits that are no whole numbers, unknown ``units`` and ``build``, a ``scale`` that is
        not positive, or for a file that says itself how long all is, and a variant that the file
        does not have.
    MemoryError
        If the file needs more than ``max_memory``, or more than there is.

    Warns
    -----
    FirsthitWarning
        For what is doubtful in the file.
    """
    limits = count("max_memory", max_memory), min(count("max_texture", max_texture), 2**32 - 1)
    scene = Scene(build=build)
    if isinstance(resources, str | PathLike):
        resources = (resources,)
    folders = [*map(Path, resources)]
    named = None if variant is None else text("variant", variant)
    strictly, factor = flag("strict", strict), _factor(units, scale)
    with uncollected():
        with timed("read %s", path), following(progress) as report:
            model = _firsthit.load(Path(path), strictly, *limits, factor, folders, named, report)
        for doubt in model["warnings"]:
            warn(doubt)
        return _filled(scene, model, path)


def _factor(units: Unit | None, scale: float) -> float:
    """Return what a file's lengths are multiplied by."""
    metres = dict(_firsthit.units())
    factor = number("scale", scale)
    return factor if units is None else metres[one_of("units", units, metres)] * factor


def open(  # noqa: A001 - fh.open
    path: str | os.PathLike[str], *, verify: bool = False, progress: Progress | None = None
) -> Scene:
    """Open a scene that `Scene.save`, or ``firsthit build``, wrote to a ``.fhs`` file.

    On Linux the file is mapped into memory as it is, with its trees, and processes that open the
    same file share it. Nothing is built. All indices are checked, so that no file does harm. The
    answers are those of the scene that was saved, to the last bit.

    Parameters
    ----------
    path : path-like
        The file.
    verify : bool
        Whether to compare all of the file with its checksums, which takes longer. Without it only
        the structure is compared; wrong coordinates in a damaged file make wrong answers.
    progress : bool or callable, optional
        As for `load`.

    Returns
    -------
    Scene
        The scene. The file must not be changed in place while the scene is in use: the system ends
        a process that reads what was cut off. `Scene.save` never does that, since it replaces a
        file.

    Raises
    ------
    FileReadError
        If the system refuses to read it; also an `OSError`.
    FileFormatError
        For a file of another kind or version, one that is not whole, and one that does not fit
        together; also a `ValueError`. Both are `FileError`, with path and place.
    TypeError
        For ``verify`` that is not ``True`` or ``False``.
    MemoryError
        If memory is short.

    Examples
    --------
    >>> import tempfile
    >>> scene = fh.Scene()
    >>> ball = scene.add(fh.Sphere(center=(0, 0, 0), radius=1), name="ball")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     scene.save(f"{folder}/ball.fhs")
    ...     opened = fh.open(f"{folder}/ball.fhs")
    >>> float(opened.shoot((0, 0, 9), (0, 0, -1)).t)
    8.0
    """
    with uncollected():
        with timed("opened %s", path), following(progress) as report:
            model = _firsthit.open(Path(path), flag("verify", verify), report)
        return _filled(Scene(), model, path)


def _filled(scene: Scene, model: _firsthit._Model, path: str | PathLike[str]) -> Scene:
    """Fill an empty scene with what a file holds, and return it."""
    try:
        _fill(scene, model)
    except ValueError as error:
        # Numbers that nothing can have are the file's, not the caller's.
        text = fspath(path)
        raise FileFormatError(_firsthit.escaped(f"{text}: {error}"), text) from None
    return scene


def _fill(scene: Scene, model: _firsthit._Model) -> None:
    scene.up = model["up"]
    scene._up_is_guessed = model["up_is_guessed"]
    scene._objects = _objects(model)
    for light in model["lights"]:
        scene.add_light(light_of(*light))
    if model["environment"] is not None:
        scene.environment = environment_of(model["environment"])
    scene._has_view = model["has_view"]
    # Those of scene files were cameras already.
    scene._cameras = tuple(
        named_camera.from_native(*camera, settled=model["has_view"]) for camera in model["cameras"]
    )
    background = model["background"]
    if background is not None:
        if not background:
            scene.background = "transparent"
        else:
            scene.background = Sky(*background) if len(background) == 3 else background[0]
    if model["shading"] is not None:
        shade, settings, rig, ground, samples, colors = model["shading"]
        shader = None if shade is None else Shader(shade, **dict(settings))
        by_numbers = None if colors is None else colors_from(colors)
        look: dict[str, Any] = {"light": rig, "ground": ground, "samples": samples}
        scene.shading = Shading(shader, colors=by_numbers, **look)
    scene.display = Display(*model["display"])
    if model["edges"] is not None:
        scene.edges = Edges(*model["edges"])
    if model["scene"] is not None:
        scene._take_built(model["scene"])


@overload
def lint(  # type: ignore[overload-overlap] # A text is one path.
    path: str | os.PathLike[str], **how: Unpack[_How]
) -> LintReport: ...


@overload
def lint(path: Iterable[str | os.PathLike[str]], **how: Unpack[_How]) -> tuple[LintReport, ...]: ...


def lint(
    path: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    *,
    ignore: Iterable[str] = (),
    places: int = 10,
    threads: int | None = None,
    strict: bool = False,
    max_memory: int = 8 << 30,
    max_texture: int = 16384,
    units: Unit | None = None,
    scale: float = 1.0,
    resources: str | os.PathLike[str] | Iterable[str | os.PathLike[str]] = (),
    build: Build = "auto",
    variant: str | None = None,
    progress: Progress | None = None,
) -> LintReport | tuple[LintReport, ...]:
    """Look for what may be wrong with a 3D file, or with several.

    Parameters
    ----------
    path : path-like or iterable of path-like
        The file, as for `load`; or several.
    ignore, places, threads
        As for `Scene.lint`.
    strict, max_memory, max_texture, units, scale, resources, build, variant, progress
        As for `load`.

    Returns
    -------
    LintReport
        Findings with counts and places; a tuple with one for each of several files.

    Raises
    ------
    FileReadError, FileFormatError, MemoryError
        As `load`.
    ValueError
        For a kind that there is not, and as `load`.

    Warns
    -----
    FirsthitWarning
        For what is doubtful in the file.
    """

    def report(file: str | os.PathLike[str]) -> LintReport:
        scene = load(
            file,
            strict=strict,
            max_memory=max_memory,
            max_texture=max_texture,
            units=units,
            scale=scale,
            resources=resources,
            build=build,
            variant=variant,
            progress=progress,
        )
        return scene.lint(ignore=ignore, places=places, threads=threads, progress=progress)

    if isinstance(path, str | bytes | PathLike):
        return report(path)
    # No map: it would take a StopIteration of the caller's function for its own end.
    return tuple([report(file) for file in path])


def _objects(model: _firsthit._Model) -> ObjectList:
    materials = _Materials(model["textures"])
    looks = [tuple(map(materials.made, each)) for each in model["looks"]]
    meshes = [Mesh._wrap(mesh) for mesh in model["meshes"]]
    native = model["objects"]
    return ObjectList(range(len(native)), OfFile(native, meshes, looks))


class _Materials:
    """Materials that are made once, however many objects have them."""

    def __init__(self, textures: Sequence[_firsthit.Texels]) -> None:
        self._texels = textures
        self._textures: dict[_firsthit._MapOut, Texture] = {}
        self._made: dict[tuple[object, ...], Material] = {}

    def made(self, look: _firsthit._MaterialOut) -> Material:
        *first, (kind, settings), strengths, textures = look
        key = (*first, kind, tuple(settings), strengths, tuple(textures))
        if key not in self._made:
            color, alpha, texture, alpha_texture, mode, cutoff, unlit, both, name = look[:9]
            emission, normal_scale, occlusion_strength = strengths
            others = {f"{role}_texture": self._texture(map_) for role, map_ in textures}
            made = Material(
                (1, 1, 1),
                alpha,
                self._texture(texture),
                self._texture(alpha_texture),
                mode,
                cutoff,
                unlit,
                both,
                name,
                kind=kind,
                emission=emission,
                normal_scale=normal_scale,
                occlusion_strength=occlusion_strength,
                **dict[str, Any](settings),
                **dict[str, Any](others),
            )
            settle(made, color=as_vector("color", color))
            self._made[key] = made
        return self._made[key]

    def _texture(self, made: _firsthit._MapOut | None) -> Texture | None:
        if made is None:
            return None
        if made not in self._textures:
            texels = self._texels[made[0]]
            self._textures[made] = Texture._wrapped(texels, made[1], made[2], made[3], made[4])
        return self._textures[made]
