"""Check a recorded demonstration: by the predicates, and by the contacts that its task asks for."""

from __future__ import annotations

from prag_asp.errors import SceneError
from prag_asp.physics.demonstration.contacts import intended_contacts, unintended_contacts
from prag_asp.physics.demonstration.demonstration import Demonstration
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import physical_task
from prag_asp.scene.scene import Scene
from prag_asp.task import Task


def check_demonstration(task: Task, demonstration: Demonstration, scene: Scene) -> list[str]:
    """Return which facts of the task do not hold in the recorded frames, and which contacts it does not ask for.

    There is nothing to return where the task is performed.

    Raises:
        SceneError: the task speaks about something for which the scene has no shape.
    """
    physical = physical_task(task, scene)
    states, ends = physical.states, demonstration.ends.tolist()
    if len(ends) != len(states):
        return [f"{len(ends)} states are reached; the task has {len(states)}"]
    if demonstration.robots != tuple(scene.robots):
        names = ", ".join(demonstration.robots) or "none"
        return [f"it shows the robots {names}; the scene has {', '.join(scene.robots)}"]
    found = list[str]()
    begun: Situation | None = None
    for k, (frame, facts) in enumerate(zip(ends, states, strict=True)):
        if not 0 <= frame < len(demonstration.times):
            return [f"state {k}: there is no frame {frame}"]
        try:
            situation = demonstration.situation(scene, frame)
            wanted = intended_contacts(physical, k, begun or situation, situation)
            broken = [fact for fact in facts if not fact.is_satisfied(situation)]
        except SceneError as error:
            return [f"state {k}: {error}"]
        touches = demonstration.touches(ends[k - 1] + 1 if k else 0, frame)
        found += [f"{_during(task, k)}: {touch.sentence()}" for touch in unintended_contacts(touches, wanted)]
        found += [f"state {k}: it does not hold that {fact.sentence()}" for fact in broken]
        begun = situation
    return found


def _during(task: Task, number: int) -> str:
    """Return in words when an action takes place, counted from 1."""
    return f"action {number}, {task.actions[number - 1]}" if number else "before the first action"
