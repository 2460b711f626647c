"""The kinds of clauses, and the facts with which each kind requests tests from ``encodings/conditions``."""

from __future__ import annotations

import random
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, reduce
from typing import ClassVar, Protocol

import clingo

from prag_asp.errors import QueryError
from prag_asp.program.entity_names import action_name, mentioned_entities, no_action
from prag_asp.program.facts import Facts
from prag_asp.space.conditions.patterns import ANY, Pattern, alternatives, class_members
from prag_asp.space.conditions.regular import Recogniser, parse_expression, recogniser
from prag_asp.space.conditions.state_formula import parse_conjunction, parse_formula
from prag_asp.wording import not_too_deep


class Clause(Protocol):
    """One clause of a condition; its text is the user's notation."""

    @property
    def file(self) -> str:
        """The name of the encoding that tests the clause."""
        ...

    def requests(self, number: int, facts: Facts) -> Iterator[str]:
        """Yield the request terms for the encoding; `number` identifies this clause.

        Raises:
            QueryError: the clause names something that the domain does not have.
        """
        ...


@dataclass(frozen=True)
class Begins:
    """The clause that the first actions are the given actions or have the given names."""

    prefix: tuple[str, ...]
    file: ClassVar[str] = "begins"

    def __str__(self) -> str:
        return f"begins {', '.join(self.prefix)}"

    def requests(self, number: int, facts: Facts) -> Iterator[str]:
        """Yield the request terms for the encoding."""
        for step, item in enumerate(self.prefix):
            yield f"begins({number},{step})"
            yield f"instant({step + 1})"
            for action in Pattern.parse(item).matches(facts):
                yield f"fits({number},{step},{action})"


def fewest_actions(clause: Clause) -> int:
    """Return a lower bound on the number of actions of a plan that satisfies a clause."""
    if isinstance(clause, After):
        return clause.steps
    if isinstance(clause, Begins):
        return len(clause.prefix)
    if isinstance(clause, Achieves):
        return 1
    return clause.times.low if isinstance(clause, Has) else 0


@dataclass(frozen=True)
class Range:
    """A number from `low` to `high`, or with no upper bound if `high` is None."""

    low: int = 0
    high: int | None = None

    def __str__(self) -> str:
        if self.low == self.high:
            return f"exactly {self.low}"
        return f"at least {self.low}" if self.high is None else f"at most {self.high}"


@dataclass(frozen=True)
class Has:
    """The clause that matching actions, or pairs of consecutive action names, occur `times` times."""

    pattern: str
    times: Range
    file: ClassVar[str] = "has"

    def __str__(self) -> str:
        return f"has {self.times} {self.pattern}"

    def requests(self, number: int, facts: Facts) -> Iterator[str]:
        """Yield the request terms for the encoding."""
        first, arrow, second = (part.strip() for part in self.pattern.partition(">"))
        if arrow:
            names = {action_name(action) for action in facts.actions}
            for name in (first, second):
                if name not in names:
                    raise QueryError(no_action(name, names, facts))
            yield from _counted(str(number), self.times, [f"{first},{second}"])
        elif len(patterns := alternatives(self.pattern)) > 1:
            matching = (action for each in patterns for action in Pattern.parse(each).matches(facts))
            yield from _counted(str(number), self.times, sorted({*matching}))
        else:
            actions = Pattern.parse(self.pattern).matches(facts)
            # Different patterns that match a single action are equivalent.
            parsed = Pattern.parse(str(actions[0]) if len(actions) == 1 else self.pattern)
            which = _named_by_all(actions, facts)
            if not which and parsed.arguments is None:
                which = str(number)
            elif not which:  # the term contains the entities that the pattern mentions
                arguments = (f'"{ANY}"' if argument == ANY else argument for argument in parsed.arguments or ())
                which = f'("{parsed.name}",{",".join(arguments)})'
            yield from _counted(which, self.times, actions)


