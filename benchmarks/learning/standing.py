"""Check that every state in which an episode can begin is stable: its facts hold for a second after a reset.

    python benchmarks/learning/standing.py

It resets to every stage of the witnesses of uniformly sampled tasks of the shipped domains with a scene, takes 20 steps
without arm motion, and counts the stages in which all facts of the state still hold, and the facts. Then it resets to
each of them again, alternating between tasks, and measures the processor time of a reset. Exits with code 1 if a fact
does not hold.
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
"""The duration of the check, in steps of 1/20 s."""


def main() -> None:
    """Check all states, and print a table and the facts that do not hold."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200, help="total number of witnesses")
    parser.add_argument("--length", type=int, default=4, help="actions of each task")
    parser.add_argument("--seed", type=int, default=0, help="the seed of the tasks and their witnesses")
    options = parser.parse_args()
    heads = ("domain", "witnesses", "stable stages", "facts that hold", "reset, ms")
    table, fallen = Table(*heads), list[str]()
    for number, domain in enumerate(SHIPPED):
        count = (options.count + number) // len(SHIPPED)
        stages, facts, taken, lost = stood(domain, count, length=options.length, seed=options.seed)
        milliseconds = f"{1000 * median(taken):.2f}" if taken else "-"
        table.add_row(
            domain, str(count), *(f"{rate.successes:,} of {rate.trials:,}" for rate in (stages, facts)), milliseconds
        )
        fallen += lost
    console = Console()
    console.print(table)
    for line in fallen:
        console.print(line, markup=False, highlight=False)
    sys.exit(int(bool(fallen)))


def stood(domain: str, count: int, *, length: int, seed: int) -> tuple[Rate, Rate, list[float], list[str]]:
    """Return the rates of stable stages and of facts that hold, the seconds of each reset, and the failed facts."""
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
            fallen += [f"{domain}, {task}, stage {stage}: no longer holds: {each}" for each in lost]
    if env is not None:
        taken += resets(env, given)
        env.close()
    return Rate(sum(stages), len(stages)), Rate(sum(facts), len(facts)), taken, fallen


def resets(env: TaskEnv, given: Sequence[tuple[Task, Witness]]) -> Iterator[float]:
    """Yield the processor seconds of a reset to each stage, all tasks at the first stage first."""
    for stage in range(max(len(task.actions) for task, _ in given)):
        for task, witness in given:
            begun = process_time()
            env.reset(options={"task": task, "witness": witness, "stage": stage})
            yield process_time() - begun


if __name__ == "__main__":
    main()
