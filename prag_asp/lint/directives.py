"""Statements that a domain must not have, rules in the wrong program part, and unbounded facts and rules."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

from clingo.ast import ASTType

from prag_asp.atom import STRING
from prag_asp.program.finite.checks import ever_larger
from prag_asp.program.finite.endless import endless_rules
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
"""The predicates of the base part, which must not depend on the step."""

CHOICES = (ASTType.Aggregate, ASTType.Disjunction, ASTType.HeadAggregate)
TIMED: frozenset[Signature] = frozenset([OCCURS, HOLDS])

MOST = 10**8
"""The maximum number of atoms in a fact. Each atom takes at least 100 bytes, so this number of atoms takes 10 GB."""

NUMBER = re.compile(r"-?\d+")
INTERVAL = re.compile(r"\((-?\d+|_*[a-z]\w*)\.\.(-?\d+|_*[a-z]\w*)\)")
"""An interval between two numbers or constants, as clingo prints it."""


def directive_problems(statements: Sequence[Statement]) -> Iterator[Problem]:
    """Yield the statements that a domain must not have, and the program parts that are never grounded."""
    for statement in statements:
        if not statement.own:
            if statement.kind == ASTType.Script:
                yield statement.problem(REFUSED[ASTType.Script])
            continue
        if statement.kind in REFUSED:
            yield statement.problem(REFUSED[statement.kind])
        yield from (statement.problem(runs_no_code(name)) for name in statement.scripts)
        if statement.is_rule and "&" in statement.text:
            theory_atoms = (node for node in below(statement.node) if node.ast_type == ASTType.TheoryAtom)
            yield from (statement.problem(REFUSED[node.ast_type]) for node in theory_atoms)
        if statement.kind == ASTType.Program:
            yield from _part_problems(statement)
        if statement.kind == ASTType.Definition:
            name = statement.node.name
            encodings = (each for each in statements if not each.own)
            if name in names(
                text for each in encodings for atom in (*each.heads, *each.body) for text in atom.arguments
            ):
                yield statement.problem(f"#const {name} would change what {name} means; choose another name")


def _part_problems(statement: Statement) -> Iterator[Problem]:
    """Yield a problem for a program part that is never grounded."""
    name, count = statement.part, len(statement.parameters)
    if (name == "base" and count == 0) or (name in TIMED_PARTS and count == 1):
        return
    written = f"#program {name}({','.join(statement.parameters)})" if count else f"#program {name}"
    parts = {"base": "base", **{part: f"{part}(t)" for part in TIMED_PARTS}}
    near = parts.get(name) or parts.get(nearest(name, parts) or "")
    hint = f"did you mean {near}?" if near else "the program parts are base, step(t) and check(t)"
    yield statement.problem(f"{written}. is never grounded; {hint}")


def placement_problems(statements: Sequence[Statement]) -> Iterator[Problem]:
    """Yield the author's rules in the wrong program part."""
    rules = [each for each in statements if each.own and each.is_rule]
    for rule in rules:
        if rule.timed:
            time = rule.parameters[0] if rule.parameters else "t"
            part = f"#program {rule.part}({time})"
            for atom in rule.heads:
                if atom.signature in STATED:
                    yield rule.problem(
                        f"{spelled(atom.signature)} is stated in {part}, but holds at every step; "
                        "move the rule above it, or below #program base."
                    )
                elif not atom.arguments or atom.arguments[-1] != time:
                    text = f"the head {atom} of a rule in {part} has no time argument"
                    yield rule.problem(f"{text}; make {time} its last argument")
            continue
        timed = (atom for atom in (*rule.heads, *rule.body) if atom.signature in TIMED)
        of_step = next((atom for atom in timed if atom.signature == OCCURS or atom.arguments[-1] == "t"), None)
        stated = next((atom for atom in rule.heads if atom.signature in STATED), None)
        if of_step is not None:
            text = f"{of_step} is about a step, but is in the base part"
            yield rule.problem(f"{text}; put the rules of a step below #program step(t).")
        elif stated is not None and rule.node.head.ast_type in CHOICES:
            yield rule.problem(f"{spelled(stated.signature)} depends on a choice; state it as a fact")


def last_step_problems(statements: Sequence[Statement]) -> Iterator[Problem]:
    """Yield the step rules that read a predicate derived at the same step by rules in ``check(t)``.

    A step is the same function at every time, so it does not know whether it is the last one. The program is grounded
    part by part: ``base``, then ``step(1)`` to ``step(n)``, then ``check(n)``. Each part can read only atoms that it or
    an earlier part derives.
    """
    checks = [each for each in statements if each.is_rule and each.part == "check"]
    derived = {head.signature: each for each in checks for head in each.heads if not head.negated}
    for rule in statements:
        if not derived or not rule.is_rule or rule.part != "step":
            continue
        before = f"({rule.parameters[0] if rule.parameters else 't'}-1)"
        read = (each.signature for each in rule.body if not each.arguments or each.arguments[-1] != before)
        signature = next((each for each in read if each in derived), None)
        if signature is None:
            continue
        time = f"check({rule.parameters[0] if rule.parameters else 't'})"
        if rule.own:
            text = f"this rule of a step reads {spelled(signature)}, which {time} derives after the last step only"
            yield rule.problem(f"{text}; derive it in the step, or move this rule to {time}")
        else:
            check = derived.pop(signature)
            text = f"{spelled(signature)} is derived in {time}, but rules of a step read it"
            yield check.problem(f"{text}; derive a predicate of another name")


def size_problems(statements: Sequence[Statement]) -> Iterator[Problem]:
    """Yield the author's facts whose intervals expand to too many atoms."""
    constants = {each.node.name: str(each.node.value) for each in statements if each.kind == ASTType.Definition}
    for statement in statements:
        if statement.own and statement.is_rule and ".." in statement.text and not statement.node.body:
            atoms = 1
            for ends in INTERVAL.finditer(STRING.sub("", str(statement.node.head))):
                low, high = (constants.get(end, end) for end in ends.groups())
                if NUMBER.fullmatch(low) and NUMBER.fullmatch(high):
                    atoms *= max(int(high) - int(low) + 1, 0)
            if atoms > MOST:
                yield statement.problem(
                    f"this fact stands for {atoms:,} atoms, more than the limit of {MOST:,}; make its intervals smaller"
                )


def recursion_problems(statements: Sequence[Statement]) -> Iterator[Problem]:
    """Yield the author's step rules that certainly derive ever-growing terms within one step.

    Rules of the base part that do so are found while it is grounded. A rule that never fires, because no other rule
    derives its head, is not reported.
    """
    endless = [each for each in endless_rules(statements) if each.certain and each.rule.timed]
    rules = {each.rule for each in endless}
    begun = {head.signature for each in statements if each.is_rule and each not in rules for head in each.heads}
    for each in endless:
        head = each.rule.heads[0]
        if head.signature in begun:
            yield each.rule.problem(ever_larger(head.name))
