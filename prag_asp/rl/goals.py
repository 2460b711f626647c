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
        facts = (*self.achieved, *self.unchanged)
        last = None if before is None else before[0]
        if before is None or last is None or last.scene is not situation.scene or last.openings != situation.openings:
            measured = [0.0 if late else fact.way(situation) for fact, late in zip(facts, self._late, strict=True)]
        else:
            stood = last.poses
            moved = {entity for entity, pose in situation.poses.items() if stood.get(entity) is not pose}
            moved.update(stood.keys() - situation.poses.keys())
            measured = [
                0.0 if late else distance if bodies is not None and moved.isdisjoint(bodies) else fact.way(situation)
                for fact, bodies, distance, late in zip(facts, self._bodies, before[1], self._late, strict=True)
            ]
        own = min(len(self.achieved), BROUGHT)
        exact = zip(measured[own:], self._late[own:], strict=True)
        largest = max((distance for distance, late in exact if not late), default=-math.inf)
        for number, late in enumerate(self._late):
            if late:
                measured[number] = distance = facts[number].distance_up_to(situation, largest)
                largest = max(largest, distance)
        return measured

    @cached_property
    def _late(self) -> tuple[bool, ...]:
        """For each fact, whether its distance is needed only in the maximum, and is therefore computed last."""
        places, facts = min(len(self.achieved), BROUGHT), (*self.achieved, *self.unchanged)
        return tuple(
            number >= places and not fact.value and bodies is None
            for number, (fact, bodies) in enumerate(zip(facts, self._bodies, strict=True))
        )

    @cached_property
    def _bodies(self) -> tuple[tuple[str, ...] | None, ...]:
        """For each fact, the entities whose poses determine its distance, or None if other bodies or arms matter."""
        kinds = [(fact.predicate, fact.arguments) for fact in (*self.achieved, *self.unchanged)]
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
