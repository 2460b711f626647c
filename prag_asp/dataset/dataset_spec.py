"""What a data set is to hold: all that identifies it, and how many tasks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import ceil
from typing import TYPE_CHECKING

from prag_asp.dataset.store.manifest import Asked, BudgetNote, StagingNote
from prag_asp.errors import QueryError
from prag_asp.grammar.phrasings import Phrasings
from prag_asp.space.sampling.sharding import ALL, Deal
from prag_asp.space.without_replacement import Division

if TYPE_CHECKING:
    from prag_asp.physics import Budget, Staging
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.space.weights.temperature import Temperature
    from prag_asp.space.weights.weights import Number

SHARD = 1000
"""Tasks of a full shard, if no other number is asked for."""

LARGEST_SHARD, MOST_STARTS = 20_000, 1000
"""So many tasks, and witnesses of one of them, are held in memory at once."""

DRAWS_FOR_EACH = 1000
"""Draws after which a part is given up, for each task wanted."""

LARGEST_SEED = 2**63 - 1
"""The largest seed that a column of whole numbers holds."""


@dataclass(frozen=True)
class Wanted:
    """What a data set is to hold, beside the space: what identifies it, but for the number of `tasks` and of draws."""

    tasks: int
    seed: int
    division: Division
    budget: Budget | None
    starts: int = 1
    demonstrate: bool = False
    evenly: bool = False
    weights: Mapping[str, Number] | None = None
    temperature: Temperature = 1
    shard: int = SHARD
    language: str = "en"
    staging: Staging | None = None
    max_draws: int | None = None
    deal: Deal = ALL
    phrasings: str = ""

    def __post_init__(self) -> None:
        if self.tasks < 1:
            raise QueryError(f"tasks {self.tasks}: a data set needs at least 1")
        if self.max_draws is not None and self.max_draws < 1:
            raise QueryError(f"max_draws {self.max_draws}: a data set needs at least 1 draw")
        for name, number, most in (("starts", self.starts, MOST_STARTS), ("shard", self.shard, LARGEST_SHARD)):
            if not 1 <= number <= most:
                raise QueryError(f"{name} {number}: give a number from 1 to {most}")
        if not 0 <= self.seed <= LARGEST_SEED:
            raise QueryError(f"seed {self.seed}: give one from 0 to {LARGEST_SEED}")

    def of(self, share: Fraction) -> int:
        """Return how many tasks a part of some share is to have, rounded up, so that more never means fewer.

        Of those that several make together, each makes as many.
        """
        return ceil(Fraction(ceil(self.tasks * share), self.deal.of))

    def draws(self, share: Fraction) -> int:
        """Return after how many draws a part of some share is given up."""
        return self.max_draws or DRAWS_FOR_EACH * self.of(share)

    def asked(self, space: TaskSpace) -> Asked:
        """Return all that identifies the data set of a space."""
        weights = space.domain.settings.weights if self.weights is None else self.weights
        division = self.division
        budget = None if self.budget is None else BudgetNote(**self.budget.to_json())
        staging = self.staging
        return Asked(
            lengths=list(space.lengths),
            where=[str(clause) for clause in space.condition.clauses],
            seed=self.seed,
            weights={key: str(weight) for key, weight in weights.items()},
            temperature=str(self.temperature),
            evenly=self.evenly,
            split={name: str(share) for name, share in division.shares.items()},
            skeletons=division.skeletons,
            hold_out=division.hold_out,
            budget=budget,
            starts=self.starts,
            demonstrate=self.demonstrate,
            shard=self.shard,
            language=self.language,
            staging=None if staging is None else StagingNote.of(staging),
            part=None if self.deal == ALL else str(self.deal),
            phrasings=str(Phrasings.parse(self.phrasings)),
        )