@dataclass(frozen=True)
class Uses:
    """The clause that the actions use `number` entities with a given name or of a given class."""

    kind: str
    number: Range
    file: ClassVar[str] = "uses"

    def __str__(self) -> str:
        return f"uses {self.number} {self.kind}"

    def requests(self, number: int, facts: Facts) -> Iterator[str]:
        """Yield the request terms for the encoding."""
        yield from _bounds(number, self.number, "fewest", "greatest")
        for entity in class_members(self.kind, facts):
            yield f"uses({number},{entity})"


@dataclass(frozen=True)
class Names:
    """The clause that some action, or no action, uses an entity of a kind: a case of `Uses` with a smaller state."""

    kind: str
    some: bool
    file: ClassVar[str] = "has"

    def __str__(self) -> str:
        return f"{'uses' if self.some else 'avoids'} {self.kind}"

    def requests(self, number: int, facts: Facts) -> Iterator[str]:
        """Yield the request terms for the encoding."""
        actions = self.actions(facts)
        which = _named_by_all(actions, facts) or str(number)
        yield from _counted(which, Range(1) if self.some else Range(0, 0), actions)

    def actions(self, facts: Facts) -> tuple[clingo.Symbol, ...]:
        """Return the actions that use an entity of this kind."""
        members = set(class_members(self.kind, facts))
        return tuple(action for action in facts.actions if any(mentioned_entities(action, members)))


@dataclass(frozen=True)
class Matches:
    """The clause that the sequence of action names matches a regular expression or, with `inverse`, does not."""

    expression: str
    inverse: bool = False
    file: ClassVar[str] = "matches"

    def __str__(self) -> str:
        return f"{'not ' if self.inverse else ''}matches {self.expression}"

    def requests(self, number: int, facts: Facts) -> Iterator[str]:
        """Yield the request terms for the encoding."""
        names = {action_name(action) for action in facts.actions}
        with not_too_deep(self.expression):
            machine = recogniser(parse_expression(self.expression, names), names, inverse=self.inverse)
        yield from language_requests(number, machine)


@dataclass(frozen=True)
class Part:
    """The clause that the skeleton is in one of the parts into which a random automaton divides skeletons evenly.

    Each action name stands for a random permutation, determined by `seed`, of the numbers below `modulus`; the class of
    a skeleton is the image of 0 under the permutations of its names in order.
    """

    residues: tuple[int, ...]
    modulus: int
    seed: int
    file: ClassVar[str] = "matches"

    def __str__(self) -> str:
        numbers = self.residues
        breaks = [i for i in range(1, len(numbers)) if numbers[i] != numbers[i - 1] + 1]
        intervals = [numbers[a:b] for a, b in zip([0, *breaks], [*breaks, len(numbers)], strict=True)]
        spelled = ",".join(f"{interval[0]}-{interval[-1]}" for interval in intervals if interval)
        return f"part {spelled} of {self.modulus} by seed {self.seed}"

    def requests(self, number: int, facts: Facts) -> Iterator[str]:
        """Yield the request terms for the encoding."""
        rows: list[dict[str, int]] = [{} for _ in range(self.modulus)]
        for name in sorted({action_name(action) for action in facts.actions}):
            for state, target in enumerate(self._permutation(name)):
                rows[state][name] = target
        yield from language_requests(number, Recogniser(rows, frozenset(self.residues)))

    def includes(self, skeletons: Iterable[Sequence[str]]) -> list[bool]:
        """Return whether each skeleton belongs to the part."""
        permutation, residues = cache(self._permutation), frozenset(self.residues)
        return [reduce(lambda number, name: permutation(name)[number], names, 0) in residues for names in skeletons]

    def _permutation(self, name: str) -> list[int]:
        """Return the image of each number under the permutation of a name."""
        numbers = list(range(self.modulus))
        random.Random(f"{self.seed} {name}").shuffle(numbers)
        return numbers


@dataclass(frozen=True)
class After:
    """The clause that fluents have given values after `steps` actions (0: initially), possibly known in hindsight."""

    steps: int
    formula: str
    file: ClassVar[str] = "after"

    def __str__(self) -> str:
        return f"after {self.steps}: {self.formula}" if self.steps else f"starts {self.formula}"

    def requests(self, number: int, facts: Facts) -> Iterator[str]:
        """Yield the request terms for the encoding."""
        if self.steps:
            yield f"instant(1..{self.steps})"
        for fluent, value in self.conjunction(facts).items():
            yield f"after({self.steps},{fluent},{_spelled(value)})"

    def conjunction(self, facts: Facts) -> Mapping[str, bool]:
        """Return the required values of fluents."""
        return parse_conjunction(self.formula, map(str, facts.fluents))


