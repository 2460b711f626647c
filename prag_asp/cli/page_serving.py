"""Serve pages of ``prag-asp explore`` until Ctrl-C, and print their links."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from prag_asp.cli import exit_control
from prag_asp.cli.arguments import parse_constant_options
from prag_asp.cli.domain_options import DomainOptions
from prag_asp.cli.terminal import end_progress, progress, say, tell_line
from prag_asp.errors import QueryError
from prag_asp.safe_reading import STANDARD_INPUT

if TYPE_CHECKING:
    from prag_asp.explore.page_server import View
    from prag_asp.explore.turns import Turns

ENGINES = ("auto", "diagram", "clingo")
"""The engines that can compute facets."""


def serve_page(views: Mapping[str, View], turns: Turns, page: str, *, port: int, opens: bool) -> None:
    """Serve views, and print the link of `page` (file and query); with `opens`, open the page in the browser."""
    from prag_asp.explore.page_server import PageServer
    from prag_asp.explore.space_pages import PAGE
    from prag_asp.processes.progress_events import hear

    hear(turns.tell)
    with PageServer(PAGE, views, turns, port=port, report=tell_line) as server:
        link = f"{server.link}{page}"
        say(link)
        tell_line("open this link in a browser on this machine; Ctrl-C ends")
        if opens:
            click.launch(link)
        server.serve_forever()


def serve_models(request: DomainOptions, *, project: bool, optimal: bool, port: int, opens: bool) -> None:
    """Serve the page of a program until Ctrl-C.

    Raises:
        PragError: the program is wrong, or does not allow a choice or the engine.
    """
    from prag_asp.explore.programs.explored_program import ExploredProgram, Watch
    from prag_asp.explore.programs.models_state import ModelsState
    from prag_asp.explore.programs.program_pages import MODELS_PAGE, program_views
    from prag_asp.explore.turns import Turns
    from prag_asp.models.answer_sets import answer_sets

    if STANDARD_INPUT in request.names:
        raise QueryError("a page shows commands that read the program again; give a file instead of standard input")
    if request.engine not in ENGINES:
        raise QueryError(f"--engine {request.engine}: with --models, choose {', '.join(ENGINES)}")
    constants = parse_constant_options(request.constants)
    turns = Turns()
    watch = Watch(replace(exit_control.limits(), seconds=None, stop=turns.stop))
    with progress():
        answers = answer_sets(
            *request.names,
            constants=constants,
            project=project,
            optimal=optimal,
            engine=request.engine,
            tell=lambda line: tell_line(f"note: {line}"),
            progress=watch.look,
        )
        answers.where(*request.where)  # reports a wrong choice
    end_progress()
    for line in answers.ground.remarks:
        tell_line(line)
    words = (*request.names, *(word for text in request.constants for word in ("-c", text)))
    options = [name for name, given in (("--project", project), ("--optimal", optimal)) if given]
    arguments = [*map(repr, request.names), *([f"constants={constants!r}"] if constants else [])]
    arguments += [f"{name}=True" for name, given in (("project", project), ("optimal", optimal)) if given]
    if request.engine != "auto":
        options += ["--engine", request.engine]
        arguments.append(f"engine={request.engine!r}")
    title = " + ".join(Path(name).name for name in request.names)
    call = f"answer_sets({', '.join(arguments)})"
    explored = ExploredProgram(title, answers, words, tuple(options), call, watch)
    query = ModelsState(request.where).query
    serve_page(program_views(explored), turns, f"{MODELS_PAGE}{query and '?'}{query}", port=port, opens=opens)
