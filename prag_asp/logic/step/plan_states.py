"""Hindsight for many plans: each distinct step is evaluated once and cached by its number."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.step.hindsight import FluentValues, Hindsight, Truth, solved_states
from prag_asp.program.facts import Facts
from prag_asp.program.sources import Program

Numbers = NDArray[np.int64]

ENTRIES = 1 << 15
"""The number of entries at which a cache is emptied; including its states, it then takes about 30 MB."""


LOW = 2**32 - 1
"""The mask for the second of two numbers in one key; numbers stay below it, because caches are emptied."""


class _Rows:
    """Distinct, numbered columns of truth values."""

    def __init__(self) -> None:
        self._numbers: dict[bytes, int] = {}
        self._texts: list[bytes] = []
        self._height = 0

    def add(self, columns: Truth) -> list[int]:
        """Return the number of each column; a new column gets the next number."""
        self._height = columns.shape[0]
        numbers = []
        for row in np.packbits(columns, axis=0).T:
            text = row.tobytes()
            number = self._numbers.setdefault(text, len(self._texts))
            if number == len(self._texts):
                self._texts.append(text)
            numbers.append(number)
        return numbers

    def get(self, numbers: Sequence[int]) -> Truth:
        """Return the columns with the given numbers."""
        text = b"".join(self._texts[number] for number in numbers)
        packed = np.frombuffer(text, dtype=np.uint8).reshape(len(numbers), -(-self._height // 8))
        columns: Truth = np.unpackbits(packed, axis=1, count=self._height).astype(np.bool_).T
        return columns


class PlanStates:
    """The known values of the states of plans, with hindsight; equal states have equal numbers.

    A step is a function of a state and an action, and hindsight is a function of a step and the known atoms of the
    state after it. The steps of a plan are looked up forward and then backward; new ones are evaluated for all plans.
    """

    def __init__(self, hindsight: Hindsight) -> None:
        self._hindsight = hindsight
        self._width = len(hindsight.step.occurs)
        self._states, self._seen, self._outcomes = _Rows(), _Rows(), _Rows()
        self._steps: dict[int, tuple[int, int]] = {}
        self._last: dict[int, int] = {}
        self._before: dict[int, int] = {}
        start, seen = hindsight.start
        self._start = self._states.add(start)[0]
        self._nothing = self._seen.add(seen)[0]

    @property
    def full(self) -> bool:
        """Whether the caches are so large that starting over saves memory."""
        return max(len(self._steps), len(self._before)) > ENTRIES

    @property
    def letters(self) -> tuple[clingo.Symbol, ...]:
        """The actions, in the order of their numbers."""
        return tuple(self._hindsight.step.occurs)

    def numbers(self, plans: Numbers) -> Numbers:
        """Return numbers that identify the known values of the states 0..n of valid plans, shape (plans, n + 1).

        Plans have shape (plans, n) and hold the numbers of actions.
        """
        hindsight, outcomes = self._hindsight, self._outcomes

        def follow(keys: list[int]) -> list[tuple[int, int]]:
            states = self._states.get([key // self._width for key in keys])
            after, seen = hindsight.follow(states, np.array([key % self._width for key in keys]))
            return list(zip(self._states.add(after), self._seen.add(seen), strict=True))

        def evaluate_last(keys: list[int]) -> list[int]:
            return outcomes.add(hindsight.evaluate_last(self._seen.get(keys)))

        def evaluate_before(keys: list[int]) -> list[int]:
            seen, known = self._seen.get([key & LOW for key in keys]), outcomes.get([key >> 32 for key in keys])
            return outcomes.add(hindsight.evaluate_before(seen, known))

        count, length = plans.shape
        state = np.full(count, self._start)
        seen = np.full((length + 1, count), self._nothing)
        for k in range(length):
            step = _look_up(self._steps, state * self._width + plans[:, k], follow)
            state, seen[k + 1] = step[:, 0], step[:, 1]
        numbers = np.empty((count, length + 1), dtype=np.int64)
        numbers[:, length] = _look_up(self._last, seen[length], evaluate_last)
        for k in range(length, 0, -1):
            numbers[:, k - 1] = _look_up(self._before, (numbers[:, k] << 32) + seen[k], evaluate_before)
        return numbers

    def values(self, numbers: Sequence[int]) -> FluentValues:
        """Return the values of numbered states, shape (fluents, numbers)."""
        return self._hindsight.values(self._outcomes.get(numbers))


def _look_up(table: dict[int, Any], keys: Numbers, evaluate: Callable[[list[int]], list[Any]]) -> Numbers:
    """Return the entries of a table for the given keys, after computing those that are missing."""
    different, places = np.unique(keys, return_inverse=True)
    distinct = different.tolist()
    new = [key for key in distinct if key not in table]
    if new:
        table.update(zip(new, evaluate(new), strict=True))
    entries: Numbers = np.array([table[key] for key in distinct])[places]
    return entries


class SolvedPlanStates:
    """The counterpart of `PlanStates` for steps that cannot be evaluated: it solves the program of each plan."""

    def __init__(self, program: Program, facts: Facts) -> None:
        self._program = program
        self._fluents = facts.fluents
        self.letters = facts.actions
        self._numbers: dict[bytes, int] = {}

    @property
    def full(self) -> bool:
        """Whether the caches are so large that starting over saves memory."""
        return len(self._numbers) > ENTRIES

    def numbers(self, plans: Numbers) -> Numbers:
        """Return numbers that identify the known values of the states 0..n of valid plans, shape (plans, n + 1)."""
        numbers = np.empty((plans.shape[0], plans.shape[1] + 1), dtype=np.int64)
        for row, letters in zip(numbers, plans.tolist(), strict=True):
            values = solved_states(self._program, tuple(self.letters[each] for each in letters), self._fluents)
            row[:] = [self._numbers.setdefault(state.tobytes(), len(self._numbers)) for state in values.T]
        return numbers

    def values(self, numbers: Sequence[int]) -> FluentValues:
        """Return the values of numbered states, shape (fluents, numbers)."""
        texts = list(self._numbers)
        rows = [np.frombuffer(texts[number], dtype=np.int8) for number in numbers]
        values: FluentValues = np.array(rows, dtype=np.int8).reshape(len(numbers), len(self._fluents)).T
        return values
