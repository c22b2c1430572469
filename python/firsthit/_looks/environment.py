"""Light from all around."""

from __future__ import annotations

import copyreg
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import (
    color_of,
    count,
    direction,
    flag,
    number,
    numbers,
    settle,
    vector,
    vectors,
)
from firsthit._base.errors import warn

from .lights import DirectionalLight, light_of

if TYPE_CHECKING:
    import os

    import numpy.typing as npt

    from firsthit.typing import Vector

    Turn = float | tuple[npt.ArrayLike, float]


class Environment:
    """Light from all around, from infinitely far away: a picture of all directions. Immutable.

    It lights a scene, and is what pictures show where nothing is hit: see `Scene.environment`, and
    `render` for one picture's own. The class methods make other ones: of one colour, of two, of a
    gradient, of an array, and daylight.

    The picture shows longitude across and latitude down. Its middle looks along +x where +y or +z
    is up; to the right of that is +z where +y is up, and -y where +z is.

    Parameters
    ----------
    file : path-like
        A picture in linear light, ``.hdr`` (Radiance) or ``.exr``.
    rotate : float or (axis, degrees)
        By how many degrees it is turned about up, counter-clockwise seen from above; or about any
        axis.
    strength : float
        The factor of its radiance.
    seen : bool
        Whether pictures show it in place of the background. It lights in any case.
    up : (3,) array_like, optional
        Which way is up. If left out, as in the scene.
    max_memory, max_texture : int
        As for `load`.

    Raises
    ------
    FileReadError, FileFormatError
        As `load`.
    ValueError
        For values that make no sense, with their name.
    MemoryError
        If the file needs more than ``max_memory``, or more than there is.

    Warns
    -----
    FirsthitWarning
        For texels that are negative or no numbers, which are taken as 0, and infinite ones, which
        are taken as 65,504.

    Examples
    --------
    >>> scene = fh.Scene()
    >>> ball = scene.add(fh.Sphere(center=(0, 0, 1), radius=1))
    >>> sky = fh.Environment.daylight(elevation=35, azimuth=60)
    >>> scene.environment = sky
    >>> scene.add_light(sky.sun())
    """

    _kind: str
    _vectors: tuple[Vector, ...]
    _numbers: tuple[float, ...]
    _map: _firsthit.EnvironmentMap | None
    strength: float
    seen: bool
    up: Vector | None

    def __init__(
        self,
        file: str | os.PathLike[str],
        *,
        rotate: Turn = 0.0,
        strength: float = 1.0,
        seen: bool = True,
        up: npt.ArrayLike | None = None,
        max_memory: int = 8 << 30,
        max_texture: int = 16384,
    ) -> None:
        axis, degrees = _turn(rotate)
        limits = count("max_memory", max_memory), min(count("max_texture", max_texture), 2**32 - 1)
        made, doubts = _firsthit.EnvironmentMap.read(Path(file), *limits)
        for doubt in doubts:
            warn(doubt)
        self._settle("map", axis, (degrees,), made, strength, seen, up)

    @classmethod
    def uniform(
        cls, color: npt.ArrayLike, *, strength: float = 1.0, seen: bool = True
    ) -> Environment:
        """Make the same light from everywhere.

        Parameters
        ----------
        color : (3,) array_like or str
            Its linear radiance, or sRGB as ``"#rrggbb"`` or a CSS name.
        strength, seen
            As for `Environment`.

        Raises
        ------
        ValueError
            For values that make no sense, with their name.
        """
        return cls._of(
            "uniform", (color_of("color", color, is_light=True),), (), None, strength, seen, None
        )

    @classmethod
    def hemispheres(
        cls,
        above: npt.ArrayLike,
        below: npt.ArrayLike,
        *,
        strength: float = 1.0,
        seen: bool = True,
        up: npt.ArrayLike | None = None,
    ) -> Environment:
        """Make one light from above the horizon and another from below.

        Parameters
        ----------
        above, below : (3,) array_like or str
            Their linear radiance, or sRGB as ``"#rrggbb"`` or a CSS name.
        strength, seen, up
            As for `Environment`.

        Raises
        ------
        ValueError
            For values that make no sense, with their name.
        """
        both = color_of("above", above, is_light=True), color_of("below", below, is_light=True)
        return cls._of("hemispheres", both, (), None, strength, seen, up)

    @classmethod
    def gradient(
        cls,
        horizon: npt.ArrayLike,
        zenith: npt.ArrayLike,
        *,
        strength: float = 1.0,
        seen: bool = True,
        up: npt.ArrayLike | None = None,
    ) -> Environment:
        """Make light that goes from the horizon's, which is that of all below too, to the zenith's.

        Parameters
        ----------
        horizon, zenith : (3,) array_like or str
            Their linear radiance, or sRGB as ``"#rrggbb"`` or a CSS name.
        strength, seen, up
            As for `Environment`.

        Raises
        ------
        ValueError
            For values that make no sense, with their name.
        """
        both = (
            color_of("horizon", horizon, is_light=True),
            color_of("zenith", zenith, is_light=True),
        )
        return cls._of("gradient", both, (), None, strength, seen, up)

    @classmethod
    def from_array(
        cls,
        texels: npt.ArrayLike,
        *,
        rotate: Turn = 0.0,
        strength: float = 1.0,
        seen: bool = True,
        up: npt.ArrayLike | None = None,
    ) -> Environment:
        """Make an environment of a picture in memory.

        Parameters
        ----------
        texels : (rows, columns, 3) array_like of float
            Linear radiance, finite and not negative, as float32; row 0 is up.
        rotate, strength, seen, up
            As for `Environment`.

        Raises
        ------
        ValueError
            For an array of a wrong shape or type, and values that make no sense.
        MemoryError
            If memory is short.
        """
        axis, degrees = _turn(rotate)
        array = numbers("texels", texels)
        if array.ndim != 3 or array.shape[2] != 3 or array.dtype.kind != "f":
            raise ValueError(
                "texels must be floats of shape (rows, columns, 3), "
                f"got {array.dtype} of shape {array.shape}"
            )
        made = _firsthit.EnvironmentMap(np.ascontiguousarray(array, np.float32))
        return cls._of("map", axis, (degrees,), made, strength, seen, up)

    @classmethod
    def daylight(
        cls,
        elevation: float = 45.0,
        azimuth: float = 0.0,
        *,
        turbidity: float = 3.0,
        ground: npt.ArrayLike = (0.2, 0.2, 0.2),
        strength: float = 1.0,
        seen: bool = True,
        up: npt.ArrayLike | None = None,
    ) -> Environment:
        """Make the sky of a clear day, after Preetham, Shirley and Smits (1999).

        It is exposed so that a white, level surface takes a luminance of 1 of the sky and of its
        sun, which is a light of its own: see `sun`.

        Parameters
        ----------
        elevation : float
            How high the sun stands, in degrees, from 0 to 90.
        azimuth : float
            How far around the sun stands, in degrees, counter-clockwise seen from above; where +z
            or +y is up, from +x.
        turbidity : float
            How hazy the air is, from 2, very clear, to 10.
        ground : (3,) array_like or str
            The share of light that the ground sends back, from 0 to 1.
        strength, seen, up
            As for `Environment`.

        Raises
        ------
        ValueError
            For values that make no sense, with their name.
        """
        angles = number("elevation", elevation), number("azimuth", azimuth)
        settings = *angles, number("turbidity", turbidity)
        albedo = color_of("ground", ground, is_light=True)
        return cls._of("daylight", (albedo,), settings, None, strength, seen, up)

    def sun(self, up: npt.ArrayLike = (0.0, 0.0, 1.0)) -> DirectionalLight:
        """Return the sun of `daylight`, 0.53 degrees wide, as bright as its sky says.

        Parameters
        ----------
        up : (3,) array_like
            Which way is up in the scene. If the environment says it itself, that holds.

        Returns
        -------
        DirectionalLight
            The light, to be added to a scene.

        Raises
        ------
        ValueError
            For an environment that is no daylight.
        """
        sun = self._sun(up)
        if sun is None:
            raise ValueError("only daylight has a sun")
        return sun

    def radiance(
        self, directions: npt.ArrayLike, *, up: npt.ArrayLike = (0.0, 0.0, 1.0)
    ) -> npt.NDArray[np.float64]:
        """Return the linear radiance from directions, as rays see it that meet nothing.

        Parameters
        ----------
        directions : (..., 3) array_like
            World space, of any length.
        up : (3,) array_like
            Which way is up in the scene. If the environment says it itself, that holds.

        Returns
        -------
        ndarray
            (..., 3) float64; 0 for a direction of no length.
        """
        given = vectors("directions", directions)
        rows = given.reshape(-1, 3).astype(np.float64).tolist()
        found = _firsthit.environment_radiance(self._native(), vector("up", up), rows)
        return found.reshape(given.shape)

    def _sun(self, up: npt.ArrayLike) -> DirectionalLight | None:
        """Return its sun, if it has one."""
        light = _firsthit.sun_of(self._native(), vector("up", up))
        sun = None if light is None else light_of(*light)
        assert isinstance(sun, DirectionalLight | None)
        return sun

    @classmethod
    def _of(cls, *parts: Any) -> Environment:
        made = object.__new__(cls)
        made._settle(*parts)
        return made

    def _settle(
        self,
        kind: str,
        directions: tuple[Vector, ...],
        settings: tuple[float, ...],
        texels: _firsthit.EnvironmentMap | None,
        strength: float,
        seen: bool,  # noqa: FBT001 - the order of the native half
        up: npt.ArrayLike | None,
    ) -> None:
        settle(self, _kind=kind, _vectors=tuple(directions), _numbers=tuple(settings), _map=texels)
        settle(self, strength=number("strength", strength), seen=flag("seen", seen))
        settle(self, up=None if up is None else direction("up", up))
        _firsthit.check_environment(self._native())

    def _native(self) -> _firsthit._Environment:
        made = self._kind, self._vectors, self._numbers, self._map
        return *made, self.strength, self.seen, self.up

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"an environment does not change: {name} cannot be set")

    def __repr__(self) -> str:
        kind = "map" if self._kind == "placed" else self._kind
        return f"Environment({kind}, strength={self.strength:g}, seen={self.seen})"


copyreg.pickle(_firsthit.EnvironmentMap, lambda made: (_firsthit.EnvironmentMap, (made.array(),)))


def environment_of(native: _firsthit._Environment) -> Environment:
    """Return the environment of a file."""
    return Environment._of(*native)


def _turn(rotate: Turn) -> tuple[tuple[Vector, ...], float]:
    """Return an axis, unless it is up, and degrees."""
    axis: tuple[Vector, ...] = ()
    if isinstance(rotate, tuple | list):
        if len(rotate) != 2:
            raise ValueError(f"rotate must be degrees, or an axis and degrees, got {rotate!r}")
        axis, rotate = (direction("rotate's axis", rotate[0]),), rotate[1]
    degrees = number("rotate", rotate)
    if not math.isfinite(degrees):
        raise ValueError(f"rotate must be finite, got {degrees}")
    return axis, degrees
