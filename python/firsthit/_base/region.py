"""Parts of pictures."""

from __future__ import annotations

from typing import NamedTuple

#: No memory has a byte for each: addresses have 47 bits.
_MOST = 1 << 47


def check_pixels(rows: int, columns: int) -> None:
    """Refuse a picture of which no memory could hold a byte for each pixel."""
    if rows * columns > _MOST:
        raise MemoryError(f"{rows} rows of {columns} pixels do not fit into memory")


class Region(NamedTuple):
    """A part of a picture: its first row and the one behind its last, and likewise its columns."""

    top: int
    bottom: int
    left: int
    right: int

    @classmethod
    def of(cls, region: object, shape: tuple[int, int]) -> Region:
        """Check what a user gave, for pictures of a shape."""
        part = cls._part(region, shape)
        check_pixels(*part.shape)
        return part

    @classmethod
    def _part(cls, region: object, shape: tuple[int, int]) -> Region:
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

    def corner(self) -> Region:
        """Return its first pixel."""
        return Region(self.top, self.top + 1, self.left, self.left + 1)
