"""Make a mutant smaller while the same is wrong with it."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from time import monotonic
from typing import TypeVar

from tests.fuzz.campaign import Finding, attempt
from tests.fuzz.isolated import Limits
from tests.fuzz.mutant import Mutant

SECONDS = 60.0
"""How long one finding is made smaller."""

Piece = TypeVar("Piece", str, bytes)

TEXTS = (".lp", ".toml", ".jsonl", ".urdf", ".obj", ".stl")


def shrunk(finding: Finding, limits: Limits, seconds: float = SECONDS) -> Finding:
    """Return a finding of the same signature with as little in it as can be found in some time."""
    until = monotonic() + seconds
    best = [finding]

    def holds(mutant: Mutant) -> bool:
        if monotonic() > until:
            return False
        found = attempt(mutant, limits).finding
        if found is None or found.signature != finding.signature:
            return False
        best[0] = found
        return True

    mutant = finding.mutant
    if not finding.what.startswith("differ"):  # the one command that the finding is about; others are not compared
        alone = replace(mutant, commands=(finding.arguments,))
        mutant = alone if holds(alone) else mutant
    if mutant.kind == "command":
        mutant = _least(mutant.commands[-1], lambda words: replace(finding.mutant, commands=(tuple(words),)), holds)
    for name in sorted(mutant.files, key=lambda name: len(mutant.files[name])):
        without = replace(mutant, files={other: each for other, each in mutant.files.items() if other != name})
        if holds(without):
            mutant = without
    for name in mutant.files:
        # Fewer lines, then fewer tokens.
        for pattern in (rb"[^\n]*\n|[^\n]+$", rb"\w+|\s+|[^\w\s]") if name.endswith(TEXTS) else ():
            mutant = _least(re.findall(pattern, mutant.files[name]), partial(_with_file, mutant, name), holds)
    return best[0]


def _with_file(mutant: Mutant, name: str, pieces: Sequence[bytes]) -> Mutant:
    """Return a mutant in which one file is made of other pieces."""
    return replace(mutant, files={**mutant.files, name: b"".join(pieces)})


def _least(
    pieces: Sequence[Piece], mutant_of: Callable[[Sequence[Piece]], Mutant], holds: Callable[[Mutant], bool]
) -> Mutant:
    """Return a mutant of a part of some pieces that holds, and does not with one less, if it can be found in time.

    Zeller and Hildebrandt, "Simplifying and isolating failure-inducing input", 2002, without their complements.
    """
    found = list(pieces)
    size = max(len(found) // 2, 1)
    while found:
        at, before = 0, len(found)
        while at < len(found):
            fewer = found[:at] + found[at + size :]
            if holds(mutant_of(fewer)):
                found = fewer
            else:
                at += size
        if size == 1 and len(found) == before:
            break
        size = max(size // 2, 1)
    return mutant_of(found)
