"""Pictures of scenes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import _firsthit
from ._arrays import threads_or_all
from ._camera import Camera
from ._colors import Colors, colors_of
from ._draws import Draws, takes_draws
from ._edges import Edges
from ._files import distinct, matte_of
from ._filters import Filters
from ._frame import Frame
from ._lights import Sky, background_native
from ._progress import following, later
from ._queries import shoot_camera, shoot_rays
from ._rays import Rays
from ._scene import Scene
from ._sensor import Sensor
from ._shading import SAMPLES, Shader, Shading, shader_of
from ._source import Source

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    import numpy.typing as npt

    from ._hits import Hits
    from ._progress import Report
    from ._traceable import Built
    from ._types import Asked, Selection, Side
    from .typing import ColorMapName, LightName, OwnShade, Progress, ShaderName

#: About how many rays an own shader sees at a time when there are several samples.
_BATCH = 1 << 18


def render(
    scene: Scene,
    camera: Sensor | None = None,
    *,
    channels: Asked | Sequence[Asked] = ("color",),
    background: Sky | npt.ArrayLike | None = None,
    samples: int | None = None,
    region: tuple[slice, slice] | None = None,
    cull: Side | None = None,
    edges: Edges | float | None = None,
    objects: Selection | None = None,
    shade: ShaderName | Shader | OwnShade | None = None,
    light: LightName | None = None,
    ground: bool | None = None,
    ambient: npt.ArrayLike | None = None,
    shadows: bool | None = None,
    color_by: str | npt.ArrayLike | Colors | None = None,
    color_map: ColorMapName | None = None,
    color_range: tuple[float, float] | None = None,
    color_bar: bool | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Frame:
    """Make a picture.

    ``fh.render(fh.load(path)).save("out.png")`` writes the picture that the program makes of the
    same file.

    Parameters
    ----------
    scene : Scene
        The scene.
    camera : Camera or another sensor, optional
        The camera, or any `Sensor`. If left out, it is the first camera of a scene file (TOML); of
        other scenes it is `Camera.framing`. A scene without lights is lit over the shoulder of a
        camera, of one that moves in the middle of the picture; with a `RaySensor` or a `Lidar` it
        has ambient light alone.
    channels : str or sequence of str
        Any of those that the table below lists; ``"attribute:NAME"`` for an attribute of the
        meshes, as `Hits.attribute` gives it; and ``"crypto_object:8"`` for a Cryptomatte of 8 pairs
        instead of 6.
    background : Sky, (3,) array_like or str, optional
        The colour of misses: a `Sky`, linear numbers, sRGB as ``"#rrggbb"``, a CSS name, or
        ``"transparent"``. If left out, `Scene.background`, or a dark blue grey where that is
        ``None``.
    samples : int, optional
        The number of points of a pixel whose mean is its colour. They are the first ``samples``
        points of a fixed low-discrepancy sequence, the same in every pixel; the first is the
        centre. With a camera that has an aperture, each is a point of the lens too, and it takes at
        least 2. ``alpha``, ``ao`` and Cryptomattes are of the same samples. All other channels are
        those of the centre. If left out, this, ``shade``, ``light`` and ``ground`` are those of
        `Scene.shading`; where that does not say either, it is 16 with shaders that draw numbers,
        and 4 with others.
    region : tuple of two slices, optional
        The part of the picture to make: its rows and its columns, without steps, such as
        ``np.s_[100:200, :]``. Its numbers are those of the same part of the whole picture, bit for
        bit. The whole if left out.
    cull : {"front", "back"}, optional
        The side of surfaces that the camera's rays pass through: with ``"back"``, into a room
        through its walls. Rays of the shader, such as those to lights, meet both.
    edges : Edges or float, optional
        Lines along edges over the colours, also those of a function: an `Edges`, or the width of
        the usual ones in pixels. The channel ``edge`` has their coverage. Only a camera has them;
        one with an aperture is taken for a pinhole. If left out, `Scene.edges`, and where that is
        ``None`` there are none over the colours.
    objects : int, str, or sequence of them, optional
        What is there, by identifiers or names. The others are not in the picture, and cast no
        shadows.
    shade : str, Shader or callable, optional
        How hits get their colour: a shader's name, a `Shader` with settings, or a function. A
        function ``shade(hits)`` gets `Hits`, misses included, and returns their linear colours, of
        shape (..., 3); ``shade(hits, draws)`` gets numbers to draw too, see `Draws`. It may shoot
        rays of its own at the scene, all together. With one sample it is called once; with
        several it is called for each sample, and for parts of large pictures. It only sees the
        pixels of the region. ``background``, ``light``, ``ground``, ``ambient`` and ``shadows``
        cannot be given with it. If left out, it is ``"direct"``; see docs/shading.md for all.
    light : {"auto", "studio", "overcast", "sun", "headlight", "shoulder"}, optional
        Lights that go with the camera, in place of the scene's. If left out, ``"auto"`` where
        nothing shines.
    ground : bool, optional
        Whether there is a ground that only shadows are seen of, under everything. If left out, it
        is there with automatic light and a camera above it that is outside of the scene.
    ambient : (3,) array_like or str, optional
        Ambient light, linear, of a shader that has that setting; without a ``shade``, of
        ``lambert``.
    shadows : bool, optional
        Whether objects cast shadows, of a shader that has that setting.
    color_by : str, (n,) array_like of float or Colors, optional
        Colour surfaces by numbers, in place of their own colours: see `Colors`, which it may be as
        a whole. If left out, ``colors`` of `Scene.shading`.
    color_map, color_range, color_bar : optional
        Its ``map``, ``range`` and ``bar``.
    threads : int, optional
        The number of threads; all cores if left out. The result is the same for any number.
    progress : bool or callable, optional
        As for `Scene.shoot`; every sample of a pixel and every channel counts.

    Returns
    -------
    Frame
        With the channels asked for, of the shape (rows, columns) of the region, or of the camera.
        Colours are linear and of any brightness; `Frame.display`, by which PNGs show them, is
        `Scene.display`.

    Raises
    ------
    ValueError
        For no channel, an unknown channel, attribute or shader, a value out of range, one sample of
        a camera with an aperture (its colours would be a pinhole's), a region
        without pixels or with steps, and colours of a wrong shape from ``shade``.
    TypeError
        For a scene, a camera, a region, a shader or a flag of another type.
    MemoryError
        If the picture does not fit into memory.

    Notes
    -----
    ===============================  =================  =====================  ================
    channel                          type               unit and frame         a miss
    ===============================  =================  =====================  ================
    ``color``                        3 or 4 float32     linear Rec. 709        the background
    ``t``                            float64            length, along the ray  inf
    ``range``, ``z``                 float64            length, camera         inf
    ``object``, ``primitive``        int32              identifier             -1
    ``face``                         int32              identifier             -1
    ``node``, ``mesh``               int32              identifier, see below  -1
    ``material``                     int32              identifier, see below  -1
    ``normal``                       3 float64          length one, world      nan
    ``incidence``                    float64            radian                 nan
    ``position``                     3 float64          length, world          nan
    ``barycentric``                  3 float64          weights of corners     nan
    ``uv``                           2 float64          texture coordinates    nan
    ``base_color``                   3 float64          linear Rec. 709        nan
    ``attribute:NAME``               any float64        the attribute's        nan
    ``front``                        bool               the front was met      False
    ``valid``                        bool               the pixel has a ray    either
    ``edge``                         float32            coverage, 0 to 1       either
    ``alpha``                        float32            coverage               0, or shadow
    ``ao``                           float32            share of the sky       1
    ``samples``                      int32              number of samples      as others
    ``crypto_object``                12 float32         Cryptomatte            0
    ``crypto_material``              12 float32         Cryptomatte            0
    ===============================  =================  =====================  ================

    A node is one of the file's tree, a mesh one of the file, whose parts may be several objects,
    and materials that are alike in name and look are one. An object is itself an instance: of a
    mesh, at a node. ``frame.metadata["names"]`` has the names of what identifiers stand for, and so
    has `Hits.names`.

    A Cryptomatte has pairs of an identifier, which is the hash of a name, and the share of the
    pixel's samples that it covers, the largest share first: mattes with soft edges. `Frame.matte`
    takes one out; ``.exr`` and ``.npz`` hold them, for compositing programs too.

    Lengths are in scene units. ``t`` counts from the ray's start; ``range`` from the camera's
    position along the ray; ``z`` from the camera's position along its aim, which a `Lidar` and a
    `RaySensor` without an aim do not have. With a transparent
    background ``color`` has four numbers: the last is alpha, the pixel's coverage, and the others
    are premultiplied by it.

    Examples
    --------
    >>> import firsthit as fh
    >>> scene = fh.Scene()
    >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
    0
    >>> camera = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 45, rows=3, columns=3)
    >>> frame = fh.render(scene, camera, channels=("color", "z", "object"))
    >>> float(frame["z"][1, 1])
    4.0
    """
    if not isinstance(scene, Scene) or not isinstance(camera, Sensor | None):
        raise TypeError("render takes a Scene and a Camera or another sensor")
    names, said = _names(channels), scene.shading
    own = None if shade is None or isinstance(shade, str | Shader) else shade
    if own is not None and not callable(own):
        raise TypeError(f"shade must be the name of a shader or a function, got {own!r}")
    given: dict[str, Any] = {"background": background, "light": light, "ground": ground}
    given |= {"ambient": ambient, "shadows": shadows, "color_by": color_by}
    given |= {"color_map": color_map, "color_range": color_range, "color_bar": color_bar}
    if own is not None:
        for name, value in given.items():
            if value is not None:
                raise ValueError(f"{name} does nothing with a shade of one's own; leave it out")
    shader = shade if isinstance(shade, str | Shader) else said.shade
    if ambient is not None and said.shade is None and shade is None:
        shader = "lambert"
    shader = shader_of(shader, {"ambient": ambient, "shadows": shadows})
    numbers = {"map": color_map, "range": color_range, "bar": color_bar}
    colors = colors_of(said.colors, color_by, **numbers)
    look = said._but(shade=shader, samples=samples, light=light, ground=ground, colors=colors)
    use = threads_or_all(threads)
    background = scene.background if background is None else background
    back = None if background is None else background_native(background)
    if own is not None:
        samples = SAMPLES if look.samples is None else look.samples
        look = Shading("unlit", samples=samples, ground=False)
    usual = scene.edges if camera is None or isinstance(camera, Camera) else None
    lines = Edges._of(usual if edges is None else edges)
    asked = [name for name in names if own is None or name != "color"]
    # The library draws over its own colours alone.
    if own is not None and lines is not None and "color" in names and "edge" not in asked:
        asked.append("edge")
    camera = scene._view() if camera is None else camera
    built, filters = scene._seen(scene._ready(), None, objects), Filters.of(None, cull, None)
    how = look._native(), scene.up
    samples, _guessed = _firsthit.resolve(built.native, camera._native, *how)
    if own is not None and "color" in names:
        _firsthit.check_samples(camera._native, samples)
    part = _Region.of(region, (camera.rows, camera.columns))
    pixels = math.prod(part.shape)
    work = _firsthit.render_work(pixels, asked, samples)
    owned = pixels * samples if own is not None and "color" in names else 0
    side = None if filters is None else filters.cull
    with following(progress, work + owned) as report:
        drawn = None if lines is None else lines._native()
        settings = look._native(), back, scene.up, samples, part, side, drawn, use
        arrays, origin = _firsthit.render(built.native, camera._native, asked, *settings, report)
        made = {name: _shaped(array, part) for name, array in zip(asked, arrays, strict=True)}
        if own is not None and "color" in names:
            job = _OwnShading(built, filters, camera, part, own, use)
            told = later(report, work)
            made["color"] = job.centres(told) if samples == 1 else job.means(samples, told)
            if lines is not None:
                made["color"] = _under(made["edge"], lines, made["color"])
    held = {matte_of(name) or name: made[name] for name in names}
    return Frame._of(part.shape, held, origin, display=scene.display)


def _names(channels: str | Sequence[str]) -> list[str]:
    known: list[str] = [name for name, _ in _firsthit.channel_names()]
    return distinct(channels, known)


def _under(
    covered: npt.NDArray[np.float32], lines: Edges, color: npt.NDArray[np.float32]
) -> npt.NDArray[np.float32]:
    """Return colours with lines over them."""
    share = covered[..., np.newaxis].astype(np.float64)
    mixed: npt.NDArray[np.float64] = (1 - share) * color + share * np.asarray(lines.color)
    return mixed.astype(np.float32)


def _shaped(array: npt.NDArray[Any], part: _Region) -> npt.NDArray[Any]:
    components = array.size // max(math.prod(part.shape), 1)
    return array.reshape(part.shape if components == 1 else (*part.shape, components))


class _Region(NamedTuple):
    """A part of a picture: its first row and the one behind its last, and likewise its columns."""

    top: int
    bottom: int
    left: int
    right: int

    @classmethod
    def of(cls, region: object, shape: tuple[int, int]) -> _Region:
        """Check what a user gave, for pictures of a shape."""
        if region is None:
            return cls(0, shape[0], 0, shape[1])
        slices = tuple(region) if isinstance(region, tuple | list) else (region,)
        if len(slices) != 2 or not all(isinstance(each, slice) for each in slices):
            raise TypeError(f"region must be two slices, of rows and of columns, got {region!r}")
        try:
            ends = [each.indices(length) for each, length in zip(slices, shape, strict=True)]
        except (TypeError, ValueError) as error:
            raise type(error)(f"region must be two slices of int: {error}") from None
        if any(step != 1 or first >= last for first, last, step in ends):
            raise ValueError(f"region must have pixels, and no steps, got {region!r}")
        (top, bottom, _), (left, right, _) = ends
        return cls(top, bottom, left, right)

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, columns)."""
        return self.bottom - self.top, self.right - self.left


