"""Whether every state in which an episode can begin stands: for a second after a reset, with its facts.

    python benchmarks/learning/standing.py

It resets to every stage of the witnesses of tasks, drawn uniformly from the shipped domains that have a scene, lets no
arm move for 20 steps, and counts the stages of which all facts of the state still hold, and the facts themselves. Then
it begins with each of them once more, one task after another, and tells the processor time that a reset takes. It ends
with 1 where a fact does not hold.
"""

from __future__ import annotations

import argparse
import itertools
import sys
from collections.abc import Iterator, Sequence
from statistics import median
from time import process_time

import numpy as np
from rich.console import Console
from rich.table import Table
from starts import witnessed

from prag_asp import Task
from prag_asp.physics import Witness, physical_task
from prag_asp.rl import Rate, TaskEnv

SHIPPED = ("prag", "tabletop", "kitchen", "two_arms")

SECOND = 20
"""How many steps of 1/20 s a state shall stand."""


def main() -> None:
    """Let all states stand, and print a table, and what has fallen."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200, help="how many witnesses, of all domains together")
    parser.add_argument("--length", type=int, default=4, help="how many actions their tasks have")
    parser.add_argument("--seed", type=int, default=0, help="the seed of the tasks and their witnesses")
    options = parser.parse_args()
    heads = ("domain", "witnesses", "stages that stand", "facts that hold", "a reset, ms")
    table, fallen = Table(*heads), list[str]()
    for number, domain in enumerate(SHIPPED):
        count = (options.count + number) // len(SHIPPED)
        stages, facts, taken, lost = stood(domain, count, length=options.length, seed=options.seed)
        told = f"{1000 * median(taken):.2f}" if taken else "-"
        table.add_row(domain, str(count), *(f"{rate.successes:,} of {rate.trials:,}" for rate in (stages, facts)), told)
        fallen += lost
    console = Console()
    console.print(table)
    for line in fallen:
        console.print(line, markup=False, highlight=False)
    sys.exit(int(bool(fallen)))


def stood(domain: str, count: int, *, length: int, seed: int) -> tuple[Rate, Rate, list[float], list[str]]:
    """Return how many stages stand, how many facts hold, what each reset takes, and which facts do not hold."""
    drawn = witnessed(domain, length, seed=seed)
    given = list(itertools.islice(drawn, count))
    drawn.close()
    stages, facts, taken, fallen = list[bool](), list[bool](), list[float](), list[str]()
    env: TaskEnv | None = None
    for task, witness in given:
        env = env or TaskEnv(task=task, witness=witness, reward="sparse", steps=SECOND + 1)
        still = np.zeros(env.action_space.shape, dtype=np.float32)
        states = physical_task(task, env.scene).states
        for stage in range(len(task.actions)):
            env.reset(options={"task": task, "witness": witness, "stage": stage})
            for _ in range(SECOND):
                env.step(still)
            held = [fact.is_satisfied(env.situation) for fact in states[stage]]
            facts += held
            stages.append(all(held))
            lost = [fact.sentence() for fact, holds in zip(states[stage], held, strict=True) if not holds]
            fallen += [f"{domain}, {task}, stage {stage}: no longer so: {each}" for each in lost]
    if env is not None:
        taken += resets(env, given)
        env.close()
    return Rate(sum(stages), len(stages)), Rate(sum(facts), len(facts)), taken, fallen


def resets(env: TaskEnv, given: Sequence[tuple[Task, Witness]]) -> Iterator[float]:
    """Yield the seconds of processor time that it takes to begin with each stage, the first of all tasks first."""
    for stage in range(max(len(task.actions) for task, _ in given)):
        for task, witness in given:
            begun = process_time()
            env.reset(options={"task": task, "witness": witness, "stage": stage})
            yield process_time() - begun


if __name__ == "__main__":
    main()
