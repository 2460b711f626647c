"""Step rules that read a fluent whose value may be unknown; three-valued states are inexact for them."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import clingo
from clingo.ast import ASTType

from prag_asp.lint.unset_fluents import unset_fluents
from prag_asp.program.facts import Facts
from prag_asp.program.grounding import Grounder
from prag_asp.program.predicates import HOLDS, KNOWN, OCCURS, PRUNED
from prag_asp.program.problem import Problem
from prag_asp.program.sources import Program
from prag_asp.program.syntax import AtomNode, Signature, Statement, atoms, names, variables

READS: frozenset[Signature] = frozenset([HOLDS, KNOWN])
READ, UNSURE, POOLED = "_read", "_unsure", "_Pooled"
ANONYMOUS = re.compile(r"(?<![\w'])_(?![\w'])")


def open_world_problems(
    program: Program, grounder: Grounder, facts: Facts, statements: Sequence[Statement]
) -> Iterator[Problem]:
    """Yield the author's step rules that read a fluent whose value may be unknown."""
    readings = [
        (each, atom)
        for each in statements
        if each.own and each.timed and each.is_rule
        for atom in each.body
        if atom.signature in READS
    ]
    if not readings:
        return
    unsure = _unsure(grounder.control, facts)
    for unset, rule in unset_fluents(program, facts, statements, unsure.keys()).items():
        changes = f"which {rule.path.name}:{rule.line} changes"
        unsure[unset] = f"{changes}, though no rule may give it a value; derive holds({unset},V,t) in every case"
    if not unsure:
        return
    grounder.state(PRUNED(term) for term in facts.pruned)
    timed = {atom.signature for each in statements if each.timed for atom in each.heads}
    reported: set[tuple[Path, int]] = set()
    for number, (statement, atom) in enumerate(readings):
        conditions = list(_conditions(statement, timed))
        fluent = _read_fluent(grounder.control, f"{READ}_{number}", atom, conditions, unsure)
        if fluent is None or (statement.path, statement.line) in reported:
            continue
        reported.add((statement.path, statement.line))
        yield statement.problem(f"this rule of a step reads {fluent}, {unsure[fluent]}", atom.line)


def _unsure(control: clingo.Control, facts: Facts) -> dict[clingo.Symbol, str]:
    """Return the fluents that may be unknown, each with the reason and the remedy."""
    initially_known = {atom.symbol.arguments[0] for atom in control.symbolic_atoms.by_signature(*HOLDS)}
    unsure = {
        fluent: f"which is unknown at the start; state initially({fluent}, ...), or include rules/closed_world.lp"
        for fluent in facts.fluents
        if fluent not in initially_known
    }
    for action, values in facts.postconditions.items():
        for fluent, value in values:
            if value == "unknown":
                unsure.setdefault(fluent, f"which {action} may leave unknown; let the action make it true or false")
    return unsure


def _read_fluent(
    control: clingo.Control, part: str, atom: AtomNode, conditions: Sequence[str], unsure: Iterable[clingo.Symbol]
) -> clingo.Symbol | None:
    """Return the first fluent in `unsure` that a rule may read through an atom, or None."""
    numbers = itertools.count()
    fluent = ANONYMOUS.sub(lambda _: f"_V{next(numbers)}", atom.arguments[0])
    facts = " ".join(f"{UNSURE}({each})." for each in unsure)
    for name, restricting in ((part, conditions), (f"{part}_at_all", ())):
        several = ";" in fluent or ".." in fluent
        literals = [f"{UNSURE}({POOLED})", f"{POOLED} = {fluent}"] if several else [f"{UNSURE}({fluent})"]
        head = POOLED if several else fluent
        rule = f"{name}({head}) :- {'; '.join([*literals, *restricting])}."
        try:
            control.add(name, [], f"{facts}\n{rule}")
            control.ground([(name, [])])
        except RuntimeError:
            continue
        return min((each.symbol.arguments[0] for each in control.symbolic_atoms.by_signature(name, 1)), default=None)
    return None


def _conditions(statement: Statement, timed: set[Signature]) -> Iterator[str]:
    """Yield the conditions of a rule that do not depend on the step; they restrict the fluents that it reads.

    An occurrence is replaced by the condition that its action is not pruned.
    """
    bound, parameters = set[str](), set(statement.parameters)
    comparisons: list[str] = []
    for node, text in statement.literals:
        if node.ast_type != ASTType.Literal or text.startswith("not "):
            continue
        if node.atom.ast_type == ASTType.Comparison:
            comparisons.append(text)
            continue
        for atom in atoms(node, text):
            if atom.signature == OCCURS:
                condition = f"action({atom.arguments[0]}); not {PRUNED.name}({atom.arguments[0]})"
            elif atom.signature in timed or atom.signature in READS or names(atom.arguments) & parameters:
                continue
            else:
                condition = str(atom)
            bound |= variables(condition)
            yield condition
    for text in comparisons:
        if variables(text) <= bound and not names([text]) & parameters:
            yield text
