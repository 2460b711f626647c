"""A search for rules that may derive new values at every step without end, such as unbounded counters."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator

from clingo.ast import AST, ASTType, Sign, parse_string

from prag_asp.program.predicates import HOLDS, OCCURS
from prag_asp.program.sources import Program
from prag_asp.program.syntax import VARIABLE, AtomNode, Signature, atoms, children_of, head_atoms, variables

FINITE = {OCCURS, HOLDS}
"""Timed predicates that take only the values that the domain declares."""

MADE = (ASTType.BinaryOperation, ASTType.UnaryOperation, ASTType.Function)
"""The kinds of terms that build new values."""


def growing_heads(
    heads: Iterable[AtomNode], body: Iterable[tuple[AST, str]], timed: Collection[Signature]
) -> Iterator[Signature]:
    """Yield the heads of a rule that build new values from carried values that no literal of the body bounds.

    Each literal of the body is given with its text. A second literal that reads a variable may bound it.
    """
    made_of = [(head.signature, _made_of(head)) for head in heads]
    if not any(names for _, names in made_of):
        return
    unbounded = set(timed) - FINITE
    carried: set[str] = set()
    bounded: set[str] = set()
    for literal, text in body:
        read = variables(text)
        plain = literal.ast_type == ASTType.Literal and literal.sign == Sign.NoSign
        symbolic = plain and literal.atom.ast_type == ASTType.SymbolicAtom
        if symbolic and all(atom.signature in unbounded for atom in atoms(literal, text)):
            bounded |= read & carried
            carried |= read
        else:
            bounded |= read
    yield from (head for head, names in made_of if not bounded.issuperset(names))


def _made_of(head: AtomNode) -> set[str]:
    """Return the variables from which an atom builds a new value."""
    if all(VARIABLE.fullmatch(argument) for argument in head.arguments[:-1]):
        return set()
    names: set[str] = set()
    waiting = list(head.terms[:-1])
    while waiting:
        term = waiting.pop()
        if term.ast_type in MADE:
            names |= variables(str(term))
        else:
            waiting += children_of(term)
    return names


def locate_head(program: Program, signature: Signature) -> str:
    """Return the file and line of a rule of a step that derives a predicate, preferably one that builds new values."""
    lines: list[tuple[bool, int]] = []
    part = "base"

    def collect(statement: AST) -> None:
        nonlocal part
        if statement.ast_type == ASTType.Program:
            part = statement.name
        elif statement.ast_type == ASTType.Rule and part == "step":
            heads, _ = head_atoms(statement.head)
            if any(head.signature == signature for head in heads):
                lines.append((not any(map(_made_of, heads)), statement.location.begin.line))

    parse_string(program.text, collect)
    path, line = program.locate(min(lines)[1])
    return f"{path}:{line}"
