"""The numbers of a camera, whatever made it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import number, text, vector, vectors

from .sensor import Sensor

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from typing import Self

    import numpy.typing as npt

    from firsthit.typing import Projection, RayStart, Vector

#: The projections with a viewplane.
FLAT = ("perspective", "orthographic")
#: A viewplane's numbers that are arguments of their own.
_LENGTHS = ("focal_length", "width", "height")
#: The numbers of its thin lens, which are too.
LENS = ("aperture", "focus")


class CameraView(Sensor):
    """A camera's position, aim, pixels, projection and parameters, and how they are compared."""

    _native: _firsthit.Camera

    #: Position, aim as it was given, up; rows and columns; projection and ray start; parameters.
    _arguments: tuple[
        Vector,
        Vector,
        Vector,
        tuple[int, int],
        tuple[Projection, RayStart],
        tuple[tuple[str, float], ...],
    ]

    #: Whether the arguments were taken from a camera: its aim is then to stay as it is, bit by bit.
    _is_taken: bool

    def _take(self, native: _firsthit.Camera, aim: Vector | None = None) -> None:
        """Become the camera that the native half made."""
        (where, own_aim, up), (rows, columns), (kind, start), parameters = native.view()
        aimed = vector("aim", own_aim) if aim is None else aim
        position, upwards = vector("position", where), vector("up", up)
        pixels, words = (rows, columns), (kind, start)
        self._arguments = (position, aimed, upwards, pixels, words, tuple(parameters))
        self._native, self._is_taken = native, aim is None

    @classmethod
    def _of(cls, native: _firsthit.Camera) -> Self:
        camera = cls.__new__(cls)
        camera._take(native)
        return camera

    @classmethod
    def _of_arguments(
        cls,
        vectors_: tuple[npt.ArrayLike, npt.ArrayLike, npt.ArrayLike],
        pixels: tuple[int, int],
        words: tuple[Projection, RayStart],
        parameters: Sequence[tuple[str, float]],
        is_taken: bool = False,  # noqa: FBT001, FBT002 - pickled by place
    ) -> Self:
        """Return the camera of arguments as `_arguments` has them, if need be taken from one."""
        where, aim, up = (vector("view", each) for each in vectors_)
        native = _firsthit.Camera(where, aim, up, pixels, *words, parameters, is_exact=is_taken)
        camera = cls.__new__(cls)
        camera._take(native, None if is_taken else aim)
        return camera

    @property
    def position(self) -> npt.NDArray[np.float64]:
        """The camera's position, in world space, (3,) float64: a copy."""
        return np.array(self._arguments[0])

    @property
    def aim(self) -> npt.NDArray[np.float64]:
        """The direction in which it looks, in world space, (3,) float64, of length one: a copy."""
        return np.array(self._native.frame()[1])

    @property
    def up(self) -> npt.NDArray[np.float64]:
        """The direction upwards, in world space, (3,) float64, as it was given: a copy."""
        return np.array(self._arguments[2])

    @property
    def right(self) -> npt.NDArray[np.float64]:
        """To the right in the picture, in world space, (3,) float64, of length one: a copy."""
        return np.array(self._native.frame()[2])

    @property
    def upwards(self) -> npt.NDArray[np.float64]:
        """Upwards in the picture, in world space, (3,) float64, of length one: a copy."""
        return np.array(self._native.frame()[3])

    @property
    def focal_length(self) -> float | None:
        """Distance to the viewplane, in scene units; ``None`` for a projection without one."""
        return self._length("focal_length")

    @property
    def width(self) -> float | None:
        """Width of the viewplane, in scene units; ``None`` for a projection without one."""
        return self._length("width")

    @property
    def height(self) -> float | None:
        """Height of the viewplane, in scene units; ``None`` for a projection without one."""
        return self._length("height")

    @property
    def aperture(self) -> float:
        """Diameter of the lens, in scene units; 0 of a pinhole."""
        return self.parameters.get("aperture", 0.0)

    @property
    def focus(self) -> float | None:
        """Distance along the aim at which pictures are sharp; ``None`` if it was not given."""
        return self.parameters.get("focus") or None

    def _length(self, name: str) -> float | None:
        return self.parameters[name] if self.projection in FLAT else None

    @property
    def rows(self) -> int:
        """Pixels down."""
        return self._arguments[3][0]

    @property
    def columns(self) -> int:
        """Pixels across."""
        return self._arguments[3][1]

    @property
    def projection(self) -> Projection:
        """The projection: one of those that `Camera` lists."""
        return self._arguments[4][0]

    @property
    def ray_start(self) -> RayStart:
        """``viewplane`` or ``eye``."""
        return self._arguments[4][1]

    @property
    def parameters(self) -> dict[str, float]:
        """All numbers of the projection by their names, also of the viewplane: a copy."""
        return dict(self._arguments[5])

    def project(self, points: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """Say where in the picture points are seen, whether or not anything hides them.

        Parameters
        ----------
        points : (..., 3) array_like
            Points in world space.

        Returns
        -------
        (..., 2) array of float64
            Columns from the picture's left edge and rows from its upper edge: the centre of the
            first pixel is (0.5, 0.5), and what is beyond the edges has places there. NaN where the
            projection sees no such direction, as behind a pinhole or beyond a fold.

        Examples
        --------
        >>> camera = fh.Camera.look_at((0, -5, 0), (0, 0, 0), (0, 0, 1), 90, rows=480, columns=640)
        >>> camera.project([(0, 0, 0), (0, -9, 0)])
        array([[320., 240.],
               [ nan,  nan]])
        """
        given = vectors("points", points)
        flat_points = np.ascontiguousarray(given, np.float64).reshape(-1)
        return self._native.project(flat_points).reshape((*given.shape[:-1], 2))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, CameraView):
            return False
        # The arguments may be the same and the aim, made of length one once more, not.
        mine, theirs = self._arguments, other._arguments
        same_frame = self._native.frame() == other._native.frame()
        return mine[:1] + mine[2:] == theirs[:1] + theirs[2:] and same_frame

    def __hash__(self) -> int:
        return hash(self._arguments[:1] + self._arguments[2:])

    def __repr__(self) -> str:
        position, aim, up, (rows, columns), (projection, ray_start), parameters = self._arguments
        others = dict(parameters)
        lens = [(name, others.pop(name)) for name in LENS if name in others]
        lengths = [(name, others.pop(name, None)) for name in _LENGTHS]
        pairs: list[tuple[str, object]] = [("position", position), ("aim", aim), ("up", up)]
        pairs += [*lengths, ("rows", rows), ("columns", columns)]
        pairs += [("projection", projection), ("ray_start", ray_start)]
        if others := {name: value for name, value in others.items() if value}:
            pairs.append(("parameters", others))
        pairs += lens
        return f"Camera({', '.join(f'{name}={value!r}' for name, value in pairs)})"

    def __reduce__(self) -> tuple[object, tuple[object, ...]]:
        """Pickle by what it was made from."""
        vectors_, others = self._arguments[:3], self._arguments[3:]
        return type(self)._of_arguments, (vectors_, *others, self._is_taken)


def checked_parameters(given: Mapping[str, float] | None) -> dict[str, float]:
    if given is None:
        return {}
    if not isinstance(given, dict) and not hasattr(given, "items"):
        raise TypeError(f"parameters must be a dict of numbers, got {given!r}")
    return {text("a parameter", name): number(str(name), each) for name, each in given.items()}
