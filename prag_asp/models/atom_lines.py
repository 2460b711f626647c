"""Where a program states a ground atom."""

from __future__ import annotations

import clingo
from clingo.ast import AST, ASTType

from prag_asp.program.parse import parse_sources
from prag_asp.program.sources import Program
from prag_asp.program.syntax import AtomNode


def place_of(symbol: clingo.Symbol, program: Program) -> str:
    """Return the file and the line of a rule that may derive an atom, ``file:line: ``, best of one whose head fits it.

    Nothing is said where no head has its name and so many arguments.
    """
    statements, _ = parse_sources((source, True) for source in program.sources)
    signature = ("-" * symbol.negative + symbol.name, len(symbol.arguments))
    found = [
        (not _derives(head, symbol), place, f"{statement.path}:{statement.line}: ")
        for place, statement in enumerate(statements)
        for head in statement.heads
        if head.signature == signature
    ]
    return min(found)[2] if found else ""


def _derives(head: AtomNode, symbol: clingo.Symbol) -> bool:
    return all(map(_may_be, head.terms, symbol.arguments))


def _may_be(term: AST, symbol: clingo.Symbol) -> bool:
    """Return whether a term may stand for a ground one; what is computed may be anything."""
    if term.ast_type == ASTType.SymbolicTerm:
        return bool(term.symbol == symbol)
    if term.ast_type != ASTType.Function or term.external:
        return True
    if symbol.type != clingo.SymbolType.Function or symbol.name != term.name:
        return False
    return len(symbol.arguments) == len(term.arguments) and all(map(_may_be, term.arguments, symbol.arguments))
