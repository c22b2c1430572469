"""The storage of numbers in files."""

from __future__ import annotations

from typing import TYPE_CHECKING, get_args

from firsthit._base.arrays import flag, number, text
from firsthit._base.types import Far

if TYPE_CHECKING:
    from firsthit import _firsthit


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
