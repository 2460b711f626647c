"""Divide a task space into parts that share no skeleton, with shares as near to the requested ones as possible."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from math import lcm

from prag_asp.space.conditions.clause_kinds import Matches, Part
from prag_asp.space.conditions.condition import Condition
from prag_asp.space.parts.choice import NEAR, choose_parts, farthest
from prag_asp.space.parts.shares import divided

FEWEST_CLASSES = 20
"""Minimum number of classes of skeletons; where there are many skeletons, parts are unions of whole classes."""

MOST_SKELETONS, LONGEST = 500, 30
"""Maximum number of skeletons, and of actions in each, for which parts are chosen skeleton by skeleton."""

SPELLABLE = re.compile(r"\w+")
"""A name that regular expressions can spell."""

Count = Callable[[Condition], int]
"""Return the number of tasks that satisfy a condition."""

Skeletons = Mapping[tuple[str, ...], int]
"""The number of tasks of each skeleton."""


class SharesWarning(UserWarning):
    """The parts of a split are far from the requested shares."""


def divide_skeletons(
    shares: Mapping[str, Fraction], seed: int, count: Count, listed: Callable[[], Skeletons | None]
) -> dict[str, Condition]:
    """Return conditions that partition a space at random into parts of whole skeletons.

    A random automaton divides the skeletons evenly. If the shares of tasks come out uneven, skeletons are assigned by
    their exact numbers of tasks: one by one, or in classes if `listed` returns None because there are too many.
    """
    modulus = lcm(*(share.denominator for share in shares.values()))
    modulus *= -(-FEWEST_CLASSES // modulus)
    residues = divided(modulus, shares)
    parts = {name: _part(numbers, modulus, seed) for name, numbers in residues.items()}
    if _distance(parts, shares, count) > NEAR:
        few = listed()
        pieces = [count(_part([r], modulus, seed)) for r in range(modulus)] if few is None else list(few.values())
        members: list[list[int]] = [[] for _ in shares]
        for piece, part in enumerate(choose_parts(pieces, list(shares.values()), seed)):
            members[part].append(piece)
        if few is None:
            parts = {name: _part(own, modulus, seed) for name, own in zip(shares, members, strict=True)}
        else:
            words = [" ".join(skeleton) or ".{0}" for skeleton in few]
            expressions = [" | ".join(words[piece] for piece in own) for own in members]
            clauses = [Matches(spelled) if spelled else Matches(".*", inverse=True) for spelled in expressions]
            parts = {name: Condition((clause,)) for name, clause in zip(shares, clauses, strict=True)}
        if _distance(parts, shares, count) > NEAR:
            total = sum(map(count, parts.values()))
            actual = ", ".join(f"{name} has {float(100 * count(part) / total):.1f} %" for name, part in parts.items())
            requested = ", ".join(f"{float(100 * share):.4g} %" for share in shares.values())
            why = "no choice of whole skeletons comes nearer; take other shares or lengths"
            warnings.warn(f"{actual} of the tasks, not {requested}: {why}", SharesWarning, stacklevel=3)
    return parts


def _part(residues: Iterable[int], modulus: int, seed: int) -> Condition:
    return Condition((Part(tuple(residues), modulus, seed),))


def _distance(parts: Mapping[str, Condition], shares: Mapping[str, Fraction], count: Count) -> Fraction:
    return farthest([count(part) for part in parts.values()], list(shares.values()))
