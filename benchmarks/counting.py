"""Compare exact counting with clingo's enumeration: python benchmarks/counting.py."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from time import perf_counter

from rich.console import Console
from rich.table import Table

from prag_asp import TaskSpace, load_domain

TRANSPORT = Path(__file__).parent / "transport"
ENUMERATED = 7
"""The largest length that clingo finishes in seconds; longer ones are extrapolated by its models per second."""


def seconds(work: Callable[[], object]) -> float:
    """Return the wall-clock seconds that a function takes."""
    begun = perf_counter()
    work()
    return perf_counter() - begun


def main() -> None:
    """Print the table of counting times and their ratios."""
    domain = load_domain(TRANSPORT)
    table = Table("length", "plans", "automaton, s", "clingo, s", "ratio")
    reference = TaskSpace(domain, ENUMERATED, engine="clingo")
    models = reference.count("plan")
    rate = models / seconds(lambda: TaskSpace(domain, ENUMERATED, engine="clingo").count("plan"))
    for length in (ENUMERATED, 15, 30, 1000):
        space = TaskSpace(domain, length, engine="automaton")
        ours = seconds(lambda space=space: space.count("plan"))  # type: ignore[misc]
        count = space.count("plan")
        digits = len(str(count))
        peer = count // int(rate)
        shown = f"{peer:,}" if digits < 20 else f"10^{len(str(peer)) - 1}"
        ratio = int(peer / ours) if digits < 20 else 0
        table.add_row(
            f"{length:,}",
            f"{count:,}" if digits < 20 else f"{digits} digits",
            f"{ours:.3f}",
            shown if length == ENUMERATED else f"{shown} (extrapolated)",
            f"{ratio:,}" if ratio else "-",
        )
    Console().print(table)


if __name__ == "__main__":
    main()
