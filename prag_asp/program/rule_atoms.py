"""The atoms of a rule, as clingo parses it."""

from __future__ import annotations

from collections.abc import Iterator

from clingo.ast import AST, ASTType

Signature = tuple[str, int]

NOW, BEFORE = "t", "(t-1)"
"""How the times of a step are written."""


def children_of(node: AST) -> Iterator[AST]:
    """Yield the nodes right below a node."""
    for key in node.child_keys:
        child = getattr(node, key)
        if isinstance(child, AST):
            yield child
        elif child is not None:
            yield from child


def atoms_in(node: AST) -> Iterator[AST]:
    """Yield the functions that stand as atoms, each one of a pool."""
    if node.ast_type == ASTType.SymbolicAtom:
        yield from _functions(node.symbol)
    else:
        for child in children_of(node):
            yield from atoms_in(child)


def _functions(symbol: AST) -> Iterator[AST]:
    kind = symbol.ast_type
    if kind == ASTType.Pool:
        for each in symbol.arguments:
            yield from _functions(each)
    elif kind == ASTType.UnaryOperation:
        yield from _functions(symbol.argument)
    elif kind == ASTType.Function:
        yield symbol


def heads_of(head: AST) -> Iterator[AST]:
    """Yield the atoms that a head derives, without the conditions that they stand under."""
    if head.ast_type == ASTType.ConditionalLiteral:
        yield from atoms_in(head.literal)
    elif head.ast_type in (ASTType.Aggregate, ASTType.Disjunction):
        for element in head.elements:
            yield from heads_of(element)
    else:
        yield from atoms_in(head)


def variables_in(node: AST) -> Iterator[str]:
    """Yield the names of the variables in a node."""
    if node.ast_type == ASTType.Variable:
        yield node.name
    for child in children_of(node):
        yield from variables_in(child)


def signature_of(atom: AST) -> Signature:
    """Return the name and the number of arguments of an atom."""
    return atom.name, len(atom.arguments)
