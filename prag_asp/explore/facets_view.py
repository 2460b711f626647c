"""The facets: facts of the final state, the shares of tasks in which they hold, and what remains after a choice."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import clingo

from prag_asp.explore.explored_domain import ExploredDomain
from prag_asp.explore.page_state import PageState
from prag_asp.explore.plan_view import share
from prag_asp.explore.same_result import SameResult, level_argument, python_space
from prag_asp.integers import digits_of
from prag_asp.logic.symmetry.renaming import renamed
from prag_asp.logic.symmetry.symmetries import Symmetries


@dataclass(frozen=True)
class GoalFacet:
    """A fact of the final state, or the facts that renamings of interchangeable entities map to each other.

    `holding` is the number of tasks that are known to end with one of the facts, and `share` is their share of all
    tasks. The condition `choose` leaves `chosen` tasks, and `exclude` leaves `excluded`; in an open world, values may
    be unknown, so a task may satisfy both conditions. The numbers are empty strings if the facts are not counted.
    """

    facts: tuple[str, ...]
    holding: str
    share: str
    choose: str
    chosen: str
    exclude: str
    excluded: str


@dataclass(frozen=True)
class FacetsView:
    """The facets of the tasks that begin with the chosen actions, and the number of these tasks."""

    count: str
    facets: tuple[GoalFacet, ...]
    same: tuple[SameResult, ...]


def facets_view(explored: ExploredDomain, state: PageState) -> FacetsView:
    """Return the facets of the tasks that begin with the chosen actions of a page.

    Raises:
        PragError: the state does not fit the domain, a limit was reached, or there are too many states.
    """
    space, chosen = explored.space_of(state), explored.chosen(state)
    count = space.engines.engine(state.by, state.length).count(state.length, chosen)
    fluents = space.domain.facts.fluents
    orbits = fact_orbits(fluents, space.symmetries if state.by == "task" else Symmetries())
    endings = space.ending(orbits, chosen, state.by)
    facets = []
    for facts, ending in zip(orbits, endings, strict=True):
        choose, exclude = f"ends {' or '.join(facts)}", f"ends {', '.join(f'not {fact}' for fact in facts)}"
        if ending is None:
            facets.append(GoalFacet(facts, "", "", choose, "", exclude, ""))
            continue
        facets.append(
            GoalFacet(
                facts,
                digits_of(ending.holding),
                share(ending.holding, count),
                choose,
                digits_of(ending.possible),
                exclude,
                digits_of(count - ending.holding),
            )
        )
    python = f"{python_space(explored, state)}space.ending([['FACT']], {list(chosen)}{level_argument(state)})"
    return FacetsView(digits_of(count), tuple(facets), (SameResult("the facts of final states", "", python),))


def fact_orbits(fluents: Sequence[clingo.Symbol], symmetries: Symmetries) -> list[tuple[str, ...]]:
    """Return the groups of facts that renamings of interchangeable entities map to each other."""
    swaps: list[Mapping[clingo.Symbol, clingo.Symbol]] = []
    for alike in (*symmetries.joint, *(tuple((entity,) for entity in group) for group in symmetries.groups)):
        for one, other in pairwise(alike):
            swaps.append({**dict(zip(one, other, strict=True)), **dict(zip(other, one, strict=True))})
    known, orbit_of = set(fluents), {fluent: [fluent] for fluent in fluents}
    for fluent in fluents:
        for swap in swaps:
            image = renamed(fluent, swap)
            if image in known and orbit_of[image] is not orbit_of[fluent]:
                joined = orbit_of[fluent] + orbit_of[image]
                orbit_of |= dict.fromkeys(joined, joined)
    places = {fluent: place for place, fluent in enumerate(fluents)}
    orbits = {id(orbit): sorted(orbit, key=places.__getitem__) for orbit in orbit_of.values()}
    return [tuple(map(str, orbit)) for orbit in orbits.values()]
