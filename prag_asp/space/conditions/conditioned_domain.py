"""A domain under a condition: the encodings that test its clauses, and the facts that they are asked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from prag_asp.domain.load import Domain
from prag_asp.processes.progress_events import stage
from prag_asp.program.facts import Assignment, Facts
from prag_asp.program.predicates import REQUEST
from prag_asp.program.sources import ADDED, Program, Source, each_once, read_sources
from prag_asp.space.conditions.clause_kinds import Achieves, After, Clause, Ends, asked_end, asked_start
from prag_asp.space.conditions.condition import Condition
from prag_asp.space.conditions.meaning import known_where, shared, simplest, weakest
from prag_asp.space.conditions.state_formula import Conjunction


def conditioned(domain: Domain, condition: Condition) -> Domain:
    """Return a domain whose plans are those of `domain` that satisfy a condition.

    The condition becomes part of the program, so every engine answers for it as for any rule, and entities that it
    distinguishes are no longer interchangeable.

    Raises:
        QueryError: the condition speaks of something that the domain does not have.
    """
    stage("reading the conditions")
    facts, files, asked = domain.facts, [], []
    said = (simplest(clause, facts) for clause in condition.clauses)
    clauses = [clause for clause in said if clause is not None]
    goal, conjunctions = _last_state([clause for clause in clauses if isinstance(clause, Ends)], facts)
    asked += [f"goal({fluent},{value})." for fluent, value in goal]
    achieved = [clause for clause in clauses if isinstance(clause, Achieves)]
    if achieved:
        files.append(Achieves.file)
        asked += [REQUEST.fact(term) for term in asked_start(_first_state(achieved, clauses, facts))]
    if achieved and conjunctions is None:
        conjunctions = [{}]
    if conjunctions is not None:
        files.append(Ends.file)
        asked += [REQUEST.fact(term) for term in asked_end(0, conjunctions)]
    for number, clause in enumerate(clauses):
        if not isinstance(clause, Ends):
            files.append(clause.file)
            asked += [REQUEST.fact(term) for term in clause.requests(number, facts)]
    facts = replace(facts, goal=tuple(dict.fromkeys((*facts.goal, *goal))))
    folder = domain.encodings / "conditions"
    read = (source for file in dict.fromkeys(files) for source in read_sources(folder / f"{file}.lp", domain.encodings))
    added = [Source(ADDED, " ".join(dict.fromkeys(asked)))] if asked else []
    program = Program(each_once((*domain.program.sources, *read, *added)))
    return replace(domain, program=program, facts=facts, reduction=None)


def _last_state(ends: Sequence[Ends], facts: Facts) -> tuple[Assignment, Sequence[Conjunction] | None]:
    """Return what is asked of the final state: a goal, and conjunctions one of which it satisfies as well, if any are.

    All choices of the final state are one, because one state has to satisfy them all. What is so with each of them is
    part of the goal.
    """
    asked = [(clause, clause.conjunctions(facts)) for clause in ends]
    goal = [value for _, found in asked if len(found) == 1 for value in _assigned(found[0], facts)]
    choices = [clause.formula for clause, found in asked if len(found) != 1]
    if not choices:
        return tuple(goal), None
    together = Ends(", ".join(f"({formula})" for formula in choices)).conjunctions(facts)
    found = weakest(together, (*facts.goal, *goal), facts)
    goal += _assigned(shared(found, facts), facts)
    return tuple(goal), None if len(found) == 1 else found


def _first_state(achieved: Sequence[Achieves], clauses: Sequence[Clause], facts: Facts) -> Sequence[Conjunction]:
    """Return the conjunctions one of which is known of an initial state that satisfies one of some formulas."""
    starts = [each for clause in clauses if isinstance(clause, After) and not clause.steps
              for each in _assigned(clause.conjunction(facts), facts)]  # fmt: skip
    asked = [each for clause in achieved for each in clause.conjunctions(facts)]
    return known_where(asked, (*facts.initially, *starts), facts)


def _assigned(conjunction: Conjunction, facts: Facts) -> Assignment:
    """Return a conjunction as the values that fluents have."""
    fluents = {str(fluent): fluent for fluent in facts.fluents}
    return tuple((fluents[fluent], "true" if value else "false") for fluent, value in conjunction.items())
