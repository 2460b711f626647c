"""Terms as patterns with places for entities, so that renaming entities is arithmetic on arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import perm, prod

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.program import mentioned_entities
from prag_asp.logic.renaming import renamed

LARGEST_TABLE = 2**25
NOBODY = -1


@dataclass(frozen=True)
class Patterns:
    """Terms, each as a pattern and the different entities that it names, from the left.

    `pattern` has shape (terms,); `entities` has shape (terms, most entities in a term), filled up with -1; `named`
    is how many entities each pattern names; `table` gives the term of a pattern and its entities, -1 where there is
    none. `places` is the number of entities in all.
    """

    pattern: NDArray[np.int64]
    entities: NDArray[np.int64]
    named: NDArray[np.int64]
    places: int
    complete: bool
    table: NDArray[np.int32]

    @cached_property
    def arity(self) -> NDArray[np.int64]:
        """How many entities each term names, shape (terms,)."""
        return self.named[self.pattern]

    def find(self, pattern: NDArray[np.int64], entities: NDArray[np.int64]) -> NDArray[np.int32]:
        """Return the numbers of terms given as patterns, shape (m,), and entities, shape (m, most)."""
        return self.table[_codes(pattern, entities, self.places)]


def _codes(pattern: NDArray[np.int64], entities: NDArray[np.int64], places: int) -> NDArray[np.int64]:
    code = pattern
    for column in entities.T:
        code = code * (places + 1) + column + 1
    return code


def read_patterns(terms: Sequence[clingo.Symbol], groups: Sequence[Sequence[clingo.Symbol]]) -> Patterns | None:
    """Return terms as patterns, with the entities of all groups numbered in order; None where that takes too much room.

    The patterns are complete where every renaming of a term that permutes the groups is a term again.
    """
    number = {entity: place for place, entity in enumerate(e for group in groups for e in group)}
    group_of = {entity: place for place, group in enumerate(groups) for entity in group}
    holes = [clingo.Function(f"_{place}") for place in range(_most_named(terms, group_of))]
    kinds: dict[tuple[clingo.Symbol, tuple[int, ...]], int] = {}
    pattern = np.empty(len(terms), dtype=np.int64)
    entities = np.full((len(terms), len(holes)), NOBODY, dtype=np.int64)
    for term_number, term in enumerate(terms):
        named = list(dict.fromkeys(mentioned_entities(term, group_of)))
        shape = renamed(term, dict(zip(named, holes, strict=False)))
        pattern[term_number] = kinds.setdefault((shape, tuple(group_of[entity] for entity in named)), len(kinds))
        entities[term_number, : len(named)] = [number[entity] for entity in named]
    size = len(kinds) * (len(number) + 1) ** len(holes)
    if size > LARGEST_TABLE:
        return None
    table = np.full(max(size, 1), NOBODY, dtype=np.int32)
    table[_codes(pattern, entities, len(number))] = np.arange(len(terms))
    sizes = [len(group) for group in groups]
    wanted = [_renamings(signature, sizes) for _, signature in kinds]
    complete = bool(np.array_equal(np.bincount(pattern, minlength=len(kinds)), wanted)) if kinds else True
    arities = np.array([len(signature) for _, signature in kinds], dtype=np.int64)
    return Patterns(pattern, entities, arities, len(number), complete, table)


def _most_named(terms: Sequence[clingo.Symbol], group_of: Mapping[clingo.Symbol, int]) -> int:
    return max((len(set(mentioned_entities(term, group_of))) for term in terms), default=0)


def _renamings(signature: tuple[int, ...], sizes: Sequence[int]) -> int:
    """Return the number of ways to name different entities, of which the i-th is from group ``signature[i]``."""
    return prod(perm(size, signature.count(group)) for group, size in enumerate(sizes))
