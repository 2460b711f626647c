"""Tasks that ``prag-asp sample`` chooses: a few that cover all combinations of factors, or some that are far apart."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from prag_asp.cli.terminal import tell_line
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.analysis.covering.covering_set import CoveringSet
    from prag_asp.dataset.jsonl import Record
    from prag_asp.domain.load import Domain
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.task import Task


@dataclass(frozen=True)
class CoveringTasks:
    """The tasks of a covering set, which replace the samples of a space."""

    space: TaskSpace
    found: CoveringSet

    @property
    def domain(self) -> Domain:
        """The domain of the tasks."""
        return self.space.domain

    def stream(self, **drawing: Any) -> Iterator[Task]:
        """Yield the tasks; the options for sampling do not apply."""
        return iter(self.found.tasks)

    def report(self, records: Iterable[Record]) -> Iterator[Record]:
        """Yield the feasible tasks; if they miss combinations, print the number that they cover."""
        from prag_asp.analysis.covering.combinations import coverage

        passed = list(records)
        yield from passed
        covered = coverage((record.task for record in passed), self.space, self.found.strength)
        if covered.missing:
            tell_line(
                f"the feasible tasks cover {len(covered.covered)} of {len(covered.reachable)} reachable combinations; "
                "prag-asp diversity --tasks FILE --coverage lists the others"
            )


def covering_tasks(space: TaskSpace, strength: int) -> CoveringTasks:
    """Return a few tasks that cover all reachable combinations, and print the numbers of both."""
    from prag_asp.analysis.covering.covering_set import covering_set

    found = covering_set(space, strength)
    tell_line(
        f"{plural(len(found.tasks), 'task')} for all {plural(len(found.reachable), 'reachable combination')} of "
        f"{plural(strength, 'factor')}; at least {plural(found.at_least, 'task')} needed"
    )
    return CoveringTasks(space, found)


def far_apart(records: Iterable[Record], count: int, space: TaskSpace) -> Iterator[Record]:
    """Yield `count` tasks that are far apart, and print their distance; yield all tasks if there are no more."""
    from prag_asp.analysis.all_pairs import pair_distances
    from prag_asp.analysis.farthest_first import METRIC, diverse_choice

    given = list(records)
    if len(given) <= count:
        yield from given
        return
    choice = diverse_choice(pair_distances([record.task for record in given], METRIC, space), count)
    tell_line(
        f"{plural(count, 'task')} at least {choice.separation:.4g} apart ({METRIC}); the other {len(given) - count} "
        f"are within {choice.radius:.4g} of them"
    )
    yield from (given[number] for number in choice.tasks)
