"""The parts of a job in a folder: which are there, and what their records say."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from firsthit._base.errors import FileFormatError, FileWriteError, blaming

from .digest import Digests
from .part import discard, name_of, record_of, remove_leftovers

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from .part import Form


#: So many ranges are told one by one.
_MOST = 12


def in_words(ranges: Sequence[range]) -> str:
    """Return ranges as people write them: ``0-4, 7``; of many only the first."""
    told = [
        f"{one.start}" if len(one) == 1 else f"{one.start}-{one.stop - 1}" for one in ranges[:_MOST]
    ]
    text = ", ".join(told)
    rest = sum(len(one) for one in ranges[_MOST:])
    return f"{text} and {rest} more" if rest else text


class Parts:
    """The parts of a job in a folder, of which any may be missing.

    Its work takes time and memory by the parts that are there, not by those that there will be.
    All records name the job, by its digest.
    """

    def __init__(self, out: Path, form: Form, job: str, count: int) -> None:
        self._out, self.form, self._job, self.count = out, form, job, count
        self._folder = out / form.folder
        #: Names are as wide as those of so many.
        self._named = count

    def first(self, count: int) -> Parts:
        """Return the first of these parts only."""
        made = Parts(self._out, self.form, self._job, count)
        made._named = self._named
        return made

    def open(self) -> None:
        """Make the folder, and remove what was left in it long ago."""
        if self._folder.is_symlink():
            raise FileWriteError._of(self._folder, "a link, not the folder of a job")
        with blaming(self._folder, FileWriteError):
            self._folder.mkdir(exist_ok=True)
        remove_leftovers(self._folder)

    def path(self, number: int) -> Path:
        """Return the folder of a part."""
        return self._folder / name_of(number, self._named)

    def record(self, number: int, *, verify: bool = False) -> dict[str, Any] | None:
        """Return the record of a part; ``None`` if it is not whole."""
        return record_of(self.path(number), self.form, self._job, verify=verify)

    def whole(self, wanted: range, *, verify: bool) -> bytearray:
        """Return of each of some parts, up to the last that is whole, whether it is whole.

        Those that are not are removed.
        """
        found = bytearray()
        for number in self.there():
            if number not in wanted:
                continue
            if self.record(number, verify=verify) is not None:
                at = number - wanted.start
                found.extend(bytes(max(0, at + 1 - len(found))))
                found[at] = True
            else:
                discard(self.path(number))
        return found

    def state(self) -> tuple[int, str | None]:
        """Return how many parts are missing, and the digest of all if none is."""
        missing = self.count - sum(1 for _ in self.there())
        if missing:
            # Nothing is read: of many parts each would read what all others made.
            return missing, None
        made = Digests()
        for number in range(self.count):
            record = self.record(number)
            if record is None:
                missing += 1
            else:
                made.add(record["digest"])
        return missing, None if missing else made.text()

    def records(self) -> Iterator[dict[str, Any]]:
        """Return the records of all parts, in their order."""
        return map(self.whole_record, range(self.count))

    def whole_record(self, number: int) -> dict[str, Any]:
        """Return the record of a part that was whole before."""
        record = self.record(number)
        if record is None:
            path = self.path(number)
            raise FileFormatError._of(path, "damaged while it was read")
        return record

    def there(self) -> Iterator[int]:
        """Yield the numbers of the parts whose names are there, in any order."""
        with os.scandir(self._folder) as entries:
            for entry in entries:
                name = entry.name
                if name.isascii() and name.isdigit():
                    number = int(name)
                    if number < self.count and name == name_of(number, self._named):
                        yield number
