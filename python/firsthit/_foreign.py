"""Meshes and scenes of other packages, trimesh's above all, without importing any."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any, NamedTuple, TypeGuard

import numpy as np

from . import _firsthit
from ._arrays import text
from ._errors import FirsthitWarning
from ._material import Material, Texture
from ._shapes import Mesh, Shape

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy.typing as npt

    from ._types import SceneLike


class Part(NamedTuple):
    """What becomes an object."""

    name: str
    shape: Shape
    material: Material | None = None
    transform: npt.NDArray[np.float64] | None = None


def is_scene(thing: object) -> TypeGuard[SceneLike]:
    """Tell whether something is a scene like trimesh's."""
    return hasattr(thing, "geometry") and hasattr(getattr(thing, "graph", None), "nodes_geometry")


def objects(scene: SceneLike) -> Iterator[Part]:
    """Yield a scene's nodes that have meshes. Nodes that share a mesh go on sharing it."""
    made: dict[str, tuple[Mesh, Material | None]] = {}
    for node in scene.graph.nodes_geometry:
        matrix, name = scene.graph.get(node)
        thing = scene.geometry[name]
        if not (hasattr(thing, "vertices") and hasattr(thing, "faces")):
            what = f"node {node!r} is left out: a {type(thing).__name__} has no triangles"
            warnings.warn(what, FirsthitWarning, stacklevel=3)
            continue
        if name not in made:
            made[name] = mesh(thing)
        shape, material = made[name]
        placed = np.asarray(matrix, np.float64)
        if not np.linalg.det(placed[:3, :3]):
            what = f"node {node!r} is left out: its transform flattens space"
            warnings.warn(what, FirsthitWarning, stacklevel=3)
            continue
        yield Part(text("node", str(node)), shape, material, placed)


def mesh(thing: Any) -> tuple[Mesh, Material | None]:
    """Return a mesh with its colours, and its look if it has one."""
    visual: Any = getattr(thing, "visual", None)
    kind = getattr(visual, "kind", None)
    vertices, faces = thing.vertices, thing.faces
    properties: dict[str, Any] = {
        "vertex_properties": _properties(thing, "vertex_attributes", len(vertices)),
        "face_properties": _properties(thing, "face_attributes", len(faces)),
    }

    def made(**look: Any) -> Mesh:
        return Mesh(vertices, faces, **look, **properties)

    if kind == "vertex":
        return made(colors=_linear(visual.vertex_colors)), None
    if kind == "face":
        colors = np.repeat(_linear(visual.face_colors)[:, None], 3, axis=1)
        return made(colors=colors), None
    if kind == "texture":
        uvs = getattr(visual, "uv", None)
        return made(uvs=uvs), _material(visual.material, has_uvs=uvs is not None)
    return made(), None


def _properties(thing: Any, of: str, count: int) -> dict[str, npt.NDArray[Any]]:
    """Return trimesh's attributes of vertices or faces that are numbers, one row for each."""
    found = {}
    for name, values in (getattr(thing, of, None) or {}).items():
        array = np.asarray(values)
        has_rows = array.ndim in (1, 2) and len(array) == count and array.size
        if isinstance(name, str) and array.dtype.kind in "biuf" and has_rows:
            found[name] = array
        else:
            what = f"the attribute {name!r} of {of} is left out: it has no numbers for each"
            warnings.warn(what, FirsthitWarning, stacklevel=4)
    return found


def _linear(colors: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return linear red, green and blue, (n, 3), of sRGB colours with eight bits each."""
    # The library's own numbers: NumPy's powers differ between machines in the last bit.
    return np.array(_firsthit.srgb_levels())[np.asarray(colors, np.uint8)[:, :3]]


def _material(look: Any, *, has_uvs: bool) -> Material:
    """Return a look of trimesh's: one of glTF's materials, or one of MTL's.

    Both have linear colours in eight bits; their pictures are sRGB.
    """
    if hasattr(look, "materials"):
        what = "a mesh's several materials are left out: it is white"
        warnings.warn(what, FirsthitWarning, stacklevel=5)
    color = _first(look, "baseColorFactor", "diffuse")
    levels = np.full(4, 255.0) if color is None else np.asarray(color, np.float64)
    # trimesh has eight bits, but leaves floats that it was given.
    levels = levels / 255.0 if color is None or np.asarray(color).dtype.kind in "iu" else levels
    picture = _first(look, "baseColorTexture", "image") if has_uvs else None
    texture = None if picture is None else Texture(np.asarray(picture.convert("RGBA")))
    mode = str(getattr(look, "alphaMode", None) or "opaque").lower()
    cutoff = getattr(look, "alphaCutoff", None)
    return Material(
        levels[:3],
        float(levels[3]) if len(levels) > 3 else 1.0,
        texture,
        alpha_mode="mask" if mode == "mask" else "blend" if mode == "blend" else "opaque",
        cutoff=0.5 if cutoff is None else float(cutoff),
        double_sided=bool(getattr(look, "doubleSided", True)),
    )


def _first(look: Any, *names: str) -> Any:
    """Return the first of some attributes that is there."""
    return next((v for name in names if (v := getattr(look, name, None)) is not None), None)
