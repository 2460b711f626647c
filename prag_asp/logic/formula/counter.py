"""Model counting in a child process: exactly with Ganak or d4, or approximately with ApproxMC.

The native code of all three handles neither Ctrl-C nor a time limit, and ends its process on invalid input.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from importlib.util import find_spec
from itertools import chain
from signal import SIGCONT, SIGSTOP
from tempfile import TemporaryFile
from time import monotonic
from typing import Any

from prag_asp.errors import EngineError, LimitReached
from prag_asp.logic.formula.clause_builder import Literal
from prag_asp.logic.formula.cnf import Cnf
from prag_asp.processes.machine import processor_time_of
from prag_asp.processes.workers import Worker, WorkerEnded, WorkerGroup, ready_workers
from prag_asp.stop_reason import StopKind, StopReason


@dataclass(frozen=True)
class Counter:
    """A model counter: its package, the extra that installs it, and the module of its child process."""

    name: str
    package: str
    extra: str
    module: str


GANAK = Counter("Ganak", "pyganak", "sharp", "prag_asp.logic.formula.ganak")
D4 = Counter("d4", "py_d4", "sharp", "prag_asp.logic.formula.d4")
APPROXMC = Counter("ApproxMC", "pyapproxmc", "approximate", "prag_asp.logic.formula.approxmc")

SHARP = "engine sharp"
"""The engine that needs Ganak, as named in messages."""

POLL = 0.05
"""Seconds between two measurements of the processor time of a counter."""

LARGEST = 2**24
"""The largest number of variables in a formula: beyond it, Ganak needs unbounded memory or aborts."""


def has_counter(counter: Counter = GANAK) -> bool:
    """Return whether a counter is installed."""
    return find_spec(counter.package) is not None


def require_counter(counter: Counter = GANAK, request: str = SHARP) -> None:
    """Check that a counter is installed; `request` names the user's request in the message.

    Raises:
        EngineError: the counter is not installed.
    """
    if not has_counter(counter):
        raise EngineError(
            f"{request}: the package {counter.package} is missing; pip install 'prag_asp[{counter.extra}]'"
        )


def count_models(
    cnf: Cnf,
    assumptions: Sequence[Literal] = (),
    seconds: float | None = None,
    *,
    counter: Counter = GANAK,
    request: str = SHARP,
) -> int:
    """Return the number of assignments of the shown variables that extend to a model under assumptions.

    d4 does not support projection: it counts models over all variables. `request` names the user's request in messages.

    Raises:
        EngineError: the counter is missing, cannot accept the formula, or fails.
        LimitReached: the counter has not finished after `seconds`.
    """
    return int(run_counter(counter, cnf, assumptions, seconds, request))


def run_counter(
    counter: Counter, cnf: Cnf, assumptions: Sequence[Literal], seconds: float | None, request: str, *more: object
) -> Any:
    """Return a counter's result for a formula under assumptions; `more` are further arguments of the counter.

    Raises:
        EngineError: the counter is not installed, cannot accept the formula, or fails.
        LimitReached: the counter has not finished after `seconds`.
    """
    require_counter(counter, request)
    message = _checked_formula(cnf, assumptions, counter, request)
    with TemporaryFile() as complaints, WorkerGroup(counter.module, complaints.fileno()) as children:
        try:
            child = children.start()
            child.send((*message, *more))
            return child.receive(seconds)
        except TimeoutError:
            what = f"{request}: no count after {seconds:.3g} s; allow more (--time), or ask for less"
            raise LimitReached(what, 0, StopReason(StopKind.TIME, seconds)) from None
        except WorkerEnded as ended:
            complaints.seek(0)
            last_line = complaints.read().decode(errors="replace").strip().rpartition("\n")[2] or "nothing said"
            raise EngineError(f"{request}: {counter.name} ended {ended} ({last_line}); choose another engine") from None


class CountBeside:
    """A context manager that counts the models of a formula in a child process while this process does other work.

    `formula` returns the formula and the assumptions; it is called when the counter starts, at the first call after
    `patience` seconds. A failure is not an error; the count then remains unknown.
    """

    def __init__(
        self,
        formula: Callable[[], tuple[Cnf, Sequence[Literal]]],
        patience: float,
        begins: Callable[[], None] = lambda: None,
        counter: Counter = GANAK,
    ) -> None:
        self._formula, self._begins, self._counter = formula, begins, counter
        self._due: float | None = monotonic() + patience
        self._running = ExitStack()
        self._child: Worker | None = None

    def __enter__(self) -> CountBeside:
        return self

    def __exit__(self, *error: object) -> None:
        self._running.close()

    def __call__(self) -> int | None:
        """Return the number of models once it is known; the first call after `patience` seconds starts the counter."""
        due = self._due is not None and monotonic() >= self._due
        try:
            if self._child is not None and ready_workers([self._child], 0):
                return int(self._child.receive())
            if due:
                self._due = None
                cnf, assumptions = self._formula()
                message = _checked_formula(cnf, assumptions, self._counter)
                complaints = self._running.enter_context(TemporaryFile())  # noqa: SIM115  the stack closes it
                child = self._running.enter_context(WorkerGroup(self._counter.module, complaints.fileno())).start()
                child.send(message)
                self._child = child
        except (EngineError, WorkerEnded, OSError, MemoryError):  # the last two errors mean that there is no space left
            self._running.close()
            self._child = None
        if due and self._child is not None:
            self._begins()  # an error of the callback is not a failure of the counter
        return None

    def alone(self, seconds: float) -> int | None:
        """Return the number of models, or None if the counter fails or takes more than `seconds` of processor time."""
        number = self()
        while number is None and self._child is not None and processor_time_of(self._child.process.pid) < seconds:
            ready_workers([self._child], POLL)
            number = self()
        return number

    def pause(self) -> None:
        """Stop the child process, if there is one, until `resume`."""
        if self._child is not None:
            self._child.process.send_signal(SIGSTOP)

    def resume(self) -> None:
        """Continue the child process after `pause`."""
        if self._child is not None:
            self._child.process.send_signal(SIGCONT)


def _checked_formula(
    cnf: Cnf, assumptions: Sequence[Literal], counter: Counter = GANAK, request: str = SHARP
) -> tuple[int, Sequence[Literal], list[tuple[Literal, ...]]]:
    """Check a formula under assumptions, and return its number of variables, its shown variables and its clauses."""
    clauses = [*cnf.clauses, *((literal,) for literal in assumptions)]
    check_formula(cnf.variables, clauses, cnf.shown, counter, request)
    return cnf.variables, cnf.shown, clauses


def check_formula(
    variables: int,
    clauses: Iterable[Sequence[Literal]],
    shown: Sequence[Literal],
    counter: Counter = GANAK,
    request: str = SHARP,
) -> None:
    """Check that a counter can accept a formula.

    Raises:
        EngineError: the formula has no variables or too many, an empty clause, or a literal of an unknown variable.
    """
    if not 0 < variables <= LARGEST:
        raise EngineError(f"{request}: a formula of {variables:,} variables; {counter.name} takes 1 to {LARGEST:,}")
    for clause in clauses:
        if not clause:
            raise EngineError(f"{request}: a clause is empty, which {counter.name} may overlook")
    for literal in chain(shown, *clauses):
        if not 0 < abs(literal) <= variables:
            raise EngineError(f"{request}: the literal {literal} is none of the {variables:,} variables")
