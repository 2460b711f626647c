"""Conditions on tasks, as values that are parsed from and printed as plain text."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from prag_asp.space.conditions.clause_kinds import Clause


LARGE = 100
"""The largest upper bound on occurrences that is kept even for shorter plans, so that lengths share engines."""


@dataclass(frozen=True)
class Condition:
    """A conjunction of clauses: ``Condition.parse("uses apple", "has at least 2 grasp", "loop-free")``.

    Its text has one clause per line.
    """

    clauses: tuple[Clause, ...] = ()

    @classmethod
    def parse(cls, *words: str) -> Condition:
        """Return the condition stated by texts, each of which has one clause per line.

        Raises:
            QueryError: a line is not a clause.
        """
        from prag_asp.space.conditions.keywords import parse_clause

        lines = (line for text in words for line in text.split("\n") if line.strip())
        return cls(tuple(map(parse_clause, lines)))

    @property
    def fewest_actions(self) -> int:
        """A lower bound on the number of actions of a plan that satisfies the condition."""
        from prag_asp.space.conditions.clause_kinds import fewest_actions

        return max(map(fewest_actions, self.clauses), default=0)

    def up_to(self, length: int) -> Condition:
        """Return an equivalent condition for plans of at most `length` actions, with large upper bounds reduced.

        The state of a plan counts occurrences up to the reduced bounds, which barely exceed `length`, or `LARGE` if
        that is greater. Different bounds remain different, so that the condition distinguishes the same entities.
        """
        from prag_asp.space.conditions.clause_kinds import Has, Range

        largest = max(length, LARGE)
        large = sorted(
            {
                clause.times.high
                for clause in self.clauses
                if isinstance(clause, Has) and clause.times.high is not None and clause.times.high > largest
            }
        )
        bounds = {high: largest + number for number, high in enumerate(large, 1)}
        return Condition(
            tuple(
                replace(
                    clause, times=Range(min(clause.times.low, bounds[clause.times.high]), bounds[clause.times.high])
                )
                if isinstance(clause, Has) and clause.times.high in bounds
                else clause
                for clause in self.clauses
            )
        )

    def __and__(self, other: Condition) -> Condition:
        return Condition((*self.clauses, *(clause for clause in other.clauses if clause not in self.clauses)))

    def __bool__(self) -> bool:
        return bool(self.clauses)

    def _repr_html_(self) -> str:
        """Return the clauses as a list, for a notebook."""
        from prag_asp.html import element, fragment

        items = (element("li", element("code", str(clause))) for clause in self.clauses)
        return fragment(element("ul", *items) if self else element("p", "every task"))

    def __str__(self) -> str:
        return "\n".join(map(str, self.clauses))
