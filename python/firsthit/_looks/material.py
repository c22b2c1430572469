"""The look of surfaces, and the alpha masks that cut them out."""

from __future__ import annotations

import copyreg
import marshal
import math
from dataclasses import dataclass, fields
from inspect import signature
from operator import attrgetter
from typing import TYPE_CHECKING, Any
from weakref import WeakValueDictionary

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import color_of, flag, number, numbers, settle, text, vector

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy.typing as npt

    from firsthit.typing import AlphaMode, Filter, MaterialKind, Vector, Wrap

#: Texture coordinates whose v runs upwards, as in OBJ and PLY: rows of the map to the picture.
_V_UP = ((1.0, 0.0, 0.0), (0.0, -1.0, 1.0))


class Texture:
    """An image on surfaces. Immutable; materials can share one.

    Parameters
    ----------
    texels : (rows, columns, 3 or 4) array of uint8
        Red, green and blue as sRGB, and a linear alpha; without alpha the texture is opaque. Row 0
        is the top row.
    wrap : {"repeat", "mirror", "clamp"} or two of them
        The picture beyond the edges: beyond the left and the right one, and beyond the top and the
        bottom one.
    filter : {"linear", "nearest"}
        The colour between texels: their weighted mean in linear light, or the nearest texel.
    picture_from_uv : (2, 3) array_like, optional
        The affine map from (u, v, 1) to the image's coordinates, which run from 0 at the left to 1
        at the right, and from 0 at the top to 1 at the bottom. If left out, it is (u, 1 - v).
    second_uvs : bool
        Whether it takes a mesh's ``second_uvs`` in place of its ``uvs``.

    Raises
    ------
    ValueError
        For an array of a wrong shape or type, and for unknown words.
    TypeError
        For a ``wrap`` or a ``filter`` that is no word.

    Examples
    --------
    >>> checker = np.uint8([[[0], [255]], [[255], [0]]]).repeat(3, axis=2)
    >>> fh.Texture(checker, filter="nearest")
    Texture(2 x 2 texels)
    """

    def __init__(
        self,
        texels: npt.ArrayLike,
        *,
        wrap: Wrap | tuple[Wrap, Wrap] = "repeat",
        filter: Filter = "linear",  # noqa: A002 - the field's word
        picture_from_uv: npt.ArrayLike | None = None,
        second_uvs: bool = False,
    ) -> None:
        array = numbers("texels", texels)
        if array.ndim != 3 or array.shape[2] not in (3, 4) or array.dtype != np.uint8:
            raise ValueError(
                "texels must be uint8 of shape (rows, columns, 3 or 4), "
                f"got {array.dtype} of shape {array.shape}"
            )
        if array.shape[2] == 3:
            opaque = np.full((*array.shape[:2], 1), 255, np.uint8)
            array = np.concatenate([array, opaque], axis=2)
        both = (wrap, wrap) if isinstance(wrap, str) else wrap
        if not isinstance(both, tuple | list) or len(both) != 2:
            raise TypeError(f"wrap must be a word or two of them, got {wrap!r}")
        across, down = (text("wrap", each) for each in both)
        rows = _V_UP if picture_from_uv is None else _rows(picture_from_uv)
        native = _firsthit.Texels(np.ascontiguousarray(array))
        second = flag("second_uvs", second_uvs)
        self._set(native, (across, down), text("filter", filter), rows, second)
        # Refused here, not at the first shot.
        Material(texture=self)

    def _set(
        self,
        texels: _firsthit.Texels,
        wrap: tuple[str, str],
        filter_name: str,
        rows: tuple[Vector, Vector],
        second_uvs: bool,  # noqa: FBT001 - as the native module has it
    ) -> None:
        self._texels, self._wrap, self._filter, self._rows = texels, wrap, filter_name, rows
        self._second_uvs = second_uvs

    @classmethod
    def _wrapped(
        cls,
        texels: _firsthit.Texels,
        wrap: tuple[str, str],
        filter_name: str,
        rows: tuple[Vector, Vector],
        second_uvs: bool,  # noqa: FBT001 - as above
    ) -> Texture:
        made = cls.__new__(cls)
        made._set(texels, wrap, filter_name, rows, second_uvs)
        return made

    @property
    def texels(self) -> npt.NDArray[np.uint8]:
        """The texels, (rows, columns, 4) uint8, red, green, blue as sRGB and alpha: a copy."""
        return self._texels.array()

    @property
    def wrap(self) -> tuple[str, str]:
        """The continuation beyond the edges: beyond left and right, and beyond top and bottom."""
        return self._wrap

    @property
    def filter(self) -> str:
        """The filter between texels: ``linear`` or ``nearest``."""
        return self._filter

    @property
    def picture_from_uv(self) -> npt.NDArray[np.float64]:
        """The map from (u, v, 1) to the image's coordinates, (2, 3) float64: a copy."""
        return np.array(self._rows)

    @property
    def second_uvs(self) -> bool:
        """Whether it takes a mesh's ``second_uvs`` in place of its ``uvs``."""
        return self._second_uvs

    def _native(self) -> _firsthit._Map:
        return self._texels, self._wrap, self._filter, self._rows, self._second_uvs

    def __repr__(self) -> str:
        rows, columns, _ = self.texels.shape
        return f"Texture({columns} x {rows} texels)"


