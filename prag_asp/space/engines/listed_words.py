"""The words of a level and length with their weights, listed: for engines that find words one by one."""

from __future__ import annotations

from collections.abc import Iterable

from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.space.engines.engine import Letters, Level
from prag_asp.space.plans.task_builder import Narrator
from prag_asp.space.weights.tree import word_tree
from prag_asp.space.weights.weights import Weighed, Weights, refuse_weights


def listed(
    words: Iterable[Letters],
    letters: Letters,
    model: DomainLogic,
    level: Level,
    length: int,
    weights: Weights,
    goals: bool,
) -> Weighed:
    """Return all words of a level and length with their weights; with `goals`, also what is known after each.

    Raises:
        QueryError: the weights tell interchangeable entities apart, or skeletons are weighed.
    """
    refuse_weights(level, weights, model, length)
    everything = list(words)
    numbers = {letter: number for number, letter in enumerate(letters)}
    spelled = [[numbers[letter] for letter in word] for word in everything]
    if level == "skeleton":
        return word_tree(spelled, length)
    actions = {str(action): action for action in model.domain.facts.actions}
    weighs = [weights.of_plan([actions[letter] for letter in word]) for word in everything] if weights else None
    return word_tree(spelled, length, weighs, Narrator(model).last_states(everything) if goals else None)
