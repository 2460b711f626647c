"""Rules that may carry ever new values from step to step: counters that nothing bounds."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from clingo.ast import AST, ASTType, ComparisonOperator, Sign, parse_string

from prag_asp.program.rule_atoms import Signature, atoms_in, children_of, heads_of, signature_of, variables_in
from prag_asp.program.sources import Program

FINITE = {("occurs", 2), ("holds", 3)}
"""Timed predicates that take no values but those that the domain declares."""

MADE = (ASTType.BinaryOperation, ASTType.UnaryOperation, ASTType.Function)
"""Terms that make a new value from others."""


def growing_heads(rule: AST, timed: Collection[Signature]) -> Iterator[Signature]:
    """Yield the heads of a rule that make new values of carried ones, with nothing in the body to bound them.

    What bounds a variable is a comparison other than !=, or an atom that takes its values from what does not change.
    """
    made = [
        (signature_of(atom), {name for argument in atom.arguments[:-1] for name in _made_of(argument)})
        for atom in heads_of(rule.head)
    ]
    if not any(names for _, names in made):
        return
    bounded: set[str] = set()
    for literal in rule.body:
        if literal.ast_type != ASTType.Literal or literal.sign != Sign.NoSign:
            continue
        if literal.atom.ast_type == ASTType.Comparison:
            if all(guard.comparison != ComparisonOperator.NotEqual for guard in literal.atom.guards):
                bounded.update(variables_in(literal.atom))
        elif any(signature_of(atom) in FINITE or signature_of(atom) not in timed for atom in atoms_in(literal.atom)):
            bounded.update(variables_in(literal.atom))
    yield from (head for head, names in made if not bounded.issuperset(names))


def _made_of(term: AST) -> Iterator[str]:
    """Yield the variables of which a term makes a new value."""
    if term.ast_type in MADE:
        yield from variables_in(term)
    else:
        for child in children_of(term):
            yield from _made_of(child)


def locate_head(program: Program, signature: Signature) -> str:
    """Return the file and the line of a rule of a step that derives a predicate, best of one that makes new values."""
    found: list[tuple[bool, int]] = []
    part = "base"

    def collect(statement: AST) -> None:
        nonlocal part
        if statement.ast_type == ASTType.Program:
            part = statement.name
        elif statement.ast_type == ASTType.Rule and part == "step":
            heads = list(heads_of(statement.head))
            if any(signature_of(head) == signature for head in heads):
                made = any(True for head in heads for argument in head.arguments[:-1] for _ in _made_of(argument))
                found.append((not made, statement.location.begin.line))

    parse_string(program.text, collect)
    path, line = program.locate(min(found)[1])
    return f"{path}:{line}"
