"""Parts of a task space that have no skeleton in common, with shares as near to those wanted as skeletons allow."""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping
from fractions import Fraction
from math import lcm
from typing import TYPE_CHECKING

from prag_asp.space.conditions.clauses import Matches, Part
from prag_asp.space.conditions.condition import Condition
from prag_asp.space.parts.choice import NEAR, choose_parts, farthest
from prag_asp.space.parts.split import divided

if TYPE_CHECKING:
    from prag_asp.space.task_space import TaskSpace

FEWEST_CLASSES = 20
"""Classes that skeletons are divided into at least: where there are many skeletons, parts are made of whole classes."""

LISTED = 500
"""Skeletons up to which parts are made of single ones."""


WORD = re.compile(r"\w+")
"""A name that regular expressions can spell."""


class SharesWarning(UserWarning):
    """The parts of a split are not near to the shares that were asked for."""


def divide_skeletons(space: TaskSpace, shares: Mapping[str, Fraction], seed: int) -> dict[str, TaskSpace]:
    """Return disjoint random parts of a space, together all of it, each with whole skeletons.

    Skeletons are divided evenly by a random automaton. Where that comes out uneven, skeletons or classes of them are
    chosen by how many tasks each has, exactly.
    """
    modulus = lcm(*(share.denominator for share in shares.values()))
    modulus *= -(-FEWEST_CLASSES // modulus)
    residues = divided(modulus, shares)
    parts = {name: space.where(Condition((Part(tuple(own), modulus, seed),))) for name, own in residues.items()}
    if _distance(parts, shares) > NEAR:
        few = space.count("skeleton") <= LISTED and all(map(WORD.fullmatch, space.letters("skeleton")))
        parts = _of_skeletons(space, shares, seed) if few else _of_classes(space, shares, seed, modulus)
        if _distance(parts, shares) > NEAR:
            warnings.warn(_told(parts, shares), SharesWarning, stacklevel=3)
    return parts


def _distance(parts: Mapping[str, TaskSpace], shares: Mapping[str, Fraction]) -> Fraction:
    return farthest([part.count() for part in parts.values()], list(shares.values()))


def _of_skeletons(space: TaskSpace, shares: Mapping[str, Fraction], seed: int) -> dict[str, TaskSpace]:
    skeletons = list(space.words("skeleton"))
    chosen = choose_parts([space.count("task", skeleton) for skeleton in skeletons], list(shares.values()), seed)
    words: list[list[str]] = [[] for _ in shares]
    for skeleton, part in zip(skeletons, chosen, strict=True):
        words[part].append(" ".join(skeleton) or ".{0}")
    clauses = [Matches(" | ".join(own)) if own else Matches(".*", inverse=True) for own in words]
    return {name: space.where(Condition((clause,))) for name, clause in zip(shares, clauses, strict=True)}


def _of_classes(space: TaskSpace, shares: Mapping[str, Fraction], seed: int, modulus: int) -> dict[str, TaskSpace]:
    classes = [space.where(Condition((Part((residue,), modulus, seed),))).count() for residue in range(modulus)]
    chosen = choose_parts(classes, list(shares.values()), seed)
    residues: list[list[int]] = [[] for _ in shares]
    for residue, part in enumerate(chosen):
        residues[part].append(residue)
    return {
        name: space.where(Condition((Part(tuple(own), modulus, seed),)))
        for name, own in zip(shares, residues, strict=True)
    }


def _told(parts: Mapping[str, TaskSpace], shares: Mapping[str, Fraction]) -> str:
    total = sum(part.count() for part in parts.values())
    have = ", ".join(f"{name} has {float(100 * part.count() / total):.1f} %" for name, part in parts.items())
    wanted = ", ".join(f"{float(100 * share):.4g} %" for share in shares.values())
    return f"{have} of the tasks, not {wanted}: no choice of whole skeletons comes nearer; take other shares or lengths"
