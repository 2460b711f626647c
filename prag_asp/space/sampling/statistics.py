"""Exact statistics of the words of a level when words are sampled by weight.

No word is enumerated: the weight of all words through an edge is the weight of all paths to it times the weight of all
paths from it (forward-backward algorithm, Baum et al. 1970), computed here with integers of any size.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import MAX_EMAX, MIN_EMIN, Context, Decimal, localcontext
from fractions import Fraction
from itertools import compress
from typing import Any

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.errors import QueryError
from prag_asp.processes.progress_events import counted, stage
from prag_asp.program.entity_names import action_name, mentioned_entities
from prag_asp.program.facts import Facts
from prag_asp.space.automaton.automaton import Automaton, Completions, avoiding, positive
from prag_asp.space.automaton.occurrences import occurrences_by_recurrence
from prag_asp.space.automaton.recurrence import SHORTEST, weight_of_length
from prag_asp.space.engines.engine import Engine, Level
from prag_asp.space.sampling.streams import weighed_words
from prag_asp.space.weights.weights import Weights
from prag_asp.wording import unknown

ENTROPY_PLACES = 30
"""The number of correct decimal places of an entropy."""

Objects = NDArray[np.object_]
"""Integers of any size."""


@dataclass(frozen=True)
class Statistics:
    """Exact statistics of a random word (a plan, task or skeleton of `length` letters), sampled by weight.

    `words` is the number of words of positive weight and `total_weight` the sum of their weights. `entropy` is in bits,
    with 30 decimal places. The `expected` mappings hold the expected numbers of occurrences of an action, of a name and
    of two consecutive names; the `contains` mappings hold the probability that a word contains an action, a name, an
    entity, or an entity of a class. Actions, names and pairs that never occur are absent; entities and classes are
    complete. Skeletons have only names and pairs.
    """

    by: Level
    length: int
    words: int
    total_weight: Fraction
    entropy: Decimal
    expected_actions: Mapping[str, Fraction]
    expected_names: Mapping[str, Fraction]
    expected_pairs: Mapping[tuple[str, str], Fraction]
    contains_action: Mapping[str, Fraction]
    contains_name: Mapping[str, Fraction]
    contains_entity: Mapping[str, Fraction]
    contains_class: Mapping[str, Fraction]


def statistics_of(engine: Engine, facts: Facts, by: Level, length: int, weights: Weights) -> Statistics:
    """Return the statistics of the words of a given level and length when they are sampled by weight.

    Raises:
        QueryError: there is nothing to sample.
    """
    weighed = weighed_words(engine, by, length, weights, plain=True)
    stage("summing up statistics")
    letters = engine.letters
    name_of = letters if by == "skeleton" else tuple(_names(facts, letters))
    names = sorted(set(name_of))
    numbers = np.array([names.index(name) for name in name_of], dtype=np.int64)
    total = weighed.total(length)
    occurring = occurrences(weighed.completions, length, weighed.automaton.letters, len(letters))
    by_name = _summed(occurring, numbers, len(names))
    pairs = consecutive(weighed.completions, length, numbers)
    own = {letter: {number} for number, letter in enumerate(letters)}
    entities, classes = ({}, {}) if by == "skeleton" else _mentions(facts, letters)

    def shares(weights: Sequence[int], keys: Sequence[Any]) -> dict[Any, Fraction]:
        return {key: Fraction(weight, total) for key, weight in zip(keys, weights, strict=True) if weight}

    def containing(sets: Mapping[str, Collection[int]]) -> dict[str, Fraction]:
        others = {key: Completions(avoiding(weighed.automaton, excluded)) for key, excluded in sets.items()}
        return {
            key: 1 - Fraction(weight_of_length(others[key], length), total)
            for key in counted(list(others), "probabilities")
        }

    actions = {} if by == "skeleton" else shares(occurring, letters)
    named = shares(by_name, names)
    return Statistics(
        by,
        length,
        weight_of_length(Completions(replace(positive(weighed.automaton), weights=None)), length),
        total * weighed.unit,
        entropy(weighed.completions, length, total),
        actions,
        named,
        {(names[one], names[two]): Fraction(weight, total) for (one, two), weight in sorted(pairs.items())},
        containing({action: own[action] for action in actions}),
        containing({name: set(np.flatnonzero(numbers == names.index(name)).tolist()) for name in named}),
        containing(entities),
        containing(classes),
    )


def weight_of_words_without(
    engine: Engine, facts: Facts, by: Level, length: int, weights: Weights, what: Collection[str]
) -> Fraction:
    """Return the weight of all words of a given level and length that lack certain names and pairs of names.

    Raises:
        QueryError: an item is neither an action's name nor a pair of names.
    """
    weighed = engine.weighed(length, weights, plain=True)
    letters = engine.letters
    name_of = letters if by == "skeleton" else tuple(_names(facts, letters))
    numbers = {name: number for number, name in enumerate(sorted(set(name_of)))}
    patterns = [tuple(part.strip() for part in text.split(">")) for text in what]
    declared = numbers.keys() | {action_name(action) for action in (*facts.actions, *facts.pruned)}
    for name in (name for pattern in patterns for name in pattern):
        if name not in declared:
            raise QueryError(unknown(name, sorted(declared), "action"))
    patterns = [pattern for pattern in patterns if numbers.keys() >= {*pattern}]  # other patterns never occur
    single = {numbers[pattern[0]] for pattern in patterns if len(pattern) == 1}
    pairs = {(numbers[pattern[0]], numbers[pattern[1]]) for pattern in patterns if len(pattern) == 2}
    places = np.array([numbers[name] for name in name_of], dtype=np.int64)
    return weight_without(weighed.automaton, length, places, single, pairs) * weighed.unit


def _names(facts: Facts, letters: Sequence[str]) -> Iterator[str]:
    names = {str(action): action_name(action) for action in facts.actions}
    return (names[letter] for letter in letters)


def _mentions(facts: Facts, letters: Sequence[str]) -> tuple[dict[str, set[int]], dict[str, set[int]]]:
    """Return the letters that use each entity, and the letters that use an entity of each class."""
    symbols = {str(action): action for action in facts.actions}
    by_entity: dict[str, set[int]] = {str(entity): set() for entity in facts.entities}
    by_class: dict[str, set[int]] = {str(name): set() for _, name in sorted(facts.memberships, key=str)}
    classes: dict[clingo.Symbol, list[str]] = {}
    for entity, name in facts.memberships:
        classes.setdefault(entity, []).append(str(name))
    for number, letter in enumerate(letters):
        for entity in mentioned_entities(symbols[letter], facts.entities):
            by_entity[str(entity)].add(number)
            for kind in classes.get(entity, ()):
                by_class[kind].add(number)
    return by_entity, by_class


def occurrences(completions: Completions, length: int, kinds: NDArray[np.int64], size: int) -> list[int]:
    """Return, for each kind of edge, the sum over all words of the weight times the number of edges of that kind.

    `kinds` holds the kind of each edge, from 0 to `size` - 1, shape (edges,).
    """
    marks = [(kinds == kind,) for kind in range(size)]
    weights = occurrences_by_recurrence(completions.automaton, marks, length)
    if weights is None:
        crossings = np.zeros(len(kinds), dtype=object)
        for step, over in _forward(completions.automaton, length):
            crossings += over * completions.row(length - step - 1)[completions.automaton.targets].astype(object)
        weights = _summed(crossings, kinds, size)
    return weights


def consecutive(completions: Completions, length: int, names: NDArray[np.int64]) -> dict[tuple[int, int], int]:
    """Return, for each pair of names, the sum over all words of the weight times the number of such pairs.

    `names` maps letters to numbers of names.
    """
    automaton = completions.automaton
    if not len(automaton.letters):
        return {}
    named = names[automaton.letters]
    width = int(names.max()) + 1
    coming, into = np.unique(automaton.targets * width + named, return_inverse=True)
    leaving, out_of = np.unique(automaton.sources * width + named, return_inverse=True)
    first = np.searchsorted(leaving, coming // width * width)
    counts = np.searchsorted(leaving, (coming // width + 1) * width) - first
    left = np.repeat(np.arange(len(coming)), counts)
    right = np.arange(len(left)) + np.repeat(first - np.cumsum(counts) + counts, counts)
    if length > SHORTEST:
        found = np.unique(np.stack([coming[left] % width, leaving[right] % width]), axis=1).T.tolist()
        counts = occurrences_by_recurrence(automaton, [(named == one, named == two) for one, two in found], length)
        if counts is not None:
            return {(one, two): weight for (one, two), weight in zip(found, counts, strict=True) if weight}
    sums = np.zeros(len(left), dtype=object)
    factors = _factors(automaton)
    for step, over in _forward(automaton, length - 1):
        behind = factors * completions.row(length - step - 2)[automaton.targets].astype(object)
        before, after = _summed(over, into, len(coming)), _summed(behind, out_of, len(leaving))
        sums += np.array(before, dtype=object)[left] * np.array(after, dtype=object)[right]
    weights: dict[tuple[int, int], int] = {}
    for one, two, weight in zip((coming[left] % width).tolist(), (leaving[right] % width).tolist(), sums, strict=True):
        if weight:
            weights[one, two] = weights.get((one, two), 0) + int(weight)
    return weights


def weight_without(
    automaton: Automaton,
    length: int,
    names: NDArray[np.int64],
    single: Collection[int],
    pairs: Collection[tuple[int, int]],
) -> int:
    """Return the weight of all words that have none of the `single` names and `pairs` of consecutive names.

    `names` maps letters to numbers of names. States are split according to the name of the preceding action.
    """
    if not automaton.states:
        return 0
    width = int(names.max(initial=-1)) + 1
    may_follow = np.ones((width + 1, width), dtype=np.bool_)
    for one, two in pairs:
        may_follow[one, two] = False
    may_follow[:, list(single)] = False
    named = names[automaton.letters]
    coming, into = np.unique(automaton.targets * (width + 1) + named, return_inverse=True)
    states, before = np.divmod(np.concatenate([[width], coming]), width + 1)
    degrees = np.diff(automaton.offsets)[states]
    begins = np.cumsum(degrees) - degrees
    edges = np.arange(degrees.sum()) + np.repeat(automaton.offsets[states] - begins, degrees)
    kept = may_follow[np.repeat(before, degrees), named[edges]]
    left = edges[kept]
    apart = Automaton(
        np.concatenate([[0], np.cumsum(kept)])[np.append(begins, len(edges))],
        automaton.letters[left],
        into[left] + 1,
        automaton.accepting[states],
        None if automaton.weights is None else automaton.weights[left],
    )
    return weight_of_length(Completions(apart), length)


def entropy(completions: Completions, length: int, total: int) -> Decimal:
    """Return the entropy in bits of a word sampled by weight: log2 of the total minus the expected log2 of a weight.

    The expected numbers of edges are exact; only the logarithms are rounded.
    """
    factors = _factors(completions.automaton).tolist()
    different = sorted({*factors} - {0, 1})
    places = {weight: place for place, weight in enumerate(different, 1)}
    kinds = np.array([places.get(weight, 0) for weight in factors], dtype=np.int64)
    passed = occurrences(completions, length, kinds, len(different) + 1)[1:] if different else []
    by_weight = dict(zip(different, passed, strict=True))
    with localcontext(Context(prec=2 * ENTROPY_PLACES + 20, Emax=MAX_EMAX, Emin=MIN_EMIN)):
        spent = sum((Decimal(passed) / total * Decimal(weight).ln() for weight, passed in by_weight.items()), Decimal())
        bits = (Decimal(total).ln() - spent) / Decimal(2).ln()
        return abs(bits.quantize(Decimal(1).scaleb(-ENTROPY_PLACES)))


def _forward(automaton: Automaton, length: int) -> Iterator[tuple[int, Objects]]:
    """Yield, for each step from 0 on, the weight of all paths that end with each edge, shape (edges,)."""
    row = np.zeros(automaton.states, dtype=object)
    row[0] = 1
    factors = _factors(automaton)
    for step in counted(range(length), "steps"):
        over = row[automaton.sources] * factors
        yield step, over
        row = np.array(_summed(over, automaton.targets, automaton.states), dtype=object)


def _factors(automaton: Automaton) -> Objects:
    if automaton.weights is not None:
        return automaton.weights.astype(object)
    return np.ones(len(automaton.letters), dtype=np.int64).astype(object)


def _summed(values: Sequence[int] | Objects, places: NDArray[np.int64], size: int) -> list[int]:
    """Return `size` sums: the i-th is the sum of the values whose entry in `places` is i."""
    sums = [0] * size
    for place, value in compress(zip(places.tolist(), values, strict=True), values):
        sums[place] += value
    return sums
