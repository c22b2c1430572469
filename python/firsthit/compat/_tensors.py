"""Open3D's tensors and meshes, without importing it."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from firsthit._base.arrays import cast, vectors

from ._foreign_meshes import is_of

if TYPE_CHECKING:
    import numpy.typing as npt


class Tensor(Protocol):
    """An ``open3d.core.Tensor``."""

    def cpu(self) -> Any:
        """Return the tensor in the memory of the CPU."""

    def numpy(self) -> npt.NDArray[Any]:
        """Return it as an array."""


class Asked(NamedTuple):
    """The array that is asked about, and the form of the answers."""

    array: npt.NDArray[Any]
    dtype: type[np.float32] | type[np.float64]
    #: Where tensors are to be; ``None`` for arrays.
    device: Any

    def rays(self) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
        """Return origins and directions."""
        return self.array[..., :3], self.array[..., 3:]

    def number(self, made: npt.NDArray[Any]) -> Any:
        """Return numbers in the type and the kind of what was asked."""
        return self.answer(cast(made, self.dtype))

    def identifier(self, made: npt.NDArray[np.int32]) -> Any:
        """Return identifiers; -1 becomes ``INVALID_ID``."""
        return self.answer(made.astype(np.uint32))

    def answer(self, made: npt.NDArray[Any]) -> Any:
        """Return an array or a tensor."""
        return like(self.device, made)


def array_of(value: Any) -> Any:
    """Return a tensor as an array; anything else as it is."""
    return value.cpu().numpy() if is_tensor(value) else value


def is_tensor(value: object) -> bool:
    """Tell whether something is a tensor of Open3D's."""
    return is_of("open3d", value) and hasattr(value, "cpu") and hasattr(value, "numpy")


def like(device: Any, made: npt.NDArray[Any]) -> Any:
    """Return an array that can be written, or a tensor on a device."""
    own = np.array(made, order="C")
    if device is None:
        return own
    # It is loaded, since something was its own.
    core = sys.modules["open3d"].core
    return core.Tensor.from_numpy(own).to(core.Device(str(device)))


def parts_of(mesh: Any) -> tuple[Any, Any]:
    """Return the vertices and the triangles of a mesh."""
    if hasattr(mesh, "vertex") and hasattr(mesh, "triangle"):
        return mesh.vertex["positions"], mesh.triangle["indices"]
    if hasattr(mesh, "vertices") and hasattr(mesh, "triangles"):
        return np.asarray(mesh.vertices), np.asarray(mesh.triangles)
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
        return mesh.vertices, mesh.faces
    raise ValueError("triangle_indices must be given with an array of vertices")


def or_zero(is_there: npt.NDArray[np.bool_], values: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return values, and zero where there is nothing."""
    return np.where(is_there[..., None], values, 0.0)


def asked_about(name: str, given: Any, columns: int, *, wants_tensors: bool) -> Asked:
    """Return what was asked about, (..., columns), and what answers are to be like."""
    array = vectors(name, array_of(given), columns)
    # Lists have no type that anyone chose.
    is_double = hasattr(given, "dtype") and array.dtype == np.float64
    device = given.device if is_tensor(given) else "CPU:0" if wants_tensors else None
    return Asked(array, np.float64 if is_double else np.float32, device)
