"""Ground rules as clauses with exactly one model for each answer set.

*Without positive loops.* An atom is true if the body of one of its rules is true (Clark 1978); an atom that a choice
allows may then be false as well. If no atom depends positively on itself, the models of this completion are the answer
sets (Fages 1994; Erdem and Lifschitz 2003 for rules with sums). Every auxiliary variable is the output of a gate, a
function of the atoms, so each answer set is one model.

*With positive loops.* M is an answer set if it is the least model of its reduct: the limit of the stages S_0 = {} and
S_k = { a : the reduct has a rule for a with its body in S_(k-1) }. For each strongly connected component C of the
positive dependency graph with m atoms, gates compute from M only the stages of C, up to the m-th: negated literals and
atoms outside of C have their value in M, atoms of C have their value in the previous stage, and a choice counts as a
rule for its atoms in M (Simons, Niemelä and Soininen 2002). The stages only grow, and each stage before the limit adds
an atom, so S_m is the limit. A clause for each atom of C states that it is in S_m if it is in M.

Together, these clauses express stability. The stages of an answer set reach all of its atoms. Conversely, let M satisfy
the completion, and let U be the set of its atoms that are not in the least model of its reduct. Take a component C that
intersects U and depends on no other component that does. Any body that is true in M, of a rule for an atom in both U
and C, needs an atom of U, and this atom is in C. Therefore no stage of C reaches an atom of U, which contradicts the
clauses. (Lee and Lifschitz 2003 split by loops in the same way.)

The stages are functions of M, so again each answer set is one model. The stage at which an atom appears is its level in
the strong level ranking of M, which Janhunen (2004, 2006) shows to be unique; he encodes levels in binary, which is
smaller for large components but propagates less.

*With copies.* Counting by cases needs less (Kabir, Chakraborty and Meel 2024): each atom of a component has a copy that
implies the atom. The copy of a true atom follows if one of its rules has a true body, with copies in place of the
component's atoms. Unit propagation then makes the copies of all atoms of an answer set true, and leaves some copies
open if an atom is true without support. There are thus more models than answer sets, but the models without open copies
are the answer sets.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import partial

from prag_asp.logic.formula.clause_builder import TRUE, ClauseBuilder, Literal
from prag_asp.logic.ground.rules import Rule
from prag_asp.program.finite.components import components


@dataclass(frozen=True)
class Completion:
    """Clauses whose models are answer sets, and the literal of each atom.

    `loops` are the components of atoms that depend positively on themselves, each atom with its rules. With copies,
    `copies` maps the variable of each copy to the literal of its atom, and the variables of gates over copies to TRUE.
    """

    clauses: ClauseBuilder
    values: Mapping[int, Literal]
    loops: tuple[Mapping[int, tuple[Rule, ...]], ...] = ()
    copies: Mapping[int, Literal] = field(default_factory=dict)

    def value(self, literal: int) -> Literal:
        """Return the literal of an atom or its negation; an atom that no rule derives is false."""
        return _value(self.values, literal)


def complete(rules: Iterable[Rule], *, copied: bool = False, sums_apart: bool = False) -> Completion:
    """Return the clauses of a ground program without disjunctions; with `copied`, positive loops have copies.

    With `sums_apart`, no clauses define the sums (see `ClauseBuilder`).
    """
    clauses = ClauseBuilder(sums_apart=sums_apart)
    rules_of: dict[int, list[Rule]] = {}
    constraints: list[Rule] = []
    for rule in dict.fromkeys(rules):
        if not rule.heads:
            constraints.append(rule)
        for head in rule.heads:
            rules_of.setdefault(head, []).append(rule)
    values: dict[int, Literal] = {}
    for atom, own in rules_of.items():
        is_fact = any(not (rule.choice or rule.body) for rule in own)
        values[atom] = TRUE if is_fact else clauses.fresh()
    open_rules = {atom: own for atom, own in rules_of.items() if values[atom] != TRUE}

    value = partial(_value, values)
    for atom, own in open_rules.items():
        _support(clauses, values[atom], own, value)
    for rule in constraints:
        if rule.weights:
            clauses.add(-body_literal(clauses, rule, value))
        else:
            clauses.add(*(-value(literal) for literal in rule.body))
    loops: list[Mapping[int, tuple[Rule, ...]]] = []
    graph = {atom: [below for rule in own for below in rule.body if below > 0] for atom, own in open_rules.items()}
    for component in components(graph, lambda atom: (below for below in graph[atom] if below in graph)):
        if len(component) > 1 or any(component[0] in rule.body for rule in open_rules[component[0]]):
            loops.append({atom: tuple(open_rules[atom]) for atom in sorted(component)})
    before = clauses.variables
    copies: dict[int, Literal] = {}
    for loop in loops:
        copies |= (_by_copies if copied else _by_stages)(clauses, loop, value)
    gates = range(before + 1, clauses.variables + 1) if copied else ()
    return Completion(clauses, values, tuple(loops), {**dict.fromkeys(gates, TRUE), **copies})


def _value(values: Mapping[int, Literal], literal: int) -> Literal:
    value = values.get(abs(literal), -TRUE)
    return value if literal > 0 else -value


def body_literal(clauses: ClauseBuilder, rule: Rule, value: Callable[[int], Literal]) -> Literal:
    """Return a literal that is equivalent to the body of a rule, given the values of its literals."""
    literals = list(map(value, rule.body))
    return clauses.at_least(rule.bound, literals, rule.weights) if rule.weights else clauses.all_of(literals)


def _support(clauses: ClauseBuilder, atom: Literal, rules: list[Rule], value: Callable[[int], Literal]) -> None:
    """Add clauses by which an atom is true if a rule derives it, and only if a rule derives or allows it."""
    if all(not rule.choice for rule in rules):
        if len(rules) == 1 and not rules[0].weights:
            clauses.all_of(map(value, rules[0].body), into=atom)
        else:
            clauses.any_of([body_literal(clauses, rule, value) for rule in rules], into=atom)
        return
    bodies = [(rule.choice, body_literal(clauses, rule, value)) for rule in rules]
    clauses.add(-atom, *(body for _, body in bodies))
    for choice, body in bodies:
        if not choice:
            clauses.add(atom, -body)


def _by_copies(
    clauses: ClauseBuilder, loop: Mapping[int, tuple[Rule, ...]], value: Callable[[int], Literal]
) -> dict[int, Literal]:
    """Add copies of a component's atoms, derived by its rules; return each copy with the literal of its atom."""
    copies = {atom: clauses.fresh() for atom in loop}

    def of_copies(literal: int) -> Literal:
        return copies[literal] if literal in copies else value(literal)

    for atom, rules in loop.items():
        clauses.add(-copies[atom], value(atom))
        for rule in rules:
            chosen = [-value(atom)] if rule.choice else []
            if rule.weights:
                clauses.add(copies[atom], *chosen, -body_literal(clauses, rule, of_copies))
            else:
                clauses.add(copies[atom], *chosen, *(-of_copies(literal) for literal in rule.body))
    return {copy: value(atom) for atom, copy in copies.items()}


def _by_stages(
    clauses: ClauseBuilder, loop: Mapping[int, tuple[Rule, ...]], value: Callable[[int], Literal]
) -> dict[int, Literal]:
    """Add clauses by which each true atom of a component is derived at some stage; return no copies."""
    stage = dict.fromkeys(loop, -TRUE)

    def at_stage(literal: int) -> Literal:
        return stage[literal] if literal in stage else value(literal)

    for _ in loop:
        derived = {}
        for atom in stage:
            ways = []
            for rule in loop[atom]:
                body = body_literal(clauses, rule, at_stage)
                ways.append(clauses.all_of((body, value(atom))) if rule.choice else body)
            derived[atom] = clauses.any_of(ways)
        if derived == stage:
            break
        stage = derived
    for atom, literal in stage.items():
        clauses.add(-value(atom), literal)
    return {}
