"""The shifting of disjunctions in head-cycle-free programs: no two head atoms depend positively on each other.

Each rule ``a ; b :- B`` may be replaced by ``a :- B, not b`` and ``b :- B, not a`` without changing the answer sets
(Ben-Eliyahu and Dechter 1994).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import count

from prag_asp.logic.ground.rules import Rule
from prag_asp.program.finite.components import components


def is_head_cycle_free(rules: Sequence[Rule]) -> bool:
    """Return whether no disjunctive head has two atoms in the same component of the positive dependency graph."""
    graph: dict[int, set[int]] = {}
    for rule in rules:
        for head in rule.heads:
            graph.setdefault(head, set()).update(literal for literal in rule.body if literal > 0)
    number: dict[int, int] = {}
    for place, component in enumerate(components(graph, lambda atom: graph.get(atom, ()))):
        number.update(dict.fromkeys(component, place))
    return all(len({number[head] for head in rule.heads}) == len(rule.heads) for rule in rules if rule.is_disjunctive)


def shift_disjunctions(rules: Iterable[Rule]) -> list[Rule]:
    """Return the rules of a head-cycle-free program without disjunctions."""
    rules = list(rules)
    used = (abs(atom) for rule in rules for atom in (*rule.heads, *rule.body))
    fresh = count(max(used, default=0) + 1)
    shifted: list[Rule] = []
    for rule in rules:
        if not rule.is_disjunctive:
            shifted.append(rule)
            continue
        body = rule.body
        if rule.weights:  # a fresh atom replaces a weighted body
            body = (next(fresh),)
            shifted.append(Rule(body, rule.body, bound=rule.bound, weights=rule.weights))
        shifted += [Rule((head,), (*body, *(-other for other in rule.heads if other != head))) for head in rule.heads]
    return shifted
