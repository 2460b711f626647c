"""Processor time of exact figures over whole task spaces: distances, neighbours, Vendi scores, tasks apart.

``python benchmarks/diversity.py`` computes each figure in this process from a space that has been explored, and checks
the distributions: all ordered pairs add up to the square of the number of tasks.
"""

from __future__ import annotations

import time
from collections.abc import Callable

from rich.console import Console
from rich.table import Table

from prag_asp import TaskSpace, load_domain
from prag_asp.analysis import (
    compare_frequencies,
    count_neighbours,
    hamming_distribution,
    nearest_task,
    tasks_apart,
    vendi_score,
)

SPACES = (("prag", 15, "grasp>rotate"), ("tabletop", 5, "can_1"))
"""Domains, lengths, and what the test part alone has."""


def checked_mean(space: TaskSpace, by: str) -> str:
    """Return the mean distance, after a check of the number of pairs."""
    found = hamming_distribution(space, by)  # type: ignore[arg-type]
    assert sum(found.pairs) == space.count(by) ** 2  # type: ignore[arg-type]
    return f"mean {float(found.mean):.4f}"


def figures(space: TaskSpace, held: str) -> dict[str, Callable[[], object]]:
    """Return what is measured for a space."""
    training, test = space.hold_out(held)
    task, far, some = space[space.count() // 3], test[test.count() // 3], space.sample(1000, seed=0)
    return {
        "distances of plans": lambda: checked_mean(space, "plan"),
        "distances of tasks": lambda: checked_mean(space, "task"),
        "neighbours of a task up to 3 edits": lambda: count_neighbours(space, task, 3),
        "nearest task of the training part": lambda: nearest_task(training, far).distance,
        "Vendi score of the space, actions": lambda: f"{vendi_score(space).score:.2f}",
        "Vendi score of 1,000 tasks, actions": lambda: f"{vendi_score(space, some).score:.2f}",
        "chi-square of 1,000 tasks, pairs": lambda: f"p = {compare_frequencies(space, some, 'pairs').p_value:.3f}",
        "test tasks at least 3 edits apart": lambda: tasks_apart(test, training, 3).count(),
    }


def main() -> None:
    """Print a row for each figure."""
    table = Table("domain, length", "figure", "result", "CPU, s")
    for name, length, held in SPACES:
        space = TaskSpace(load_domain(name), length)
        space.count("plan")
        for figure, compute in figures(space, held).items():
            begun = time.process_time()
            result = compute()
            table.add_row(f"{name}, {length}", figure, str(result), f"{time.process_time() - begun:.2f}")
    Console().print(table)


if __name__ == "__main__":
    main()
