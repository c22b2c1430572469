"""How hits get their colour."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, get_args

from . import _firsthit
from ._arrays import color_of, count, flag, settle
from ._types import ShaderName

if TYPE_CHECKING:
    import numpy.typing as npt

    from ._types import Vector

_SHADERS = get_args(ShaderName)

#: Points of a pixel where nobody says, the program's own.
SAMPLES: int = _firsthit.defaults()[0]


@dataclass(frozen=True, init=False)
class Shading:
    """How hits get their colour, by default: see `Scene.shading`. Immutable.

    Parameters
    ----------
    shade : {"lambert", "unlit", "normal"}
        The shader.
    ambient : (3,) array_like or str, optional
        Ambient light of the shader ``lambert``: linear numbers, or sRGB as ``"#rrggbb"`` or a CSS
        name; (0.25, 0.25, 0.25) if left out.
    shadows : bool
        Whether objects cast shadows with the shader ``lambert``.
    samples : int
        The number of points of a pixel whose mean is its colour; 4 if left out. See `render`.

    Raises
    ------
    ValueError
        For an unknown shader, a colour that makes no sense, and samples that are not from 1 to
        4294967295.
    TypeError
        For ``shadows`` that are not ``True`` or ``False``.
    """

    shade: ShaderName
    ambient: Vector | None
    shadows: bool
    samples: int

    def __init__(
        self,
        shade: ShaderName = "lambert",
        ambient: npt.ArrayLike | None = None,
        shadows: bool = True,  # noqa: FBT001, FBT002 - as scene files have it, mostly given by name
        samples: int = SAMPLES,
    ) -> None:
        if not isinstance(shade, str) or shade not in _SHADERS:
            raise ValueError(f"shade must be one of {', '.join(_SHADERS)}, got {shade!r}")
        many = count("samples", samples)
        if not 1 <= many < 2**32:
            raise ValueError(f"samples must be from 1 to 4294967295, got {many}")
        light = None if ambient is None else color_of("ambient", ambient)
        settle(self, shade=shade, ambient=light, shadows=flag("shadows", shadows), samples=many)
