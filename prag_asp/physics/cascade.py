"""The cascade of tiers on a witness that is there already, from cheap to dear."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import NamedTuple

from prag_asp.physics.checks.check import open_witness_check
from prag_asp.physics.checks.settling import open_settling
from prag_asp.physics.demonstration.demonstration import Demonstration
from prag_asp.physics.demonstration.perform import demonstrate
from prag_asp.physics.facts import physical_task
from prag_asp.physics.motion.transit import travel
from prag_asp.physics.search.attempt import NO_PATH
from prag_asp.physics.verdict import Budget
from prag_asp.physics.witness import Witness
from prag_asp.scene.model import Scene
from prag_asp.task import Task


class Passage(NamedTuple):
    """How far a witness came through the tiers: its first fault, none where it passes; the last tier's recording."""

    fault: str = ""
    demonstration: Demonstration | None = None


@contextmanager
def open_cascade(scene: Scene, budget: Budget) -> Iterator[Callable[[Task, Witness], Passage]]:
    """Open simulators and yield the function that checks a witness by the tiers of a budget; close them afterwards.

    A witness that does not show the ways of the arm is given some where the tier of transit is asked for.
    """
    with ExitStack() as resources:
        check = resources.enter_context(open_witness_check(scene))
        settling = resources.enter_context(open_settling(scene)) if budget.includes("settling") else None

        def passage(task: Task, witness: Witness) -> Passage:
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
            demonstration = demonstrate(task, witness, scene)
            return Passage("" if demonstration.success else demonstration.detail, demonstration)

        yield passage
