"""The views of the pages of a task space by name, as functions of the fields of a request."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from prag_asp.errors import QueryError
from prag_asp.explore.comparison_view import comparison_view
from prag_asp.explore.empty_view import empty_view
from prag_asp.explore.explored_domain import ExploredDomain
from prag_asp.explore.facets_view import facets_view
from prag_asp.explore.jumps import Jump, to_rank, to_sample
from prag_asp.explore.page_server import Fields, View
from prag_asp.explore.page_state import PageState, parse_query
from prag_asp.explore.plan_view import count_view, plan_view
from prag_asp.explore.vocabulary_view import vocabulary_view

PAGE = Path(__file__).parent / "page"
"""The folder of the files of the pages."""

LARGEST_SEED = 2**63 - 1


def space_views(explored: ExploredDomain) -> Mapping[str, View]:
    """Return the views of a domain; the field ``state`` of a request is the query of the page's link."""

    def of_state(view: Callable[[ExploredDomain, PageState], Any]) -> View:
        return lambda fields: view(explored, parse_query(fields.get("state", "")))

    def rank(fields: Fields) -> Jump:
        return to_rank(explored, parse_query(fields.get("state", "")), fields.get("rank", ""))

    def sample(fields: Fields) -> Jump:
        state, text = parse_query(fields.get("state", "")), fields.get("seed", "0").strip()
        if not (text.isascii() and text.isdigit() and len(text) < 20 and int(text) <= LARGEST_SEED):
            raise QueryError(f"seed {text[:30]!r}: write a whole number from 0 to {LARGEST_SEED}")
        return to_sample(explored, state, int(text), weighted=fields.get("weighted") == "1")

    return {
        "vocabulary": lambda fields: vocabulary_view(explored),
        "plan": of_state(plan_view),
        "count": of_state(count_view),
        "facets": of_state(facets_view),
        "compare": of_state(comparison_view),
        "why": of_state(empty_view),
        "rank": rank,
        "sample": sample,
    }