copyreg.pickle(_firsthit.Texels, lambda made: (_firsthit.Texels, (made.array(),)))


def _rows(picture_from_uv: npt.ArrayLike) -> tuple[Vector, Vector]:
    rows = numbers("picture_from_uv", picture_from_uv)
    if rows.shape != (2, 3) or not np.all(np.isfinite(rows)):
        raise ValueError(f"picture_from_uv must be (2, 3) and finite, got {rows.tolist()}")
    return vector("picture_from_uv", rows[0]), vector("picture_from_uv", rows[1])


@dataclass(frozen=True, init=False, repr=False)
class Material:
    """The look of a surface, and the alpha mask that cuts it out. Immutable.

    Parameters
    ----------
    color : (3,) array_like or str
        Linear numbers, or sRGB as ``"#rrggbb"`` or a CSS name; multiplied by the mesh's own colours
        and by the texture.
    alpha : float
        From 0, transparent, to 1, opaque; multiplied by the mesh's own alphas and by the texture's.
    texture : Texture, optional
        Colour and alpha, for meshes with ``uvs``.
    alpha_texture : Texture, optional
        Alpha alone, in place of the alpha of ``texture``.
    alpha_mode : {"opaque", "mask", "blend"}
        The meaning of alpha. ``opaque``: nothing. ``mask``: it is an alpha mask; where it is below
        ``cutoff`` the surface is cut out, and rays do not meet it. ``blend``: the surface is
        translucent in colours; other channels and rays meet it as if it were opaque.
    cutoff : float
        The alpha from which on the surface is there.
    unlit : bool
        Whether the colour is shown as it is, without any light.
    double_sided : bool
        Whether the file says that both sides are visible. Rays meet both sides in any case.
    name : str
        A name, which changes no picture: `Hits.names` has it. It need not be unique.
    kind : {"matte", "metal-rough", "glass"}, optional
        The model of the surface. If left out, it is ``matte``, or ``metal-rough`` where one of
        the numbers from ``metallic`` to ``sheen_roughness`` is given. Those, and ``absorption``,
        are ``None`` in materials of a kind that does not have them.
    metallic : float, optional
        Of ``metal-rough``, which is glTF's model: from 0, no metal, to 1. Default: 0.
    roughness : float, optional
        From 0, a mirror, to 1. Default: 0.5.
    ior : float, optional
        The index of refraction, of ``glass`` too. Default: 1.5.
    specular : float, optional
        How much of its reflection there is, of what is no metal: from 0 to 1, the default.
    specular_color : (3,) array_like or str, optional
        The colour of its reflection, of what is no metal. Default: white.
    transmission : float, optional
        How much of the light that is not reflected goes through: from 0, the default, to 1.
    solid : bool, optional
        Whether the surface is that of a solid, which refracts light, or a thin wall, the default.
    attenuation_color : (3,) array_like or str, optional
        The colour of white light after the attenuation distance inside a solid. Default: white.
    attenuation_distance : float, optional
        See ``attenuation_color``. Default: infinite.
    clearcoat, clearcoat_roughness : float, optional
        How much clear coat there is, and how rough it is: from 0, the default, to 1.
    clearcoat_normal_scale : float, optional
        How steep the normal map of the coat is. Default: 1.
    sheen_color : (3,) array_like or str, optional
        The colour of fibres, as of cloth. Default: black.
    sheen_roughness : float, optional
        From 0, smooth, the default, to 1.
    absorption : (3,) array_like, optional
        Of ``glass``: what is taken away inside for each unit of length; after a length d there is
        exp(-d times this) left. Default: nothing.
    emission : (3,) array_like or str
        The radiance that the surface gives off. An object of such a material is a light.
    metallic_roughness_texture : Texture, optional
        Green multiplies the roughness, blue the metallic. This one and the next ones are for meshes
        with ``uvs``. Of all but colours the levels are numbers, not sRGB.
    normal_texture, clearcoat_normal_texture : Texture, optional
        Normals of the surface and of its coat, in the space of the mesh's ``tangents``.
    occlusion_texture : Texture, optional
        Red says how much of the light from all around reaches the surface.
    emission_texture, specular_color_texture, sheen_color_texture : Texture, optional
        Colours that multiply those of the same name.
    transmission_texture, clearcoat_texture : Texture, optional
        Red multiplies the number of the same name.
    clearcoat_roughness_texture : Texture, optional
        Green multiplies the roughness of the coat.
    specular_texture, sheen_roughness_texture : Texture, optional
        Alpha multiplies the number of the same name.
    normal_scale : float
        How steep the normal map is.
    occlusion_strength : float
        How much the occlusion map counts, from 0 to 1.

    Raises
    ------
    ValueError
        For values that make no sense, with their name.
    TypeError
        For a texture that is no `Texture`, and flags that are not ``True`` or ``False``.

    Examples
    --------
    >>> fh.Material(color=(1, 0, 0), unlit=True).color
    (1.0, 0.0, 0.0)
    """

    color: Vector
    alpha: float
    texture: Texture | None
    alpha_texture: Texture | None
    alpha_mode: AlphaMode
    cutoff: float
    unlit: bool
    double_sided: bool
    name: str
    kind: MaterialKind
    metallic: float | None
    roughness: float | None
    ior: float | None
    specular: float | None
    specular_color: Vector | None
    transmission: float | None
    solid: bool | None
    attenuation_color: Vector | None
    attenuation_distance: float | None
    clearcoat: float | None
    clearcoat_roughness: float | None
    clearcoat_normal_scale: float | None
    sheen_color: Vector | None
    sheen_roughness: float | None
    absorption: Vector | None
    emission: Vector
    metallic_roughness_texture: Texture | None
    normal_texture: Texture | None
    occlusion_texture: Texture | None
    emission_texture: Texture | None
    transmission_texture: Texture | None
    specular_texture: Texture | None
    specular_color_texture: Texture | None
    clearcoat_texture: Texture | None
    clearcoat_roughness_texture: Texture | None
    clearcoat_normal_texture: Texture | None
    sheen_color_texture: Texture | None
    sheen_roughness_texture: Texture | None
    normal_scale: float
    occlusion_strength: float

    def __init__(
        self,
        color: npt.ArrayLike = (1.0, 1.0, 1.0),
        alpha: float = 1.0,
        texture: Texture | None = None,
        alpha_texture: Texture | None = None,
        alpha_mode: AlphaMode = "opaque",
        cutoff: float = 0.5,
        unlit: bool = False,  # noqa: FBT001, FBT002 - a material's words, mostly given by name
        double_sided: bool = True,  # noqa: FBT001, FBT002 - as above
        name: str = "",
        *,
        kind: MaterialKind | None = None,
        metallic: float | None = None,
        roughness: float | None = None,
        ior: float | None = None,
        specular: float | None = None,
        specular_color: npt.ArrayLike | None = None,
        transmission: float | None = None,
        solid: bool | None = None,
        attenuation_color: npt.ArrayLike | None = None,
        attenuation_distance: float | None = None,
        clearcoat: float | None = None,
        clearcoat_roughness: float | None = None,
        clearcoat_normal_scale: float | None = None,
        sheen_color: npt.ArrayLike | None = None,
        sheen_roughness: float | None = None,
        absorption: npt.ArrayLike | None = None,
        emission: npt.ArrayLike = (0.0, 0.0, 0.0),
        metallic_roughness_texture: Texture | None = None,
        normal_texture: Texture | None = None,
        occlusion_texture: Texture | None = None,
        emission_texture: Texture | None = None,
        transmission_texture: Texture | None = None,
        specular_texture: Texture | None = None,
        specular_color_texture: Texture | None = None,
        clearcoat_texture: Texture | None = None,
        clearcoat_roughness_texture: Texture | None = None,
        clearcoat_normal_texture: Texture | None = None,
        sheen_color_texture: Texture | None = None,
        sheen_roughness_texture: Texture | None = None,
        normal_scale: float = 1.0,
        occlusion_strength: float = 1.0,
    ) -> None:
        given = locals()
        settle(self, color=color_of("color", color), alpha=number("alpha", alpha))
        settle(self, alpha_mode=text("alpha_mode", alpha_mode), cutoff=number("cutoff", cutoff))
        if not 0 <= self.alpha <= 1:
            raise ValueError(f"alpha must be from 0 to 1, got {self.alpha}")
        if not math.isfinite(self.cutoff):
            raise ValueError(f"cutoff must be finite, got {self.cutoff}")
        settle(self, unlit=flag("unlit", unlit))
        settle(self, double_sided=flag("double_sided", double_sided), name=text("name", name))
        settle(self, emission=color_of("emission", emission, is_light=True))
        for strength in ("normal_scale", "occlusion_strength"):
            settle(self, **{strength: number(strength, given[strength])})
        for role in ("texture", "alpha_texture", *_TEXTURES):
            if not isinstance(given[role], Texture | None):
                raise TypeError(f"{role} must be a Texture, got {given[role]!r}")
            settle(self, **{role: given[role]})
        settings = [
            (key, checked(key, given[key]))
            for key, checked in _SETTINGS.items()
            if given[key] is not None
        ]
        usual = "metal-rough" if settings else "matte"
        settle(self, kind=usual if kind is None else text("kind", kind))
        everything = _firsthit.check_material(self._native(settings))
        settle(self, **(dict.fromkeys(_SETTINGS) | dict(everything)))

    def __repr__(self) -> str:
        """Show what is there, and not as in a plain material."""
        shown = [
            f"{each.name}={value!r}"
            for each in fields(self)
            if (value := getattr(self, each.name)) is not None and value != _PLAIN.get(each.name)
        ]
        return f"Material({', '.join(shown)})"

    def _settings(self) -> _firsthit._Settings:
        settings = [(name, getattr(self, name)) for name in _SETTINGS]
        return [(name, value) for name, value in settings if value is not None]

    def _native(self, settings: _firsthit._Settings | None = None) -> _firsthit._Material:
        textures = [(name.removesuffix("_texture"), getattr(self, name)) for name in _TEXTURES]
        return (
            self.color,
            self.alpha,
            self.texture._native() if self.texture else None,
            self.alpha_texture._native() if self.alpha_texture else None,
            self.alpha_mode,
            self.cutoff,
            self.unlit,
            self.double_sided,
            self.name,
            (self.kind, self._settings() if settings is None else settings),
            (self.emission, self.normal_scale, self.occlusion_strength),
            [(role, texture._native()) for role, texture in textures if texture is not None],
        )


