"""Functions that tests call in processes of their own."""

from __future__ import annotations

import signal
from collections.abc import Sequence

from prag_asp import QueryError, load_domain


def total(numbers: Sequence[int]) -> int:
    return sum(numbers)


def refuse() -> None:
    raise QueryError("not so")


def grow() -> None:
    """Ground without end, in foreign code."""
    load_domain(
        text="class(lamp). entity(one,lamp). fluent(on). action(off). n(1..3000). m(X,Y,Z) :- n(X), n(Y), n(Z).\n"
        "precondition(off,on,true). postcondition(off,on,false). initially(on,true)."
    )


def fill() -> None:
    kept = []
    while True:
        kept.append(b"x" * 10**6)


def crash() -> None:
    signal.raise_signal(signal.SIGSEGV)
