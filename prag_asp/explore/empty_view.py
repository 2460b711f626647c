"""Why no task remains: the conditions and lines of the domain that together exclude every task."""

from __future__ import annotations

from dataclasses import dataclass

from prag_asp.explore.explored_domain import ExploredDomain
from prag_asp.explore.page_state import PageState
from prag_asp.explore.same_result import SameResult, beginning, python_space, shell_line
from prag_asp.space.emptiness import why_empty


@dataclass(frozen=True)
class EmptyView:
    """A minimal set of conditions, and of lines as ``file:line: text``, that exclude every task.

    Both are empty if a task remains, in which case `empty` is False, or if the declarations of the domain alone allow
    no task.
    """

    empty: bool
    conditions: tuple[str, ...]
    lines: tuple[str, ...]
    same: SameResult


def empty_view(explored: ExploredDomain, state: PageState) -> EmptyView:
    """Return why no task begins with the actions chosen on a page.

    Raises:
        PragError: the state does not fit the domain, or the program cannot be translated to clauses.
    """
    chosen = explored.chosen(state)
    begun = (beginning(chosen),) if chosen else ()
    reasons = why_empty(explored.space(state.length, (*state.where, *begun)))
    shell = shell_line(explored, "explain", state, *(word for text in begun for word in ("--where", text)))
    same = SameResult(
        "why", shell, f"from prag_asp import why_empty\n{python_space(explored, state, *begun)}why_empty(space)"
    )
    if reasons is None:
        return EmptyView(False, (), (), same)
    return EmptyView(True, tuple(map(str, reasons.conditions)), tuple(map(str, reasons.lines)), same)
