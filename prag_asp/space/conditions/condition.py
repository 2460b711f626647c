"""What tasks have to satisfy, as a value that is written and read in plain words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from prag_asp.space.conditions.clause_kinds import Clause


@dataclass(frozen=True)
class Condition:
    """All of some clauses: ``Condition.parse("uses apple", "has at least 2 grasp", "loop-free")``.

    As text, it is the words of its clauses, one on each line.
    """

    clauses: tuple[Clause, ...] = ()

    @classmethod
    def parse(cls, *words: str) -> Condition:
        """Return the condition that texts spell, each one clause or several lines of them.

        Raises:
            QueryError: a text spells none.
        """
        from prag_asp.space.conditions.keywords import parse_clause

        lines = (line for text in words for line in text.split("\n") if line.strip())
        return cls(tuple(map(parse_clause, lines)))

    @property
    def fewest_actions(self) -> int:
        """How many actions a plan has at least that satisfies it, as far as that is known at once."""
        from prag_asp.space.conditions.clause_kinds import fewest_actions

        return max(map(fewest_actions, self.clauses), default=0)

    def __and__(self, other: Condition) -> Condition:
        return Condition((*self.clauses, *(clause for clause in other.clauses if clause not in self.clauses)))

    def __bool__(self) -> bool:
        return bool(self.clauses)

    def __str__(self) -> str:
        return "\n".join(map(str, self.clauses))
