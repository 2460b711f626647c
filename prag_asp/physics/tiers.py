"""Pass witnesses through the tiers in order of cost, both when the validator finds them and when they are rechecked.

A witness found by a search passes the first tier, kinematics, by construction; `check_witness` checks this tier.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from typing import NamedTuple

from prag_asp.physics.checks.settling import Settling, open_settling
from prag_asp.physics.checks.witness_check import witness_problems
from prag_asp.physics.demonstration.demonstration import Demonstration
from prag_asp.physics.demonstration.performance import Performer, open_performer
from prag_asp.physics.filming.camera_rendering import render_cameras
from prag_asp.physics.filming.episode_options import Staging
from prag_asp.physics.motion.transit import with_transit
from prag_asp.physics.search.attempt import NO_PATH, PhysicsFault
from prag_asp.physics.symbolic_facts import PhysicalTask, physical_task
from prag_asp.physics.verdict import Budget, Tier
from prag_asp.physics.witness import Witness
from prag_asp.physics.world.simulator import Simulator, open_simulator
from prag_asp.scene.scene import Scene
from prag_asp.task import Task


class TierOutcome(NamedTuple):
    """The result of passing a witness through the tiers: its first fault, if any, and the episode of the last tier.

    The `witness` includes the transit waypoints that the transit tier added.
    """

    witness: Witness
    fault: PhysicsFault | None = None
    demonstration: Demonstration | None = None


class TierPipeline:
    """A pipeline of the tiers above kinematics for the witnesses of one scene; each tier opens its world on first use.

    The bodies in the `simulator` must have the sizes that the witness has (`Simulator.use`). The worlds are closed
    together with `resources`.
    """

    def __init__(self, scene: Scene, simulator: Simulator, resources: ExitStack):
        self._scene, self._simulator, self._resources = scene, simulator, resources
        self._settling: Settling | None = None
        self._performer: Performer | None = None

    def run(
        self, physical: PhysicalTask, witness: Witness, budget: Budget, seeds: Sequence[int], staging: Staging
    ) -> TierOutcome:
        """Return the result of passing a witness through a budget's tiers; transit waypoints are added if it has none.

        `staging` holds the options of the demonstration; `seeds` determine the random variation.
        """
        if budget.includes(Tier.SETTLING):
            if self._settling is None:
                self._settling = self._resources.enter_context(open_settling(self._scene))
            fault = self._settling.fault(physical, witness)
            if fault is not None:
                return TierOutcome(witness, fault)
        if budget.includes(Tier.TRANSIT) and not witness.has_transit:
            complete = with_transit(self._simulator, physical, witness)
            if complete is None:
                return TierOutcome(witness, PhysicsFault(NO_PATH))
            witness = complete
        if not budget.includes(Tier.DEMONSTRATION):
            return TierOutcome(witness)
        if self._performer is None:
            self._performer = self._resources.enter_context(open_performer(self._scene, self._simulator))
        variation = staging.sample_variation(self._scene.with_sizes(witness.sizes), physical.objects, seeds)
        demonstration = self._performer.perform(physical, witness, variation)
        if not demonstration.success:
            return TierOutcome(witness, PhysicsFault(demonstration.cause, text=demonstration.detail), demonstration)
        if staging.cameras:
            demonstration = render_cameras(demonstration, self._scene, staging)
        return TierOutcome(witness, None, demonstration)


@contextmanager
def open_tier_check(
    scene: Scene, budget: Budget, staging: Staging | None = None, seed: int = 0
) -> Iterator[Callable[..., TierOutcome]]:
    """Open simulators, yield a function that passes witnesses through a budget's tiers, and close them afterwards.

    The function takes a task, a witness and the index of the task (0 by default), on which variations depend. `staging`
    holds the options of demonstrations. Transit waypoints are added to a witness that has none if the budget includes
    the transit tier.

    Raises:
        SceneError: the scene cannot be built.
    """
    with ExitStack() as resources:
        simulator = resources.enter_context(open_simulator(scene))
        pipeline = TierPipeline(scene, simulator, resources)

        def check(task: Task, witness: Witness, index: int = 0) -> TierOutcome:
            for problem in witness_problems(task, witness, simulator, scene)[:1]:
                return TierOutcome(witness, PhysicsFault(problem))
            return pipeline.run(physical_task(task, scene), witness, budget, (seed, index, 0), staging or Staging())

        yield check
