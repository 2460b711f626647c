"""Counts of the models of clauses and sums, by a table of states: partial sums, and clauses not satisfied yet.

The variables of a part are decided in a fixed order. After some decisions, the models of the rest depend only on the
weight that each sum still lacks and on the clauses that have begun and are not satisfied, so that equal states are
merged. A table is thus an ordered decision diagram, built from the sums themselves (Behle 2007; Abío et al. 2012) and
from the clauses (Huang and Darwiche 2005). Nothing is searched or learned, so a state takes a few microseconds.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable, Container, Generator, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from heapq import heappop, heappush
from math import fsum
from time import process_time

from prag_asp.logic.formula.clause_builder import Literal
from prag_asp.models.prepared_formula import OpenSum
from prag_asp.models.sums.sum_formula import SumFormula, SumPart
from prag_asp.models.sums.sum_order import table_order

PAUSE = 1024
"""The number of states between two checks of the time."""

SECONDS = 4e-6
"""The processor time for a state, in seconds."""

DEAD = -1
"""The number of a state without models."""

OPEN, REACHES, MISSES = 0, 1, 2
"""Whether the output of a sum is undecided, true or false: the last two bits of the number for an open sum.

The other bits are the weight that the sum lacks, which is at least 1.
"""

CLOSED, REACHED, MISSED, DEAD_SUM = 0, -1, -2, -3
"""The numbers for a sum that restricts nothing, for sums whose output is implied (true or false) but not yet decided,
and for a sum that cannot have its value."""

OPEN_AND_AT_LEAST_1 = 1 << 2
"""The smallest number for an open sum."""

State = tuple[int, ...]
"""The clauses that have begun and are not satisfied, as bits, and a number for each sum."""


@dataclass
class _Decision:
    """The effect of a literal on a state.

    The clauses in `last` would be violated, those not in `keep` are satisfied, and those in `begin` begin. Each of
    `additions` is the slot of a sum, 4 times the weight that is added to the sum, and 4 times the weight that is still
    open afterwards, plus 3. Each of `outputs` is the slot of a sum, and REACHES or MISSES.
    """

    last: int = 0
    keep: int = -1
    begin: int = 0
    additions: list[tuple[int, int, int]] = field(default_factory=list)
    outputs: list[tuple[int, int]] = field(default_factory=list)

    def after(self, state: State) -> State | None:
        """Return the next state, or None if it has no models."""
        if state[0] & self.last:
            return None
        new = [*state]
        new[0] = state[0] & self.keep | self.begin
        for slot, weight, most in self.additions:
            missing = new[slot]
            if missing > 0:
                left = missing - weight
                if not OPEN_AND_AT_LEAST_1 <= left <= most:
                    left = _closed(missing & 3, left < OPEN_AND_AT_LEAST_1)
                    if left == DEAD_SUM:
                        return None
                new[slot] = left
        for slot, value in self.outputs:
            missing = new[slot]
            if missing > 0:
                new[slot] = missing | value
            elif missing == (REACHED if value == REACHES else MISSED):
                new[slot] = CLOSED
            else:
                return None
        return tuple(new)


def _closed(value: int, reached: bool) -> int:
    """Return the number for a sum that has reached its bound or cannot reach it, given its output."""
    if value == OPEN:
        return REACHED if reached else MISSED
    return CLOSED if (value == REACHES) == reached else DEAD_SUM


class TableCount:
    """A count that continues where the previous call ended."""

    def __init__(self, formula: SumFormula) -> None:
        self._formula = formula
        self._work = self._steps()
        self._number: int | None = None

    @cached_property
    def _orders(self) -> list[tuple[list[int], float]]:
        return [table_order(part, self._formula.projection) for part in self._formula.parts]

    @property
    def most_seconds(self) -> float:
        """A rough bound on the processor time."""
        return SECONDS * fsum(2.0 ** min(bound, 1000) for _, bound in self._orders)

    def within(self, seconds: float, look: Callable[[], None] = lambda: None) -> int | None:
        """Return the number of projected models, or None if counting takes more than `seconds` of processor time.

        `look` is called before each step; an exception from `look` ends the call.
        """
        until = process_time() + seconds
        while self._number is None:
            look()
            next(self._work, None)
            if process_time() > until:
                break
        return self._number

    def _steps(self) -> Iterator[None]:
        """Count step by step."""
        number = 0 if self._formula.contradictory else 1 << self._formula.free
        for part, (order, _) in zip(self._formula.parts, self._orders, strict=True):
            number *= yield from _count(part, order, self._formula.projection)
        self._number = number


def _count(part: SumPart, order: Sequence[int], projection: Container[int]) -> Generator[None, None, int]:
    """Return the number of projected models of a part; projection variables come first in the order."""
    levels = yield from _table(part, order)
    totals = [1]
    for variable, (trues, falses) in zip(reversed(order), reversed(levels), strict=True):
        yield
        totals.append(0)  # the total of DEAD
        if variable in projection:
            totals = [totals[high] + totals[low] for high, low in zip(trues, falses, strict=True)]
        else:
            totals = [1 if totals[high] or totals[low] else 0 for high, low in zip(trues, falses, strict=True)]
    return totals[0] if totals else 0


def _table(part: SumPart, order: Sequence[int]) -> Generator[None, None, list[tuple[array[int], array[int]]]]:
    """Return, for each level, the numbers of the states after a true and a false variable."""
    decisions, start = _decisions(part, order)
    current: dict[State, int] = {start: 0}
    levels: list[tuple[array[int], array[int]]] = []
    states = 0
    for pair in decisions:
        following: dict[State, int] = {}
        reached = (array("q"), array("q"))
        for state in current:
            states += 1
            if states % PAUSE == 0:
                yield
            for decision, numbers in zip(pair, reached, strict=True):
                new = decision.after(state)
                numbers.append(DEAD if new is None else following.setdefault(new, len(following)))
        levels.append(reached)
        current = following
    return levels


def _decisions(part: SumPart, order: Sequence[int]) -> tuple[list[tuple[_Decision, _Decision]], State]:
    """Return the effects of each variable's two literals, and the state before all decisions.

    Clauses share a bit if they are not open at the same time; each sum has its own slot.
    """
    place = {variable: number for number, variable in enumerate(order)}
    pairs = [(_Decision(), _Decision()) for _ in order]
    spans = [_span(place, clause) for clause in part.clauses]
    for clause, bit in zip(part.clauses, _slots(spans), strict=True):
        _add_clause(pairs, place, clause, 1 << bit)
    state = [0]
    for slot, each in enumerate(part.sums, 1):
        bound, rest, value = each.missing
        state.append(bound << 2 | (OPEN if not value else REACHES if value > 0 else MISSES))
        _add_sum(pairs, place, each, slot, rest)
    return pairs, tuple(state)


def _span(place: dict[int, int], clause: Sequence[Literal]) -> tuple[int, int]:
    places = [place[abs(literal)] for literal in clause]
    return min(places), max(places)


def _slots(spans: Sequence[tuple[int, int]]) -> list[int]:
    """Return a number for each span, such that spans with the same number do not overlap."""
    slots = [0] * len(spans)
    free: list[int] = []
    ends: list[tuple[int, int]] = []
    used = 0
    for number in sorted(range(len(spans)), key=spans.__getitem__):
        begin, end = spans[number]
        while ends and ends[0][0] < begin:
            heappush(free, heappop(ends)[1])
        if free:
            slots[number] = heappop(free)
        else:
            slots[number], used = used, used + 1
        heappush(ends, (end, slots[number]))
    return slots


def _add_clause(
    pairs: Sequence[tuple[_Decision, _Decision]], place: dict[int, int], clause: Sequence[Literal], bit: int
) -> None:
    first, last = _span(place, clause)
    for literal in clause:
        level = place[abs(literal)]
        satisfied, violated = pairs[level] if literal > 0 else reversed(pairs[level])
        satisfied.keep &= ~bit
        if level == first:
            violated.begin |= bit
        if level == last:
            violated.last |= bit


def _add_sum(
    pairs: Sequence[tuple[_Decision, _Decision]], place: dict[int, int], each: OpenSum, slot: int, rest: int
) -> None:
    weights: dict[int, list[int]] = {}
    for literal, weight in each.weights.items():
        weights.setdefault(place[abs(literal)], [0, 0])[literal < 0] += weight
    for level in sorted(weights):
        rest -= max(weights[level])
        for decision, weight in zip(pairs[level], weights[level], strict=True):
            decision.additions.append((slot, weight << 2, rest << 2 | 3))
    if each.output:
        high, low = pairs[place[abs(each.output)]] if each.output > 0 else reversed(pairs[place[abs(each.output)]])
        high.outputs.append((slot, REACHES))
        low.outputs.append((slot, MISSES))
