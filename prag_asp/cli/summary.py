"""The summary of validated tasks on stderr: a line, and a table of causes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from prag_asp.cli import exit_control
from prag_asp.cli.terminal import hide_progress
from prag_asp.errors import PragError, one_line
from prag_asp.wording import plural

if TYPE_CHECKING:
    from rich.table import Table

    from prag_asp.dataset.pass_rates import Tally

KINDS = {"not_found": "not found", "infeasible": "proved infeasible", "witness_fails": "witness fails"}
"""The names of failures in the table, by status."""


def tally_line(tally: Tally, what: tuple[str, str], limits: str) -> str:
    """Return one line with the number of tasks that passed; `what` is the noun for one task and for several."""
    share = f" ({100 * tally.passed / tally.seen:.1f} %, {limits})" if tally.seen else ""
    return f"{plural(tally.seen, *what)}, {tally.passed} passed{share}"


@contextmanager
def tallied(tally: Tally, line: Callable[[], str]) -> Iterator[None]:
    """Print a line on stderr at the end, and, if anything failed, the table of causes.

    This also happens after an interruption, but not after an error of the input.
    An error after a signal counts as an interruption, because native code may have turned one into the other.
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
