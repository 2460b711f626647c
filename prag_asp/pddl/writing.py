"""Write a domain, or one task of it, as a domain and a problem of PDDL.

Actions of one name whose conditions and effects are the same up to their arguments become one action with parameters,
and a predicate says of which objects there is one; others are written one by one, without parameters.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import clingo

from prag_asp.atom import symbol_of
from prag_asp.errors import DomainError
from prag_asp.pddl.ground import GroundAction, Outcomes, broken_invariant, ground_actions
from prag_asp.pddl.pairs import Values
from prag_asp.pddl.spelling import Spelling
from prag_asp.program.facts import Facts
from prag_asp.program.sources import Program
from prag_asp.task import Task
from prag_asp.wording import plural

Literal = tuple[str, tuple[str, ...], bool]
"""A predicate, its terms, and whether it is asserted; a term is the name of an object or a variable."""


@dataclass(frozen=True)
class Exported:
    """The texts of a domain and of a problem, and the steps of the task's plan, if there is one."""

    domain: str
    problem: str
    plan: tuple[str, ...]


@dataclass(frozen=True)
class _Schema:
    """An action as it is written: variables, conditions and effects; `allowed` says of which objects there is one."""

    name: str
    variables: tuple[str, ...]
    before: tuple[Literal, ...]
    after: tuple[Literal, ...]
    allowed: str = ""


def write(name: str, program: Program, facts: Facts, task: Task | None = None, *, negative: bool = True) -> Exported:
    """Write a domain as PDDL, or one task of it: its initial state, and as its goal what is known of its last state.

    What a task leaves open of its initial state is false in PDDL. An effect that is unknown is what the task needs it
    to be, and false in all other actions: of the plans of the domain, PDDL has those for which that is so. Comments of
    the problem say both. Without `negative`, no condition and no goal is negative: a predicate of its own says what is
    not so.

    Raises:
        DomainError: the domain says what PDDL cannot, its first state breaks an invariant, or it is an open world and
            no task is given.
    """
    if task is None and not facts.closed:
        told = "its world is open, so it has no first state that PDDL can say; state one"
        raise DomainError(f"{name}: {told} with initially(...), or export a task")
    stated = _known(facts.initially) if task is None else _values(task.initial.items())
    if broken_invariant(facts, stated):
        raise DomainError(f"{name}: its first state breaks an invariant, so there is no plan; change either")
    actions = ground_actions(name, program, facts, stated, None if task is None else _outcomes(task, facts))
    return _Writer(name, facts, actions, negative).written(task, stated)


def _outcomes(task: Task, facts: Facts) -> Outcomes:
    """Return what the actions of a task make of fluents that they may change, where that is known.

    Raises:
        DomainError: an action occurs twice, and has to make something else of a fluent each time.
    """
    found: dict[tuple[clingo.Symbol, clingo.Symbol], bool] = {}
    for atom, state in zip(task.actions, task.states, strict=True):
        action, known = symbol_of(atom), _values(state.items())
        for fluent, value in facts.postconditions.get(action, ()):
            if value != "unknown" or fluent not in known:
                continue
            if found.setdefault((action, fluent), known[fluent]) != known[fluent]:
                told = f"{action} occurs twice, and {fluent} is true after one and false after the other"
                raise DomainError(f"{told}, which PDDL cannot say; choose another task")
    return found


