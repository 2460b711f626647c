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

    mutant = _fewer_commands(finding)
    if not holds(mutant):
        mutant = finding.mutant
    words = mutant.commands[-1]
    if mutant.kind == "command":
        whole = mutant
        words = tuple(_least(words, lambda found: holds(replace(whole, commands=(tuple(found),)))))
        mutant = replace(mutant, commands=(words,))
    for name in sorted(mutant.files, key=lambda name: len(mutant.files[name])):
        without = replace(mutant, files={other: each for other, each in mutant.files.items() if other != name})
        if holds(without):
            mutant = without
    for name in mutant.files:
        if name.endswith(TEXTS):
            mutant = _smaller_text(mutant, name, holds)
    return best[0]


def _fewer_commands(finding: Finding) -> Mutant:
    """Return a mutant with the one command that the finding is about, where no others are compared."""
    if finding.what.startswith("differ"):
        return finding.mutant
    return replace(finding.mutant, commands=(finding.arguments,))


def _smaller_text(mutant: Mutant, name: str, holds: Callable[[Mutant], bool]) -> Mutant:
    """Return a mutant with fewer lines, and then fewer tokens, in one of its files."""
    for pattern in (rb"[^\n]*\n|[^\n]+$", rb"\w+|\s+|[^\w\s]"):
        pieces = _least(re.findall(pattern, mutant.files[name]), partial(_holds_with, holds, mutant, name))
        mutant = _with(mutant, name, pieces)
    return mutant


def _with(mutant: Mutant, name: str, pieces: Sequence[bytes]) -> Mutant:
    """Return a mutant in which one file is made of other pieces."""
    return replace(mutant, files={**mutant.files, name: b"".join(pieces)})


def _holds_with(holds: Callable[[Mutant], bool], mutant: Mutant, name: str, pieces: Sequence[bytes]) -> bool:
    return holds(_with(mutant, name, pieces))


def _least(pieces: Sequence[Piece], holds: Callable[[Sequence[Piece]], bool]) -> Sequence[Piece]:
    """Return a part of some pieces that holds, and does not where one more is left out, if it can be found in time.

    Zeller and Hildebrandt, "Simplifying and isolating failure-inducing input", 2002, without their complements.
    """
    found = list(pieces)
    size = max(len(found) // 2, 1)
    while found:
        at, before = 0, len(found)
        while at < len(found):
            fewer = found[:at] + found[at + size :]
            if holds(fewer):
                found = fewer
            else:
                at += size
        if size == 1 and len(found) == before:
            break
        size = max(size // 2, 1)
    return found
