"""Conditional literals in heads that clingo 5 grounds wrongly, because their conditions depend on the head.

A rule such as ``a : a :- b.`` with ``b :- a.`` derives its head while the instances of its condition are still unknown;
clingo drops them, and the program loses answer sets or gets wrong ones. The same happens if the body of a rule with
such a head has a conditional literal that depends on the head. Choices are not affected, nor are conditions that the
head does not depend on.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from clingo.ast import AST, ASTType

from prag_asp.program.finite.components import components
from prag_asp.program.problem import Problem
from prag_asp.program.syntax import AtomNode, Signature, Statement, atoms


def recursive_head_problems(statements: Sequence[Statement]) -> Iterator[Problem]:
    """Yield the rules with a conditional literal in the head whose conditions depend positively on the head."""
    suspects = [each for each in statements if each.is_rule and _has_conditional_head(each.node.head)]
    component = _component_numbers(statements) if suspects else {}
    for statement in suspects:
        heads = {component[atom.signature] for atom in statement.heads}
        read = [*statement.conditions, *_conditional_atoms(statement.node.body)]
        again = next((atom for atom in read if component.get(atom.signature) in heads and not atom.negated), None)
        if again is not None:
            yield statement.problem(
                f"a conditional literal in the head is not supported where a condition of the rule reads {again}, "
                "which depends on the head, because clingo grounds it wrongly; let conditions read only what does not "
                "depend on the head"
            )


def _has_conditional_head(head: AST) -> bool:
    return head.ast_type == ASTType.Disjunction and any(len(element.condition) for element in head.elements)


def _conditional_atoms(body: Sequence[AST]) -> Iterator[AtomNode]:
    """Yield the atoms in the conditional literals of a body."""
    for node in body:
        if node.ast_type == ASTType.ConditionalLiteral:
            yield from atoms(node, str(node))


def _component_numbers(statements: Sequence[Statement]) -> dict[Signature, int]:
    """Return the component of each predicate in the graph of positive dependencies of heads on bodies."""
    graph: dict[Signature, set[Signature]] = {}
    for statement in statements:
        read = {atom.signature for atom in statement.body if not atom.negated} if statement.is_rule else set()
        for atom in statement.heads:
            graph.setdefault(atom.signature, set()).update(read)
    found = components(graph, lambda predicate: graph.get(predicate, ()))
    return {predicate: number for number, component in enumerate(found) for predicate in component}