class _OwnShading(NamedTuple):
    """The colours that a user's function gives to the pixels of a region."""

    built: Built
    filters: Filters | None
    camera: Sensor
    region: _Region
    shade: OwnShade
    threads: int

    def centres(self, report: Report | None) -> npt.NDArray[np.float32]:
        """Return the colours of the pixels' centres."""
        camera = self.camera
        is_whole = self.region == _Region(0, camera.rows, 0, camera.columns)
        if is_whole and self.filters is None:
            hits = shoot_camera(self.built, camera, self.threads, report)
        else:
            source = Source(camera, self._pixels(self.region.top, self.region.bottom).reshape(-1))
            grids = (array.reshape(*self.region.shape, 3) for array in source.both())
            rays = Rays.of(*grids, filters=self.filters)
            hits = shoot_rays(self.built, rays, self.threads, report, source)
        pixels = self._pixels(self.region.top, self.region.bottom)
        return np.ascontiguousarray(self._colors(hits, pixels, 0), np.float32)

    def means(self, samples: int, report: Report | None) -> npt.NDArray[np.float32]:
        """Return the means of the colours at so many points of each pixel."""
        (top, bottom, left, right), camera = self.region, self.camera
        colors = np.empty((*self.region.shape, 3), np.float32)
        # The rays of whole rows are made, of which those of the region are shot.
        step = max(1, _BATCH // camera.columns)
        done = 0
        for row in range(top, bottom, step):
            last = min(row + step, bottom)
            pixels = self._pixels(row, last)
            total = np.zeros((*pixels.shape, 3))
            for sample in range(samples):
                both = camera._native.rays((row, last), sample)
                grids = (array.reshape(last - row, camera.columns, 3) for array in both)
                grids = (grid[:, left:right] for grid in grids)
                rays = Rays.of(*grids, filters=self.filters)
                source = Source(camera, pixels.reshape(-1), rays)
                told = later(report, done)
                hits = shoot_rays(self.built, rays, self.threads, told, source)
                total += self._colors(hits, pixels, sample)
                done += rays.length
            colors[row - top : last - top] = total / samples
        return colors

    def _pixels(self, row: int, last: int) -> npt.NDArray[np.int64]:
        """Return the numbers of the region's pixels in some rows."""
        columns = np.arange(self.region.left, self.region.right)
        return np.arange(row, last)[:, None] * self.camera.columns + columns

    def _colors(
        self, hits: Hits, pixels: npt.NDArray[np.int64], sample: int
    ) -> npt.NDArray[np.float64]:
        shade: Callable[..., npt.ArrayLike] = self.shade
        given = shade(hits, Draws(pixels, sample)) if takes_draws(shade) else shade(hits)
        colors = np.asarray(given)
        wanted = (*hits.shape, 3)
        if colors.dtype.kind not in "fiub":
            raise ValueError(f"shade must return real numbers, got dtype {colors.dtype}")
        if colors.shape != wanted:
            raise ValueError(f"shade must return colours of shape {wanted}, got {colors.shape}")
        return colors.astype(np.float64, copy=False)
