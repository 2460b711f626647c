"""Search for witnesses of a task: the choices, their order, and the choices to undo.

1. Choose the sizes that vary, then the openings of furniture and the place of every object in the initial state, large
   objects before small ones and supports before the objects on them. Places leave room for objects that are put beside
   or between others later. If there is no place for an object, the objects before it are placed again.
2. Try the actions in order. Each attempt at an action tries one grasp of the object, different directions first, or one
   random place for the object that is put down, moved or carried. Each attempt is checked as a whole, with the arm at
   the object and 10 cm before it.
3. If all attempts at an action fail, the search returns to the latest earlier action that may be to blame, undoes this
   action and all actions after it, and makes the next attempt at it. To blame are the action that grasped the object
   now being moved or put down, and the actions that moved or put down a body named by a failed attempt or, if there was
   no room, any body. If the action to which the search returns has no attempt left, the search returns further: to the
   latest action that is to blame for the failure of either action (conflict-directed backjumping: Prosser, "Hybrid
   algorithms for the constraint satisfaction problem", 1993). So a grasp is chosen together with the later placement,
   and a place together with all later actions that it affects.
4. If no action is to blame, or after twice as many returns as there are attempts, the search restarts with step 1.

For tasks that only move primitive bodies, the search restarts instead of step 3, which is faster because these bodies
have few grasps. If no restart within the budget finds a witness, there are a few further restarts. They return as in
step 3 if a held object could not be put down, and pack objects tightly if only room was lacking. If a held object
lacked room and the task puts several objects on or into the same body, each put leaves room for the later ones and for
the hand. If a witness fails a more expensive check, the next restart begins with other grasps of bodies with a model.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Generic, TypeVar

from prag_asp.physics.search.action_effects import advance
from prag_asp.physics.search.attempt import (
    EMPTY_VOLUME,
    OBJECTS_COLLIDE,
    Exhausted,
    Failure,
    PhysicsFault,
    Search,
    Snapshot,
)
from prag_asp.physics.search.failures import FailureLog
from prag_asp.physics.search.foresight import foresee, foresee_puts
from prag_asp.physics.search.initial_state import sample_initial_state
from prag_asp.physics.symbolic_facts import PhysicalTask
from prag_asp.physics.verdict import Budget
from prag_asp.physics.witness import Waypoint, Witness
from prag_asp.scene.scene import Scene, Size

Result = TypeVar("Result")

CROWDED = frozenset((EMPTY_VOLUME, OBJECTS_COLLIDE))
"""The causes of failed attempts that indicate a lack of room, so that tight packing may help."""

PACKED = 4
"""The maximum number of further restarts, which are also limited to half of the restarts in the budget, because each of
them backtracks and takes longer."""

RETURNS = 2
"""The maximum number of returns to earlier actions in one restart, per attempt at an action."""


def witnesses(
    physical: PhysicalTask, scene: Scene, search: Search, budget: Budget, log: FailureLog
) -> Iterator[tuple[int, Witness | None]]:
    """Yield the number of each restart, from 1, with the witness that it found in a scene, or None."""
    ranges = {entity: scene.ranges[entity] for entity in physical.objects if entity in scene.ranges}
    search = replace(search, returns=any(scene.shapes[each].model is not None for each in _handled(physical)))
    begun, found, further = False, 0, min(budget.restarts // 2, PACKED)
    for number in range(budget.restarts + further):
        if number == budget.restarts:
            causes = {fault.cause for fault in log.faults}
            crowded = not (causes.isdisjoint(CROWDED) or (begun and not causes <= CROWDED))
            if not (crowded or log.grasp_to_blame):
                return
            later_puts = {} if causes.isdisjoint(CROWDED) else foresee_puts(physical, scene)
            search = replace(search, packs=crowded, returns=True, later_puts=later_puts)
        drawn = {entity: shapes[int(search.rng.integers(len(shapes)))] for entity, shapes in ranges.items()}
        if drawn:
            sized = scene.with_shapes(drawn)
            search.simulator.use(sized)
            search = replace(search, foresight=foresee(physical, sized))
        sizes = {entity: shape.size for entity, shape in drawn.items()}
        initial = _initial_state(physical, search, budget.samples, log)
        begun = begun or initial is not None
        witness = None if initial is None else _follow(physical, search, initial, sizes, budget.samples, log)
        yield number + 1, witness
        found += witness is not None
        search = replace(search, passed_over=found)


def _handled(physical: PhysicalTask) -> set[str]:
    """Return the bodies that are grasped or moved by the actions of a task."""
    return {
        entity
        for effect in physical.effects
        for entity in (effect.grasps, effect.releases, effect.holds, *effect.moved)
        if entity is not None
    }


def _initial_state(physical: PhysicalTask, search: Search, samples: int, log: FailureLog) -> Snapshot | None:
    """Return an initial state, or None if all samples fail; a search that packs has one try, because it backtracks."""
    trial = _retry((0, 1 if search.packs else samples), log, -1, lambda _: sample_initial_state(search, physical))
    return trial.result


def _follow(
    physical: PhysicalTask,
    search: Search,
    snapshot: Snapshot,
    sizes: Mapping[str, Size],
    samples: int,
    log: FailureLog,
) -> Witness | None:
    """Return a witness from an initial state, or None if all attempts at an action fail and no action is to blame."""
    snapshots, motions = [snapshot], list[tuple[Waypoint, ...]]()
    number, returns = len(physical.effects), 0
    tried, blamed = [0] * number, [set[int]() for _ in range(number)]
    while len(motions) < number:
        k = len(motions)
        trial = _retry((tried[k], samples), log, k, partial(advance, search, snapshots[k], physical.effects[k]))
        if trial.result is not None:
            tried[k] = trial.number + 1
            snapshots.append(trial.result[0])
            motions.append(trial.result[1])
            continue
        blamed[k] |= actions_to_blame(physical, k, trial.faults)
        log.grasp_to_blame |= not search.returns and _grasped_before(physical, k) is not None
        if not (search.returns and blamed[k] and returns < RETURNS * samples):
            return None
        returns += 1
        back = max(blamed[k])
        blamed[back] |= blamed[k] - {back}
        tried[back + 1 :] = [0] * (number - back - 1)
        blamed[back + 1 :] = [set() for _ in range(number - back - 1)]
        del snapshots[back + 1 :], motions[back:]
    return Witness(tuple(each.moment() for each in snapshots), tuple(motions), sizes)


def actions_to_blame(physical: PhysicalTask, k: int, faults: Iterable[PhysicsFault]) -> set[int]:
    """Return the actions before action `k` that may have caused the failed attempts at action `k`."""
    faults = list(faults)
    effect, grasped = physical.effects[k], _grasped_before(physical, k)
    bodies = {name for fault in faults for name in fault.entities} | {effect.grasps, effect.visits}
    # any body that was put down may block a body for which there is no room
    crowded = any(fault.cause in CROWDED and len(fault.entities) == 1 for fault in faults)
    moved = []
    for i, earlier in enumerate(physical.effects[:k]):
        placed = {*earlier.moved, earlier.releases} - {None}
        if placed and (crowded or not bodies.isdisjoint(placed)):
            moved.append(i)
    return {*moved, *(() if grasped is None else (grasped,))}


def _grasped_before(physical: PhysicalTask, k: int) -> int | None:
    """Return the action that grasped the body which action `k` moves or puts down, or None if there is none."""
    entity = physical.effects[k].releases or physical.effects[k].holds
    if entity is None:
        return None
    return max((i for i in range(k) if physical.effects[i].grasps == entity), default=None)


@dataclass(frozen=True)
class _Trial(Generic[Result]):
    """Attempts at an action: the number and result of the successful one, if any, and the faults of the others."""

    number: int
    result: Result | None
    faults: tuple[PhysicsFault, ...]


def _retry(numbers: tuple[int, int], log: FailureLog, done: int, attempt: Callable[[int], Result]) -> _Trial[Result]:
    """Call an attempt with each number in the range given by `numbers` in turn, and return the first success.

    `done` is the number of earlier actions.
    """
    faults = list[PhysicsFault]()
    for number in range(*numbers):
        try:
            return _Trial(number, attempt(number), tuple(faults))
        except Exhausted:
            break
        except Failure as failure:
            log.add(failure.fault, done, failure.missed)
            faults.append(failure.fault)
    return _Trial(numbers[1], None, tuple(faults))
