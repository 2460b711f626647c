"""Whether a step program is the same function at every step, told from its syntax.

The one-step program stands for all steps only if no rule looks at the number of a step, or at a step other than the
one before. That cannot be seen in the ground program of a single step, so it is read off the rules themselves.
"""

from __future__ import annotations

from dataclasses import dataclass

import clingo
from clingo.ast import AST, ASTType, parse_string

from prag_asp.domain.sources import Program
from prag_asp.logic.growth import growing_heads
from prag_asp.logic.syntax import BEFORE, NOW, Signature, atoms_in, children_of, heads_of, signature_of, time_of

START = "0"
PARTS = ("base", "step", "check")


@dataclass(frozen=True)
class StepReads:
    """What the rules of a step read of the step before, and why they are no function of it, if they are none.

    `timed` are the predicates that carry a time; `growing` those of them that may take new values without end.
    """

    timed: frozenset[Signature]
    previous: frozenset[Signature]
    obstacles: tuple[str, ...]
    growing: frozenset[Signature]


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
        timed |= {signature_of(atom) for atom in atoms_in(rule.head) if time_of(atom) == NOW}
    previous: set[Signature] = set()
    obstacles = []
    for name in PARTS:
        for rule in rules[name]:
            obstacle = _obstacle(rule, name, timed, previous)
            if obstacle:
                path, line = program.locate(rule.location.begin.line)
                obstacles.append(f"{path}:{line}: {obstacle}")
    growing = {head for rule in rules["step"] for head in growing_heads(rule, timed)}
    return StepReads(frozenset(timed), frozenset(previous), tuple(obstacles), frozenset(growing))


def _obstacle(rule: AST, part: str, timed: set[Signature], previous: set[Signature]) -> str | None:
    for atom in atoms_in(rule):
        signature, time = signature_of(atom), time_of(atom)
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
    if part == "step" and any(time_of(atom) != NOW for atom in heads_of(rule.head)):
        return "a head in step(t) does not carry the time t"
    if part != "base" and _reads_number(rule):
        return "the rule reads the number of the step; carry a counter along instead"
    return None


def _reads_number(node: AST) -> bool:
    """Return whether the step number stands anywhere but as the time of an atom."""
    if node.ast_type == ASTType.SymbolicTerm:
        return bool(node.symbol == clingo.Function("t", []))
    if node.ast_type == ASTType.SymbolicAtom:
        return any(
            _reads_number(argument)
            for atom in atoms_in(node)
            for argument in (atom.arguments[:-1] if time_of(atom) in (NOW, BEFORE) else atom.arguments)
        )
    return any(_reads_number(child) for child in children_of(node))
