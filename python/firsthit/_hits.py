"""What rays met."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from . import _firsthit
from ._arrays import chunks, flat
from ._memory import empty

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy.typing as npt

    from ._camera import Camera
    from ._scene import Scene

    Arrays = tuple[
        npt.NDArray[np.float64],
        npt.NDArray[np.int32],
        npt.NDArray[np.int32],
        npt.NDArray[np.float64],
    ]


def hits_arrays(length: int) -> Arrays:
    """Return arrays for so many hits; their elements are anything."""
    return (
        empty((length,), np.float64),
        empty((length,), np.int32),
        empty((length,), np.int32),
        empty((length, 2), np.float64),
    )


class Hits:
    """What rays met first, as arrays of the rays' shape.

    ``t, o = hits`` is the pair of distances and objects. A miss has ``t``, ``range`` and ``z`` of
    infinity, ``object`` and ``primitive`` of -1, and NaN in all else. What is not asked for is not
    computed.
    """

    def __init__(self) -> None:
        raise TypeError("Hits are made by Scene.shoot")

    _scene: Scene
    _camera: Camera | None
    _rays: tuple[npt.NDArray[Any], ...] | None
    _arrays: Arrays
    _shape: tuple[int, ...]
    _made: dict[str, npt.NDArray[Any]]

    @classmethod
    def _of(cls, scene: Scene, arrays: Arrays, shape: tuple[int, ...]) -> Hits:
        hits = cls.__new__(cls)
        hits._scene, hits._arrays, hits._shape, hits._made = scene, arrays, shape, {}
        hits._native_scene = scene._native()
        hits._camera, hits._rays = None, None
        return hits

    _native_scene: _firsthit.Scene

    @classmethod
    def _of_camera(cls, scene: Scene, camera: Camera, arrays: Arrays) -> Hits:
        hits = cls._of(scene, arrays, (camera.rows, camera.columns))
        hits._camera = camera
        return hits

    @classmethod
    def _of_rays(
        cls,
        scene: Scene,
        rays: tuple[npt.NDArray[Any], ...],
        arrays: Arrays,
        camera: Camera | None = None,
    ) -> Hits:
        hits = cls._of(scene, arrays, rays[2].shape)
        hits._rays, hits._camera = rays, camera
        return hits

    @property
    def shape(self) -> tuple[int, ...]:
        """The rays' shape, (rows, columns) for a camera."""
        return self._shape

    @property
    def t(self) -> npt.NDArray[np.floating[Any]]:
        """The rays' parameters, (...); infinity for a miss.

        In lengths of the directions, for a camera a distance from the rays' start. float32 for
        float32 rays, else float64.
        """
        if self._is_single():
            if "t" not in self._made:
                self._made["t"] = self._arrays[0].astype(np.float32)
            return self._made["t"].reshape(self._shape)
        return self._arrays[0].reshape(self._shape)

    @property
    def object(self) -> npt.NDArray[np.int32]:
        """The objects' identifiers, (...) int32; -1 for a miss."""
        return self._arrays[1].reshape(self._shape)

    @property
    def primitive(self) -> npt.NDArray[np.int32]:
        """The identifiers of the objects' parts, such as triangles, (...) int32; -1 for a miss."""
        return self._arrays[2].reshape(self._shape)

    @property
    def face(self) -> npt.NDArray[np.int32]:
        """The identifiers of the file's polygons that triangles were part of, (...) int32."""
        return self._channel("face")

    @property
    def barycentric(self) -> npt.NDArray[np.float64]:
        """The weights of a triangle's corners 0, 1, 2, (..., 3); NaN for other shapes."""
        return self._channel("barycentric", 3)

    @property
    def position(self) -> npt.NDArray[np.float64]:
        """Where the hits are in the world, (..., 3)."""
        return self._channel("position", 3)

    @property
    def normal(self) -> npt.NDArray[np.float64]:
        """The geometric normals in the world, (..., 3), of length one, outwards."""
        return self._channel("normal", 3)

    @property
    def front(self) -> npt.NDArray[np.bool_]:
        """Whether the side was met that the normal points to, (...) bool; false for a miss."""
        return self._channel("front")

    @property
    def uv(self) -> npt.NDArray[np.float64]:
        """The texture coordinates, (..., 2); NaN where there are none."""
        return self._channel("uv", 2)

    @property
    def range(self) -> npt.NDArray[np.float64]:
        """The distance from the camera's position along the ray, (...); for a camera's hits."""
        camera = self._of_a_camera("range")
        if self._rays is None:
            return self._channel("range")
        if camera.projection == "orthographic":
            return self.z
        behind = np.linalg.norm(self.origin - camera.position, axis=-1)
        return np.asarray(self._arrays[0].reshape(self._shape) + behind)

    @property
    def z(self) -> npt.NDArray[np.float64]:
        """The distance from the camera's position along its aim, (...); for a camera's hits."""
        camera = self._of_a_camera("z")
        if self._rays is None:
            return self._channel("z")
        along = (self.position - camera.position) @ camera.aim
        return np.where(self.object < 0, np.inf, along)

    @property
    def origin(self) -> npt.NDArray[Any]:
        """The rays' starts, (..., 3)."""
        return self._both()[0]

    @property
    def direction(self) -> npt.NDArray[Any]:
        """The rays' directions, (..., 3)."""
        return self._both()[1]

    def __iter__(self) -> Iterator[npt.NDArray[Any]]:
        """Yield ``t`` and ``object``, for ``t, o = hits``."""
        yield self.t
        yield self.object

    def __repr__(self) -> str:
        met = int(np.count_nonzero(self._arrays[1] >= 0))
        return f"Hits(shape={self._shape}, {met:,} of {len(self._arrays[1]):,} rays hit)"

    def __getstate__(self) -> dict[str, Any]:
        """Pickle with the scene, and without what can be computed again."""
        state = {key: value for key, value in self.__dict__.items() if key != "_native_scene"}
        return {**state, "_made": {}}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._native_scene = self._scene._native()

    def _is_single(self) -> bool:
        if self._rays is None:
            return False
        single = (array.dtype.kind == "f" and array.dtype.itemsize <= 4 for array in self._rays[:2])
        return all(single)

    def _of_a_camera(self, name: str) -> Camera:
        if self._camera is None:
            raise AttributeError(f"{name} is for hits of a camera: rays alone do not know of one")
        return self._camera

    def _both(self) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
        if self._rays is not None:
            return self._rays[0], self._rays[1]
        if "origin" not in self._made and self._camera is not None:
            self._made["origin"], self._made["direction"] = self._camera.rays()
        return self._made["origin"], self._made["direction"]

    def _channel(self, name: str, components: int = 1) -> npt.NDArray[Any]:
        if name not in self._made:
            self._made[name] = self._compute(name, components)
        shape = self._shape if components == 1 else (*self._shape, components)
        return self._made[name].reshape(shape)

    def _compute(self, name: str, components: int) -> npt.NDArray[Any]:
        if self._rays is None:
            camera = self._of_a_camera(name)._native
            return _firsthit.channel(self._native_scene, name, None, camera, self._arrays)
        pieces = []
        limits = np.zeros(1), np.full(1, np.inf)
        for part in chunks(len(self._arrays[0])):
            rays = flat(self._rays[0], part, 1), flat(self._rays[1], part, 1), *limits
            hits = tuple(np.ascontiguousarray(array[part]) for array in self._arrays)
            pieces.append(_firsthit.channel(self._native_scene, name, rays, None, hits))
        if len(pieces) == 1:
            return pieces[0]
        if pieces:
            return np.concatenate(pieces)
        dtype = {"front": np.bool_, "face": np.int32}.get(name, np.float64)
        return np.empty(0, dtype)
