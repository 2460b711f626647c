"""Why a sequence of actions is not a plan: the first step that cannot occur, the reasons, and conflicting steps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import clingo
from clingo.ast import AST, ASTType, parse_string

from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.formula.clause_builder import Literal
from prag_asp.logic.formula.cnf import Cnf, plan_cnf
from prag_asp.logic.formula.solver import Solver, smallest_conflict
from prag_asp.processes.progress_events import stage
from prag_asp.program.facts import Assignment
from prag_asp.program.predicates import BARRED, FINAL, HOLDS, KNOWN, OCCURS, RULED_OUT, EncodingPredicate
from prag_asp.program.sources import Program, Source

OPPOSITE = {"true": "false", "false": "true"}
EXPLAINED = ("step.lp", "invariants.lp", "goal.lp", "impossible.lp")
"""The encodings whose constraints are explained in words."""

BROKEN = "__broken"
TIMES = {"base": "0", "step": "{}", "check": "{}+1"}
"""The time of a violation in each program part: the initial state, a step, or the time after the last step."""


@dataclass(frozen=True)
class Explanation:
    """The reasons why n actions are not a plan.

    `step` is the number, from 1, of the first step that cannot follow the previous ones; it is 0 if the initial state
    is impossible, and n + 1 if all steps can occur but the goal or the final check fails. `reasons` are sentences.
    `conflict` is a smallest set of steps that no plan of n steps has at the same positions; it is empty if there is no
    plan of n steps at all.
    """

    step: int
    reasons: tuple[str, ...]
    conflict: tuple[int, ...]


def explain(model: DomainLogic, plan: Sequence[clingo.Symbol]) -> Explanation | None:
    """Return why a sequence of the domain's actions is not a plan, or None if it is one.

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


@dataclass(frozen=True)
class ReportingProgram:
    """A program without constraints; ``__broken(L,T)`` states that the constraint of line L is violated at time T.

    `rules` holds, for each L, the file, the line and the text of the constraint.
    """

    program: Program
    rules: Mapping[int, tuple[Path, int, str]]


def report_violations(program: Program) -> ReportingProgram:
    """Return a program with its constraints turned into rules that derive an atom; line numbers do not change."""
    lines = program.text.splitlines()
    statements: dict[int, list[str]] = {}
    rules: dict[int, tuple[Path, int, str]] = {}
    part, time = "base", "0"

    def collect(statement: AST) -> None:
        nonlocal part, time
        begin, end = statement.location.begin.line, statement.location.end.line
        if statement.ast_type == ASTType.Program:
            part = statement.name
            time = statement.parameters[0].name if statement.parameters else "0"
        text = str(statement)
        if _is_constraint(statement) and part in TIMES:
            rules[begin] = (*program.locate(begin), " ".join(line.strip() for line in lines[begin - 1 : end]))
            body = "; ".join(map(str, statement.body))
            text = f"{BROKEN}({begin},{TIMES[part].format(time)}) :- {body or '#true'}."
        statements.setdefault(begin, []).append(text)

    parse_string(program.text, collect)
    sources: list[Source] = []
    line = 1  # in clingo's text of a program, a line is added before each source
    for source in program.sources:
        end = line + source.text.count("\n") + 2
        texts = (" ".join(statements.get(number, ())) for number in range(line + 1, end))
        sources.append(Source(source.path, "\n".join(texts)))
        line = end
    return ReportingProgram(Program(tuple(sources)), rules)


def _is_constraint(statement: AST) -> bool:
    if statement.ast_type != ASTType.Rule or statement.head.ast_type != ASTType.Literal:
        return False
    atom = statement.head.atom
    return bool(atom.ast_type == ASTType.BooleanConstant and not atom.value and not statement.head.sign)


