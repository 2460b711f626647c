"""A domain under a condition: it adds the encodings that test the clauses, and the facts that request the tests."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from prag_asp.domain.load import Domain
from prag_asp.processes.progress_events import stage
from prag_asp.program.facts import Assignment, Facts
from prag_asp.program.predicates import REQUEST
from prag_asp.program.sources import ADDED, Program, Source, each_once, read_sources
from prag_asp.space.conditions.clause_kinds import Achieves, After, Ends, end_requests, start_requests
from prag_asp.space.conditions.condition import Condition
from prag_asp.space.conditions.meaning import known_where, shared, simplest, weakest
from prag_asp.space.conditions.state_formula import Conjunction


def conditioned(domain: Domain, condition: Condition) -> Domain:
    """Return a domain whose plans are the plans of `domain` that satisfy a condition.

    The condition becomes part of the program, so every engine treats it like any other rule, and entities that it
    distinguishes are no longer interchangeable.

    Raises:
        QueryError: the condition names something that the domain does not have.
    """
    stage("reading the conditions")
    facts, files, requests = domain.facts, [], []
    simplified = (simplest(clause, facts) for clause in condition.clauses)
    clauses = [clause for clause in simplified if clause is not None]
    goal, conjunctions = _last_state([clause for clause in clauses if isinstance(clause, Ends)], facts)
    requests += [f"goal({fluent},{value})." for fluent, value in goal]
    achieved = [clause for clause in clauses if isinstance(clause, Achieves)]
    if achieved:
        files.append(Achieves.file)
        starts = [value for clause in clauses if isinstance(clause, After) and not clause.steps
                  for value in _assigned(clause.conjunction(facts), facts)]  # fmt: skip
        reached = [conjunction for clause in achieved for conjunction in clause.conjunctions(facts)]
        already = known_where(reached, (*facts.initially, *starts), facts)  # one of these is known to hold initially
        requests += [REQUEST.fact(term) for term in start_requests(already)]
    if achieved and conjunctions is None:
        conjunctions = [{}]
    if conjunctions is not None:
        files.append(Ends.file)
        requests += [REQUEST.fact(term) for term in end_requests(0, conjunctions)]
    for number, clause in enumerate(clauses):
        if not isinstance(clause, Ends):
            files.append(clause.file)
            requests += [REQUEST.fact(term) for term in clause.requests(number, facts)]
    facts = replace(facts, goal=tuple(dict.fromkeys((*facts.goal, *goal))))
    folder = domain.encodings / "conditions"
    encodings = (
        source for file in dict.fromkeys(files) for source in read_sources(folder / f"{file}.lp", domain.encodings)
    )
    added = [Source(ADDED, " ".join(dict.fromkeys(requests)))] if requests else []
    program = Program(each_once((*domain.program.sources, *encodings, *added)))
    return replace(domain, program=program, facts=facts, reduction=None)


def _last_state(ends: Sequence[Ends], facts: Facts) -> tuple[Assignment, Sequence[Conjunction] | None]:
    """Return the requirements on the final state: a goal, and conjunctions of which at least one must also hold.

    All disjunctive clauses are combined, because one state must satisfy them all. Literals that occur in every
    conjunction become part of the goal.
    """
    cases = [(clause, clause.conjunctions(facts)) for clause in ends]
    goal = [value for _, conjunctions in cases if len(conjunctions) == 1 for value in _assigned(conjunctions[0], facts)]
    choices = [clause.formula for clause, conjunctions in cases if len(conjunctions) != 1]
    if not choices:
        return tuple(goal), None
    together = Ends(", ".join(f"({formula})" for formula in choices)).conjunctions(facts)
    alternatives = weakest(together, (*facts.goal, *goal), facts)
    goal += _assigned(shared(alternatives, facts), facts)
    return tuple(goal), None if len(alternatives) == 1 else alternatives


def _assigned(conjunction: Conjunction, facts: Facts) -> Assignment:
    """Return a conjunction as an assignment of values to fluents."""
    fluents = {str(fluent): fluent for fluent in facts.fluents}
    return tuple((fluents[fluent], "true" if value else "false") for fluent, value in conjunction.items())