class _Writer:
    """Names of PDDL for all that a domain has, and the texts that use them."""

    def __init__(self, name: str, facts: Facts, actions: Sequence[GroundAction], negative: bool) -> None:
        self._facts = facts
        self._negative = negative
        self._spelling = Spelling()
        self._name = Spelling().name(name, name)
        for fluent in facts.fluents:
            self._predicate(fluent)
        self._entities = [self._object(entity) for entity in facts.entities]
        self._terms = {self._object(term): None for fluent in facts.fluents for term in fluent.arguments}
        self._fluents = {fluent: self._literal(fluent, True) for fluent in facts.fluents}
        self._allowed: list[Literal] = []
        self._steps: dict[clingo.Symbol, str] = {}
        by_name: dict[tuple[str, int], list[GroundAction]] = {}
        for action in actions:
            by_name.setdefault((action.term.name, len(action.term.arguments)), []).append(action)
        self._schemas = [schema for key, found in by_name.items() for schema in self._schemas_of(key, found)]

    def written(self, task: Task | None, stated: Values) -> Exported:
        """Return the texts for the whole domain, or for a task, and for what is stated of the first state."""
        last = (task.states[-1] if task.states else task.initial) if task is not None else {}
        goal = _known(self._facts.goal) if task is None else _values(last.items())
        left = len(self._facts.fluents) - len(stated)
        true = [fluent for fluent in self._facts.fluents if stated.get(fluent)]
        wanted = [self._literal(fluent, value) for fluent, value in goal.items()]
        flipped = set() if self._negative else {each[0] for each in self._conditions(wanted) if not each[2]}
        initial = [self._fluents[fluent] for fluent in true]
        initial += [
            (_opposite(each[0]), each[1], True)
            for fluent, each in self._fluents.items()
            if each[0] in flipped and not stated.get(fluent)
        ]
        told = f"; {plural(left, 'fluent')} that the task leaves open {'is' if left == 1 else 'are'} false here.\n"
        comment = told if left else ""
        if any(value == "unknown" for values in self._facts.postconditions.values() for _, value in values):
            comment += "; Effects that the domain leaves open are what the task needs, and false otherwise.\n"
        steps = tuple(self._steps[symbol_of(action)] for action in task.actions) if task is not None else ()
        wanted = [_positive(each, flipped) for each in wanted]
        problem = self._problem([*initial, *self._allowed], wanted, comment)
        return Exported(self._domain(flipped), problem, steps)

    def _conditions(self, goal: Iterable[Literal]) -> Iterator[Literal]:
        yield from goal
        for schema in self._schemas:
            yield from schema.before

    def _object(self, term: clingo.Symbol) -> str:
        return self._spelling.name(("object", term), str(term))

    def _predicate(self, fluent: clingo.Symbol) -> str:
        return self._spelling.name(("predicate", fluent.name, len(fluent.arguments)), fluent.name)

    def _literal(self, fluent: clingo.Symbol, value: bool) -> Literal:
        return self._predicate(fluent), tuple(map(self._object, fluent.arguments)), value

    def _schemas_of(self, key: tuple[str, int], actions: Sequence[GroundAction]) -> Iterator[_Schema]:
        """Yield the actions of a name: one with parameters, if all of them are like it."""
        ground = [
            (tuple(map(self._object, each.term.arguments)), self._literals(each.before), self._literals(each.after))
            for each in actions
        ]
        for arguments, *_ in ground:
            self._terms.update(dict.fromkeys(arguments))
        lifted = _lifted(key[1], ground)
        if lifted is not None and key[1]:
            name = self._spelling.name(("action", *key), key[0])
            allowed = self._spelling.name(("can", *key), f"can-{key[0]}")
            for action, (arguments, *_) in zip(actions, ground, strict=True):
                self._allowed.append((allowed, arguments, True))
                self._steps[action.term] = f"({' '.join([name, *arguments])})"
            yield _Schema(name, tuple(_variable(number) for number in range(key[1])), *lifted, allowed)
            return
        for action, (_, before, after) in zip(actions, ground, strict=True):
            name = self._spelling.name(("action", action.term), str(action.term))
            self._steps[action.term] = f"({name})"
            yield _Schema(name, (), before, after)

    def _literals(self, values: Values) -> tuple[Literal, ...]:
        return tuple(sorted(self._literal(fluent, value) for fluent, value in values.items()))

    def _domain(self, flipped: set[str]) -> str:
        """Return the text of the domain."""
        predicates = {each[0]: len(each[1]) for each in self._fluents.values()}
        opposites = {_opposite(name): arity for name, arity in predicates.items() if name in flipped}
        allowed = {schema.allowed: len(schema.variables) for schema in self._schemas if schema.allowed}
        lines = [
            f"(define (domain {self._name})",
            f"  (:requirements :strips{' :negative-preconditions' if self._negative else ''})",
            *([f"  (:constants {' '.join(self._terms)})"] if self._terms else []),
            "  (:predicates",
            *(
                f"    ({' '.join([name, *map(_variable, range(arity))])})"
                for name, arity in {**predicates, **opposites, **allowed}.items()
            ),
            "  )",
        ]
        for schema in self._schemas:
            before = [_positive(each, flipped) for each in schema.before]
            before = [*([(schema.allowed, schema.variables, True)] if schema.allowed else []), *before]
            after = [*schema.after]
            after += [(_opposite(each[0]), each[1], not each[2]) for each in schema.after if each[0] in flipped]
            lines += ["", f"  (:action {schema.name}", f"    :parameters ({' '.join(schema.variables)})"]
            lines += [f"    :precondition (and{_told(before)})", f"    :effect (and{_told(after)}))"]
        return "\n".join([*lines, ")"]) + "\n"

    def _problem(self, initial: Iterable[Literal], goal: Iterable[Literal], comment: str) -> str:
        """Return the text of the problem."""
        others = [name for name in self._entities if name not in self._terms]
        lines = [
            f"(define (problem {self._name}-task)",
            f"  (:domain {self._name})",
            *([f"  (:objects {' '.join(others)})"] if others else []),
            "  (:init",
            *(f"   {_told([each])}" for each in initial),
            "  )",
            f"  (:goal (and{_told(goal)}))",
        ]
        return comment + "\n".join([*lines, ")"]) + "\n"


