"""Ground rules as clauses with exactly one model for each answer set.

*Without positive loops.* An atom is true where the body of one of its rules is (Clark 1978); an atom that a choice
allows may then be false as well. Where no atom depends positively on itself, the models of this completion are the
answer sets (Fages 1994; Erdem and Lifschitz 2003 for rules with sums). Every auxiliary variable is the output of a gate,
a function of the atoms, so each answer set is one model.

*With positive loops.* M is an answer set if it is the least model of its reduct, the limit of stages S_0 = {} and
S_k = { a : a rule for a of the reduct has its body in S_(k-1) }. The stages only grow, and the atoms of one strongly
connected component of the positive dependency graph reach each other through the component alone: given the atoms of M
that lie outside of it, a component of m atoms is complete after m stages, for each stage before adds one of them. So for
each component and k <= m a gate for each atom a computes from M whether a is in S_k: negated literals and atoms outside
of the component have their value in M, atoms of the component that of stage k - 1, and an atom that is chosen
counts if M has it (Simons, Niemelä and Soininen 2002). Together with the completion, the clause that an atom of M is in
S_m says that M is the limit, component by component, which is stability (Lee and Lifschitz 2003; Alviano and Dodaro 2016
use the same split). The stages are functions of M: again one model for each answer set. The stage at which an atom
appears is its level in the one *strong* level ranking of M, of which Janhunen (2004, 2006) shows that it is unique; he
writes it in binary, which is smaller for large components and propagates less.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from prag_asp.logic.clauses import TRUE, Clauses, Literal
from prag_asp.logic.components import components
from prag_asp.logic.ground import Rule


@dataclass(frozen=True)
class Completion:
    """Clauses whose models are answer sets, and the literal of each atom."""

    clauses: Clauses
    values: Mapping[int, Literal]


def complete(rules: Iterable[Rule]) -> Completion:
    """Return the clauses of a ground program without disjunctions."""
    clauses = Clauses()
    rules_of: dict[int, list[Rule]] = {}
    constraints: list[Rule] = []
    for rule in dict.fromkeys(rules):
        if not rule.heads:
            constraints.append(rule)
        for head in rule.heads:
            rules_of.setdefault(head, []).append(rule)
    values: dict[int, Literal] = {}
    for atom, own in rules_of.items():
        values[atom] = TRUE if any(_is_fact(rule) for rule in own) else clauses.fresh()
    open_rules = {atom: own for atom, own in rules_of.items() if values[atom] != TRUE}

    def value(literal: int) -> Literal:
        found = values.get(abs(literal), -TRUE)
        return found if literal > 0 else -found

    for atom, own in open_rules.items():
        _support(clauses, values[atom], own, value)
    for rule in constraints:
        if rule.weights:
            clauses.add(-_body(clauses, rule, value))
        else:
            clauses.add(*(-value(literal) for literal in rule.body))
    for component in components(_positive_graph(open_rules)):
        if len(component) > 1 or any(component[0] in rule.body for rule in open_rules[component[0]]):
            _found(clauses, component, open_rules, value)
    return Completion(clauses, values)


def _is_fact(rule: Rule) -> bool:
    return not rule.choice and not rule.body


def _body(clauses: Clauses, rule: Rule, value: Callable[[int], Literal]) -> Literal:
    literals = list(map(value, rule.body))
    return clauses.at_least(rule.bound, literals, rule.weights) if rule.weights else clauses.all_of(literals)


def _support(clauses: Clauses, atom: Literal, rules: list[Rule], value: Callable[[int], Literal]) -> None:
    """State that an atom is true where a rule derives it, and only where a rule derives or allows it."""
    if all(not rule.choice for rule in rules):
        if len(rules) == 1 and not rules[0].weights:
            clauses.all_of(map(value, rules[0].body), into=atom)
        else:
            clauses.any_of([_body(clauses, rule, value) for rule in rules], into=atom)
        return
    bodies = [(rule.choice, _body(clauses, rule, value)) for rule in rules]
    clauses.add(-atom, *(body for _, body in bodies))
    for choice, body in bodies:
        if not choice:
            clauses.add(atom, -body)


def _positive_graph(rules_of: Mapping[int, list[Rule]]) -> dict[int, list[int]]:
    return {atom: [below for rule in own for below in rule.body if below > 0] for atom, own in rules_of.items()}


def _found(
    clauses: Clauses, component: list[int], rules_of: Mapping[int, list[Rule]], value: Callable[[int], Literal]
) -> None:
    """State that each true atom of a component is derived at some stage."""
    stage = dict.fromkeys(sorted(component), -TRUE)

    def at_stage(literal: int) -> Literal:
        return stage[literal] if literal in stage else value(literal)

    for _ in component:
        derived = {}
        for atom in stage:
            ways = []
            for rule in rules_of[atom]:
                body = _body(clauses, rule, at_stage)
                ways.append(clauses.all_of((body, value(atom))) if rule.choice else body)
            derived[atom] = clauses.any_of(ways)
        if derived == stage:
            break
        stage = derived
    for atom, literal in stage.items():
        clauses.add(-value(atom), literal)
