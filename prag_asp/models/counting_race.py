"""Counts of answer sets when the fastest engine is unknown: a brief enumeration, then several engines in turns.

A turn has a limit on its processor time. Counters run in their own processes, and are paused after their turns. If no
engine has finished, the counters continue in parallel, and this process compiles a diagram; the first count is the
answer.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from itertools import count
from math import inf
from time import process_time

from prag_asp.logic.formula.cnf import Cnf
from prag_asp.logic.formula.counter import CountBeside, Counter, has_counter
from prag_asp.models.compiled_program import CompiledProgram
from prag_asp.models.enumeration.bounded_enumeration import BoundedEnumeration
from prag_asp.models.enumeration.effort import (
    LONG_TABLE,
    QUICK,
    OwnEngine,
    Turn,
    first_effort,
    seconds_of_enumeration,
    seconds_of_table,
    turns_of_engines,
)
from prag_asp.models.sums.sum_table import TableCount
from prag_asp.processes.progress_events import stage


class _Counted(Exception):
    """The signal that a counter has finished before the compilation."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


class _TimeOver(Exception):
    """The signal that the turn of the compiler is over."""


def count_by_race(compiled: CompiledProgram) -> int | None:
    """Return the number of answer sets, or None if the diagram was compiled first."""
    enumeration = BoundedEnumeration(compiled.ground, project=compiled.project)
    number = enumeration.count(first_effort(compiled.ground))
    if number is not None:
        return number
    predicted = enumeration.predicted_seconds()
    if predicted is not None and predicted <= QUICK:
        number = enumeration.count_within(seconds_of_enumeration(predicted))
        if number is not None:
            return number
        predicted = inf  # the prediction was wrong
    table = None if compiled.sums is None else TableCount(compiled.sums)
    if table is not None:
        number = table.within(seconds_of_table(table.most_seconds, predicted))
        if number is not None:
            return number
    formula, prepared = compiled.formula, compiled.prepared
    turns = turns_of_engines(
        predicted,
        prepared.order.width,
        tight=not formula.completion.loops,
        whole=formula.whole,
        swept=prepared.order.swept,
    )
    installed = [turn for turn in turns if isinstance(turn.engine, OwnEngine) or has_counter(turn.engine)]

    def begins(counter: Counter) -> None:
        compiled.note(f"{counter.name} also counts, because compilation takes long; the first result is used")

    own = {
        OwnEngine.CLINGO: enumeration.count_within,
        OwnEngine.DIAGRAM: lambda seconds: _count_by_diagram(compiled, seconds),
    }

    def compile_last(look: Callable[[], None]) -> None:
        number = None if table is None else table.within(LONG_TABLE, look)
        if number is not None:
            raise _Counted(number)
        compiled.compile(look)

    return count_unless_compiled(installed, lambda: compiled.counting_formula.cnf, compile_last, begins, own)


def _count_by_diagram(compiled: CompiledProgram, seconds: float) -> int | None:
    """Return the number of answer sets, or None if compiling takes more than `seconds` of processor time."""
    until = process_time() + seconds

    def look() -> None:
        if process_time() > until:
            raise _TimeOver

    try:
        compiled.compile(look)
    except _TimeOver:
        return None
    return compiled.diagram.unweighted().total


def count_unless_compiled(
    turns: Sequence[Turn],
    formula: Callable[[], Cnf],
    compile_formula: Callable[[Callable[[], None]], None],
    begins: Callable[[Counter], None],
    own: Mapping[OwnEngine, Callable[[float], int | None]] | None = None,
) -> int | None:
    """Return the number of models from the first engine to finish, or None if the compiler finishes first.

    `compile_formula` receives a function that it calls periodically, and propagates its errors. `begins` is called with
    each counter that has no separate turn when it starts to run alongside the compiler. `own` holds the engines of this
    process, each a function of its time limit in seconds.
    """
    looks = count()
    with ExitStack() as stack:

        def beside(turn: Turn, counter: Counter) -> CountBeside:
            tell = (lambda: None) if turn.seconds else (lambda: begins(counter))
            return stack.enter_context(CountBeside(lambda: (formula(), ()), 0, tell, counter))

        running: dict[Turn, CountBeside] = {}
        waiting = {turn: turn.engine for turn in turns if isinstance(turn.engine, Counter)}

        def look() -> None:
            now = next(looks)
            for turn in [each for each in waiting if each.looks <= now]:
                counter = waiting.pop(turn)
                if turn not in running:
                    running[turn] = beside(turn, counter)
                running[turn].resume()
            for each in running.values():
                number = each()
                if number is not None:
                    raise _Counted(number)

        for turn in turns:
            number = None
            if isinstance(turn.engine, OwnEngine):
                number = (own or {})[turn.engine](turn.seconds)
            elif turn.seconds:
                stage(f"counting models with {turn.engine.name}")
                running[turn] = beside(turn, turn.engine)
                number = running[turn].alone(turn.seconds)
                if number is None:
                    running[turn].pause()
            if number is not None:
                return number
        try:
            look()
            compile_formula(look)
        except _Counted as counted:
            return counted.number
    return None
