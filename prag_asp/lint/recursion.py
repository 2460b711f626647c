"""Rules that make ever larger terms, so that grounding would never end."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

from prag_asp.program.problem import Problem
from prag_asp.program.syntax import VARIABLE, AtomNode, Signature, Statement, plain_atom, variables

LARGER = re.compile(r"[a-z]\w*\(|\([A-Z]\w*[+-]\d+\)$|\(\d+\+[A-Z]\w*\)$")
"""The terms that are larger than a variable in them: functions, and sums as clingo writes them."""


def recursion_problems(statements: Sequence[Statement]) -> Iterator[Problem]:
    """Yield the own rules that derive a larger atom from atoms that depend on it, and from nothing else."""
    rules = [each for each in statements if each.is_rule]
    reads: dict[Signature, set[Signature]] = {}
    for rule in rules:
        for head in rule.heads:
            reads.setdefault(head.signature, set()).update(atom.signature for atom in rule.body)
    for rule in rules:
        if rule.own and rule.node.body and _grows(rule, reads):
            yield rule.problem(
                f"this rule makes ever larger terms of {rule.heads[0].name} and never ends; "
                "bound it by a condition such as N < 10"
            )


def _grows(rule: Statement, reads: Mapping[Signature, set[Signature]]) -> bool:
    """Return whether a head puts a variable of the body deeper, where the body is made of that head."""
    if any(atom is None or atom.negated for atom in (plain_atom(*literal) for literal in rule.literals)):
        return False
    plain = {argument for atom in rule.body for argument in atom.arguments if VARIABLE.fullmatch(argument)}
    for head in rule.heads:
        deep = {name for argument in head.arguments if LARGER.match(argument) for name in variables(argument)}
        if deep & plain and _at_one_time(rule, head):
            made_of = [_reachable(atom.signature, reads) | {atom.signature} for atom in rule.body]
            return all(head.signature in each for each in made_of)
    return False


def _at_one_time(rule: Statement, head: AtomNode) -> bool:
    """Return whether a rule derives its head from atoms of the same step: over the steps, terms may grow."""
    return not rule.timed or all(atom.arguments[-1:] == head.arguments[-1:] for atom in rule.body)


def _reachable(start: Signature, reads: Mapping[Signature, set[Signature]]) -> set[Signature]:
    """Return the predicates that a predicate depends on."""
    found: set[Signature] = set()
    stack = [start]
    while stack:
        for signature in reads.get(stack.pop(), ()):
            if signature not in found:
                found.add(signature)
                stack.append(signature)
    return found