def _lifted(
    arity: int, ground: Sequence[tuple[tuple[str, ...], tuple[Literal, ...], tuple[Literal, ...]]]
) -> tuple[tuple[Literal, ...], tuple[Literal, ...]] | None:
    """Return conditions and effects with variables that all of some actions have, None where there are none."""
    model = next((each for each in ground if len(set(each[0])) == arity), None)
    if model is None:
        return None
    names = {argument: _variable(number) for number, argument in enumerate(model[0])}
    before, after = (_with(literals, names) for literals in model[1:])
    for arguments, *parts in ground:
        values = {_variable(number): argument for number, argument in enumerate(arguments)}
        made = [_with(literals, values) for literals in (before, after)]
        if [set(each) for each in made] != [set(each) for each in parts] or len(set(made[1])) < len(made[1]):
            return None
    return before, after


def _with(literals: Iterable[Literal], names: dict[str, str]) -> tuple[Literal, ...]:
    return tuple((name, tuple(names.get(term, term) for term in terms), value) for name, terms, value in literals)


def _variable(number: int) -> str:
    return f"?x{number + 1}"


def _opposite(predicate: str) -> str:
    return f"not-{predicate}"


def _positive(literal: Literal, flipped: set[str]) -> Literal:
    """Return a literal whose negation has a predicate of its own as that predicate."""
    name, terms, value = literal
    return literal if value or name not in flipped else (_opposite(name), terms, True)


def _told(literals: Iterable[Literal]) -> str:
    """Return literals as a text of PDDL, each after a blank."""
    texts = (
        f"({' '.join([name, *terms])})" if value else f"(not ({' '.join([name, *terms])}))"
        for name, terms, value in literals
    )
    return "".join(f" {text}" for text in texts)


def _known(values: Iterable[tuple[clingo.Symbol, str]]) -> dict[clingo.Symbol, bool]:
    return {fluent: value == "true" for fluent, value in values}


def _values(values: Iterable[tuple[object, bool]]) -> dict[clingo.Symbol, bool]:
    return {symbol_of(str(fluent)): value for fluent, value in values}
