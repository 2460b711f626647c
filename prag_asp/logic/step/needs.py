"""Literals of the state that forbid actions, tested for all actions at once: in most states, most cannot occur."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.step.normal import RuleBody
from prag_asp.logic.step.strata import Column

ROOM = 2**25
"""The maximum memory in bytes of the columns that are tested together."""


@dataclass(frozen=True)
class Needs:
    """The constraints that forbid an action wherever one literal of the state before it is true.

    Action ``letters[i]`` is forbidden by the literals whose numbers are ``forbidding[starts[i]:starts[i + 1]]``; they
    are `literals`. Letters without such constraints are not among them.
    """

    size: int
    literals: tuple[int, ...]
    letters: NDArray[np.intp]
    starts: NDArray[np.intp]
    forbidding: NDArray[np.intp]

    @classmethod
    def of(cls, constraints: Iterable[RuleBody], actions: Sequence[int], before: Collection[int]) -> Needs:
        """Return the needs that follow from constraints with one action and one atom `before` the step."""
        letter_of = {atom: letter for letter, atom in enumerate(actions)}
        numbers: dict[int, int] = {}
        pairs: set[tuple[int, int]] = set()
        for body in constraints:
            if len(body.literals) == 2 and not body.weights:
                for action, literal in (body.literals, body.literals[::-1]):
                    if action in letter_of and abs(literal) in before:
                        pairs.add((letter_of[action], numbers.setdefault(literal, len(numbers))))
        table = np.array(sorted(pairs), dtype=np.intp).reshape(-1, 2)
        letters, starts = np.unique(table[:, 0], return_index=True)
        return cls(len(actions), tuple(numbers), letters, np.append(starts, len(table)), table[:, 1])

    def met(self, read: Callable[[int], Column], states: int) -> NDArray[np.bool_]:
        """Return which actions are not forbidden in some state of a frontier, shape (actions,)."""
        met = np.ones(self.size, dtype=np.bool_)
        if not len(self.letters):
            return met
        columns = (read(literal) if literal > 0 else ~read(-literal) for literal in self.literals)
        true = np.stack([np.packbits(column) for column in columns])
        everywhere = np.packbits(np.ones(states, dtype=np.bool_))
        together = max(ROOM * len(self.letters) // (len(self.forbidding) * len(everywhere)), 1)
        for first in range(0, len(self.letters), together):
            starts = self.starts[first : first + together + 1]
            taken = true[self.forbidding[starts[0] : starts[-1]]]
            forbidden = np.bitwise_or.reduceat(taken, starts[:-1] - starts[0], axis=0)
            met[self.letters[first : first + together]] = (forbidden != everywhere).any(axis=1)
        return met
