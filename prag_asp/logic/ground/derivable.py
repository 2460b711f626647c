"""Test which predicates a step may derive, before it is ground."""

from __future__ import annotations

from collections.abc import Collection

import clingo

from prag_asp.program.parse import parse_sources
from prag_asp.program.sources import ADDED, Program, owned
from prag_asp.program.syntax import Signature, Statement, plain_atom


def may_derive(
    program: Program, atoms: clingo.SymbolicAtoms, open_before: Collection[Signature], heads: Collection[Signature]
) -> bool:
    """Return whether a step may derive an atom of the predicates `heads`.

    A rule derives nothing unless every predicate of its positive body has an atom: in the base part, whose `atoms` are
    ground, among the open atoms of step t-1, or by a rule of the step.
    """
    statements, _ = parse_sources(each for each in owned(program) if each[0].path != ADDED)
    waiting = [(each, _needed(each)) for each in statements if each.part == "step" and each.is_rule and each.heads]
    base = {signature for _, needed in waiting for signature in needed if any(atoms.by_signature(*signature))}
    there = base.union(open_before)
    while derived := [rule for rule, needed in waiting if needed <= there]:
        there.update(head.signature for rule in derived for head in rule.heads)
        waiting = [(rule, needed) for rule, needed in waiting if not needed <= there]
    return not there.isdisjoint(heads)


def _needed(rule: Statement) -> set[Signature]:
    """Return the predicates of the plain positive atoms of a body."""
    plain = (plain_atom(node, text) for node, text in rule.literals)
    return {each.signature for each in plain if each and not each.negated and not each.name.startswith("-")}
