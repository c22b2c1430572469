"""Scenes that workers share: a file that each maps, and the last few that a worker has opened."""

from __future__ import annotations

import json
import os
import threading
from typing import TYPE_CHECKING, Any, NamedTuple

from firsthit import _firsthit
from firsthit._base.errors import FileFormatError
from firsthit._looks.lights import background_native
from firsthit._scene.load import load
from firsthit._scene.load import open as open_built
from firsthit._sensors.camera import Camera

from .digest import finite, of_json

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from firsthit._scene.scene import Scene


class Mark(NamedTuple):
    """The digests of all that a scene's frames depend on."""

    #: Of its objects and lights, as the metadata of pictures have it.
    fingerprint: str
    #: The sha256 of what that leaves out, and frames depend on: names, up, background, shading,
    #: display, and edges if there are any.
    setting: str


def mark_of(scene: Scene) -> Mark:
    """Return the mark of a scene."""
    native = scene._ready().native
    camera = Camera((0, 0, 0), (1, 0, 0), (0, 0, 1), 1, 1, 1, 1, 1)
    fingerprint = json.loads(_firsthit.origin(native, camera._native, ["object"]))["scene"]
    look, background = scene.shading._native(), scene.background
    back = None if background is None else background_native(background)
    names = [(made.name, made.node, made.mesh_name) for made in scene.objects]
    said: list[Any] = [list(scene.up), back, look, scene.display._native, names]
    if scene.edges is not None:
        said.append(scene.edges._native())
    return Mark(fingerprint, of_json(finite(said)))


#: How many scenes a worker keeps.
_KEPT = 2

_opened: dict[tuple[str, str, Mark], Scene] = {}
_lock = threading.Lock()

#: The end of a built scene's name.
BUILT = ".fhs"


class SharedScene:
    """A scene as a worker gets it.

    In this process it is the scene itself. Pickled it is the name of a file, which is opened and
    compared with its mark when the scene is first asked for.
    """

    def __init__(self, run: str, path: Path | None, mark: Mark, scene: Scene | None) -> None:
        self.run, self.path, self.mark, self._scene = run, path, mark, scene

    def __reduce__(self) -> tuple[object, ...]:
        if self.path is None:
            raise ValueError("the scene has no file for workers in other processes")
        return SharedScene, (self.run, self.path, self.mark, None)

    def get(self) -> Scene:
        """Return the scene."""
        if self._scene is None:
            assert self.path is not None
            self._scene = opened(self.run, self.path, self.mark)
        return self._scene

    def save(self, path: Path) -> None:
        """Write the file that workers open, unless there is one."""
        if self.path is not None:
            return
        assert self._scene is not None
        if not _is_there(path, self.mark):
            # The file that was read is not written over.
            path.unlink(missing_ok=True)
            self._scene.save(path)
        self.path = path


def opened(run: str, path: Path, mark: Mark, up: Sequence[float] | None = None) -> Scene:
    """Return the scene of a file, which is read once by each process of a run.

    A later run reads it again: it may be another by then. A `FileFormatError` if it is not the
    scene of the mark.
    """
    key = run, os.fspath(path), mark
    with _lock:
        scene = _opened.pop(key, None)
        if scene is None:
            scene = read(path, up)
            refuse_changed(path, mark_of(scene), mark)
        _keep(key, scene)
        return scene


def keep(run: str, path: Path, mark: Mark, scene: Scene) -> None:
    """Have a scene that was read already at hand."""
    with _lock:
        _keep((run, os.fspath(path), mark), scene)


def forget(run: str) -> None:
    """Let go of the scenes of a run that has ended."""
    with _lock:
        for key in [key for key in _opened if key[0] == run]:
            del _opened[key]


def _keep(key: tuple[str, str, Mark], scene: Scene) -> None:
    while len(_opened) >= _KEPT:
        del _opened[next(iter(_opened))]
    _opened[key] = scene


def read(path: Path, up: Sequence[float] | None = None) -> Scene:
    """Return the scene of a file: mapped if it is built."""
    scene = open_built(path) if path.suffix.lower() == BUILT else load(path)
    if up is not None:
        scene.up = up
    return scene


def refuse_changed(path: Path, found: Mark, wanted: Mark) -> None:
    """Refuse a scene that is not what it was when a job began."""
    for name, value in found._asdict().items():
        if value != getattr(wanted, name):
            why = f"its {name} is {value}, not {getattr(wanted, name)}"
            raise FileFormatError._of(path, f"not what it was when the job began: {why}")


def _is_there(path: Path, mark: Mark) -> bool:
    try:
        return path.is_file() and not path.is_symlink() and mark_of(open_built(path)) == mark
    except (OSError, ValueError):
        return False
