"""Draw from words that are all listed, for engines that can do no better."""

from __future__ import annotations

import random
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import accumulate
from math import lcm

import clingo

from prag_asp.errors import QueryError
from prag_asp.space.engines.protocol import Draw, Letters
from prag_asp.space.weights import Weights


def draw_listed(words: Sequence[Letters], generator: random.Random, weights: Weights) -> Iterator[Draw]:
    """Yield words drawn independently, each with a probability proportional to its weight, without end.

    Raises:
        QueryError: no word weighs anything.
    """
    weighed = [weights.of_plan([clingo.parse_term(action) for action in word]) for word in words]
    sums = list(accumulate(weighed))
    if not sums or not sums[-1]:
        raise QueryError("there is no plan or task of this length to draw")
    unit = Fraction(1, lcm(*(weight.denominator for weight in weighed)))
    total = int(sums[-1] / unit)
    while True:
        at = bisect_right(sums, generator.randrange(total) * unit)
        yield Draw(words[at], weighed[at] / sums[-1])
