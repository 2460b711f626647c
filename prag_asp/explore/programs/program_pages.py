"""The views on the page of a program by name, as functions of the fields of a request."""

from __future__ import annotations

from collections.abc import Mapping

from prag_asp.explore.page_server import View
from prag_asp.explore.programs.explored_program import ExploredProgram
from prag_asp.explore.programs.models_state import parse_models_query
from prag_asp.explore.programs.models_view import models_conflict_view, models_view

MODELS_PAGE = "models.html"
"""The file of the page, in the folder that holds all pages."""


def program_views(explored: ExploredProgram) -> Mapping[str, View]:
    """Return the views of a program; the field ``state`` of a request is the query string of the page's URL."""
    return {
        "models": lambda fields: models_view(explored, parse_models_query(fields.get("state", ""))),
        "conflict": lambda fields: models_conflict_view(explored, parse_models_query(fields.get("state", ""))),
    }
