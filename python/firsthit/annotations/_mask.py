"""Masks: which pixels of a picture belong to something."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ._outline import compressed, polygons, run_lengths

if TYPE_CHECKING:
    import numpy.typing as npt

    Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Mask:
    """The pixels of a picture that belong to something, kept as the part that has any.

    `array` is the mask of the whole picture, and NumPy's functions take a `Mask` as that. Boxes and
    polygons are in columns from the left edge and rows from the upper edge of the picture, so that
    a box of one pixel is 1 wide, and the centre of the first pixel is (0.5, 0.5).

    Examples
    --------
    >>> from firsthit.annotations import Mask
    >>> mask = Mask.of(np.array([[0, 0, 0, 0], [0, 1, 1, 0]], bool))
    >>> mask.box, mask.pixels
    ((1, 1, 2, 1), 2)
    >>> mask.rle()
    {'size': [2, 4], 'counts': '31101'}
    """

    #: Rows and columns of the picture.
    shape: tuple[int, int]
    #: Where in the picture the first pixel of ``crop`` is.
    row: int
    column: int
    #: The least part of the mask that has all its pixels.
    crop: npt.NDArray[np.bool_]

    @classmethod
    def of(
        cls,
        mask: npt.ArrayLike,
        *,
        shape: tuple[int, int] | None = None,
        row: int = 0,
        column: int = 0,
    ) -> Mask:
        """Return a mask of an array, or of one that stands somewhere in a larger picture.

        Parameters
        ----------
        mask : (rows, columns) array_like of bool
            Which pixels belong to it.
        shape : pair of int, optional
            Rows and columns of the whole picture; those of the array if left out.
        row, column : int
            Where in the picture the array's first pixel is.

        Returns
        -------
        Mask
            With the least part that has all its pixels.

        Raises
        ------
        ValueError
            For an array that is not of bool or has no two axes, and one beyond the picture.
        """
        given = np.asarray(mask)
        if given.ndim != 2 or given.dtype != np.bool_:
            raise ValueError(
                f"mask must be (rows, columns) of bool, got {given.dtype} of shape {given.shape}"
            )
        whole = given.shape if shape is None else shape
        if row < 0 or column < 0 or np.greater(np.add(given.shape, (row, column)), whole).any():
            raise ValueError(
                f"mask of shape {given.shape} at row {row} and column {column} must be within the "
                f"picture {whole}"
            )
        rows, columns = (np.flatnonzero(given.any(axis=axis)) for axis in (1, 0))
        if len(rows) == 0:
            return cls((whole[0], whole[1]), 0, 0, np.zeros((0, 0), np.bool_))
        crop = given[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1].copy()
        crop.flags.writeable = False
        return cls((whole[0], whole[1]), row + int(rows[0]), column + int(columns[0]), crop)

    @property
    def array(self) -> npt.NDArray[np.bool_]:
        """The mask of the whole picture, (rows, columns) bool: a new array."""
        whole = np.zeros(self.shape, np.bool_)
        whole[self.part] = self.crop
        return whole

    def __array__(self, dtype: Any = None, copy: Any = None) -> npt.NDArray[Any]:
        """Return `array`, so that NumPy's functions take a mask."""
        if copy is False:
            raise ValueError("a mask is kept as its part, so its array is always a new one")
        return self.array if dtype is None else self.array.astype(dtype)

    @property
    def part(self) -> tuple[slice, slice]:
        """The rows and columns of ``crop``, to index arrays of the picture with."""
        rows, columns = self.crop.shape
        return slice(self.row, self.row + rows), slice(self.column, self.column + columns)

    @property
    def pixels(self) -> int:
        """The number of pixels that belong to it."""
        return int(np.count_nonzero(self.crop))

    @property
    def box(self) -> tuple[int, int, int, int] | None:
        """The least box around its pixels: left and upper edge, width, height; ``None`` if none."""
        rows, columns = self.crop.shape
        return (self.column, self.row, columns, rows) if rows else None

    def polygons(self, *, join: bool = False) -> list[Floats]:
        """Return polygons along the edges of pixels that cover exactly the mask.

        Parameters
        ----------
        join : bool
            Whether to join parts that do not touch to one polygon, by slits without a width.

        Returns
        -------
        list of (n, 2) array of float64
            One for each part whose pixels touch by edges. A hole is joined to what surrounds it by
            a slit without a width: by the even-odd rule, and for COCO's own code, exactly the
            pixels' centres of the mask are inside.
        """
        found = polygons(self.crop, is_one=join)
        return [np.add(polygon, (self.column, self.row)) for polygon in found]

    def rle(self) -> dict[str, Any]:
        """Return the mask as COCO's run lengths.

        Returns
        -------
        dict
            ``size`` (rows, columns) and ``counts`` as compressed text, for ``pycocotools.mask``.
        """
        return {"size": list(self.shape), "counts": compressed(self.run_lengths())}

    def run_lengths(self) -> list[int]:
        """Return how many pixels are out, in, out, ..., column by column from the left."""
        return run_lengths(self.array)
