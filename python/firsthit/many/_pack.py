"""The parts of a job as tar files for training, in the form that WebDataset reads."""

from __future__ import annotations

import hashlib
import io
import os
import re
import tarfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, NamedTuple
from urllib.parse import quote

from firsthit._base.arrays import count, flag
from firsthit._base.errors import FileFormatError, FileReadError, FileWriteError, blaming
from firsthit._base.progress import following
from firsthit._parts.digest import Digests, canonical, of_file, of_json
from firsthit._parts.files import writing_file
from firsthit._parts.folder import in_words
from firsthit._parts.job import known_job, refuse_other, write_job
from firsthit._parts.part import remove_leftovers
from firsthit._parts.records import open_inside

from ._parts_of import found

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from firsthit.typing import Progress

    from ._parts_of import Found

#: The file beside shards that says of which job they are and what is in them.
INDEX = "pack.json"

#: Counts up when the same job is packed to other bytes.
_ANSWER = 1

#: The names that may be in the folder: shards, the index, and what a killed run left of these.
_SHARD = re.compile(r"shard-[0-9]{6,}\.tar")
_LEFT = re.compile(r"\.(shard-[0-9]{6,}\.tar|pack\.json)\.[0-9a-f]+(\.tmp)?")

#: A tar has blocks of this size; so many blocks are a record, and a tar is a number of records.
_BLOCK, _RECORD = tarfile.BLOCKSIZE, tarfile.RECORDSIZE


class Packed(NamedTuple):
    """The result of packing.

    Attributes
    ----------
    shards : tuple of Path
        The tar files, in their order.
    samples : int
        How many samples are in them.
    parts : int
        How many parts they are of.
    missing : int
        How many parts were left out, since they are not there. Of a stream of rays that has not
        come to its end these are the ones between others.
    bytes : int
        The size of all shards together.
    """

    shards: tuple[Path, ...]
    samples: int
    parts: int
    missing: int
    bytes: int


def pack(
    folder: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    size: int = 1_000_000_000,
    parts: int | None = None,
    partial: bool = False,
    progress: Progress | None = None,
) -> Packed:
    """Pack the parts of a job, or the frames of a data set, into tar files.

    The files are ``shard-000000.tar`` and so on, and `WebDataset
    <https://github.com/webdataset/webdataset>`_ reads them. A sample is a picture, the hits of a
    part, or what one sensor sees in a frame: its files have one key, ``PART-NAME``, and follow each
    other: ``000012-eye.json``, ``000012-eye.color.png``, ``000012-eye.npz``. The ``.json`` is the
    part's record, as far as it is about this sample. ``pack.json`` lists the shards.

    The same parts come to the same bytes. The sha256 of every file is compared with its record. A
    shard has its name when it is whole; a run that was stopped goes on.

    Parameters
    ----------
    folder : path-like
        The folder of `render_many`, `shoot_many`, `visible_many` or `dataset`.
    out : path-like
        Where the shards go; the folder is made. One with anything but shards of the same job is
        refused.
    size : int
        The most bytes of a shard, if it has more than one sample.
    parts : int, optional
        Instead of ``size``: of how many parts a shard is.
    partial : bool
        Whether to pack what is there while other parts are missing.
    progress : bool or callable, optional
        ``True`` for a line on standard error with the time left, or a function that is called with
        the parts that are packed and their number.

    Returns
    -------
    Packed
        The shards, and how many samples there are.

    Raises
    ------
    FileReadError, FileFormatError
        For a folder that is that of no job, parts that are missing, a file that is not what its
        record says, and files of one sample that WebDataset could not tell apart.
    FileWriteError
        If the system refuses to write, and for a folder that has something else in it.
    ValueError, TypeError
        For numbers that are none of sizes, and flags that are none.

    Examples
    --------
    >>> scene = fh.Scene()
    >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
    0
    >>> camera = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 45, rows=3, columns=3)
    >>> made = fh.render_many(scene, {"front": camera}, "one", channels="z", save=".npz")
    >>> packed = fh.many.pack("one", "shards")
    >>> [path.name for path in packed.shards], packed.samples
    (['shard-000000.tar'], 1)
    >>> import tarfile
    >>> with tarfile.open("shards/shard-000000.tar") as tar:
    ...     tar.getnames()
    ['000000-front.json', '000000-front.npz']
    """
    source, into, is_partial = Path(folder), Path(out), flag("partial", partial)
    split = {"size": count("size", size, 1)}
    if parts is not None:
        split = {"parts": count("parts", parts, 1)}
    job = found(source, verify=False)
    if job.state.missing and not is_partial:
        which = f": {in_words(job.missing)}" if job.is_ended else ", nobody knows yet how many"
        raise FileFormatError._of(source, f"parts are missing{which}; partial packs what is there")
    if not job.state.done:
        raise FileFormatError._of(source, "no part is there that could be packed")
    records = Digests()
    for record in job.records():
        records.add(of_json(record))
    said = {
        "answer": _ANSWER,
        "job": job.digest,
        "parts": job.state.done,
        "missing": [[one.start, one.stop - 1] for one in job.missing],
        "records": records.text(),
        "split": split,
    }
    listed = _claim(into, said)
    if listed is None:
        with following(progress, job.state.done, 0, "parts") as report:
            listed = [
                _shard(into / f"shard-{number:06d}.tar", samples, report)
                for number, samples in enumerate(_shards(job, split))
            ]
        _refuse_strange(into, {one["name"] for one in listed})
        write_job(into / INDEX, {**said, "shards": listed})
    return Packed(
        tuple(into / one["name"] for one in listed),
        sum(one["samples"] for one in listed),
        job.state.done,
        sum(len(one) for one in job.missing),
        sum(one["bytes"] for one in listed),
    )


