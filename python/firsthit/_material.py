"""What surfaces look like, and where alpha masks cut them out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _firsthit
from ._arrays import color_of, flag, number, numbers, settle, text, vector

if TYPE_CHECKING:
    import numpy.typing as npt

    from ._types import AlphaMode, Filter, Vector, Wrap

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
        What is beyond the edges: beyond the left and the right one, and beyond the top and the
        bottom one.
    filter : {"linear", "nearest"}
        What is between texels: their weighted mean in linear light, or the nearest texel.
    picture_from_uv : (2, 3) array_like, optional
        The affine map from (u, v, 1) to the image's coordinates, which run from 0 at the left to 1
        at the right, and from 0 at the top to 1 at the bottom. If left out, it is (u, 1 - v).

    Raises
    ------
    ValueError
        For an array of a wrong shape or type, and for unknown words.
    TypeError
        For a ``wrap`` or a ``filter`` that is no word.

    Examples
    --------
    >>> import firsthit as fh
    >>> import numpy as np
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
        self._set(native, (across, down), text("filter", filter), rows)
        # Refused here, not at the first shot.
        Material(texture=self)

    def _set(
        self,
        texels: _firsthit.Texels,
        wrap: tuple[str, str],
        filter_name: str,
        rows: tuple[Vector, Vector],
    ) -> None:
        self._texels, self._wrap, self._filter, self._rows = texels, wrap, filter_name, rows

    @classmethod
    def _wrapped(
        cls,
        texels: _firsthit.Texels,
        wrap: tuple[str, str],
        filter_name: str,
        rows: tuple[Vector, Vector],
    ) -> Texture:
        made = cls.__new__(cls)
        made._set(texels, wrap, filter_name, rows)
        return made

    @property
    def texels(self) -> npt.NDArray[np.uint8]:
        """The texels, (rows, columns, 4) uint8, red, green, blue as sRGB and alpha: a copy."""
        return self._texels.array()

    @property
    def wrap(self) -> tuple[str, str]:
        """What is beyond the edges: beyond left and right, and beyond top and bottom."""
        return self._wrap

    @property
    def filter(self) -> str:
        """What is between texels: ``linear`` or ``nearest``."""
        return self._filter

    @property
    def picture_from_uv(self) -> npt.NDArray[np.float64]:
        """The map from (u, v, 1) to the image's coordinates, (2, 3) float64: a copy."""
        return np.array(self._rows)

    def _native(
        self,
    ) -> tuple[_firsthit.Texels, tuple[str, str], str, tuple[Vector, Vector]]:
        return self._texels, self._wrap, self._filter, self._rows

    def __repr__(self) -> str:
        rows, columns, _ = self.texels.shape
        return f"Texture({columns} x {rows} texels)"

    def __reduce__(self) -> tuple[Any, tuple[object, ...]]:
        """Pickle by value."""
        return _texture, (self.texels, self._wrap, self._filter, self._rows)


def _texture(texels: Any, wrap: Any, filter_name: Any, rows: Any) -> Texture:
    return Texture(texels, wrap=wrap, filter=filter_name, picture_from_uv=rows)


def _rows(picture_from_uv: npt.ArrayLike) -> tuple[Vector, Vector]:
    rows = numbers("picture_from_uv", picture_from_uv)
    if rows.shape != (2, 3) or not np.all(np.isfinite(rows)):
        raise ValueError(f"picture_from_uv must be (2, 3) and finite, got {rows.tolist()}")
    return vector("picture_from_uv", rows[0]), vector("picture_from_uv", rows[1])


@dataclass(frozen=True, init=False)
class Material:
    """What a surface looks like, and where an alpha mask cuts it out. Immutable.

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
        What alpha does. ``opaque``: nothing. ``mask``: it is an alpha mask; where it is below
        ``cutoff`` the surface is cut out, and rays do not meet it. ``blend``: the same as opaque,
        for now.
    cutoff : float
        The alpha from which on the surface is there.
    unlit : bool
        Whether the colour is shown as it is, without any light.
    double_sided : bool
        Whether the file says that both sides are visible. Rays meet both sides in any case.
    name : str
        A name, which changes no picture: `Hits.names` has it. It need not be unique.

    Raises
    ------
    ValueError
        For values that make no sense, with their name.
    TypeError
        For a texture that is no `Texture`, and flags that are not ``True`` or ``False``.

    Examples
    --------
    >>> import firsthit as fh
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
    ) -> None:
        settle(self, color=color_of("color", color), alpha=number("alpha", alpha))
        settle(self, texture=texture, alpha_texture=alpha_texture)
        settle(self, alpha_mode=text("alpha_mode", alpha_mode), cutoff=number("cutoff", cutoff))
        settle(self, unlit=flag("unlit", unlit))
        settle(self, double_sided=flag("double_sided", double_sided), name=text("name", name))
        for name in ("texture", "alpha_texture"):
            if not isinstance(getattr(self, name), Texture | None):
                raise TypeError(f"{name} must be a Texture, got {getattr(self, name)!r}")
        _firsthit.check_material(self._native())

    def _native(self) -> _firsthit._Material:
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
        )
