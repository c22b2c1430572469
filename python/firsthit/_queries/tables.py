"""Hits as tables, and in files."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import copied, flag, text
from firsthit._files.channels import attribute_of, distinct, files, is_cloud, is_of_several
from firsthit._files.frame_file import channel_array, in_file, write_channels
from firsthit.typing import ChannelName

from .channels import Channels

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from firsthit.typing import Asked

#: The ends of columns' names in a table, where they are not x, y, z.
_LETTERS = {"barycentric": "012", "uv": "uv", "base_color": "rgb"}


class Tables(Channels):
    """Hits as columns by name, and as files hold them."""

    def to_dict(
        self, channels: Asked | Sequence[Asked] | None = None, *, copy: bool = False
    ) -> dict[str, npt.NDArray[Any]]:
        """Return the hits as a table: its columns by name.

        ``pandas.DataFrame(hits.to_dict())`` and its like take it.

        Parameters
        ----------
        channels : str or sequence of str, optional
            Some of `channels`, or ``"attribute:NAME"`` for an `attribute`; all channels if left
            out.
        copy : bool
            Whether the columns are copies, which can be written, and not views of the hits.

        Returns
        -------
        dict of str to (n,) array
            A row for each ray, in the order of the rays. For a camera's hits the first columns are
            ``row`` and ``column``, their pixel. A channel of several numbers has as many columns,
            called as in the program's CSV: ``position_x``, ``barycentric_0``, ``uv_u``,
            ``attribute:NAME_0``, and so on.

        Raises
        ------
        ValueError, AttributeError
            As `channel`.

        Examples
        --------
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> hits = scene.shoot([[0, 0, 5], [0, 3, 5]], [0, 0, -1])
        >>> hits.to_dict(["t", "normal"])
        {'t': array([ 4., inf]), 'normal_x': array([ 0., nan]), 'normal_y': array([ 0., nan]),
        'normal_z': array([ 1., nan])}
        """
        table: dict[str, npt.NDArray[Any]] = {}
        pixels = self._source.rows_and_columns(len(self._arrays[0]))
        if pixels is not None:
            table["row"], table["column"] = pixels
        names = [channels] if isinstance(channels, str) else channels
        for name in self.channels if names is None else names:
            array = self.channel(name)
            if array.ndim == len(self._shape):
                table[name] = array.reshape(-1)
                continue
            columns = array.reshape(-1, array.shape[-1])
            letters: Sequence[object] = _LETTERS.get(name, "xyz")
            if attribute_of(name) is not None:
                letters = range(array.shape[-1])
            for k, letter in enumerate(letters):
                table[f"{name}_{letter}"] = columns[:, k]
        return copied(table) if flag("copy", copy) else table

    def _own(
        self, path: str | os.PathLike[str], own: Mapping[str, npt.ArrayLike] | None
    ) -> dict[str, npt.NDArray[Any]]:
        """Return numbers of the user's own as files hold them."""
        if not isinstance(own, Mapping | None):
            raise TypeError(f"own must be a dict of arrays, got {own!r}")
        if own and not is_of_several(path):
            raise ValueError(f"own must be left out for {os.fspath(path)}, which takes one channel")
        made = {}
        for name, given in (own or {}).items():
            if name in (*get_args(ChannelName), "ray"):
                raise ValueError(f"own must have names that are no channels, got {name!r}")
            array = channel_array(name, given, self._shape)
            made[text("a name of own", name)] = in_file(name, array)
        return made

    def _save(
        self,
        path: str | os.PathLike[str],
        channels: Asked | Sequence[Asked] | None,
        others: dict[str, npt.NDArray[Any]],
        how: _firsthit._Stored,
    ) -> None:
        """Write channels, and before them ``others`` to a file that takes several."""
        names: list[str]
        if channels is not None:
            names = list(distinct(channels, self.channels))
        else:
            names = ["t", "object", "primitive"] if is_of_several(path) else ["t"]
            names = ["normal", *names] if is_cloud(path) else names
        if is_cloud(path) and "position" not in names:
            names = ["position", *names]
        wanted = files(path, [*others, *names] if is_of_several(path) else names)
        camera = self._source.camera
        says_camera = is_cloud(path) or self._source.is_whole
        native = camera._native if camera is not None and says_camera else None
        origin = _firsthit.origin(self._built.native, native, names)
        for file, held in wanted:
            made = ((name, others[name] if name in others else self._named(name)) for name in held)
            arrays = [(name, np.ascontiguousarray(array).ravel()) for name, array in made]
            write_channels(file, self._shape, arrays, origin, how, None)
