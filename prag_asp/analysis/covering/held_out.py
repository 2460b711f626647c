"""Combinations of factors to hold out from training, which still covers all combinations with one factor fewer."""

from __future__ import annotations

import random
from collections.abc import Collection, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from prag_asp.analysis.covering.combinations import Combination, combinations_of, letter_combinations
from prag_asp.analysis.layered_automaton import LayeredAutomaton, layered_words
from prag_asp.atom import atom_of
from prag_asp.errors import QueryError
from prag_asp.processes.progress_events import stage
from prag_asp.space.task_space import TaskSpace

SHARE = 5
"""By default, one in `SHARE` combinations is held out."""


@dataclass(frozen=True)
class HeldOut:
    """Combinations of `strength` + 1 factors that occur only in test tasks, and the actions that have one of them."""

    strength: int
    combinations: tuple[Combination, ...]
    actions: tuple[str, ...]

    def parts(self, space: TaskSpace) -> tuple[TaskSpace, TaskSpace]:
        """Return the tasks without these actions, for training, and those with at least one of them."""
        listed = " | ".join(self.actions)
        return space.part(f"lacks {listed}"), space.part(f"has {listed}")


def hold_out_combinations(space: TaskSpace, strength: int, seed: int = 0, at_most: int | None = None) -> HeldOut:
    """Return combinations of `strength` + 1 factors to hold out; tasks without them cover those of `strength` factors.

    Combinations are tried in random order until `at_most` are held out, by default a fifth of the reachable ones.

    Raises:
        QueryError: none can be held out, the strength is out of range, or the states of the space are too many to be
            listed.
        LimitReached: a limit ended the exploration.
    """
    words = layered_words(space, "task")
    smaller = letter_combinations(space, words, strength)
    larger = [frozenset(each for each in own if len(each) > strength)
              for own in letter_combinations(space, words, strength + 1)]  # fmt: skip
    targets, reachable = frozenset().union(*smaller), frozenset().union(*larger)
    order = random.Random(f"cover {seed}").sample(sorted(reachable), len(reachable))
    enough = -(-len(reachable) // SHARE) if at_most is None else at_most
    held: set[Combination] = set()
    stage("choosing combinations")
    for combination in order:
        if len(held) >= enough:
            break
        kept = np.array([own.isdisjoint(held | {combination}) for own in larger], dtype=np.bool_)
        if targets == frozenset().union(*(smaller[letter] for letter in _occurring(words, kept))):
            held.add(combination)
    if not held:
        raise QueryError(
            f"{space.title}: training needs every combination of {strength + 1} factors to cover those of {strength}; "
            "give a smaller number, or longer tasks"
        )
    return held_out(space, strength, held)


def held_out(space: TaskSpace, strength: int, held: Iterable[Combination]) -> HeldOut:
    """Return given combinations of `strength` + 1 factors, and the domain's actions that have at least one of them.

    Raises:
        QueryError: no action has one of them, or the strength is out of range.
    """
    combinations, classes = tuple(sorted(held)), space.domain.facts.entity_names
    actions = [
        str(action)
        for action in space.domain.facts.actions
        if not combinations_of(atom_of(action), classes, strength + 1).isdisjoint(combinations)
    ]
    if not actions:
        raise QueryError(f"no action of {space.domain.label} has one of the combinations that are held out")
    return HeldOut(strength, combinations, tuple(actions))


def _occurring(words: LayeredAutomaton, kept: NDArray[np.bool_]) -> Collection[int]:
    """Return the letters that occur in words that consist only of kept letters."""
    steps = words.edges or ()
    alive = [np.ones(1, dtype=np.bool_)]
    for step in reversed(steps):
        leads = kept[step.letters] & alive[-1][step.targets]
        alive.append(np.logical_or.reduceat(leads, step.begins))
    reached, found = alive[-1], set[int]()
    for step, following in zip(steps, alive[-2::-1], strict=True):
        used = reached[step.sources] & kept[step.letters] & following[step.targets]
        found.update(step.letters[used].tolist())
        reached = np.zeros(len(following), dtype=np.bool_)
        reached[step.targets[used]] = True
    return found
