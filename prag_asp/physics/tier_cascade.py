"""The cascade of tiers on a witness that is there already, from cheap to dear."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import NamedTuple

from prag_asp.physics.checks.settling import open_settling
from prag_asp.physics.checks.witness_check import open_witness_check
from prag_asp.physics.demonstration.demonstration import Demonstration
from prag_asp.physics.demonstration.performance import demonstrate
from prag_asp.physics.filming.episode_options import Staging
from prag_asp.physics.filming.film import film
from prag_asp.physics.motion.transit import travel
from prag_asp.physics.search.attempt import NO_PATH
from prag_asp.physics.symbolic_facts import physical_task
from prag_asp.physics.verdict import Budget
from prag_asp.physics.witness import Witness
from prag_asp.scene.scene import Scene
from prag_asp.task import Task


class Passage(NamedTuple):
    """How far a witness came through the tiers: its first fault, none where it passes; the last tier's recording."""

    fault: str = ""
    demonstration: Demonstration | None = None


@contextmanager
def open_cascade(
    scene: Scene, budget: Budget, staging: Staging | None = None, seed: int = 0
) -> Iterator[Callable[..., Passage]]:
    """Open simulators and yield the function that checks a witness by the tiers of a budget; close them afterwards.

    It takes a task, a witness and, where something varies, the index of the task. `staging` says how the witness is
    demonstrated, `seed` what is drawn for that.

    A witness that does not show the ways of the arm is given some where the tier of transit is asked for.
    """
    with ExitStack() as resources:
        check = resources.enter_context(open_witness_check(scene))
        settling = resources.enter_context(open_settling(scene)) if budget.includes("settling") else None

        def passage(task: Task, witness: Witness, index: int = 0) -> Passage:
            for fault in check(task, witness)[:1]:
                return Passage(fault)
            unstable = settling and settling.failure(physical_task(task, scene), witness)
            if unstable:
                return Passage(unstable)
            if budget.includes("transit") and not witness.travels:
                travelled = travel(task, witness, scene)
                if travelled is None:
                    return Passage(NO_PATH)
                witness = travelled
            if not budget.includes("demonstration"):
                return Passage()
            asked, sized = staging or Staging(), scene.with_sizes(witness.sizes)
            variation = asked.drawn(sized, physical_task(task, sized).objects, (seed, index, 0))
            demonstration = demonstrate(task, witness, scene, variation)
            if not demonstration.success:
                return Passage(demonstration.detail, demonstration)
            return Passage("", film(demonstration, scene, asked) if asked.cameras else demonstration)

        yield passage
