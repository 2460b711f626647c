"""The plans, tasks or skeletons of one length, as the words of an engine."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from prag_asp.errors import QueryError
from prag_asp.logic.symmetry.renaming import renamed
from prag_asp.space.domain_engines import DomainEngines
from prag_asp.space.engines import Engine, Level
from prag_asp.space.engines.engine import Letters
from prag_asp.space.plans.canonical_plan import canonical_names


class RankedWords(Protocol):
    """Some of the tasks of one length, with their ranks."""

    @property
    def length(self) -> int:
        """The number of actions of each task."""
        ...

    def count(self) -> int:
        """Return the number of tasks."""
        ...

    def word(self, rank: int) -> tuple[str, ...]:
        """Return the task with a given rank, as the texts of its actions."""
        ...

    def rank(self, word: tuple[str, ...]) -> int | None:
        """Return the rank of a task, or None if the task is not included."""
        ...


@dataclass(frozen=True)
class WordSet:
    """The words of one level and one length, with their count and ranks."""

    engines: DomainEngines
    by: Level
    length: int

    @property
    def engine(self) -> Engine:
        """The engine of the level and length."""
        return self.engines.engine(self.by, self.length)

    def count(self) -> int:
        """Return the number of words."""
        return self.engines.count(self.by, self.length)

    def word(self, rank: int) -> Letters:
        """Return the word with a given rank, from 0 to ``count() - 1``."""
        return self.engine.unrank(self.length, rank)

    def rank(self, word: Letters) -> int | None:
        """Return the rank of a word, or None if it is not in the set.

        A task may use any names of interchangeable entities; canonical names are faster.
        """
        if len(word) != self.length:
            return None
        rank = self.engine.rank(word)
        actions = self.engines.actions
        if rank is not None or self.by != "task" or not actions.keys() >= {*word}:
            return rank
        plan = [actions[action] for action in word]
        names = canonical_names(plan, self.engines.model.symmetries(self.length))
        return self.engine.rank(tuple(str(renamed(action, names)) for action in plan))

    def require_rank(self, word: Letters) -> int:
        """Return the rank of a word.

        Raises:
            QueryError: the set does not contain the word.
        """
        rank = self.rank(word)
        if rank is None:
            raise QueryError(
                f"no {self.by} of {self.engines.model.domain.label} of length {self.length}: {' '.join(word)}"
            )
        return rank
