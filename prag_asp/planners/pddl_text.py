"""The names and formulas of a domain as PDDL text.

If negative conditions are not allowed, `opposites` maps a predicate to the predicate for its negation.
"""

from __future__ import annotations

import re
from collections.abc import Hashable, Iterable, Mapping

from prag_asp.planners.lifted_actions import Clause, Literal, PddlCase

KEYWORDS = frozenset([
    "and", "or", "not", "imply", "forall", "exists", "when", "either", "object", "number", "define", "domain",
    "problem", "assign", "increase", "decrease", "scale-up", "scale-down", "minimize", "maximize", "oneof",
    "preference", "always", "sometime", "within", "over", "at", "start", "end", "all", "total-cost", "total-time",
])  # fmt: skip
"""Reserved words in PDDL; `at` is reserved in some dialects."""


class Spelling:
    """Unique PDDL names, because some parsers refuse shared names."""

    def __init__(self) -> None:
        self._names: dict[Hashable, str] = {}
        self._taken: set[str] = set(KEYWORDS)

    def name(self, thing: Hashable, text: str) -> str:
        """Return the unique name of an item, derived from a text."""
        if thing not in self._names:
            plain = re.sub(r"[^a-z0-9_]+", "-", text.lower()).strip("-_")
            first = plain if re.match("[a-z]", plain) else f"n{plain}"
            name, number = first, 2
            while name in self._taken:
                name, number = f"{first}-{number}", number + 1
            self._taken.add(name)
            self._names[thing] = name
        return self._names[thing]


def mirror(literals: Iterable[Literal], opposites: Mapping[str, str]) -> list[Literal]:
    """Return the literals of the opposite predicates, for those literals whose predicates have an opposite."""
    return [(opposites[name], terms, not value) for name, terms, value in literals if name in opposites]


def all_of(literals: Clause, clauses: Iterable[Clause], opposites: Mapping[str, str]) -> str:
    """Return literals and clauses as PDDL formulas, each preceded by a blank."""
    formulas = [
        as_text(
            (opposites[name], terms, True) if not value and name in opposites else (name, terms, value)
            for name, terms, value in several
        )
        for several in (literals, *clauses)
    ]
    return formulas[0] + "".join(f" (or{clause})" for clause in formulas[1:])


def effects(case: PddlCase, opposites: Mapping[str, str]) -> str:
    """Return the effects of a case as PDDL text, each preceded by a blank."""
    by_condition: dict[Clause, list[Literal]] = {}
    for where, each in case.effects:
        by_condition.setdefault(where, []).append(each)
    formulas = ""
    for where, after in by_condition.items():
        text = as_text([*after, *mirror(after, opposites)])
        formulas += f" (when (and{all_of(where, (), opposites)}) (and{text}))" if where else text
    return formulas


def as_text(literals: Iterable[Literal]) -> str:
    """Return literals as PDDL text, each preceded by a blank."""
    texts = (
        f"({' '.join([name, *terms])})" if value else f"(not ({' '.join([name, *terms])}))"
        for name, terms, value in literals
    )
    return "".join(f" {text}" for text in texts)
