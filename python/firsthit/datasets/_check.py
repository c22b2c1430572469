"""What can be known of a plan before anything is made."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ._job import check
from ._scenes import Loaded

if TYPE_CHECKING:
    from ._plan import Plan


def checked(plan: Plan, threads: int | None) -> list[str]:
    """Read all scenes, try what the plan asks of them, and return their fingerprints."""
    loaded = Loaded(plan._scenes)
    return [check(plan, number, loaded, threads) for number in range(len(plan.scenes))]
