"""Tasks in words: the states of a task, and a summary of validated tasks on stderr (a line and a table of causes)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from itertools import islice
from typing import TYPE_CHECKING

from prag_asp.cli import exit_control
from prag_asp.cli.terminal import hide_progress
from prag_asp.errors import PragError, one_line
from prag_asp.wording import plural

if TYPE_CHECKING:
    from rich.table import Table

    from prag_asp.dataset.pass_rates import Tally
    from prag_asp.dataset.strata.stratum_figures import StratumFigures
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.task import State, Task

READINGS = 5
"""The maximum number of readings of a plan that are printed."""

KINDS = {"not_found": "not found", "infeasible": "proved infeasible", "witness_fails": "witness fails"}
"""The names of failures in the table, by status."""


def tally_line(tally: Tally, what: tuple[str, str], limits: str) -> str:
    """Return a line with the number of tasks that passed; `what` holds the noun for one task and for several."""
    share = f" ({100 * tally.passed / tally.seen:.1f} %, {limits})" if tally.seen else ""
    return f"{plural(tally.seen, *what)}, {tally.passed} passed{share}"


@contextmanager
def tallied(tally: Tally, line: Callable[[], str]) -> Iterator[None]:
    """Print a line on stderr at the end and, if anything failed, the table of causes.

    This also happens after an interruption, but not after an error in the input. An error after a signal counts as an
    interruption, because native code may raise other errors when it is interrupted.
    """
    failed = False
    try:
        yield
    except PragError:
        failed = not exit_control.interrupted()
        raise
    finally:
        if tally.seen and not failed:
            from rich.console import Console

            hide_progress()
            console = Console(stderr=True, highlight=False)
            console.print(one_line(line()), soft_wrap=True, markup=False)
            if tally.reasons or tally.causes:
                console.print(_table(tally))


MOST_STRATA = 20
"""The maximum number of strata that are printed."""


def strata_lines(strata: Sequence[StratumFigures]) -> list[str]:
    """Return a line for each stratum in a sample: its tasks, its size, and the weight of each task."""
    from prag_asp.dataset.strata.stratum_figures import stratum_weights

    weights = stratum_weights(strata)
    rows = [
        (each.name, str(each.tasks), each.size, str(weights[each.name] / each.tasks) if each.tasks else "none")
        for each in strata[:MOST_STRATA]
    ]
    wide = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = [
        f"{name:<{wide[0]}}  {tasks:>{wide[1]}} of {size:>{wide[2]}} tasks, each of weight {weight}"
        for name, tasks, size, weight in rows
    ]
    return lines + ([f"and {len(strata) - MOST_STRATA} more strata"] if len(strata) > MOST_STRATA else [])


def _table(tally: Tally) -> Table:
    """Return a table of the numbers of failed tasks by reason, and of failed attempts by cause."""
    from rich.markup import escape
    from rich.table import Table

    from prag_asp.physics import CAUSES

    table = Table()
    table.add_column("cause")
    table.add_column("tasks", justify="right")
    table.add_column("failed attempts", justify="right")
    tasks = {cause: tally.reasons["not_found", cause] for cause in CAUSES}
    for cause in CAUSES:
        if tally.causes[cause] or tasks[cause]:
            table.add_row(cause, str(tasks[cause]), str(tally.causes[cause]))
    for (status, reason), number in tally.reasons.most_common():
        if status != "not_found" or reason not in tasks:
            table.add_row(escape(one_line(f"{KINDS.get(status, status)}: {reason}")), str(number), "")
    return table


def described(found: Task, space: TaskSpace, *, false_facts: bool = False) -> list[str]:
    """Return lines that describe a task: its rank, initial state, effects of actions, goal and readings.

    For each state, the true facts are listed and, with `false_facts`, the facts that are known to be false.
    """
    lines = [f"task {space.index(found)} of {space.count()}", f"start  {_state(found.initial, false_facts)}"]
    width = max((len(str(action)) for action in found.actions), default=0)
    for number, (action, subgoal) in enumerate(zip(found.actions, found.subgoals, strict=True), 1):
        lines.append(f"{number:>5}  {action!s:<{width}}  {_facts_text(subgoal)}".rstrip())
    lines.append(f"goal   {_state(found.goal, false_facts)}")
    readings = space.readings(found) if space.domain.facts.composites else None
    if readings is not None:
        lines += [f"read   {' '.join(map(str, reading))}" for reading in islice(readings, READINGS)]
        if readings.count() > READINGS:
            lines.append(f"       and {plural(readings.count() - READINGS, 'more reading')}")
    return lines


def _state(state: State, false_facts: bool) -> str:
    """Return the true facts of a state as text, or all known facts."""
    return _facts_text({fluent: value for fluent, value in state.items() if value or false_facts}) or "no true fact"


def _facts_text(state: State) -> str:
    return ", ".join(f"{'' if value else 'not '}{fluent}" for fluent, value in state.items())
