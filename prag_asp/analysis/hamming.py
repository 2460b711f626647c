"""The exact distribution of the Hamming distance between two random words of a space.

The distance between two tasks is the smallest number of different actions over all renamings of one of them. Pairs of
words are pairs of paths of the layered automaton. For each pair of states, the dynamic programme counts the pairs of
paths to the end by their numbers of agreements under each renaming. It compares only letters of the same orbit, because
letters of different orbits differ under all renamings. The recursion for one renaming and matrices M of pairs of states
is M' = A M A^T + (z - 1) sum_a A_a M A_a^T, where A_a contains the edges with letter a, and z counts agreements.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from prag_asp.analysis.layered_automaton import LayeredAutomaton, LayerEdges, layered_words, sums_at
from prag_asp.analysis.letter_renamings import letter_renamings
from prag_asp.errors import LimitReached, QueryError
from prag_asp.processes.machine import usual_memory
from prag_asp.processes.progress_events import stage
from prag_asp.space.engines import Level
from prag_asp.space.limits import LimitClock
from prag_asp.space.task_space import TaskSpace
from prag_asp.stop_reason import StopKind, StopReason

Agreements = int
"""The number of agreements between two words under each renaming, as the digits of one integer in base length + 1."""

SAFE = 2**62
"""A bound on sums that are computed in 64 bits."""

PRIMES_FROM = 2**31
"""Moduli are primes below this number, so that a sum of 2^31 residues fits into 64 bits."""

TOGETHER = 1 << 22
"""The number of integers processed at a time, 32 MiB: enough to amortise the overhead of NumPy."""

COMPARED = 1 << 33
"""The maximum number of letters to compare when all pairs of words are listed; this takes about 10 s."""

FEW_COMPARED = 1 << 26
"""The number of compared letters up to which all pairs of words are simply listed, in less than a second."""

MOST_AGREEMENTS = 1 << 15
"""The maximum number of distinct agreements in a layer."""


@dataclass(frozen=True)
class DistanceDistribution:
    """The number of ordered pairs of words of a level at each Hamming distance 0, 1, ..., `length`.

    Both words of a pair range over all `words` and may be equal, as in two independent samples.
    """

    by: Level
    length: int
    words: int
    pairs: tuple[int, ...]

    @property
    def mean(self) -> Fraction:
        """The exact mean distance between two independent random words."""
        return Fraction(sum(distance * number for distance, number in enumerate(self.pairs)), self.words**2)

    @property
    def mean_of_different(self) -> Fraction:
        """The exact mean distance between two different random words, or 0 if there is only one word."""
        return self.mean * Fraction(self.words, max(self.words - 1, 1))

    def share(self, distance: int) -> Fraction:
        """Return the probability that two independent random words are at most `distance` apart."""
        return Fraction(sum(self.pairs[: distance + 1]), self.words**2)


def hamming_distribution(space: TaskSpace, by: Level = "task") -> DistanceDistribution:
    """Return the exact distribution of the Hamming distance between two random plans, tasks or skeletons of a space.

    Raises:
        QueryError: the space has several lengths or is empty, or it has too many renamings or states.
        LimitReached: a limit was reached, or the forecast memory exceeds the limit.
    """
    clock = space.engines.limits.begin()
    words = layered_words(space, by)
    if not words.total:
        raise QueryError(f"there is no {by} of {space.title} to compare")
    renamings = letter_renamings(space, by, words.letters)
    stage("comparing all pairs")
    pairs = AgreementCount(space, words, renamings, clock).pairs()
    return DistanceDistribution(by, space.length, words.total, tuple(pairs))


def mean_hamming(space: TaskSpace, by: Level = "plan") -> Fraction:
    """Return the exact mean Hamming distance between two independent random plans or skeletons, at any length.

    The mean depends only on the number of occurrences of each letter at each position. For tasks, see
    `hamming_distribution`.

    Raises:
        QueryError: the level is task, or the space has several lengths or is empty.
        LimitReached: a limit ended the exploration.
    """
    if by == "task":
        raise QueryError("the mean of tasks needs their distribution, hamming_distribution; choose plan or skeleton")
    words = layered_words(space, by)
    if words.edges is None:
        raise QueryError(f"there is no {by} of {space.title} to compare")
    same = 0
    for step, before, after in zip(words.edges, words.beginnings, words.completions[1:], strict=False):
        through = before[step.sources] * after[step.targets]
        same += sum(number**2 for number in sums_at(through, step.letters, len(words.letters)))
    return words.length - Fraction(same, words.total**2)


class AgreementCount:
    """The dynamic programme that counts pairs of words by their agreements under each renaming."""

    def __init__(
        self, space: TaskSpace, words: LayeredAutomaton, renamings: NDArray[np.int64], clock: LimitClock
    ) -> None:
        self._space = space
        self._words = words
        self._renamings = renamings
        self._clock = clock
        self._base = words.length + 1
        self._related = related_letters(renamings, self._base)

    def pairs(self) -> list[int]:
        """Return the number of ordered pairs of words at each distance."""
        words, length, renamings = self._words, self._words.length, len(self._renamings)
        compared = words.total**2 * renamings * max(length, 1)
        layers = None if compared < FEW_COMPARED else self._agreements()
        if layers is None:
            if compared > COMPARED:
                self._refuse(f"need more than {COMPARED:,} comparisons of actions")
            return listed_pairs(words.words(), self._renamings)
        self._forecast(layers)
        counts = [0] * (length + 1)
        for agreements, number in zip(layers[0], self._counted(layers), strict=True):
            most = max(agreements // self._base**place % self._base for place in range(renamings))
            counts[length - most] += number
        return counts

    def _agreements(self) -> list[list[Agreements]] | None:
        """Return the agreements that pairs of paths from each layer can have, or None if there are too many."""
        reached = {0}
        layers = [[0]]
        for step in reversed(self._words.edges or ()):
            used = set(step.letters.tolist())
            before = list(reached)
            for kind in {kind for one, other, kind in self._related if one in used and other in used}:
                reached.update(vector + kind for vector in before)
                if len(reached) > MOST_AGREEMENTS:
                    return None
            layers.append(sorted(reached))
        return layers[::-1]

    def _forecast(self, layers: Sequence[Sequence[Agreements]]) -> None:
        """Check that every two consecutive layers fit into memory.

        Raises:
            LimitReached: the memory limit would be exceeded.
        """
        sizes = [size**2 * len(vectors) for size, vectors in zip(self._words.sizes, layers, strict=True)]
        needed = 8 * (max(map(sum, pairwise(sizes)), default=1) + 4 * TOGETHER)
        if self._clock.reached_limit(needed) or needed > usual_memory():
            self._refuse(f"need {needed / 1e6:,.0f} MB")

    def _refuse(self, why: str) -> None:
        memory = self._space.engines.limits.memory_bytes or usual_memory()
        raise LimitReached(
            f"the pairs of {self._space.title} under {len(self._renamings):,} renamings {why}; "
            "compare plans or skeletons, or take a shorter length",
            0,
            StopReason(StopKind.MEMORY, memory),
        )

    def _counted(self, layers: Sequence[Sequence[Agreements]]) -> list[int]:
        """Return the number of pairs of words that have each of the agreements of the first layer."""
        most = self._words.total**2
        if most < SAFE:
            return self._residues(layers, 0)
        modulus, counts = 1, [0] * len(layers[0])
        for prime in primes_below(PRIMES_FROM):  # the Chinese remainder theorem, by Garner's algorithm
            inverse = pow(modulus, -1, prime)
            for place, residue in enumerate(self._residues(layers, prime)):
                counts[place] += modulus * ((residue - counts[place]) * inverse % prime)
            modulus *= prime
            if modulus > most:
                break
        return counts

    def _residues(self, layers: Sequence[Sequence[Agreements]], prime: int) -> list[int]:
        """Return the result of `_counted` modulo a prime, or the exact result if `prime` is 0."""
        matrices = np.ones((1, 1, 1), dtype=np.int64)
        steps = self._words.edges or ()
        for place in range(len(steps) - 1, -1, -1):
            reason = self._clock.reached_limit()
            if reason:
                raise LimitReached(f"{reason.prose()} was reached while all pairs were compared; allow more", 0, reason)
            matrices = self._before(steps[place], matrices, layers[place + 1], layers[place], prime)
        return [int(number) for number in matrices[:, 0, 0]]

    def _before(
        self,
        step: LayerEdges,
        matrices: NDArray[np.int64],
        vectors: Sequence[Agreements],
        following: Sequence[Agreements],
        prime: int,
    ) -> NDArray[np.int64]:
        """Return the matrices of a layer, shape (agreements, states, states), computed from those of the next layer."""
        number = {vector: place for place, vector in enumerate(following)}
        same = np.array([number[vector] for vector in vectors])
        result = np.zeros((len(following), step.states, step.states), dtype=np.int64)
        for part in _parts(len(vectors), len(step.letters) * max(matrices.shape[1], step.states)):
            result[same[part]] = both_steps(step, matrices[part], prime)
        order = np.argsort(step.letters, kind="stable")
        bounds = np.searchsorted(step.letters[order], np.arange(self._renamings.shape[1] + 1)).tolist()
        for one, other, kind in self._related:
            left, right = order[bounds[one] : bounds[one + 1]], order[bounds[other] : bounds[other + 1]]
            if not (len(left) and len(right)):
                continue
            further = np.array([number[vector + kind] for vector in vectors])
            for part in _parts(len(vectors), len(left) * len(right)):
                # a state has at most one edge per letter, so no element of the block occurs twice
                block = matrices[part][:, step.targets[left][:, None], step.targets[right]]
                result[np.ix_(same[part], step.sources[left], step.sources[right])] -= block
                result[np.ix_(further[part], step.sources[left], step.sources[right])] += block
        return result % prime if prime else result


def related_letters(renamings: NDArray[np.int64], base: int) -> list[tuple[int, int, Agreements]]:
    """Return the pairs of letters of one orbit; digit 1 marks the renamings that map the second letter to the first."""
    related = []
    powers = [base**place for place in range(len(renamings))]
    for other, images in enumerate(renamings.T.tolist()):
        kinds: dict[int, Agreements] = {}
        for image, power in zip(images, powers, strict=True):
            kinds[image] = kinds.get(image, 0) + power
        related += [(one, other, kind) for one, kind in kinds.items() if one >= 0]
    return related


def both_steps(step: LayerEdges, matrices: NDArray[np.int64], prime: int) -> NDArray[np.int64]:
    """Return A M A^T for each matrix M, shape (matrices, states, states), where A has the edges of a step."""
    rows = np.add.reduceat(matrices[:, step.targets, :], step.begins, axis=1)
    if prime:
        rows %= prime
    sums: NDArray[np.int64] = np.add.reduceat(rows[:, :, step.targets], step.begins, axis=2)
    return sums % prime if prime else sums


def listed_pairs(words: NDArray[np.int64], renamings: NDArray[np.int64]) -> list[int]:
    """Return the number of ordered pairs of words, shape (words, length), at each distance, by comparing all pairs."""
    length = words.shape[1]
    counts = np.zeros(length + 1, dtype=np.int64)
    narrow = np.int16 if renamings.shape[1] < 2**15 else np.int64
    columns = words.T.astype(narrow)
    for images in renamings.astype(narrow)[:, words].transpose(1, 0, 2):
        agreements = sum((image[:, None] == column for image, column in zip(images.T, columns, strict=True)),
                         start=np.zeros((len(renamings), len(words)), dtype=np.int16))  # fmt: skip
        counts += np.bincount(length - agreements.max(axis=0), minlength=length + 1)
    return [int(count) for count in counts]


def primes_below(bound: int) -> Iterator[int]:
    """Yield the primes below a bound of at most 2^32, from the largest down."""
    for number in range(bound - 1, 2, -1):
        if number % 2 and all(pow(base, number - 1, number) == 1 for base in (2, 3)) and _is_prime(number):
            yield number


def _is_prime(number: int) -> bool:
    return all(number % divisor for divisor in range(3, int(number**0.5) + 1, 2))


def _parts(number: int, cost: int) -> Iterator[slice]:
    """Yield slices of `number` items, each slice with a total cost of about `TOGETHER`; `cost` is that of an item."""
    size = max(TOGETHER // max(cost, 1), 1)
    return (slice(begin, begin + size) for begin in range(0, number, size))
