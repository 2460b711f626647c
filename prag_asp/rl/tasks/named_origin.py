"""Build the origin of an environment's tasks from plain values, so that text can specify it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from prag_asp.dataset.store.dataset import Dataset
from prag_asp.domain.load import Domain, load_domain
from prag_asp.errors import QueryError
from prag_asp.exact_numbers import Number
from prag_asp.rl.tasks.task_origin import Curricula, Split, TaskOrigin
from prag_asp.space.parts.ranked_tasks import RankedTasks
from prag_asp.space.task_space import TaskSpace
from prag_asp.space.without_replacement import Division
from prag_asp.task import Task

Lengths = int | str | Iterable[int]
Shares = Mapping[str, Number | float]

SHARES: Shares = {"train": "0.8", "test": "0.2"}
"""The default shares of the parts of a split space."""


@dataclass(frozen=True)
class SplitOptions:
    """The options of a split: the name of the part to use, if any, and the options for the division of a space."""

    part: str | None
    shares: Shares | None
    skeletons: bool
    hold_out: str | None
    seed: int

    def split(self) -> Split | None:
        """Return the split of a space.

        Raises:
            QueryError: the options are wrong, or contradict each other.
        """
        if self.part is None:
            self.require_default("no part is named; give split, such as split='train'")
            return None
        if isinstance(self.seed, bool) or not isinstance(self.seed, int):
            raise QueryError(f"split_seed {self.seed!r:.80}: give a whole number")
        if self.shares is not None and not isinstance(self.shares, Mapping):
            raise QueryError(f"shares {self.shares!r:.80}: give the share of each part, such as {SHARES}")
        shares = self.shares or (SHARES if self.hold_out is None else None)
        return Split(self.part, Division.parse(shares, skeletons=self.skeletons, hold_out=self.hold_out), self.seed)

    def require_default(self, reason: str) -> None:
        """Check that all options for the division of a space have their default values.

        Raises:
            QueryError: an option does; the message states the `reason` why the option has no effect.
        """
        if self.shares is not None or self.skeletons or self.hold_out is not None or self.seed != 0:
            raise QueryError(f"shares, skeletons, hold_out and split_seed divide a space: {reason}")


def named_origin(
    *,
    space: TaskSpace | None,
    part: RankedTasks | None,
    dataset: Dataset | str | Path | None,
    task: Task | None,
    domain: Domain | str | None,
    length: Lengths | None,
    where: Sequence[str],
    split: SplitOptions,
    curriculum: Curricula,
    trivial: bool = False,
) -> TaskOrigin:
    """Return the origin of tasks: a space, a `domain` with a `length`, a dataset or its folder, or one task.

    The conditions `where` restrict a space or a dataset, and `split` selects a part of it. Tasks of a space whose final
    state equals the initial state are excluded unless `trivial` is true.

    Raises:
        QueryError: the values are wrong, missing or contradictory.
        DomainError: there is no such domain, or the domain has errors.
    """
    if isinstance(where, str) or not all(isinstance(condition, str) for condition in where):
        raise QueryError(f'where {where!r:.80}: give a list of conditions, such as ["uses cube_1"]')
    if all(each is None for each in (space, dataset, task)) and domain is not None:
        if length is None:
            raise QueryError('a domain alone names no tasks; give the number of their actions, such as length="2..4"')
        space = TaskSpace(domain if isinstance(domain, Domain) else load_domain(domain), length)
    elif length is not None:
        raise QueryError(f"length {length!r:.80}: give it with a domain; a space, a dataset and a task have their own")
    if isinstance(dataset, str | Path):
        dataset = Dataset.open(dataset)
    if isinstance(dataset, Dataset):
        split.require_default("a dataset has its parts; give the name of one as split")
        dataset = dataset.where(*where)
        return TaskOrigin(space, part, dataset if split.part is None else dataset.part(split.part), task, curriculum)
    if isinstance(space, TaskSpace):
        space = space.where(*where)
    elif where:
        raise QueryError("where restricts a domain, a space or a dataset; give one of them")
    return TaskOrigin(space, part, dataset, task, curriculum, split.split(), trivial)
