"""Pictures."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import count, text
from firsthit._base.hints import channel_hint
from firsthit._base.optional import optional
from firsthit._looks.display import Display, as_display

from .channels import files, is_of_one, matte_of, stored
from .frame_file import channel_array, in_file, read_channels, write_channels
from .plot import Plottable

if TYPE_CHECKING:
    from collections.abc import ItemsView, Iterator, KeysView, Sequence, ValuesView

    import numpy.typing as npt
    import xarray

    from firsthit.typing import (
        AngleName,
        DistanceName,
        Far,
        IdentifierName,
        MatteName,
        ToneMapName,
        VectorName,
    )


class Frame(Plottable):
    """A picture: named channels over the same pixels, row 0 at the top.

    ``frame["z"]`` is the array of a channel, of shape (rows, columns), or (rows, columns, k) where
    a pixel has several numbers. `render` lists the channels with their types, units and frames.
    ``items()``, ``keys()`` and ``values()`` are those of a dict. A notebook shows a frame as a
    picture.

    For type checkers, channels have the types that `render` gives them; those of a file may differ,
    see `load`.

    Parameters
    ----------
    shape : pair of int
        Rows and columns.
    channels : mapping of str to (rows, columns) or (rows, columns, k) array_like
        The numbers of each pixel, as bool, integers or floats; arrays are not copied. Names that
        `render` lists say how a channel is shown and what a miss is; numbers under any other name
        are your own. Files hold integers as int32, and ``_`` in the place of characters of a name
        that are no letters, digits, ``.``, ``-`` or ``_`` of ASCII.

    Raises
    ------
    ValueError
        For a channel of another shape, or of no numbers, with its name.
    TypeError
        For channels that are no mapping of names.

    Examples
    --------
    >>> fh.Frame((2, 3), {"quality": np.zeros((2, 3))})
    Frame(3 x 2 pixels: quality)
    """

    _shape: tuple[int, int]
    _channels: dict[str, npt.NDArray[Any]]
    #: The JSON of where the channels come from.
    _origin: str
    #: Where the frame is from a file.
    _metadata: dict[str, Any] | None
    _display: Display

    def __init__(self, shape: tuple[int, int], channels: Mapping[str, npt.ArrayLike]) -> None:
        if not isinstance(shape, tuple | list) or len(shape) != 2:
            raise ValueError(f"shape must be (rows, columns), got {shape!r}")
        rows, columns = count("rows", shape[0]), count("columns", shape[1])
        if not isinstance(channels, Mapping):
            raise TypeError(f"channels must be a dict of arrays, got {channels!r}")
        self._shape = rows, columns
        self._channels = {
            text("a name of channels", name): channel_array(f"channel {name!r}", array, self._shape)
            for name, array in channels.items()
        }
        self._origin, self._metadata, self._display = "{}", None, Display()

    @classmethod
    def _of(
        cls,
        shape: tuple[int, int],
        channels: dict[str, npt.NDArray[Any]],
        origin: str = "{}",
        metadata: dict[str, Any] | None = None,
        display: Display | None = None,
    ) -> Frame:
        """Return a frame of arrays that are as they should be."""
        frame = cls.__new__(cls)
        frame._shape, frame._channels = shape, channels
        frame._origin, frame._metadata = origin, metadata
        frame._display = Display() if display is None else display
        return frame

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
        channels, said = read_channels(path)
        metadata = None if said is None else json.loads(said)
        rows, columns = next((array.shape[:2] for array in channels.values()), (0, 0))
        return cls._of((rows, columns), channels, said or "{}", metadata)

    @property
    def metadata(self) -> dict[str, Any]:
        """The metadata in files of this frame.

        That is: each channel's unit, frame, miss value and type; where pixel centres are; the
        camera, also as intrinsic matrix and pose; the scene's fingerprint; the version. A frame
        from a file has that file's metadata; they are empty for files of other programs.
        """
        if self._metadata is not None:
            return self._metadata
        if self._origin == "{}":
            return {}
        # Of one pixel: what is said depends on types and components alone.
        pixel = [(name, in_file(name, array[:1, :1])) for name, array in self._channels.items()]
        made: dict[str, Any] = json.loads(_firsthit.metadata(self._shape, pixel, self._origin))
        return made

    @property
    def display(self) -> Display:
        """The display of ``color`` in PNGs and notebooks, where `save` is not told otherwise.

        Of a frame that `render` made it is `Scene.display`, of others it changes nothing. It is set
        to another `Display`; anything else is a ``TypeError``. The arrays stay as they are.
        """
        return self._display

    @display.setter
    def display(self, display: Display) -> None:
        self._display = as_display(display)

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, columns)."""
        return self._shape

    @property
    def channels(self) -> tuple[str, ...]:
        """The names of the channels, in their order."""
        return tuple(self._channels)

    @overload
    def __getitem__(self, name: Literal["color"] | MatteName) -> npt.NDArray[np.float32]: ...

    @overload
    def __getitem__(
        self, name: DistanceName | AngleName | VectorName
    ) -> npt.NDArray[np.float64]: ...

    @overload
    def __getitem__(self, name: IdentifierName) -> npt.NDArray[np.int32]: ...

    @overload
    def __getitem__(self, name: Literal["front", "valid"]) -> npt.NDArray[np.bool_]: ...

    @overload
    def __getitem__(self, name: str) -> npt.NDArray[Any]: ...

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        """Return the array of a channel; a ``KeyError`` where there is none, as of a dict."""
        if name not in self._channels:
            there = ", ".join(self._channels)
            raise KeyError(
                f"no channel {name!r}; there are {there}{channel_hint(name, self._channels)}"
            )
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

    def save(
        self,
        path: str | os.PathLike[str],
        *,
        png_scale: float | None = None,
        far: Far | None = None,
        png_labels: bool = False,
        compress: bool = False,
        exposure: float | None = None,
        tone_map: ToneMapName | None = None,
    ) -> None:
        """Write the frame to a file, whole or not at all.

        Parameters
        ----------
        path : path-like
            ``.exr`` and ``.npz`` hold all channels. ``.npy`` and ``.png`` hold one: the only one,
            and a PNG of several ``color``. With ``{channel}`` in the name each channel has a file
            of its own. NPY and NPZ are exact, with linear colours; an EXR is linear float32; a PNG
            is sRGB, and shows other channels in false colours. ``.ply`` and ``.pcd`` are point
            clouds: the pixels that hit something, with all channels, of which ``position`` must be
            one. Their colours are sRGB bytes; a PLY is exact otherwise, a PCD float32, but float64
            for positions so far from the origin that float32 has too few digits.
        png_scale : float, optional
            Write distances (``t``, ``range``, ``z``) to ``.png`` as 16 bit numbers, which count
            steps of this length in scene units; 0 is a miss. A distance beyond 65535 steps, unless
            ``far`` is given, or below half a step, is an error.
        far : {"saturate", "zero"}, optional
            The number in such a PNG for a distance beyond 65535 steps, such as that of a far
            background: 65535, or 0 as for a miss. If left out, that is an error.
        png_labels : bool
            Write identifiers (``object``, ``primitive``, ``face``, ``node``, ``mesh``,
            ``material``) to ``.png`` as 16 bit numbers, each plus one; 0 is a miss. `load` takes
            the one away again. An identifier above 65534 is an error.
        compress : bool
            Pack an ``.npz``, by deflate; ``numpy.load`` reads it as any other.
        exposure : float, optional
            Show ``color`` in a ``.png`` so many stops brighter: times 2 to this power. If left out,
            that of `display`. All other files keep linear colours.
        tone_map : {"none", "neutral", "agx", "aces"}, optional
            How a ``.png`` shows colours of any brightness, after the exposure. If left out, that of
            `display`.

        Raises
        ------
        ValueError
            For an unknown extension or tone map, several channels for a file that takes one,
            ``{channel}`` in the name of a point cloud, an exposure that is not finite, or numbers
            that the format cannot hold.
        FileWriteError
            If the system refuses to write it; an old file is as it was. Also an `OSError`.

        Warns
        -----
        FirsthitWarning
            For positions in an ``.exr`` that float32 moves by more than a millionth of their
            largest side.
        """
        names, shown = list(self._channels), self._display._but(exposure, tone_map)
        how = stored(png_scale, far, png_labels, compress)
        if len(names) > 1 and is_of_one(path):
            if "color" not in names or Path(path).suffix.lower() != ".png":
                lost = next(name for name in names if name != "color")
                raise ValueError(
                    f"the channel {lost} goes to no file: {os.fspath(path)} takes one channel; put "
                    "{channel} into the name for a file of each, or use .npz"
                )
            names = ["color"]
        for file, held in files(path, names):
            self._write(file, held, how, shown)

    def matte(
        self, names: str | Sequence[str], channel: MatteName = "crypto_object"
    ) -> npt.NDArray[np.float32]:
        """Return how much of each pixel some objects or materials cover, of a Cryptomatte.

        Parameters
        ----------
        names : str or sequence of str
            Their names. Those without a name are called ``object_3`` or ``material_3``, after their
            identifiers. Things of one name are one.
        channel : {"crypto_object", "crypto_material"}
            The channel, which `render` makes.

        Returns
        -------
        (rows, columns) array of float32
            From 0 to 1: the share of the pixel's samples that meet them. An object not among the
            pixel's largest shares, six unless more were asked for, counts as 0.

        Raises
        ------
        KeyError
            For a channel that the frame does not have, and a name that the scene does not have.

        Examples
        --------
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1), name="ball")
        0
        >>> camera = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 45, rows=3, columns=3)
        >>> frame = fh.render(scene, camera, channels="crypto_object", samples=16)
        >>> frame.matte("ball")[1]
        array([0.1875, 1.    , 0.125 ], dtype=float32)
        """
        pairs = np.ascontiguousarray(self[channel], np.float32)
        known = self.metadata.get("cryptomatte", {}).get(channel, {}).get("manifest")
        shares = np.zeros(self._shape, np.float32)
        for name in dict.fromkeys([names] if isinstance(names, str) else names):
            if known is not None and name not in known:
                raise KeyError(f"no {name!r} in the manifest of {channel}")
            is_it = pairs[..., 0::2].view(np.uint32) == _firsthit.matte_id(name)
            shares += np.where(is_it, pairs[..., 1::2], np.float32(0)).sum(axis=-1)
        return np.minimum(shares, np.float32(1))

    def to_points(self) -> dict[str, npt.NDArray[Any]]:
        """Return the point cloud of the pixels that hit something.

        Returns
        -------
        dict of str to (n,) or (n, k) array
            All channels, of which ``position`` must be one, and ``row`` and ``column``, int64: an
            element for each pixel that has a position, row by row. Copies.

        Raises
        ------
        ValueError
            Without the channel ``position``.

        Examples
        --------
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> camera = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 45, rows=3, columns=3)
        >>> fh.render(scene, camera, channels=("position", "object")).to_points()["position"]
        array([[0., 0., 1.]])
        """
        if "position" not in self._channels:
            there = ", ".join(self._channels)
            raise ValueError(f"to_points takes a frame with the channel position, got {there}")
        row, column = np.nonzero(~np.isnan(self._channels["position"]).any(axis=-1))
        return {
            **{name: array[row, column] for name, array in self._channels.items()},
            "row": row,
            "column": column,
        }

    def to_xarray(self) -> xarray.Dataset:
        """Return the frame as a Dataset of xarray, which shares the arrays' memory.

        Returns
        -------
        xarray.Dataset
            A variable for each channel, of the dimensions ``row``, ``column`` and, where a pixel
            has several numbers, ``NAME_component``. The coordinates of ``row`` and ``column`` are
            those of the pixels' centres, from the upper left corner of the camera's whole picture:
            0.5 is the first. A variable's attributes are ``long_name``, ``units``, ``frame`` and
            ``miss``, as far as the metadata have them; those of the Dataset are ``camera`` and
            ``sensor`` as JSON, ``scene`` and ``firsthit``.

        Raises
        ------
        ImportError
            Where xarray is missing.
        """
        datasets = optional("xarray", "to_xarray")
        said = self.metadata
        records = {record["name"]: record for record in said.get("channels", [])}
        x, y = (said.get("pixels") or {}).get("first_center", (0.5, 0.5))
        words = {"about": "long_name", "unit": "units", "frame": "frame", "miss": "miss"}
        variables = {}
        for name, array in self._channels.items():
            sides = ("row", "column") if array.ndim == 2 else ("row", "column", f"{name}_component")
            known = records.get(name, {})
            kept = {key: known[word] for word, key in words.items() if known.get(word) is not None}
            variables[name] = (sides, array, kept)
        about = {name: said[name] for name in ("scene", "firsthit") if said.get(name) is not None}
        for name in ("camera", "sensor"):
            if said.get(name) is not None:
                about[name] = json.dumps(said[name])
        rows, columns = self._shape
        places = {"row": np.arange(rows) + y, "column": np.arange(columns) + x}
        made: xarray.Dataset = datasets.Dataset(variables, places, about)
        return made

    def _write(
        self, path: Path, names: list[str], how: _firsthit._Stored, shown: Display | None = None
    ) -> None:
        channels = [(name, in_file(name, self._channels[name])) for name in names]
        display = (self._display if shown is None else shown)._native
        write_channels(path, self._shape, channels, self._origin, how, display)

    def _repr_html_(self) -> str:
        """Show it at a glance, for notebooks."""
        from .glance import of_frame

        return of_frame(self)

    def _png(self) -> bytes | None:
        pictures = [name for name in self._channels if matte_of(name) is None]
        if not pictures:
            return None
        name = "color" if "color" in pictures else pictures[0]
        values = in_file(name, self._channels[name])
        return _firsthit.png(list(self._shape), name, values, self._display._native)
