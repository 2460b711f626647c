"""Choices: shown symbols that answer sets must have or lack, as constraints of the ground program."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import clingo

from prag_asp.errors import QueryError
from prag_asp.logic.ground.rules import Condition, Rule
from prag_asp.models.ground_program import GroundModels
from prag_asp.wording import not_too_deep, unknown

NOT = "not "
"""The beginning of the text of a choice that excludes a symbol."""


@dataclass(frozen=True)
class AtomChoice:
    """A shown symbol that answer sets must have or, if `excluded`, lack; its text is a literal, such as ``not a``."""

    symbol: clingo.Symbol
    excluded: bool = False

    def __str__(self) -> str:
        return f"{NOT if self.excluded else ''}{self.symbol}"


def parse_choice(text: str, known: Collection[clingo.Symbol]) -> AtomChoice:
    """Return the choice that a literal states, such as ``queen(1,2)`` or ``not queen(1,2)``.

    Raises:
        QueryError: the text is not a literal, or no answer set can show its symbol.
    """
    words = " ".join(text.split())
    name = words.removeprefix(NOT)
    try:
        with not_too_deep(text):
            symbol = clingo.parse_term(name, logger=lambda *_: None)
    except RuntimeError:
        raise QueryError(f"{text[:40]!r} is not a literal; write an atom, such as p(1), or not p(1)") from None
    if symbol not in known:
        raise QueryError(unknown(str(symbol), map(str, known), "shown atom"))
    return AtomChoice(symbol, name != words)


def only_chosen(ground: GroundModels, choices: Sequence[AtomChoice], *, project: bool) -> GroundModels:
    """Return a ground program with constraints for choices, which are also added to its control."""
    rules = add_choices(ground.grounder.control, choices, conditions_of_symbols(ground, project=project))
    return replace(ground, rules=(*ground.rules, *rules))


def conditions_of_symbols(ground: GroundModels, *, project: bool) -> Mapping[clingo.Symbol, Sequence[Condition]]:
    """Return the symbols that answer sets may show, with the alternative conditions under which they do.

    With `project`, the atoms of a ``#project`` statement are shown.
    """
    if project and ground.projected is not None:
        return {symbol: ((atom,),) for symbol, atom in ground.names if atom in ground.projected}
    return dict(ground.shown)


def add_choices(
    control: clingo.Control, choices: Sequence[AtomChoice], conditions: Mapping[clingo.Symbol, Sequence[Condition]]
) -> tuple[Rule, ...]:
    """Add the constraints for choices to a control, and return them."""
    with control.backend() as backend:
        rules = tuple(
            rule
            for each in choices
            for rule in rules_of_choice(each, conditions.get(each.symbol, ()), backend.add_atom)
        )
        for rule in rules:
            backend.add_rule(rule.heads, rule.body)
    return rules


def rules_of_choice(choice: AtomChoice, conditions: Sequence[Condition], fresh: Callable[[], int]) -> Iterator[Rule]:
    """Yield rules that exclude the answer sets that violate a choice, without changing the others."""
    if choice.excluded:
        yield from (Rule((), tuple(condition)) for condition in conditions)
        return
    unmet: list[int] = []
    for condition in conditions:
        if not condition:
            return
        literal = condition[0]
        if len(condition) > 1:
            literal = fresh()
            yield Rule((literal,), tuple(condition))
        unmet.append(-literal)
    yield Rule((), tuple(unmet))
