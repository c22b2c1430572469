"""The shading of hits."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, get_args

from firsthit import _firsthit
from firsthit._base.arrays import color_of, count, flag, number, one_of, settle, vector
from firsthit.typing import LightName, ShaderName

from .colors import Colors

if TYPE_CHECKING:
    from firsthit.typing import Vector

    Setting = bool | float | Vector


#: Points of a pixel where nobody says, of a function of one's own.
SAMPLES: int = _firsthit.defaults()[0]


@dataclass(frozen=True, init=False, repr=False)
class Shader:
    """A shader of the library, with its settings. Immutable.

    Parameters
    ----------
    name : str
        The shader's name: ``"direct"``, ``"lambert"``, ... docs/shading.md explains
        them all.
    **settings : bool, float, (3,) array_like or str
        Settings of the shader by their names; the usual ones if left out. Colours are linear
        numbers, or sRGB as ``"#rrggbb"`` or a CSS name.

    Raises
    ------
    ValueError
        For an unknown shader or setting, and for a value that makes no sense.
    TypeError
        For a setting of another type.

    Examples
    --------
    >>> shader = fh.Shader("path", depth=4)
    >>> shader
    Shader('path', depth=4.0, roulette=3.0)
    >>> shader["depth"]
    4.0
    """

    name: ShaderName
    settings: tuple[tuple[str, Setting], ...]

    def __init__(self, name: ShaderName, **settings: Any) -> None:
        one_of("shade", name, get_args(ShaderName))
        domains = dict(_firsthit.shader_settings(name))
        given = [(key, _value(key, domains, value)) for key, value in settings.items()]
        settle(self, name=name, settings=tuple(_firsthit.check_shader(name, given)))

    def __getitem__(self, name: str) -> Setting:
        """Return a setting by its name."""
        return dict(self.settings)[name]

    def __repr__(self) -> str:
        settings = "".join(f", {name}={value!r}" for name, value in self.settings)
        return f"Shader({self.name!r}{settings})"

    def __reduce__(self) -> tuple[Any, ...]:
        return partial(Shader, **dict[str, Any](self.settings)), (self.name,)


def _value(name: str, domains: dict[str, str], value: Any) -> Setting:
    """Return a value of a setting's form."""
    domain = domains.get(name)
    if domain is None:
        known = ", ".join(domains) or "none"
        raise ValueError(f"{name} is no setting of the shader; there are {known}")
    if domain == "flag":
        return flag(name, value)
    if domain == "number":
        return number(name, value)
    return color_of(name, value) if domain == "color" else vector(name, value)


@dataclass(frozen=True, init=False)
class Shading:
    """The default shading of hits: see `Scene.shading`. Immutable.

    A field that is ``None`` is decided by the scene and the camera, as `render` says.

    Parameters
    ----------
    shade : str or Shader, optional
        The shader.
    samples : int, optional
        The number of points of a pixel whose mean is its colour. See `render`.
    light : {"auto", "studio", "overcast", "sun", "headlight", "shoulder"}, optional
        Lights that go with the camera, in place of the scene's.
    ground : bool, optional
        Whether there is a ground that only shadows are seen of, under everything.
    colors : Colors, optional
        Colours by numbers, in place of those that surfaces have.
    **settings : bool, float, (3,) array_like or str
        Settings of the shader: ``ambient`` without a ``shade`` means ``"lambert"``, others mean
        ``"direct"``.

    Raises
    ------
    ValueError
        For an unknown shader, light or setting, a colour that makes no sense, and samples that are
        not from 1 to 4294967295.
    TypeError
        For flags that are not ``True`` or ``False``.
    """

    shade: Shader | None
    samples: int | None
    light: LightName | None
    ground: bool | None
    colors: Colors | None

    def __init__(
        self,
        shade: ShaderName | Shader | None = None,
        *,
        samples: int | None = None,
        light: LightName | None = None,
        ground: bool | None = None,
        colors: Colors | None = None,
        **settings: Any,
    ) -> None:
        if samples is not None:
            samples = count("samples", samples, 1, 2**32 - 1)
        if light is not None:
            one_of("light", light, get_args(LightName))
        if ground is not None:
            ground = flag("ground", ground)
        if colors is not None and not isinstance(colors, Colors):
            raise TypeError(f"colors must be Colors, got {colors!r}")
        shader = shader_of(shade, settings)
        settle(self, shade=shader, samples=samples, light=light, ground=ground, colors=colors)

    def _native(self) -> _firsthit._Shading:
        name = None if self.shade is None else self.shade.name
        settings = [] if self.shade is None else list(self.shade.settings)
        colors = None if self.colors is None else self.colors._native()
        return name, settings, self.light, self.ground, self.samples, colors

    def _but(self, **changes: Any) -> Shading:
        """Return the same with other values for those that are not ``None``."""
        own: dict[str, Any] = {"shade": self.shade, "samples": self.samples}
        own |= {"light": self.light, "ground": self.ground, "colors": self.colors}
        return Shading(
            **(own | {key: value for key, value in changes.items() if value is not None})
        )

    def _without_light(self) -> Shading:
        """Return the same for a picture that has an environment of its own."""
        return Shading(self.shade, samples=self.samples, ground=self.ground, colors=self.colors)


def shader_of(shade: ShaderName | Shader | None, settings: dict[str, Any]) -> Shader | None:
    """Return a shader with some of its settings replaced by those that are not ``None``."""
    given = {name: value for name, value in settings.items() if value is not None}
    if shade is None:
        if not given:
            return None
        shade = "lambert" if "ambient" in given else "direct"
    if isinstance(shade, Shader):
        return Shader(shade.name, **(dict(shade.settings) | given)) if given else shade
    return Shader(shade, **given)
