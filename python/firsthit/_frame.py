"""Pictures."""

from __future__ import annotations

import json
import os
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np

from . import _firsthit
from ._arrays import color_of, count, flag, number, text, threads_or_all
from ._camera import Camera
from ._errors import FileFormatError, FirsthitWarning
from ._files import distinct, files, is_cloud, is_of_several
from ._lights import Sky, background_native
from ._progress import following, later
from ._rays import Rays
from ._scene import Scene

if TYPE_CHECKING:
    from collections.abc import ItemsView, Iterator, KeysView, Sequence, ValuesView

    import numpy.typing as npt

    from ._hits import Hits
    from ._progress import Report
    from ._traceable import Built
    from .typing import (
        ChannelName,
        DistanceName,
        IdentifierName,
        OwnShade,
        Progress,
        ShaderName,
        VectorName,
    )

#: About how many rays an own shader sees at a time when there are several samples.
_BATCH = 1 << 18


#: The types of channels, as metadata name them, and those that an EXR holds as uint32.
_DTYPES = ("float64", "float32", "int32", "bool")
_AS_UINT32 = _DTYPES[2:]


class Frame:
    """A picture: named channels over the same pixels, row 0 at the top.

    ``frame["z"]`` is the array of a channel, of shape (rows, columns), or (rows, columns, k) where
    a pixel has several numbers. `render` lists the channels with their types, units and frames.
    ``items()``, ``keys()`` and ``values()`` are those of a dict. A notebook shows a frame as a
    picture.

    For type checkers, channels have the types that `render` gives them; those of a file may differ,
    see `load`.
    """

    def __init__(
        self,
        shape: tuple[int, int],
        channels: dict[str, npt.NDArray[Any]],
        origin: str = "{}",
        metadata: dict[str, Any] | None = None,
    ) -> None:
        self._shape, self._channels = shape, channels
        self._origin, self._metadata = origin, metadata

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Frame:
        """Read a picture from a file.

        Parameters
        ----------
        path : path-like
            ``.exr``, ``.npz``, ``.npy`` or ``.png``, written by `save`, by the program or by other
            software. Of ``.ply`` and ``.pcd`` `read_metadata` reads the metadata.

        Returns
        -------
        Frame
            With the channels as they are in the file: float32 from an EXR, distances from a PNG
            that was written with a scale, bytes from other PNGs. A channel that has no name in the
            file is called ``array``.

        Raises
        ------
        FileReadError
            If the system refuses to read it; also an `OSError`.
        FileFormatError
            If the content is wrong, or its metadata name a type that no channel has; also a
            `ValueError`.
        ValueError
            For an unknown extension, for a point cloud (``.ply``, ``.pcd``), which is a list of
            points, and for the hits of an array of rays: they are no pictures.

        Warns
        -----
        FirsthitWarning
            For what is doubtful in the file.
        """
        if is_cloud(path):
            raise ValueError(
                f"{os.fspath(path)} must hold a picture, got a point cloud, which is a list of "
                "points; read_metadata reads its metadata"
            )
        arrays, said, doubts = _firsthit.read(Path(path))
        for doubt in doubts:
            warnings.warn(f"{os.fspath(path)}: {doubt}", FirsthitWarning, stacklevel=2)
        metadata = None if said is None else json.loads(said)
        records = {} if metadata is None else {c["name"]: c for c in metadata["channels"]}
        channels = {}
        for name, shape, values, in_file in arrays:
            if len(shape) < 2:
                raise ValueError(f"{os.fspath(path)} must hold a picture, got the shape {shape}")
            dtype = in_file
            if name in records:
                # A stranger's words: NumPy knows types of a gigabyte, and of objects.
                computed = records[name]["dtype"]
                possible = _AS_UINT32 if in_file == "uint32" else _DTYPES
                if computed not in possible:
                    wanted = f"{', '.join(possible[:-1])} or {possible[-1]}"
                    raise _wrong(path, name, f"dtype must be {wanted}, got {computed!r}")
                if in_file == "uint32":
                    dtype = computed
            if values.dtype.kind == "f":
                dtype = str(values.dtype)
            channels[name or "array"] = values.astype(dtype, copy=False).reshape(shape)
        rows, columns = next((array.shape[:2] for array in channels.values()), (0, 0))
        return cls((rows, columns), channels, said or "{}", metadata)

    @property
    def metadata(self) -> dict[str, Any]:
        """What files of this frame say of it.

        That is: each channel's unit, frame, miss value and type; where pixel centres are; the
        camera, also as intrinsic matrix and pose; the scene's fingerprint; the version. A frame
        from a file has that file's metadata; they are empty for files of other programs.
        """
        if self._metadata is not None:
            return self._metadata
        if self._origin == "{}":
            return {}
        # Of one pixel: what is said depends on types and components alone.
        pixel = [(name, array[:1, :1].reshape(-1)) for name, array in self._channels.items()]
        made: dict[str, Any] = json.loads(_firsthit.metadata(self._shape, pixel, self._origin))
        return made

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, columns)."""
        return self._shape

    @property
    def channels(self) -> tuple[str, ...]:
        """The names of the channels, in their order."""
        return tuple(self._channels)

    @overload
    def __getitem__(self, name: Literal["color"]) -> npt.NDArray[np.float32]: ...

    @overload
    def __getitem__(self, name: DistanceName | VectorName) -> npt.NDArray[np.float64]: ...

    @overload
    def __getitem__(self, name: IdentifierName) -> npt.NDArray[np.int32]: ...

    @overload
    def __getitem__(self, name: Literal["front"]) -> npt.NDArray[np.bool_]: ...

    @overload
    def __getitem__(self, name: str) -> npt.NDArray[Any]: ...

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        """Return the array of a channel; a ``KeyError`` where there is no such channel."""
        if name not in self._channels:
            raise KeyError(f"no channel {name!r}; there are {', '.join(self._channels)}")
        return self._channels[name]

    def keys(self) -> KeysView[str]:
        """Return the channels' names, as of a dict."""
        return self._channels.keys()

    def values(self) -> ValuesView[npt.NDArray[Any]]:
        """Return the channels' arrays, as of a dict."""
        return self._channels.values()

    def items(self) -> ItemsView[str, npt.NDArray[Any]]:
        """Return names and arrays, as of a dict."""
        return self._channels.items()

    def __iter__(self) -> Iterator[str]:
        return iter(self._channels)

    def __contains__(self, name: object) -> bool:
        return name in self._channels

    def __len__(self) -> int:
        return len(self._channels)

    def __repr__(self) -> str:
        rows, columns = self._shape
        return f"Frame({columns} x {rows} pixels: {', '.join(self._channels)})"

    def save(self, path: str | os.PathLike[str], *, png_scale: float | None = None) -> None:
        """Write the frame to a file, whole or not at all.

        Parameters
        ----------
        path : path-like
            ``.exr`` and ``.npz`` hold all channels. ``.npy`` and ``.png`` hold one: the only one,
            or ``color``. With ``{channel}`` in the name each channel has a file of its own. NPY and
            NPZ are exact, with linear colours; an EXR is linear float32; a PNG is sRGB, and shows
            other channels in false colours. ``.ply`` and ``.pcd`` are point clouds: the pixels that
            hit something, with all channels, of which ``position`` must be one. Their colours are
            sRGB bytes; a PLY is exact otherwise, a PCD float32.
        png_scale : float, optional
            Write distances (``t``, ``range``, ``z``) to ``.png`` as 16 bit numbers, which count
            steps of this length in scene units; 0 is a miss. A distance beyond 65535 steps, or
            below half a step, is an error.

        Raises
        ------
        ValueError
            For an unknown extension, several channels for a file that takes one, ``{channel}`` in
            the name of a point cloud, or numbers that the format cannot hold.
        FileWriteError
            If the system refuses to write it; an old file is as it was. Also an `OSError`.
        """
        names = list(self._channels)
        if len(names) != 1 and not is_of_several(path):
            if "color" not in names:
                raise ValueError(
                    "path must end in .exr, .npz, .ply or .pcd, or contain {channel}, "
                    f"for several channels, got {os.fspath(path)}"
                )
            names = ["color"]
        for file, held in files(path, names):
            self._write(file, held, png_scale)

    def _write(self, path: Path, names: list[str], png_scale: float | None) -> None:
        channels = [(name, np.ascontiguousarray(self._channels[name]).ravel()) for name in names]
        scale = None if png_scale is None else number("png_scale", png_scale)
        _firsthit.write(path, list(self._shape), channels, self._origin, scale)

    def _repr_png_(self) -> bytes:
        name = "color" if "color" in self._channels else next(iter(self._channels))
        values = np.ascontiguousarray(self._channels[name]).ravel()
        return _firsthit.png(list(self._shape), name, values)


