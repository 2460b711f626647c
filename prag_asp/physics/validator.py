"""Validate tasks: proofs first, then the search for a witness that passes all tiers of a budget."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

import numpy as np

from prag_asp.atom import Atom
from prag_asp.errors import PragError, SceneError
from prag_asp.physics.filming.episode_options import Staging
from prag_asp.physics.proofs.prover import Prover
from prag_asp.physics.search.attempt import CAUSES, PhysicsFault, Search
from prag_asp.physics.search.failures import FailureLog
from prag_asp.physics.search.foresight import foresee
from prag_asp.physics.search.spans import foresee_spans
from prag_asp.physics.symbolic_facts import PhysicalTask, physical_task
from prag_asp.physics.tiers import TierPipeline
from prag_asp.physics.verdict import Budget, Detail, Status, Verdict
from prag_asp.physics.witness_search import witnesses
from prag_asp.physics.world.simulator import open_simulator
from prag_asp.processes.progress_events import stage
from prag_asp.scene.scene import Scene
from prag_asp.task import Task

ACTIVITY = "checking tasks by physics"
"""The name of the activity in progress displays."""

LISTED = 8
"""The maximum number of details about failed attempts in a verdict."""


class Validator:
    """A validator of the tasks of one scene, with its simulators; `open_validator` creates and closes one."""

    def __init__(self, scene: Scene, resources: ExitStack):
        self._scene = scene
        self._simulator = resources.enter_context(open_simulator(scene))
        self._prover = Prover(scene)
        self._tiers = TierPipeline(scene, self._simulator, resources)

    def validate(
        self, task: Task, *, seed: int, index: int = 0, budget: Budget | None = None, staging: Staging | None = None
    ) -> Verdict:
        """Return the verdict on a task, which depends only on the arguments and the scene.

        `staging` holds the options of the demonstration, if the budget includes that tier.

        Raises:
            SceneError: the task contains an entity that has no shape.
            QueryError: the scene lacks a camera that `staging` names.
        """
        budget = budget or Budget()
        stage(ACTIVITY)
        physical = physical_task(task, self._scene)
        if len(physical.effects) != len(task.states):
            raise SceneError(f"the task {task} has {len(task.states)} states for {len(physical.effects)} actions")
        proof = self._prover.impossibility(physical)
        if proof is not None:
            return Verdict("infeasible", budget, seed, index, reason=str(proof))
        rng = np.random.default_rng([seed, index])
        ahead, spans = foresee(physical, self._scene), foresee_spans(physical, self._scene)
        search = Search(self._simulator, physical.objects, rng, ahead, spans)
        return self._search(physical, search, budget, (seed, index), staging or Staging())

    def _search(
        self, physical: PhysicalTask, search: Search, budget: Budget, seeds: tuple[int, int], staging: Staging
    ) -> Verdict:
        """Search for a witness that passes the tiers of a budget."""
        log = FailureLog()
        status: Status = "not_found"
        restarts, witness, demonstration = 0, None, None
        for restarts, candidate in witnesses(physical, self._scene, search, budget, log):
            if candidate is None:
                continue
            outcome = self._tiers.run(physical, candidate, budget, (*seeds, restarts - 1), staging)
            if outcome.fault is None:
                status, (witness, _, demonstration) = "feasible", outcome
                break
            log.add(outcome.fault, len(physical.effects))
        counted: Counter[str] = Counter()
        for fault, number in log.faults.items():
            counted[fault.cause] += number
        return Verdict(
            status,
            budget,
            *seeds,
            # The cause that occurred first breaks ties.
            reason="" if witness is not None else counted.most_common(1)[0][0],
            causes={cause: counted[cause] for cause in CAUSES if counted[cause]},
            restarts=restarts,
            witness=witness,
            demonstration=demonstration,
            details=_details(log.faults, self._scene),
            nearest="" if witness is not None else log.nearest(physical.effects),
        )


@contextmanager
def open_validator(scene: Scene) -> Iterator[Validator]:
    """Open a validator, and close its simulators afterwards.

    Raises:
        SceneError: the scene cannot be built.
    """
    with ExitStack() as resources:
        try:
            validator = Validator(scene, resources)
        except PragError:
            raise
        except Exception as error:
            raise SceneError(f"the scene cannot be built: {type(error).__name__}: {error}") from error
        yield validator


def validate_task(
    task: Task,
    scene: Scene,
    *,
    seed: int,
    index: int = 0,
    budget: Budget | None = None,
    staging: Staging | None = None,
) -> Verdict:
    """Return the verdict on one task; use `open_validator` for many tasks.

    Raises:
        SceneError: the task contains an entity that has no shape.
    """
    with open_validator(scene) as validator:
        return validator.validate(task, seed=seed, index=index, budget=budget, staging=staging)


def _details(faults: Counter[PhysicsFault], scene: Scene) -> tuple[Detail, ...]:
    """Return the details of failed attempts, most common first, but no more than `LISTED`."""
    counts: Counter[tuple[str, str, str, bool | None, tuple[str, ...]]] = Counter()
    for fault, number in faults.items():
        fact, value, text = "", None, fault.text
        if fault.fact is not None:
            fact = str(Atom(fault.fact.predicate.name, fault.fact.arguments))
            value, text = fault.fact.value, fault.fact.sentence()
        entities = tuple(name for name in fault.entities if name in scene.shapes or name in scene.robots)
        if fact or text or entities:
            counts[fault.cause, text, fact, value, entities] += number
    order = {cause: i for i, cause in enumerate(CAUSES)}
    ranked = sorted(counts.items(), key=lambda item: (-item[1], order[item[0][0]], item[0][1:3], item[0][4]))
    return tuple(Detail(*what, attempts=number) for what, number in ranked[:LISTED])
