"""The command line and the Python code that give the same result as a view."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass

from prag_asp.explore.explored_domain import ExploredDomain
from prag_asp.explore.page_state import PageState


@dataclass(frozen=True)
class SameResult:
    """What a view shows, in a few words, and the command line and the Python code that produce it."""

    what: str
    shell: str
    python: str


def shell_line(explored: ExploredDomain, command: str, state: PageState, *options: str) -> str:
    """Return a command line about the tasks that have a page's length and conditions."""
    words = ["prag-asp", command, *explored.words, "--length", str(state.length)]
    words += [word for text in state.where for word in ("--where", text)]
    return shlex.join([*words, *options])


def python_space(explored: ExploredDomain, state: PageState, *more: str) -> str:
    """Return the Python code that makes the task space of a page, under further conditions."""
    conditions = (*state.where, *more)
    under = f".where({', '.join(map(repr, conditions))})" if conditions else ""
    return (
        f"from prag_asp import TaskSpace, load_domain\n"
        f"space = TaskSpace({explored.call}, length={state.length}){under}\n"
    )


def level_options(state: PageState) -> tuple[str, ...]:
    """Return the options of a command that select the level of a page."""
    return () if state.by == "task" else ("--by", state.by)


def level_argument(state: PageState) -> str:
    """Return the argument of a method, after other arguments, that selects the level of a page."""
    return "" if state.by == "task" else f", by={state.by!r}"


def beginning(chosen: Sequence[str]) -> str:
    """Return the condition that a task begins with the given actions."""
    return f"begins {', '.join(chosen)}"
