"""Ground rules simplified by facts.

clingo leaves literals of facts in the rules of recursive predicates; which ones depends on its order of atoms.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence

from prag_asp.logic.ground.rules import Rule


def propagate_facts(rules: Sequence[Rule], facts: Iterable[int] = ()) -> tuple[list[Rule], set[int]]:
    """Return equivalent rules without facts in their bodies, and all facts, including the given `facts`."""
    derived = {*facts, *(rule.heads[0] for rule in rules if _states(rule))}
    spoken = derived | {-fact for fact in derived}
    if all(spoken.isdisjoint(rule.body) for rule in rules):
        return list(_without_facts(rules, derived)), derived
    remaining = list(rules)
    reading: dict[int, list[int]] = {}
    for number, rule in enumerate(rules):
        for literal in rule.body:
            reading.setdefault(abs(literal), []).append(number)
    waiting, gone = deque(derived), set[int]()
    while waiting:
        fact = waiting.popleft()
        for number in reading.get(fact, ()):
            rest = _after(remaining[number], fact) if number not in gone else None
            if rest is None:
                gone.add(number)
                continue
            remaining[number] = rest
            if _states(rest) and rest.heads[0] not in derived:
                derived.add(rest.heads[0])
                waiting.append(rest.heads[0])
    simplified = (rule for number, rule in enumerate(remaining) if number not in gone)
    return list(_without_facts(simplified, derived)), derived


def _states(rule: Rule) -> bool:
    """Return whether a rule is a fact."""
    return not rule.body and not rule.choice and len(rule.heads) == 1 and rule.bound <= 0


def _after(rule: Rule, fact: int) -> Rule | None:
    """Return a rule simplified by a fact, or None if its body is then false."""
    if not rule.weights:
        if -fact in rule.body:
            return None
        return Rule(rule.heads, tuple(literal for literal in rule.body if literal != fact), rule.choice)
    rest = [pair for pair in zip(rule.body, rule.weights, strict=True) if abs(pair[0]) != fact]
    bound = rule.bound - sum(weight for literal, weight in zip(rule.body, rule.weights, strict=True) if literal == fact)
    if bound <= 0:
        return Rule(rule.heads, (), rule.choice)
    if sum(weight for _, weight in rest) < bound:
        return None
    return Rule(rule.heads, tuple(each for each, _ in rest), rule.choice, bound, tuple(each for _, each in rest))


def _without_facts(rules: Iterable[Rule], facts: set[int]) -> Iterator[Rule]:
    """Yield the rules that do not derive known facts, and each known fact once."""
    stated = set[int]()
    for rule in rules:
        if len(rule.heads) != 1 or rule.choice or rule.heads[0] not in facts:
            yield rule
        elif _states(rule) and rule.heads[0] not in stated:
            stated.add(rule.heads[0])
            yield rule