def _radiance(name: str, value: npt.ArrayLike) -> Vector:
    return color_of(name, value, is_light=True)


#: The textures beside those of colour and alpha.
_TEXTURES = [
    each.name
    for each in fields(Material)
    if each.name.endswith("_texture") and each.name != "alpha_texture"
]
#: The settings of all kinds, and what checks a value; the native half knows which make sense.
_SETTINGS: dict[str, Callable[[str, Any], Any]] = {
    each.name: {"float": number, "bool": flag, "Vector": _radiance}[each.type.split(" |")[0]]
    for each in fields(Material)
    if each.type in ("float | None", "bool | None", "Vector | None")
}
#: Values that need not be shown.
_PLAIN = {each.name: each.default for each in signature(Material).parameters.values()}
_PLAIN |= {"color": None, "kind": "matte"}
_values = attrgetter(*(each.name for each in fields(Material)))

#: The materials of objects by what they are made of, and those that have only a colour by that, to
#: the bit: a zero with a sign is another number.
_known: WeakValueDictionary[bytes, Material] = WeakValueDictionary()


def colored(color: npt.ArrayLike) -> Material:
    """Return the material of a colour; one for all objects that have it."""
    made = color_of("color", color)
    key = marshal.dumps(made, 2)
    return _known.get(key) or _known.setdefault(key, Material(made))


def shared(material: Material) -> Material:
    """Return the material that objects were given already, if one is alike to the bit."""
    if type(material) is not Material:
        return material
    # A texture is known by its place: it stays there as long as the material that is kept.
    values = [id(each) if isinstance(each, Texture) else each for each in _values(material)]
    try:
        key = marshal.dumps(values, 2)
    except ValueError:
        # A name of a class that is not str itself.
        return material
    return _known.setdefault(key, material)
