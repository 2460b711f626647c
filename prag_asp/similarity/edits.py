"""The edit distance between two sequences under given costs, and the edits that achieve it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from prag_asp.errors import QueryError
from prag_asp.similarity.edit_costs import Cost
from prag_asp.similarity.symbols import Symbol

Row = list[Fraction]


@dataclass(frozen=True)
class Edit:
    """An edit at index `place` of the first sequence: `old` is None for an insertion, and `new` for a deletion."""

    place: int
    old: Symbol
    new: Symbol
    cost: Fraction


def edit_table(one: Sequence[Symbol], other: Sequence[Symbol], cost: Cost) -> list[Row]:
    """Return the smallest cost of turning each prefix of one sequence into each prefix of the other.

    The algorithm is that of Wagner and Fischer (1974).
    """
    inserted = [cost(None, new) for new in other]
    table: list[Row] = [[Fraction(0)]]
    for gap in inserted:
        table[0].append(table[0][-1] + gap)
    for old in one:
        deleted, before = cost(old, None), table[-1]
        row = [before[0] + deleted]
        for place, new in enumerate(other):
            replaced = before[place] + (0 if old == new else cost(old, new))
            row.append(min(replaced, before[place + 1] + deleted, row[place] + inserted[place]))
        table.append(row)
    return table


def edit_distance(one: Sequence[Symbol], other: Sequence[Symbol], cost: Cost) -> Fraction:
    """Return the smallest cost of edits that turn one sequence into the other."""
    return edit_table(one, other, cost)[-1][-1]


def least_edits(one: Sequence[Symbol], other: Sequence[Symbol], cost: Cost) -> tuple[Edit, ...]:
    """Return edits of the smallest total cost, in order; among several solutions, that with the latest replacements."""
    return tuple(reversed([*_edits_from_the_end(one, other, cost)]))


def _edits_from_the_end(one: Sequence[Symbol], other: Sequence[Symbol], cost: Cost) -> Iterator[Edit]:
    table = edit_table(one, other, cost)
    i, j = len(one), len(other)
    while i or j:
        here = table[i][j]
        if i and j and here == table[i - 1][j - 1] + (price := cost(one[i - 1], other[j - 1])):
            i, j = i - 1, j - 1
            if one[i] != other[j]:
                yield Edit(i, one[i], other[j], price)
        elif i and here == table[i - 1][j] + (price := cost(one[i - 1], None)):
            i -= 1
            yield Edit(i, one[i], None, price)
        else:
            j -= 1
            yield Edit(i, None, other[j], cost(None, other[j]))


def replacements(one: Sequence[Symbol], other: Sequence[Symbol], cost: Cost) -> tuple[Edit, ...]:
    """Return the replacements that turn a sequence into another one of the same length."""
    pairs = enumerate(zip(one, other, strict=True))
    return tuple(Edit(place, old, new, cost(old, new)) for place, (old, new) in pairs if old != new)


def check_lengths(lengths: set[int]) -> None:
    """Check that tasks have the same length.

    Raises:
        QueryError: the tasks have different lengths.
    """
    if len(lengths) > 1:
        several = " and ".join(map(str, sorted(lengths)[:2]))
        raise QueryError(f"Hamming compares tasks of the same length, not of {several} actions; use levenshtein")
