"""Sampling weights of tasks, as exact fractions.

The weight of a plan is the product of the weights of its actions, of its pairs of consecutive actions, and of the
distinct entities that it uses; the weight of an entity includes the weights of its classes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import pairwise
from math import lcm, prod
from typing import Protocol

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.errors import QueryError
from prag_asp.exact_numbers import Number, parse_number
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.program.entity_names import action_name, mentioned_entities, refuse_ambiguous, shared_names
from prag_asp.program.facts import Facts
from prag_asp.program.predicates import FINDING, REQUEST
from prag_asp.space.automaton.automaton import Automaton, Completions, Word
from prag_asp.space.automaton.recurrence import weight_of_length
from prag_asp.space.automaton.walks import Choice
from prag_asp.wording import unknown

MOST_BITS, FEW_BITS = 1 << 19, 64
"""Maximum number of bits of an exact total; it does not apply to weights of at most `FEW_BITS` bits per step.

The maximum is about 158,000 digits. Each state has a total for each number of remaining steps. In the domain `prag`,
totals of this size take minutes.
"""

MANY_KINDS = 1 << 61
"""Above this bound, the numbers of edge kinds are compressed, so that twice such a number still fits into 64 bits."""


@dataclass(frozen=True)
class Weights:
    """The weights that differ from 1: of action names, of pairs of names, of single actions, and of entities."""

    names: Mapping[str, Fraction] = field(default_factory=dict)
    pairs: Mapping[tuple[str, str], Fraction] = field(default_factory=dict)
    actions: Mapping[clingo.Symbol, Fraction] = field(default_factory=dict)
    entities: Mapping[clingo.Symbol, Fraction] = field(default_factory=dict)

    def __bool__(self) -> bool:
        return any((self.names, self.pairs, self.actions, self.entities))

    @property
    def of_actions_alone(self) -> bool:
        """Whether the weight of a plan is the product of the weights of its single actions."""
        return not self.pairs and not self.entities

    def of_action(self, action: clingo.Symbol) -> Fraction:
        """Return the weight of a single occurrence of an action."""
        return self.names.get(action_name(action), Fraction(1)) * self.actions.get(action, Fraction(1))

    def of_plan(self, plan: Sequence[clingo.Symbol]) -> Fraction:
        """Return the weight of a whole plan."""
        weight = prod(map(self.of_action, plan), start=Fraction(1))
        names = [action_name(action) for action in plan]
        for pair in pairwise(names):
            weight *= self.pairs.get(pair, Fraction(1))
        used = {entity for action in plan for entity in mentioned_entities(action, self.entities)}
        return prod((self.entities[entity] for entity in used), start=weight)


def parse_weights(stated: Mapping[str, Number], facts: Facts) -> Weights:
    """Parse weights whose keys are texts such as ``grasp``, ``grasp>move``, ``apple`` or ``apple_1``.

    A key is an action's name, a pair of names, a single action, an entity or a class. Floats are refused because their
    decimal digits are not their exact value.

    Raises:
        QueryError: a key is unknown or ambiguous, or a weight is not a number of at least 0.
    """
    names = {action_name(action) for action in facts.declared_actions}
    classes = {str(name): name for name in facts.classes}
    entities = {str(entity): entity for entity in facts.entities}
    actions = {str(action): action for action in facts.declared_actions}
    shared = shared_names(facts)
    by_name: dict[str, Fraction] = {}
    pairs: dict[tuple[str, str], Fraction] = {}
    singles: dict[clingo.Symbol, Fraction] = {}
    by_entity = dict.fromkeys(facts.entities, Fraction(1))
    for key, number in stated.items():
        weight = parse_weight(key, number)
        first, arrow, second = (part.strip() for part in key.partition(">"))
        if arrow:
            if first not in names or second not in names:
                raise QueryError(unknown(first if first not in names else second, sorted(names), "action"))
            pairs[first, second] = weight
        elif key in shared:
            refuse_ambiguous(key, facts)
        elif key in names:
            by_name[key] = weight
        elif key in actions:
            singles[actions[key]] = weight
        elif key in entities:
            by_entity[entities[key]] *= weight
        elif key in classes:
            for entity in facts.entities:
                if (entity, classes[key]) in facts.memberships:
                    by_entity[entity] *= weight
        else:
            raise QueryError(unknown(key, sorted({*names, *classes, *entities}), "action, class or entity"))
    return Weights(
        {key: weight for key, weight in by_name.items() if weight != 1},
        {key: weight for key, weight in pairs.items() if weight != 1},
        {key: weight for key, weight in singles.items() if weight != 1},
        {key: weight for key, weight in by_entity.items() if weight != 1},
    )


def parse_weight(key: str, number: Number) -> Fraction:
    """Return a weight as a fraction, read from decimal digits or from p/q.

    Raises:
        QueryError: the value is not a number of at least 0.
    """
    weight = parse_number(f"weight of {key!r}", number)
    if weight < 0:
        raise QueryError(f"weight of {key!r}: {number} is below 0; the smallest weight is 0, which means never")
    return weight


def refuse_weights(level: str, weights: Weights, model: DomainLogic, length: int) -> None:
    """Refuse weights that a level does not support.

    Raises:
        QueryError: skeletons have weights, or two interchangeable entities of tasks have different weights.
    """
    if weights and level == "skeleton":
        raise QueryError("skeletons have no weights; choose task or plan, or give weights={} (--uniform)")
    if weights and level == "task":
        refuse_unequal(weights, model.symmetries(length).orbits)


def refuse_long_totals(weights: Weights, length: int) -> None:
    """Refuse weights with so many digits that exact sums of products of `length` weights are too long to compute.

    Raises:
        QueryError: the totals have too many digits.
    """
    bits = 0
    for table in (weights.names, weights.pairs, weights.actions, weights.entities):
        scale = lcm(*(weight.denominator for weight in table.values()))
        bits += max(int(weight * scale).bit_length() for weight in (*table.values(), Fraction(1)))
    if bits > FEW_BITS and bits * length > MOST_BITS:
        digits, most = bits * 3 // 10, MOST_BITS // length * 3 // 10
        raise QueryError(
            f"the weights have {digits:,} digits together, too many for exact totals at length {length:,}; "
            f"round them to about {most} digits together, such as 1.33 or 4/3, or choose a smaller length"
        )


def refuse_unequal(weights: Weights, groups: Sequence[Sequence[clingo.Symbol]]) -> None:
    """Refuse weights that differ between interchangeable entities, because a task does not distinguish them.

    Raises:
        QueryError: two interchangeable entities have different weights.
    """
    for group in groups:
        first = weights.entities.get(group[0], Fraction(1))
        for entity in group:
            if weights.entities.get(entity, Fraction(1)) != first:
                raise QueryError(
                    f"{group[0]} and {entity} are interchangeable, so a task cannot prefer one of them; "
                    "give a weight to their class, or sample plans"
                )
        named = {str(entity) for entity in group}
        for action in weights.actions:
            if named & {str(entity) for entity in mentioned_entities(action, set(group))}:
                raise QueryError(
                    f"{action} names one of the interchangeable {', '.join(sorted(named))}; draw plans instead"
                )


def weighing_facts(weights: Weights) -> tuple[list[str], list[clingo.Symbol]]:
    """Return the facts for ``rules/weights.lp``, and the atoms that this file derives for weighing an edge."""
    pairs = [clingo.Function("weighed", list(map(clingo.Function, pair))) for pair in sorted(weights.pairs)]
    entities = [clingo.Function("weighed", [entity]) for entity in sorted(weights.entities)]
    findings = [clingo.Function("follows", pair.arguments) for pair in pairs]
    findings += [clingo.Function("first_use", entity.arguments) for entity in entities]
    return [REQUEST.fact(term) for term in (*pairs, *entities)], [FINDING.timeless(term) for term in findings]


class Walks(Protocol):
    """Words of one length that are chosen letter by letter; `total` is the sum of their weights."""

    total: int

    def walk(self, choose: Choice) -> tuple[Word, int]:
        """Return a word and its weight.

        At each step, `choose` selects an edge, given the running totals of the weights.
        """
        ...


@dataclass(frozen=True)
class Weighed:
    """The words of a level as paths of an automaton; a word's weight is the product of its edge weights, times `unit`.

    `goals` holds the number of the known final state after each edge, shape (edges,), and `goal_values` the values of
    these states, as in `FluentValues`, shape (fluents, goals); both are None if they were not requested. `ranking`
    finds the words if a path stands for several words, or if the automaton is empty because states are not listed; it
    is None if each path is one word.
    """

    completions: Completions
    unit: Fraction = Fraction(1)
    goals: NDArray[np.int64] | None = None
    ranking: Walks | None = None
    goal_values: NDArray[np.int8] | None = None

    @property
    def automaton(self) -> Automaton:
        """The automaton."""
        return self.completions.automaton

    def total(self, length: int) -> int:
        """Return the sum of the weights of all words of a given length, as a multiple of `unit`."""
        if self.ranking is not None:
            return self.ranking.total
        return weight_of_length(self.completions, length)


def edge_weights(actions: Sequence[clingo.Symbol], weights: Weights) -> tuple[list[Fraction], list[Fraction]]:
    """Return the weight of an edge for each action, and the factor for each true label of `weighing_facts`."""
    by_label = [weights.pairs[pair] for pair in sorted(weights.pairs)]
    by_label += [weights.entities[entity] for entity in sorted(weights.entities)]
    return [weights.of_action(action) for action in actions], by_label


def weigh(
    automaton: Automaton, labels: NDArray[np.bool_], actions: Sequence[clingo.Symbol], weights: Weights
) -> tuple[Automaton, int]:
    """Return the automaton with integer edge weights, and the factor by which these exceed the exact weights.

    `actions` are the letters of the automaton; the columns of `labels`, shape (edges, labels), are the atoms of
    `weighing_facts`.
    """
    by_letter, by_label = edge_weights(actions, weights)
    kinds = automaton.letters.astype(np.int64)  # a kind is a letter with labels
    for column in labels.T:
        kinds = 2 * kinds + column
        if kinds.max(initial=0) > MANY_KINDS:
            kinds = np.unique(kinds, return_inverse=True)[1]
    _, first, kinds = np.unique(kinds, return_index=True, return_inverse=True)
    fractions = [
        prod((by_label[label] for label in np.flatnonzero(labels[edge])), start=by_letter[int(automaton.letters[edge])])
        for edge in first
    ]
    scale = lcm(*(fraction.denominator for fraction in fractions))
    whole = np.array([int(fraction * scale) for fraction in fractions], dtype=object)
    return replace(automaton, weights=whole[kinds]), scale
