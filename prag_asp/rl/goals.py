"""The subgoals of a task as facts of physics: those that an action achieves, and those that must persist."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from prag_asp.physics import physical_task
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import Fact, facts
from prag_asp.scene.scene import Scene
from prag_asp.task import Task

BROUGHT = 6
"""The number of achieved facts with their own elements in a goal vector; all other facts share the last element."""

PLACES = 2 + BROUGHT
"""The size of a goal vector: the index of the subgoal, the distances of achieved facts, and the largest other distance.
"""


@dataclass(frozen=True)
class Subgoal:
    """A subgoal: the facts that its action achieves, and all other facts known to hold after it.

    `names` holds the facts as text, with a minus sign if a fact must not hold.
    """

    achieved: tuple[Fact, ...]
    unchanged: tuple[Fact, ...]
    names: tuple[str, ...]

    def measured(self, situation: Situation, before: tuple[Situation, list[float]] | None = None) -> list[float]:
        """Return the signed distance, in metres or radians, of each fact in `names`: at most 0 if the fact holds.

        If the distances in an earlier situation, `before`, are given, a distance is computed again only if the fact is
        about the gripper or about bodies that have moved since. For a fact that must not hold and has no element of its
        own in a goal vector, a distance below the largest one is replaced by an upper bound.
        """
        facts, bodies, last = self._facts, self._bodies, None if before is None else before[0]
        if before is None or last is None or last.scene is not situation.scene or last.openings != situation.openings:
            measured, stale = [0.0] * len(facts), self._exact
        else:
            measured, stood = before[1].copy(), last.poses
            moved = {entity for entity, pose in situation.poses.items() if stood.get(entity) is not pose}
            moved.update(stood.keys() - situation.poses.keys())
            stale = tuple([i for i in self._exact if (about := bodies[i]) is None or not moved.isdisjoint(about)])
        for number in stale:
            measured[number] = facts[number].way(situation)
        own = min(len(self.achieved), BROUGHT)
        largest = max([measured[number] for number in self._exact if number >= own], default=-math.inf)
        for number in self._late:
            measured[number] = distance = facts[number].distance_up_to(situation, largest)
            largest = max(largest, distance)
        return measured

    @cached_property
    def _facts(self) -> tuple[Fact, ...]:
        """The facts in the order of `names`."""
        return (*self.achieved, *self.unchanged)

    @cached_property
    def _exact(self) -> tuple[int, ...]:
        """The numbers of the facts whose distance is computed exactly."""
        return tuple(number for number in range(len(self._facts)) if number not in self._late)

    @cached_property
    def _late(self) -> tuple[int, ...]:
        """The numbers of the facts whose distance is needed only in the maximum, and is therefore computed last."""
        places = min(len(self.achieved), BROUGHT)
        return tuple(
            number
            for number, (fact, bodies) in enumerate(zip(self._facts, self._bodies, strict=True))
            if number >= places and not fact.value and bodies is None
        )

    @cached_property
    def _bodies(self) -> tuple[tuple[str, ...] | None, ...]:
        """For each fact, the entities whose poses determine its distance, or None if other bodies or arms matter."""
        kinds = [(fact.predicate, fact.arguments) for fact in self._facts]
        return tuple([None if kind.of_gripper or kind.looks_around else entities for kind, entities in kinds])

    def placed(self, measured: list[float]) -> list[float]:
        """Return signed distances as the `PLACES` - 1 last elements of a goal vector, with 0 for unused elements.

        All numbers are at most 0 if and only if the subgoal is reached; the last one is the largest distance of the
        facts without an element of their own.
        """
        own = min(len(self.achieved), BROUGHT)
        return [*measured[:own], *[0.0] * (BROUGHT - own), max(measured[own:], default=0.0)]

    def reached(self, measured: list[float]) -> tuple[str, ...]:
        """Return the names of the facts that hold."""
        return tuple([name for name, distance in zip(self.names, measured, strict=True) if distance <= 0.0])


def subgoals_of(task: Task, scene: Scene) -> tuple[Subgoal, ...]:
    """Return the subgoals of a task as facts of physics, one for each action.

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
