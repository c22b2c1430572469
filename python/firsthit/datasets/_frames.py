"""The folder of frames: which are there, and what their records say."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from firsthit._errors import FileFormatError, FileWriteError

from ._digest import Digests
from ._part import discard, name_of, record_of, remove_leftovers

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


class Frames:
    """The frames of a plan in a folder, of which any may be missing.

    What it does takes time and memory by the frames that are there, not by those that are planned.
    """

    def __init__(self, folder: Path, plan: str, count: int) -> None:
        self._folder, self._plan, self._count = folder, plan, count

    def open(self) -> None:
        """Make the folder, and remove what was left in it long ago."""
        try:
            self._folder.mkdir(exist_ok=True)
        except OSError as error:
            name = os.fspath(self._folder)
            raise FileWriteError(f"{name}: {error.strerror or error}", name) from error
        remove_leftovers(self._folder)

    def path(self, frame: int) -> Path:
        """Return the folder of a frame."""
        return self._folder / name_of(frame, self._count)

    def whole(self, wanted: range, *, verify: bool) -> set[int]:
        """Return those of some frames that are whole; what is not is removed."""
        found = set()
        for frame in self._there():
            if frame not in wanted:
                continue
            path = self.path(frame)
            if record_of(path, self._plan, verify=verify) is not None:
                found.add(frame)
            else:
                discard(path)
        return found

    def state(self) -> tuple[int, str | None]:
        """Return how many frames are missing, and the digest of all if none is."""
        missing = self._count - sum(1 for _ in self._there())
        if missing:
            # Nothing is read: of many parts each would read what all others made.
            return missing, None
        made = Digests()
        for path in self._paths():
            record = record_of(path, self._plan)
            if record is None:
                missing += 1
            else:
                made.add(record["digest"])
        return missing, None if missing else made.text()

    def records(self) -> Iterator[dict[str, Any]]:
        """Yield the records of all frames, in their order."""
        for path in self._paths():
            record = record_of(path, self._plan)
            if record is None:
                raise FileFormatError(f"{path}: damaged while it was read", os.fspath(path))
            yield record

    def _there(self) -> Iterator[int]:
        with os.scandir(self._folder) as entries:
            for entry in entries:
                name = entry.name
                if name.isascii() and name.isdigit():
                    frame = int(name)
                    if frame < self._count and name == name_of(frame, self._count):
                        yield frame

    def _paths(self) -> Iterator[Path]:
        return map(self.path, range(self._count))
