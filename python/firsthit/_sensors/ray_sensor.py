"""Tables of rays."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import cast, count, lock, vector, vectors

from .conventions import rigid
from .sensor import OtherSensor

if TYPE_CHECKING:
    import numpy.typing as npt


class RaySensor(OtherSensor):
    """A table of rays: one for every pixel, whatever computed them. Immutable.

    A pixel whose direction is zero or not finite has no ray: it is a miss, and the channel
    ``valid`` is false there. With several samples, all of a pixel are its one ray.

    Parameters
    ----------
    origins, directions : (..., 3) array_like
        The rays, in world space, of any real type, of which copies are kept: one for all pixels, or
        one for each. Directions have any length but zero, in units of which ``t`` counts; ``range``
        is the distance from the ray's own origin in scene units.
    shape : pair of int, optional
        Rows and columns of the picture. If left out, the arrays have the shape (rows, columns, 3),
        or (columns, 3) of a picture of one row.
    aim : (3,) array_like, optional
        The direction along which ``z`` is measured, from each ray's own origin, of any length but
        zero. Without it there is no ``z``.

    Raises
    ------
    ValueError
        For arrays of other shapes or types, no pixels, and an aim that is no direction.

    Examples
    --------
    >>> scene = fh.Scene()
    >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
    0
    >>> x = np.linspace(-1.2, 1.2, 5)
    >>> origins = np.stack([x, 0 * x, 0 * x + 4], axis=-1)
    >>> line = fh.RaySensor(origins, (0, 0, -2), shape=(1, 5))
    >>> scene.shoot(line).range.round(3)
    array([[inf, 3.2, 3. , 3.2, inf]])
    """

    def __init__(
        self,
        origins: npt.ArrayLike,
        directions: npt.ArrayLike,
        shape: tuple[int, int] | None = None,
        aim: npt.ArrayLike | None = None,
    ) -> None:
        starts, ways = vectors("origins", origins), vectors("directions", directions)
        if shape is None:
            try:
                leading = np.broadcast_shapes(starts.shape[:-1], ways.shape[:-1])
            except ValueError:
                raise ValueError(
                    f"origins {starts.shape} and directions {ways.shape} must broadcast against "
                    "each other"
                ) from None
            if len(leading) not in (1, 2):
                raise ValueError(f"shape must be given with rays of the shape {leading}")
            shape = leading if len(leading) == 2 else (1, leading[0])
        if not isinstance(shape, tuple | list) or len(shape) != 2:
            raise ValueError(f"shape must be (rows, columns), got {shape!r}")
        size = count("rows", shape[0], 1), count("columns", shape[1], 1)
        along = None if aim is None else vector("aim", aim)
        flat = [_of_pixels("origins", starts, size), _of_pixels("directions", ways, size)]
        self._arguments = flat[0], flat[1], size, along
        self._native = _firsthit.Sensor.table(*self._arguments)

    @property
    def aim(self) -> npt.NDArray[np.float64] | None:
        """The direction along which ``z`` is measured, as it was given; ``None`` without one."""
        return None if self._arguments[3] is None else np.array(self._arguments[3])

    def moved(self, pose: npt.ArrayLike) -> RaySensor:
        """Return the same rays, carried by a body.

        Parameters
        ----------
        pose : (4, 4) or (3, 4) array_like
            The matrix that takes the coordinates in which these rays are to others, such as those
            of the world; a rotation and a translation.

        Returns
        -------
        RaySensor
            With the aim turned too.

        Raises
        ------
        ValueError
            For a matrix that is no rigid motion.
        """
        matrix = rigid(pose)
        origins, directions, size, aim = self._arguments
        starts = origins.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]
        ways = directions.reshape(-1, 3) @ matrix[:3, :3].T
        along = None if aim is None else matrix[:3, :3] @ aim
        return RaySensor(starts, ways, size, along)

    def __repr__(self) -> str:
        return f"RaySensor(shape={self.shape}, aim={self._arguments[3]})"

    def __reduce__(self) -> tuple[object, tuple[object, ...]]:
        """Pickle by what it was made from."""
        origins, directions, size, aim = self._arguments
        return RaySensor, (origins.reshape(-1, 3), directions.reshape(-1, 3), size, aim)


def _of_pixels(
    name: str, given: npt.NDArray[np.float64], size: tuple[int, int]
) -> npt.NDArray[np.float64]:
    """Return a flat copy of vectors: one for all pixels, or one for each."""
    rows, columns = size
    pixels = rows * columns
    if given.size == 3:
        flat = given.reshape(1, 3)
    elif given.size == 3 * pixels:
        flat = given.reshape(pixels, 3)
    else:
        try:
            flat = np.broadcast_to(given, (rows, columns, 3)).reshape(pixels, 3)
        except ValueError:
            raise ValueError(
                f"{name} must be one vector, or one for each of {rows} x {columns} pixels, "
                f"got an array of shape {given.shape}"
            ) from None
    made = np.array(cast(flat, np.float64), order="C").reshape(-1)
    lock(made)
    return made
