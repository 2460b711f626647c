"""How much a curriculum costs: 100 tasks drawn by weights that are new, by those that were there, and by each course.

Processor time, the smallest of some; the first draw, which explores the space, is left out.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import islice
from time import process_time

from rich.console import Console
from rich.table import Table

from prag_asp import TaskSpace, load_domain
from prag_asp.rl import Adaptive, Bandit, Novelty
from prag_asp.rl.curriculum.task_pool import Pool
from prag_asp.rl.curriculum.task_sampler import Attempt, Course, Episode

SPACES = {"prag": 15, "tabletop": 5}
COUNT, TIMES = 100, 3


def smallest(work: Callable[[int], object]) -> float:
    """Return the smallest processor time of some tries, in seconds."""
    found = []
    for number in range(TIMES):
        begun = process_time()
        work(number)
        found.append(process_time() - begun)
    return min(found)


def lot(course: Course, pool: Pool) -> None:
    """Take a lot of tasks, and report on each: the course weighs anew."""
    for number in range(COUNT):
        offer = course.offer()
        course.settle(offer.word, True)
        actions = pool.task(offer).actions
        attempts = [
            Attempt(action, actions[i - 1] if i else None, (number + i) % 3 > 0) for i, action in enumerate(actions)
        ]
        course.report(Episode(len(actions), 0, attempts, number % 2 > 0))


def figures(space: TaskSpace) -> Iterator[str]:
    """Yield the processor time of each kind of draw."""
    names = sorted({str(action).split("(")[0] for action in space.domain.facts.actions})

    def drawn(number: int) -> None:
        weights = {each: f"{number + place + 2}/3" for place, each in enumerate(names)}
        list(islice(space.stream(seed=1, weights={**weights, f"{names[0]}>{names[1]}": 3}), COUNT))

    yield f"{smallest(drawn):.2f}"
    yield f"{smallest(lambda _: drawn(TIMES - 1)):.2f}"
    pool = Pool(space)
    for kind in (Adaptive(lot=COUNT), Bandit(lot=COUNT), Novelty(), Novelty("skeletons"), Novelty("tasks")):
        course = kind.course(pool)
        lot(course, pool)
        yield f"{smallest(lambda _, course=course: lot(course, pool)):.2f}"


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
