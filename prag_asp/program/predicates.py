"""The predicates of the encodings that Python reads or writes.

Predicates of the contract have plain names (see ``encodings/contract.lp``). All others begin with the prefix
`RESERVED`, which predicates of a domain must not have.
"""

from __future__ import annotations

import re
from typing import NamedTuple

import clingo

RESERVED = "_"
"""The prefix of the library's internal predicates; authors may use all other names except those of the contract."""


class EncodingPredicate(NamedTuple):
    """The name and the arity of a predicate; calling it builds an atom."""

    name: str
    arity: int

    def __call__(self, *arguments: clingo.Symbol) -> clingo.Symbol:
        """Return the atom with these arguments."""
        return clingo.Function(self.name, arguments)

    def fact(self, *arguments: object) -> str:
        """Return a fact as text."""
        return f"{self.name}({','.join(map(str, arguments))})."

    def timeless(self, *arguments: clingo.Symbol) -> clingo.Symbol:
        """Return the atom with these arguments, without the last argument of the predicate, the step."""
        return clingo.Function(self.name, arguments)

    @property
    def without_time(self) -> tuple[str, int]:
        """The signature of the predicate without its last argument, the step."""
        return self.name, self.arity - 1


OCCURS, HOLDS, CHANGED = EncodingPredicate("occurs", 2), EncodingPredicate("holds", 3), EncodingPredicate("changed", 2)
NAME, MENTIONS = EncodingPredicate("name", 2), EncodingPredicate("mentions", 3)
EVER, IMPOSSIBLE = EncodingPredicate("ever", 1), EncodingPredicate("impossible", 2)
"""Predicates of the contract."""

KNOWN, STEP_NAME = EncodingPredicate("_known", 3), EncodingPredicate("_step_name", 2)
FINAL, STATE = EncodingPredicate("_final", 3), EncodingPredicate("_state", 3)
RULED_OUT, BARRED = EncodingPredicate("_ruled_out", 2), EncodingPredicate("_barred", 2)
PROPAGATES = EncodingPredicate("_propagates", 4)
"""Predicates for known fluent values: at a step, in the final state, in hindsight, and by the invariants."""

PRUNED = EncodingPredicate("_pruned", 1)
MAY_OCCUR, MAY_HOLD = EncodingPredicate("_may_occur", 1), EncodingPredicate("_may_hold", 2)
MAY_STAND, MAY_SET = EncodingPredicate("_may_stand", 2), EncodingPredicate("_may_set", 3)
"""Predicates for pruning and relaxed reachability."""

SUCCESSOR, INTRODUCED = EncodingPredicate("_successor", 2), EncodingPredicate("_introduced", 2)
JOINT_UNIT, NEXT_UNIT = EncodingPredicate("_joint_unit", 2), EncodingPredicate("_next_unit", 2)
UNIT_INTRODUCED = EncodingPredicate("_unit_introduced", 2)
"""The order in which tasks introduce interchangeable entities."""

REQUEST, MEMORY, FINDING = (
    EncodingPredicate("_request", 1),
    EncodingPredicate("_memory", 2),
    EncodingPredicate("_finding", 2),
)
"""Predicates for conditions and weights: their requests, their memory after a step, and their results at a step."""


def refers_to(text: str, predicate: EncodingPredicate) -> bool:
    """Return whether a program text contains the name of a predicate."""
    name = predicate.name
    return name in text and re.search(rf"\b{name}\b", text) is not None  # the plain search is far faster
