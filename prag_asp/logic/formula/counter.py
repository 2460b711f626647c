"""Exact projected model counting by Ganak, in a process of its own that can be killed.

Ganak is native code that hears neither Ctrl-C nor a time limit, and that ends the process where its input is wrong.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from importlib.util import find_spec
from itertools import chain
from tempfile import TemporaryFile
from typing import IO

from prag_asp.errors import EngineError, LimitReached
from prag_asp.logic.formula.clauses import Literal
from prag_asp.logic.formula.cnf import Cnf
from prag_asp.processes.children import Children, Ended

SHARP = "sharp"
"""The engine of task spaces that counts so."""

LARGEST = 2**24
"""Variables that Ganak is given at most: beyond, it takes memory without bound, or aborts."""


def has_ganak() -> bool:
    """Tell whether Ganak is installed."""
    return find_spec("pyganak") is not None


def require_ganak(engine: str = SHARP) -> None:
    """Refuse to go on where Ganak is not installed.

    Raises:
        EngineError: it is not.
    """
    if not has_ganak():
        raise EngineError(f"engine {engine}: the package pyganak is missing; pip install 'prag_asp[sharp]'")


def count_models(
    cnf: Cnf, assumptions: Sequence[Literal] = (), seconds: float | None = None, *, engine: str = SHARP
) -> int:
    """Return the number of assignments of the shown variables that a model with the literals assumed has.

    Messages speak of the engine that the user has chosen.

    Raises:
        EngineError: Ganak is missing, cannot take the formula, or fails.
        LimitReached: it has not finished after `seconds`.
    """
    require_ganak(engine)
    clauses = [*cnf.clauses, *((literal,) for literal in assumptions)]
    refuse_what_ganak_cannot_take(cnf.variables, clauses, cnf.shown, engine)
    with TemporaryFile() as complaints, Children("prag_asp.logic.formula.ganak", complaints.fileno()) as children:
        try:
            ganak = children.start()
            ganak.send((cnf.variables, cnf.shown, clauses))
            return int(ganak.receive(seconds))
        except TimeoutError:
            told = f"engine {engine}: no count after {seconds:.3g} s"
            raise LimitReached(f"{told}; allow more (--time), or choose a smaller length", 0) from None
        except Ended as ended:
            said = _last_line(complaints)
            raise EngineError(f"engine {engine}: Ganak ended {ended} ({said}); choose another engine") from None


def _last_line(complaints: IO[bytes]) -> str:
    """Return what was complained about last."""
    complaints.seek(0)
    lines = complaints.read().decode(errors="replace").strip().splitlines()
    return lines[-1] if lines else "nothing said"


def refuse_what_ganak_cannot_take(
    variables: int, clauses: Iterable[Sequence[Literal]], shown: Sequence[Literal], engine: str = SHARP
) -> None:
    """Refuse a formula that Ganak would miscount or abort on.

    Raises:
        EngineError: it has no variables or too many, an empty clause, or a literal of none of its variables.
    """
    if not 0 < variables <= LARGEST:
        raise EngineError(f"engine {engine}: a formula of {variables:,} variables; Ganak takes 1 to {LARGEST:,}")
    for clause in clauses:
        if not clause:
            raise EngineError(f"engine {engine}: a clause is empty, which Ganak may overlook")
    for literal in chain(shown, *clauses):
        if not 0 < abs(literal) <= variables:
            raise EngineError(f"engine {engine}: the literal {literal} is none of the {variables:,} variables")
