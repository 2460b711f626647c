"""A domain with rules over time, as ground actions with conditions and effects that depend on the state."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace

import clingo

from prag_asp.domain.load import Domain
from prag_asp.errors import DomainError, EngineError, LimitReached
from prag_asp.logic.diagram.functions import FALSE, TRUE, Cube, Functions, Node, TooLarge
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.ground.program import with_facts
from prag_asp.logic.step.transition import Transition
from prag_asp.planners.evaluation import After, StepFunctions, holds
from prag_asp.planners.ground_action import (
    CARRIED,
    Case,
    ConditionalEffect,
    GroundAction,
    PlanningTask,
    Proposition,
    Value,
)
from prag_asp.planners.grounding import rules_over_time
from prag_asp.planners.implied_values import ImpliedValues

MOST_NODES = 1_000_000
"""The maximum number of diagram nodes."""

MOST_CASES = 1000
"""The maximum number of copies of an action, one for each case of its conditions."""

REACHED = Proposition(clingo.Function("goal-reached"), CARRIED)
"""The proposition that the goal holds, which is used for goals that are not conjunctions."""

OPPOSITE = {True: "false", False: "true"}

Change = tuple[Value, Node]
"""A value that an action sets, and the states in which the action sets it."""


def ground_over_time(
    domain: Domain, stated: Mapping[clingo.Symbol, bool], goal: Mapping[clingo.Symbol, bool] | None, *, whole: bool
) -> PlanningTask:
    """Return the planning task of a domain with the initial state `stated`; all other fluents are false.

    With a `goal`, the final state must also have these values. With `whole`, there are no conditional effects and no
    disjunctions: an action has a case for each combination of truth values of its conditions (Nebel 2000).

    Raises:
        DomainError: PDDL cannot express a rule, because a step is not a function of the state and the action; an action
            has too many cases, or depends on the state in too many ways.
    """
    values = {fluent: stated.get(fluent, False) for fluent in domain.facts.fluents}
    initially = tuple((fluent, OPPOSITE[not value]) for fluent, value in values.items())
    program = with_facts(domain.program, [f"initially({fluent},{value})." for fluent, value in initially])
    symbols = [holds(fluent, value) for fluent in values for value in OPPOSITE.values()]
    unknown: set[clingo.Symbol] = set()
    try:
        model = DomainLogic(replace(domain, program=program, facts=replace(domain.facts, initially=initially)))
        transition = model.transition(tasks=False, labels=symbols)
        while True:
            step = _Step(domain, transition, frozenset(unknown))
            task = step.ground(goal or {}, whole=whole)
            if not step.unknown:
                return task
            unknown |= step.unknown
    except LimitReached:
        raise
    except EngineError as error:
        places = [f"{path}:{line}" for path, line in rules_over_time(domain.program)]
        place = error.place if error.place in places else places[0] if places else domain.name
        why = error.what if error.place in ("", place) else f"{error.place}: {error.what}"
        hint = "leave it out, or export without it"
        raise DomainError(f"{place}: PDDL cannot express this rule over time: {why}; {hint}") from None


class _Step:
    """The actions of a step; `unknown` collects fluents assumed to be known that an action may leave unknown."""

    def __init__(self, domain: Domain, transition: Transition, unknown: frozenset[clingo.Symbol]) -> None:
        self._domain = domain
        self._terms = transition.actions
        self._preconditions = domain.facts.preconditions
        self._functions = Functions(MOST_NODES)
        self._implied = ImpliedValues(domain.facts, unknown)
        with self._within_limits("a step"):
            self._step = StepFunctions(transition, unknown, self._functions)
        self._propositions = self._step.propositions
        self._numbers = {proposition: number for number, proposition in enumerate(self._propositions)}
        self.unknown: set[clingo.Symbol] = set()

    def ground(self, goal: Mapping[clingo.Symbol, bool], *, whole: bool) -> PlanningTask:
        """Return the planning task, which is valid only if `unknown` remains empty."""
        first = self._step.first
        initial = {self._propositions[number] for number, value in first.items() if value}
        propositions = [*self._propositions]
        with self._within_limits("the goal"):
            demands = [*self._clauses(self._step.refused_at_end())]
            opposed = (self._step.opposed(fluent, OPPOSITE[value]) for fluent, value in goal.items())
            demands += [(self._value(each),) for each in opposed if each is not None]
        goal_values, clauses = self._implied.units(demands)
        end = None
        if whole and clauses:
            end = self._functions.all(map(self._clause, demands))
            goal_values, clauses = {REACHED: True}, ()
            propositions.append(REACHED)
            initial |= {REACHED} if self._functions.where(end, first) == TRUE else set()
        actions = []
        for letter, term in enumerate(self._terms):
            with self._within_limits(str(term)):
                cases = tuple(self._cases(letter, end, whole=whole))
            if cases:
                actions.append(GroundAction(term, cases))
        return PlanningTask(tuple(propositions), frozenset(initial), tuple(actions), goal_values, clauses)

    @contextmanager
    def _within_limits(self, what: str) -> Iterator[None]:
        """Refuse a domain if a part of it depends on the state in too many ways."""
        try:
            yield
        except TooLarge:
            problem = f"{what} depends on the state in more ways than can be written"
            raise DomainError(f"{self._place()}: {problem}; let its rules read fewer fluents at once") from None

    def _place(self) -> str:
        """Return the line of the first rule over time, if any, because it is unknown which rule is responsible."""
        return next((f"{path}:{line}" for path, line in rules_over_time(self._domain.program)), self._domain.name)

    def _cases(self, letter: int, end: Node | None, *, whole: bool) -> Iterator[Case]:
        """Yield the cases of an action, or nothing if it never occurs."""
        tried = self._step.tried(letter)
        if tried is None:
            return
        before, clauses = self._implied.units(self._clauses(tried.refused))
        if () in clauses:
            return
        self.unknown |= self._left_unknown(tried.after, tried.refused)
        fixed = self._implied.fixed(before, self._propositions)
        stated = self._preconditions.get(self._terms[letter], ())
        before = self._implied.needed(before, {(Proposition(fluent), value == "true") for fluent, value in stated})
        changes = [*self._changes(tried.after, fixed)]
        if end is not None:
            states = {number: self._step.becomes(number, tried.after) for number in self._functions.variables([end])}
            reached = self._functions.where(self._functions.composed(end, states), fixed)
            for value, where in ((True, reached), (False, self._functions.opposite(reached))):
                changes.append(((REACHED, value), self._where(where, fixed)))
        changes = [(value, where) for value, where in changes if where != FALSE]
        if whole:
            yield from self._split(str(self._terms[letter]), before, clauses, changes)
            return
        cubes = ((value, cube) for value, where in changes for cube in self._functions.cubes(where))
        yield Case(
            before, clauses, tuple(ConditionalEffect(tuple(map(self._value, cube)), value) for value, cube in cubes)
        )

    def _left_unknown(self, after: After, refused: Iterable[Node]) -> set[clingo.Symbol]:
        """Return the fluents that may be unknown after a step."""
        functions = {number: self._step.undecided(number, after) for number in self._step.changed(after)}
        wrong = {number: where for number, where in functions.items() if where != FALSE}
        if not wrong:
            return set()
        allowed = self._functions.all(map(self._functions.opposite, refused))
        return {
            self._propositions[number].term
            for number, where in wrong.items()
            if self._where(self._functions.choice(where, allowed, FALSE), {}) != FALSE
        }

    def _changes(self, after: After, fixed: Mapping[int, bool]) -> Iterator[Change]:
        """Yield, for each proposition, the states in which it becomes true, and the states in which it becomes false.

        The two sets are disjoint, because planners disagree on contradictory effects.
        """
        functions = self._functions
        for number in self._step.changed(after):
            proposition, own = self._propositions[number], functions.variable(number)
            becomes_true = functions.where(self._step.becomes(number, after), fixed)
            if number in fixed:
                changed = not fixed[number]
                yield (
                    (proposition, changed),
                    self._where(becomes_true if changed else functions.opposite(becomes_true), fixed),
                )
                continue
            was_false, was_true = (functions.where(becomes_true, {number: value}) for value in (False, True))
            gained = self._where(was_false, {**fixed, number: False})
            lost = self._where(functions.opposite(was_true), {**fixed, number: True})
            if functions.choice(gained, lost, FALSE) != FALSE:
                gained, lost = functions.choice(own, FALSE, gained), functions.choice(own, lost, FALSE)
            yield (proposition, True), gained
            yield (proposition, False), lost

    def _split(
        self,
        name: str,
        before: Mapping[Proposition, bool],
        clauses: Iterable[Sequence[Value]],
        changes: Sequence[Change],
    ) -> Iterator[Case]:
        """Yield a case for each combination of truth values of the conditions of an action."""
        functions = self._functions
        may = functions.all(map(self._clause, clauses))
        restricted = [(value, functions.choice(may, where, FALSE)) for value, where in changes]
        read = (may, *(where for _, where in restricted))

        def possible(cube: Cube) -> bool:
            return self._implied.possible([*map(self._value, cube), *before.items()])

        for number, (cube, (occurs, *constants)) in enumerate(functions.cases(read, possible)):
            if number == MOST_CASES:
                problem = f"{name} depends on {len(functions.variables(read))} fluents, which makes more than"
                hint = "let it keep its conditional effects"
                raise DomainError(f"{self._place()}: {problem} {MOST_CASES:,} copies of it; {hint}")
            if occurs == TRUE:
                effects = [
                    value for (value, _), constant in zip(restricted, constants, strict=True) if constant == TRUE
                ]
                case = {**before, **dict(map(self._value, cube))}
                yield Case(case, (), tuple(ConditionalEffect((), each) for each in effects))

    def _where(self, function: Node, fixed: Mapping[int, bool]) -> Node:
        """Restrict a function to the states that are consistent with the given values under the invariants."""
        fixed_values = [*map(self._value, fixed.items())]
        functions = self._functions
        return functions.any(
            functions.all(functions.variable(number, value=value) for number, value in cube)
            for cube in functions.cubes(function)
            if self._implied.possible([*map(self._value, cube), *fixed_values])
        )

    def _clauses(self, refused: Iterable[Node]) -> Iterator[tuple[Value, ...]]:
        """Yield clauses that make all `refused` functions false, except those that the invariants entail."""
        for function in refused:
            for cube in self._functions.cubes(function):
                values = [*map(self._value, cube)]
                if self._implied.possible(values):
                    yield tuple((proposition, not value) for proposition, value in values)

    def _clause(self, clause: Iterable[Value]) -> Node:
        """Return the function of a clause."""
        return self._functions.any(self._functions.variable(self._numbers[each], value=value) for each, value in clause)

    def _value(self, literal: tuple[int, bool]) -> Value:
        return self._propositions[literal[0]], literal[1]
