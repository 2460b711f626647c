"""Execute a witness in a dynamic simulation, and check every state and contact."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from itertools import islice

from prag_asp.physics.demonstration.acting import Actor, PerformanceFailed
from prag_asp.physics.demonstration.contacts import excessive_contacts, intended_contacts, unintended_contacts
from prag_asp.physics.demonstration.demonstration import Demonstration
from prag_asp.physics.demonstration.handling import handling_faults
from prag_asp.physics.demonstration.planning import Action
from prag_asp.physics.demonstration.recording import Recorder
from prag_asp.physics.predicates import Gripper
from prag_asp.physics.search.attempt import LOST, NOT_REACHED, OVERBEARING, PRESSED
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import PhysicalTask, physical_task
from prag_asp.physics.witness import Witness
from prag_asp.physics.world.dynamics import Dynamics, open_dynamics
from prag_asp.physics.world.simulator import Simulator, open_simulator
from prag_asp.scene.scene import Scene
from prag_asp.scene.variation import Variation
from prag_asp.task import Task


class Performer:
    """An executor of witnesses in one dynamic simulation; `open_performer` creates one and closes it."""

    def __init__(self, world: Dynamics, planner: Simulator):
        self._scene = world.scene
        self._world = world
        self._planner = planner

    def perform(self, physical: PhysicalTask, witness: Witness, variation: Variation | None = None) -> Demonstration:
        """Execute a task from the initial state of a witness, in a varied world if requested, and return the episode.

        There must be no unintended or excessive contacts, and after every action each fact of the state has to hold;
        otherwise the episode ends there, with the cause. A complete episode fails if an object slips or turns in the
        hand, or if a joint exceeds its acceleration limit.
        """
        scene, first = self._scene.with_sizes(witness.sizes), witness.moments[0]
        self._planner.use(scene)
        self._world.begin(physical.objects, first, scene if variation is None else variation.applied(scene))
        recorder = Recorder(self._world, physical.objects)
        actor = Actor(self._world, self._planner, recorder, first)
        previous: Situation | None = None
        cause = detail = ""
        try:
            for k, facts in enumerate(physical.states):
                part = "the start"
                if k:
                    effect, before, after = physical.effects[k - 1], *witness.moments[k - 1 : k + 1]
                    part = str(effect.action)
                    actor.act(Action(effect, before, after, witness.motions[k - 1]))
                actor.rest()
                situation = recorder.end_state()
                intended = intended_contacts(physical, k, previous or situation, situation)
                touches = recorder.touches()
                for touch in unintended_contacts(touches, intended)[:1]:
                    raise PerformanceFailed(PRESSED, f"during {part} {touch.sentence()}")
                for touch in excessive_contacts(touches, intended, scene)[:1]:
                    raise PerformanceFailed(OVERBEARING, f"during {part} {touch.sentence()}")
                broken = [fact for fact in facts if not fact.is_satisfied(situation)]
                lost = [fact for fact in broken if fact.predicate.gripper is Gripper.HOLDS and fact.value]
                for fact in (lost or broken)[:1]:
                    reason = f"after {part}, this fact does not hold: {fact.sentence()}"
                    raise PerformanceFailed(LOST if lost else NOT_REACHED, reason)
                previous = situation
        except PerformanceFailed as failed:
            cause, detail = failed.args
        episode = recorder.finish(cause, detail)
        for fault in islice(() if cause else handling_faults(episode, scene), 1):
            episode = replace(episode, cause=fault.cause, detail=fault.text)
        return replace(episode, variation=variation)


@contextmanager
def open_performer(scene: Scene, planner: Simulator) -> Iterator[Performer]:
    """Open a simulation in which witnesses are executed, and close it afterwards; `planner` plans the paths."""
    with open_dynamics(scene) as world:
        yield Performer(world, planner)


def demonstrate(task: Task, witness: Witness, scene: Scene, variation: Variation | None = None) -> Demonstration:
    """Execute a task from the initial state of a witness, in a varied world if requested, and return the episode.

    Raises:
        SceneError: the task contains an entity that has no shape.
    """
    with open_simulator(scene) as planner, open_performer(scene, planner) as performer:
        return performer.perform(physical_task(task, scene), witness, variation)
