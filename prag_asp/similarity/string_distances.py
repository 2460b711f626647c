"""String metrics on sequences of symbols: those in the code of the paper, and similar ones.

Rapidfuzz computes all but one of them. The code of the paper ("PRAG: Procedural Action Generator" by Škoviera et al.)
compares sequences by the distances of Levenshtein, Hamming and Jaro-Winkler, by the longest common subsequence and by
the longest common substring.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from types import ModuleType
from typing import Any

from prag_asp.errors import SimilarityMissingError
from prag_asp.similarity.symbols import Symbol

StringDistance = Callable[[str, str], float]

FIRST_CODE = 0x20000
"""The first character that stands for a symbol; this and all following characters are valid."""

PREFIX_WEIGHT = 0.1
"""The weight of each of up to four equal symbols at the beginning (Winkler 1990)."""


def rapidfuzz_distance() -> ModuleType:
    """Import rapidfuzz's module of distances.

    Raises:
        SimilarityMissingError: rapidfuzz is not installed.
    """
    try:
        return import_module("rapidfuzz.distance")
    except ImportError:
        raise SimilarityMissingError(
            'this metric needs rapidfuzz; install it: pip install "prag_asp[similarity]"'
        ) from None


def spelled(*sequences: Sequence[Symbol]) -> list[str]:
    """Return sequences as strings with one character per symbol; equal symbols have the same character."""
    characters: dict[Any, str] = {}
    return [
        "".join(characters.setdefault(symbol, chr(FIRST_CODE + len(characters))) for symbol in sequence)
        for sequence in sequences
    ]


def substring_distance(one: str, other: str) -> int:
    """Return the number of characters to remove from, and to add to, the ends of one text to obtain the other.

    This is the sum of the lengths minus twice the length of the longest common substring. It is a metric, because two
    substrings of a text overlap in at least the sum of their lengths minus the length of the text.
    """
    longest, ending = 0, [0] * (len(other) + 1)
    for character in one:
        ending = [0, *(ending[place] + 1 if each == character else 0 for place, each in enumerate(other))]
        longest = max(longest, *ending)
    return len(one) + len(other) - 2 * longest


def damerau_distance() -> StringDistance:
    """Return the distance that counts insertions, deletions, replacements and swaps of neighbours (Damerau 1964)."""
    distance: StringDistance = rapidfuzz_distance().DamerauLevenshtein.distance
    return distance


def jaro_distance() -> StringDistance:
    """Return 1 minus the similarity of Jaro (1989)."""
    distance: StringDistance = rapidfuzz_distance().Jaro.distance
    return distance


def jaro_winkler_distance() -> StringDistance:
    """Return 1 minus the similarity of Winkler (1990), which favours common prefixes."""
    function = rapidfuzz_distance().JaroWinkler.distance
    return lambda one, other: float(function(one, other, prefix_weight=PREFIX_WEIGHT))


def subsequence_distance() -> StringDistance:
    """Return the length of the longer text minus that of the longest common subsequence (Bakkelund 2009)."""
    distance: StringDistance = rapidfuzz_distance().LCSseq.distance
    return distance
