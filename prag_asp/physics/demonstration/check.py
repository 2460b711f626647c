"""Check a recorded demonstration by the predicates alone."""

from __future__ import annotations

from prag_asp.errors import SceneError
from prag_asp.physics.demonstration.demonstration import Demonstration
from prag_asp.physics.facts import physical_task
from prag_asp.scene.model import Scene
from prag_asp.task import Task


def check_demonstration(task: Task, demonstration: Demonstration, scene: Scene) -> list[str]:
    """Return which facts of the task do not hold in the recorded frames, nothing where the task is performed.

    Raises:
        SceneError: the task speaks about something for which the scene has no shape.
    """
    states = physical_task(task, scene).states
    if len(demonstration.ends) != len(states):
        return [f"{len(demonstration.ends)} states are reached; the task has {len(states)}"]
    found = []
    for k, (frame, facts) in enumerate(zip(demonstration.ends.tolist(), states, strict=True)):
        if not 0 <= frame < len(demonstration.times):
            return [f"state {k}: there is no frame {frame}"]
        try:
            situation = demonstration.situation(scene, frame)
            broken = [fact for fact in facts if not fact.satisfied(situation)]
        except SceneError as error:
            return [f"state {k}: {error}"]
        found += [f"state {k}: it does not hold that {fact.sentence()}" for fact in broken]
    return found
