"""The division of a task space into parts that share no skeleton, with shares close to the requested ones."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from itertools import compress
from itertools import count as numbers_from
from math import ceil, lcm

from prag_asp.errors import QueryError
from prag_asp.space.conditions.clause_kinds import Matches, Part
from prag_asp.space.conditions.condition import Condition
from prag_asp.space.parts.choice import NEAR, choose_parts, farthest
from prag_asp.space.parts.shares import divided

FEWEST_CLASSES = 20
"""Minimum number of classes of skeletons; if there are many skeletons, each part is a union of classes."""

MANY_CLASSES, MOST_CLASSES = 200, 1000
"""Maximum number of classes for exact shares, and maximum number of classes that the smallest share may require.

The time to count all classes one by one is proportional to their number: about 0.04 s each in the domain `prag`.
"""

CLOSE = NEAR / 10
"""Maximum difference between the share of the classes and the requested share, if exact shares need many classes."""

MOST_SKELETONS, LONGEST = 500, 30
"""Maximum number of skeletons, and maximum length, for which parts are chosen skeleton by skeleton."""

FEW_SEQUENCES = 5000
"""The maximum number of sequences of action names for which the skeletons are listed first, which takes about as long
as counting the tasks of one part."""

SPELLABLE = re.compile(r"\w+")
"""The pattern of names that can be written in a regular expression."""

Count = Callable[[Condition], int]
"""A function that returns the number of tasks that satisfy a condition."""

Skeletons = Mapping[tuple[str, ...], int]
"""The number of tasks with each skeleton."""


class SharesWarning(UserWarning):
    """The parts of a split are far from the requested shares."""


def divide_skeletons(
    shares: Mapping[str, Fraction],
    seed: int,
    count: Count,
    listed: Callable[[], Skeletons | None],
    *,
    names: int,
    length: int,
) -> dict[str, Condition]:
    """Return conditions that partition a space at random into parts that share no skeleton.

    A random automaton divides the skeletons evenly. If the shares of tasks come out uneven, skeletons are assigned by
    their exact numbers of tasks: one by one, or in classes if `listed` returns None because there are too many. If
    `names` action names have few sequences of this `length`, the skeletons are listed first and no part is counted.

    Raises:
        QueryError: a share is too small to be a class of skeletons.
    """
    modulus = _number_of_classes(shares)
    residues = divided(modulus, shares)
    clauses = [Part(tuple(numbers), modulus, seed) for numbers in residues.values()]
    parts = {name: Condition((clause,)) for name, clause in zip(shares, clauses, strict=True)}
    listed_first = names**length <= FEW_SEQUENCES
    few = listed() if listed_first else None
    if few is None:
        sizes = [count(part) for part in parts.values()]
    else:
        sizes = [sum(compress(few.values(), clause.includes(few))) for clause in clauses]
    if farthest(sizes, list(shares.values())) <= NEAR:
        return parts
    if not listed_first:
        few = listed()
    pieces = [count(_part([r], modulus, seed)) for r in range(modulus)] if few is None else list(few.values())
    members: list[list[int]] = [[] for _ in shares]
    for piece, place in enumerate(choose_parts(pieces, list(shares.values()), seed)):
        members[place].append(piece)
    if few is None:
        parts = {name: _part(own, modulus, seed) for name, own in zip(shares, members, strict=True)}
    else:
        words = [" ".join(skeleton) or ".{0}" for skeleton in few]
        expressions = [" | ".join(words[piece] for piece in own) for own in members]
        matches = [Matches(spelled) if spelled else Matches(".*", inverse=True) for spelled in expressions]
        parts = {name: Condition((clause,)) for name, clause in zip(shares, matches, strict=True)}
    sizes = [sum(pieces[piece] for piece in own) for own in members]
    if farthest(sizes, list(shares.values())) > NEAR:
        _warn(shares, sizes)
    return parts


def _warn(shares: Mapping[str, Fraction], sizes: Sequence[int]) -> None:
    """Warn that the sizes of parts are far from the requested shares."""
    total = sum(sizes)
    percentages = {name: float(Fraction(100 * size, total)) for name, size in zip(shares, sizes, strict=True)}
    actual = ", ".join(f"{name} has {share:.1f} %" for name, share in percentages.items())
    requested = ", ".join(f"{float(100 * share):.4g} %" for share in shares.values())
    why = "no choice of whole skeletons comes closer; choose other shares or lengths"
    warnings.warn(f"{actual} of the tasks, not {requested}: {why}", SharesWarning, stacklevel=4)


def _number_of_classes(shares: Mapping[str, Fraction]) -> int:
    """Return the smallest number of classes that gives the shares exactly, or nearly if that number is large.

    Raises:
        QueryError: a share is too small to be a class of skeletons.
    """
    modulus = lcm(*(share.denominator for share in shares.values()))
    if modulus <= MANY_CLASSES:
        return modulus * -(-FEWEST_CLASSES // modulus)
    name = min(shares, key=lambda each: shares[each])
    fewest = ceil(1 / shares[name])
    if fewest > MOST_CLASSES:
        least = f"parts of whole skeletons have shares of at least 1/{MOST_CLASSES}"
        raise QueryError(f"share of {name!r}: {least}; choose a larger share, or split without whole skeletons")

    def distance(classes: int) -> Fraction:
        return farthest([len(residues) for residues in divided(classes, shares).values()], list(shares.values()))

    return next(classes for classes in numbers_from(max(fewest, FEWEST_CLASSES)) if distance(classes) <= CLOSE)


def _part(residues: Iterable[int], modulus: int, seed: int) -> Condition:
    return Condition((Part(tuple(residues), modulus, seed),))
