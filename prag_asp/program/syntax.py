"""The statements of a logic program, with the atoms of their heads and bodies."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from clingo.ast import AST, ASTType

from prag_asp.atom import STRING
from prag_asp.program.problem import Problem

Signature = tuple[str, int]
"""The name and the number of arguments of a predicate or a term."""

TIMED_PARTS = ("step", "check")
NAME = re.compile(r"(?<![\w'@#])_*[a-z][\w']*")
VARIABLE = re.compile(r"(?<![\w'])_*[A-Z][\w']*")
PLAIN_ATOM = re.compile(r"(?P<sign>not not |not )?(?P<name>-?_*[a-z][\w']*)(?:\((?P<arguments>.*)\))?$", re.S)

PLAIN_FACT = re.compile(r"_*[a-z][\w']*(?:\((?:[(),]|(?:[0-9]+|_*[a-z][\w']*)(?![\w']))*\))?\.")
"""A fact without variables, pools, intervals, operations, strings, anonymous variables and negation."""


@dataclass(frozen=True)
class AtomNode:
    """An atom in a rule: its predicate, prefixed with ``-`` if it is strongly negated, and its arguments as text."""

    name: str
    arguments: tuple[str, ...]
    negated: bool
    node: AST

    @property
    def signature(self) -> Signature:
        """The name and the number of arguments."""
        return self.name, len(self.arguments)

    @property
    def line(self) -> int:
        """The line number in the file."""
        return int(self.node.location.begin.line)

    @property
    def terms(self) -> list[AST]:
        """The arguments as nodes of the syntax tree, which are slow to read from clingo."""
        node = self.node.atom.symbol if self.node.ast_type == ASTType.Literal else self.node
        function: AST = node.argument if node.ast_type == ASTType.UnaryOperation else node
        return list(function.arguments)

    def __str__(self) -> str:
        return f"{self.name}({','.join(self.arguments)})" if self.arguments else self.name


@dataclass(frozen=True, eq=False)
class Statement:
    """One statement of a source, in its program part; statements are compared by identity.

    `own` is true for files of the domain, and false for the encodings. `parameters` are the parameters of the program
    part.
    """

    node: AST
    kind: ASTType
    path: Path
    line: int
    own: bool
    part: str
    parameters: tuple[str, ...]

    @property
    def timed(self) -> bool:
        """Whether the statement belongs to a step or to the check after the last step."""
        return self.part in TIMED_PARTS

    @property
    def is_rule(self) -> bool:
        """Whether the statement is a rule, a fact or a constraint."""
        return self.kind == ASTType.Rule

    @cached_property
    def text(self) -> str:
        """The statement as clingo writes it."""
        return str(self.node)

    @cached_property
    def is_plain_fact(self) -> bool:
        """Whether the statement is a fact whose terms are written out; reading its text is fast."""
        return self.is_rule and PLAIN_FACT.fullmatch(self.text) is not None

    @cached_property
    def literals(self) -> tuple[tuple[AST, str], ...]:
        """The literals in the body, each with its text."""
        body = () if self.is_plain_fact else getattr(self.node, "body", ())
        return tuple((node, str(node)) for node in body)

    @cached_property
    def heads(self) -> tuple[AtomNode, ...]:
        """The atoms that a rule derives."""
        return tuple(self._head[0])

    @cached_property
    def body(self) -> tuple[AtomNode, ...]:
        """The atoms that the statement reads, including those in conditions."""
        return (*self._head[1], *(atom for node, text in self.literals for atom in atoms(node, text)))

    @property
    def conditions(self) -> tuple[AtomNode, ...]:
        """The atoms in the conditions in the head of a rule."""
        return tuple(self._head[1])

    @cached_property
    def _head(self) -> tuple[list[AtomNode], list[AtomNode]]:
        if self.is_plain_fact:
            atom = plain_atom(self.node.head, self.text[:-1])
            if atom is not None:
                return [atom], []
        return head_atoms(self.node.head) if self.is_rule else ([], [])

    @cached_property
    def scripts(self) -> tuple[str, ...]:
        """The names of the external functions that the statement calls, as in ``@name(X)``."""
        if "@" not in self.text:
            return ()
        return tuple(n.name for n in below(self.node) if n.ast_type == ASTType.Function and n.external)

    def problem(self, text: str, line: int | None = None, name: str = "") -> Problem:
        """Return a problem with this statement: an error, or a warning if a `name` is given."""
        return Problem(self.path, self.line if line is None else line, text, name)


def head_atoms(head: AST) -> tuple[list[AtomNode], list[AtomNode]]:
    """Return the atoms that the head of a rule derives, and the atoms in its conditions."""
    plain = plain_atom(head, str(head))
    if plain:
        return [plain], []
    if head.ast_type in (ASTType.Aggregate, ASTType.Disjunction):
        elements = list(head.elements)
    elif head.ast_type == ASTType.HeadAggregate:
        elements = [element.condition for element in head.elements]
    else:
        return list(atoms(head, str(head))), []
    conditions = [literal for each in elements for literal in each.condition]
    return (
        [atom for each in elements for atom in atoms(each.literal, str(each.literal))],
        [atom for node in conditions for atom in atoms(node, str(node))],
    )


def atoms(node: AST, text: str) -> Iterator[AtomNode]:
    """Yield the atoms in a literal, an aggregate or a condition; `text` is its text."""
    plain = plain_atom(node, text)
    if plain:
        yield plain
        return
    stack = [(node, False)]
    while stack:
        node, negated = stack.pop()
        if node.ast_type == ASTType.SymbolicAtom:
            yield from _symbolic_atoms(node.symbol, negated)
        else:
            inner = bool(node.sign) if node.ast_type == ASTType.Literal else negated
            stack += [(child, inner) for child in reversed(children_of(node))]


def plain_atom(node: AST, text: str) -> AtomNode | None:
    """Return the atom of a plain literal, parsed quickly from its text; None for other literals, strings and pools."""
    match = PLAIN_ATOM.match(text)
    if not match or '"' in text or ";" in text:
        return None
    arguments = split_arguments(match["arguments"]) if match["arguments"] is not None else []
    if arguments is None:
        return None
    return AtomNode(match["name"], tuple(arguments), bool(match["sign"]), node)


def split_arguments(text: str) -> list[str] | None:
    """Return the comma-separated arguments in a text, or None if its parentheses do not match."""
    if "(" not in text and ")" not in text:
        return text.split(",")
    arguments, depth, start = [], 0, 0
    for separator in re.finditer(r"[(),]", text):
        if separator[0] == ",":
            if depth == 0:
                arguments.append(text[start : separator.start()])
                start = separator.end()
        else:
            depth += 1 if separator[0] == "(" else -1
            if depth < 0:
                return None
    return [*arguments, text[start:]] if depth == 0 else None


def _symbolic_atoms(symbol: AST, negated: bool, prefix: str = "") -> Iterator[AtomNode]:
    if symbol.ast_type == ASTType.Pool:
        for each in symbol.arguments:
            yield from _symbolic_atoms(each, negated, prefix)
    elif symbol.ast_type == ASTType.UnaryOperation:
        yield from _symbolic_atoms(symbol.argument, negated, "" if prefix else "-")
    elif symbol.ast_type == ASTType.Function:
        yield AtomNode(prefix + symbol.name, tuple(map(str, symbol.arguments)), negated, symbol)


def children_of(node: AST) -> list[AST]:
    """Return the child nodes of a node in a syntax tree."""
    children: list[AST] = []
    for key in node.child_keys:
        child = getattr(node, key)
        if isinstance(child, AST):
            children.append(child)
        elif child is not None:
            children += child
    return children


def below(node: AST) -> Iterator[AST]:
    """Yield a node in a syntax tree and all its descendants."""
    stack = [node]
    while stack:
        node = stack.pop()
        yield node
        stack += children_of(node)


def runs_no_code(name: str) -> str:
    """Return the message that refuses a statement because it calls an external function."""
    return f"@{name} calls a script: a domain runs no code; write plain rules"


def spelled(signature: Signature) -> str:
    """Return a signature in clingo's notation, such as ``holds/3``."""
    return f"{signature[0]}/{signature[1]}"


def names(texts: Iterable[str]) -> set[str]:
    """Return the names of the functions and constants in texts, outside of strings."""
    return {name for text in texts for name in NAME.findall(STRING.sub("", text) if '"' in text else text)} - {"not"}


def variables(text: str) -> set[str]:
    """Return the names of the variables in a text, outside of strings."""
    return set(VARIABLE.findall(STRING.sub("", text)))


def with_replaced(text: str, replaced: Mapping[Statement, str]) -> str:
    """Return a text in which the given statements are replaced by one-line texts; line numbers do not change."""
    lines = text.encode().split(b"\n")  # clingo counts columns in bytes
    for statement in sorted(replaced, key=_begin, reverse=True):
        (first, column), end = _begin(statement), statement.node.location.end
        after = lines[end.line - 1][end.column - 1 :]
        lines[first - 1] = lines[first - 1][: column - 1] + replaced[statement].encode()
        lines[first : end.line] = [b""] * (end.line - first)
        lines[end.line - 1] += after
    return b"\n".join(lines).decode()


def _begin(statement: Statement) -> tuple[int, int]:
    begin = statement.node.location.begin
    return begin.line, begin.column
