"""The channels that go into each file, and how files hold numbers."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar, cast, get_args

from firsthit._base.arrays import flag, number, text
from firsthit._base.hints import channel_hint
from firsthit.typing import DistanceName, Far, MatteName

if TYPE_CHECKING:
    from collections.abc import Sequence

    from firsthit import _firsthit


#: The extensions of point clouds: lists of points, with all channels.
CLOUDS = (".ply", ".pcd")

#: The extensions of files that hold several channels.
OF_SEVERAL = (".npz", ".exr", *CLOUDS)

#: Channels of distances, whose PNGs need a scale.
DISTANCES = get_args(DistanceName)

#: The channel of ambient occlusion, of which ``ao:LENGTH`` is that up to a distance.
_OCCLUSION = "ao"
_EACH = "{channel}"

_Name = TypeVar("_Name", bound=str)

#: The beginning of the name of an attribute's channel.
ATTRIBUTE = "attribute:"


def attribute_of(name: str) -> str | None:
    """Return the attribute that a channel's name stands for, if it is one."""
    return name[len(ATTRIBUTE) :] or None if name.startswith(ATTRIBUTE) else None


def matte_of(name: str) -> str | None:
    """Return the channel of a Cryptomatte, without its number of pairs, if it is one."""
    channel = name.split(":")[0]
    return channel if channel in get_args(MatteName) else None


def in_path(name: str) -> str:
    """Return a channel's name as a file's name has it: one's own may have any characters."""
    attribute = attribute_of(name)
    if attribute is None:
        return re.sub(r"[^A-Za-z0-9._:-]", "_", name)[:100]
    return "attribute-" + re.sub(r"[^A-Za-z0-9._-]", "_", attribute)[:100]


def is_for_each(path: str | os.PathLike[str]) -> bool:
    """Tell whether each channel gets a file of its own."""
    return _EACH in os.fspath(path)


def is_cloud(path: str | os.PathLike[str]) -> bool:
    """Tell whether a file is a point cloud."""
    return Path(path).suffix.lower() in CLOUDS


def is_of_several(path: str | os.PathLike[str]) -> bool:
    """Tell whether several channels can be written to a path."""
    return is_for_each(path) or Path(path).suffix.lower() in OF_SEVERAL


def is_of_one(path: str | os.PathLike[str]) -> bool:
    """Tell whether a path is that of one channel; an unknown extension is refused elsewhere."""
    return not is_for_each(path) and Path(path).suffix.lower() in (".npy", ".png")


def files(path: str | os.PathLike[str], names: Sequence[_Name]) -> list[tuple[Path, list[_Name]]]:
    """Return the files to write with their channels: one, or one for each channel.

    A ``ValueError`` for point clouds of one channel each, and for two channels in one file.
    """
    if not is_for_each(path):
        return [(Path(path), list(names))]
    if is_cloud(path):
        raise ValueError(
            f"path must not contain {_EACH}: a point cloud holds all channels, "
            f"got {os.fspath(path)}"
        )
    made = [(Path(os.fspath(path).replace(_EACH, in_path(name))), [name]) for name in names]
    of_file: dict[Path, _Name] = {}
    for file, (name,) in made:
        if other := of_file.get(file):
            raise ValueError(f"channels {other!r} and {name!r} would both be written to {file}")
        of_file[file] = name
    return made


def distinct(names: _Name | Sequence[_Name], known: Sequence[_Name]) -> list[_Name]:
    """Return the names of channels, each once, if they are known and there are any."""
    try:
        asked = cast("list[_Name]", [names] if isinstance(names, str) else list(names))
    except TypeError:
        raise TypeError(f"channels must be a str or several, got {names!r}") from None
    if not asked:
        raise ValueError(f"channels must be one or more of {', '.join(known)}, got none")
    for name in asked:
        is_more = isinstance(name, str) and (
            attribute_of(name) is not None
            or (name != matte_of(name) in known)
            or (_OCCLUSION in known and name.startswith(f"{_OCCLUSION}:"))
        )
        if name not in known and not is_more:
            there = f"{', '.join(known)}, {_OCCLUSION}:LENGTH, {ATTRIBUTE}NAME"
            meant = channel_hint(name, known)
            raise ValueError(f"channels must be among {there}, got {name!r}{meant}")
    return list(dict.fromkeys(asked))


def stored(
    png_scale: float | None = None,
    far: Far | None = None,
    png_labels: bool = False,  # noqa: FBT001, FBT002 - given by name where users say it
    compress: bool = False,  # noqa: FBT001, FBT002 - as above
) -> _firsthit._Stored:
    """Check how files are to hold numbers, and return it as the native half takes it."""
    if far is not None:
        if text("far", far) not in get_args(Far):
            raise ValueError(f"far must be 'saturate', 'zero' or None, got {far!r}")
        if png_scale is None:
            raise ValueError("far needs png_scale: it is about PNGs of distances in steps")
    scale = None if png_scale is None else number("png_scale", png_scale)
    return scale, far, flag("png_labels", png_labels), flag("compress", compress)
