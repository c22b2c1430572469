"""Arrays that workers in other processes map, from files beside the parts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit._parts.digest import of_arrays
from firsthit._parts.files import writing_file

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    import numpy.typing as npt


class SharedArrays:
    """Arrays by name. Pickled they are the names of files, which `share` writes before."""

    def __init__(self, arrays: Mapping[str, npt.NDArray[Any]]) -> None:
        self._arrays = dict(arrays)
        self._digest = of_arrays(self._arrays)
        self._folder: Path | None = None

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        """Return an array."""
        return self._arrays[name]

    def digest(self) -> str:
        """Return the sha256 of all."""
        return self._digest

    def share(self, folder: Path) -> None:
        """Write the files, each whole or not at all, where they are not there."""
        self._folder = folder.absolute()
        for name, array in self._arrays.items():
            path = self._path(name)
            if not _holds(path, array):
                with writing_file(path) as file:
                    np.save(file, array, allow_pickle=False)

    def _path(self, name: str) -> Path:
        assert self._folder is not None  # shared before it is pickled
        return self._folder / f"{name}-{self._digest[:16]}.npy"

    def __getstate__(self) -> dict[str, Any]:
        return {
            "_digest": self._digest,
            "_folder": self._folder,
            "_arrays": {name: self._path(name) for name in self._arrays},
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._arrays = {
            name: np.load(path, mmap_mode="r", allow_pickle=False)
            for name, path in state["_arrays"].items()
        }


def _holds(path: Path, array: npt.NDArray[Any]) -> bool:
    """Tell whether a file has an array, to the last bit."""
    if path.is_symlink() or not path.is_file():
        return False
    try:
        found = np.load(path, mmap_mode="r", allow_pickle=False)
    except (OSError, ValueError, EOFError):
        return False
    is_alike = found.dtype == array.dtype and found.shape == array.shape
    return is_alike and of_arrays({"": found}) == of_arrays({"": array})
