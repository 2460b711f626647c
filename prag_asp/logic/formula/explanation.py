"""Why a sequence of actions is no plan: the first step that cannot occur, the reasons, and the steps in conflict."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import clingo

from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.formula.broken_constraints import ReportingProgram, broken_atoms, report_violations
from prag_asp.logic.formula.clause_builder import Literal
from prag_asp.logic.formula.cnf import Cnf, plan_cnf
from prag_asp.logic.formula.solver import Solver, smallest_conflict
from prag_asp.processes.progress_events import stage
from prag_asp.program.facts import Assignment
from prag_asp.program.predicates import BARRED, FINAL, HOLDS, KNOWN, OCCURS, RULED_OUT, EncodingPredicate

OPPOSITE = {"true": "false", "false": "true"}
EXPLAINED = ("step.lp", "invariants.lp", "goal.lp", "impossible.lp")
"""The encodings whose constraints are explained in words."""


@dataclass(frozen=True)
class Explanation:
    """The reasons why n actions are no plan.

    `step` is the first one, from 1, that cannot follow those before it; 0 if the start is impossible, n + 1 if all
    steps can occur, but the goal or check after them fails. `reasons` are sentences. `conflict` is a smallest set of
    steps that no plan of n steps has at these places; it is empty if there is no plan of n steps at all.
    """

    step: int
    reasons: tuple[str, ...]
    conflict: tuple[int, ...]


def explain(model: DomainLogic, plan: Sequence[clingo.Symbol]) -> Explanation | None:
    """Return why a sequence of actions of the domain is no plan, or None if it is one.

    Raises:
        EngineError: the program has no counterpart in clauses.
    """
    program = report_violations(model.program)
    cnf = plan_cnf(program.program, len(plan))
    stage("looking for the conflict")
    with Solver(cnf.variables, cnf.clauses) as solver:
        search = _ReasonSearch(model, tuple(plan), program, cnf, solver)
        if solver.satisfiable([*search.actions, *search.lawful(len(plan) + 1)]):
            return None
        step = next(k for k in range(len(plan) + 2) if not solver.satisfiable(search.until(k)))
        reasons = tuple(dict.fromkeys(search.reasons(step)))
        core = smallest_conflict(solver, search.lawful(len(plan) + 1), search.actions)
        conflict = tuple(k for k, literal in enumerate(search.actions, 1) if literal in core)
        return Explanation(step, reasons, conflict)


class _ReasonSearch:
    """Solver queries about one sequence of actions."""

    def __init__(
        self, model: DomainLogic, plan: tuple[clingo.Symbol, ...], program: ReportingProgram, cnf: Cnf, solver: Solver
    ) -> None:
        self._model, self._plan, self._rules, self._cnf, self._solver = model, plan, program.rules, cnf, solver
        self._broken = broken_atoms(cnf.literals)
        self.actions = [self._atom(OCCURS, action, k) for k, action in enumerate(plan, 1)]

    def lawful(self, end: int) -> list[Literal]:
        """Return the literals of "no constraint is broken up to a time"."""
        return [-literal for time, literals in self._broken.items() if time <= end for literal in literals.values()]

    def until(self, step: int) -> list[Literal]:
        """Return the literals of "the first steps occur and break no constraint"."""
        return [*self.actions[:step], *self.lawful(step)]

    def reasons(self, step: int) -> Iterator[str]:
        """Yield the reasons why a step cannot follow those before it."""
        assumed = [*self.actions[:step], *self.lawful(step - 1)]
        if not self._solver.satisfiable(assumed):
            yield "another action has to occur there"
            return
        state = _State(self._cnf, self._solver.model(), self._plan)
        words = list(self._needs(step, state)) or list(self._contradictions(step, state))
        yield from words
        for line in self._lines(step, assumed):
            path, number, text = self._rules[line]
            if not words or path.name not in EXPLAINED:
                yield f"{path}:{number} forbids it: {text}"

    def _lines(self, step: int, assumed: Sequence[Literal]) -> list[int]:
        """Return the constraints that each forbid a step, or else a smallest set that does so together."""
        here = self._broken.get(step, {})
        alone = [line for line, literal in here.items() if not self._solver.satisfiable([*assumed, -literal])]
        if alone:
            return sorted(alone)
        together = smallest_conflict(self._solver, assumed, [-literal for literal in here.values()])
        return sorted(line for line, literal in here.items() if -literal in together)

    def _needs(self, step: int, state: _State) -> Iterator[str]:
        facts = self._model.domain.facts
        needed: Assignment = ()
        if step > len(self._plan):
            needed, who = facts.goal, "the goal needs"
        elif step:
            needed, who = facts.preconditions.get(self._plan[step - 1], ()), "it needs"
        for fluent, value in needed:
            since = state.known_since(fluent, OPPOSITE[value], step - 1)
            if since is not None:
                yield f"{who} {fluent} to be {value}, which is {OPPOSITE[value]} {since}"

    def _contradictions(self, step: int, state: _State) -> Iterator[str]:
        for fluent in self._model.domain.facts.fluents:
            for predicate in (KNOWN, HOLDS, FINAL):
                time = min(step, len(self._plan))
                if all(state.true(self._atom(predicate, fluent, time, value)) for value in OPPOSITE):
                    yield f"{fluent} would have to be both true and false"
                    break
            if self._impossible(fluent, min(step, len(self._plan)), state):
                yield f"{fluent} would have to be true, which is impossible together with what else is true then"

    def _impossible(self, fluent: clingo.Symbol, time: int, state: _State) -> bool:
        true = {each: state.true(self._atom(each, fluent, time, "true")) for each in (KNOWN, HOLDS, FINAL)}
        ruled_out, barred = (state.true(self._atom(each, fluent, time)) for each in (RULED_OUT, BARRED))
        return (barred and true[KNOWN]) or (ruled_out and (true[HOLDS] or true[FINAL]))

    def _atom(self, predicate: EncodingPredicate, term: clingo.Symbol, time: int, value: str = "") -> Literal:
        middle = [clingo.Function(value)] if value else []
        return self._cnf.literal(predicate(term, *middle, clingo.Number(time)))


class _State:
    """The values of the states of the steps in one model."""

    def __init__(self, cnf: Cnf, model: Sequence[Literal], plan: Sequence[clingo.Symbol]) -> None:
        self._cnf, self._values, self._plan = cnf, model, plan

    def true(self, literal: Literal) -> bool:
        """Return whether a literal is true."""
        return (self._values[abs(literal) - 1] > 0) == (literal > 0)

    def known_since(self, fluent: clingo.Symbol, value: str, step: int) -> str | None:
        """Return the time since which a fluent is known to have a value, or None if it is not known after the step."""
        since = step + 1
        while since > 0 and self._holds(fluent, value, since - 1):
            since -= 1
        if since > step:
            return None
        return f"since step {since}, {self._plan[since - 1]}" if since else "from the start"

    def _holds(self, fluent: clingo.Symbol, value: str, step: int) -> bool:
        return self.true(self._cnf.literal(HOLDS(fluent, clingo.Function(value), clingo.Number(step))))
