"""Conditions and effects as texts of PDDL; the negation of a predicate in `opposites` has a predicate of its own."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from prag_asp.planners.lifted_actions import Clause, Literal, Written


def positive(literal: Literal, opposites: Mapping[str, str]) -> Literal:
    """Return a literal whose negation has a predicate of its own as that predicate."""
    name, terms, value = literal
    return literal if value or name not in opposites else (opposites[name], terms, True)


def mirrored(literals: Iterable[Literal], opposites: Mapping[str, str]) -> list[Literal]:
    """Return what literals say of the predicates of their negations, where there are some."""
    return [(opposites[name], terms, not value) for name, terms, value in literals if name in opposites]


def all_of(literals: Clause, clauses: Iterable[Clause], opposites: Mapping[str, str]) -> str:
    """Return literals, and of each clause one, as texts of PDDL that are side by side, each after a blank."""
    given = [[positive(each, opposites) for each in several] for several in (literals, *clauses)]
    return as_text(given[0]) + "".join(f" (or{as_text(clause)})" for clause in given[1:])


def effects(case: Written, opposites: Mapping[str, str]) -> str:
    """Return what a case makes as a text of PDDL, each effect after a blank."""
    made: dict[Clause, list[Literal]] = {}
    for where, each in case.after:
        made.setdefault(where, []).append(each)
    found = ""
    for where, after in made.items():
        text = as_text([*after, *mirrored(after, opposites)])
        found += f" (when (and{all_of(where, (), opposites)}) (and{text}))" if where else text
    return found


def as_text(literals: Iterable[Literal]) -> str:
    """Return literals as a text of PDDL, each after a blank."""
    texts = (
        f"({' '.join([name, *terms])})" if value else f"(not ({' '.join([name, *terms])}))"
        for name, terms, value in literals
    )
    return "".join(f" {text}" for text in texts)
