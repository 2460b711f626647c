"""Rules that make ever larger terms, so that grounding would never end."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from clingo.ast import AST, ASTType, BinaryOperator, Sign

from prag_asp.domain.lint.problem import Problem, Signature
from prag_asp.domain.lint.statement import Statement, variables


def recursion_problems(statements: Sequence[Statement]) -> Iterator[Problem]:
    """Yield the own rules that derive a larger atom from atoms that depend on it, and from nothing that ends it."""
    rules = [each for each in statements if each.is_rule and not each.timed]
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
    """Return whether a head puts a variable deeper than all of the body does, where the body is made of that head."""
    for head in rule.heads:
        deep = variables(each for each in head.arguments if _is_larger(each))
        plain = {str(each) for atom in rule.body for each in atom.arguments if each.ast_type == ASTType.Variable}
        if deep & plain and all(_is_positive_atom(node) for node in rule.node.body):
            made_of = [_reachable(atom.signature, reads) | {atom.signature} for atom in rule.body]
            return all(head.signature in each for each in made_of)
    return False


def _is_larger(term: AST) -> bool:
    if term.ast_type == ASTType.BinaryOperation:
        return term.operator_type in (BinaryOperator.Plus, BinaryOperator.Minus)
    return term.ast_type == ASTType.Function


def _is_positive_atom(node: AST) -> bool:
    return (
        node.ast_type == ASTType.Literal
        and node.sign == Sign.NoSign
        and node.atom.ast_type == ASTType.SymbolicAtom
    )


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
