"""Compare sampling with clingo's random search: python benchmarks/sampling.py."""

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
"""The lengths for measuring the rates, and for measuring chi-square."""

RUNS = 3
CHECKED = 20_000
"""The number of samples for chi-square, except for clingo's."""

BY_CLINGO = 3000


def rate(sample: Callable[[int], object], count: int) -> float:
    """Return the sampled tasks per second of processor time, in the best of `RUNS` runs."""
    sample(count // 10)
    times = []
    for _ in range(RUNS):
        begun = process_time()
        sample(count)
        times.append(process_time() - begun)
    return count / min(times)


def clingo_draws(length: int) -> Iterator[tuple[str, ...]]:
    """Yield the first task that clingo finds with random decisions and signs, with a new seed each time."""
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
    """Return chi-square divided by its degrees of freedom for the uniform distribution; about 1 is expected."""
    total = TaskSpace(DOMAIN, SHORT).count()
    seen = Counter(islice(words, draws))
    expected = draws / total
    missing = (total - len(seen)) * expected
    return (sum((count - expected) ** 2 / expected for count in seen.values()) + missing) / (total - 1)


def main() -> None:
    """Print the rate at one length and chi-square at a short one, for each way to sample."""
    space, short = TaskSpace(DOMAIN, LENGTH), TaskSpace(DOMAIN, SHORT)
    tasks = space.stream(seed=0, weights={})
    from_clingo = clingo_draws(LENGTH)
    texts = short.action_texts()
    rows = short.sampling(weights={}).array(CHECKED, seed=2).tolist()
    arrays = (tuple(texts[number] for number in row) for row in rows)
    lines = (tuple(map(str, task.actions)) for task in short.stream(seed=3, weights={}))
    weights = {"grasp": 2, "grasp>move": "1/3", "object": "1/2"}
    ways: list[tuple[str, float, float | None]] = [
        ("array", rate(lambda n: space.sampling(weights={}).array(n, seed=0), 1_000_000), chi_square(arrays, CHECKED)),
        ("array, weights", rate(lambda n: space.sampling(weights=weights).array(n, seed=0), 1_000_000), None),
        ("Task objects", rate(lambda n: list(islice(tasks, n)), 50_000), chi_square(lines, CHECKED)),
        ("JSON lines", rate(lambda n: [write_line(Record(task)) for task in islice(tasks, n)], 20_000), None),
        ("over skeletons", rate(lambda n: space.sampling(weights={}, over="skeletons").array(n, seed=0), 10_000), None),
        ("over goals", rate(lambda n: space.sampling(weights={}, over="goals").array(n, seed=0), 200_000), None),
        (
            "clingo, random",
            rate(lambda n: list(islice(from_clingo, n)), 300),
            chi_square(clingo_draws(SHORT), BY_CLINGO),
        ),
    ]
    table = Table("way to sample", f"tasks/s at length {LENGTH}", f"chi2/df at length {SHORT}")
    for name, speed, fit in ways:
        table.add_row(name, f"{speed:,.0f}", "" if fit is None else f"{fit:.2f}")
    Console().print(table)


if __name__ == "__main__":
    main()
