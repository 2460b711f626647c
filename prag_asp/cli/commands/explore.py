"""``prag-asp explore``: a local page that browses a task space."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from prag_asp.atom import split_actions
from prag_asp.cli import options
from prag_asp.cli.arguments import parse_constant_options, parse_length
from prag_asp.cli.domain_options import DOMAIN, ENGINE, DomainOptions, domain_options
from prag_asp.cli.page_serving import serve_models, serve_page
from prag_asp.cli.terminal import end_progress, progress
from prag_asp.errors import QueryError
from prag_asp.safe_reading import STANDARD_INPUT

if TYPE_CHECKING:
    from prag_asp.explore.explored_domain import ExploredDomain
    from prag_asp.space.limits import Limits

OF_TASKS = (
    "length", "by", "prefix", "settings", "rules", "encodings", "flat", "learned", "strict", "untimed", "cached",
    "trust",
)  # fmt: skip
"""The names of the options that apply only to tasks, not to answer sets (--models)."""

OF_MODELS = ("project", "optimal")
"""The names of the options that apply only with --models."""


@click.command()
@domain_options(
    *DOMAIN,
    click.option(
        "-n",
        "--length",
        type=parse_length,
        metavar="N",
        default="0",
        show_default=False,
        help="Number of actions of a task; required without --models.",
    ),
    *ENGINE,
    options.trust,
)
@click.option(
    "--by", type=click.Choice(["task", "plan"]), default="task", show_default=True,
    help="Show interchangeable entities as one (task) or separately (plan).",
)  # fmt: skip
@options.prefix
@click.option(
    "--models", is_flag=True,
    help="Show the answer sets of the clingo program in the files DOMAIN...; --where chooses and excludes atoms.",
)  # fmt: skip
@click.option("--project", is_flag=True, help="With --models: as for prag-asp models.")
@click.option("--optimal", is_flag=True, help="With --models: as for prag-asp models.")
@click.option(
    "--port", type=options.whole(0, 65535), default=0, metavar="PORT",
    help="Port of the page on this machine.  [default: a free one]",
)  # fmt: skip
@click.option("--open", "opens", is_flag=True, help="Also open the page in the browser.")
def explore(
    *,
    request: DomainOptions,
    by: Any,
    prefix: str | None,
    models: bool,
    project: bool,
    optimal: bool,
    port: int,
    opens: bool,
) -> None:
    """Browse the tasks of length N, or the answer sets of a program, in a local page.

    Prints the link of the page, which shows, for each possible next action, the exact number of tasks that remain. With
    --models, it shows, for each atom, the exact number of answer sets that contain it. Only this machine can open the
    page, and only with the link. Ctrl-C ends the command.
    """
    if models:
        _refuse(OF_TASKS, "it is about tasks; leave it out with --models")
        serve_models(request, project=project, optimal=optimal, port=port, opens=opens)
    else:
        _refuse(OF_MODELS, "it is about answer sets; add --models")
        _serve_tasks(request, by, prefix, port=port, opens=opens)


def _refuse(names: Sequence[str], reason: str) -> None:
    """Check that no option with one of these names is given.

    Raises:
        QueryError: such an option is given.
    """
    context = click.get_current_context()
    for parameter in context.command.params:
        if parameter.name in names and context.get_parameter_source(parameter.name) is ParameterSource.COMMANDLINE:
            raise QueryError(f"{parameter.opts[-1]}: {reason}")


def _serve_tasks(request: DomainOptions, by: Any, prefix: str | None, *, port: int, opens: bool) -> None:
    from prag_asp.cli import exit_control
    from prag_asp.explore.page_state import PageState, parse_query
    from prag_asp.explore.space_pages import space_views
    from prag_asp.explore.turns import Turns

    context = click.get_current_context()
    if context.get_parameter_source("length") is not ParameterSource.COMMANDLINE:
        (parameter,) = (each for each in context.command.params if each.name == "length")
        raise click.MissingParameter(param=parameter)
    turns = Turns()
    limits = replace(exit_control.limits(cached=request.cached), since=None, seconds=None, stop=turns.stop)
    state = PageState(request.one_length, request.conditions(), tuple(split_actions(prefix or "")), (), by)
    parse_query(state.query)
    with progress():
        explored = replace(_explored(request, limits), progress=turns.tell)
        explored.chosen(state)  # reports a wrong condition or prefix; the page counts later
    end_progress()
    serve_page(space_views(explored), turns, f"?{state.query}", port=port, opens=opens)


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
