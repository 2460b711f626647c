"""Find statements that a domain may not have, and rules in the wrong program part."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from clingo.ast import ASTType

from prag_asp.program.predicates import HOLDS, OCCURS
from prag_asp.program.problem import Problem
from prag_asp.program.syntax import TIMED_PARTS, Signature, Statement, below, names, runs_no_code, spelled
from prag_asp.wording import nearest

REFUSED: Mapping[ASTType, str] = {
    ASTType.Script: "#script is refused: a domain runs no code; remove it",
    ASTType.External: "#external is refused: nothing would set its atoms; state a fact, or use a fluent",
    ASTType.Minimize: "optimization is refused: it would leave plans out of the count; write a constraint",
    ASTType.ProjectAtom: "#project is refused: it would change the count; remove it",
    ASTType.ProjectSignature: "#project is refused: it would change the count; remove it",
    ASTType.Heuristic: "#heuristic is refused: the engines ignore it; remove it",
    ASTType.Edge: "#edge is refused: it would leave plans out of the count; write a constraint",
    ASTType.TheoryDefinition: "#theory is refused: the engines have no theory solver; write plain rules",
    ASTType.TheoryAtom: "theory atoms are refused: the engines have no theory solver; write plain rules",
}
STATED = frozenset(
    [
        ("class", 1), ("class", 2), ("entity", 2), ("fluent", 1), ("action", 1), ("precondition", 3),
        ("postcondition", 3), ("initially", 2), ("exclusive", 2), ("implies", 2), ("goal", 2),
        ("composite", 1), ("stage", 3), ("free", 1), ("at_most", 2), ("ever", 1),
    ]
)  # fmt: skip
"""The predicates of the base part, which do not depend on the step."""

CHOICES = (ASTType.Aggregate, ASTType.Disjunction, ASTType.HeadAggregate)
TIMED: frozenset[Signature] = frozenset([OCCURS, HOLDS])


def directive_problems(statements: Sequence[Statement]) -> Iterator[Problem]:
    """Yield the statements that a domain may not have, and the program parts that are never grounded."""
    for statement in statements:
        if statement.own:
            yield from _refused(statement)
            if statement.kind == ASTType.Program:
                yield from _part_problems(statement)
            if statement.kind == ASTType.Definition and statement.node.name in _reserved(statements):
                name = statement.node.name
                yield statement.problem(f"#const {name} would change what {name} means; choose another name")
        elif statement.kind == ASTType.Script:
            yield statement.problem(REFUSED[ASTType.Script])


def _reserved(statements: Sequence[Statement]) -> set[str]:
    """Return the names in the arguments of atoms of the encodings."""
    encodings = [each for each in statements if not each.own]
    return names(argument for each in encodings for atom in (*each.heads, *each.body) for argument in atom.arguments)


def placement_problems(statements: Sequence[Statement]) -> Iterator[Problem]:
    """Yield the author's rules in the wrong program part."""
    for statement in statements:
        if statement.own and statement.is_rule:
            yield from _timed_problems(statement) if statement.timed else _base_problems(statement)


def _refused(statement: Statement) -> Iterator[Problem]:
    if statement.kind in REFUSED:
        yield statement.problem(REFUSED[statement.kind])
    yield from (statement.problem(runs_no_code(name)) for name in statement.scripts)
    if statement.is_rule and "&" in statement.text:
        for node in below(statement.node):
            if node.ast_type == ASTType.TheoryAtom:
                yield statement.problem(REFUSED[ASTType.TheoryAtom])


def _part_problems(statement: Statement) -> Iterator[Problem]:
    name, count = statement.part, len(statement.parameters)
    if (name == "base" and count == 0) or (name in TIMED_PARTS and count == 1):
        return
    written = f"#program {name}({','.join(statement.parameters)})" if count else f"#program {name}"
    parts = {"base": "base", **{part: f"{part}(t)" for part in TIMED_PARTS}}
    near = parts.get(name) or parts.get(nearest(name, parts) or "")
    hint = f"did you mean {near}?" if near else "the program parts are base, step(t) and check(t)"
    yield statement.problem(f"{written}. is never grounded; {hint}")


def _timed_problems(statement: Statement) -> Iterator[Problem]:
    time = statement.parameters[0] if statement.parameters else "t"
    for atom in statement.heads:
        if atom.signature in STATED:
            yield statement.problem(
                f"{spelled(atom.signature)} is stated in #program {statement.part}({time}), but holds at "
                "every step; move the rule above it, or below #program base."
            )
        elif not atom.arguments or atom.arguments[-1] != time:
            yield statement.problem(
                f"the head {atom} of a rule in #program {statement.part}({time}) has no time argument; "
                f"make {time} its last argument"
            )


def _base_problems(statement: Statement) -> Iterator[Problem]:
    for atom in (*statement.heads, *statement.body):
        if atom.signature in TIMED and (atom.signature == OCCURS or atom.arguments[-1] == "t"):
            yield statement.problem(
                f"{atom} is about a step, but stands in the base part; put the rules of a step below #program step(t)."
            )
            return
    for atom in statement.heads:
        if atom.signature in STATED and statement.node.head.ast_type in CHOICES:
            yield statement.problem(f"{spelled(atom.signature)} depends on a choice; state it as a fact")
            return
