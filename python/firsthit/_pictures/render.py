"""Pictures of scenes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from firsthit._base.log import timed

from .picture import Picture

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator, Sequence

    import numpy.typing as npt

    from firsthit._files.frame import Frame
    from firsthit._looks.colors import Colors
    from firsthit._looks.edges import Edges
    from firsthit._looks.environment import Environment
    from firsthit._looks.lights import Sky
    from firsthit._looks.shading import Shader
    from firsthit._scene.scene import Scene
    from firsthit._sensors.sensor import Sensor
    from firsthit.typing import (
        Asked,
        ColorMapName,
        LightName,
        OwnShade,
        Progress,
        Selection,
        ShaderName,
        Side,
    )


def render(
    scene: Scene,
    camera: Sensor | None = None,
    *,
    channels: Asked | Sequence[Asked] = ("color",),
    background: Sky | npt.ArrayLike | None = None,
    environment: Environment | None = None,
    samples: int | None = None,
    noise: float | None = None,
    resume: str | os.PathLike[str] | None = None,
    region: tuple[slice, slice] | None = None,
    cull: Side | None = None,
    edges: Edges | float | None = None,
    objects: Selection | None = None,
    blend_below: float | None = None,
    shade: ShaderName | Shader | OwnShade | None = None,
    light: LightName | None = None,
    ground: bool | None = None,
    ambient: npt.ArrayLike | None = None,
    shadows: bool | None = None,
    color_by: str | npt.ArrayLike | Colors | None = None,
    color_map: ColorMapName | None = None,
    color_range: tuple[float, float] | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    dtype: npt.DTypeLike | None = None,
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
        other scenes it is `Camera.framing`. A scene without lights gets automatic light in the
        frame of a camera, of one that moves in the middle of the picture; with a `RaySensor` or a
        `Lidar` it has ambient light alone.
    channels : str or sequence of str
        Any of those that the table below lists; ``"attribute:NAME"`` for an attribute of the
        meshes, as `Hits.attribute` gives it; and ``"crypto_object:8"`` for a Cryptomatte of 8 pairs
        instead of 6.
    background : Sky, (3,) array_like or str, optional
        The colour of misses: a `Sky`, linear numbers, sRGB as ``"#rrggbb"``, a CSS name, or
        ``"transparent"``. If left out, `Scene.background`, or a dark blue grey where that is
        ``None``.
    environment : Environment, optional
        Light from all around in place of `Scene.environment`, which it is if left out. As there,
        `Scene.up` is up in it where it does not say so itself. Of `Environment.daylight` the sun
        shines, too, beside the scene's lights. It excludes ``light``, and that of `Scene.shading`
        does not count then.
    samples : int, optional
        The number of points of a pixel whose mean is its colour. They are the first ``samples``
        points of a fixed low-discrepancy sequence, the same in every pixel; the first is the
        centre. With a camera that has an aperture, each is a point of the lens too, and it takes at
        least 2. ``alpha``, ``ao`` and Cryptomattes are of the same samples. All other channels are
        those of the centre. If left out, this, ``shade``, ``light`` and ``ground`` are those of
        `Scene.shading`; where that does not say either, it is 16 with shaders that draw numbers
        and with a ground, and 4 with others.
    noise : float, optional
        A threshold: pixels take no more samples where the standard error of their brightness is
        below this, as a picture shows it from 0, black, to 1, white, before exposure and tone map;
        a transparent background counts as white. The error is checked after 32, 64, 128, ...
        samples, for tiles of 16 x 16 pixels. The channel ``samples`` has how
        many there were. ``samples`` are then the most of a pixel; 256 if nothing says otherwise.
        Only whole pictures by the library's shaders have a noise.
    resume : str or path, optional
        An ``.npz`` file in which the state of the picture is saved, every 20 seconds and at the
        end. If it exists, rendering resumes from it, after Ctrl-C or for more ``samples``, and the
        picture has the bytes of one that was made at once. Ctrl-C takes effect, and saves, after
        the sample that is on its way. The state of another scene, camera, light or noise is
        refused. Only pictures by the library's shaders have one, and only ``color``, ``alpha`` and
        ``samples`` resume; all else is made anew.
    region : tuple of two slices, optional
        The part of the picture to make: its rows and its columns, without steps, such as
        ``np.s_[100:200, :]``. Its numbers are those of the same part of the whole picture, bit for
        bit. The whole if left out.
    cull : {"front", "back"}, optional
        The side of surfaces that the camera's rays pass through: with ``"back"``, into a room
        through its walls. Rays of the shader, such as those to lights, meet both.
    edges : Edges, float or False, optional
        Lines along edges over the colours, also those of a function: an `Edges`, or the width of
        the usual ones in pixels. The channel ``edge`` has their coverage. Only a camera has them;
        one with an aperture is taken for a pinhole. If left out, `Scene.edges`, and where that is
        ``None`` there are none over the colours. ``False`` draws none whatever the scene has.
    objects : int, str, or sequence of them, optional
        The objects that are there, by identifiers or names. The others are not in the picture, and
        cast no shadows.
    blend_below : float, optional
        Take translucent surfaces of meshes (alpha mode ``blend``) as cut out where their alpha is
        below this, from 0 to 1, and as opaque elsewhere: in all channels, for colours too. If left
        out, colours show what is behind them, and all other channels show them as opaque.
    shade : str, Shader or callable, optional
        How hits get their colour: a shader's name, a `Shader` with settings, or a function. A
        function ``shade(hits)`` gets `Hits`, misses included, and returns their linear colours, of
        shape (..., 3); ``shade(hits, draws)`` gets numbers to draw too, see `Draws`. It may shoot
        rays of its own at the scene, all together. With one sample it is called once; with
        several it is called for each sample, and for parts of large pictures. It only sees the
        pixels of the region. ``background``, ``environment``, ``light``, ``ground``, ``ambient``,
        ``shadows`` and colours by numbers cannot be given with it. If left out, it is
        ``"direct"``, which then adds some light from all around to a scene with lights of its
        own and no environment. docs/shading.md has all shaders.
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
    color_map, color_range : optional
        Its ``map`` and ``range``.
    threads : int, optional
        The number of threads; all cores if left out. The result is the same for any number.
    progress : bool or callable, optional
        As for `Scene.shoot`; every sample of a pixel and every channel counts.
    dtype : {float64, float32}, optional
        The type of the channels that the table below says are float64: with float32 each number is
        the nearest one, but finite where it is finite, and zero only for zero. Float64 if left out.

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
        a camera with an aperture (its colours would be a pinhole's), an environment beside a
        ``light``, a region without pixels or with steps, and colours of a wrong shape from
        ``shade``.
    TypeError
        For a scene, a camera, an environment, a region, a shader or a flag of another type.
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
    >>> scene = fh.Scene()
    >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
    0
    >>> camera = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 45, rows=3, columns=3)
    >>> frame = fh.render(scene, camera, channels=("color", "z", "object"))
    >>> float(frame["z"][1, 1])
    4.0
    """
    picture = Picture.of(**locals())
    with timed("rendered %d x %d pixels", *picture.part.shape[::-1]):
        return picture.frame(progress)


