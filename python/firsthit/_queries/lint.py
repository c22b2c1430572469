"""Checks of meshes for likely faults."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from firsthit import _firsthit
from firsthit._base.arrays import locked
from firsthit._base.progress import following
from firsthit._objects.object import identified

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator

    import numpy as np
    import numpy.typing as npt

    from firsthit._objects.traceable import Built
    from firsthit.typing import ObjectKey, Progress


class Place(NamedTuple):
    """The place of a finding."""

    #: The object's identifier; of objects that share a mesh the first in which it is found.
    #: ``None`` where the finding is about the whole scene.
    object: int | None
    #: A triangle of its mesh; ``None`` where the finding is about none.
    primitive: int | None
    #: A point in world space, (3,) float64; NaN where the finding is that a vertex is nowhere.
    position: npt.NDArray[np.float64]

    def __eq__(self, other: Any) -> bool:
        return isinstance(other, Place) and self._key() == other._key()

    def __ne__(self, other: Any) -> bool:
        return not self == other

    def __hash__(self) -> int:
        return hash(self._key())

    def _key(self) -> tuple[int | None, int | None, bytes]:
        """Return what two places have to have in common; of an array, `==` is an array."""
        return self.object, self.primitive, self.position.tobytes()


@dataclass(frozen=True)
class Finding:
    """All of one kind that was found."""

    #: The name of the kind, one of `LintReport.kinds`.
    kind: str
    #: How many edges, faces, vertices, ... there are.
    count: int
    #: More about all of them, in words; may be empty.
    note: str
    #: The first of them, as many as were asked for.
    places: tuple[Place, ...]


class LintReport:
    """The findings about a scene, from `Scene.lint`. Iterating gives them. Read-only."""

    def __init__(
        self,
        built: Built,
        ignore: tuple[str, ...],
        places: int,
        threads: int,
        progress: Progress | None = None,
    ) -> None:
        self._built, self._settings = built, (ignore, places)
        with following(progress) as report:
            self._native = _firsthit.Lint(built.native, list(ignore), places, threads, report)
        self._findings = tuple(
            Finding(kind, count, note, tuple(Place(o, p, locked(xyz)) for o, p, xyz in places))
            for kind, count, note, places in self._native.findings()
        )

    @property
    def findings(self) -> tuple[Finding, ...]:
        """A finding for each kind that there is."""
        return self._findings

    @property
    def is_clean(self) -> bool:
        """Whether nothing was found."""
        return not self._findings

    @property
    def checked(self) -> tuple[str, ...]:
        """The names of the kinds that were looked for."""
        return tuple(self._native.checked())

    @property
    def kinds(self) -> dict[str, str]:
        """Every kind's name and meaning."""
        return dict(_firsthit.lint_kinds())

    def marked(self, identifier: ObjectKey) -> npt.NDArray[np.bool_]:
        """Tell which triangles of an object are part of a finding.

        Parameters
        ----------
        identifier : int or str
            The object's identifier; or its name, if no other object has it.

        Returns
        -------
        (n,) array of bool
            One for each triangle of its mesh.

        Raises
        ------
        IndexError
            For an identifier that no object has, and for an object that is no mesh.
        ValueError
            For a name that no object has, or several.
        TypeError
            For what is no identifier and no name.
        """
        marked = self._native.marked(identified(self._built.objects, identifier))
        if marked is None:
            raise IndexError(f"object {identifier!r} is no mesh")
        return marked

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write all meshes to a PLY file whose faces are coloured by what is wrong with them.

        Parameters
        ----------
        path : path-like
            A file in ``.ply``, written whole or not at all.

        Raises
        ------
        ValueError
            For another extension.
        MemoryError
            If there is too little memory.
        FileWriteError
            If the system refuses to write it; an old file is as it was. Also an `OSError`.
        """
        self._native.save(self._built.native, Path(path))

    def __len__(self) -> int:
        """Return the number of findings."""
        return len(self._findings)

    def __iter__(self) -> Iterator[Finding]:
        return iter(self._findings)

    def __bool__(self) -> bool:
        """Raise a `TypeError`: `is_clean` tells, and nobody could say which of both is true."""
        raise TypeError("a LintReport is neither true nor false: ask for its is_clean")

    def __repr__(self) -> str:
        found = ", ".join(f"{finding.kind}: {finding.count}" for finding in self._findings)
        return f"LintReport({found or 'clean'})"

    def _repr_html_(self) -> str:
        """Show it at a glance, for notebooks."""
        from firsthit._files.glance import of_lint

        return of_lint(self)

    def __reduce__(self) -> tuple[Any, ...]:
        return LintReport, (self._built, *self._settings, 0)
