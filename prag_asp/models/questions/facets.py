"""Facets: shown atoms that some answer sets contain and others do not, and how much each narrows the answer sets.

The notions are those of Fichte, Gaggl and Rusovac, "Rushing and Strolling among Answer Sets" (2022), and of Rusovac,
Hecher, Gebser, Gaggl and Fichte, "Navigating and Querying Answer Sets" (2024), as in the browser fasb.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import clingo

from prag_asp.logic.formula.clause_builder import TRUE, Literal
from prag_asp.models.diagram import Diagram


@dataclass(frozen=True)
class Narrowing:
    """The numbers of answer sets and facets that remain if an atom is chosen or excluded, and the reductions.

    `of_answer_sets` and `of_facets` are the reductions as shares of the original numbers, from 0 to 1. The latter is
    the significance of the facet.
    """

    answer_sets: int
    facets: int
    of_answer_sets: Fraction
    of_facets: Fraction


@dataclass(frozen=True)
class Facet:
    """The share of answer sets that contain a shown atom, and the results of choosing and of excluding the atom.

    An atom that is in no or in all answer sets is not a facet: choosing or excluding it leaves nothing or changes
    nothing, and both results are None.
    """

    share: Fraction
    chosen: Narrowing | None
    excluded: Narrowing | None

    @property
    def is_facet(self) -> bool:
        """Whether some answer sets contain the atom, and others do not."""
        return self.chosen is not None


@dataclass(frozen=True)
class _Companions:
    """Bit sets: the atoms that at least one of several answer sets contains, and those that at least one lacks."""

    having: int = 0
    lacking: int = 0

    @property
    def facets(self) -> int:
        """The number of atoms that some of the answer sets contain and others do not."""
        return (self.having & self.lacking).bit_count()


def facets_of_diagram(
    diagram: Diagram, printed: Sequence[tuple[clingo.Symbol, Literal]], numbers: Mapping[Literal, int], total: int
) -> dict[clingo.Symbol, Facet]:
    """Return the facets of a satisfiable formula, given the number of models with each literal and in total.

    One pass collects, for each literal, the literals that occur in models together with it.
    """
    bits: dict[Literal, int] = {}
    for place, (_, literal) in enumerate(printed):
        if abs(literal) != TRUE:
            bits[literal] = bits.get(literal, 0) | 1 << 2 * place
            bits[-literal] = bits.get(-literal, 0) | 1 << 2 * place + 1
    having = sum(1 << 2 * place for place in range(len(printed)))
    together = _together(diagram, bits)

    def companions(literal: Literal) -> _Companions:
        found = together.get(literal, 0)
        return _Companions(found & having, found >> 1 & having)

    pairs = []
    for _, literal in printed:
        number = total if literal == TRUE else numbers.get(literal, 0)
        pairs.append((number, companions(literal), companions(-literal)))
    return _facets([symbol for symbol, _ in printed], pairs, total)


def facets_of_lists(
    symbols: Sequence[clingo.Symbol], found: Iterable[tuple[clingo.Symbol, ...]]
) -> dict[clingo.Symbol, Facet]:
    """Return the facets of listed answer sets; if there are none, no atom is a facet and all shares are 0."""
    places = {symbol: place for place, symbol in enumerate(symbols)}
    whole = (1 << len(symbols)) - 1
    numbers, total = [0] * len(symbols), 0
    having, lacking = [[0, 0] for _ in symbols], [[0, 0] for _ in symbols]
    for answer_set in found:
        total += 1
        mask = sum(1 << places[symbol] for symbol in answer_set)
        for place in range(len(symbols)):
            has = mask >> place & 1
            numbers[place] += has
            having[place][has] |= mask
            lacking[place][has] |= whole & ~mask
    pairs = [
        (number, _Companions(plus[1], minus[1]), _Companions(plus[0], minus[0]))
        for number, plus, minus in zip(numbers, having, lacking, strict=True)
    ]
    return _facets(symbols, pairs, total)


def _together(diagram: Diagram, bits: Mapping[Literal, int]) -> dict[Literal, int]:
    """Return, for each literal, the bits of all literals that occur together with it in models."""
    below: list[int] = []  # for each node, the bits of the literals in its models
    for branches in diagram.nodes:
        union = 0
        for branch in branches:
            for literal in branch.literals:
                union |= bits.get(literal, 0)
            for child in branch.children:
                union |= below[child]
        below.append(union)
    around: list[int | None] = [None] * len(below)  # the bits of the literals beside a node in models through it
    if around:
        around[-1] = 0
    together: dict[Literal, int] = {}
    for node in reversed(range(len(around))):
        outside = around[node]
        if outside is None:
            continue
        for branch in diagram.nodes[node]:
            own = outside
            for literal in branch.literals:
                own |= bits.get(literal, 0)
            before = [own]
            for child in branch.children:
                before.append(before[-1] | below[child])
            for literal in branch.literals:
                together[literal] = together.get(literal, 0) | before[-1]
            after = 0
            for place in reversed(range(len(branch.children))):
                child = branch.children[place]
                around[child] = (around[child] or 0) | before[place] | after
                after |= below[child]
    return together


def _facets(
    symbols: Sequence[clingo.Symbol], pairs: Sequence[tuple[int, _Companions, _Companions]], total: int
) -> dict[clingo.Symbol, Facet]:
    """Return the facets, given for each symbol the number of answer sets with it and the atoms that occur with it."""
    facets = sum(0 < number < total for number, _, _ in pairs)

    def narrowing(number: int, companions: _Companions) -> Narrowing:
        left = companions.facets
        return Narrowing(number, left, Fraction(total - number, total), Fraction(facets - left, facets))

    found = {}
    for symbol, (number, chosen, excluded) in zip(symbols, pairs, strict=True):
        is_facet = 0 < number < total
        found[symbol] = Facet(
            Fraction(number, total or 1),
            narrowing(number, chosen) if is_facet else None,
            narrowing(total - number, excluded) if is_facet else None,
        )
    return found