class _File(NamedTuple):
    """A file of a sample: its name in the part and in the tar, and what its record says."""

    name: str
    member: str
    bytes: int
    sha256: str


class _Sample(NamedTuple):
    """Files of one key, and their record. ``part`` counts the parts up to this one."""

    folder: Path
    part: int
    record: tuple[str, bytes]
    files: list[_File]

    def size(self) -> int:
        """Return how many bytes of a tar it takes."""
        name, content = self.record
        own = _in_tar(name, len(content))
        return own + sum(_in_tar(file.member, file.bytes) for file in self.files)


def _shards(job: Found, split: dict[str, int]) -> Iterator[list[_Sample]]:
    """Yield the samples of each shard."""
    most, parts = split.get("size", 0), split.get("parts")
    held: list[_Sample] = []
    first = room = 0
    for sample in _samples(job):
        size = sample.size()
        is_full = sample.part > first + parts if parts is not None else _tar_of(room + size) > most
        if held and is_full:
            yield held
            held, room = [], 0
            first = sample.part - 1
        held.append(sample)
        room += size
    if held:
        yield held


def _samples(job: Found) -> Iterator[_Sample]:
    """Yield the samples of all parts that are there, by part and then by name."""
    for part, (number, record) in enumerate(zip(job.numbers(), job.records(), strict=True), 1):
        folder = job.parts.path(number)
        files: dict[str, list[str]] = {}
        for name in sorted(record["files"]):
            files.setdefault(_stem(name, record), []).append(name)
        for stem in sorted(files):
            # WebDataset takes what is before the first dot for the key. None is in what is quoted.
            key = f"{folder.name}-{_quoted(stem).replace('.', '%2E')}"
            made = [
                _File(name, f"{key}{_extension(name, stem)}", int(known["bytes"]), known["sha256"])
                for name in files[stem]
                for known in [record["files"][name]]
            ]
            content = canonical(_of_sample(record, stem, files[stem])) + b"\n"
            sample = _Sample(folder, part, (f"{key}.json", content), made)
            _refuse_alike(sample)
            yield sample


def _stem(name: str, record: dict[str, Any]) -> str:
    """Return of which picture, sensor or result a file is. Names of pictures may have dots."""
    pictures = record.get("pictures")
    named = [
        one
        for one in (pictures if isinstance(pictures, list) else ())
        if isinstance(one, str) and name.startswith(f"{one}.")
    ]
    return max(named, key=len) if named else name.split("/")[0].split(".")[0]


def _extension(name: str, stem: str) -> str:
    """Return what is behind the stem, with a dot; files in folders have more of them."""
    return _quoted(name[len(stem) :].replace("/", "."))


def _quoted(text: str) -> str:
    """Return a text of letters, digits and ``_.-~%`` only, which is safe as a name anywhere."""
    return quote(os.fsencode(text), safe="")


def _of_sample(record: dict[str, Any], stem: str, files: list[str]) -> dict[str, Any]:
    """Return the record of a part as far as it is about one of its samples."""
    said = {**record, "files": {name: record["files"][name] for name in files}}
    if isinstance(record.get("pictures"), list):
        said["pictures"] = [stem]
    if isinstance(record.get("annotations"), dict):
        held = record["annotations"]
        said["annotations"] = {stem: held[stem]} if stem in held else {}
    return said


def _refuse_alike(sample: _Sample) -> None:
    """Refuse files of a sample that are one to WebDataset, which reads extensions in lower case."""
    known = {sample.record[0].lower()}
    for file in sample.files:
        if file.member.lower() in known or "." not in file.member:
            what = "has no extension of its own in lower case, by which WebDataset tells files"
            raise FileFormatError._of(sample.folder / file.name, what)
        known.add(file.member.lower())


