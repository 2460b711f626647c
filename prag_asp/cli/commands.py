"""The commands of ``prag-asp``: parse, call, print."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import closing
from itertools import islice
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import click

from prag_asp.cli import options
from prag_asp.cli.learn import learn, require_proofs
from prag_asp.cli.options import Asked, Checking, Weighing, asks
from prag_asp.cli.render import render
from prag_asp.cli.split import split
from prag_asp.cli.statistics import stats
from prag_asp.cli.task import task
from prag_asp.cli.terminal import (
    FAILED,
    LIMITED,
    Command,
    progress,
    require_unrecorded,
    require_writable,
    whole_lines,
    writer,
)
from prag_asp.errors import LimitReached, QueryError
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain
    from prag_asp.program.problem import Problem

DRAWS_FOR_EACH = 1000
"""Draws after which `sample` gives up, for each task wanted."""


@click.group(cls=Command, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110})
@click.version_option(package_name="prag_asp")
def cli() -> None:
    """Robot manipulation tasks from logic programs: counted exactly, drawn exactly, checked by physics.

    DOMAIN is a shipped domain (see `prag-asp domains`) or a folder with a domain.lp.
    """


@cli.command()
def domains() -> None:
    """List the shipped domains."""
    from prag_asp.program.paths import shipped_domains
    from prag_asp.program.settings import read_table

    folders = shipped_domains()
    width = max(map(len, folders), default=0)
    for name, folder in folders.items():
        click.echo(f"{name:<{width}}  {read_table(folder / 'domain.toml').get('description', '')}")


@cli.command()
@asks((*options.DOMAIN, options.TRUST))
def check(*, asked: Asked) -> None:
    """Check a domain and say what it declares, and on stderr what is strange about it.

    Errors mean that the domain means nothing, or that a count could be wrong. Warnings are well defined; the comment
    `% lint: allow NAME` on its line quiets one.
    """
    from prag_asp.program.problem import first_of_each, raise_problems

    domain = asked.domain(tell=False)
    if "own" in domain.settings.scene:
        options.scene_of(domain)
    require_proofs(domain)
    warnings = [*domain.warnings, *_too_wide(domain)]
    if asked.strict:
        raise_problems(each.as_error() for each in first_of_each(warnings))
    for warning in first_of_each(warnings):
        click.echo(str(warning), err=True)
    facts = domain.facts
    left = f"{len(facts.actions)} of " if len(facts.actions) < len(facts.declared_actions) else ""
    world = "closed" if facts.closed else "open"
    scene = "with a scene" if domain.settings.scene else "no scene"
    parts = [
        f"{world} world",
        plural(len(facts.entities), "entity", "entities"),
        plural(len(facts.fluents), "fluent"),
        f"{left}{plural(len(facts.declared_actions), 'action')}",
        *([plural(len(facts.composites), "composite")] if facts.composites else []),
        *([plural(len(domain.learned), "learned invariant")] if domain.learned else []),
        scene,
    ]
    click.echo(f"{domain.name}: ok; {', '.join(parts)}")


def _too_wide(domain: Domain) -> Iterable[Problem]:
    """Return warnings of the bodies of a domain that no proof holds too wide, and that are yet never grasped."""
    if not domain.settings.scene:
        return ()
    from prag_asp.physics.proofs.grips import never_gripped

    return never_gripped(domain, options.scene_of(domain))


@cli.command()
@click.argument("name", metavar="NAME")
def new(name: str) -> None:
    """Write a small commented domain into the new folder NAME, to start from."""
    from pathlib import Path

    from prag_asp.domain.scaffold import write_new_domain

    folder = write_new_domain(name, Path())
    click.echo(f"wrote {folder}; try: prag-asp check {folder}", err=True)


@cli.command()
@asks(options.SPACE)
@options.by_level
@options.prefix
@click.option("--upto", is_flag=True, help="Print a table for the lengths 1 to N.")
def count(*, asked: Asked, by: Any, prefix: str | None, upto: bool) -> None:
    """Print the exact number of tasks of length N.

    Where --memory or --time ends the count, prints "at least K" for the K that were found, and exits with code 3.
    """
    first = _split(prefix)
    width = max(len(str(asked.length)), len("length")) if upto else 0
    label = ""
    try:
        with progress() as tell:
            space = asked.space(tell)
            if upto:
                click.echo(f"{'length':>{width}}  {by}s")
            for length in range(1, asked.length + 1) if upto else (asked.length,):
                label = f"{length:>{width}}  " if upto else ""
                click.echo(f"{label}{space.at(length).count(by, first)}")
    except LimitReached as limit:
        click.echo(f"{label}at least {limit.at_least}")
        click.echo(str(limit), err=True)
        raise click.exceptions.Exit(LIMITED) from None


@cli.command()
@asks(options.SPACE)
@options.by_level
@options.prefix
@click.option("--limit", type=click.IntRange(min=0), metavar="K", help="Stop after K lines.")
@options.form
@options.output
def enumerate(*, asked: Asked, by: Any, prefix: str | None, limit: int | None, form: str, output: str | None) -> None:
    """Print all tasks of length N, each once, in rank order."""
    if form != "text" and by == "skeleton":
        raise QueryError(f"skeletons have no form {form}; choose --format text, or --by task")
    from prag_asp.dataset.jsonl import Record

    first = _split(prefix)
    require_writable(output)
    with progress() as tell:
        space = asked.space(tell)
        words = islice(space.words(by, first), limit)
        with writer(output) as write:
            if form == "text":
                for word in words:
                    write(" ".join(word))
            else:
                line = options.line_form(form, space.domain)
                for task in space.narrate(words):
                    write(line(Record(task)))


@cli.command()
@asks((*options.SPACE, options.TRUST))
@click.option("--count", "wanted", type=click.IntRange(min=0), default=10, show_default=True, help="How many tasks.")
@options.seed
@options.weighs
@click.option(
    "--over",
    type=click.Choice(["skeletons", "goals"]),
    help="Draw a skeleton (or a goal) uniformly first, then a task that has it.",
)
@click.option("--by", type=click.Choice(["plan", "task"]), default="task", show_default=True, help="What is drawn.")
@click.option("--physics/--no-physics", default=None, help="Keep feasible tasks only.  [default: if there is a scene]")
@options.checks
@click.option("--max-draws", type=click.IntRange(min=1), metavar="K", help="Give up after K draws.  [1000 a task]")
@options.form
@options.output
def sample(
    *,
    asked: Asked,
    wanted: int,
    seed: int,
    weighing: Weighing,
    over: Any,
    by: Any,
    physics: bool | None,
    checking: Checking,
    max_draws: int | None,
    form: str,
    output: str | None,
) -> None:
    """Draw tasks of length N, each with a probability proportional to its weight, exactly."""
    from prag_asp.dataset.jsonl import Record

    require_writable(output)
    require_unrecorded(checking.demonstrate)
    checking.tries()
    with progress() as tell:
        space = asked.space(tell)
        line = options.line_form(form, space.domain)
        drawn = space.draw(seed=seed, by=by, over=over, **weighing.arguments(space.domain)) if wanted else iter(())
        if physics is None:
            physics = bool(space.domain.settings.scene)
        if not physics:
            checking.refuse_without_physics({"--max-draws": max_draws is not None})
            with writer(output) as write:
                for task in islice(drawn, wanted):
                    write(line(Record(task)))
            return
        from prag_asp.dataset.feasible import first_feasible

        scene, limit = options.scene_of(space.domain), max_draws or DRAWS_FOR_EACH * wanted
        records = first_feasible(drawn, wanted, scene, seed, checking, limit, tell)
        with writer(output) as write, closing(records):
            for record in records:
                write(line(record))


@cli.command()
@click.argument("file", metavar="TASKS.jsonl")
@asks(
    (
        click.option("--domain", "name", metavar="DOMAIN", default="", help="Their domain.  [default: what they name]"),
        *options.PROGRAM,
        options.WHERE,
        options.TRUST,
    )
)
@options.seed
@options.checks
@click.option("--witness-only", is_flag=True, help="Check the witnesses in the file, and look for no new ones.")
def validate(*, asked: Asked, file: str, seed: int, checking: Checking, witness_only: bool) -> None:
    """Check tasks of a file again: that their plans are valid, and that a robot can do them.

    Prints a line for each task: its number, its verdict and the reason. Give the options of --rule, --encodings, --flat
    and --where that the tasks were made with.
    """
    from prag_asp.dataset.jsonl import read_lines

    require_unrecorded(checking.demonstrate)
    checking.tries()
    if witness_only and checking.budget != options.BUDGET:
        raise QueryError(
            f"--budget {checking.budget} is for a search; --witness-only makes none, so leave one of them out"
        )
    with click.open_file(file, encoding="utf-8", errors="replace") as lines, progress() as tell:
        total = _tasks_in(lines)
        if total == 0:
            raise QueryError(f"{file}: no tasks in it; write some with prag-asp sample --format jsonl -o {file}")
        from prag_asp.dataset.recheck import check_again
        from prag_asp.dataset.tally import Tally

        budget = checking.limits()
        tally = Tally(("task", "tasks"), f"witnesses only, {budget.tier}" if witness_only else f"budget {budget}")
        outcomes = check_again(
            read_lines(lines, file),
            asked,
            folder=Path(file).parent,
            seed=seed,
            checking=checking,
            witness_only=witness_only,
        )
        try:
            with whole_lines(), closing(outcomes):
                for status, reason, causes, _ in outcomes:
                    tally.count(status, reason, causes)
                    click.echo(f"{tally.seen}\t{status}\t{reason}".rstrip())
                    tell(str(tally), tally.seen, total)
        finally:
            if tally.seen:
                tally.show()
    if tally.passed < tally.seen:
        raise click.exceptions.Exit(FAILED)


cli.add_command(render)
cli.add_command(learn)
cli.add_command(task)
cli.add_command(split)
cli.add_command(stats)


def _tasks_in(lines: IO[str]) -> int | None:
    """Return how many lines of a file hold something, None where it can be read only once."""
    if not lines.seekable():
        return None
    number = sum(1 for line in lines if line.strip())
    lines.seek(0)
    return number


def _split(prefix: str | None) -> list[str]:
    from prag_asp.atom import split_terms

    return split_terms(prefix) if prefix else []
