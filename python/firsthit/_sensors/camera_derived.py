"""Cameras made of another one: a part of its picture, other pixels, a lens, another place."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from firsthit._base.arrays import count, index, number, vector

from . import conventions
from .camera_view import CameraView

if TYPE_CHECKING:
    from typing import Self

    import numpy.typing as npt


class DerivedCamera(CameraView):
    """A camera from which others are made."""

    def crop(
        self,
        rows: slice | tuple[int, int] | tuple[slice, slice],
        columns: slice | tuple[int, int] | None = None,
    ) -> Self:
        """Make the camera of a part of the picture; its intrinsic matrix follows.

        Parameters
        ----------
        rows, columns : slice or pair of int
            From and to, without steps, as NumPy counts them; or both in one, as
            ``np.s_[100:200, :]``.

        Returns
        -------
        Camera
            Its rays are those of the part, but for rounding; `render` with a ``region`` gives the
            same bits.

        Raises
        ------
        ValueError
            For an empty part or one beyond the picture, steps, and a projection without an
            intrinsic matrix other than ``orthographic``.

        Examples
        --------
        >>> camera = fh.Camera.from_intrinsics([50, 50, 32, 24], rows=48, columns=64,
        ...                                    convention="colmap")
        >>> camera.crop(slice(4, 40), slice(8, 60)).intrinsic_matrix[:2, 2]
        array([24., 20.])
        """
        if columns is None:
            if not isinstance(rows, tuple) or len(rows) != 2 or not isinstance(rows[0], slice):
                raise ValueError("crop takes rows and columns, or both as np.s_[rows, columns]")
            rows, columns = rows
        top, bottom = _span("rows", rows, self.rows)
        left, right = _span("columns", columns, self.columns)
        return self._of(self._native.crop((top, bottom, left, right)))

    def resize(self, rows: int, columns: int) -> Self:
        """Make the camera of the same picture with other numbers of pixels, as by binning.

        Parameters
        ----------
        rows, columns : int
            Pixels down and across.

        Returns
        -------
        Camera
            Its intrinsic matrix follows; its viewplane is the same.

        Raises
        ------
        ValueError
            For no pixels, and for a shape that a cube map does not have.

        Examples
        --------
        >>> camera = fh.Camera.from_intrinsics([50, 50, 32, 24], rows=48, columns=64,
        ...                                    convention="colmap")
        >>> camera.resize(24, 32).intrinsic_matrix[:2, 2]
        array([16., 12.])
        """
        return self._of(self._native.resize(count("rows", rows, 1), count("columns", columns, 1)))

    def thin_lens(self, aperture: float, focus: npt.ArrayLike) -> Self:
        """Return the same camera with a lens of some diameter, in focus at some distance.

        Parameters
        ----------
        aperture : float
            The diameter of the lens, a disc around ``position`` at right angles to ``aim``, in
            scene units; 0 for a pinhole.
        focus : float or (3,) array_like
            The place that is sharp: the distance along ``aim`` of a plane parallel to the
            viewplane, or a point of that plane in world space.

        Returns
        -------
        Camera
            Its own rays are those of the pinhole at ``position``, and so are all channels of its
            pictures but ``color``.

        Raises
        ------
        ValueError
            For an aperture that is negative, a focus that is not ahead of the camera, a projection
            other than ``perspective``, ``opencv`` and ``fov``, and a tilted viewplane or sensor.

        Notes
        -----
        Each sample of a picture comes from another point of the lens, through another point of the
        pixel; the first from the middle of both. A point at the distance z along the aim becomes a
        disc, whose diameter on the viewplane is
        ``aperture * abs(z - focus) / (z * focus) * focal_length``. With few samples one sees so
        many sharp pictures over each other: 64 or more make the blur smooth. With distortion the
        disc is that of the undistorted image: each ray goes from its point of the lens to where the
        pixel's own ray is in focus.

        Examples
        --------
        >>> camera = fh.Camera.look_at((0, -5, 0), (0, 0, 0), (0, 0, 1), 45, rows=48, columns=64)
        >>> camera = camera.thin_lens(0.5, focus=(1, -1, 2))
        >>> camera.aperture, camera.focus
        (0.5, 4.0)
        """
        is_point = np.ndim(focus) > 0
        far = self._native.depth(vector("focus", focus)) if is_point else number("focus", focus)
        return self._of(self._native.thin_lens(number("aperture", aperture), far))

    def moved(self, pose: npt.ArrayLike) -> Self:
        """Return the same camera, carried by a body.

        Parameters
        ----------
        pose : (4, 4) or (3, 4) array_like
            The matrix that takes the coordinates in which this camera's position, aim and up are to
            others, such as those of the world; a rotation and a translation.

        Returns
        -------
        Camera
            One that is not turned keeps its bits, but for the position.

        Raises
        ------
        ValueError
            For a matrix that is no rigid motion.

        Examples
        --------
        >>> camera = fh.Camera.look_at((0, 0, 1), (1, 0, 1), (0, 0, 1), 60, rows=4, columns=6)
        >>> moved = camera.moved([[0, -1, 0, 5], [1, 0, 0, 0], [0, 0, 1, 0]])
        >>> moved.position.tolist(), moved.aim.tolist()
        ([5.0, 0.0, 1.0], [0.0, 1.0, 0.0])
        """
        return self._of(self._native.moved(conventions.pose4(pose)))


def _span(name: str, part: object, length: int) -> tuple[int, int]:
    """Return the first index of a part and the one behind it."""
    if isinstance(part, slice):
        first, last, step = part.indices(length)
        stop = part.stop
        if step != 1:
            raise ValueError(f"{name} must be without steps, got {part}")
        if stop is not None and stop > length:
            last = int(stop)
    elif isinstance(part, tuple | list) and len(part) == 2:
        first, last = (index(name, each) for each in part)
    else:
        raise ValueError(f"{name} must be a slice or a pair of ints, got {part!r}")
    if not 0 <= first < last <= length:
        raise ValueError(f"{name} must be a part of 0 to {length}, got {first} to {last}")
    return first, last
