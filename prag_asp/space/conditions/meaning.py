"""Normal forms of conditions: vacuous clauses are dropped, and equivalent formulas become equal.

The normal form of a formula about the final state is the set of the weakest conjunctions that entail it under the
invariants, each closed under entailment. It depends neither on the spelling of the formula nor on redundant
invariants, and is computed from the prime implicants of "the formula holds or an invariant is violated".
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from prag_asp.errors import QueryError
from prag_asp.program.facts import Assignment, Facts
from prag_asp.program.invariants import FluentValue, Graph, conflict, entailed, invariant_graph
from prag_asp.space.conditions.clause_kinds import Clause, Has, Names, Range, Uses
from prag_asp.space.conditions.patterns import class_members
from prag_asp.space.conditions.state_formula import Conjunction

Values = frozenset[FluentValue]

MOST_TERMS = 400
"""Number of conjunctions above which a formula is not normalised."""


def simplest(clause: Clause, facts: Facts) -> Clause | None:
    """Return the simplest equivalent clause, or None if every plan satisfies it.

    Raises:
        QueryError: the clause names something that the domain does not have.
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
    """Return the normal form of a disjunction of conjunctions, for states that satisfy `goal`.

    It is empty if no state satisfies the disjunction, and consists of one empty conjunction if every state does.
    """
    normal = _weakest(conjunctions, goal, facts, invariant_graph(facts))
    return conjunctions if normal is None else normal


def shared(conjunctions: Sequence[Conjunction], facts: Facts) -> Conjunction:
    """Return the values that each of the given conjunctions entails."""
    graph = invariant_graph(facts)
    names = {str(fluent): fluent for fluent in facts.fluents}
    closed = [
        {*entailed(((names[fluent], value) for fluent, value in conjunction.items()), graph)}
        for conjunction in conjunctions
    ]
    return {str(fluent): value for fluent, value in sorted(set.intersection(*closed))} if closed else {}


def known_where(conjunctions: Sequence[Conjunction], given: Assignment, facts: Facts) -> Sequence[Conjunction]:
    """Return the normal form of "some conjunction is known to hold" for states with the `given` values.

    Fluents that cannot hold are known to be false.

    Raises:
        QueryError: there are too many conjunctions.
    """
    normal = _weakest(conjunctions, given, facts, invariant_graph(facts, impossible=True))
    if normal is None:
        raise QueryError(f"'achieves' has more than {MOST_TERMS} cases; ask for fewer things at once")
    return normal


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
            may_fail = {value for value in term if not conflict(entailed([(value[0], not value[1])], graph))}
            terms.append(frozenset(value for value in may_fail if value not in sure))
    fluents = {fluent for term in terms for fluent, _ in term}
    violated: set[Values] = set()  # the pairs of values that violate an invariant
    for value in ((fluent, truth) for fluent in sorted(fluents) for truth in (True, False)):
        for fluent, truth in entailed([value], graph):
            if fluent in fluents and fluent != value[0]:
                violated.add(frozenset([value, (fluent, not truth)]))
    implicants = _prime_implicants([*terms, *violated])
    if implicants is None:
        return None
    possible = (implicant for implicant in implicants if _holds_in_some_state(implicant, sure, graph))
    closed = {frozenset(entailed(implicant, graph)) - set(sure) for implicant in possible}
    least = []
    for term in _absorbed(closed):  # without values that another value entails, unless the two are equivalent
        below = {value: entailed([value], graph) for value in term}
        least.append([v for v in term if not any(v in below[w] and w not in below[v] for w in term)])
    return sorted(({str(fluent): value for fluent, value in sorted(term)} for term in least), key=str)


def _holds_in_some_state(term: Values, sure: Mapping[FluentValue, FluentValue], graph: Graph) -> bool:
    return not conflict(entailed((*term, *sure), graph))


def _prime_implicants(terms: Iterable[Values]) -> set[Values] | None:
    """Return the prime implicants of a disjunction of terms, or None if there are too many.

    Each fluent is resolved once (Tison 1967).
    """
    implicants = set(terms)
    for fluent in sorted({fluent for term in implicants for fluent, _ in term}):
        if len(implicants) > MOST_TERMS:
            return None
        with_it, against = ([term for term in implicants if (fluent, value) in term] for value in (True, False))
        both = ((one - {(fluent, True)}) | (other - {(fluent, False)}) for one in with_it for other in against)
        implicants = _absorbed(implicants | {term for term in both if len({name for name, _ in term}) == len(term)})
    return implicants


def _absorbed(terms: set[Values]) -> set[Values]:
    return {term for term in terms if not any(other < term for other in terms)}
