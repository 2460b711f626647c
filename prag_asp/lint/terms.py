"""Ground terms that cannot be what they are declared as, and declarations that depend on a choice."""

from __future__ import annotations

import re
from collections.abc import Iterator

import clingo

from prag_asp.lint.directives import STATED
from prag_asp.lint.origin import Origins
from prag_asp.program.facts import Facts
from prag_asp.program.problem import Problem

NAMED = re.compile(r"_*[a-z][^\"#]*")
ENTITY = re.compile(r"[^\"#]*")


def term_problems(facts: Facts, origins: Origins) -> Iterator[Problem]:
    """Yield the entities, fluents, actions and composites that have no name of their own."""
    for predicate, terms in (("fluent", facts.fluents), ("action", facts.actions), ("composite", facts.composites)):
        nameless = [term for term in terms if not NAMED.fullmatch(str(term))]
        for term in nameless[:1]:
            yield Problem(
                *origins.place(predicate, term),
                f"{predicate}({term}) has no name of its own; write a name with arguments, without strings",
            )
    for entity, name in facts.entities.items():
        if not ENTITY.fullmatch(str(entity)):
            yield Problem(
                *origins.place("entity", entity, clingo.parse_term(name)),
                f"{entity} cannot be the name of an entity; write it in lower case, without quotes",
            )


def choice_problems(control: clingo.Control, origins: Origins) -> Iterator[Problem]:
    """Yield the first declaration of each predicate that some answer sets of the base part lack."""
    for name, arity in sorted(STATED):
        uncertain = [each.symbol for each in control.symbolic_atoms.by_signature(name, arity) if not each.is_fact]
        if uncertain:
            atom = min(uncertain)
            yield Problem(
                *origins.place(name, *atom.arguments),
                f"{atom} depends on a choice, but is the same in all plans; let it follow from facts",
            )
