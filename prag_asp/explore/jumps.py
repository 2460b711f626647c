"""The jumps of a page: to the task with a given rank, and to a random task among those that remain."""

from __future__ import annotations

from dataclasses import dataclass, replace

from prag_asp.errors import QueryError
from prag_asp.explore.explored_domain import ExploredDomain
from prag_asp.explore.page_state import PageState
from prag_asp.explore.same_result import SameResult, beginning, level_argument, level_options, python_space, shell_line
from prag_asp.integers import digits_of
from prag_asp.space.word_set import WordSet


@dataclass(frozen=True)
class Jump:
    """The state to which a page jumps, and how to get the same task elsewhere."""

    query: str
    same: SameResult


def to_rank(explored: ExploredDomain, state: PageState, text: str) -> Jump:
    """Return the task or plan with a given rank under the conditions; negative ranks count from the end.

    Raises:
        PragError: the text is not a rank, or a limit was reached.
    """
    digits = text.strip().replace(",", "").replace(" ", "")
    if not digits.removeprefix("-").isdecimal():
        raise QueryError(f"{text[:40]!r} is not a rank; write a whole number, such as 0 or -1")
    rank, words = int(digits), WordSet(explored.space_of(state).engines, state.by, state.length)
    count = words.count()
    if not -count <= rank < count:
        shown = digits_of(count)
        raise QueryError(f"rank {digits_of(rank)}: there are {shown} {state.by}s, ranked from 0; choose a smaller one")
    word = words.word(rank % count)
    shell = shell_line(explored, "task", state, "--index", digits_of(rank)) if state.by == "task" else ""
    python = f"{python_space(explored, state)}space[{digits_of(rank)}]" if state.by == "task" else ""
    return Jump(replace(state, chosen=word).query, SameResult("this task", shell, python))


def to_sample(explored: ExploredDomain, state: PageState, seed: int, *, weighted: bool) -> Jump:
    """Return a random task that begins with the chosen actions, sampled with the domain's weights or uniformly.

    Raises:
        PragError: no task remains, or a limit was reached.
    """
    chosen = explored.chosen(state)
    begun = (beginning(chosen),) if chosen else ()
    space = explored.space(state.length, (*state.where, *begun))
    found = space.sample(1, seed=seed, weights=None if weighted else {}, by=state.by)[0]
    options = ("--count", "1", "--seed", str(seed), *level_options(state), *(() if weighted else ("--uniform",)))
    weights = "" if weighted else ", weights={}"
    same = SameResult(
        "this sample",
        shell_line(explored, "sample", replace(state, where=(*state.where, *begun)), *options),
        f"{python_space(explored, state, *begun)}space.sample(1, seed={seed}{weights}{level_argument(state)})",
    )
    to = replace(state, chosen=tuple(map(str, found.actions)))
    return Jump(replace(to, chosen=explored.chosen(to)).query, same)
