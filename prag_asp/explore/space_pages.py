"""The views on the pages of a task space by name, as functions of the fields of a request."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from prag_asp.explore.comparison_view import comparison_view
from prag_asp.explore.empty_view import empty_view
from prag_asp.explore.explored_domain import ExploredDomain
from prag_asp.explore.facets_view import facets_view
from prag_asp.explore.jumps import Jump, to_rank, to_sample
from prag_asp.explore.page_server import Elsewhere, Fields, View
from prag_asp.explore.page_state import PageState, parse_query
from prag_asp.explore.physics_view import Call, TaskPhysics, calls_elsewhere
from prag_asp.explore.plan_view import count_view, plan_view
from prag_asp.explore.task_trial import Trial, read_seed, trial_of
from prag_asp.explore.vocabulary_view import vocabulary_view

PAGE = Path(__file__).parent / "page"
"""The folder that contains the files of the pages."""


@dataclass(frozen=True)
class Ended:
    """The answer to a page that no longer needs the results of its older requests."""

    ended: bool = True


def space_views(explored: ExploredDomain, call: Call | None = None) -> Mapping[str, View]:
    """Return the views of a domain; the field ``state`` of a request is the query of the page's link.

    `call` calls the functions of physics, by default in another process.
    """
    physics = TaskPhysics(explored, call or calls_elsewhere(explored))

    def of_trial(view: Callable[[Trial], Any]) -> View:
        def begin(fields: Fields) -> Elsewhere:
            trial = trial_of(explored, fields)
            return Elsewhere(lambda: view(trial))

        return begin

    def of_state(view: Callable[[ExploredDomain, PageState], Any]) -> View:
        return lambda fields: view(explored, parse_query(fields.get("state", "")))

    def rank(fields: Fields) -> Jump:
        return to_rank(explored, parse_query(fields.get("state", "")), fields.get("rank", ""))

    def sample(fields: Fields) -> Jump:
        state = parse_query(fields.get("state", ""))
        return to_sample(explored, state, read_seed(fields), weighted=fields.get("weighted") == "1")

    return {
        "vocabulary": lambda fields: vocabulary_view(explored),
        "plan": of_state(plan_view),
        "count": of_state(count_view),
        "facets": of_state(facets_view),
        "compare": of_state(comparison_view),
        "why": of_state(empty_view),
        "rank": rank,
        "sample": sample,
        "verdict": of_trial(physics.verdict),
        "strip": of_trial(physics.strip),
        "scene": of_trial(physics.scene_file),
        "film": of_trial(physics.animation),
        "end": lambda fields: Ended(),
    }
