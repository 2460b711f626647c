"""The functions that a guarded program calls during grounding to check ranges of numbers and the growth of terms."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import clingo

from prag_asp.errors import DomainError
from prag_asp.integers import LARGEST, fits
from prag_asp.program.finite.arithmetic import Expression, OutOfRange, check_range, divides
from prag_asp.program.problem import Problem

MOST_VALUES = 25_000
"""The maximum number of values from which a rule may derive larger terms within one step; grounding them takes 1 s."""

DEEPEST = 1_000
"""The maximum depth of the terms that such a rule derives."""

WIDEST = 1_000_000
"""The maximum number of values in an interval; each takes a few hundred bytes in an atom."""

MOST_KNOWN = 100_000
"""The maximum number of cached results of range checks, which take about 10 MB."""

ZERO = clingo.Number(0)

CONSTANT = re.compile(r"(?<![\w'])_*[a-z][\w']*")

BOUND = "bound it by a condition such as N < 10"


class BoundReached(DomainError):
    """Grounding computed a number out of range or exceeded a bound; `problem` states what happened and where."""

    def __init__(self, problem: Problem | BoundReached) -> None:
        super().__init__(str(problem))
        # clingo re-raises the error of a callback as an error whose argument is the original one
        self.problem: Problem = problem.problem if isinstance(problem, BoundReached) else problem


@dataclass(frozen=True)
class Site:
    """The file and line of a check, and the expression that is checked."""

    path: Path
    line: int
    text: str
    expression: Expression = 0
    inputs: tuple[str, ...] = ()
    certain: bool = False

    def error(self, what: str) -> BoundReached:
        """Return the error at this file and line."""
        return BoundReached(Problem(self.path, self.line, what))


@dataclass
class Checks:
    """The functions that a guarded program calls while clingo grounds it.

    `overflows` are the sites of numbers out of range: for these, clingo reports an undefined operation.
    """

    sites: Sequence[Site]
    overflows: list[Site] = field(default_factory=list)
    _known: set[tuple[clingo.Symbol, ...]] = field(default_factory=set)
    _values: dict[tuple[int, clingo.Symbol], set[tuple[clingo.Symbol, ...]]] = field(default_factory=dict)
    _depths: dict[clingo.Symbol, int] = field(default_factory=dict)
    _sums: dict[tuple[int, clingo.Symbol], tuple[set[clingo.Symbol], int]] = field(default_factory=dict)

    def overflow(self, message: str) -> BoundReached:
        """Return the error for an operation out of range, which clingo reports as undefined."""
        here = [site for site in self.overflows if message.startswith(f"{site.path}:{site.line}:")]
        site = (here or self.overflows)[0]
        return site.error(out_of_range(site.text))

    def as_written(self, message: str) -> str:
        """Return clingo's message about an undefined operation, with the operation as the author wrote it."""
        here = (site for site in self.sites if site.text and message.startswith(f"{site.path}:{site.line}:"))
        site = next(here, None)
        return f"{site.path}:{site.line}: operation undefined: {site.text}" if site else message

    def in_range(self, number: clingo.Symbol, *inputs: clingo.Symbol) -> clingo.Symbol:
        """Return 0 if an operation on these inputs remains in range, or otherwise a term without a numeric value.

        Raises:
            BoundReached: the operation would crash clingo.
        """
        if (number, *inputs) in self._known:
            return ZERO
        site = self.sites[number.number]
        try:
            check_range(site.expression, dict(zip(site.inputs, inputs, strict=True)))
        except OutOfRange:
            if divides(site.expression):
                raise site.error(out_of_range(site.text)) from None
            self.overflows.append(site)
            return clingo.Function("out_of_range")
        if len(self._known) < MOST_KNOWN:
            self._known.add((number, *inputs))
        return ZERO

    def must_fit(self, number: clingo.Symbol, *inputs: clingo.Symbol) -> clingo.Symbol:
        """Return 0 if an operation on these inputs remains in range.

        Raises:
            BoundReached: the result is out of range.
        """
        if self.in_range(number, *inputs).type != clingo.SymbolType.Number:
            site = self.sites[number.number]
            raise site.error(out_of_range(site.text))
        return ZERO

    def up_to(self, number: clingo.Symbol, low: clingo.Symbol, high: clingo.Symbol) -> clingo.Symbol:
        """Return the upper end of an interval.

        Raises:
            BoundReached: the interval is too wide, or an end is not a number.
        """
        site = self.sites[number.number]
        if not low.type == high.type == clingo.SymbolType.Number:
            unset = [str(end) for end in (low, high) if str(end) in CONSTANT.findall(site.text)]
            hint = f"give {unset[0]} a value by -c or #const, or " if unset else ""
            raise site.error(f"interval undefined: {site.text} from {low} to {high}; {hint}guard the operation")
        if high.number - low.number >= WIDEST:
            raise site.error(too_wide(site.text, low.number, high.number))
        return high

    def summed(self, number: clingo.Symbol, group: clingo.Symbol, element: clingo.Symbol) -> clingo.Symbol:
        """Return 0 if the sum of the elements of a group remains in range, or else a term without a numeric value."""
        elements, total = self._sums.get((number.number, group), (set(), 0))
        weight = element.arguments[0]
        if element not in elements and weight.type == clingo.SymbolType.Number:
            elements.add(element)
            total += abs(weight.number)
            self._sums[number.number, group] = (elements, total)
        if not fits(total):
            self.overflows.append(self.sites[number.number])
            return clingo.Function("out_of_range")
        return clingo.Number(0)

    def goes_on(self, number: clingo.Symbol, time: clingo.Symbol, *values: clingo.Symbol) -> clingo.Symbol:
        """Return 0 if a rule may derive terms from these values.

        Raises:
            BoundReached: the rule has derived too many values or terms that are too deep, or never terminates.
        """
        site = self.sites[number.number]
        if site.certain:
            raise site.error(ever_larger(site.text))
        made_of = self._values.setdefault((number.number, time), set())
        made_of.add(values)
        if len(made_of) > MOST_VALUES:
            raise site.error(f"this rule derived terms of {site.text} from each other {MOST_VALUES:,} times; {BOUND}")
        if any(measure(value, self._depths, _depth) > DEEPEST for value in values):
            raise site.error(f"this rule makes terms of {site.text} nested more than {DEEPEST:,} deep; {BOUND}")
        return clingo.Number(0)


def measure(symbol: clingo.Symbol, cache: dict[clingo.Symbol, int], of: Callable[[Iterable[int]], int]) -> int:
    """Return a measure of a term, which `of` computes from the measures of its arguments; `cache` stores results."""
    waiting = [] if symbol in cache else [symbol]
    while waiting:
        each = waiting[-1]
        inner = each.arguments if each.type == clingo.SymbolType.Function else ()
        unseen = [term for term in inner if term not in cache]
        if unseen:
            waiting += unseen
        else:
            cache[each] = of(cache[term] for term in inner)
            waiting.pop()
    return cache[symbol]


def _depth(inner: Iterable[int]) -> int:
    return max((each + 1 for each in inner), default=0)


def ever_larger(name: str) -> str:
    """Return the message about a rule that never terminates."""
    return f"this rule derives ever larger terms of {name} without end; {BOUND}"


def out_of_range(operation: str) -> str:
    """Return the message about an operation whose result is out of range."""
    return f"{operation} is out of range; keep it from -{LARGEST} to {LARGEST}"


def too_wide(interval: str, low: int, high: int) -> str:
    """Return the message about an interval that is too wide."""
    return f"{interval} has {high - low + 1:,} numbers, more than {WIDEST:,}; make it smaller"
