"""Numbers of parts in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

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
