"""Count answer sets where it is unknown which engine is fastest: by a bounded enumeration, or by two at once."""

from __future__ import annotations

from itertools import count as counting

from prag_asp.logic.formula.counter import CountBeside
from prag_asp.models.compiled_program import CompiledProgram
from prag_asp.models.enumeration.bounded_enumeration import BoundedEnumeration
from prag_asp.models.enumeration.effort import SECOND, first_effort, is_worth_enumerating
from prag_asp.processes.progress_events import stage

PATIENCE = 500
"""Calls of `look`, each after 64 visits of nodes, before a counter starts in parallel: about 2 s of compilation."""

HEAD_START = 1.0
"""Processor seconds of a counter before compiling begins as well, for tight programs: most are counted by then."""


class _Counted(Exception):
    """The parallel counter finished before the compilation."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


def count_by_enumeration(compiled: CompiledProgram) -> int | None:
    """Return the number of answer sets; None if clingo is not likely to be fastest, or its work exceeds the limits."""
    enumeration = BoundedEnumeration(compiled.ground, project=compiled.project)
    number = enumeration.count(first_effort(compiled.ground))
    if number is None and is_worth_enumerating(enumeration.depth(), compiled.prepared.order.width):
        number = enumeration.count(SECOND)
    return number


def count_beside(compiled: CompiledProgram, head_start: float | None) -> int | None:
    """Return the number of answer sets by a counter, or None if the diagram was compiled before.

    The counter starts at once with a head start in processor seconds, or, without it, after `PATIENCE`.
    """
    looks = counting()

    def begins() -> None:
        if head_start is None:
            compiled.note("ganak counts as well, because compiling takes long; the first answers")

    def look() -> None:
        number = beside() if head_start is not None or next(looks) >= PATIENCE else None
        if number is not None:
            raise _Counted(number)

    with CountBeside(lambda: (compiled.counting_formula.cnf, ()), 0, begins) as beside:
        if head_start is not None:
            stage("counting models with ganak")
            number = beside.alone(head_start)
            if number is not None:
                return number
        try:
            compiled.compile(look)
        except _Counted as counted:
            return counted.number
    return None
