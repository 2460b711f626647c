"""The statements of a logic program, with the atoms of their heads and bodies picked out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import clingo
from clingo.ast import AST, ASTType

from prag_asp.domain.lint.problem import Problem, Signature

TIMED_PARTS = ("step", "check")


@dataclass(frozen=True)
class Atom:
    """An atom of a rule: its predicate (with a leading ``-`` where strongly negated), its arguments, its line."""

    name: str
    arguments: tuple[AST, ...]
    line: int
    negated: bool

    @property
    def signature(self) -> Signature:
        """The name and the number of arguments."""
        return self.name, len(self.arguments)

    def __str__(self) -> str:
        return f"{self.name}({','.join(map(str, self.arguments))})" if self.arguments else self.name


@dataclass(frozen=True)
class Statement:
    """One statement of a source, in its program part.

    `own` tells the domain's files from the encodings, `parameters` are those of the part; `body` holds the atoms
    of conditions as well.
    """

    node: AST
    path: Path
    line: int
    own: bool
    part: str
    parameters: tuple[str, ...]
    heads: tuple[Atom, ...] = ()
    body: tuple[Atom, ...] = ()

    @property
    def kind(self) -> ASTType:
        """The type of the statement in clingo's syntax tree."""
        return self.node.ast_type

    @property
    def timed(self) -> bool:
        """Whether the statement belongs to a step or to the check after the last step."""
        return self.part in TIMED_PARTS

    @property
    def is_rule(self) -> bool:
        """Whether the statement is a rule, a fact or a constraint."""
        return self.node.ast_type == ASTType.Rule

    def problem(self, text: str, line: int | None = None) -> Problem:
        """Return a problem of this statement."""
        return Problem(self.path, self.line if line is None else line, text)


def read_statement(node: AST, path: Path, own: bool, part: str, parameters: tuple[str, ...]) -> Statement:
    """Return a statement of clingo's syntax tree with its atoms."""
    line = node.location.begin.line
    if node.ast_type != ASTType.Rule:
        body = tuple(atoms([*getattr(node, "body", ())]))
        return Statement(node, path, line, own, part, parameters, (), body)
    heads, conditions = _split_head(node.head)
    return Statement(
        node, path, line, own, part, parameters, tuple(atoms(heads)), tuple(atoms([*conditions, *node.body]))
    )


def _split_head(head: AST) -> tuple[list[AST], list[AST]]:
    """Return the literals that a head derives and those that it derives them under."""
    if head.ast_type in (ASTType.Aggregate, ASTType.Disjunction):
        elements = list(head.elements)
    elif head.ast_type == ASTType.HeadAggregate:
        elements = [element.condition for element in head.elements]
    else:
        return [head], []
    return [each.literal for each in elements], [literal for each in elements for literal in each.condition]


def atoms(nodes: Iterable[AST]) -> Iterator[Atom]:
    """Yield the atoms below some nodes of a syntax tree, in the order of the text."""
    stack = [(node, False) for node in reversed(list(nodes))]
    while stack:
        node, negated = stack.pop()
        if node.ast_type == ASTType.SymbolicAtom:
            yield from _symbolic_atoms(node.symbol, negated)
        else:
            inner = bool(node.sign) if node.ast_type == ASTType.Literal else negated
            stack += [(child, inner) for child in reversed(children(node))]


def _symbolic_atoms(symbol: AST, negated: bool, prefix: str = "") -> Iterator[Atom]:
    if symbol.ast_type == ASTType.Pool:
        for each in symbol.arguments:
            yield from _symbolic_atoms(each, negated, prefix)
    elif symbol.ast_type == ASTType.UnaryOperation:
        yield from _symbolic_atoms(symbol.argument, negated, "" if prefix else "-")
    elif symbol.ast_type == ASTType.Function:
        yield Atom(prefix + symbol.name, tuple(symbol.arguments), symbol.location.begin.line, negated)


def children(node: AST) -> list[AST]:
    """Return the nodes right below a node of a syntax tree."""
    found: list[AST] = []
    for key in node.child_keys:
        child = getattr(node, key)
        if isinstance(child, AST):
            found.append(child)
        elif child is not None:
            found += child
    return found


def below(nodes: Iterable[AST]) -> Iterator[AST]:
    """Yield some nodes of a syntax tree and all that is below them, in the order of the text."""
    stack = list(nodes)[::-1]
    while stack:
        node = stack.pop()
        yield node
        stack += children(node)[::-1]


def names(nodes: Iterable[AST]) -> Iterator[tuple[str, int]]:
    """Yield the names of the functions and constants below some nodes, each with its line."""
    for node in below(nodes):
        if node.ast_type == ASTType.Function and node.name:
            yield node.name, node.location.begin.line
        elif node.ast_type == ASTType.SymbolicTerm and node.symbol.type == clingo.SymbolType.Function:
            yield node.symbol.name, node.location.begin.line


def variables(nodes: Iterable[AST]) -> set[str]:
    """Return the names of the variables below some nodes, without the anonymous one."""
    return {node.name for node in below(nodes) if node.ast_type == ASTType.Variable} - {"_"}


def constant(node: AST) -> str | None:
    """Return the name that a node is, where it is a constant."""
    if node.ast_type == ASTType.SymbolicTerm and node.symbol.type == clingo.SymbolType.Function:
        return str(node.symbol) if not node.symbol.arguments else None
    return None
