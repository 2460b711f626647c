"""What is stated about actions, the start, the invariants and the goal, checked against what is declared."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

import clingo

from prag_asp.lint.origin import Origins, Place
from prag_asp.program.facts import Facts, rows
from prag_asp.program.problem import Problem
from prag_asp.program.syntax import Statement
from prag_asp.wording import did_you_mean

Symbol = clingo.Symbol
Row = tuple[Symbol, ...]
BOOLEAN = ("true", "false")
VALUES = {"postcondition": (*BOOLEAN, "unknown")}


def effect_problems(facts: Facts, origins: Origins) -> Iterator[Problem]:
    """Yield what speaks of undeclared fluents or actions, has a wrong value, or has two values at once."""
    if not facts.actions:
        yield Problem(*origins.place("action"), "the domain has no action; state one with action(...)")
    findings = Findings(origins, facts)
    for predicate, table in (("precondition", facts.preconditions), ("postcondition", facts.postconditions)):
        findings.undeclared_actions(predicate, table)
        for action, values in table.items():
            findings.assigned(predicate, values, (action,))
    findings.assigned("initially", facts.initially)
    findings.assigned("goal", facts.goal)
    for predicate, pairs in _pairs(facts).items():
        for pair in pairs:
            for fluent in pair:
                findings.declared(fluent, predicate, pair)
    yield from findings.problems()
    yield from _doubled(facts, origins)


def _pairs(facts: Facts) -> dict[str, tuple[Row, ...]]:
    return {"exclusive": facts.exclusive, "implies": facts.implies, "impossible": facts.impossible}


@dataclass
class _Culprit:
    """Something undeclared, the first place that speaks of it, and how it is spelled there."""

    text: str
    hint: str
    places: dict[Place, None] = field(default_factory=dict)


class Findings:
    """Collects what is undeclared, so that one mistake is reported once however many atoms follow from it."""

    def __init__(self, origins: Origins, facts: Facts) -> None:
        self._origins = origins
        self._facts = facts
        self._fluents = set(facts.fluents)
        self._actions = set(facts.actions)
        self._culprits: dict[tuple[str, str], _Culprit] = {}

    def undeclared_actions(self, predicate: str, table: Iterable[Symbol]) -> None:
        """Find the actions of a table that are not declared."""
        rows = {"precondition": self._facts.preconditions, "postcondition": self._facts.postconditions}[predicate]
        for action in table:
            if action not in self._actions:
                fluent, value = rows[action][0]
                row = (action, fluent, clingo.parse_term(value))
                self.undeclared("action", action, self._facts.actions, predicate, row)

    def assigned(self, predicate: str, values: Iterable[tuple[Symbol, str]], before: Row = ()) -> None:
        """Find the fluents that are not declared, and the values that are none."""
        for fluent, value in values:
            if fluent not in self._fluents:
                self.declared(fluent, predicate, (*before, fluent, clingo.parse_term(value)))
            allowed = VALUES.get(predicate, BOOLEAN)
            if value not in allowed:
                row = (*before, fluent, clingo.parse_term(value))
                hint = f"use {', '.join(allowed[:-1])} or {allowed[-1]}"
                self._add(("value", value), f"{predicate} of {fluent} has the value {value}", hint, predicate, row)

    def declared(self, fluent: Symbol, predicate: str, row: Row) -> None:
        """Find a fluent that is not declared."""
        if fluent not in self._fluents:
            self.undeclared("fluent", fluent, self._facts.fluents, predicate, row)

    def undeclared(self, kind: str, term: Symbol, known: Iterable[Symbol], predicate: str, row: Row) -> None:
        """Report a term that is not among the `known` ones of its kind."""
        same = next((each for each in known if _name(each) == _name(term)), None)
        if same is not None:
            hint = f"declared are such as {same}; mend its arguments, or declare {kind}({term})"
        else:
            hint = did_you_mean(_name(term), map(_name, known), f"declare it with {kind}({term})")
        self._add((kind, _name(term)), f"{predicate} speaks of the undeclared {kind} {term}", hint, predicate, row)

    def _add(self, key: tuple[str, str], text: str, hint: str, predicate: str, row: Row) -> None:
        culprit = self._culprits.setdefault(key, _Culprit(text, hint))
        culprit.places.setdefault(self._origins.place(predicate, *row))

    def problems(self) -> Iterator[Problem]:
        """Yield one problem for each culprit, at the first place that speaks of it."""
        for culprit in self._culprits.values():
            place, *others = culprit.places
            also = f" (also line {', '.join(str(each.line) for each in others)})" if others else ""
            yield Problem(*place, f"{culprit.text}{also}; {culprit.hint}")


def _name(term: Symbol) -> str:
    return term.name if term.type == clingo.SymbolType.Function else str(term)


def _doubled(facts: Facts, origins: Origins) -> Iterator[Problem]:
    """Yield the fluents with two initial values or two goals."""
    for predicate, values in (("initially", facts.initially), ("goal", facts.goal)):
        first: dict[Symbol, str] = {}
        for fluent, value in values:
            if first.setdefault(fluent, value) == value:
                continue
            places = [origins.place(predicate, fluent, clingo.Function(each)) for each in (first[fluent], value)]
            earlier, later = sorted(places)
            yield Problem(
                *later,
                f"{predicate} gives {fluent} two values, {first[fluent]} and {value} "
                f"(see {earlier.path.name}:{earlier.line}); keep one",
            )


LIMIT = ("at_most", 2)


def limit_problems(
    control: clingo.Control, facts: Facts, statements: Sequence[Statement], origins: Origins
) -> Iterator[Problem]:
    """Yield the limits of unknown actions, those that are no number, and those that no rule reads."""
    names = {action.name for action in facts.actions}
    limits = rows(control, *LIMIT)
    for name, most in limits:
        place = origins.place("at_most", name, most)
        if str(name) not in names:
            spelled = name.name if name.type == clingo.SymbolType.Function else str(name)
            hint = f"actions are {', '.join(sorted(names))}"
            hint = f"give the name alone, {spelled}" if spelled in names else did_you_mean(spelled, names, hint)
            yield Problem(*place, f"at_most speaks of {name}, which is not the name of an action; {hint}")
        elif most.type != clingo.SymbolType.Number or most.number < 0:
            yield Problem(*place, f"{name} cannot occur at most {most} times; write a number, as in at_most({name},2)")
    if limits and not any(atom.signature == LIMIT for each in statements for atom in each.body):
        yield Problem(
            *origins.place("at_most", *limits[0]),
            'at_most has no effect, for no rule reads it; add #include "rules/at_most.lp".',
        )
