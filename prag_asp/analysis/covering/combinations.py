"""Combinations of the factors of an action, as in covering arrays (Kuhn, Kacker and Lei 2013).

Factor 0 of an action is its name; factor i is the class of the i-th argument, or the argument itself if it is not an
entity. A combination of strength t holds the values of t factors of one action. An action with fewer factors has a
single combination, which consists of all its factors.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from prag_asp.analysis.layered_automaton import LayeredAutomaton, layered_words
from prag_asp.atom import Atom, atom_of
from prag_asp.errors import QueryError
from prag_asp.space.task_space import TaskSpace
from prag_asp.task import Task

Combination = tuple[tuple[int, str], ...]
"""Pairs of the number of a factor and its value, ordered by these numbers."""

STRONGEST = 8
"""The maximum strength; combinations of more factors are not considered."""


@dataclass(frozen=True)
class Coverage:
    """The reachable combinations of one strength, and those that the given tasks cover."""

    strength: int
    reachable: frozenset[Combination]
    covered: frozenset[Combination]

    @property
    def missing(self) -> frozenset[Combination]:
        """The reachable combinations that no task covers."""
        return self.reachable - self.covered

    @property
    def share(self) -> float:
        """The share of the reachable combinations that are covered, or 1 if there are none."""
        return len(self.covered) / len(self.reachable) if self.reachable else 1.0


def combinations_of(action: Atom, classes: Mapping[str, str], strength: int) -> frozenset[Combination]:
    """Return the combinations of an action, given the class of each entity.

    Raises:
        QueryError: the strength is not between 1 and 8.
    """
    if not 1 <= strength <= STRONGEST:
        raise QueryError(f"combinations of {strength} factors: give a number from 1 to {STRONGEST}")
    values = [(0, action.name), *((i, classes.get(each, each)) for i, each in enumerate(action.arguments, 1))]
    return frozenset(combinations(values, min(strength, len(values))))


def letter_combinations(space: TaskSpace, words: LayeredAutomaton, strength: int) -> list[frozenset[Combination]]:
    """Return the combinations of each letter in the words of a space; there are none for actions that never occur."""
    used = {int(letter) for step in words.edges or () for letter in np.unique(step.letters)}
    classes, actions = space.domain.facts.entity_names, space.engines.actions
    return [
        combinations_of(atom_of(actions[text]), classes, strength) if number in used else frozenset()
        for number, text in enumerate(words.letters)
    ]


def reachable_combinations(space: TaskSpace, strength: int) -> frozenset[Combination]:
    """Return the combinations that occur in some task of a space, which are those on the edges of its automaton.

    Raises:
        QueryError: the strength is out of range, the space has several lengths, or its states are too many to be
            listed.
        LimitReached: a limit ended the exploration.
    """
    return frozenset().union(*letter_combinations(space, layered_words(space, "task"), strength))


def coverage(tasks: Iterable[Task], space: TaskSpace, strength: int) -> Coverage:
    """Return which of the reachable combinations of a space are covered by the given tasks.

    Raises:
        QueryError: the strength is out of range, the space has several lengths, or its states are too many to be
            listed.
        LimitReached: a limit ended the exploration.
    """
    reachable, classes = reachable_combinations(space, strength), space.domain.facts.entity_names
    actions = {action for task in tasks for action in task.actions}
    covered = frozenset().union(*(combinations_of(action, classes, strength) for action in actions))
    return Coverage(strength, reachable, reachable & covered)


def combination_text(combination: Combination) -> str:
    """Return a combination as text, such as ``move(_,apple,bowl)``; ``*`` stands for any name."""
    values = dict(combination)
    arguments = [values.get(place, "_") for place in range(1, max(values) + 1)]
    return values.get(0, "*") + (f"({','.join(arguments)})" if arguments else "")
