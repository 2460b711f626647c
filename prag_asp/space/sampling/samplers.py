"""Exact samplers of words: by weight, uniformly over skeletons first, and uniformly over goals first."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, partial
from itertools import accumulate
from sys import getsizeof
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from prag_asp.random_bits import Bits
from prag_asp.space.automaton.automaton import Automaton, Completions, Ranking, Word, positive
from prag_asp.space.automaton.skeletons import skeleton_automaton
from prag_asp.space.automaton.walks import Choice
from prag_asp.space.sampling.choice_table import exact_choice
from prag_asp.space.sampling.paths import PathSampler, chunks
from prag_asp.space.sampling.remaining_words import PathWalks
from prag_asp.space.weights.weights import Walks, Weighed

Over = Literal["skeletons", "goals"]
OVER: tuple[Over, ...] = ("skeletons", "goals")

KEPT_SUMS = 1 << 26
"""Maximum memory for the cached sums of skeletons, in bytes."""

Sums = tuple[list[dict[int, list[int]]], int]
"""The running totals of the weights of the moves of each state, for each step of a skeleton; and the total weight."""


@dataclass(frozen=True)
class DrawArray:
    """Words as numbers of letters, shape (draws, length), and their exact probabilities, if requested."""

    letters: NDArray[np.int32]
    probabilities: Sequence[Fraction] = ()


@dataclass
class WordGroup:
    """The words with one skeleton or goal: their total weight, and a function that walks to one of them."""

    total: int
    walk: Callable[[Choice], tuple[Word, int]]


class Sampler(Protocol):
    """A sampler of the words of one length."""

    def sample(self, bits: Bits, first: int, count: int, *, with_probabilities: bool) -> DrawArray:
        """Return the draws from number `first` onwards, optionally with their probabilities.

        A draw depends only on its number and the random bits.
        """
        ...


class WeightSampler:
    """A sampler of words with probabilities proportional to their weights."""

    def __init__(self, weighed: Weighed, length: int) -> None:
        self._automaton = weighed.automaton
        self._paths = PathSampler(weighed.completions, length)
        self._total = weighed.total(length)

    def sample(self, bits: Bits, first: int, count: int, *, with_probabilities: bool) -> DrawArray:
        """Return the draws from number `first` onwards."""
        edges = self._paths.sample(bits, first, count)
        letters = _letters(self._automaton, edges)
        return DrawArray(letters, _shares(self._automaton, edges, [self._total] * count) if with_probabilities else ())


class WalkSampler:
    """A sampler with the same distribution as `WeightSampler` that chooses one word at a time.

    It serves automata in which a path stands for several words, or whose states are not listed.
    """

    def __init__(self, ranking: Walks, length: int) -> None:
        self._ranking = ranking
        self._length = length

    def sample(self, bits: Bits, first: int, count: int, *, with_probabilities: bool) -> DrawArray:
        """Return the draws from number `first` onwards."""
        words, probabilities = [], []
        for number in range(first, first + count):
            drawn = bits.words(number, 1, self._length)[0].tolist()

            def choose(step: int, running: Sequence[int], number: int = number, drawn: list[int] = drawn) -> int:
                return exact_choice(running, drawn[step], partial(bits.further, number, step))

            word, weight = self._ranking.walk(choose)
            words.append(word)
            probabilities.append(Fraction(weight, self._ranking.total))
        letters = np.array(words, dtype=np.int32).reshape(count, self._length)
        return DrawArray(letters, probabilities if with_probabilities else ())


class GoalSampler:
    """A sampler that chooses a goal uniformly, and then a word with this goal by weight.

    A goal is the known part of a final state. Words are sampled backward, from their last edge to their first: in the
    automaton with reversed edges, each goal has a state from which the last edges of its words lead.
    """

    def __init__(self, weighed: Weighed, length: int) -> None:
        assert weighed.goals is not None, "goals have to be numbered before they are sampled"
        automaton = weighed.automaton
        self._length = length
        self._reversed, self._letters = _reversed(automaton, weighed.goals)
        self._completions = completions = Completions(self._reversed)
        row = completions.row(length)
        self._starts = np.flatnonzero(row[automaton.states :] != 0) + automaton.states
        self._totals = [int(row[state]) for state in self._starts.tolist()]
        self._paths = PathSampler(completions, length, self._starts)

    def sample(self, bits: Bits, first: int, count: int, *, with_probabilities: bool) -> DrawArray:
        """Return the draws from number `first` onwards; the first random word of each draw determines its goal."""
        running = list(range(1, len(self._starts) + 1))
        edges = np.empty((self._length, count), dtype=np.int64)
        goals = np.empty(count, dtype=np.int64)
        for begin, end in chunks(count, self._length + 1):
            words = bits.words(first + begin, end - begin, self._length + 1)
            goals[begin:end] = [
                exact_choice(running, word, partial(bits.further, number, self._length))
                for number, word in enumerate(words[:, 0].tolist(), first + begin)
            ]
            starts = self._starts[goals[begin:end]]
            edges[:, begin:end] = self._paths.descend(starts, words[:, 1:], bits, first + begin)
        letters = self._letters[edges[::-1]].T.astype(np.int32)
        if not with_probabilities:
            return DrawArray(letters)
        totals = [len(running) * self._totals[goal] for goal in goals.tolist()]
        return DrawArray(letters, _shares(self._reversed, edges, totals))

    @property
    def weights(self) -> Sequence[int]:
        """The total weight of the words with each goal, which is their number if there are no weights."""
        return self._totals

    def of_goal(self, goal: int, bits: Bits, number: int) -> list[int]:
        """Return a word with one goal, given by its index in `weights`, sampled by weight with draw `number`."""
        words = bits.words(number, 1, self._length)
        edges = self._paths.descend(self._starts[[goal]], words, bits, number)
        letters: list[int] = self._letters[edges[::-1, 0]].tolist()
        return letters

    @property
    def count(self) -> int:
        """The number of goals of words of positive weight."""
        return len(self._starts)

    def groups(self) -> Iterator[Walks]:
        """Yield walks to the words with each goal, which choose the last letter of a word first."""
        for start in self._starts.tolist():
            backward = PathWalks(self._completions, self._length, start)
            yield WordGroup(backward.total, partial(_walk_backward, backward))


def _reversed(automaton: Automaton, goals: NDArray[np.int64]) -> tuple[Automaton, NDArray[np.int64]]:
    """Return the automaton with its edges reversed and a new state for each goal, and the letter of each edge.

    Its words are the reversed words of the automaton; the states of goals follow the others.
    """
    last = np.flatnonzero(automaton.accepting[automaton.targets])
    origins = np.concatenate([np.arange(len(automaton.letters)), last])
    sources = np.concatenate([automaton.targets, automaton.states + goals[last]])
    order = np.lexsort((automaton.sources[origins], automaton.letters[origins], sources))
    states = automaton.states + int(goals.max(initial=-1)) + 1
    letters = automaton.letters[origins[order]]
    turned = replace(
        automaton,
        offsets=np.searchsorted(sources[order], np.arange(states + 1)).astype(np.int64),
        letters=letters,
        targets=automaton.sources[origins[order]],
        accepting=np.arange(states) == 0,
        weights=None if automaton.weights is None else automaton.weights[origins[order]],
    )
    return turned, letters


class SkeletonSampler:
    """A sampler that chooses a skeleton uniformly, and then a word with this skeleton by weight.

    `count` is the number of skeletons of words of positive weight.
    """

    def __init__(self, weighed: Weighed, length: int, names: NDArray[np.int64]) -> None:
        self._automaton = positive(weighed.automaton)
        self._length = length
        self._names = names
        self._completions = completions = Completions(skeleton_automaton(self._automaton, names)[0])
        self._skeletons = PathSampler(completions, length)
        self._skeleton_letters = completions.automaton.letters
        self.count = int(completions.row(length)[0])
        self._known: dict[tuple[int, ...], Sums] = {}
        self._kept = 0
        self._ranking: Ranking | None = None

    @cached_property
    def _moves(self) -> list[dict[int, list[tuple[int, int, int]]]]:
        """The edges, their targets and their weights, for each state and name."""
        automaton = self._automaton
        weights = [1] * len(automaton.letters) if automaton.weights is None else automaton.weights.tolist()
        moves: list[dict[int, list[tuple[int, int, int]]]] = [{} for _ in range(automaton.states)]
        columns = (automaton.sources, self._names[automaton.letters], automaton.targets)
        rows = zip(*(column.tolist() for column in columns), weights, strict=True)
        for edge, (source, name, target, weight) in enumerate(rows):
            moves[source].setdefault(name, []).append((edge, target, weight))
        return moves

    def sample(self, bits: Bits, first: int, count: int, *, with_probabilities: bool) -> DrawArray:
        """Return the draws from number `first` on; the first half of a draw's random words determines its skeleton."""
        edges = np.empty((self._length, count), dtype=np.int64)
        totals: list[int] = []
        for begin, end in chunks(count, 2 * self._length):
            words = bits.words(first + begin, end - begin, 2 * self._length)
            starts = np.zeros(end - begin, dtype=np.int64)
            skeleton_edges = self._skeletons.descend(starts, words[:, : self._length], bits, first + begin)
            skeletons = self._skeleton_letters[skeleton_edges].T.tolist()
            pairs = zip(skeletons, words[:, self._length :].tolist(), strict=True)
            for place, (skeleton, chosen) in enumerate(pairs, begin):
                path, total = self._with_skeleton(tuple(skeleton), chosen, partial(bits.further, first + place))
                edges[:, place] = path
                totals.append(self.count * total)
        return DrawArray(
            _letters(self._automaton, edges), _shares(self._automaton, edges, totals) if with_probabilities else ()
        )

    def of_rank(self, rank: int, bits: Bits, number: int) -> tuple[list[int], Fraction]:
        """Return a word with one skeleton, sampled by weight for draw `number`, and its probability given the skeleton.

        The skeleton is given by its rank, from 0 to `count` - 1.
        """
        words = bits.words(number, 1, self._length)[0].tolist()
        path, total = self._with_skeleton(self.skeleton(rank), words, partial(bits.further, number))
        edges = np.array(path, dtype=np.int64)[:, None]
        return _letters(self._automaton, edges)[0].tolist(), _shares(self._automaton, edges, [total])[0]

    def skeleton(self, rank: int) -> tuple[int, ...]:
        """Return the skeleton with a given rank, from 0 to `count` - 1, as numbers of names."""
        if self._ranking is None:
            self._ranking = Ranking(self._completions, self._length)
        return tuple(self._ranking.unrank(rank))

    def weight(self, rank: int) -> int:
        """Return the weight of the words with one skeleton, which is their number if there are no weights."""
        return self._sums(self.skeleton(rank))[1]

    def groups(self) -> Iterator[Walks]:
        """Yield walks to the words with each skeleton, in the order of the names."""
        ranking = Ranking(self._completions, self._length)
        for rank in range(self.count):
            skeleton = tuple(ranking.unrank(rank))
            _, total = self._sums(skeleton)
            yield WordGroup(total, partial(self._walk, skeleton))

    def _walk(self, skeleton: tuple[int, ...], choose: Choice) -> tuple[Word, int]:
        """Return a word with a skeleton, chosen letter by letter, and its weight."""
        sums, _ = self._sums(skeleton)
        state, weight, word = 0, 1, list[int]()
        for step, name in enumerate(skeleton):
            edge, state, factor = self._moves[state][name][choose(step, sums[step][state])]
            word.append(int(self._automaton.letters[edge]))
            weight *= factor
        return tuple(word), weight

    def _with_skeleton(
        self, skeleton: tuple[int, ...], words: Sequence[int], further: Callable[[int], Iterator[int]]
    ) -> tuple[list[int], int]:
        """Return the edges of a word with a skeleton, chosen by random bits, and the weight of all such words.

        Sums are cached because short skeletons are sampled often. The cache is limited by a bound on the memory of the
        sums, computed from the last running totals, which are the largest.
        """
        known = self._known.get(skeleton)
        if known is None:
            known = self._sums(skeleton)
            numbers = [running for here in known[0] for running in here.values()]
            size = sum(getsizeof(here) + sum(map(getsizeof, here)) for here in known[0])
            size += sum(getsizeof(running) + len(running) * getsizeof(running[-1]) for running in numbers)
            size += getsizeof(known) + getsizeof(known[0]) + getsizeof(known[1])
            if self._kept + size > KEPT_SUMS:
                self._known, self._kept = {}, 0
            if size <= KEPT_SUMS:
                self._known[skeleton] = known
                self._kept += size
        (sums, total), state, path = known, 0, []
        for step, name in enumerate(skeleton):
            chosen = exact_choice(sums[step][state], words[step], partial(further, self._length + step))
            edge, state, _ = self._moves[state][name][chosen]
            path.append(edge)
        return path, total

    def _sums(self, skeleton: tuple[int, ...]) -> Sums:
        """Return, for each step and state, the running totals of the moves, and the weight of all words."""
        layers: list[set[int]] = [{0}]
        for name in skeleton:
            layers.append({move[1] for state in layers[-1] for move in self._moves[state].get(name, ())})
        behind = {state: int(self._automaton.accepting[state]) for state in layers[-1]}
        sums: list[dict[int, list[int]]] = []
        for name, layer in zip(reversed(skeleton), reversed(layers[:-1]), strict=True):
            here = {
                state: list(accumulate(weight * behind[target] for _, target, weight in self._moves[state][name]))
                for state in layer
                if name in self._moves[state]
            }
            behind = {state: here[state][-1] if state in here else 0 for state in layer}
            sums.append(here)
        return sums[::-1], behind[0]


def _walk_backward(walks: Walks, choose: Choice) -> tuple[Word, int]:
    """Return a word and its weight, given walks that choose reversed words."""
    letters, weight = walks.walk(choose)
    return letters[::-1], weight


def _letters(automaton: Automaton, edges: NDArray[np.int64]) -> NDArray[np.int32]:
    return np.ascontiguousarray(automaton.letters.astype(np.int32)[edges].T)


def _shares(automaton: Automaton, edges: NDArray[np.int64], totals: Sequence[int]) -> list[Fraction]:
    """Return the weight of each path, which is a column of `edges`, as a share of its total."""
    weights = [1] * edges.shape[1]
    if automaton.weights is not None:
        for step in automaton.weights[edges]:
            weights = [weight * factor for weight, factor in zip(weights, step.tolist(), strict=True)]
    shares: dict[tuple[int, int], Fraction] = {}
    for pair in zip(weights, totals, strict=True):
        if pair not in shares:
            shares[pair] = Fraction(*pair)
    return [shares[pair] for pair in zip(weights, totals, strict=True)]
