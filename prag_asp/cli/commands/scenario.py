"""``prag-asp scenario``: the tasks identified by scenario ids, with witnesses from the initial states."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack
from typing import TYPE_CHECKING

import click

from prag_asp.cli import options, shell_completion
from prag_asp.cli.domain_options import OF_FILE, DomainOptions, domain_options
from prag_asp.cli.line_output import require_writable, writer
from prag_asp.cli.summary import described
from prag_asp.cli.task_options import FORMS, TaskFormat, format_options
from prag_asp.cli.terminal import progress
from prag_asp.errors import QueryError

if TYPE_CHECKING:
    from prag_asp.dataset.scenario import Scenario
    from prag_asp.dataset.scenarios import Scenarios
    from prag_asp.domain.load import Domain
    from prag_asp.physics import Validator

FORM = click.option(
    "--format", "form", type=click.Choice(["full", *FORMS]), default="full", show_default=True,
    help="Format: all states, or a format of sample. With jsonl, physics searches for the witness again.",
)  # fmt: skip


@click.command()
@click.argument("ids", metavar="[ID]...", nargs=-1)
@click.option(
    "--from", "file", metavar="FILE", shell_complete=shell_completion.files,
    help="Read ids from a file, one per line; - is standard input.",
)  # fmt: skip
@domain_options(*OF_FILE, options.trust)
@format_options(FORM)
@options.output
def scenario(
    *, request: DomainOptions, ids: tuple[str, ...], file: str | None, task_format: TaskFormat, output: str | None
) -> None:
    """Print the tasks with given scenario ids.

    An id contains the name of a domain and a digest of its content, the conditions, the length and the rank of a task,
    and the search for its initial state; the same id gives the same task and initial state on every machine. An id is
    refused if the domain has changed.
    """
    from prag_asp.dataset.scenario import Scenario
    from prag_asp.dataset.scenarios import read_scenarios

    task_format.check()
    require_writable(output)
    if not ids and file is None:
        raise QueryError("give ids, or --from FILE; prag-asp sample --format scenario prints some")
    given = [*map(Scenario.parse, ids), *(read_scenarios(file) if file is not None else ())]
    with progress(), ExitStack() as resources, writer(output) as out:
        for lines in _lines(given, request, task_format, resources):
            out.write(lines, flush=True)


def _lines(
    given: Iterable[Scenario], request: DomainOptions, task_format: TaskFormat, resources: ExitStack
) -> Iterator[str]:
    """Yield the text of each scenario in a format; `resources` closes the simulators of the domains."""
    from prag_asp.dataset.jsonl import Record
    from prag_asp.dataset.scenarios import Scenarios, searched

    known: dict[tuple[str, Mapping[str, str]], Scenarios] = {}
    validators: dict[str, Validator] = {}
    for each in given:
        key = each.domain, each.constants
        if key not in known:
            known[key] = Scenarios(request.of_scenario(each).domain())
        task, space = known[key].task(each), known[key].space(each.where, each.length)
        if task_format.form == "full":
            search = [] if each.start is None else [f"search {each.start}"]
            where = [f"where  {clause}" for clause in each.where]
            yield "\n".join([f"id     {each}", *where, *described(task, space), *search])
        else:
            record = Record(task)
            if task_format.form == "jsonl" and each.start is not None:
                if each.digest not in validators:
                    validators[each.digest] = _open(known[key].domain, resources)
                record = searched(task, each.start, validators[each.digest])
            yield task_format.line(space)(record)


def _open(domain: Domain, resources: ExitStack) -> Validator:
    """Open a validator for the scene of a domain."""
    from prag_asp.dataset.scenes import scene_of
    from prag_asp.physics import open_validator, require_physics

    require_physics()
    return resources.enter_context(open_validator(scene_of(domain)))
