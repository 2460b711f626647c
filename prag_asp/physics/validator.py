"""Look for a witness of a task: restarts from new first states, samples of each action."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import replace

import numpy as np

from prag_asp.atom import Atom
from prag_asp.errors import SceneError
from prag_asp.physics.checks.settling import Settling, open_settling
from prag_asp.physics.demonstration.demonstration import Demonstration
from prag_asp.physics.demonstration.performance import Performer, open_performer
from prag_asp.physics.filming.episode_options import Staging
from prag_asp.physics.filming.film import film
from prag_asp.physics.motion.transit import with_transit
from prag_asp.physics.proofs.prover import Prover
from prag_asp.physics.search.action_effects import advance
from prag_asp.physics.search.attempt import CAUSES, NO_PATH, Exhausted, Failure, Fault, Search, Snapshot
from prag_asp.physics.search.foresight import foresee
from prag_asp.physics.search.initial_state import draw_start
from prag_asp.physics.search.spans import foresee_spans
from prag_asp.physics.symbolic_facts import Effect, PhysicalTask, physical_task
from prag_asp.physics.verdict import Budget, Detail, Verdict
from prag_asp.physics.witness import Waypoint, Witness
from prag_asp.physics.world.simulator import open_simulator
from prag_asp.processes.progress_events import stage
from prag_asp.scene.scene import Scene, Size
from prag_asp.task import Task

LISTED = 8
"""How many details of failed attempts a verdict tells at most."""


class Validator:
    """Validates tasks of one scene in its own simulators; use `open_validator`, which closes them."""

    def __init__(self, scene: Scene, resources: ExitStack):
        self._scene = scene
        self._resources = resources
        self._simulator = resources.enter_context(open_simulator(scene))
        self._prover = Prover(scene)
        self._settling: Settling | None = None
        self._performer: Performer | None = None

    def validate(
        self, task: Task, *, seed: int, index: int = 0, budget: Budget | None = None, staging: Staging | None = None
    ) -> Verdict:
        """Return the verdict on a task; it depends on nothing but the arguments and the scene.

        `staging` says how it is demonstrated, where the budget asks for that.

        Raises:
            SceneError: the task speaks about something for which the scene has no shape.
            QueryError: the scene has no camera of a name that `staging` has.
        """
        budget = budget or Budget()
        stage("checking tasks by physics")
        physical = physical_task(task, self._scene)
        if len(physical.effects) != len(task.states):
            raise SceneError(f"the task {task} has {len(task.states)} states for {len(physical.effects)} actions")
        proof = self._prover.impossibility(physical)
        if proof is not None:
            return Verdict("infeasible", budget, seed, index, reason=str(proof))
        rng = np.random.default_rng([seed, index])
        ahead, spans = foresee(physical, self._scene), foresee_spans(physical, self._scene)
        search = Search(self._simulator, physical.objects, rng, ahead, spans)
        return self._look(physical, search, budget, (seed, index), staging or Staging())

    def _look(
        self, physical: PhysicalTask, search: Search, budget: Budget, seeds: tuple[int, int], staging: Staging
    ) -> Verdict:
        """Search for a witness within a budget."""
        (seed, index), faults = seeds, Counter[Fault]()
        for restart in range(budget.restarts):
            search, sizes = self._sized(physical, search)
            witness = _attempt(physical, search, sizes, budget.samples, faults)
            if witness is None or not self._settles(physical, witness, budget, faults):
                continue
            witness = self._travels(physical, witness, budget, faults)
            if witness is None:
                continue
            demonstration = self._perform(physical, witness, budget, faults, ((*seeds, restart), staging))
            if demonstration is None or demonstration.success:
                return Verdict(
                    "feasible",
                    budget,
                    seed,
                    index,
                    causes=_causes(faults),
                    details=_details(faults, self._scene),
                    restarts=restart + 1,
                    witness=witness,
                    demonstration=demonstration,
                )
        return Verdict(
            "not_found",
            budget,
            seed,
            index,
            reason=_most_common(faults),
            causes=_causes(faults),
            restarts=budget.restarts,
            details=_details(faults, self._scene),
        )

    def _sized(self, physical: PhysicalTask, search: Search) -> tuple[Search, Mapping[str, Size]]:
        """Return the search with sizes drawn for the objects that have a range of them, and the sizes in metres."""
        ranges = {entity: self._scene.ranges[entity] for entity in physical.objects if entity in self._scene.ranges}
        if not ranges:
            return search, {}
        drawn = {entity: shapes[int(search.rng.integers(len(shapes)))] for entity, shapes in ranges.items()}
        scene = self._scene.with_shapes(drawn)
        self._simulator.use(scene)
        sizes = {entity: shape.size for entity, shape in drawn.items()}
        return replace(search, foresight=foresee(physical, scene)), sizes

    def _settles(self, physical: PhysicalTask, witness: Witness, budget: Budget, faults: Counter[Fault]) -> bool:
        """Tell whether the states of a witness are stable, as far as a budget asks for it."""
        if not budget.includes("settling"):
            return True
        if self._settling is None:
            self._settling = self._resources.enter_context(open_settling(self._scene))
        fault = self._settling.fault(physical, witness)
        if fault is not None:
            faults[fault] += 1
        return fault is None

    def _travels(
        self, physical: PhysicalTask, witness: Witness, budget: Budget, faults: Counter[Fault]
    ) -> Witness | None:
        """Return a witness with the ways of the arm, as far as a budget asks for them; None where one is missing."""
        if not budget.includes("transit"):
            return witness
        travelled = with_transit(self._simulator, physical, witness)
        if travelled is None:
            faults[Fault(NO_PATH)] += 1
        return travelled

    def _perform(
        self,
        physical: PhysicalTask,
        witness: Witness,
        budget: Budget,
        faults: Counter[Fault],
        staged: tuple[tuple[int, ...], Staging],
    ) -> Demonstration | None:
        """Return the recording of the robot performing a witness, None where a budget does not ask for it."""
        if not budget.includes("demonstration"):
            return None
        if self._performer is None:
            opened = open_performer(self._scene, self._simulator)
            self._performer = self._resources.enter_context(opened)
        seeds, staging = staged
        variation = staging.drawn(self._scene.with_sizes(witness.sizes), physical.objects, seeds)
        demonstration = self._performer.perform(physical, witness, variation)
        if not demonstration.success:
            faults[Fault(demonstration.cause, text=demonstration.detail)] += 1
        elif staging.cameras:
            return film(demonstration, self._scene, staging)
        return demonstration


@contextmanager
def open_validator(scene: Scene) -> Iterator[Validator]:
    """Open a validator, and close its simulators afterwards."""
    with ExitStack() as resources:
        yield Validator(scene, resources)


def validate_task(
    task: Task,
    scene: Scene,
    *,
    seed: int,
    index: int = 0,
    budget: Budget | None = None,
    staging: Staging | None = None,
) -> Verdict:
    """Return the verdict on one task; open a validator to check many.

    Raises:
        SceneError: the task speaks about something for which the scene has no shape.
    """
    with open_validator(scene) as validator:
        return validator.validate(task, seed=seed, index=index, budget=budget, staging=staging)


def _attempt(
    physical: PhysicalTask, search: Search, sizes: Mapping[str, Size], samples: int, faults: Counter[Fault]
) -> Witness | None:
    """Return a witness found from one first state, None where an action fails in all its samples."""
    snapshot = _start(search, physical, samples, faults)
    if snapshot is None:
        return None
    moments, motions = [snapshot.moment()], []
    for effect in physical.effects:
        outcome = _step(search, snapshot, effect, samples, faults)
        if outcome is None:
            return None
        snapshot, waypoints = outcome
        moments.append(snapshot.moment())
        motions.append(waypoints)
    return Witness(tuple(moments), tuple(motions), sizes)


def _start(search: Search, physical: PhysicalTask, samples: int, faults: Counter[Fault]) -> Snapshot | None:
    """Return a first state, None where all samples fail."""
    for _ in range(samples):
        try:
            return draw_start(search, physical)
        except Failure as failure:
            faults[failure.fault] += 1
    return None


def _step(
    search: Search, snapshot: Snapshot, effect: Effect, samples: int, faults: Counter[Fault]
) -> tuple[Snapshot, tuple[Waypoint, ...]] | None:
    """Return what an action leads to, None where all samples fail."""
    for attempt in range(samples):
        try:
            return advance(search, snapshot, effect, attempt)
        except Exhausted:
            break
        except Failure as failure:
            faults[failure.fault] += 1
    return None


def _causes(faults: Counter[Fault]) -> dict[str, int]:
    """Return how often attempts failed for each cause, in the order of the checks."""
    counted = _by_cause(faults)
    return {cause: counted[cause] for cause in CAUSES if counted[cause]}


def _most_common(faults: Counter[Fault]) -> str:
    """Return the cause for which most attempts failed, of several the first one met."""
    return _by_cause(faults).most_common(1)[0][0]


def _by_cause(faults: Counter[Fault]) -> Counter[str]:
    counted: Counter[str] = Counter()
    for fault, number in faults.items():
        counted[fault.cause] += number
    return counted


def _details(faults: Counter[Fault], scene: Scene) -> tuple[Detail, ...]:
    """Return of what the attempts failed that say so, the most common first, `LISTED` at most."""
    found: Counter[tuple[str, str, str, bool | None, tuple[str, ...]]] = Counter()
    for fault, number in faults.items():
        fact, value, text = "", None, fault.text
        if fault.fact is not None:
            fact = str(Atom(fault.fact.predicate.name, fault.fact.arguments))
            value, text = fault.fact.value, fault.fact.sentence()
        entities = tuple(name for name in fault.entities if name in scene.shapes or name in scene.robots)
        if fact or text or entities:
            found[fault.cause, text, fact, value, entities] += number
    order = {cause: i for i, cause in enumerate(CAUSES)}
    ranked = sorted(found.items(), key=lambda item: (-item[1], order[item[0][0]], item[0][1:3], item[0][4]))
    return tuple(Detail(*what, attempts=number) for what, number in ranked[:LISTED])
