"""Rules that may carry ever new values from step to step: counters that nothing bounds."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator

from clingo.ast import AST, ASTType, ComparisonOperator, Sign, parse_string

from prag_asp.program.sources import Program
from prag_asp.program.syntax import VARIABLE, AtomNode, Signature, atoms, children_of, head_atoms, variables

FINITE = {("occurs", 2), ("holds", 3)}
"""Timed predicates that take no values but those that the domain declares."""

MADE = (ASTType.BinaryOperation, ASTType.UnaryOperation, ASTType.Function)
"""Terms that make a new value from others."""


def growing_heads(
    heads: Iterable[AtomNode], body: Iterable[tuple[AST, str]], timed: Collection[Signature]
) -> Iterator[Signature]:
    """Yield the heads of a rule that make new values of carried ones, with nothing in the body to bound them.

    The literals of the body come with their texts. What bounds a variable is a comparison other than !=, or an atom
    that takes its values from what does not change.
    """
    made = [(head.signature, _made_of(head)) for head in heads]
    if not any(names for _, names in made):
        return
    bounded: set[str] = set()
    for literal, text in body:
        if literal.ast_type != ASTType.Literal or literal.sign != Sign.NoSign:
            continue
        if literal.atom.ast_type == ASTType.Comparison:
            if all(guard.comparison != ComparisonOperator.NotEqual for guard in literal.atom.guards):
                bounded |= variables(text)
        elif any(atom.signature in FINITE or atom.signature not in timed for atom in atoms(literal, text)):
            bounded |= variables(text)
    yield from (head for head, names in made if not bounded.issuperset(names))


def _made_of(head: AtomNode) -> set[str]:
    """Return the variables of which an atom makes a new value."""
    if all(VARIABLE.fullmatch(argument) for argument in head.arguments[:-1]):
        return set()
    found: set[str] = set()
    waiting = list(head.terms[:-1])
    while waiting:
        term = waiting.pop()
        if term.ast_type in MADE:
            found |= variables(str(term))
        else:
            waiting += children_of(term)
    return found


def locate_head(program: Program, signature: Signature) -> str:
    """Return the file and the line of a rule of a step that derives a predicate, best of one that makes new values."""
    found: list[tuple[bool, int]] = []
    part = "base"

    def collect(statement: AST) -> None:
        nonlocal part
        if statement.ast_type == ASTType.Program:
            part = statement.name
        elif statement.ast_type == ASTType.Rule and part == "step":
            heads, _ = head_atoms(statement.head)
            if any(head.signature == signature for head in heads):
                found.append((not any(map(_made_of, heads)), statement.location.begin.line))

    parse_string(program.text, collect)
    path, line = program.locate(min(found)[1])
    return f"{path}:{line}"
