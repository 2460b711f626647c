"""The file counts.toml of a domain: exact counts by level and length, below ``flat`` those without the hierarchy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from prag_asp.program.settings import read_table
from tests.simulation import Simulation

LEVELS = ("plan", "task", "skeleton")


def known_counts(folder: Path) -> Mapping[str, Mapping[int, int]]:
    """Return the counts by length for each level, such as ``plan`` and ``flat.plan``."""
    table: dict[str, Any] = read_table(folder / "counts.toml")
    levels = {level: table[level] for level in LEVELS}
    levels.update({f"flat.{level}": counts for level, counts in table.get("flat", {}).items()})
    return {level: {int(length): count for length, count in counts.items()} for level, counts in levels.items()}


def check_known_counts(folder: Path, simulation: Simulation, level: str, *swaps: Sequence[str]) -> None:
    """Check the counts of a level against a simulation of the domain, in which each of `swaps` may take place."""
    known = known_counts(folder)[level]
    told, _, by = level.rpartition(".")
    simulated = simulation.flat if told else simulation
    longest = max(known)
    if by == "task":
        found = simulated.tasks(longest, swaps)
    else:
        found = simulated.plans(longest) if by == "plan" else simulated.skeletons(longest)
    assert longest >= 4
    assert known == dict(enumerate(found))
