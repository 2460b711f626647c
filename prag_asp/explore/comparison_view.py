"""Two conditions side by side, with the size of their overlap."""

from __future__ import annotations

from dataclasses import dataclass, replace

from prag_asp.errors import QueryError
from prag_asp.explore.explored_domain import ExploredDomain
from prag_asp.explore.page_state import PageState
from prag_asp.explore.plan_view import share
from prag_asp.explore.same_result import SameResult, level_argument, level_options, python_space, shell_line
from prag_asp.integers import digits_of
from prag_asp.space.engines.engine import Level


@dataclass(frozen=True)
class ComparedConditions:
    """The conditions on one side, the number of tasks that satisfy them, and the number that satisfy only them."""

    where: tuple[str, ...]
    count: str
    only: str
    share_of_overlap: str
    query: str
    same: SameResult


@dataclass(frozen=True)
class ComparisonView:
    """The numbers of tasks under each of two conditions, under both, and under either; `all` counts all tasks.

    If the conditions distinguish interchangeable entities, `level` is ``plan`` and plans are counted, because the tasks
    of the two sides would be counted up to different renamings.
    """

    level: str
    distinguishes: bool
    all: str
    first: ComparedConditions
    second: ComparedConditions
    both: str
    either: str
    same: SameResult


def comparison_view(explored: ExploredDomain, state: PageState) -> ComparisonView:
    """Return the comparison of the two conditions on a page, regardless of the chosen actions.

    Raises:
        PragError: there is no second condition, a condition does not fit the domain, or a limit was reached.
    """
    if not state.beside:
        raise QueryError("there is no second condition; add one to compare")
    together = tuple(dict.fromkeys((*state.where, *state.beside)))
    sides = [state.where, state.beside, together, ()]
    spaces = [explored.space(state.length, where) for where in sides]
    distinguishes = any(space.symmetries != spaces[-1].symmetries for space in spaces)
    by: Level = "plan" if distinguishes else state.by
    first, second, both, whole = (space.count(by) for space in spaces)
    at = replace(state, by=by, chosen=())

    def side(where: tuple[str, ...], number: int) -> ComparedConditions:
        own = replace(at, where=where, beside=())
        return ComparedConditions(
            where, digits_of(number), digits_of(number - both), share(both, number), own.query, _same(explored, own)
        )

    return ComparisonView(
        by,
        distinguishes,
        digits_of(whole),
        side(state.where, first),
        side(state.beside, second),
        digits_of(both),
        digits_of(first + second - both),
        _same(explored, replace(at, where=together)),
    )


def _same(explored: ExploredDomain, state: PageState) -> SameResult:
    python = f"{python_space(explored, state)}space.count({level_argument(state).removeprefix(', ')})"
    return SameResult("the number", shell_line(explored, "count", state, *level_options(state)), python)
