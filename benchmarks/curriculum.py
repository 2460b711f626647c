"""The cost of a curriculum: 100 tasks sampled with new weights, with unchanged weights, and by each curriculum.

Reports the minimum processor time of several runs. The first sample, which explores the space, is not measured.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import islice
from time import process_time

from rich.console import Console
from rich.table import Table

from prag_asp import TaskSpace, load_domain
from prag_asp.rl import AdaptiveCurriculum, BanditCurriculum, NoveltyCurriculum
from prag_asp.rl.curriculum.task_pool import TaskPool
from prag_asp.rl.curriculum.task_sampler import Attempt, EpisodeResult, TaskSampler

SPACES = {"prag": 15, "tabletop": 5}
COUNT, TIMES = 100, 3


def smallest(work: Callable[[int], object]) -> float:
    """Return the minimum processor time of `TIMES` runs, in seconds."""
    times = []
    for number in range(TIMES):
        begun = process_time()
        work(number)
        times.append(process_time() - begun)
    return min(times)


def lot(sampler: TaskSampler, pool: TaskPool) -> None:
    """Sample `COUNT` tasks and report the result of each, so that the sampler updates its weights."""
    for number in range(COUNT):
        proposal = sampler.propose()
        sampler.note_feasibility(proposal.word, True)
        actions = pool.task(proposal).actions
        attempts = [
            Attempt(action, actions[i - 1] if i else None, (number + i) % 3 > 0) for i, action in enumerate(actions)
        ]
        sampler.update(EpisodeResult(len(actions), 0, attempts, number % 2 > 0))


def figures(space: TaskSpace) -> Iterator[str]:
    """Yield the processor time of each way to sample."""
    names = sorted({str(action).split("(")[0] for action in space.domain.facts.actions})

    def sample(number: int) -> None:
        weights = {each: f"{number + place + 2}/3" for place, each in enumerate(names)}
        list(islice(space.stream(seed=1, weights={**weights, f"{names[0]}>{names[1]}": 3}), COUNT))

    yield f"{smallest(sample):.2f}"
    yield f"{smallest(lambda _: sample(TIMES - 1)):.2f}"
    pool = TaskPool(space)
    for kind in (
        AdaptiveCurriculum(lot=COUNT),
        BanditCurriculum(lot=COUNT),
        NoveltyCurriculum(),
        NoveltyCurriculum("skeletons"),
        NoveltyCurriculum("tasks"),
    ):
        sampler = kind.task_sampler(pool)
        sampler.seed(0)
        lot(sampler, pool)
        yield f"{smallest(lambda _, sampler=sampler: lot(sampler, pool)):.2f}"


def main() -> None:
    """Print the figures."""
    table = Table(title=f"{COUNT} tasks, seconds of processor time")
    for column in ("space", "new weights", "the same", "Adaptive", "Bandit", "pairs", "skeletons", "tasks"):
        table.add_column(column)
    for name, length in SPACES.items():
        space = TaskSpace(load_domain(name), length)
        next(space.stream(seed=0))
        table.add_row(f"{name}, n = {length}", *figures(space))
    Console(width=120).print(table)


if __name__ == "__main__":
    main()