def render_progressively(
    scene: Scene,
    camera: Sensor | None = None,
    *,
    channels: Asked | Sequence[Asked] = ("color",),
    background: Sky | npt.ArrayLike | None = None,
    environment: Environment | None = None,
    samples: int | None = None,
    region: tuple[slice, slice] | None = None,
    cull: Side | None = None,
    edges: Edges | float | None = None,
    objects: Selection | None = None,
    blend_below: float | None = None,
    shade: ShaderName | Shader | OwnShade | None = None,
    light: LightName | None = None,
    ground: bool | None = None,
    ambient: npt.ArrayLike | None = None,
    shadows: bool | None = None,
    color_by: str | npt.ArrayLike | Colors | None = None,
    color_map: ColorMapName | None = None,
    color_range: tuple[float, float] | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Iterator[Frame]:
    """Make a picture that gets better: frames with 1, 2, 4, ... samples, up to all of them.

    The last frame has the bytes of the one that `render` makes. A frame goes on from the one
    before: all together take about as long as the last alone. Whoever has seen enough stops.

    Parameters
    ----------
    scene, camera, channels, background, environment, samples, region, cull, edges, objects
        As for `render`. ``samples`` are those of the last frame. With a camera that has an aperture
        the first frame has 2. A function is called for each sample; with one it is called once.
    blend_below, shade, light, ground, ambient, shadows
        As for `render`.
    color_by, color_map, color_range, threads
        As for `render`.
    progress : bool or callable, optional
        As for `Scene.shoot`; what all frames take counts together.

    Returns
    -------
    iterator of Frame
        Each is made when it is asked for, and is nobody else's: none changes afterwards. They are
        of the scene as it is at the call, whatever becomes of it. Where no channel depends on
        samples, there is one frame.

    Raises
    ------
    ValueError, TypeError
        As `render`, at the call, before anything but one pixel is made.
    MemoryError
        If the picture does not fit into memory, with 44 bytes for each pixel beside it.

    Notes
    -----
    Ctrl-C ends a step at once. An iterator that was interrupted has ended; the frames that it gave
    stay as they are.

    ``ao`` and Cryptomattes are made anew for each frame, which takes twice as long in all. Channels
    of pixels' centres are made once, and are the same in all frames.

    Examples
    --------
    >>> scene = fh.Scene()
    >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
    0
    >>> camera = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 45, rows=3, columns=3)
    >>> for frame in fh.render_progressively(scene, camera, samples=6):
    ...     print(frame.metadata["samples"])
    1
    2
    4
    6
    >>> bool((frame["color"] == fh.render(scene, camera, samples=6)["color"]).all())
    True
    """
    picture = Picture.of(**locals())
    return picture.frames(progress)
