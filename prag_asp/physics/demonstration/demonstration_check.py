"""Check an episode with the predicates, and check it for contacts that its task does not intend."""

from __future__ import annotations

from prag_asp.errors import SceneError
from prag_asp.physics.demonstration.contacts import excessive_contacts, intended_contacts, unintended_contacts
from prag_asp.physics.demonstration.demonstration import Demonstration
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import physical_task
from prag_asp.scene.scene import Scene
from prag_asp.task import Task


def check_demonstration(task: Task, demonstration: Demonstration, scene: Scene) -> list[str]:
    """Return the facts of the task that do not hold in the episode, and the faults in its contacts and motions.

    Faults are unintended and excessive contacts, objects that slip or turn in the hand, and accelerations beyond the
    limits of the joints. The result is empty if the episode passes.

    Raises:
        SceneError: the task contains an entity that has no shape.
    """
    from prag_asp.physics.demonstration.handling import handling_faults  # noqa: PLC0415 - it loads kinematics

    physical = physical_task(task, scene)
    states, ends = physical.states, demonstration.ends.tolist()
    if len(ends) != len(states):
        return [f"{len(ends)} states are reached; the task has {len(states)}"]
    if demonstration.robots != tuple(scene.robots):
        names = ", ".join(demonstration.robots) or "none"
        return [f"it shows the robots {names}; the scene has {', '.join(scene.robots)}"]
    faults = list[str]()
    previous: Situation | None = None
    for k, (frame, facts) in enumerate(zip(ends, states, strict=True)):
        if not 0 <= frame < len(demonstration.times):
            return [f"state {k}: there is no frame {frame}"]
        try:
            situation = demonstration.situation(scene, frame)
            intended = intended_contacts(physical, k, previous or situation, situation)
            broken = [fact for fact in facts if not fact.is_satisfied(situation)]
        except SceneError as error:
            return [f"state {k}: {error}"]
        touches = demonstration.touches(ends[k - 1] + 1 if k else 0, frame)
        during = f"action {k}, {task.actions[k - 1]}" if k else "before the first action"
        pressing = list(touches)
        wrong = (*unintended_contacts(pressing, intended), *excessive_contacts(pressing, intended, situation.scene))
        faults += [f"{during}: {touch.sentence()}" for touch in wrong]
        faults += [f"state {k}: this fact does not hold: {fact.sentence()}" for fact in broken]
        previous = situation
    return [*faults, *(fault.text for fault in handling_faults(demonstration, scene))]
