"""Attributes of meshes where rays met them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import chunks, filled, lock, text, threads_or_all
from firsthit._base.progress import following, later

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit._base.types import AttributeOf, Progress
    from firsthit._objects.traceable import Built

    from .source import Arrays


class Attributed:
    """Hits that know the attributes of the meshes that were hit."""

    _built: Built
    _arrays: Arrays
    _shape: tuple[int, ...]
    _threads: int
    _made: dict[str, npt.NDArray[Any]]

    @property
    def attributes(self) -> tuple[str, ...]:
        """The names of the attributes that the scene's meshes have, sorted."""
        known = _firsthit.attribute_names(self._built.native)
        return tuple(dict.fromkeys(name for name, _, _ in known))

    def attribute(
        self,
        name: str,
        *,
        of: AttributeOf | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
        out: Any = None,
    ) -> npt.NDArray[np.float64]:
        """Return an attribute of the meshes that were hit, at each hit.

        It is one of the numbers by name that a file or a program gave a mesh
        (`Mesh.vertex_properties`, `Mesh.face_properties`, `Mesh.corner_properties`), or the mesh's
        ``normals``, ``uvs``, ``colors`` or ``alphas``.

        Parameters
        ----------
        name : str
            One of `attributes`.
        of : str, optional
            ``"vertices"``, ``"corners"`` or ``"faces"``, where several have an attribute of this
            name. If left out, that of the corners comes before that of the vertices, that before
            the one of the faces, and ``normals``, ``uvs``, ``colors`` and ``alphas`` come last.
        threads : int, optional
            The number of threads; as many as the rays were shot with if left out.
        progress : bool or callable, optional
            As for `Scene.shoot`. What was looked up before reports nothing.
        out : array, optional
            As for `Hits.channel`.

        Returns
        -------
        (...) or (..., k) array of float64
            Between the corners of a triangle with the weights ``w`` of `barycentric`, numbers
            ``v`` are ``w[0] * v[0] + w[1] * v[1] + w[2] * v[2]``, added from left to right; corners
            of weight zero do not count. Labels, which are the integers of a file and of a
            program, are those of the corner with the largest weight, of equal ones the first.
            Faces have their own. NaN for a miss, for shapes that are no mesh, and for meshes
            without the attribute. There are ``k`` numbers if a mesh of the scene has so many;
            the rest is NaN where a mesh has fewer. The same memory at every call, read-only.

        Raises
        ------
        ValueError
            For a name that no mesh of the scene has, and an ``out`` of another shape.
        MemoryError
            If the array does not fit into memory.

        Examples
        --------
        >>> import firsthit as fh
        >>> corners = [[0, 0, 0], [4, 0, 0], [0, 4, 0]]
        >>> heat = {"heat": [10.0, 20.0, 40.0]}
        >>> scene = fh.Scene()
        >>> scene.add(fh.Mesh(corners, [[0, 1, 2]], vertex_properties=heat))
        0
        >>> hits = scene.shoot([[1, 2, 5], [9, 9, 5]], [0, 0, -1])
        >>> hits.attribute("heat")
        array([27.5,  nan])
        >>> hits["heat"]
        array([27.5,  nan])
        """
        use = self._threads if threads is None else threads_or_all(threads)
        name = text("name", name)
        if of is not None:
            text("of", of)
        # No channel is called so.
        key = f"attribute {of} {name}"
        if key not in self._made:
            length = len(self._arrays[0])
            with following(progress, length) as report:
                pieces = []
                for part in list(chunks(length)) or [slice(0, 0)]:
                    hits = tuple(np.ascontiguousarray(array[part]) for array in self._arrays)
                    told = later(report, part.start)
                    pieces.append(
                        _firsthit.attribute(self._built.native, (name, of), hits, use, told)
                    )
            values = [flat.reshape(-1, components) for components, flat in pieces]
            made = values[0] if len(values) == 1 else np.concatenate(values)
            # Another thread may have made it meanwhile: the first array is everyone's.
            self._made.setdefault(key, made)
        found = self._made[key]
        lock(found)
        components = found.shape[1]
        shaped = found.reshape(self._shape if components == 1 else (*self._shape, components))[()]
        return shaped if out is None else filled(out, shaped)
