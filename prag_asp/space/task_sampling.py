"""The distribution of sampled tasks: the weights, the level, and an optional first choice of skeletons or goals."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain
from typing import TYPE_CHECKING

from prag_asp.errors import QueryError
from prag_asp.random_bits import SeededBits
from prag_asp.space.domain_engines import DomainEngines
from prag_asp.space.engines import Draw, Level
from prag_asp.space.sampling.samplers import Over, Sampler, SkeletonSampler
from prag_asp.space.sampling.statistics import Statistics, statistics_of, weight_of_words_without
from prag_asp.space.sampling.streams import Portion, make_sampler, sample_batches, sample_batches_of_lengths
from prag_asp.space.weights.weights import Weights

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True)
class TaskSampling:
    """Random plans, tasks or (uniformly sampled) skeletons of given lengths, and their exact statistics.

    With `over`, a skeleton or a goal is sampled uniformly first. A draw depends only on the seed and its number.
    """

    engines: DomainEngines
    by: Level
    lengths: Sequence[int]
    weights: Weights
    over: Over | None = None

    def batches(self, *, seed: int) -> Iterator[list[Draw]]:
        """Return draws as texts, each with its exact probability, endlessly, in batches that grow.

        Raises:
            QueryError: there is nothing to sample, or goals are to be sampled first over several lengths.
        """
        if len(self.lengths) == 1:
            letters = self.engines.engine(self.by, self.lengths[0]).letters
            return sample_batches(self.sampler(self.lengths[0]), letters, seed)
        if self.over == "goals":
            raise QueryError("over goals, tasks of one length are sampled; give one, or sample over skeletons")
        key = (self.by, tuple(self.lengths), self.weights, self.over)
        portions = self.engines.latest("portions", key, self._portions)
        if not portions:
            raise QueryError(f"there is no {self.by} of the lengths {', '.join(map(str, self.lengths))} to sample")
        return sample_batches_of_lengths(portions, seed)

    def draws(self, *, seed: int) -> Iterator[Draw]:
        """Return draws as texts, each with its exact probability, endlessly.

        Raises:
            QueryError: there is nothing to sample, or goals are to be sampled first over several lengths.
        """
        return chain.from_iterable(self.batches(seed=seed))

    def array(self, count: int, *, seed: int, first: int = 0) -> NDArray[np.int32]:
        """Return draws of one length from number `first` onwards, as an array of shape (count, length).

        Its values are indices into the `action_texts` of the space. Ranges of draws may be computed separately.

        Raises:
            QueryError: there is nothing to sample, or `count` is negative.
        """
        if count < 0:
            raise QueryError(f"cannot sample {count} {self.by}s; give a number of at least 0")
        return self.sampler().sample(SeededBits(seed), first, count, with_probabilities=False).letters

    def sampler(self, length: int | None = None) -> Sampler:
        """Return the sampler for a given length, by default the only one; the latest sampler is cached.

        Raises:
            QueryError: there is nothing to sample.
        """
        chosen = self._only_length if length is None else length

        def make() -> Sampler:
            engine, facts = self.engines.engine(self.by, chosen), self.engines.model.domain.facts
            return make_sampler(engine, facts, self.by, chosen, self.weights, self.over)

        return self.engines.latest("sampler", (self.by, chosen, self.weights, self.over), make)

    def total_weight(self) -> Fraction:
        """Return the exact sum of the weights of all words, which is their number if there are no weights."""
        return sum(map(self._weight, self.lengths), start=Fraction(0))

    def weight_without(self, what: Collection[str]) -> Fraction:
        """Return the exact weight of all words of one length without certain names and pairs of names (``grasp>move``).

        Raises:
            QueryError: an item is neither an action's name nor a pair of names.
        """
        engine = self.engines.engine(self.by, self._only_length)
        facts = self.engines.model.domain.facts
        return weight_of_words_without(engine, facts, self.by, self._only_length, self.weights, what)

    def statistics(self) -> Statistics:
        """Return exact statistics of the words of one length.

        Raises:
            QueryError: there is nothing to sample.
        """
        engine = self.engines.engine(self.by, self._only_length)
        return statistics_of(engine, self.engines.model.domain.facts, self.by, self._only_length, self.weights)

    @property
    def _only_length(self) -> int:
        if len(self.lengths) > 1:
            raise QueryError(f"the lengths {', '.join(map(str, self.lengths))}: choose one, such as "
                             f"space.at({self.lengths[0]})")  # fmt: skip
        return self.lengths[0]

    def _weight(self, length: int) -> Fraction:
        weighed = self.engines.engine(self.by, length).weighed(length, self.weights)
        return weighed.total(length) * weighed.unit

    def _portions(self) -> list[Portion]:
        """Return the samplers of all lengths with a weight above 0, shortest first."""
        portions = []
        for length in sorted(self.lengths, reverse=True):  # the exploration for the greatest length covers all lengths
            weight = self._weight(length)
            if weight:
                sampler = self.sampler(length)
                share = Fraction(sampler.count) if isinstance(sampler, SkeletonSampler) else weight
                portions.append(Portion(length, self.engines.engine(self.by, length).letters, sampler, share))
        return portions[::-1]
