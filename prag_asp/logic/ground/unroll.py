"""All steps of a program as ground rules."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import clingo

from prag_asp.errors import EngineError
from prag_asp.logic.ground.ground_step import unrolled
from prag_asp.logic.ground.rules import GroundRecorder, Rule
from prag_asp.program.grounding import Grounder
from prag_asp.program.sources import Program


@dataclass(frozen=True)
class UnrolledProgram:
    """The ground rules of a number of steps; `atoms` maps each symbol to its atom. A fact is a rule without a body."""

    length: int
    rules: tuple[Rule, ...]
    atoms: Mapping[clingo.Symbol, int]


def unroll(program: Program, length: int) -> UnrolledProgram:
    """Ground all steps of plans of a length.

    Raises:
        DomainError: clingo cannot ground the program.
        EngineError: a rule has a disjunction as its head, or there is more to the program than rules.
    """
    grounder, recorder = Grounder(program), GroundRecorder()
    grounder.control.register_observer(recorder)
    grounder.ground([("base", [])])
    grounder.ground(unrolled(length))
    rules = recorder.all_rules
    unsupported = [each.value for each in recorder.unsupported]
    if any(rule.is_disjunctive for rule in rules):
        unsupported.append("a rule has a disjunction as its head")
    if any(value is not clingo.TruthValue.False_ for value in recorder.externals.values()):
        unsupported.append("the program has an external atom that is not false")
    if unsupported:
        raise EngineError(f"{unsupported[0]}, which has no counterpart in clauses; choose the engine clingo")
    atoms = {atom.symbol: atom.literal for atom in grounder.control.symbolic_atoms}
    return UnrolledProgram(length, tuple(rules), atoms)
