"""Sample tasks from each stratum of a space, with exact weights."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from dataclasses import dataclass
from itertools import count as numbers_from
from itertools import tee
from typing import TYPE_CHECKING

from prag_asp.dataset.dataset_spec import budget_of
from prag_asp.dataset.jsonl import Record
from prag_asp.dataset.pass_rates import Tally
from prag_asp.dataset.scenes import scene_of
from prag_asp.dataset.strata.stratum_figures import StratumFeed, StratumFigures, stratum_weights
from prag_asp.errors import NotFound
from prag_asp.space.strata.allocation import FEWEST, Stratification
from prag_asp.space.strata.stratum import Stratum, strata_of
from prag_asp.space.without_replacement import with_tasks
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.physics import Budget, Verdict
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.task import Task


@dataclass(frozen=True)
class StratifiedSample:
    """The tasks of a stratified sample, each with its stratum and its weight, and the figures of the strata."""

    records: Sequence[Record]
    strata: Sequence[StratumFigures]


def allocated(space: TaskSpace, count: int, stratification: Stratification, seed: int) -> list[tuple[Stratum, int]]:
    """Return the strata of a space, each with its number of tasks in a sample of `count` tasks.

    Raises:
        QueryError: the space is empty, or too small or too finely divided for that many tasks.
    """
    strata = strata_of(space, stratification.by, seed=seed, most=max(count // FEWEST, 1))
    return list(zip(strata, stratification.counts(strata, count), strict=True))


def stratified_sample(
    space: TaskSpace,
    count: int,
    stratification: Stratification,
    *,
    seed: int = 0,
    physics: bool | None = None,
    budget: Budget | None = None,
    workers: int = 1,
    tally: Tally | None = None,
    progress: Callable[[], None] = lambda: None,
) -> StratifiedSample:
    """Return distinct tasks, sampled uniformly without replacement from each stratum of a space.

    With physics, which is the default if the domain has a scene, the tasks are feasible: each stratum is sampled until
    the required number of feasible tasks is found, or until all tasks of the stratum have been drawn. The weights of
    all tasks sum to 1. Without physics, the weighted mean of a property is an unbiased estimate of the mean over the
    whole space; with physics, it is a nearly unbiased ratio estimate of the mean over the feasible tasks.

    Raises:
        QueryError: the space is empty, or too small or too finely divided for that many tasks.
        SceneError: physics is requested, and the domain has no scene.
        NotFound: 1000 draws for each task of a stratum contain too few feasible ones.
        WorkerError: workers died repeatedly.
    """
    quotas = allocated(space, count, stratification, seed)
    draws = [enumerate(task for _, task in with_tasks(space, each.order.pick(numbers_from(0)))) for each, _ in quotas]
    feed = StratumFeed([(each.name, each.size, quota) for each, quota in quotas], draws)
    with_physics = bool(space.domain.settings.scene) if physics is None else physics
    tally = Tally() if tally is None else tally
    verdicts: Generator[tuple[Record, Verdict | None], None, None] = (
        _validated(space, feed, seed, budget, workers) if with_physics else _accepted(feed)
    )
    found: list[Record] = []
    places: list[str] = []
    with closing(verdicts):
        for record, verdict in verdicts:
            passes = verdict is None or verdict.feasible
            name = feed.take(counts=passes)
            if name is None:
                continue
            if verdict is not None:
                tally.add(verdict)
                progress()
            if passes:
                found.append(record)
                places.append(name)
            if feed.full:
                break
    if not feed.exhausted:
        raise NotFound(f"only {feed.found} of {plural(count, 'task')} found; use a larger budget, or other strata")
    strata, numbers = feed.figures(), {each: places.count(each) for each in set(places)}
    weights = stratum_weights(strata)
    return StratifiedSample(
        [
            Record(each.task, each.verdict, each.witness, stratum=place, weight=weights[place] / numbers[place])
            for each, place in zip(found, places, strict=True)
        ],
        strata,
    )


def _accepted(feed: StratumFeed[Task]) -> Generator[tuple[Record, None], None, None]:
    """Yield the record of each task, without physics."""
    return ((Record(task), None) for _, task in feed)


def _validated(
    space: TaskSpace, feed: StratumFeed[Task], seed: int, budget: Budget | None, workers: int
) -> Generator[tuple[Record, Verdict], None, None]:
    """Yield the record of each task with its verdict."""
    from prag_asp.physics import validate_numbered

    tasks, again = tee(feed)
    verdicts = validate_numbered(
        tasks, scene_of(space.domain), seed=seed, workers=workers, budget=budget_of(budget, None)
    )
    with closing(verdicts):
        for (_, task), verdict in zip(again, verdicts, strict=False):
            values = verdict.to_json()
            yield Record(task, values, values.pop("witness")), verdict
