"""The names of a domain and its formulas as PDDL text.

Where negative conditions are not allowed, `opposites` has for a predicate the one that stands for its negation.
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
"""Reserved words of PDDL; `at` is reserved in some dialects."""


class Spelling:
    """Gives each thing one name; no two things share a name, because some readers refuse that."""

    def __init__(self) -> None:
        self._names: dict[Hashable, str] = {}
        self._taken: set[str] = set(KEYWORDS)

    def name(self, thing: Hashable, text: str) -> str:
        """Return the name of a thing, which is like a text."""
        if thing not in self._names:
            plain = re.sub(r"[^a-z0-9_]+", "-", text.lower()).strip("-_")
            first = plain if re.match("[a-z]", plain) else f"n{plain}"
            found, number = first, 2
            while found in self._taken:
                found, number = f"{first}-{number}", number + 1
            self._taken.add(found)
            self._names[thing] = found
        return self._names[thing]


def positive(literal: Literal, opposites: Mapping[str, str]) -> Literal:
    """Return a literal whose negation has a predicate of its own as that predicate."""
    name, terms, value = literal
    return literal if value or name not in opposites else (opposites[name], terms, True)


def mirror(literals: Iterable[Literal], opposites: Mapping[str, str]) -> list[Literal]:
    """Return what literals say of the predicates of their negations, where there are some."""
    return [(opposites[name], terms, not value) for name, terms, value in literals if name in opposites]


def all_of(literals: Clause, clauses: Iterable[Clause], opposites: Mapping[str, str]) -> str:
    """Return literals, and of each clause one, as texts of PDDL that are side by side, each after a blank."""
    formulas = [[positive(each, opposites) for each in several] for several in (literals, *clauses)]
    return as_text(formulas[0]) + "".join(f" (or{as_text(clause)})" for clause in formulas[1:])


def effects(case: PddlCase, opposites: Mapping[str, str]) -> str:
    """Return the effects of a case as text of PDDL, each after a blank."""
    by_condition: dict[Clause, list[Literal]] = {}
    for where, each in case.effects:
        by_condition.setdefault(where, []).append(each)
    found = ""
    for where, after in by_condition.items():
        text = as_text([*after, *mirror(after, opposites)])
        found += f" (when (and{all_of(where, (), opposites)}) (and{text}))" if where else text
    return found


def as_text(literals: Iterable[Literal]) -> str:
    """Return literals as a text of PDDL, each after a blank."""
    texts = (
        f"({' '.join([name, *terms])})" if value else f"(not ({' '.join([name, *terms])}))"
        for name, terms, value in literals
    )
    return "".join(f" {text}" for text in texts)
