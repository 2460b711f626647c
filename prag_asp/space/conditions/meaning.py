"""What conditions say, however they are spelled: what says nothing is left out, what says the same has one form.

A formula about the final state is told by the weakest sets of values that entail it together with the invariants, each
with all that follows from it. There is one such form of each formula: no other way to write it, and no invariant that
follows from the others, makes another. It is found from the prime implicants of the formula
or a violated invariant.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

import clingo

from prag_asp.errors import QueryError
from prag_asp.program.facts import Assignment, Facts
from prag_asp.program.invariants import FluentValue, Graph, conflict, entailed, invariant_graph
from prag_asp.space.conditions.clause_kinds import Clause, Has, Names, Range, Uses
from prag_asp.space.conditions.patterns import class_members
from prag_asp.space.conditions.state_formula import Conjunction

Values = frozenset[FluentValue]

MOST_TERMS = 400
"""Conjunctions beyond which a formula keeps the form that it is written in."""


def simplest(clause: Clause, facts: Facts) -> Clause | None:
    """Return the simplest clause that says the same, or None where every plan satisfies it.

    Raises:
        QueryError: it speaks of something that the domain does not have.
    """
    if isinstance(clause, Uses):
        members = len(list(class_members(clause.kind, facts)))
        low, high = clause.number.low, clause.number.high
        if high is not None and high >= members:
            high = None
        if (low, high) in ((1, None), (0, 0)):
            clause = Names(clause.kind, some=low == 1)
        elif (low, high) == (0, None):
            return None
    if isinstance(clause, Has) and clause.times == Range():
        return None if list(clause.requests(0, facts)) else clause
    if isinstance(clause, Names) and not clause.some and not clause.actions(facts):
        return None
    return clause


def weakest(conjunctions: Sequence[Conjunction], goal: Assignment, facts: Facts) -> Sequence[Conjunction]:
    """Return the conjunctions that say of a state which satisfies `goal` what some conjunctions say, in one form.

    None are left where no state satisfies them; an empty one where every state does.
    """
    found = _weakest(conjunctions, goal, facts, invariant_graph(facts))
    return conjunctions if found is None else found


def shared(conjunctions: Sequence[Conjunction], facts: Facts) -> Conjunction:
    """Return what holds in every state that satisfies one of some conjunctions, as far as each of them entails it."""
    graph = invariant_graph(facts)
    names = {str(fluent): fluent for fluent in facts.fluents}
    closed = [{*entailed(((names[fluent], value) for fluent, value in each.items()), graph)} for each in conjunctions]
    return {str(fluent): value for fluent, value in sorted(set.intersection(*closed))} if closed else {}


def known_where(conjunctions: Sequence[Conjunction], given: Assignment, facts: Facts) -> Sequence[Conjunction]:
    """Return conjunctions: of a state with the `given` values, one is known wherever some of others is known to hold.

    What is impossible is known not to be.

    Raises:
        QueryError: there are too many of them.
    """
    found = _weakest(conjunctions, given, facts, invariant_graph(facts, impossible=True))
    if found is None:
        raise QueryError(f"'achieves' has more than {MOST_TERMS} cases; ask for fewer things at once")
    return found


def _weakest(
    conjunctions: Sequence[Conjunction], given: Assignment, facts: Facts, graph: Graph
) -> Sequence[Conjunction] | None:
    names = {str(fluent): fluent for fluent in facts.fluents}
    sure = entailed(((fluent, value == "true") for fluent, value in given), graph)
    if conflict(sure):
        return conjunctions
    terms: list[Values] = []
    for conjunction in conjunctions:
        term = frozenset((names[fluent], value) for fluent, value in conjunction.items())
        if _holds_in_some_state(term, sure, graph):
            terms.append(frozenset(each for each in term if each not in sure and _may_fail(each, graph)))
    violated = _violations({fluent for term in terms for fluent, _ in term}, graph)
    implicants = _prime_implicants([*terms, *violated])
    if implicants is None:
        return None
    possible = (each for each in implicants if _holds_in_some_state(each, sure, graph))
    closed = {frozenset(entailed(each, graph)) - set(sure) for each in possible}
    least = [each for each in closed if not any(other < each for other in closed)]
    return sorted(({str(fluent): value for fluent, value in sorted(_roots(each, graph))} for each in least), key=str)


def _holds_in_some_state(term: Values, sure: Mapping[FluentValue, FluentValue], graph: Graph) -> bool:
    return not conflict(entailed((*term, *sure), graph))


def _may_fail(value: FluentValue, graph: Graph) -> bool:
    fluent, truth = value
    return not conflict(entailed([(fluent, not truth)], graph))


def _violations(fluents: Collection[clingo.Symbol], graph: Graph) -> list[Values]:
    """Return the pairs of values of some fluents that the invariants rule out."""
    found: set[Values] = set()
    for value in ((fluent, truth) for fluent in sorted(fluents) for truth in (True, False)):
        for fluent, truth in entailed([value], graph):
            if fluent in fluents and fluent != value[0]:
                found.add(frozenset([value, (fluent, not truth)]))
    return sorted(found, key=sorted)


def _prime_implicants(terms: Iterable[Values]) -> set[Values] | None:
    """Return the weakest conjunctions that entail that some term holds; None where they grow many.

    Each fluent is resolved once (Tison 1967).
    """
    found = set(terms)
    for fluent in sorted({fluent for term in found for fluent, _ in term}):
        if len(found) > MOST_TERMS:
            return None
        with_it, against = ([term for term in found if (fluent, value) in term] for value in (True, False))
        both = ((one - {(fluent, True)}) | (other - {(fluent, False)}) for one in with_it for other in against)
        found = _absorbed(found | {term for term in both if len({each for each, _ in term}) == len(term)})
    return found


def _absorbed(terms: set[Values]) -> set[Values]:
    return {each for each in terms if not any(other < each for other in terms)}


def _roots(values: Values, graph: Graph) -> Values:
    """Return the values that no other one entails without following from it."""
    below = {value: entailed([value], graph) for value in values}
    return frozenset(v for v in values if not any(v in below[w] and w not in below[v] for w in values))
