"""Whether a step program is the same function at every step, told from its syntax.

The one-step program stands for all steps only if no rule looks at the number of a step, or at a step other than the
one before. That cannot be seen in the ground program of a single step, so it is read off the rules themselves.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import clingo
from clingo.ast import AST, ASTType, parse_string

from prag_asp.domain.sources import Program

Signature = tuple[str, int]

NOW, BEFORE, START = "t", "(t-1)", "0"
PARTS = ("base", "step", "check")


@dataclass(frozen=True)
class StepReads:
    """What the rules of a step read of the step before, and why they are no function of it, if they are none.

    `timed` are the predicates that carry a time.
    """

    timed: frozenset[Signature]
    previous: frozenset[Signature]
    obstacles: tuple[str, ...]


def read_step(program: Program) -> StepReads:
    """Return what the parts ``step(t)`` and ``check(t)`` of a program read of step t-1."""
    rules: dict[str, list[AST]] = {name: [] for name in PARTS}
    part = rules["base"]

    def collect(statement: AST) -> None:
        nonlocal part
        if statement.ast_type == ASTType.Program:
            part = rules.setdefault(statement.name, [])
        elif statement.ast_type == ASTType.Rule:
            part.append(statement)

    parse_string(program.text, collect)
    timed = {("occurs", 2), ("holds", 3)}
    for rule in rules["step"]:
        timed |= {_signature(atom) for atom in _atoms(rule.head) if _time(atom) == NOW}
    previous: set[Signature] = set()
    obstacles = []
    for name in PARTS:
        for rule in rules[name]:
            obstacle = _obstacle(rule, name, timed, previous)
            if obstacle:
                path, line = program.locate(rule.location.begin.line)
                obstacles.append(f"{path}:{line}: {obstacle}")
    return StepReads(frozenset(timed), frozenset(previous), tuple(obstacles))


def locate_head(program: Program, signature: Signature) -> str:
    """Return the file and the line of the first rule of a step that derives a predicate."""
    found: list[int] = []
    part = "base"

    def collect(statement: AST) -> None:
        nonlocal part
        if statement.ast_type == ASTType.Program:
            part = statement.name
        elif statement.ast_type == ASTType.Rule and part == "step" and signature in heads(statement):
            found.append(statement.location.begin.line)

    def heads(rule: AST) -> set[Signature]:
        return {_signature(atom) for atom in _heads(rule.head)}

    parse_string(program.text, collect)
    path, line = program.locate(found[0])
    return f"{path}:{line}"


def _obstacle(rule: AST, part: str, timed: set[Signature], previous: set[Signature]) -> str | None:
    for atom in _atoms(rule):
        signature, time = _signature(atom), _time(atom)
        spelled = f"{atom.name}/{len(atom.arguments)}"
        if part == "base":
            if signature in timed and time != START:
                return f"{spelled} is read outside of the parts step(t) and check(t)"
        elif time == BEFORE and part == "check":
            return "the check after the last step reads the step before it"
        elif signature in timed and time not in (NOW, BEFORE, START):
            return f"{spelled} is read at a step other than t and t-1"
        if time == BEFORE:
            previous.add(signature)
    if part == "step" and any(_time(atom) != NOW for atom in _heads(rule.head)):
        return "a head in step(t) does not carry the time t"
    if part != "base" and _reads_number(rule):
        return "the rule reads the number of the step; carry a counter along instead"
    return None


def _children(node: AST) -> Iterator[AST]:
    for key in node.child_keys:
        child = getattr(node, key)
        if isinstance(child, AST):
            yield child
        elif child is not None:
            yield from child


def _atoms(node: AST) -> Iterator[AST]:
    """Yield the functions that stand as atoms."""
    if node.ast_type == ASTType.SymbolicAtom:
        symbol = node.symbol
        while symbol.ast_type == ASTType.UnaryOperation:
            symbol = symbol.argument
        if symbol.ast_type == ASTType.Function:
            yield symbol
    else:
        for child in _children(node):
            yield from _atoms(child)


def _heads(head: AST) -> Iterator[AST]:
    """Yield the atoms that a head derives, without the conditions that they stand under."""
    if head.ast_type == ASTType.ConditionalLiteral:
        yield from _atoms(head.literal)
    elif head.ast_type in (ASTType.Aggregate, ASTType.Disjunction):
        for element in head.elements:
            yield from _heads(element)
    else:
        yield from _atoms(head)


def _signature(atom: AST) -> Signature:
    return atom.name, len(atom.arguments)


def _time(atom: AST) -> str:
    return str(atom.arguments[-1]) if len(atom.arguments) else ""


def _reads_number(node: AST) -> bool:
    """Return whether the step number stands anywhere but as the time of an atom."""
    if node.ast_type == ASTType.SymbolicTerm:
        return bool(node.symbol == clingo.Function("t", []))
    if node.ast_type == ASTType.SymbolicAtom:
        return any(
            _reads_number(argument)
            for atom in _atoms(node)
            for argument in (atom.arguments[:-1] if _time(atom) in (NOW, BEFORE) else atom.arguments)
        )
    return any(_reads_number(child) for child in _children(node))