class _ReasonSearch:
    """Solver queries about one sequence of actions."""

    def __init__(
        self, model: DomainLogic, plan: tuple[clingo.Symbol, ...], program: ReportingProgram, cnf: Cnf, solver: Solver
    ) -> None:
        self._model, self._plan, self._rules, self._cnf, self._solver = model, plan, program.rules, cnf, solver
        self._broken: dict[int, dict[int, Literal]] = {}  # the literals of violations, by time and then by line
        for symbol, literal in cnf.literals.items():
            if symbol.match(BROKEN, 2):
                line, time = (argument.number for argument in symbol.arguments)
                self._broken.setdefault(time, {})[line] = literal
        self.actions = [self._atom(OCCURS, action, k) for k, action in enumerate(plan, 1)]

    def lawful(self, end: int) -> list[Literal]:
        """Return the literals which state that no constraint is violated up to a time."""
        return [-literal for time, literals in self._broken.items() if time <= end for literal in literals.values()]

    def until(self, step: int) -> list[Literal]:
        """Return the literals which state that the first steps occur and violate no constraint."""
        return [*self.actions[:step], *self.lawful(step)]

    def reasons(self, step: int) -> Iterator[str]:
        """Yield the reasons why a step cannot follow the previous steps."""
        assumed = [*self.actions[:step], *self.lawful(step - 1)]
        if not self._solver.satisfiable(assumed):
            yield "another action has to occur at this step"
            return
        state = _State(self._cnf, self._solver.model(), self._plan)
        words = list(self._needs(step, state)) or list(self._contradictions(step, state))
        yield from words
        # Constraints that each forbid the step, or else a smallest set that forbids it together.
        here = self._broken.get(step, {})
        forbidding = [line for line, literal in here.items() if not self._solver.satisfiable([*assumed, -literal])]
        if not forbidding:
            together = smallest_conflict(self._solver, assumed, [-literal for literal in here.values()])
            forbidding = [line for line, literal in here.items() if -literal in together]
        for line in sorted(forbidding):
            path, number, text = self._rules[line]
            if not words or path.name not in EXPLAINED:
                yield f"{path}:{number} forbids it: {text}"

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
                yield f"{who} {fluent} to be {value}, but that has been {OPPOSITE[value]} {since}"

    def _contradictions(self, step: int, state: _State) -> Iterator[str]:
        time = min(step, len(self._plan))
        for fluent in self._model.domain.facts.fluents:
            true = {each: state.true(self._atom(each, fluent, time, "true")) for each in (KNOWN, HOLDS, FINAL)}
            if any(also and state.true(self._atom(each, fluent, time, "false")) for each, also in true.items()):
                yield f"{fluent} would have to be both true and false"
            ruled_out, barred = (state.true(self._atom(each, fluent, time)) for each in (RULED_OUT, BARRED))
            if (barred and true[KNOWN]) or (ruled_out and (true[HOLDS] or true[FINAL])):
                yield f"{fluent} would have to be true, which contradicts the other conditions of that state"

    def _atom(self, predicate: EncodingPredicate, term: clingo.Symbol, time: int, value: str = "") -> Literal:
        middle = [clingo.Function(value)] if value else []
        return self._cnf.literal(predicate(term, *middle, clingo.Number(time)))


class _State:
    """The values of the state at each time in one model."""

    def __init__(self, cnf: Cnf, model: Sequence[Literal], plan: Sequence[clingo.Symbol]) -> None:
        self._cnf, self._values, self._plan = cnf, model, plan

    def true(self, literal: Literal) -> bool:
        """Return whether a literal is true."""
        return (self._values[abs(literal) - 1] > 0) == (literal > 0)

    def known_since(self, fluent: clingo.Symbol, value: str, step: int) -> str | None:
        """Return the time since which a fluent has had a known value, or None if it is not known after the step."""
        since, term = step + 1, clingo.Function(value)
        while since > 0 and self.true(self._cnf.literal(HOLDS(fluent, term, clingo.Number(since - 1)))):
            since -= 1
        if since > step:
            return None
        return f"since step {since}, {self._plan[since - 1]}" if since else "from the start"
