"""The subgoals of a task as facts of physics: those that an action brings about, and those that have to stay."""

from __future__ import annotations

from dataclasses import dataclass

from prag_asp.physics import physical_task
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import Fact, facts
from prag_asp.scene.scene import Scene
from prag_asp.task import Task

BROUGHT = 6
"""Facts that an action brings about with a separate place in a goal vector; more share the place of all others."""

PLACES = 2 + BROUGHT
"""The size of a goal vector: the number of the subgoal, distances of what is brought about, the worst of the rest."""


@dataclass(frozen=True)
class Subgoal:
    """A subgoal: the facts that its action brings about, and all others that are known to hold after it.

    `names` are their texts, with a minus for those that must not hold.
    """

    achieved: tuple[Fact, ...]
    unchanged: tuple[Fact, ...]
    names: tuple[str, ...]

    def measured(self, situation: Situation) -> list[float]:
        """Return the signed distance of each fact in metres or radians, at most 0 where it holds, by `names`."""
        return [fact.way(situation) for fact in (*self.achieved, *self.unchanged)]

    def placed(self, measured: list[float]) -> list[float]:
        """Return signed distances as `PLACES` - 1 numbers, 0 where there is no fact.

        All are at most 0 exactly where the subgoal is reached; the last is the worst of the facts that have no place.
        """
        own = min(len(self.achieved), BROUGHT)
        return [*measured[:own], *[0.0] * (BROUGHT - own), max(measured[own:], default=0.0)]

    def reached(self, measured: list[float]) -> tuple[str, ...]:
        """Return the names of the facts that hold."""
        return tuple([name for name, distance in zip(self.names, measured, strict=True) if distance <= 0.0])


def subgoals_of(task: Task, scene: Scene) -> tuple[Subgoal, ...]:
    """Return the subgoals of a task as physics sees them, one for each action.

    Raises:
        SceneError: the scene lacks the shape or the yaw of an entity that a spatial fluent refers to.
    """
    subgoals = []
    for effect, fluents in zip(physical_task(task, scene).effects, task.subgoals, strict=True):
        achieved = facts(scene, fluents)
        unchanged = tuple(fact for fact in effect.after if fact not in achieved)
        names = [
            f"{'' if fact.value else '-'}{fact.predicate.name}({','.join(fact.arguments)})"
            for fact in (*achieved, *unchanged)
        ]
        subgoals.append(Subgoal(achieved, unchanged, tuple(names)))
    return tuple(subgoals)
