"""The writer of a domain, or of one of its tasks, as a PDDL domain and problem.

Actions with the same name that differ only in their arguments become one action with parameters, with a predicate for
its valid arguments; other actions are written without parameters.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain

import clingo

from prag_asp.atom import symbol_of
from prag_asp.domain.load import Domain
from prag_asp.errors import DomainError
from prag_asp.planners.ground_action import GroundAction, PlanningTask, Proposition, Value
from prag_asp.planners.grounding import (
    broken_invariant,
    ground_plain,
    known_values,
    outcomes_of,
    rules_over_time,
    values_of,
)
from prag_asp.planners.lifted_actions import Clause, Instance, Literal, PddlCase, group_alike, lift, variable
from prag_asp.planners.pddl_text import Spelling, all_of, as_text, effects, mirror
from prag_asp.program.facts import Facts
from prag_asp.task import Task
from prag_asp.wording import plural


@dataclass(frozen=True)
class PddlExport:
    """The texts of a domain and a problem and, if there is a task, the steps of its plan.

    `fluents` maps atoms in PDDL, such as ``on a b``, to the fluents of the domain; PDDL may need further atoms.
    """

    domain: str
    problem: str
    plan: tuple[str, ...]
    fluents: Mapping[str, clingo.Symbol]


@dataclass(frozen=True)
class _Schema:
    """An action schema: parameters and a case; `allowed` is the predicate of its possible arguments, or ""."""

    name: str
    variables: tuple[str, ...]
    case: PddlCase
    allowed: str = ""


def write(domain: Domain, task: Task | None = None, *, negative: bool = True, conditional: bool = True) -> PddlExport:
    """Write a domain or a task as PDDL; the goal for a task is the known part of its final state.

    Fluents that are unknown in the initial state of a task are false in PDDL. Without rules over time, an unknown
    effect has the value that the task needs, and is false in all other actions, so that the PDDL plans are the plans of
    the domain that agree with these values. Comments in the problem state both.

    Rules over time become preconditions and conditional effects. Without `conditional`, there are no conditional
    effects and no disjunctions: an action has a copy for each combination of its conditions, so that plans keep their
    lengths and their number (Nebel 2000). Without `negative`, preconditions and goals are positive: a separate
    predicate stands for each negation.

    Raises:
        DomainError: the domain cannot be expressed in PDDL, its initial state breaks an invariant, its world is
            open and no task is given, or an action has too many copies.
    """
    name, facts = domain.name, domain.facts
    if task is None and not facts.closed:
        problem = "its world is open, so it has no initial state that PDDL can express"
        hint = "add --rule closed_world, state one with initially(...), or export a task"
        raise DomainError(f"{name}: {problem}; {hint}")
    stated = known_values(facts.initially) if task is None else values_of(task.initial)
    if broken_invariant(facts, stated):
        raise DomainError(f"{name}: its initial state breaks an invariant, so there is no plan; change either")
    last = None if task is None else values_of(task.states[-1] if task.states else task.initial)
    rule = next(rules_over_time(domain.program), None)
    if rule is None and not facts.composites:
        goal = known_values(facts.goal) if last is None else last
        ground = ground_plain(facts, stated, goal, None if task is None else outcomes_of(task, facts))
        open_effects = any(value == "unknown" for values in facts.postconditions.values() for _, value in values)
    else:
        from prag_asp.planners.over_time import ground_over_time

        ground, open_effects = ground_over_time(domain, stated, last, whole=not conditional), False
    comment, left_open = "", len(facts.fluents) - len(stated)
    if left_open:
        is_false = "is" if left_open == 1 else "are"
        comment = f"; {plural(left_open, 'fluent')} that the task leaves open {is_false} false here.\n"
    if open_effects:
        comment += "; Effects that the domain leaves open are what the task needs, and false otherwise.\n"
    return _PddlWriter(name, facts, ground, negative).write(task, comment)


class _PddlWriter:
    """The PDDL names of a domain, and the texts that use them."""

    def __init__(self, name: str, facts: Facts, ground: PlanningTask, negative: bool) -> None:
        self._ground = ground
        self._negative = negative
        self._spelling = Spelling()
        self._name = Spelling().name(name, name)
        for fluent in facts.fluents:
            self._predicate(Proposition(fluent))
        self._entities = [self._object(entity) for entity in facts.entities]
        self._terms = {self._object(term): None for fluent in facts.fluents for term in fluent.arguments}
        self._positive = {proposition: self._literal(proposition, True) for proposition in ground.propositions}
        self._terms.update((term, None) for _, terms, _ in self._positive.values() for term in terms)
        self._allowed: list[Literal] = []
        self._steps: dict[clingo.Symbol, tuple[str, ...]] = {}
        by_name: dict[tuple[str, int], list[GroundAction]] = {}
        for action in ground.actions:
            by_name.setdefault((action.term.name, len(action.term.arguments)), []).append(action)
        self._schemas = [schema for key, actions in by_name.items() for schema in self._schemas_of(key, actions)]

    def write(self, task: Task | None, comment: str) -> PddlExport:
        """Return the texts for the whole domain, or for a task."""
        goal, clauses = self._literals(self._ground.goal.items()), self._clauses(self._ground.clauses)
        conditions = chain(goal, *clauses, *(schema.case.conditions for schema in self._schemas))
        negated = [] if self._negative else [name for name, _, value in conditions if not value]
        opposites = {name: self._spelling.name(("opposite", name), f"not-{name}") for name in negated}
        first = [(*literal[:2], proposition in self._ground.initial) for proposition, literal in self._positive.items()]
        initial = [literal for literal in (*first, *mirror(first, opposites)) if literal[2]]
        plan = () if task is None else tuple(self._plan(map(symbol_of, task.actions)))
        others = [name for name in self._entities if name not in self._terms]
        lines = [
            f"(define (problem {self._name}-task)",
            f"  (:domain {self._name})",
            *([f"  (:objects {' '.join(others)})"] if others else []),
            "  (:init",
            *(f"   {as_text([each])}" for each in (*initial, *self._allowed)),
            "  )",
            f"  (:goal (and{all_of(goal, clauses, opposites)}))",
            ")",
        ]
        fluents = {
            " ".join((name, *terms)): each.term for each, (name, terms, _) in self._positive.items() if not each.role
        }
        return PddlExport(self._domain(opposites), comment + "\n".join(lines) + "\n", plan, fluents)

    def _plan(self, actions: Iterable[clingo.Symbol]) -> Iterator[str]:
        """Yield the steps of a plan, choosing for each action the case whose precondition holds."""
        state = set(self._ground.initial)

        def so(value: Value) -> bool:
            return (value[0] in state) == value[1]

        cases = {action.term: action.cases for action in self._ground.actions}
        for action in actions:
            number = 0
            if len(cases[action]) > 1:
                number = next(
                    number
                    for number, case in enumerate(cases[action])
                    if all(map(so, case.precondition.items())) and all(any(map(so, each)) for each in case.clauses)
                )
            effects = cases[action][number].effects
            values = [effect.value for effect in effects if all(map(so, effect.condition))]
            state -= {each for each, _ in values}
            state |= {each for each, value in values if value}
            yield self._steps[action][number]

    def _object(self, term: clingo.Symbol) -> str:
        return self._spelling.name(("object", term), str(term))

    def _predicate(self, proposition: Proposition) -> str:
        term, role = proposition
        text = f"{role}-{term.name.lstrip('_')}" if role else term.name
        return self._spelling.name(("predicate", role, term.name, len(term.arguments)), text)

    def _literal(self, proposition: Proposition, value: bool) -> Literal:
        return self._predicate(proposition), tuple(map(self._object, proposition.term.arguments)), value

    def _literals(self, values: Iterable[Value]) -> Clause:
        return tuple(sorted(self._literal(*each) for each in values))

    def _clauses(self, clauses: Iterable[Sequence[Value]]) -> tuple[Clause, ...]:
        return tuple(sorted(map(self._literals, clauses)))

    def _schemas_of(self, key: tuple[str, int], actions: Sequence[GroundAction]) -> Iterator[_Schema]:
        """Yield the schemas for the actions with a given name; actions with a common schema share it."""
        instances = []
        for action in actions:
            arguments = tuple(map(self._object, action.term.arguments))
            self._terms.update(dict.fromkeys(arguments))
            renamed = []
            for case in action.cases:
                after = sorted((self._literals(each.condition), self._literal(*each.value)) for each in case.effects)
                before = self._literals(case.precondition.items())
                renamed.append(PddlCase(before, self._clauses(case.clauses), tuple(after)))
            instances.append(Instance(action.term, arguments, tuple(renamed)))
        groups = group_alike(instances)
        for number, group in enumerate(groups):
            cases = lift(group)
            if cases is None or not key[1] or (len(group) == 1 < len(groups)):
                for term, _, own in group:
                    names = self._action_names((term,), str(term), own)
                    self._steps[term] = tuple(f"({name})" for name in names)
                    yield from (_Schema(name, (), case) for name, case in zip(names, own, strict=True))
                continue
            allowed = self._spelling.name(("can", *key, number), f"can-{key[0]}")
            variables = tuple(map(variable, range(len(group[0].arguments))))
            names = self._action_names((*key, number), key[0], cases)
            for term, arguments, own in group:
                self._allowed.append((allowed, arguments, True))
                values = dict(zip(variables, arguments, strict=True))
                which_of = {case.rename(values).key: name for case, name in zip(cases, names, strict=True)}
                self._steps[term] = tuple(f"({' '.join([which_of[c.key], *arguments])})" for c in own)
            yield from (_Schema(name, variables, case, allowed) for name, case in zip(names, cases, strict=True))

    def _action_names(self, key: tuple[Hashable, ...], text: str, cases: Sequence[PddlCase]) -> list[str]:
        """Return the names for the cases of an action, numbered if there are several."""
        texts = [text] if len(cases) == 1 else [f"{text}-{number + 1}" for number in range(len(cases))]
        return [self._spelling.name(("action", *key, number), each) for number, each in enumerate(texts)]

    def _domain(self, opposites: Mapping[str, str]) -> str:
        """Return the text of the domain."""
        predicates = {name: len(terms) for name, terms, _ in self._positive.values()}
        own = {opposites[name]: arity for name, arity in predicates.items() if name in opposites}
        allowed = {schema.allowed: len(schema.variables) for schema in self._schemas if schema.allowed}
        cases = [schema.case for schema in self._schemas]
        disjunctive = bool(self._ground.clauses) or any(case.clauses for case in cases)
        needed = {
            ":strips": True,
            ":negative-preconditions": self._negative,
            ":disjunctive-preconditions": disjunctive,
            ":conditional-effects": any(where for case in cases for where, _ in case.effects),
        }
        lines = [
            f"(define (domain {self._name})",
            f"  (:requirements {' '.join(name for name, used in needed.items() if used)})",
            *([f"  (:constants {' '.join(self._terms)})"] if self._terms else []),
            "  (:predicates",
            *(
                f"    ({' '.join([name, *map(variable, range(arity))])})"
                for name, arity in {**predicates, **own, **allowed}.items()
            ),
            "  )",
        ]
        for schema in self._schemas:
            case = schema.case
            before = [f" ({' '.join([schema.allowed, *schema.variables])})"] if schema.allowed else []
            before.append(all_of(case.precondition, case.clauses, opposites))
            lines += ["", f"  (:action {schema.name}", f"    :parameters ({' '.join(schema.variables)})"]
            lines += [f"    :precondition (and{''.join(before)})", f"    :effect (and{effects(case, opposites)}))"]
        return "\n".join([*lines, ")"]) + "\n"
