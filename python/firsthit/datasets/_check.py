"""What can be known of a plan before anything is made."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ._job import check, check_packages
from ._scenes import Loaded

if TYPE_CHECKING:
    from ._mark import Mark
    from ._plan import Plan


def checked(plan: Plan, threads: int | None) -> list[Mark]:
    """Read all scenes, try what the plan asks of them, and return their marks."""
    check_packages(plan)
    loaded = Loaded(plan._scenes)
    return [check(plan, number, loaded, threads) for number in range(len(plan.scenes))]