@dataclass(frozen=True)
class Ends:
    """The clause that the final state satisfies a formula, together with the goal of the domain."""

    formula: str
    file: ClassVar[str] = "ends"

    def __str__(self) -> str:
        return f"ends {self.formula}"

    def requests(self, number: int, facts: Facts) -> Iterator[str]:
        """Yield the request terms for the encoding."""
        yield from end_requests(number, self.conjunctions(facts))

    def conjunctions(self, facts: Facts) -> Sequence[Mapping[str, bool]]:
        """Return conjunctions of which the final state satisfies at least one."""
        return parse_formula(self.formula, map(str, facts.fluents))


@dataclass(frozen=True)
class Achieves(Ends):
    """The clause that the final state satisfies a formula that the initial state is not known to satisfy.

    Several such clauses share one initial state, which must not be known to satisfy any of their formulas.
    """

    file: ClassVar[str] = "achieves"

    def __str__(self) -> str:
        return f"achieves {self.formula}"


@dataclass(frozen=True)
class KeywordClause:
    """A clause that is a single keyword, tested by the encoding of the same name."""

    keyword: str

    @property
    def file(self) -> str:
        """The name of the encoding that tests the clause."""
        return self.keyword.replace("-", "_")

    def __str__(self) -> str:
        return self.keyword

    def requests(self, number: int, facts: Facts) -> Iterator[str]:
        """Yield the request terms for the encoding: there are none."""
        return iter(())


NONTRIVIAL = KeywordClause("nontrivial")
"""The known parts of the final and the initial state differ."""

LOOP_FREE = KeywordClause("loop-free")
"""No two states of a task have the same known part."""


SHORTEST = KeywordClause("shortest")
"""No shorter plan leads from the known initial state of a task to its goal."""


def end_requests(number: int, conjunctions: Iterable[Mapping[str, bool]]) -> Iterator[str]:
    """Yield the request terms for ``ends.lp``: the final state satisfies one of the given conjunctions."""
    yield f"ends({number})"
    for which, conjunction in enumerate(conjunctions):
        yield f"either({number},{which})"
        for fluent, value in conjunction.items():
            yield f"either({number},{which},{fluent},{_spelled(value)})"


def start_requests(conjunctions: Iterable[Mapping[str, bool]]) -> Iterator[str]:
    """Yield the request terms for ``achieves.lp``: none of the conjunctions is known to hold initially."""
    for which, conjunction in enumerate(conjunctions):
        yield f"known({which})"
        for fluent, value in conjunction.items():
            yield f"known({which},{fluent},{_spelled(value)})"


def language_requests(number: int, machine: Recogniser) -> Iterator[str]:
    """Yield the request terms for ``matches.lp``: an automaton accepts the skeleton."""
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
    """Yield the request terms for ``has.lp``.

    A counter is part of the state. Its name contains the entities that it counts, so that renaming entities maps
    counters to counters.
    """
    which = f"({what},{times.low},{'any' if times.high is None else times.high})"
    yield from _bounds(which, times, "least", "most")
    yield f"tops({which},{max(times.low, 0 if times.high is None else times.high + 1)})"
    yield from (f"counts({which},{item})" for item in counted)


def _named_by_all(actions: Sequence[clingo.Symbol], facts: Facts) -> str:
    """Return the term of the only entity that exactly these actions use, or an empty string."""
    naming = {entity: tuple(action for action in facts.actions if any(mentioned_entities(action, [entity])))
              for entity in ({*mentioned_entities(actions[0], facts.entities)} if actions else ())}  # fmt: skip
    entities = [entity for entity, users in naming.items() if users == tuple(actions)]
    return f"({entities[0]},)" if len(entities) == 1 else ""


def _spelled(value: bool) -> str:
    return "true" if value else "false"
