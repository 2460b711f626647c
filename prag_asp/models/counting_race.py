"""Count models by several engines of which any may be the fastest by orders of magnitude.

Each counter has a turn of some processor seconds in its own process, in which the others are paused. If none has
finished, all of them go on in parallel, and this process compiles a diagram; the first count is the answer.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from itertools import count
from typing import NamedTuple, TypeVar

from prag_asp.logic.formula.cnf import Cnf
from prag_asp.logic.formula.counter import CountBeside, Counter
from prag_asp.processes.progress_events import stage

Compiled = TypeVar("Compiled")


class Turn(NamedTuple):
    """A counter, the processor seconds of its turn, and after how many looks of the compiler it continues in parallel.

    Without seconds, it first starts in parallel.
    """

    counter: Counter
    seconds: float
    looks: int = 0


class CountFound(Exception):
    """A counter finished before the compiler."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


def count_or_compile(
    turns: Sequence[Turn],
    formula: Callable[[], Cnf],
    compile_formula: Callable[[Callable[[], None]], Compiled],
    begins: Callable[[Counter], None],
) -> int | Compiled:
    """Return the number of models by the first counter to finish, or what the compiler returns if that is faster.

    `compile_formula` receives a function that it calls periodically, and passes on what that raises. `begins` is told
    of each counter that first starts in parallel.
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
            for turn in turns:
                number = running[turn]() if turn in running else None
                if number is not None:
                    raise CountFound(number)

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
            return compile_formula(look)
        except CountFound as found:
            return found.number
