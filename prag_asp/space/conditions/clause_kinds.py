"""The kinds of conditions, and the facts by which each asks the encodings in ``encodings/conditions``."""

from __future__ import annotations

import random
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Protocol

import clingo

from prag_asp.errors import QueryError
from prag_asp.program.entity_names import action_name, mentioned_entities, no_action
from prag_asp.program.facts import Facts
from prag_asp.space.conditions.patterns import ANY, Pattern, class_members
from prag_asp.space.conditions.regular import Recogniser, parse_expression, recogniser
from prag_asp.space.conditions.state_formula import parse_conjunction, parse_formula
from prag_asp.wording import not_too_deep


class Clause(Protocol):
    """One condition; as text, it is the words that a user writes for it.

    `file` names the encoding that tests it.
    """

    file: ClassVar[str]

    def requests(self, number: int, facts: Facts) -> Iterator[str]:
        """Yield what the encoding is asked, as terms; `number` tells this condition from others.

        Raises:
            QueryError: it speaks of something that the domain does not have.
        """
        ...


@dataclass(frozen=True)
class Begins:
    """The first actions are these, or actions of these names."""

    prefix: tuple[str, ...]
    file: ClassVar[str] = "begins"

    def __str__(self) -> str:
        return f"begins {', '.join(self.prefix)}"

    def requests(self, number: int, facts: Facts) -> Iterator[str]:
        """Yield what the encoding is asked."""
        for step, item in enumerate(self.prefix):
            yield f"begins({number},{step})"
            yield f"instant({step + 1})"
            for action in Pattern.parse(item).matches(facts):
                yield f"fits({number},{step},{action})"


def fewest_actions(clause: Clause) -> int:
    """Return how many actions a plan has at least that satisfies a clause, as far as the clause itself says so."""
    if isinstance(clause, After):
        return clause.steps
    if isinstance(clause, Begins):
        return len(clause.prefix)
    if isinstance(clause, Achieves):
        return 1
    return clause.times.low if isinstance(clause, Has) else 0


@dataclass(frozen=True)
class Range:
    """A number from `low` to `high`; without `high`, there is no upper bound."""

    low: int = 0
    high: int | None = None

    def __str__(self) -> str:
        if self.low == self.high:
            return f"exactly {self.low}"
        return f"at least {self.low}" if self.high is None else f"at most {self.high}"


@dataclass(frozen=True)
class Has:
    """Actions that fit a pattern, or pairs of consecutive names, occur so often."""

    pattern: str
    times: Range
    file: ClassVar[str] = "has"

    def __str__(self) -> str:
        return f"has {self.times} {self.pattern}"

    def requests(self, number: int, facts: Facts) -> Iterator[str]:
        """Yield what the encoding is asked."""
        first, arrow, second = (part.strip() for part in self.pattern.partition(">"))
        if arrow:
            known = {action_name(action) for action in facts.actions}
            for name in (first, second):
                if name not in known:
                    raise QueryError(no_action(name, known, facts))
            yield from _counted(str(number), self.times, [f"{first},{second}"])
        else:
            actions = Pattern.parse(self.pattern).matches(facts)
            # Several patterns may fit one action alone, and say the same then.
            pattern = str(actions[0]) if len(actions) == 1 else self.pattern
            which = _named_by_all(actions, facts) or _told_of(pattern, number)
            yield from _counted(which, self.times, actions)


@dataclass(frozen=True)
class Uses:
    """The actions name so many entities that are this one or belong to this class."""

    kind: str
    number: Range
    file: ClassVar[str] = "uses"

    def __str__(self) -> str:
        return f"uses {self.number} {self.kind}"

    def requests(self, number: int, facts: Facts) -> Iterator[str]:
        """Yield what the encoding is asked."""
        yield from _bounds(number, self.number, "fewest", "greatest")
        for entity in class_members(self.kind, facts):
            yield f"uses({number},{entity})"


