"""Answer sets of any program beside clingo's enumeration and pyganak alone, in one run: python benchmarks/models.py.

Times are seconds of processor time of the process and its children. It fails where two counts differ.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import clingo
from rich.console import Console
from rich.table import Table

from prag_asp import answer_sets
from prag_asp.logic.formula.counter import count_models
from prag_asp.models.formula import model_formula

GRID = "v(1..n,1..m). e((X,Y),(X+1,Y)) :- v(X,Y), v(X+1,Y). e((X,Y),(X,Y+1)) :- v(X,Y), v(X,Y+1). "
INDEPENDENT = GRID + "{ in(A) } :- v(X,Y), A = (X,Y). :- e(A,B), in(A), in(B)."
CONNECTED = (
    GRID + "{ t(A,B) } :- e(A,B). r((1,1)). r(B) :- r(A), t(A,B). r(A) :- r(B), t(A,B). :- v(X,Y), not r((X,Y))."
)
CIRCLE = "{ c(X,1..k) } = 1 :- X = 1..n. :- c(X,C), c(X+1,C). :- c(1,C), c(n,C)."
ENUMERATED = 1_000_000
"""Answer sets that clingo finds of each program; the time for the others is extrapolated."""

DRAWN = 20_000


def timed(work: Callable[[], Any]) -> tuple[Any, float]:
    """Return what a piece of work returns, and its seconds of processor time."""
    before = os.times()
    found = work()
    return found, sum(os.times()[:4]) - sum(before[:4])


def enumerated(text: str, constants: dict[str, int]) -> int:
    """Return how many answer sets clingo finds, with no callback, up to a bound."""
    control = clingo.Control([str(ENUMERATED), *(f"-c{name}={value}" for name, value in constants.items())])
    control.add("base", [], text)
    control.ground([("base", [])])
    control.solve()
    return int(control.statistics["summary"]["models"]["enumerated"])


def counting(name: str, text: str, constants: dict[str, int]) -> tuple[str, ...]:
    """Return the row of a program: its count, our time, that of the counter alone, and that of enumeration."""
    count, own = timed(lambda: answer_sets(text=text, constants=constants).count())
    ground = answer_sets(text=text, constants=constants).ground
    formula = model_formula(ground, project=False, copied=False)
    alone = ""
    if not formula.completion.loops:
        same, seconds = timed(lambda: count_models(formula.cnf))
        assert same == count
        alone = f"{seconds:.2f}"
    found, peer = timed(lambda: enumerated(text, constants))
    assert found == min(count, ENUMERATED)
    by_clingo = Fraction(peer) * count / found
    shown = f"{count:,}" if count < 10**18 else f"{len(str(count))} digits"
    return (
        name,
        f"{len(ground.rules):,}",
        shown,
        f"{own:.2f}",
        alone,
        power(by_clingo),
        power(by_clingo / Fraction(own)),
    )


def power(number: Fraction) -> str:
    """Return a number with three digits, or as a power of ten where it is beyond all use."""
    return f"{float(number):.3g}" if number < 10**9 else f"10^{len(str(int(number))) - 1}"


def drawing() -> tuple[float, int, float]:
    """Return draws a second of a large program, its count, and chi-square over degrees of freedom for a small one."""
    large = answer_sets(text=INDEPENDENT, constants={"n": 9, "m": 9})
    next(large.sample(1))  # compiled
    _, seconds = timed(lambda: list(large.sample(DRAWN, seed=1)))
    small = answer_sets(text=CIRCLE, constants={"n": 6, "k": 5})
    number = small.count()
    drawn = Counter(small.sample(100 * number, seed=1))
    assert len(drawn) <= number
    square = sum((often - 100) ** 2 / 100 for often in drawn.values()) + 100 * (number - len(drawn))
    return DRAWN / seconds, large.count(), square / (number - 1)


def main() -> None:
    """Print both tables."""
    table = Table("program", "ground rules", "answer sets", "models count, s", "pyganak alone, s", "clingo, s", "ratio")
    answer_sets(text="{a;b}. a :- b. b :- a.").count()  # what is imported when it is first used
    for row in (
        ("independent sets of 6 x 290, tight", INDEPENDENT, {"n": 6, "m": 290}),
        ("connected subgraphs of 3 x 6, loops", CONNECTED, {"n": 3, "m": 6}),
        ("connected subgraphs of 3 x 7, loops", CONNECTED, {"n": 3, "m": 7}),
        ("connected subgraphs of 4 x 6, loops", CONNECTED, {"n": 4, "m": 6}),
    ):
        table.add_row(*counting(*row))
    Console(width=140).print(table)
    rate, count, square = drawing()
    rates = Table("draws/s", "of answer sets", "chi2/df at 100 draws a model")
    rates.add_row(f"{rate:,.0f}", f"{count:,}", f"{square:.3f}")
    Console(width=140).print(rates)


if __name__ == "__main__":
    main()
