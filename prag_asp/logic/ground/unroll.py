"""All steps of a program as the ground rules that clingo makes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import clingo

from prag_asp.errors import EngineError
from prag_asp.logic.ground.ground_step import Rule, unrolled
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
    grounder, recorder = Grounder(program), _Recorder()
    grounder.control.register_observer(recorder)
    grounder.ground([("base", [])])
    grounder.ground(unrolled(length))
    if recorder.obstacle:
        raise EngineError(f"{recorder.obstacle}, which has no counterpart in clauses; choose the engine clingo")
    atoms = {atom.symbol: atom.literal for atom in grounder.control.symbolic_atoms}
    return UnrolledProgram(length, tuple(recorder.rules), atoms)


class _Recorder(clingo.Observer):
    """Keeps the rules that clingo grounds, and the first statement that is none."""

    def __init__(self) -> None:
        self.rules: list[Rule] = []
        self.obstacle = ""

    def rule(self, choice: bool, head: Sequence[int], body: Sequence[int]) -> None:
        self._keep(Rule(tuple(head), tuple(body), choice))

    def weight_rule(self, choice: bool, head: Sequence[int], lower_bound: int, body: Sequence[tuple[int, int]]) -> None:
        if lower_bound <= 0:
            self._keep(Rule(tuple(head), (), choice))
        elif body:
            literals, weights = zip(*body, strict=True)
            self._keep(Rule(tuple(head), literals, choice, lower_bound, weights))

    def external(self, atom: int, value: clingo.TruthValue) -> None:
        if value is not clingo.TruthValue.False_:
            self._refuse("the program has an external atom that is not false")

    def _keep(self, rule: Rule) -> None:
        if len(rule.heads) > 1 and not rule.choice:
            self._refuse("a rule has a disjunction as its head")
        self.rules.append(rule)

    def _refuse(self, obstacle: str) -> None:
        self.obstacle = self.obstacle or obstacle

    def _refusing(obstacle: str) -> Callable[..., None]:  # type: ignore[misc]
        return lambda self, *_: self._refuse(obstacle)

    minimize = _refusing("the program minimizes a sum")
    acyc_edge = _refusing("the program has a graph that must stay acyclic")
    theory_atom = _refusing("the program uses a theory")
    theory_atom_with_guard = _refusing("the program uses a theory")
