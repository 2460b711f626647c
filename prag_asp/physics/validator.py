"""Search for a witness of a task: restarts from new initial states, samples of each action."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from functools import partial
from typing import Generic, TypeVar

import numpy as np

from prag_asp.atom import Atom
from prag_asp.errors import PragError, SceneError
from prag_asp.physics.filming.episode_options import Staging
from prag_asp.physics.proofs.prover import Prover
from prag_asp.physics.search.action_effects import advance
from prag_asp.physics.search.attempt import (
    CAUSES,
    EMPTY_VOLUME,
    OBJECTS_COLLIDE,
    Exhausted,
    Failure,
    PhysicsFault,
    Search,
    Snapshot,
)
from prag_asp.physics.search.failures import FailureLog
from prag_asp.physics.search.foresight import foresee
from prag_asp.physics.search.initial_state import sample_initial_state
from prag_asp.physics.search.spans import foresee_spans
from prag_asp.physics.symbolic_facts import PhysicalTask, physical_task
from prag_asp.physics.tiers import TierPipeline
from prag_asp.physics.verdict import Budget, Detail, Status, Verdict
from prag_asp.physics.witness import Waypoint, Witness
from prag_asp.physics.world.simulator import open_simulator
from prag_asp.processes.progress_events import stage
from prag_asp.scene.scene import Scene, Size
from prag_asp.task import Task

Result = TypeVar("Result")
ACTIVITY = "checking tasks by physics"
"""What validation is called where progress is shown."""

CROWDED = frozenset((EMPTY_VOLUME, OBJECTS_COLLIDE))
"""The causes of failed attempts that are a lack of room, for which tight packing may help."""

PACKED = 4
"""Restarts that pack the objects tightly, at most, and at most half of the budget's: each backtracks on its own."""

LISTED = 8
"""Details of failed attempts that a verdict has at most."""


class Validator:
    """Validates tasks of one scene in its own simulators; use `open_validator`, which closes them."""

    def __init__(self, scene: Scene, resources: ExitStack):
        self._scene = scene
        self._simulator = resources.enter_context(open_simulator(scene))
        self._prover = Prover(scene)
        self._tiers = TierPipeline(scene, self._simulator, resources)

    def validate(
        self, task: Task, *, seed: int, index: int = 0, budget: Budget | None = None, staging: Staging | None = None
    ) -> Verdict:
        """Return the verdict on a task; it depends on the arguments and the scene alone.

        `staging` says how the task is demonstrated, if the budget includes that tier.

        Raises:
            SceneError: the task names an entity that has no shape.
            QueryError: the scene has no camera of a name that `staging` has.
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
        for restarts, candidate in self._restarts(physical, search, budget, log):
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
            # The cause that was met first breaks ties.
            reason="" if witness is not None else counted.most_common(1)[0][0],
            causes={cause: counted[cause] for cause in CAUSES if counted[cause]},
            restarts=restarts,
            witness=witness,
            demonstration=demonstration,
            details=_details(log.faults, self._scene),
            nearest="" if witness is not None else log.nearest(physical.effects),
        )

    def _restarts(
        self, physical: PhysicalTask, search: Search, budget: Budget, log: FailureLog
    ) -> Iterator[tuple[int, Witness | None]]:
        """Yield the number of each restart, from 1, with its witness if it finds one.

        Sizes with a range are sampled at each restart. If no restart of the budget finds an initial state, or all fail
        for lack of room, up to `PACKED` further ones pack the objects tightly.
        """
        ranges = {entity: self._scene.ranges[entity] for entity in physical.objects if entity in self._scene.ranges}
        begun = False
        for number in range(budget.restarts + min(budget.restarts // 2, PACKED)):
            if number == budget.restarts:
                causes = {fault.cause for fault in log.faults}
                if causes.isdisjoint(CROWDED) or (begun and not causes <= CROWDED):
                    return
                search = replace(search, packs=True)
            drawn = {entity: shapes[int(search.rng.integers(len(shapes)))] for entity, shapes in ranges.items()}
            if drawn:
                scene = self._scene.with_shapes(drawn)
                self._simulator.use(scene)
                search = replace(search, foresight=foresee(physical, scene))
            sizes = {entity: shape.size for entity, shape in drawn.items()}
            initial = _initial_state(physical, search, budget.samples, log)
            begun = begun or initial is not None
            follow = None if initial is None else _follow(physical, search, initial, sizes, budget.samples, log)
            yield number + 1, follow


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
    """Return the verdict on one task; `open_validator` is for many.

    Raises:
        SceneError: the task names an entity that has no shape.
    """
    with open_validator(scene) as validator:
        return validator.validate(task, seed=seed, index=index, budget=budget, staging=staging)


def _initial_state(physical: PhysicalTask, search: Search, samples: int, log: FailureLog) -> Snapshot | None:
    """Return an initial state, None if all samples fail; a search that packs tries once, because it backtracks."""
    trial = _retry((0, 1 if search.packs else samples), log, -1, lambda _: sample_initial_state(search, physical))
    return None if trial is None else trial.result


def _follow(
    physical: PhysicalTask,
    search: Search,
    snapshot: Snapshot,
    sizes: Mapping[str, Size],
    samples: int,
    log: FailureLog,
) -> Witness | None:
    """Return a witness from an initial state, None if all samples of an action fail.

    If a body with a model cannot be moved or put down as it is held, the next of its grasps is tried.
    """
    snapshots, motions = [snapshot], list[tuple[Waypoint, ...]]()
    tried = [0] * len(physical.effects)
    while len(motions) < len(physical.effects):
        k = len(motions)
        trial = _retry((tried[k], samples), log, k, partial(advance, search, snapshots[k], physical.effects[k]))
        if trial is None:
            grasped = _grasped_before(physical, k, search.scene)
            if grasped is None:
                return None
            tried[grasped + 1 :] = [0] * (len(tried) - grasped - 1)
            del snapshots[grasped + 1 :], motions[grasped:]
            continue
        tried[k] = trial.number + 1
        snapshots.append(trial.result[0])
        motions.append(trial.result[1])
    return Witness(tuple(each.moment() for each in snapshots), tuple(motions), sizes)


def _grasped_before(physical: PhysicalTask, k: int, scene: Scene) -> int | None:
    """Return the action that grasped the body with a model which action `k` moves or puts down, None if there is none.

    Primitives have few grasps, so their tasks start over.
    """
    entity = physical.effects[k].releases or physical.effects[k].holds
    if entity is None or scene.shapes[entity].model is None:
        return None
    return max((i for i in range(k) if physical.effects[i].grasps == entity), default=None)


@dataclass(frozen=True)
class _Trial(Generic[Result]):
    """An attempt that succeeded: its number from 0, and its result."""

    number: int
    result: Result


def _retry(
    numbers: tuple[int, int], log: FailureLog, done: int, attempt: Callable[[int], Result]
) -> _Trial[Result] | None:
    """Return the first success of an attempt, which gets its number, from the first to before the last of two.

    None if all fail; `done` is the number of actions before.
    """
    for number in range(*numbers):
        try:
            return _Trial(number, attempt(number))
        except Exhausted:
            break
        except Failure as failure:
            log.add(failure.fault, done)
    return None


def _details(faults: Counter[PhysicsFault], scene: Scene) -> tuple[Detail, ...]:
    """Return the details of failed attempts, the most common first, at most `LISTED`."""
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
