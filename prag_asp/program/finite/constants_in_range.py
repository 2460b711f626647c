"""A check of the arithmetic of constants, which clingo computes when it reads a program, before any rule."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import clingo
from clingo.ast import AST, ASTType, parse_string

from prag_asp.program.finite.arithmetic import OPERATIONS, OutOfRange, Undefined, compute, read_expression
from prag_asp.program.finite.checks import Site, out_of_range
from prag_asp.program.syntax import Statement, children_of

Values = Mapping[str, clingo.Symbol]
"""The numeric values of constants, by name."""


def require_constants_in_range(statements: Iterable[Statement]) -> None:
    """Evaluate the values of all ``#const`` statements.

    Raises:
        BoundReached: a value or an intermediate result is out of range.
    """
    waiting = [statement for statement in statements if statement.kind == ASTType.Definition]
    values: dict[str, clingo.Symbol] = {}
    found = True
    while found and waiting:
        found = False
        for statement in tuple(waiting):
            term = statement.node.value
            wrong = operation_out_of_range(term, values)
            if wrong is not None:
                raise Site(statement.path, statement.line, wrong).error(out_of_range(wrong))
            try:
                number = compute(read_expression(term), values)
            except Undefined:
                continue  # it needs a constant that comes later, or is not a number
            values.setdefault(statement.node.name, clingo.Number(number))
            waiting.remove(statement)
            found = True


def operation_out_of_range(term: AST, values: Values) -> str | None:
    """Return the text of the first operation in a term whose result is out of range, or None."""
    for operation in _operations(term):
        try:
            compute(read_expression(operation), values)
        except OutOfRange:
            text = str(operation)
            return text[1:-1] if operation.ast_type == ASTType.BinaryOperation else text
        except Undefined:
            continue
    return None


def term_of(text: str) -> AST:
    """Return the syntax tree of a term.

    Raises:
        RuntimeError: the text is not a term.
    """
    nodes: list[AST] = []
    parse_string(f"#const value = {text}.", nodes.append, logger=lambda *_: None)
    if [node.ast_type for node in nodes[1:]] != [ASTType.Definition]:
        raise RuntimeError(text)
    term: AST = nodes[-1].value
    return term


def _operations(term: AST) -> Iterator[AST]:
    """Yield the outermost operations in a term."""
    if term.ast_type in OPERATIONS:
        yield term
    else:
        for child in children_of(term):
            yield from _operations(child)
