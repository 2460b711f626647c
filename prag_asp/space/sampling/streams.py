"""Streams of random plans: a sampler for each request, and draws of one or several lengths in batches."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import Context, Decimal, localcontext
from fractions import Fraction
from functools import lru_cache, partial
from itertools import accumulate
from math import lcm
from typing import Protocol

import numpy as np

from prag_asp.batches import growing_ranges
from prag_asp.errors import QueryError
from prag_asp.processes.progress_events import stage
from prag_asp.program.entity_names import action_name
from prag_asp.program.facts import Facts
from prag_asp.random_bits import Bits, SeededBits
from prag_asp.space.engines.engine import Draw, Engine, Letters, Level
from prag_asp.space.sampling.choice_table import exact_choice
from prag_asp.space.sampling.samplers import (
    OVER,
    GoalSampler,
    Over,
    Sampler,
    SkeletonSampler,
    WalkSampler,
    WeightSampler,
)
from prag_asp.space.weights.weights import Weighed, Weights, refuse_long_totals

BATCH = 2048
"""Maximum number of words that are sampled together."""


class ProbablePlan(Protocol):
    """A sampled plan with its probability."""

    @property
    def word(self) -> tuple[str, ...]:
        """The texts of its actions."""
        ...

    @property
    def probability(self) -> Fraction:
        """The probability of the draw."""
        ...


@dataclass(frozen=True)
class Portion:
    """The words of one length: their letters, their sampler, and their total weight, which is above 0."""

    length: int
    letters: Letters
    sampler: Sampler
    weight: Fraction


def make_sampler(
    engine: Engine, facts: Facts, by: Level, length: int, weights: Weights, over: Over | None = None
) -> Sampler:
    """Return the sampler for the words of a given level and length; with `over`, skeletons or goals are sampled first.

    Raises:
        QueryError: there is nothing to sample, or the options contradict each other.
    """
    if over is not None and over not in OVER:
        raise QueryError(f"cannot sample over {over!r}; there are {', '.join(OVER)}")
    if over and by == "skeleton":
        raise QueryError(f"{over} are sampled first only for tasks and plans; choose task or plan")
    weighed = weighed_words(engine, by, length, weights, goals=over == "goals" and length > 0, plain=over is not None)
    if over == "skeletons":
        names = {str(action): action_name(action) for action in facts.actions}
        numbers = {name: number for number, name in enumerate(sorted(set(names.values())))}
        return SkeletonSampler(weighed, length, np.array([numbers[names[letter]] for letter in engine.letters]))
    if over == "goals" and length:
        return GoalSampler(weighed, length)
    return WalkSampler(weighed.ranking, length) if weighed.ranking else WeightSampler(weighed, length)


def weighed_words(
    engine: Engine, by: Level, length: int, weights: Weights, *, goals: bool = False, plain: bool = False
) -> Weighed:
    """Return the weighted words of a given level and length from the engine.

    Raises:
        QueryError: no word has a weight above 0, or exact totals of the weights have too many digits.
    """
    refuse_long_totals(weights, length)
    weighed = engine.weighed(length, weights, goals=goals, plain=plain)
    if not weighed.total(length):
        count = engine.count(length)
        why = f": all {count} weigh 0; raise a weight that is 0" if count else ""
        raise QueryError(f"there is no {by} of length {length} to sample{why}")
    return weighed


def sample_batches(sampler: Sampler, letters: Letters, seed: int) -> Iterator[list[Draw]]:
    """Yield words of one length, each with its probability, endlessly, in batches that grow.

    A draw depends only on the seed and its number.
    """
    stage("sampling")
    bits = SeededBits(seed)
    for first, size in growing_ranges(BATCH):
        yield _sample(sampler, letters, bits, first, size)


def _sample(
    sampler: Sampler, letters: Letters, bits: Bits, first: int, count: int, share: Fraction = Fraction(1)
) -> list[Draw]:
    """Return draws as texts; `share` is the probability of their length."""
    draws = sampler.sample(bits, first, count, with_probabilities=True)
    return [
        Draw(tuple([letters[letter] for letter in word]), probability if share == 1 else share * probability)
        for word, probability in zip(draws.letters.tolist(), draws.probabilities, strict=True)
    ]


def sample_batches_of_lengths(portions: Sequence[Portion], seed: int) -> Iterator[list[Draw]]:
    """Yield words, each with its probability among all portions, endlessly, in batches that grow.

    The length is sampled first, with its exact share of the weight as its probability. Lengths, and the words of each
    length, use independent random bits, so all draws are independent; a draw depends only on the seed and its number.
    """
    stage("sampling")
    scale = lcm(*(portion.weight.denominator for portion in portions))
    running = list(accumulate(int(portion.weight * scale) for portion in portions))
    lengths = SeededBits(seed, " lengths")
    total = sum((portion.weight for portion in portions), start=Fraction(0))
    bits = [SeededBits(seed, f" length {portion.length}") for portion in portions]
    used = [0] * len(portions)
    for first, size in growing_ranges(BATCH):
        words = enumerate(lengths.words(first, size, 1)[:, 0].tolist(), first)
        chosen = [exact_choice(running, word, partial(lengths.further, draw, 0)) for draw, word in words]
        draws: dict[int, Iterator[Draw]] = {}
        for number in sorted(set(chosen)):
            portion, count = portions[number], chosen.count(number)
            share = portion.weight / total
            draws[number] = iter(_sample(portion.sampler, portion.letters, bits[number], used[number], count, share))
            used[number] += count
        yield [next(draws[number]) for number in chosen]


@lru_cache(maxsize=1 << 16)
def log_probability(probability: Fraction) -> float:
    """Return the correctly rounded natural logarithm, so that every machine gives the same float."""
    with localcontext(Context(prec=40, Emax=10**9, Emin=-(10**9))):
        return float((Decimal(probability.numerator) / Decimal(probability.denominator)).ln())
