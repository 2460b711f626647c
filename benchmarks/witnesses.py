"""Check every witness that validation accepts with an independent checker that shares no code with it.

    python benchmarks/witnesses.py tabletop --count 10000
    python benchmarks/witnesses.py two_arms --tier transit --count 100

The checker in tests/independent uses NumPy alone, with separate implementations of arm kinematics, collisions,
furniture, balance and relations. With the tier transit it also follows the motions of the arm. Exits with code 1 and a
list of the faults if a witness fails.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from pathlib import Path

from rich.console import Console
from rich.progress import track
from rich.table import Table

sys.path.insert(0, str(Path(__file__).parents[1]))

from prag_asp import TaskSpace, load_domain
from prag_asp.dataset.jsonl import Record, write_line
from prag_asp.domain.load import load_scene
from prag_asp.physics import Budget, Tier, validate_tasks
from tests.independent.check import problems
from tests.independent.world import world_of


def main() -> None:
    """Sample tasks of each length, validate them, check the witnesses, and print a table and the faults."""
    options = _options()
    domain = load_domain(options.domain)
    scene = load_scene(domain)
    world, console = world_of(scene), Console(stderr=True)
    budget, results = Budget(tier=Tier(options.tier)), dict[int, Counter[str]]()
    faults: list[str] = []
    for length in options.lengths:
        number = options.count // len(options.lengths)
        tasks = list(TaskSpace(domain, length).sample(number, seed=options.seed, weights={}))
        verdicts = validate_tasks(tasks, scene, seed=options.seed, workers=options.workers, budget=budget)
        counts = results[length] = Counter[str]()
        pairs = zip(tasks, verdicts, strict=True)
        for task, verdict in track(pairs, f"length {length}", total=number, console=console):
            if verdict.witness is None:
                counts["none"] += 1
                continue
            data = json.loads(write_line(Record(task, None, verdict.witness.to_json())))
            broken = problems(data, data["witness"], world, ways=budget.includes(Tier.TRANSIT))
            counts["wrong" if broken else "right"] += 1
            if broken:
                faults.append(
                    f"length {length}, seed {options.seed}, index {verdict.index}, {task}: {'; '.join(broken)}"
                )
    Console().print(_table(options.domain, budget, results))
    for text in faults:
        Console().print(text, soft_wrap=True, highlight=False)
    sys.exit(1 if faults else 0)


def _options() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description="Check the witnesses of random tasks independently.")
    parser.add_argument("domain", nargs="?", default="tabletop")
    parser.add_argument("--lengths", type=int, nargs="+", default=[3, 4, 5, 6])
    parser.add_argument("--count", type=int, default=10_000, help="total number of tasks")
    parser.add_argument("--tier", choices=("kinematics", "settling", "transit"), default="kinematics")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=1)
    return parser.parse_args()


def _table(domain: str, budget: Budget, results: dict[int, Counter[str]]) -> Table:
    """Return the table of the witnesses of each length that passed."""
    table = Table(title=f"{domain}: witnesses of budget {budget}, checked independently")
    for name in ("length", "witnesses", "passed", "failed", "tasks without a witness"):
        table.add_column(name, justify="right")
    for name, counts in [
        *((str(length), each) for length, each in results.items()),
        ("all", sum(results.values(), Counter())),
    ]:
        right, failed = counts["right"], counts["wrong"]
        table.add_row(name, f"{right + failed:,}", f"{right:,}", str(failed), str(counts["none"]))
    return table


if __name__ == "__main__":
    main()
