"""Check in a dynamic simulation that the objects of a witness stay in place, and keep their relations.

The simulation has no arms: held objects are fixed. Its world is rebuilt for every witness, because PyBullet's results
depend on the history of a world, even on the order of its bodies.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from prag_asp.physics.bullet import pybullet
from prag_asp.physics.search.attempt import UNSETTLED, UNSTABLE, PhysicsFault
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import PhysicalTask, physical_task
from prag_asp.physics.witness import Moment, Witness
from prag_asp.physics.world.bodies import body_pose, make_body, make_table, parking_place, put_body, set_mass
from prag_asp.physics.world.furniture_bodies import read_opening, set_opening
from prag_asp.physics.world.simulator import open_client, start_world
from prag_asp.scene.geometry import Pose, turn_between
from prag_asp.scene.scene import Scene
from prag_asp.task import Task

TIME_STEP = 1 / 240
STEPS = 60
"""The number of time steps in a quarter of a second, in which a 5 cm cube with its centre of mass 2 mm beyond an edge
tips over."""

LARGEST_MOVE = 0.003
LARGEST_TURN = math.radians(3)
LARGEST_SPEED = 0.03
"""The largest displacement of a stable object, in metres or radians, and its largest final speed in m/s."""


Rest = tuple[Mapping[str, Pose], Mapping[str, float], tuple[str, ...]]
"""The poses of objects after settling, the openings of furniture in metres or radians, and the entities that moved."""


class Settling:
    """A PyBullet world of objects alone, in which witnesses settle; `open_settling` creates one and closes it."""

    def __init__(self, scene: Scene, client: int):
        self._scene = scene
        self._client = client

    def fault(self, physical: PhysicalTask, witness: Witness) -> PhysicsFault | None:
        """Return the reason why a state of a witness is not stable, or None if all states are stable.

        An object may move by up to `LARGEST_MOVE`, turn by up to `LARGEST_TURN` and have a final speed of up to
        `LARGEST_SPEED`; afterwards, every fact of the state must still hold according to its predicate.
        """
        scene = self._scene.with_sizes(witness.sizes)
        start_world(self._client)
        pybullet.setTimeStep(TIME_STEP, physicsClientId=self._client)
        make_table(self._client, scene)
        bodies = {
            entity: make_body(self._client, scene, entity, parking_place(i), free=True)
            for i, entity in enumerate(physical.objects)
        }
        previous: Moment | None = None
        for facts, moment in zip(physical.states, witness.moments, strict=True):
            # If nothing has moved or been released, the state is as stable as the previous state.
            still = previous is not None and (previous.poses, previous.openings) == (moment.poses, moment.openings)
            if previous is None or not (still and previous.held <= moment.held):
                poses, openings, displaced = self._settle(scene, bodies, moment)
                if displaced:
                    return PhysicsFault(UNSTABLE, displaced)
                situation = Situation(scene, poses, moment.arms, openings)
                for fact in facts:
                    if not fact.is_satisfied(situation):
                        return PhysicsFault(UNSETTLED, fact.arguments, fact)
            previous = moment
        return None

    def _settle(self, scene: Scene, bodies: Mapping[str, int], moment: Moment) -> Rest:
        """Return the state after its objects have settled."""
        client = self._client
        for entity, body in bodies.items():
            put_body(client, scene, entity, body, moment.poses[entity])
        for entity, opening in moment.openings.items():
            set_opening(client, bodies[entity], opening)
        for entity in moment.held:
            set_mass(client, scene, entity, bodies[entity], still=True)
        for _ in range(STEPS):
            pybullet.stepSimulation(physicsClientId=client)
        settled = {entity: body_pose(client, scene, entity, body) for entity, body in bodies.items()}
        speeds = {e: pybullet.getBaseVelocity(body, physicsClientId=client)[0] for e, body in bodies.items()}
        for entity in moment.held:
            set_mass(client, scene, entity, bodies[entity])
        openings = {entity: read_opening(client, bodies[entity]) for entity in moment.openings}
        displaced = [
            entity
            for entity, pose in settled.items()
            if math.hypot(*speeds[entity]) > LARGEST_SPEED
            or not math.dist(moment.poses[entity].position, pose.position) <= LARGEST_MOVE  # also true for NaN
            or not turn_between(moment.poses[entity].quaternion, pose.quaternion) <= LARGEST_TURN
            or abs(openings.get(entity, 0.0) - moment.openings.get(entity, 0.0)) > LARGEST_MOVE
        ]
        return settled, openings, tuple(displaced)


@contextmanager
def open_settling(scene: Scene) -> Iterator[Settling]:
    """Open a world in which witnesses settle, and close it afterwards."""
    with open_client() as client:
        yield Settling(scene, client)


def settle(task: Task, witness: Witness, scene: Scene) -> str | None:
    """Return the reason why a state of a witness is not stable (one of `CAUSES`), or None if all states are stable.

    Raises:
        SceneError: the task contains an entity that has no shape.
    """
    with open_settling(scene) as settling:
        fault = settling.fault(physical_task(task, scene), witness)
        return None if fault is None else fault.cause
