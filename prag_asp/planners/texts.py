"""Conditions and effects as texts of PDDL; where a predicate is `flipped`, its negation has one of its own."""

from __future__ import annotations

from collections.abc import Iterable

from prag_asp.planners.lifting import Clause, Literal, Written


def opposite(predicate: str) -> str:
    """Return the predicate that says that another does not hold."""
    return f"not-{predicate}"


def positive(literal: Literal, flipped: set[str]) -> Literal:
    """Return a literal whose negation has a predicate of its own as that predicate."""
    name, terms, value = literal
    return literal if value or name not in flipped else (opposite(name), terms, True)


def all_of(literals: Clause, clauses: Iterable[Clause], flipped: set[str]) -> str:
    """Return literals, and of each clause one, as texts of PDDL that are side by side, each after a blank."""
    given = [[positive(each, flipped) for each in several] for several in (literals, *clauses)]
    return as_text(given[0]) + "".join(f" (or{as_text(clause)})" for clause in given[1:])


def effects(case: Written, flipped: set[str]) -> str:
    """Return what a case makes as a text of PDDL, each effect after a blank."""
    made: dict[Clause, list[Literal]] = {}
    for where, each in case.after:
        made.setdefault(where, []).append(each)
    found = ""
    for where, after in made.items():
        text = as_text([*after, *((opposite(each[0]), each[1], not each[2]) for each in after if each[0] in flipped)])
        found += f" (when (and{all_of(where, (), flipped)}) (and{text}))" if where else text
    return found


def as_text(literals: Iterable[Literal]) -> str:
    """Return literals as a text of PDDL, each after a blank."""
    texts = (
        f"({' '.join([name, *terms])})" if value else f"(not ({' '.join([name, *terms])}))"
        for name, terms, value in literals
    )
    return "".join(f" {text}" for text in texts)
