"""Conversion of other packages' meshes, trimesh's above all, without importing any."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit import _firsthit
from firsthit._base.errors import warn
from firsthit._looks.material import Material, Texture

from .properties import is_exact

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy.typing as npt


def is_mesh(thing: object) -> bool:
    """Tell whether something is a mesh like trimesh's."""
    # The class first: a box or a sphere of trimesh's is asked before it can tell its vertices.
    places = (type(thing), thing)
    return all(any(hasattr(p, name) for p in places) for name in ("vertices", "faces"))


def attributes(thing: Any) -> dict[str, Any]:
    """Return what a mesh has beside vertices and faces, as arguments of `Mesh`."""
    found: dict[str, Any] = {
        of + "_properties": properties(getattr(thing, name, None) or {}, name, len(whose))
        for of, name, whose in (
            ("vertex", "vertex_attributes", thing.vertices),
            ("face", "face_attributes", thing.faces),
        )
    }
    visual: Any = getattr(thing, "visual", None)
    kind = getattr(visual, "kind", None)
    if kind == "vertex":
        found["colors"] = linear(visual.vertex_colors)
    elif kind == "face":
        found["colors"] = np.repeat(linear(visual.face_colors)[:, None], 3, axis=1)
    elif kind == "texture":
        found["uvs"] = getattr(visual, "uv", None)
    return found


def material(thing: Any) -> Material | None:
    """Return the look of a mesh, if it has one beside its colours."""
    visual: Any = getattr(thing, "visual", None)
    if getattr(visual, "kind", None) != "texture":
        return None
    return _material(visual.material, has_uvs=getattr(visual, "uv", None) is not None)


def properties(given: Mapping[str, Any], of: str, count: int) -> dict[str, npt.NDArray[Any]]:
    """Return those attributes of vertices or faces that are numbers, one row for each."""
    found = {}
    for name, values in given.items():
        array = np.asarray(values)
        has_rows = array.ndim in (1, 2) and len(array) == count and array.size
        if not (isinstance(name, str) and array.dtype.kind in "biuf" and has_rows):
            warn(
                f"the attribute {name!r} of {of} is left out: it must have real numbers, a row for "
                f"each of {count}, got {array.dtype} of shape {array.shape}"
            )
        elif not is_exact(array):
            warn(f"the attribute {name!r} of {of} is left out: it has integers beyond 2**53")
        else:
            found[name] = array
    return found


def linear(colors: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return linear red, green and blue, (n, 3), of sRGB colours with eight bits each."""
    # The library's own numbers: NumPy's powers differ between machines in the last bit.
    return np.array(_firsthit.srgb_levels())[np.asarray(colors, np.uint8)[:, :3]]


def _material(look: Any, *, has_uvs: bool) -> Material:
    """Return a look of trimesh's: one of glTF's materials, or one of MTL's.

    Both have linear colours in eight bits; their pictures are sRGB.
    """
    if hasattr(look, "materials"):
        warn("a mesh's several materials are left out: it is white")
    color = _first(look, "baseColorFactor", "diffuse")
    levels = np.full(4, 255.0) if color is None else np.asarray(color, np.float64)
    # trimesh has eight bits, but leaves floats that it was given.
    levels = levels / 255.0 if color is None or np.asarray(color).dtype.kind in "iu" else levels
    picture = _first(look, "baseColorTexture", "image") if has_uvs else None
    texture = None if picture is None else Texture(np.asarray(picture.convert("RGBA")))
    mode = str(getattr(look, "alphaMode", None) or "opaque").lower()
    cutoff = getattr(look, "alphaCutoff", None)
    # As glTF has it: a metal, where a look of metal and roughness does not say otherwise.
    surface: dict[str, Any] = {}
    if hasattr(look, "metallicFactor"):
        metallic, roughness = look.metallicFactor, look.roughnessFactor
        surface = {
            "kind": "metal-rough",
            "metallic": 1.0 if metallic is None else float(metallic),
            "roughness": 1.0 if roughness is None else float(roughness),
        }
    return Material(
        levels[:3],
        float(levels[3]) if len(levels) > 3 else 1.0,
        texture,
        alpha_mode="mask" if mode == "mask" else "blend" if mode == "blend" else "opaque",
        cutoff=0.5 if cutoff is None else float(cutoff),
        double_sided=bool(getattr(look, "doubleSided", True)),
        **surface,
    )


def _first(look: Any, *names: str) -> Any:
    """Return the first of some attributes that is there."""
    return next((v for name in names if (v := getattr(look, name, None)) is not None), None)