def _shard(
    path: Path, samples: list[_Sample], report: Callable[[int], object] | None
) -> dict[str, Any]:
    """Write a shard, unless a run that was stopped has; return what the index says of it."""
    size = _tar_of(sum(sample.size() for sample in samples))
    if _has_size(path, size):
        sha256 = _read(path)
        if report is not None:
            report(samples[-1].part)
    else:
        with writing_file(path) as file:
            told = _Written(file)
            with tarfile.open(fileobj=told, mode="w", format=tarfile.PAX_FORMAT) as tar:
                for sample in samples:
                    _add(tar, sample)
                    if report is not None:
                        report(sample.part)
            sha256 = told.sha256.hexdigest()
    return {"name": path.name, "samples": len(samples), "bytes": size, "sha256": sha256}


def _read(path: Path) -> str:
    with blaming(path, FileReadError):
        return of_file(path)


def _has_size(path: Path, size: int) -> bool:
    return path.is_file() and not path.is_symlink() and path.stat().st_size == size


def _add(tar: tarfile.TarFile, sample: _Sample) -> None:
    """Put a sample into a tar: its record first."""
    name, content = sample.record
    tar.addfile(_entry(name, len(content)), io.BytesIO(content))
    for file in sample.files:
        path = sample.folder / file.name
        try:
            opened = open_inside(sample.folder, file.name)
        except (OSError, ValueError) as error:
            raise FileReadError._of(path, f"{error}") from None
        with opened:
            told = _Read(opened, path)
            tar.addfile(_entry(file.member, file.bytes), told)
            if told.sha256.hexdigest() != file.sha256 or opened.read(1):
                raise FileFormatError._of(path, _DAMAGED)


_DAMAGED = "its sha256 is not that of its record; a run with verify makes the part again"


class _Written(io.RawIOBase):
    """A file that `tarfile` writes, with the sha256 of what was written."""

    def __init__(self, file: BinaryIO) -> None:
        self._file, self.sha256 = file, hashlib.sha256()

    def write(self, piece: bytes) -> int:  # type: ignore[override]
        self.sha256.update(piece)
        return self._file.write(piece)

    def tell(self) -> int:
        return self._file.tell()


class _Read(io.RawIOBase):
    """A file of a part that `tarfile` reads, with the sha256 of what was read."""

    def __init__(self, file: BinaryIO, path: Path) -> None:
        self._file, self._path, self.sha256 = file, path, hashlib.sha256()

    def read(self, size: int = -1) -> bytes:
        with blaming(self._path, FileReadError):
            piece = self._file.read(size)
        if len(piece) < size:
            raise FileFormatError._of(self._path, _DAMAGED)
        self.sha256.update(piece)
        return piece


def _entry(name: str, size: int) -> tarfile.TarInfo:
    """Return the header of a file: nothing of the machine, the user or the time is in it."""
    made = tarfile.TarInfo(name)
    made.size, made.mode = size, 0o644
    return made


def _in_tar(name: str, size: int) -> int:
    """Return how many bytes a file takes in a tar."""
    header = len(_entry(name, size).tobuf(tarfile.PAX_FORMAT))
    return header + -(-size // _BLOCK) * _BLOCK


def _tar_of(content: int) -> int:
    """Return how many bytes a tar has: it ends with two empty blocks, and fills whole records."""
    return -(-(content + 2 * _BLOCK) // _RECORD) * _RECORD


def _claim(into: Path, said: dict[str, Any]) -> list[dict[str, Any]] | None:
    """Make the folder that of these shards; return them if all are there."""
    path = into / INDEX
    with blaming(into, FileWriteError):
        into.mkdir(parents=True, exist_ok=True)
    known = known_job(path)
    _refuse_strange(into, None if known is not None else set())
    remove_leftovers(into)
    if known is None:
        write_job(path, said)
        return None
    refuse_other(path, known, said)
    try:
        listed: list[dict[str, Any]] = [
            {"name": str(one["name"]), "samples": int(one["samples"]), "bytes": int(one["bytes"])}
            for one in known["shards"]
        ]
    except (KeyError, TypeError, ValueError):
        return None
    is_there = all(
        _SHARD.fullmatch(one["name"]) and _has_size(into / one["name"], one["bytes"])
        for one in listed
    )
    _refuse_strange(into, {one["name"] for one in listed} if is_there else None)
    return listed if is_there else None


def _refuse_strange(into: Path, shards: set[str] | None) -> None:
    """Refuse a folder with anything but the index and some shards: ``None`` for any."""
    with blaming(into, FileWriteError):
        names = sorted(os.listdir(into))  # noqa: PTH208 - names are all that is asked for
    for name in names:
        is_shard = _SHARD.fullmatch(name) and (shards is None or name in shards)
        if not (is_shard or name == INDEX or _LEFT.fullmatch(name)):
            why = f"there is {name} in it, which is not of these shards; take another folder"
            raise FileWriteError._of(into, why)
