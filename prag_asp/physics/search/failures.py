"""The failed attempts of a search: how often each fault occurred, and the attempts that came nearest to success."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence

from prag_asp.physics.search.attempt import PhysicsFault
from prag_asp.physics.symbolic_facts import ActionEffect
from prag_asp.wording import plural


class FailureLog:
    """The counts of the faults of all attempts and, separately, of the attempts that completed the most actions.

    `grasp_to_blame` is true if an object could not be moved or put down with the grasp chosen, and no other grasp was
    tried.
    """

    def __init__(self) -> None:
        self.faults = Counter[PhysicsFault]()
        self.grasp_to_blame = False
        self._farthest = -1
        self._last = Counter[PhysicsFault]()
        self._missed = dict[PhysicsFault, float]()

    def add(self, fault: PhysicsFault, done: int, missed: float = 0.0) -> None:
        """Count a fault that occurred after `done` actions or, if `done` is -1, in sampling the initial state.

        `missed` is the amount by which the attempt failed, as in `Failure`.
        """
        self.faults[fault] += 1
        if done > self._farthest:
            self._farthest = done
            self._last.clear()
            self._missed.clear()
        if done == self._farthest:
            self._last[fault] += 1
            if missed > 0.0:
                self._missed[fault] = min(missed, self._missed.get(fault, missed))

    def nearest(self, effects: Sequence[ActionEffect]) -> str:
        """Return, in words, how close the best attempts at a task came, and the fault that ended most of them.

        The text states by how much the nearest attempt failed, if this is known.
        """
        if not self._last:
            return ""
        fault = self._last.most_common(1)[0][0]
        concerned = fault.text or (fault.fact.sentence() if fault.fact is not None else ", ".join(fault.entities))
        missed = self._missed.get(fault)
        if missed is not None:
            turns = fault.fact is not None and fault.fact.predicate.turns
            distance = f"{math.degrees(missed):.2g} degrees" if turns else f"{1000 * missed:.3g} mm"
            concerned += f"; missed by {distance}"
        what = f"{fault.cause} ({concerned})" if concerned else fault.cause
        if self._farthest < 0:
            return f"in the initial state {what}"
        if self._farthest == len(effects):
            return f"after all {plural(len(effects), 'action')} {what}"
        action = effects[self._farthest].action
        return f"at action {self._farthest + 1} of {len(effects)}, {action}, {what}"