@dataclass(frozen=True)
class Names:
    """Some action names an entity of this kind, or none does: as `Uses`, with a smaller state."""

    kind: str
    some: bool
    file: ClassVar[str] = "has"

    def __str__(self) -> str:
        return f"{'uses' if self.some else 'avoids'} {self.kind}"

    def requests(self, number: int, facts: Facts) -> Iterator[str]:
        """Yield what the encoding is asked."""
        actions = self.actions(facts)
        which = _named_by_all(actions, facts) or str(number)
        yield from _counted(which, Range(1) if self.some else Range(0, 0), actions)

    def actions(self, facts: Facts) -> tuple[clingo.Symbol, ...]:
        """Return the actions that name an entity of this kind."""
        members = set(class_members(self.kind, facts))
        return tuple(action for action in facts.actions if any(mentioned_entities(action, members)))


@dataclass(frozen=True)
class Matches:
    """The names of the actions make a word of a regular expression, or, inverse, do not."""

    expression: str
    inverse: bool = False
    file: ClassVar[str] = "matches"

    def __str__(self) -> str:
        return f"{'not ' if self.inverse else ''}matches {self.expression}"

    def requests(self, number: int, facts: Facts) -> Iterator[str]:
        """Yield what the encoding is asked."""
        names = {action_name(action) for action in facts.actions}
        with not_too_deep(self.expression):
            found = recogniser(parse_expression(self.expression, names), names, inverse=self.inverse)
        yield from asked_language(number, found)


@dataclass(frozen=True)
class Part:
    """The skeleton belongs to one part of all skeletons, divided evenly by a random automaton.

    Each name permutes the numbers below `modulus`, drawn from `seed`; a skeleton belongs where its names send 0.
    """

    residues: tuple[int, ...]
    modulus: int
    seed: int
    file: ClassVar[str] = "matches"

    def __str__(self) -> str:
        return f"part {_intervals(self.residues)} of {self.modulus} by seed {self.seed}"

    def requests(self, number: int, facts: Facts) -> Iterator[str]:
        """Yield what the encoding is asked."""
        rows: list[dict[str, int]] = [{} for _ in range(self.modulus)]
        for name in sorted({action_name(action) for action in facts.actions}):
            numbers = list(range(self.modulus))
            random.Random(f"{self.seed} {name}").shuffle(numbers)
            for state, target in enumerate(numbers):
                rows[state][name] = target
        yield from asked_language(number, Recogniser(rows, frozenset(self.residues)))


@dataclass(frozen=True)
class After:
    """After so many actions, fluents have these values, learned where they are unknown; after 0, at the start."""

    steps: int
    formula: str
    file: ClassVar[str] = "after"

    def __str__(self) -> str:
        return f"after {self.steps}: {self.formula}" if self.steps else f"starts {self.formula}"

    def requests(self, number: int, facts: Facts) -> Iterator[str]:
        """Yield what the encoding is asked."""
        if self.steps:
            yield f"instant(1..{self.steps})"
        for fluent, value in self.conjunction(facts).items():
            yield f"after({self.steps},{fluent},{_spelled(value)})"

    def conjunction(self, facts: Facts) -> Mapping[str, bool]:
        """Return the values that the fluents have."""
        return parse_conjunction(self.formula, map(str, facts.fluents))


@dataclass(frozen=True)
class Ends:
    """The final state satisfies a formula, together with the goal of the domain."""

    formula: str
    file: ClassVar[str] = "ends"

    def __str__(self) -> str:
        return f"ends {self.formula}"

    def requests(self, number: int, facts: Facts) -> Iterator[str]:
        """Yield what the encoding is asked."""
        yield from asked_end(number, self.conjunctions(facts))

    def conjunctions(self, facts: Facts) -> Sequence[Mapping[str, bool]]:
        """Return the conjunctions, one of which the final state satisfies."""
        return parse_formula(self.formula, map(str, facts.fluents))


@dataclass(frozen=True)
class Achieves(Ends):
    """The final state satisfies a formula, of which the first is not known to satisfy it.

    Several require one initial state, which may satisfy none of their formulas.
    """

    file: ClassVar[str] = "achieves"

    def __str__(self) -> str:
        return f"achieves {self.formula}"


