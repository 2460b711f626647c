"""Check a witness independently of the search: every state is loaded into a fresh simulator."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from prag_asp.errors import SceneError
from prag_asp.physics.checks.approaches import End
from prag_asp.physics.checks.motions import motion_problems, stray_objects
from prag_asp.physics.checks.numbers import broken_numbers, count_mismatch
from prag_asp.physics.checks.states import state_problems
from prag_asp.physics.symbolic_facts import physical_task
from prag_asp.physics.witness import Witness
from prag_asp.physics.world.simulator import Simulator, open_simulator
from prag_asp.scene.scene import Scene
from prag_asp.task import Task


def check_witness(task: Task, witness: Witness, scene: Scene) -> list[str]:
    """Return the problems of a task's witness, or nothing if it passes; use `open_witness_check` for many witnesses.

    Every state is loaded into a fresh simulator. A witness passes if all numbers are finite, joints are within their
    limits, facts have their required truth values, nothing collides or falls, the simulator's forward kinematics agrees
    with the grasp of the held object, and the only bodies that move are those that the action is meant to move.

    Raises:
        SceneError: the task contains an entity that has no shape.
    """
    with open_witness_check(scene) as check:
        return check(task, witness)


@contextmanager
def open_witness_check(scene: Scene) -> Iterator[Callable[[Task, Witness], list[str]]]:
    """Yield a function like `check_witness` that checks all tasks of one scene in a single simulator."""
    with open_simulator(scene) as simulator:
        yield lambda task, witness: witness_problems(task, witness, simulator, scene)


def witness_problems(task: Task, witness: Witness, simulator: Simulator, scene: Scene) -> list[str]:
    """Return the problems of a task's witness, or nothing if it passes, as `check_witness` does.

    Afterwards, the bodies in the `simulator` of the scene have the sizes of the witness.
    """
    physical = physical_task(task, scene)
    unfit = count_mismatch(witness, len(physical.effects))
    if unfit is not None:
        return [unfit]
    unsized = [entity for entity in physical.objects if entity in scene.ranges and entity not in witness.sizes]
    if unsized:
        return [f"the witness has no size of {', '.join(unsized)}"]
    try:
        simulator.use(scene.with_sizes(witness.sizes))
    except SceneError as error:
        return [str(error)]
    broken = [list(broken_numbers(moment, physical, simulator)) for moment in witness.moments]
    problems = list[str]()
    for k, moment in enumerate(witness.moments):
        texts = broken[k] or state_problems(moment, physical, k, simulator)
        problems += [f"state {k}: {text}" for text in texts]
    ends = list(map(End, witness.moments, physical.states))
    for k, (motion, effect) in enumerate(zip(witness.motions, physical.effects, strict=True)):
        if not broken[k] and not broken[k + 1]:
            before, after = ends[k : k + 2]
            texts = [*motion_problems(motion, before, after, simulator)]
            texts += stray_objects(effect, before.moment, after.moment, simulator)
            problems += [f"action {k + 1}, {effect.action}: {text}" for text in texts]
    return problems
