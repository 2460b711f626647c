"""Words of several lengths, drawn as one space: first the length by its exact share, then a word of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import accumulate
from math import lcm

from prag_asp.random_bits import SeededBits
from prag_asp.space.engines.engine import Draw, Letters
from prag_asp.space.sampling.choice_table import exact_choice
from prag_asp.space.sampling.draws import BATCH
from prag_asp.space.sampling.samplers import Drawer


@dataclass(frozen=True)
class Portion:
    """The words of one length: how they are drawn, and what they weigh together, more than 0."""

    length: int
    weight: Fraction
    drawer: Drawer


def drawn_batches(portions: Sequence[Portion], letters: Letters, seed: int) -> Iterator[list[Draw]]:
    """Yield words with their probability among all portions, in batches that grow, without end.

    The lengths and the words of each length have random bits of their own, so all draws are independent. A word depends
    on the seed and on its place alone.
    """
    total = sum((portion.weight for portion in portions), start=Fraction(0))
    scale = lcm(*(portion.weight.denominator for portion in portions))
    running = list(accumulate(int(portion.weight * scale) for portion in portions))
    chances = SeededBits(seed, " lengths")
    bits = [SeededBits(seed, f" length {portion.length}") for portion in portions]
    begun = [0] * len(portions)
    first, size = 0, 1
    while True:
        words = chances.words(first, size, 1)[:, 0].tolist()
        chosen = [
            exact_choice(running, word, partial(chances.further, draw, 0)) for draw, word in enumerate(words, first)
        ]
        drawn: dict[int, Iterator[Draw]] = {}
        for number in sorted(set(chosen)):
            portion, count = portions[number], chosen.count(number)
            found = portion.drawer.draw(bits[number], begun[number], count, tell=True)
            begun[number] += count
            share = portion.weight / total
            drawn[number] = iter(
                [
                    Draw(tuple([letters[letter] for letter in word]), share * probability)
                    for word, probability in zip(found.letters.tolist(), found.probabilities, strict=True)
                ]
            )
        yield [next(drawn[number]) for number in chosen]
        first, size = first + size, min(2 * size, BATCH)
