"""Checks of a plan before anything is made."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from ._job import check, check_packages

if TYPE_CHECKING:
    from firsthit._parts.mark import Mark
    from firsthit._scene.scene import Scene
    from firsthit.typing import Vector

    from ._plan import Plan
    from ._scenes import PlannedScene


class Checked(NamedTuple):
    """The facts that a check found about a scene."""

    mark: Mark
    #: Which way is up in it.
    up: Vector
    #: Who says so, in the words of ``firsthit info``.
    up_source: str


def checked(plan: Plan, threads: int | None) -> list[Checked]:
    """Read all scenes, try what the plan asks of them, and return what is known of each."""
    check_packages(plan)
    found = []
    for number, planned in enumerate(plan._scenes):
        scene = planned.load()
        mark = check(plan, number, scene, threads)
        found.append(Checked(mark, scene.up, _up_source(planned, scene)))
    return found


def _up_source(planned: PlannedScene, scene: Scene) -> str:
    if planned.up is not None:
        return "as the plan says"
    if not scene._up_is_guessed:
        return "as the file says"
    if scene.up == scene._up:
        return "by the format's convention"
    return "guessed from a flat base"