def render(
    scene: Scene,
    camera: Camera | None = None,
    *,
    channels: ChannelName | Sequence[ChannelName] = ("color",),
    background: Sky | npt.ArrayLike | None = None,
    samples: int | None = None,
    region: tuple[slice, slice] | None = None,
    shade: ShaderName | OwnShade | None = None,
    ambient: npt.ArrayLike | None = None,
    shadows: bool | None = None,
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
    camera : Camera, optional
        The camera. If left out, it is the first camera of a scene file (TOML); of other scenes it
        is `Camera.framing`.
    channels : str or sequence of str
        Any of those that the table below lists.
    background : Sky, (3,) array_like or str, optional
        The colour of misses: a `Sky`, linear numbers, sRGB as ``"#rrggbb"``, a CSS name, or
        ``"transparent"``. If left out, `Scene.background`, or a dark blue grey where that is
        ``None``.
    samples : int, optional
        The number of points of a pixel whose mean is its colour. They are the first ``samples``
        points of a fixed low-discrepancy sequence, the same in every pixel; the first is the
        centre. All other channels are those of the centre. If left out, this, ``shade``,
        ``ambient`` and ``shadows`` are those of `Scene.shading`.
    region : tuple of two slices, optional
        The part of the picture to make: its rows and its columns, without steps, such as
        ``np.s_[100:200, :]``. Its numbers are those of the same part of the whole picture, bit for
        bit. The whole if left out.
    shade : {"lambert", "unlit", "normal"} or callable, optional
        How hits get their colour. A function ``shade(hits)`` gets `Hits`, misses included, and
        returns their linear colours, of shape (..., 3). It is called for each sample, for parts of
        large pictures, and only for the pixels of the region. ``background``, ``ambient`` and
        ``shadows`` cannot be given with it.
    ambient : (3,) array_like or str, optional
        Ambient light of the shader ``lambert``, linear.
    shadows : bool, optional
        Whether objects cast shadows with the shader ``lambert``.
    threads : int, optional
        The number of threads; all cores if left out. The result is the same for any number.
    progress : bool or callable, optional
        As for `Scene.shoot`; every sample of a pixel and every channel counts.

    Returns
    -------
    Frame
        With the channels asked for, of the shape (rows, columns) of the region, or of the camera.

    Raises
    ------
    ValueError
        For no channel, an unknown channel or shader, a value out of range, a region without pixels
        or with steps, and colours of a wrong shape from ``shade``.
    TypeError
        For a scene, a camera, a region or a flag of another type.
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
    ``normal``                       3 float64          length one, world      nan
    ``position``                     3 float64          length, world          nan
    ``barycentric``                  3 float64          weights of corners     nan
    ``uv``                           2 float64          texture coordinates    nan
    ``front``                        bool               the front was met      False
    ===============================  =================  =====================  ================

    Lengths are in scene units. ``t`` counts from the ray's start; ``range`` from the camera's
    position along the ray; ``z`` from the camera's position along its aim. With a transparent
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
    if not isinstance(scene, Scene) or not isinstance(camera, Camera | None):
        raise TypeError("render takes a Scene and a Camera")
    names, said = _names(channels), scene.shading
    given = {"background": background, "ambient": ambient, "shadows": shadows}
    if shade is not None and not isinstance(shade, str):
        for name, value in given.items():
            if value is not None:
                raise ValueError(f"{name} does nothing with a shade of one's own; leave it out")
    shade = said.shade if shade is None else shade
    ambient = said.ambient if ambient is None else ambient
    shadows = said.shadows if shadows is None else shadows
    many = said.samples if samples is None else count("samples", samples)
    use = threads_or_all(threads)
    if not 1 <= many < 2**32:
        raise ValueError(f"samples must be from 1 to 4294967295, got {many}")
    background = scene.background if background is None else background
    back = None if background is None else background_native(background)
    light = None if ambient is None else color_of("ambient", ambient)
    own = None if isinstance(shade, str) else shade
    shader = text("shade", shade) if isinstance(shade, str) else "unlit"
    shading = (shader, back, light, flag("shadows", shadows))
    asked = [name for name in names if own is None or name != "color"]
    camera = scene._view() if camera is None else camera
    part = _part(region, (camera.rows, camera.columns))
    shape = (part[1] - part[0], part[3] - part[2])
    work = _firsthit.render_work(shape[0] * shape[1], asked, many)
    owned = shape[0] * shape[1] * many if own is not None and "color" in names else 0
    built = scene._ready()
    with following(progress, work + owned) as report:
        how = shading, many, part, use
        arrays, origin = _firsthit.render(built.native, camera._native, asked, *how, report)
        made = {name: _shaped(array, shape) for name, array in zip(asked, arrays, strict=True)}
        if own is not None and "color" in names:
            told = later(report, work)
            colors = _own_colors((scene, built), (camera, part), own, (many, use), told)
            made["color"] = np.ascontiguousarray(colors)
    return Frame(shape, {name: made[name] for name in names}, origin)


def read_metadata(path: str | os.PathLike[str]) -> dict[str, Any] | None:
    """Read what an output says of itself.

    Parameters
    ----------
    path : path-like
        ``.exr``, ``.npz``, ``.npy`` (whose metadata are in ``NAME.npy.json``), ``.png``, ``.ply``
        or ``.pcd``.

    Returns
    -------
    dict or None
        As `Frame.metadata`, and how the file stores each channel; ``None`` for a file without
        metadata. ``docs/outputs.md`` and the JSON Schema beside it say what every entry means.

    Raises
    ------
    FileReadError, FileFormatError
        As `Frame.load`.
    ValueError
        For an unknown extension.

    Warns
    -----
    FirsthitWarning
        For what is doubtful in the file.
    """
    _, said, doubts = _firsthit.read(Path(path))
    for doubt in doubts:
        warnings.warn(f"{os.fspath(path)}: {doubt}", FirsthitWarning, stacklevel=2)
    return None if said is None else json.loads(said)


def _wrong(path: str | os.PathLike[str], name: str | None, what: str) -> FileFormatError:
    text = os.fspath(path)
    return FileFormatError(f"{text}: metadata of channel {name!r}: {what}", text)


def _names(channels: ChannelName | Sequence[ChannelName]) -> list[str]:
    known: list[str] = [name for name, _ in _firsthit.channel_names()]
    return distinct(channels, known)


def _shaped(array: npt.NDArray[Any], shape: tuple[int, int]) -> npt.NDArray[Any]:
    components = array.size // max(shape[0] * shape[1], 1)
    return array.reshape(shape if components == 1 else (*shape, components))


def _part(region: object, shape: tuple[int, int]) -> tuple[int, int, int, int]:
    """Return the first row and the one behind the last, and likewise the columns."""
    if region is None:
        return 0, shape[0], 0, shape[1]
    slices = tuple(region) if isinstance(region, tuple | list) else (region,)
    if len(slices) != 2 or not all(isinstance(each, slice) for each in slices):
        raise TypeError(f"region must be two slices, of rows and of columns, got {region!r}")
    ends = [each.indices(length) for each, length in zip(slices, shape, strict=True)]
    if any(step != 1 or first >= last for first, last, step in ends):
        raise ValueError(f"region must have pixels, and no steps, got {region!r}")
    (top, bottom, _), (left, right, _) = ends
    return top, bottom, left, right


def _colors(shade: OwnShade, hits: Hits) -> npt.NDArray[np.float64]:
    colors = np.asarray(shade(hits), dtype=np.float64)
    wanted = (*hits.shape, 3)
    if colors.shape != wanted:
        raise ValueError(f"shade must return colours of shape {wanted}, got {colors.shape}")
    return colors


def _own_colors(
    scenes: tuple[Scene, Built],
    seen: tuple[Camera, tuple[int, int, int, int]],
    shade: OwnShade,
    how: tuple[int, int],
    report: Report | None,
) -> npt.NDArray[np.float32]:
    (scene, built), (camera, part), (samples, threads) = scenes, seen, how
    if samples == 1:
        is_whole = part == _part(None, (camera.rows, camera.columns))
        hits = (
            scene._shot_by(built, camera, threads, report)
            if is_whole
            else scene._shot_part(built, (camera, part), threads, report)
        )
        return _colors(shade, hits).astype(np.float32)
    top, bottom, left, right = part
    colors = np.empty((bottom - top, right - left, 3), np.float32)
    # The rays of whole rows are made, of which those of the region are shot.
    step = max(1, _BATCH // camera.columns)
    done = 0
    for row in range(top, bottom, step):
        last = min(row + step, bottom)
        total = np.zeros((last - row, right - left, 3))
        for sample in range(samples):
            both = camera._native.rays((row, last), sample)
            grids = (array.reshape(last - row, camera.columns, 3) for array in both)
            rays = Rays.of(*(grid[:, left:right] for grid in grids))
            hits = scene._shot(built, rays, threads, later(report, done))
            hits._camera = camera
            total += _colors(shade, hits)
            done += rays.length
        colors[row - top : last - top] = total / samples
    return colors