@dataclass(frozen=True)
class Nontrivial:
    """What is known of the final state differs from what is known of the first."""

    file: ClassVar[str] = "nontrivial"

    def __str__(self) -> str:
        return "nontrivial"

    def requests(self, number: int, facts: Facts) -> Iterator[str]:
        """Yield what the encoding is asked."""
        return iter(())


@dataclass(frozen=True)
class LoopFree:
    """No two states of a task are the same, as far as they are known."""

    file: ClassVar[str] = "loop_free"

    def __str__(self) -> str:
        return "loop-free"

    def requests(self, number: int, facts: Facts) -> Iterator[str]:
        """Yield what the encoding is asked."""
        return iter(())


def asked_end(number: int, conjunctions: Iterable[Mapping[str, bool]]) -> Iterator[str]:
    """Yield what ``ends.lp`` is asked where the final state satisfies one of some conjunctions."""
    yield f"ends({number})"
    for which, conjunction in enumerate(conjunctions):
        yield f"either({number},{which})"
        for fluent, value in conjunction.items():
            yield f"either({number},{which},{fluent},{_spelled(value)})"


def asked_start(conjunctions: Iterable[Mapping[str, bool]]) -> Iterator[str]:
    """Yield what ``achieves.lp`` is asked where one of some conjunctions must not be known of the initial state."""
    for which, conjunction in enumerate(conjunctions):
        yield f"known({which})"
        for fluent, value in conjunction.items():
            yield f"known({which},{fluent},{_spelled(value)})"


def asked_language(number: int, machine: Recogniser) -> Iterator[str]:
    """Yield what ``matches.lp`` is asked for the words of an automaton."""
    yield f"language({number})"
    yield f"starts({number},0)"
    for state, row in enumerate(machine.moves):
        for name, target in row.items():
            yield f"moves({number},{state},{name},{target})"
    yield from (f"accepts({number},{state})" for state in sorted(machine.accepting))


def _bounds(which: int | str, expected: Range, lower: str, upper: str) -> Iterator[str]:
    if expected.low:
        yield f"{lower}({which},{expected.low})"
    if expected.high is not None:
        yield f"{upper}({which},{expected.high})"


def _counted(what: str, times: Range, counted: Iterable[object]) -> Iterator[str]:
    """Yield what ``has.lp`` is asked.

    A tally is part of the state. Its name has the entities that it speaks of, so that renaming them makes of it the
    tally of what is renamed.
    """
    which = f"({what},{times.low},{'any' if times.high is None else times.high})"
    yield from _bounds(which, times, "least", "most")
    yield f"tops({which},{max(times.low, 0 if times.high is None else times.high + 1)})"
    yield from (f"counts({which},{each})" for each in counted)


def _named_by_all(actions: Sequence[clingo.Symbol], facts: Facts) -> str:
    """Return the one entity that some actions, and no others, name, as a term; an empty text where there is none."""
    naming = {entity: tuple(action for action in facts.actions if any(mentioned_entities(action, [entity])))
              for entity in ({*mentioned_entities(actions[0], facts.entities)} if actions else ())}  # fmt: skip
    found = [entity for entity, those in naming.items() if those == tuple(actions)]
    return f"({found[0]},)" if len(found) == 1 else ""


def _told_of(pattern: str, number: int) -> str:
    """Return a pattern as a term with the entities that it names; `number` where it names none."""
    parsed = Pattern.parse(pattern)
    if parsed.arguments is None:
        return str(number)
    arguments = (f'"{ANY}"' if argument == ANY else argument for argument in parsed.arguments)
    return f'("{parsed.name}",{",".join(arguments)})'


def _intervals(numbers: Sequence[int]) -> str:
    """Return numbers as ``0-3,7``."""
    breaks = [i for i in range(1, len(numbers)) if numbers[i] != numbers[i - 1] + 1]
    pieces = [numbers[a:b] for a, b in zip([0, *breaks], [*breaks, len(numbers)], strict=True)]
    return ",".join(f"{piece[0]}-{piece[-1]}" for piece in pieces if piece)


def _spelled(value: bool) -> str:
    return "true" if value else "false"
