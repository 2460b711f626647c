"""The interface of the engines."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Literal, Protocol

import clingo

from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.program.entity_names import action_name
from prag_asp.space.limits import Limits

if TYPE_CHECKING:
    from prag_asp.space.weights.weights import Weighed, Weights

Level = Literal["plan", "task", "skeleton"]
LEVELS: tuple[Level, ...] = ("plan", "task", "skeleton")

Letters = tuple[str, ...]
"""A plan or a task as the texts of its actions, or a skeleton as names."""


@dataclass(frozen=True)
class Draw:
    """A sampled plan or task with its exact probability."""

    word: Letters
    probability: Fraction


class Engine(Protocol):
    """An engine, which counts, enumerates and samples the words of one domain at one level.

    `prefix` holds, for each of the first steps, the text of a letter or a name that stands for several letters (see
    `name_in_prefix`). Words are in lexicographic order of their letters: actions in clingo's order of terms, names in
    alphabetical order.
    """

    def count(self, length: int, prefix: Letters = ()) -> int:
        """Return the number of words of a given length."""
        ...

    def following(self, length: int, prefix: Letters = ()) -> dict[str, int]:
        """Return, for each letter that can follow `prefix`, the number of words that continue with it.

        The letters are in order. If `prefix` is as long as the words, no letter can follow it.
        """
        ...

    def words(self, length: int, prefix: Letters = ()) -> Iterator[Letters]:
        """Yield the words of a given length in order, lazily."""
        ...

    def contains(self, word: Letters) -> bool:
        """Return whether a word belongs to the level."""
        ...

    def unrank(self, length: int, rank: int) -> Letters:
        """Return the word with a given rank, from 0 to count - 1."""
        ...

    def rank(self, word: Letters) -> int | None:
        """Return the rank of a word among the words of its length, or None if it is not a word."""
        ...

    @property
    def letters(self) -> Letters:
        """The texts of the letters, in order."""
        ...

    def weighed(self, length: int, weights: Weights, *, goals: bool = False, plain: bool = False) -> Weighed:
        """Return the weighted words of a given length; with `goals`, also the known part of their final states.

        With `plain` (or `goals`), each path is one word; otherwise a path may stand for several words.

        Raises:
            QueryError: the weights distinguish interchangeable entities, or skeletons have weights.
        """
        ...


Progress = Callable[[str], None]
"""A function that is called with a short text about the progress of a long computation."""

ALL = "(...)"
"""Suffix of a prefix item that stands for all actions with a name, even if the text of one action equals that name."""


def name_in_prefix(item: str, letters: Container[str]) -> str | None:
    """Return the name that an item of a prefix stands for, or None if it is a letter."""
    if item.endswith(ALL):
        return item.removesuffix(ALL)
    return None if item in letters else item


def prefix_sets(prefix: Letters, numbers: Mapping[str, int], names: Sequence[str]) -> list[frozenset[int]]:
    """Return the numbers of the letters that each item of a prefix allows; `names` holds the name of each letter."""
    sets = []
    for item in prefix:
        name = name_in_prefix(item, numbers)
        allowed = (number for number, other in enumerate(names) if other == name)
        sets.append(frozenset(allowed if name is not None else {numbers[item]}))
    return sets


def count_each(engine: Engine, length: int, prefix: Letters) -> dict[str, int]:
    """Return what `following` returns, by counting the words for each letter that might follow `prefix`."""
    if len(prefix) >= length:
        return {}
    counts = {letter: engine.count(length, (*prefix, letter)) for letter in engine.letters}
    return {letter: number for letter, number in counts.items() if number}


MakeEngine = Callable[[DomainLogic, Level, "Progress | None", Limits], Engine]


def all_letters(model: DomainLogic, level: Level) -> dict[str, clingo.Symbol]:
    """Return the letters of a level with their terms, in order: the texts of all candidate actions, or their names."""
    actions = model.domain.facts.tried
    if level == "skeleton":
        return {name: clingo.Function(name) for name in sorted(set(map(action_name, actions)))}
    return {str(action): action for action in actions}
