"""``prag-asp explore``: a local page that browses a task space."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from prag_asp.atom import split_actions
from prag_asp.cli import options
from prag_asp.cli.arguments import parse_constant_options
from prag_asp.cli.domain_options import SPACE, DomainOptions, domain_options
from prag_asp.cli.terminal import end_progress, progress, say, tell_line
from prag_asp.errors import QueryError
from prag_asp.safe_reading import STANDARD_INPUT

if TYPE_CHECKING:
    from prag_asp.explore.explored_domain import ExploredDomain
    from prag_asp.space.limits import Limits


@click.command()
@domain_options(*SPACE, options.trust)
@click.option(
    "--by", type=click.Choice(["task", "plan"]), default="task", show_default=True,
    help="Show interchangeable entities as one (task) or separately (plan).",
)  # fmt: skip
@options.prefix
@click.option(
    "--port", type=options.whole(0, 65535), default=0, metavar="PORT",
    help="Port of the page on this machine.  [default: a free one]",
)  # fmt: skip
@click.option("--open", "opens", is_flag=True, help="Also open the page in the browser.")
def explore(*, request: DomainOptions, by: Any, prefix: str | None, port: int, opens: bool) -> None:
    """Browse the tasks of length N in a local page.

    Prints the link of the page, which shows, for each possible next action, the exact number of tasks that remain. Only
    this machine can open it, and only with the link. Ctrl-C ends the command.
    """
    from prag_asp.cli import exit_control
    from prag_asp.explore.page_server import PageServer
    from prag_asp.explore.page_state import PageState, parse_query
    from prag_asp.explore.space_pages import PAGE, space_views
    from prag_asp.explore.turns import Turns
    from prag_asp.processes.progress_events import hear

    turns = Turns()
    limits = replace(exit_control.limits(cached=request.cached), since=None, seconds=None, stop=turns.stop)
    state = PageState(request.one_length, request.conditions(), tuple(split_actions(prefix or "")), (), by)
    parse_query(state.query)
    with progress():
        explored = replace(_explored(request, limits), progress=turns.tell)
        explored.chosen(state)  # a wrong condition or prefix is reported here; the page counts
    end_progress()
    hear(turns.tell)
    with PageServer(PAGE, space_views(explored), turns, port=port, report=tell_line) as server:
        link = f"{server.link}?{state.query}"
        say(link)
        tell_line("open this link in a browser on this machine; Ctrl-C ends")
        if opens:
            click.launch(link)
        server.serve_forever()


def _explored(request: DomainOptions, limits: Limits) -> ExploredDomain:
    from prag_asp.explore.explored_domain import ExploredDomain

    if STANDARD_INPUT in request.names:
        raise QueryError("a page shows commands that load the domain again; give a file instead of standard input")
    words, arguments = [*request.names], [repr(name) for name in request.names]
    constants = parse_constant_options(request.constants)
    for text in request.constants:
        words += ["--const", text]
    arguments += [f"constants={constants!r}"] if constants else []
    for rule in request.rules:
        words += ["--rule", rule]
    arguments += [f"rules={request.rules!r}"] if request.rules else []
    for option, value in (("settings", request.settings), ("encodings", request.encodings)):
        if value is not None:
            words += [f"--{option}", value]
            arguments.append(f"{option}={value!r}")
    for option in ("flat", "untimed", "trust"):
        if getattr(request, option):
            words.append(f"--{option}")
            arguments.append(f"{option}=True")
    if not request.learned:
        words.append("--no-learned")
        arguments.append("learned=False")
    domain = request.domain()
    return ExploredDomain(domain, tuple(words), f"load_domain({', '.join(arguments)})", request.engine, limits)
