"""A domain under a condition: the encodings that test its clauses, and the facts that they are asked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import clingo

from prag_asp.domain.load import Domain
from prag_asp.logic.ground.program import ADDED
from prag_asp.program.facts import Facts
from prag_asp.program.sources import Program, Source, read_sources
from prag_asp.space.conditions.clauses import Clause, Ends
from prag_asp.space.conditions.condition import Condition
from prag_asp.stage import stage


def conditioned(domain: Domain, condition: Condition) -> Domain:
    """Return a domain whose plans are those of `domain` that satisfy a condition.

    The condition becomes part of the program, so every engine answers for it as for any rule, and entities that it
    tells apart are no longer interchangeable.

    Raises:
        QueryError: the condition speaks of something that the domain does not have.
    """
    stage("reading the conditions")
    facts, files, asked = domain.facts, [], []
    for number, clause in enumerate(_one_end(condition.clauses, facts)):
        goal = _goal(clause, facts)
        if goal is not None:
            facts = replace(facts, goal=tuple(dict.fromkeys((*facts.goal, *goal))))
            asked += [f"goal({fluent},{value})." for fluent, value in goal]
            continue
        files.append(clause.file)
        asked += [f"asked({term})." for term in clause.asked(number, domain.facts)]
    folder = domain.encodings / "conditions"
    read = (source for file in dict.fromkeys(files) for source in read_sources(folder / f"{file}.lp", domain.encodings))
    sources = {source.path.resolve(): source for source in (*domain.program.sources, *read)}
    added = [Source(ADDED, " ".join(dict.fromkeys(asked)))] if asked else []
    return replace(domain, program=Program((*sources.values(), *added)), facts=facts)


def _one_end(clauses: Sequence[Clause], facts: Facts) -> list[Clause]:
    """Return clauses with all choices that the last state has as one clause, for one state has to satisfy them all.

    What asks for one conjunction leaves no choice, and stays alone.
    """
    ends = [clause for clause in clauses if isinstance(clause, Ends) and len(clause.conjunctions(facts)) != 1]
    if len(ends) < 2:
        return list(clauses)
    together = Ends(", ".join(f"({clause.formula})" for clause in ends))
    return [*(clause for clause in clauses if clause not in ends), together]


def _goal(clause: Clause, facts: Facts) -> list[tuple[clingo.Symbol, str]] | None:
    """Return a clause as a goal, where it asks for one conjunction of fluents at the end."""
    if not isinstance(clause, Ends):
        return None
    found = clause.conjunctions(facts)
    if len(found) != 1:
        return None
    fluents = {str(fluent): fluent for fluent in facts.fluents}
    return [(fluents[fluent], "true" if value else "false") for fluent, value in found[0].items()]
