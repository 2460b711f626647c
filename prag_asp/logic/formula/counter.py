"""Exact projected model counting by Ganak, in a process of its own that can be killed.

Ganak is native code that hears neither Ctrl-C nor a time limit, and that ends the process where its input is wrong.
"""

from __future__ import annotations

import ctypes
import signal
import subprocess
import sys
from collections.abc import Iterable, Sequence
from importlib.util import find_spec
from itertools import chain

from prag_asp.errors import EngineError
from prag_asp.logic.formula.clauses import Literal
from prag_asp.logic.formula.cnf import Cnf

LARGEST = 2**24
"""Variables that Ganak is given at most: beyond, it takes memory without bound, or aborts."""

ANSWER = "count "


def require_ganak() -> None:
    """Refuse to go on where Ganak is not installed.

    Raises:
        EngineError: it is not.
    """
    if find_spec("pyganak") is None:
        raise EngineError("engine sharp: the package pyganak is missing; pip install 'prag_asp[sharp]'")


def count_models(cnf: Cnf, assumptions: Sequence[Literal] = (), seconds: float | None = None) -> int:
    """Return the number of assignments of the shown variables that a model with the literals assumed has.

    Raises:
        EngineError: Ganak is missing, cannot take the formula, fails, or has not finished after `seconds`.
    """
    require_ganak()
    clauses = [*cnf.clauses, *((literal,) for literal in assumptions)]
    refuse_what_ganak_cannot_take(cnf.variables, clauses, cnf.shown)
    text = "\n".join(" ".join(map(str, row)) for row in ((cnf.variables,), cnf.shown, *clauses))
    # The path is handed over, and the folder that the user stands in, which Python would add, left out.
    code = f"import sys; sys.path[:] = {sys.path!r}; from prag_asp.logic.formula.counter import main; main()"
    process = subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        printed, complaint = process.communicate(text, timeout=seconds)
    except subprocess.TimeoutExpired:
        raise EngineError(
            f"engine sharp: no count after {seconds:g} s; allow more, or choose a smaller length"
        ) from None
    finally:
        process.kill()
        process.communicate()
    answers = [line for line in printed.splitlines() if line.startswith(ANSWER)]
    if process.returncode or len(answers) != 1:
        said = (complaint.strip().splitlines() or ["nothing said"])[-1]
        raise EngineError(f"engine sharp: Ganak ended with code {process.returncode} ({said}); choose another engine")
    return int(answers[0].removeprefix(ANSWER))


def refuse_what_ganak_cannot_take(
    variables: int, clauses: Iterable[Sequence[Literal]], shown: Sequence[Literal]
) -> None:
    """Refuse a formula that Ganak would miscount or abort on.

    Raises:
        EngineError: it has no variables or too many, an empty clause, or a literal of none of its variables.
    """
    if not 0 < variables <= LARGEST:
        raise EngineError(f"engine sharp: a formula of {variables:,} variables; Ganak takes 1 to {LARGEST:,}")
    for clause in clauses:
        if not clause:
            raise EngineError("engine sharp: a clause is empty, which Ganak may overlook")
    for literal in chain(shown, *clauses):
        if not 0 < abs(literal) <= variables:
            raise EngineError(f"engine sharp: the literal {literal} is none of the {variables:,} variables")


def main() -> None:
    """Count the formula on stdin: the number of variables, those shown, then a clause a line."""
    import pyganak  # noqa: PLC0415

    _end_with_parent()
    (variables,), shown, *clauses = ([int(word) for word in line.split()] for line in sys.stdin)
    counter = pyganak.Counter()
    counter.new_vars(variables)
    counter.add_clauses(clauses)
    counter.set_sampling_set(shown)
    sys.stdout.write(f"\n{ANSWER}{counter.count()}\n")


def _end_with_parent() -> None:
    """Have this process end where the one that asked is killed and cannot do it."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG
