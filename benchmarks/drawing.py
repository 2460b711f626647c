"""Drawing beside clingo's random search, in one run: python benchmarks/drawing.py."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path
from time import process_time

import clingo
from rich.console import Console
from rich.table import Table

from prag_asp import TaskSpace, load_domain
from prag_asp.dataset.jsonl import Record, write_line
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.ground.ground_step import unrolled
from prag_asp.program.grounding import Grounder

DOMAIN = load_domain(Path(__file__).parent / "transport")
LENGTH, SHORT = 15, 4
"""Lengths at which rates are measured, and at which chi-square is."""

RUNS = 3
CHECKED = 20_000
"""Draws that chi-square takes, for each way to draw but clingo's."""

BY_CLINGO = 3000


def rate(draw: Callable[[int], object], count: int) -> float:
    """Return how many tasks a second of processor time are drawn, in the best of some runs."""
    draw(count // 10)
    times = []
    for _ in range(RUNS):
        begun = process_time()
        draw(count)
        times.append(process_time() - begun)
    return count / min(times)


def clingo_draws(length: int) -> Iterator[tuple[str, ...]]:
    """Yield tasks that clingo finds first, with random decisions and signs, from a new seed each time."""
    grounder = Grounder(DomainLogic(DOMAIN).task_program(length), "1", "--rand-freq=1", "--sign-def=rnd")
    grounder.ground([("base", []), *unrolled(length)])
    solver = grounder.control.configuration.solver
    assert isinstance(solver, clingo.Configuration)
    for seed in range(1, 2**31):
        solver.seed = str(seed)
        with grounder.control.solve(yield_=True) as handle:
            model = handle.model()
            assert model is not None
            chosen = [symbol.arguments for symbol in model.symbols(atoms=True) if symbol.match("occurs", 2)]
        yield tuple(str(action) for action, _ in sorted(chosen, key=lambda each: each[1].number))


def chi_square(words: Iterator[tuple[str, ...]], draws: int) -> float:
    """Return chi-square over its degrees of freedom against the uniform distribution; 1 is right."""
    total = TaskSpace(DOMAIN, SHORT).count()
    seen = Counter(islice(words, draws))
    expected = draws / total
    missing = (total - len(seen)) * expected
    return (sum((count - expected) ** 2 / expected for count in seen.values()) + missing) / (total - 1)


def main() -> None:
    """Print the rates at one length and the chi-square at a short one, for each way to draw."""
    space, short = TaskSpace(DOMAIN, LENGTH), TaskSpace(DOMAIN, SHORT)
    tasks = space.stream(seed=0, weights={})
    found = clingo_draws(LENGTH)
    letters = short.action_texts()
    rows = short.sampling(weights={}).array(CHECKED, seed=2).tolist()
    arrays = (tuple(letters[letter] for letter in row) for row in rows)
    lines = (tuple(map(str, task.actions)) for task in short.stream(seed=3, weights={}))
    weighed = {"grasp": 2, "grasp>move": "1/3", "object": "1/2"}
    ways: list[tuple[str, float, float | None]] = [
        ("array", rate(lambda n: space.sampling(weights={}).array(n, seed=0), 1_000_000), chi_square(arrays, CHECKED)),
        ("array, weighed", rate(lambda n: space.sampling(weights=weighed).array(n, seed=0), 1_000_000), None),
        ("Task objects", rate(lambda n: list(islice(tasks, n)), 50_000), chi_square(lines, CHECKED)),
        ("JSON lines", rate(lambda n: [write_line(Record(task)) for task in islice(tasks, n)], 20_000), None),
        ("over skeletons", rate(lambda n: space.sampling(weights={}, over="skeletons").array(n, seed=0), 10_000), None),
        ("over goals", rate(lambda n: space.sampling(weights={}, over="goals").array(n, seed=0), 200_000), None),
        ("clingo, random", rate(lambda n: list(islice(found, n)), 300), chi_square(clingo_draws(SHORT), BY_CLINGO)),
    ]
    table = Table("way to draw", f"tasks/s at length {LENGTH}", f"chi2/df at length {SHORT}")
    for name, speed, fit in ways:
        table.add_row(name, f"{speed:,.0f}", "" if fit is None else f"{fit:.2f}")
    Console().print(table)


if __name__ == "__main__":
    main()
