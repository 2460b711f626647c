"""Count answer sets if the fastest engine is unknown: by a bounded enumeration, then by several engines in parallel.

Each counter runs in its own process for a turn of some processor seconds, while the others are paused. If none has
finished, all of them continue in parallel, and this process compiles a diagram; the first count is the answer.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from itertools import count

from prag_asp.logic.formula.cnf import Cnf
from prag_asp.logic.formula.counter import CountBeside, Counter, has_counter
from prag_asp.models.compiled_program import CompiledProgram
from prag_asp.models.enumeration.bounded_enumeration import BoundedEnumeration
from prag_asp.models.enumeration.effort import SECOND, Turn, first_effort, is_worth_enumerating, turns_of_counters
from prag_asp.processes.progress_events import stage


class _Counted(Exception):
    """A counter has finished before the compilation."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


def count_by_enumeration(compiled: CompiledProgram) -> int | None:
    """Return the number of answer sets, or None if clingo is unlikely to be fastest or its work exceeds the limits."""
    enumeration = BoundedEnumeration(compiled.ground, project=compiled.project)
    number = enumeration.count(first_effort(compiled.ground))
    if number is None and is_worth_enumerating(enumeration.depth(), compiled.prepared.order.width):
        number = enumeration.count(SECOND)
    return number


def count_beside(compiled: CompiledProgram) -> int | None:
    """Return the number of answer sets by an installed counter, or None if the diagram was compiled first."""
    formula = compiled.formula
    turns = turns_of_counters(compiled.prepared.order.width, tight=not formula.completion.loops, whole=formula.whole)

    def begins(counter: Counter) -> None:
        compiled.note(f"{counter.name} counts as well, because compiling takes long; the first answers")

    installed = [turn for turn in turns if has_counter(turn.counter)]
    return count_unless_compiled(installed, lambda: compiled.counting_formula.cnf, compiled.compile, begins)


def count_unless_compiled(
    turns: Sequence[Turn],
    formula: Callable[[], Cnf],
    compile_formula: Callable[[Callable[[], None]], None],
    begins: Callable[[Counter], None],
) -> int | None:
    """Return the number of models by the first counter to finish, or None if the compiler finished first.

    `compile_formula` receives a function that it calls periodically, and propagates its errors. `begins` receives each
    counter that first starts in parallel.
    """
    looks = count()
    with ExitStack() as stack:

        def beside(turn: Turn) -> CountBeside:
            tell = (lambda: None) if turn.seconds else (lambda: begins(turn.counter))
            return stack.enter_context(CountBeside(lambda: (formula(), ()), 0, tell, turn.counter))

        running: dict[Turn, CountBeside] = {}
        waiting = list(turns)

        def look() -> None:
            now = next(looks)
            for turn in [each for each in waiting if each.looks <= now]:
                waiting.remove(turn)
                if turn not in running:
                    running[turn] = beside(turn)
                running[turn].resume()
            for each in running.values():
                number = each()
                if number is not None:
                    raise _Counted(number)

        for turn in turns:
            if turn.seconds:
                stage(f"counting models with {turn.counter.name}")
                running[turn] = beside(turn)
                number = running[turn].alone(turn.seconds)
                if number is not None:
                    return number
                running[turn].pause()
        try:
            look()
            compile_formula(look)
        except _Counted as counted:
            return counted.number
    return None
