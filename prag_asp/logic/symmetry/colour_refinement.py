"""Colour refinement and twins of the entities of packed states.

Both work on the bits that are set, for many states at once. A colour is a hash: a collision adds a tie but causes no
wrong result, because twins are tested on the bits themselves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.step.packed import WORD, Rows, words_for
from prag_asp.logic.symmetry.term_patterns import Patterns

Colours = NDArray[np.uint64]
"""The colour of each entity in each state, shape (states, entities)."""

MULTIPLIER, SHIFT = np.uint64(0x9E3779B97F4A7C15), np.uint64(29)
TOGETHER = 2**22
"""The number of pairs of twins and bits that are compared at once."""


@dataclass(frozen=True)
class StateBits:
    """The bits set in packed states, each a term: `state` and `term` have shape (bits,), in order of the states.

    `alone` holds, for each state and entity, the patterns of the bits that name only that entity, as a set packed into
    words, shape (states, entities, words). `related` are the indices, in `state` and `term`, of the bits that relate
    several entities.
    """

    rows: Rows
    terms: Patterns
    state: NDArray[np.intp]
    term: NDArray[np.intp]
    alone: NDArray[np.uint64]
    related: NDArray[np.intp]

    def entities(self, bits: NDArray[np.intp]) -> NDArray[np.int64]:
        """Return the entities that the given bits name, shape (bits, most entities of a term)."""
        return self.terms.entities[self.term[bits]]


def find_bits(rows: Rows, terms: Patterns, term_of: NDArray[np.int64]) -> StateBits:
    """Return the bits set in packed states; `term_of` maps a variable to its term, or to -1."""
    state, word = np.nonzero(rows)
    octets = rows[state, word].astype("<u8")[:, None].view(np.uint8)
    place, shift = np.nonzero(np.unpackbits(octets, axis=1, bitorder="little"))
    state, term = state[place], term_of[word[place] * WORD + shift]
    state, term = state[term >= 0], term[term >= 0]
    arity, is_single = terms.arity[term], terms.named == 1
    numbers = np.cumsum(is_single) - 1
    alone = np.zeros((len(rows), terms.places, words_for(int(is_single.sum()))), dtype=np.uint64)
    single = np.flatnonzero(arity == 1)
    if len(single):
        word, shift = np.divmod(numbers[terms.pattern[term[single]]], WORD)
        where = (state[single], terms.entities[term[single], 0], word)
        np.bitwise_or.at(alone, where, np.uint64(1) << shift.astype(np.uint64))
    return StateBits(rows, terms, state, term, alone, np.flatnonzero(arity > 1))


def refine_colours(bits: StateBits, initial: Colours) -> Colours:
    """Return the colours of entities, refined from `initial` until no state distinguishes more entities."""
    colours: Colours = initial
    for word in np.moveaxis(bits.alone, 2, 0):
        colours = _mixed(colours ^ word)
    if not len(bits.related):
        return colours
    states, inverse = np.unique(bits.state[bits.related], return_inverse=True)
    refined: Colours = colours[states]
    number = _distinct(refined)
    while True:
        finer = _refined(bits, refined, inverse)
        counts = _distinct(finer)
        grown = counts > number
        if not grown.any():
            break
        # A stable state keeps its colours, even if others are refined further.
        refined[grown], number[grown] = finer[grown], counts[grown]
    colours = colours.copy()
    colours[states] = refined
    return colours


def _refined(bits: StateBits, colours: Colours, state: NDArray[np.intp]) -> Colours:
    """Mix the colours of related entities into the colour of each entity; `state` is the row of each related bit."""
    pattern = bits.terms.pattern[bits.term[bits.related]].astype(np.uint64)
    entities = bits.entities(bits.related)
    sums = np.zeros_like(colours)
    for place in range(entities.shape[1]):
        hashes = _mixed(pattern + np.uint64(1 + place * 2**32))
        for other in range(entities.shape[1]):
            if other != place:
                there = entities[:, other] >= 0
                hashes[there] = _mixed(hashes[there] ^ colours[state[there], entities[there, other]])
        there = entities[:, place] >= 0
        np.add.at(sums, (state[there], entities[there, place]), hashes[there])
    return _mixed(colours ^ _mixed(sums + np.uint64(1)))


def _mixed(values: NDArray[np.uint64]) -> NDArray[np.uint64]:
    mixed = (values ^ (values >> SHIFT)) * MULTIPLIER
    result: NDArray[np.uint64] = (mixed ^ (mixed >> SHIFT)) * MULTIPLIER + np.uint64(1)
    return result


def _distinct(colours: Colours) -> NDArray[np.intp]:
    ordered = np.sort(colours, axis=1)
    differences: NDArray[np.intp] = (ordered[:, 1:] != ordered[:, :-1]).sum(axis=1)
    return differences


def are_twins(
    bits: StateBits, variable_of: NDArray[np.int64], state: NDArray[np.intp], pairs: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Return, for each pair of entities of one group, whether swapping them leaves the state of the pair unchanged.

    `state` holds the state of each pair, shape (m,); `pairs` has shape (m, 2). `variable_of` maps a term to its
    variable.
    """
    first, second = pairs.T
    result: NDArray[np.bool_] = (bits.alone[state, first] == bits.alone[state, second]).all(axis=1)
    if not len(bits.related):
        return result
    starts = np.searchsorted(bits.state[bits.related], np.arange(len(bits.rows) + 1))
    candidates = np.flatnonzero(result & (starts[state + 1] > starts[state]))
    size = max(int((starts[state[candidates] + 1] - starts[state[candidates]]).max(initial=1)), 1)
    for begin in range(0, len(candidates), max(TOGETHER // size, 1)):
        some = candidates[begin : begin + max(TOGETHER // size, 1)]
        result[some] = _relations_agree(bits, variable_of, state[some], pairs[some], starts)
    return result


def _relations_agree(
    bits: StateBits,
    variable_of: NDArray[np.int64],
    state: NDArray[np.intp],
    pairs: NDArray[np.int64],
    starts: NDArray[np.intp],
) -> NDArray[np.bool_]:
    """Return, for each pair, whether swapping its entities keeps the bits that relate several entities; shape (m,)."""
    sizes = starts[state + 1] - starts[state]
    pair = np.repeat(np.arange(len(state)), sizes)
    within = np.arange(len(pair)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    bit = bits.related[starts[state[pair]] + within]
    entities = bits.entities(bit)
    is_first, is_second = entities == pairs[pair, :1], entities == pairs[pair, 1:]
    moved = (is_first | is_second).any(axis=1)
    swapped = np.where(is_first, pairs[pair, 1:], np.where(is_second, pairs[pair, :1], entities))[moved]
    variable = variable_of[bits.terms.find(bits.terms.pattern[bits.term[bit[moved]]], swapped)]
    word, shift = np.divmod(variable, WORD)
    missing = (bits.rows[state[pair[moved]], word] >> shift.astype(np.uint64)) & np.uint64(1) == 0
    agree = np.ones(len(state), dtype=np.bool_)
    agree[pair[moved][missing]] = False
    return agree
