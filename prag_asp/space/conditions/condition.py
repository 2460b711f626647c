"""Conditions on tasks, as values that are parsed from and printed as plain text."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from prag_asp.space.conditions.clause_kinds import Clause


@dataclass(frozen=True)
class Condition:
    """A conjunction of clauses: ``Condition.parse("uses apple", "has at least 2 grasp", "loop-free")``.

    Its text has one clause per line.
    """

    clauses: tuple[Clause, ...] = ()

    @classmethod
    def parse(cls, *words: str) -> Condition:
        """Return the condition of some texts, each with one clause per line.

        Raises:
            QueryError: a line is no clause.
        """
        from prag_asp.space.conditions.keywords import parse_clause

        lines = (line for text in words for line in text.split("\n") if line.strip())
        return cls(tuple(map(parse_clause, lines)))

    @property
    def fewest_actions(self) -> int:
        """A lower bound on the number of actions of a plan that satisfies it."""
        from prag_asp.space.conditions.clause_kinds import fewest_actions

        return max(map(fewest_actions, self.clauses), default=0)

    def __and__(self, other: Condition) -> Condition:
        return Condition((*self.clauses, *(clause for clause in other.clauses if clause not in self.clauses)))

    def __bool__(self) -> bool:
        return bool(self.clauses)

    def __str__(self) -> str:
        return "\n".join(map(str, self.clauses))
