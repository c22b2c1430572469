"""The outlines of masks: polygons along the edges of pixels, and run lengths."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

    Mask = npt.NDArray[np.bool_]
    Floats = npt.NDArray[np.float64]
    Integers = npt.NDArray[np.int64]

#: The directions of edges: right, down, left, up, so that the mask is to the right of each.
_STEPS = np.array([[1, 0], [0, 1], [-1, 0], [0, -1]])
_DOWN, _UP = 1, 3


def run_lengths(mask: Mask) -> list[int]:
    """Return how many pixels are out, in, out, ... column by column from the left, as COCO's."""
    flat = mask.T.reshape(-1)
    changes = np.flatnonzero(flat[1:] != flat[:-1]) + 1
    ends = np.concatenate(([0], changes, [flat.size]))
    counts: list[int] = np.diff(ends).tolist()
    # The first run is of pixels that are out, and may have none.
    return [0, *counts] if flat.size and flat[0] else counts


def compressed(counts: list[int]) -> str:
    """Return run lengths as COCO's text: six bits a character, mostly of differences."""
    text = []
    for k, count in enumerate(counts):
        # From the fourth on: the difference to the run before the last.
        value = count - counts[k - 2] if k > 2 else count
        is_more = True
        while is_more:
            bits = value & 0x1F
            value >>= 5
            # The last group's highest bit is the sign.
            is_more = value != -1 if bits & 0x10 else value != 0
            text.append(chr((bits | 0x20 if is_more else bits) + 48))
    return "".join(text)


def polygons(mask: Mask, *, is_one: bool = False) -> list[Floats]:
    """Return polygons that cover exactly a mask's pixels, by the even-odd rule.

    Each is its corners, (n, 2), columns from the left edge and rows from the upper edge, along the
    edges of pixels. There is one for each part whose pixels touch by edges; a hole is joined to
    what surrounds it by a slit without a width, and with ``is_one`` so are parts that do not touch.
    """
    if not mask.any():
        return []
    ways = _Ways(*_edges(mask))
    outer = ways.join_holes(mask)
    if is_one:
        for first in outer[1:]:
            ways.slit(outer[0], first)
        outer = outer[:1]
    return [ways.corners(first) for first in outer]


def _edges(mask: Mask) -> tuple[Integers, Integers]:
    """Return where the edges between mask and rest start, (n, 2), and in which direction they go.

    Edges are a pixel long, and the mask is to their right.
    """
    held = np.pad(mask, 1)
    inside = held[1:-1, 1:-1]
    # Of a pixel at (x, y) the upper, right, lower and left edge, clockwise.
    neighbours = (
        (held[:-2, 1:-1], 0, 0),
        (held[1:-1, 2:], 1, 0),
        (held[2:, 1:-1], 1, 1),
        (held[1:-1, :-2], 0, 1),
    )
    starts, kinds = [], []
    for kind, (beside, dx, dy) in enumerate(neighbours):
        rows, columns = np.nonzero(inside & ~beside)
        starts.append(np.stack((columns + dx, rows + dy), axis=1))
        kinds.append(np.full(len(rows), kind))
    return np.concatenate(starts), np.concatenate(kinds)


def _following(starts: Integers, kinds: Integers) -> Integers:
    """Return which edge follows each."""
    ends = starts + _STEPS[kinds]
    width = int(ends[:, 0].max()) + 1
    # A number for each place and direction in which an edge starts.
    keys = (starts[:, 1] * width + starts[:, 0]) * 4 + kinds
    order = np.argsort(keys)
    places = (ends[:, 1] * width + ends[:, 0]) * 4
    following = np.full(len(starts), -1)
    # Where two pixels touch by a corner, the turn to the right keeps their outlines apart.
    for turn in (1, 0, 3):
        wanted = places + (kinds + turn) % 4
        found = np.minimum(np.searchsorted(keys, wanted, sorter=order), len(order) - 1)
        is_there = (keys[order[found]] == wanted) & (following < 0)
        following[is_there] = order[found[is_there]]
    return following


class _Ways:
    """Closed ways along edges: which edge comes after which, by their numbers."""

    def __init__(self, starts: Integers, kinds: Integers) -> None:
        following = _following(starts, kinds)
        self._kinds: list[int] = kinds.tolist()
        self._points: list[list[int]] = starts.tolist()
        self._after: list[int] = following.tolist()
        self._before: list[int] = np.argsort(following).tolist()

    def join_holes(self, mask: Mask) -> list[int]:
        """Join every hole to what is left of it; return an edge of each outline."""
        points, kinds = self._points, self._kinds
        upward = {tuple(points[edge]): edge for edge, kind in enumerate(kinds) if kind == _UP}
        # As it is before anything is joined.
        after, outer = self._after[:], []
        for loop in self._loops():
            upright = (edge for edge in loop if kinds[edge] in (_DOWN, _UP))
            edge = min(upright, key=points.__getitem__)
            # The leftmost edges of an outline go up, and those of a hole down.
            if kinds[edge] == _UP:
                outer.append(edge)
                continue
            # From the hole to the left, along the upper edges of pixels, to where the mask ends.
            # The outline there begins farther left, so that no holes are joined in a circle.
            x, y = points[edge]
            gaps = np.flatnonzero(~mask[y, :x])
            border = int(gaps[-1]) + 1 if len(gaps) else 0
            self.slit(after[upward[border, y + 1]], edge)
        return outer

    def _loops(self) -> list[list[int]]:
        loops, is_seen = [], [False] * len(self._after)
        for first in range(len(self._after)):
            loop, at = [], first
            while not is_seen[at]:
                is_seen[at] = True
                loop.append(at)
                at = self._after[at]
            if loop:
                loops.append(loop)
        return loops

    def slit(self, a: int, b: int) -> None:
        """Join two ways at the starts of two edges: from one to the other, around, and back."""
        # Both starts are there twice: to go on from, and to come back to.
        back, out = len(self._points), len(self._points) + 1
        self._points += [self._points[b], self._points[a]]
        last, rest = self._before[b], self._after[a]
        self._after += [out, rest]
        self._before += [last, back]
        self._after[last], self._after[a] = back, b
        self._before[b], self._before[rest] = a, out

    def corners(self, first: int) -> Floats:
        """Return a way without the points on straight lines."""
        way, at = [self._points[first]], self._after[first]
        while at != first:
            way.append(self._points[at])
            at = self._after[at]
        places = np.array(way, np.float64)
        come, go = places - np.roll(places, 1, axis=0), np.roll(places, -1, axis=0) - places
        turns = come[:, 0] * go[:, 1] - come[:, 1] * go[:, 0]
        # Where a way turns back on itself is a corner, too.
        is_corner = (turns != 0.0) | ((come * go).sum(axis=1) < 0.0)
        found: Floats = places[is_corner]
        return found
