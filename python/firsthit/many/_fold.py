"""Answers instead of hits: what a worker makes of its rays before anything is stored.

At 10^12 rays the answers are what costs. A fold is called with the `Hits` of each part, and returns
arrays; its ``merge`` makes one of those of two neighbouring parts. They are merged in the order of
the parts, so the result is the same for any number of workers.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Protocol, cast, runtime_checkable

import numpy as np

from firsthit._base.arrays import numbers, text

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit._queries.hits import Hits
    from firsthit.typing import Asked

#: The names that an array may have.
_NAME = re.compile(r"[A-Za-z0-9_]{1,100}")

Arrays = dict[str, "npt.NDArray[Any]"]


@runtime_checkable
class Fold(Protocol):
    """A function that reduces the hits of a part.

    It must be picklable, as an object of a module's class is, and its ``repr`` must say its
    parameters: a later run knows the job by them.
    """

    def __call__(self, hits: Hits) -> Arrays:
        """Return what the hits of a part come to."""
        ...

    def merge(self, first: Arrays, second: Arrays) -> Arrays:
        """Return what two ranges of rays come to, of which the second begins where one ends."""
        ...


class Sum:
    """The number of hits, and the sum of a channel over them.

    Sums are made of pairs, and of pairs of these, so that rounding is the same on every machine.

    Parameters
    ----------
    channel : str
        A channel of numbers, such as ``t``.
    """

    def __init__(self, channel: str = "t") -> None:
        self.channel = text("channel", channel)

    def __call__(self, hits: Hits) -> Arrays:
        """Return ``count`` and ``sum``."""
        values = _of_hits(hits, self.channel).astype(np.float64)
        return {"count": np.array(len(values)), "sum": _in_pairs(values)}

    def merge(self, first: Arrays, second: Arrays) -> Arrays:
        """Add both."""
        return {name: np.asarray(first[name] + second[name]) for name in first}

    def __repr__(self) -> str:
        return f"Sum({self.channel!r})"


class Minimum:
    """The least value of a channel over the hits, and the ray that has it.

    Of several it is the first. Without hits the value is ``inf`` and the ray -1.

    Parameters
    ----------
    channel : str
        A channel of one number, such as ``t``.
    """

    def __init__(self, channel: str = "t") -> None:
        self.channel = text("channel", channel)

    def __call__(self, hits: Hits) -> Arrays:
        """Return ``value``, ``ray`` and ``rays``, the number of all rays."""
        met = np.flatnonzero(hits.object.reshape(-1) >= 0)
        values = _one_number("Minimum", self.channel, _of_hits(hits, self.channel))
        values = values.astype(np.float64)
        rays = np.array(hits.object.size, np.int64)
        if len(values) == 0:
            return {"value": np.array(np.inf), "ray": np.array(-1, np.int64), "rays": rays}
        at = int(values.argmin())
        return {"value": np.array(values[at]), "ray": np.array(met[at], np.int64), "rays": rays}

    def merge(self, first: Arrays, second: Arrays) -> Arrays:
        """Take the less of both; ``ray`` counts through."""
        rays = np.asarray(first["rays"] + second["rays"])
        if second["ray"] < 0 or (first["ray"] >= 0 and first["value"] <= second["value"]):
            return {**first, "rays": rays}
        ray = np.asarray(first["rays"] + second["ray"])
        return {"value": second["value"], "ray": ray, "rays": rays}

    def __repr__(self) -> str:
        return f"Minimum({self.channel!r})"


class Histogram:
    """The numbers of hits with a channel between edges.

    A value counts in the bin that begins at or below it and ends above it; those outside are in
    ``below`` and ``above``, and misses in neither.

    Parameters
    ----------
    channel : str
        A channel of one number, such as ``t``.
    edges : (n + 1,) array_like
        The ends of n bins, which increase.
    """

    def __init__(self, channel: str, edges: npt.ArrayLike) -> None:
        self.channel = text("channel", channel)
        self.edges = numbers("edges", edges).astype(np.float64)
        if self.edges.ndim != 1 or len(self.edges) < 2 or not (np.diff(self.edges) > 0.0).all():
            raise ValueError(f"edges must be two or more that increase, got {edges!r}")

    def __call__(self, hits: Hits) -> Arrays:
        """Return ``counts``, ``below`` and ``above``."""
        values = _one_number("Histogram", self.channel, _of_hits(hits, self.channel))
        bins = np.searchsorted(self.edges, values, side="right")
        counts = np.bincount(bins, minlength=len(self.edges) + 1)
        return {"counts": counts[1:-1], "below": counts[0], "above": counts[-1]}

    def merge(self, first: Arrays, second: Arrays) -> Arrays:
        """Add both."""
        return {name: np.asarray(first[name] + second[name]) for name in first}

    def __repr__(self) -> str:
        return f"Histogram({self.channel!r}, {self.edges.tolist()})"


class Bits:
    """Whether each ray hits, in bits: the first ray is the lowest bit of the first byte.

    `numpy.unpackbits` with ``count=rays`` and ``bitorder="little"`` gives them back.
    """

    def __call__(self, hits: Hits) -> Arrays:
        """Return ``bits`` and ``rays``."""
        met = hits.object.reshape(-1) >= 0
        return {"bits": np.packbits(met, bitorder="little"), "rays": np.array(met.size, np.int64)}

    def merge(self, first: Arrays, second: Arrays) -> Arrays:
        """Put one behind the other."""
        parts = first, second
        if first["rays"] % 8:
            # The second one's bits do not begin with a byte.
            bits = np.packbits(np.concatenate([_unpacked(one) for one in parts]), bitorder="little")
        else:
            bits = np.concatenate([one["bits"] for one in parts])
        return {"bits": bits, "rays": np.asarray(first["rays"] + second["rays"])}

    def __repr__(self) -> str:
        return "Bits()"


def _unpacked(one: Arrays) -> npt.NDArray[np.uint8]:
    return np.unpackbits(one["bits"], count=int(one["rays"]), bitorder="little")


def checked(result: Any) -> Arrays:
    """Return what a fold returned, as arrays."""
    if not isinstance(result, dict):
        raise TypeError(f"a fold must return a dict of arrays, got {result!r}")
    made = {text("the name of an array", name): np.asarray(one) for name, one in result.items()}
    for name, array in made.items():
        if not _NAME.fullmatch(name) or name in ("file", "allow_pickle"):
            raise ValueError(f"the name of an array must be letters, digits, '_', got {name!r}")
        if array.dtype.kind not in "biufcSU":
            raise TypeError(f"a fold must return arrays of numbers or text, {name!r} is {array!r}")
    return made


def _of_hits(hits: Hits, channel: str) -> npt.NDArray[Any]:
    """Return a channel of the rays that hit, in their order."""
    array: npt.NDArray[Any] = hits.channel(cast("Asked", channel))
    met = hits.object.reshape(-1) >= 0
    return array.reshape(met.size, *array.shape[hits.object.ndim :])[met]


def _one_number(fold: str, channel: str, values: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Refuse a channel of several numbers."""
    if values.ndim != 1:
        raise ValueError(f"{fold} takes a channel of one number, not {channel}")
    return values


def _in_pairs(values: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the sum over the first axis."""
    while len(values) > 1:
        half = len(values) // 2
        rest = values[2 * half :]
        values = np.concatenate([values[:half] + values[half : 2 * half], rest])
    made: npt.NDArray[np.float64] = values.sum(axis=0)
    return made
