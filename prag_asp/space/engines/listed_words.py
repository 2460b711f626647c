"""Weighted words of engines that enumerate them, and the engine of lengths without words."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.space.engines.engine import Letters, Level, all_letters
from prag_asp.space.weights.weights import Weighed, Weights, refuse_weights


def weigh_words(
    words: Iterable[Letters],
    letters: Letters,
    model: DomainLogic,
    level: Level,
    length: int,
    weights: Weights,
    goals: bool,
) -> Weighed:
    """Return the weighted words of a level and length; with `goals`, also the known part of their final states.

    Raises:
        QueryError: the weights distinguish interchangeable entities, or skeletons have weights.
    """
    from prag_asp.space.plans.task_builder import TaskBuilder
    from prag_asp.space.weights.tree import word_tree

    refuse_weights(level, weights, model, length)
    everything = list(words)
    numbers = {letter: number for number, letter in enumerate(letters)}
    spelled = [[numbers[letter] for letter in word] for word in everything]
    if level == "skeleton":
        return word_tree(spelled, length)
    actions = {str(action): action for action in model.domain.facts.actions}
    weighs = [weights.of_plan([actions[letter] for letter in word]) for word in everything] if weights else None
    return word_tree(spelled, length, weighs, TaskBuilder(model).final_states(everything) if goals else None)


@dataclass(frozen=True)
class NoWords:
    """The engine for lengths without words; it grounds nothing."""

    model: DomainLogic
    level: Level

    @property
    def letters(self) -> Letters:
        """The texts of the letters, in their order."""
        return tuple(all_letters(self.model, self.level))

    def count(self, length: int, prefix: Letters = ()) -> int:
        """Return the number of words of a length."""
        return 0

    def words(self, length: int, prefix: Letters = ()) -> Iterator[Letters]:
        """Yield the words of a length in order."""
        return iter(())

    def contains(self, word: Letters) -> bool:
        """Return whether a word belongs to the level."""
        return False

    def unrank(self, length: int, rank: int) -> Letters:
        """Raise an IndexError, because there are no words."""
        raise IndexError(rank)

    def rank(self, word: Letters) -> int | None:
        """Return None, because there are no words."""
        return None

    def weighed(self, length: int, weights: Weights, *, goals: bool = False, plain: bool = False) -> Weighed:
        """Return the weighted words of a length."""
        return weigh_words((), self.letters, self.model, self.level, length, Weights(), goals=False)
