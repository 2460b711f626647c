"""The checks of preconditions, effects, the initial state, invariants and the goal against the declarations."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, field

import clingo
from clingo.ast import ASTType

from prag_asp.lint.rule_origin import Origins, RulePlace
from prag_asp.program.facts import Assignment, Facts, rows, unsorted_rows
from prag_asp.program.predicates import EVER
from prag_asp.program.problem import Problem
from prag_asp.program.syntax import Statement
from prag_asp.wording import did_you_mean

Symbol = clingo.Symbol
Row = tuple[Symbol, ...]
ACTION = ("action", 1)
INVARIANTS = ("exclusive", "implies", "impossible")
ARITIES = {"precondition": 3, "postcondition": 3, "initially": 2, "goal": 2, **dict.fromkeys(INVARIANTS, 2)}
"""The arities of invariants and of predicates that assign values to fluents; with three arguments, the first is an
action."""

BOOLEAN = ("true", "false")
VALUES = {"postcondition": (*BOOLEAN, "unknown")}


def effect_problems(control: clingo.Control, facts: Facts, origins: Origins) -> Iterator[Problem]:
    """Yield atoms with undeclared fluents or actions, with wrong values, or with contradictory values."""
    findings = Findings(origins, facts)
    for predicate in _doubtful(facts):
        rows = unsorted_rows(control, predicate, ARITIES[predicate])
        (findings.named if predicate in INVARIANTS else findings.assigned)(predicate, rows)
    if not findings.any:
        findings.named(EVER.name, unsorted_rows(control, *EVER))
    yield from findings.problems()
    for predicate, values in (("initially", facts.initially), ("goal", facts.goal)):
        first: dict[Symbol, str] = {}
        for fluent, value in values:
            if first.setdefault(fluent, value) == value:
                continue
            places = [origins.place(predicate, fluent, clingo.Function(each)) for each in (first[fluent], value)]
            earlier, later = sorted(places)
            text = f"{predicate} gives {fluent} two values, {first[fluent]} and {value}"
            yield Problem(*later, f"{text} (see {earlier.path.name}:{earlier.line}); keep one")


def action_problems(facts: Facts, statements: Iterable[Statement], origins: Origins) -> Iterator[Problem]:
    """Report a domain without actions: an error if no rule states an action, and a warning if no such rule fires."""
    if facts.actions:
        return
    own = [each for each in statements if each.own]
    is_defined = any(each.kind == ASTType.Defined and (each.node.name, each.node.arity) == ACTION for each in own)
    if is_defined or any(atom.signature == ACTION for each in own for atom in each.heads):
        subject = "no rule states an action, so no plan has a step; change the bodies of its rules"
        yield Problem(*origins.place(ACTION[0]), subject, "no-plan")
    else:
        yield Problem(*origins.place(ACTION[0]), "the domain has no action; state one with action(...)")


def _doubtful(facts: Facts) -> Iterator[str]:
    """Yield the predicates with undeclared terms or wrong values."""
    fluents, actions = set(facts.fluents), set(facts.declared_actions)
    for predicate, table in (("precondition", facts.preconditions), ("postcondition", facts.postconditions)):
        if not actions.issuperset(table) or not all(_right(predicate, each, fluents) for each in table.values()):
            yield predicate
    for predicate, values in (("initially", facts.initially), ("goal", facts.goal)):
        if not _right(predicate, values, fluents):
            yield predicate
    for predicate, pairs in zip(INVARIANTS, (facts.exclusive, facts.implies, facts.impossible), strict=True):
        if not fluents.issuperset(fluent for pair in pairs for fluent in pair):
            yield predicate


def _right(predicate: str, values: Assignment, fluents: Collection[Symbol]) -> bool:
    allowed = VALUES.get(predicate, BOOLEAN)
    return all(value in allowed and fluent in fluents for fluent, value in values)


@dataclass
class _Culprit:
    """An undeclared term or a wrong value: the message, the remedy, and the lines where it occurs."""

    text: str
    hint: str
    places: dict[RulePlace, None] = field(default_factory=dict)


class Findings:
    """The undeclared terms and wrong values, collected so that a mistake in many atoms is reported only once."""

    def __init__(self, origins: Origins, facts: Facts) -> None:
        self._origins = origins
        self._facts = facts
        self._fluents = set(facts.fluents)
        self._actions = set(facts.actions)
        self._culprits: dict[tuple[str, str], _Culprit] = {}

    def assigned(self, predicate: str, rows: Iterable[list[Symbol]]) -> None:
        """Check the rows of a predicate that assigns values, for undeclared actions and fluents and wrong values."""
        fluents, actions, allowed = self._fluents, self._actions, VALUES.get(predicate, BOOLEAN)
        wrong = (
            row
            for row in rows
            if row[-2] not in fluents or str(row[-1]) not in allowed or (len(row) == 3 and row[0] not in actions)
        )
        subject: set[Symbol] = set()
        for *before, fluent, value in sorted(wrong):
            row = (*before, fluent, value)
            if before and before[0] not in actions and before[0] not in subject:
                subject.add(before[0])
                self.undeclared("action", before[0], self._facts.actions, predicate, row)
            if fluent not in fluents:
                self.undeclared("fluent", fluent, self._facts.fluents, predicate, row)
            if str(value) not in allowed:
                hint = f"use {', '.join(allowed[:-1])} or {allowed[-1]}"
                self._add(("value", str(value)), f"{predicate} of {fluent} has the value {value}", hint, predicate, row)

    @property
    def any(self) -> bool:
        """Whether there are any problems."""
        return bool(self._culprits)

    def named(self, predicate: str, rows: Iterable[list[Symbol]]) -> None:
        """Check the rows of a predicate whose arguments are all fluents."""
        for row in sorted(row for row in rows if not self._fluents.issuperset(row)):
            for fluent in row:
                if fluent not in self._fluents:
                    self.undeclared("fluent", fluent, self._facts.fluents, predicate, tuple(row))

    def undeclared(self, kind: str, term: Symbol, declared: Iterable[Symbol], predicate: str, row: Row) -> None:
        """Add a term that is not among the `declared` terms of its kind."""
        same = next((each for each in declared if _name(each) == _name(term)), None)
        if same is not None:
            hint = f"declared terms look like {same}; fix its arguments, or declare {kind}({term})"
        else:
            hint = did_you_mean(_name(term), map(_name, declared), f"declare it with {kind}({term})")
        self._add((kind, _name(term)), f"{predicate} refers to the undeclared {kind} {term}", hint, predicate, row)

    def _add(self, key: tuple[str, str], text: str, hint: str, predicate: str, row: Row) -> None:
        culprit = self._culprits.setdefault(key, _Culprit(text, hint))
        culprit.places.setdefault(self._origins.place(predicate, *row))

    def problems(self) -> Iterator[Problem]:
        """Yield one problem for each undeclared term or wrong value, at its first line."""
        for culprit in self._culprits.values():
            place, *others = culprit.places
            also = f" (also line {', '.join(str(each.line) for each in others)})" if others else ""
            yield Problem(*place, f"{culprit.text}{also}; {culprit.hint}")


def _name(term: Symbol) -> str:
    return term.name if term.type == clingo.SymbolType.Function else str(term)


LIMIT = ("at_most", 2)


def limit_problems(
    control: clingo.Control, facts: Facts, statements: Sequence[Statement], origins: Origins
) -> Iterator[Problem]:
    """Yield limits on unknown actions, limits that are not numbers, and limits that no rule reads."""
    limits = rows(control, *LIMIT)
    names = {action.name for action in facts.actions} if limits else set[str]()
    for name, most in limits:
        place = origins.place("at_most", name, most)
        if str(name) not in names:
            spelled = name.name if name.type == clingo.SymbolType.Function else str(name)
            hint = f"actions are {', '.join(sorted(names))}"
            hint = f"give the name alone, {spelled}" if spelled in names else did_you_mean(spelled, names, hint)
            yield Problem(*place, f"at_most refers to {name}, which is not the name of an action; {hint}")
        elif most.type != clingo.SymbolType.Number or most.number < 0:
            yield Problem(*place, f"{name} cannot occur at most {most} times; write a number, as in at_most({name},2)")
    if limits and not any(atom.signature == LIMIT for each in statements for atom in each.body):
        yield Problem(
            *origins.place("at_most", *limits[0]),
            'at_most has no effect, because no rule reads it; add #include "rules/at_most.lp".',
        )
