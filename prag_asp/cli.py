"""The command ``prag-asp``: parse, call, print. Results go to stdout, everything else to stderr."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from itertools import islice
from typing import TYPE_CHECKING, Any, TextIO, TypeVar

import click

from prag_asp.errors import OutputError, PragError, QueryError

if TYPE_CHECKING:
    from prag_asp.dataset.jsonl import Record
    from prag_asp.domain.load import Domain
    from prag_asp.domain.scene import Scene
    from prag_asp.physics import Verdict
    from prag_asp.space.task import Task
    from prag_asp.space.task_space import TaskSpace

F = TypeVar("F", bound=Callable[..., Any])
INTERRUPTED, BAD_INPUT, FAILED = 130, 2, 1


class _Command(click.Group):
    """Turns the library's errors into one line on stderr, and an interruption into a quiet end."""

    def main(self, *args: Any, **kwargs: Any) -> Any:  # the signature is click's
        if hasattr(sys, "set_int_max_str_digits"):
            sys.set_int_max_str_digits(0)
        try:
            return super().main(*args, **{**kwargs, "standalone_mode": False}) or 0
        except click.exceptions.Exit as stop:
            return stop.exit_code
        except click.ClickException as error:
            error.show()
            return error.exit_code
        except (click.Abort, KeyboardInterrupt):
            click.echo("interrupted", err=True)
            return INTERRUPTED
        except BrokenPipeError:
            sys.stdout = None  # type: ignore[assignment]  # nothing more can be flushed into it
            return FAILED
        except OutputError as error:
            click.echo(str(error), err=True)
            return FAILED
        except PragError as error:
            click.echo(str(error), err=True)
            return BAD_INPUT
        except OSError as error:
            click.echo(f"{error.filename or 'output'}: {error.strerror}", err=True)
            return FAILED


@click.group(cls=_Command, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110})
@click.version_option(package_name="prag_asp")
def cli() -> None:
    """Robot manipulation tasks from logic programs: counted exactly, drawn exactly, checked by physics.

    DOMAIN is a shipped domain (see `prag-asp domains`) or a folder with a domain.lp.
    """


def main() -> None:
    """Run the command and exit."""
    sys.exit(cli.main())


def _domain_options(command: F) -> F:
    """Add the argument DOMAIN and what chooses its rules and encodings."""
    for decorate in (
        click.option("--encodings", metavar="DIR", help="Folder of encodings to use in place of the shipped ones."),
        click.option("--rule", "rules", metavar="RULE", multiple=True, help="Rule to add, such as no_undo or 'at_most(grasp,2)'."),
        click.argument("name", metavar="DOMAIN"),
    ):
        command = decorate(command)
    return command


def _space_options(command: F) -> F:
    """Add the options that say which task space is meant."""
    for decorate in (
        click.option("--engine", default="auto", show_default=True, metavar="ENGINE", help="auto, automaton or clingo."),
        click.option("-n", "--length", type=int, required=True, metavar="N", help="Number of actions of a task."),
    ):
        command = decorate(command)
    return _domain_options(command)


_by = click.option(
    "--by", type=click.Choice(["plan", "task", "skeleton"]), default="task", show_default=True,
    help="Plans; tasks, which are plans up to renaming of interchangeable entities; or sequences of action names.",
)  # fmt: skip
_prefix = click.option("--prefix", metavar="A,B,...", help="Begin with these actions, or names of actions.")
_output = click.option("-o", "--output", metavar="FILE", help="Write to FILE in place of stdout.")
_format = click.option("--format", "form", type=click.Choice(["text", "jsonl"]), default="text", show_default=True)


@cli.command()
def domains() -> None:
    """List the shipped domains."""
    from prag_asp.domain.paths import shipped_domains
    from prag_asp.domain.settings import read_table

    folders = shipped_domains()
    width = max(map(len, folders), default=0)
    for name, folder in folders.items():
        click.echo(f"{name:<{width}}  {read_table(folder / 'domain.toml').get('description', '')}")


@cli.command()
@_domain_options
def check(name: str, rules: tuple[str, ...], encodings: str | None) -> None:
    """Check a domain and say what it declares."""
    domain = _load(name, rules, encodings)
    facts = domain.facts
    world = "closed" if facts.closed else "open"
    scene = "with a scene" if domain.settings.scene else "no scene"
    click.echo(
        f"{domain.name}: ok; {world} world, {len(facts.entities)} entities, {len(facts.fluents)} fluents, "
        f"{len(facts.actions)} actions, {scene}"
    )


@cli.command()
@click.argument("name", metavar="NAME")
def new(name: str) -> None:
    """Write a small commented domain into the new folder NAME, to start from."""
    from pathlib import Path

    from prag_asp.domain.scaffold import write_new_domain

    folder = write_new_domain(name, Path())
    click.echo(f"wrote {folder}; try: prag-asp check {folder}", err=True)


@cli.command()
@_space_options
@_by
@_prefix
@click.option("--upto", is_flag=True, help="Print a table for the lengths 1 to N.")
def count(
    name: str, rules: tuple[str, ...], encodings: str | None, length: int, engine: str, by: Any,
    prefix: str | None, upto: bool,
) -> None:  # fmt: skip
    """Print the exact number of tasks of length N."""
    with _progress() as tell:
        space = _space(name, rules, encodings, length, engine, tell)
        if not upto:
            click.echo(space.count(by, _split(prefix)))
            return
        width = max(len(str(length)), len("length"))
        click.echo(f"{'length':>{width}}  {by}s")
        for each in range(1, length + 1):
            click.echo(f"{each:>{width}}  {space.at(each).count(by, _split(prefix))}")


@cli.command()
@_space_options
@_by
@_prefix
@click.option("--limit", type=click.IntRange(min=0), metavar="K", help="Stop after K lines.")
@_format
@_output
def enumerate(
    name: str, rules: tuple[str, ...], encodings: str | None, length: int, engine: str, by: Any,
    prefix: str | None, limit: int | None, form: str, output: str | None,
) -> None:  # fmt: skip
    """Print all tasks of length N, each once, in rank order."""
    if form == "jsonl" and by == "skeleton":
        raise QueryError("skeletons have no JSON form; choose --format text, or --by task")
    with _progress() as tell, _writer(output) as write:
        space = _space(name, rules, encodings, length, engine, tell)
        words = islice(space.words(by, _split(prefix)), limit)
        if form == "text":
            for word in words:
                write(" ".join(word))
        else:
            from prag_asp.dataset.jsonl import Record, write_line

            for task in space.narrate(words):
                write(write_line(Record(task)))


@cli.command()
@_space_options
@click.option("--count", "wanted", type=click.IntRange(min=0), default=10, show_default=True, help="How many tasks.")
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Same seed, same bytes.")
@click.option("--weight", "weights", metavar="KEY=W", multiple=True, help="Such as grasp=2, 'grasp>move=0.5', apple=1/3.")
@click.option("--uniform", is_flag=True, help="Leave out the weights of domain.toml.")
@click.option("--by", type=click.Choice(["plan", "task"]), default="task", show_default=True)
@click.option("--physics/--no-physics", default=None, help="Keep feasible tasks only.  [default: where there is a scene]")
@click.option("--workers", type=click.IntRange(min=1), default=1, show_default=True, help="Processes for physics.")
@click.option("--max-draws", type=click.IntRange(min=1), metavar="K", help="Give up after K draws.  [default: 1000 a task]")
@_format
@_output
def sample(
    name: str, rules: tuple[str, ...], encodings: str | None, length: int, engine: str, wanted: int, seed: int,
    weights: tuple[str, ...], uniform: bool, by: Any, physics: bool | None, workers: int, max_draws: int | None,
    form: str, output: str | None,
) -> None:  # fmt: skip
    """Draw tasks of length N, each with a probability proportional to its weight, exactly."""
    from prag_asp.dataset.jsonl import Record, write_line

    def line(record: Record) -> str:
        return write_line(record) if form == "jsonl" else str(record.task)

    with _progress() as tell, _writer(output) as write:
        space = _space(name, rules, encodings, length, engine, tell)
        given = {} if uniform else dict(space.domain.settings.weights)
        drawn = space.draw(seed=seed, weights={**given, **_weights(weights)}, by=by) if wanted else iter(())
        if physics is False or (physics is None and not space.domain.settings.scene):
            for task in islice(drawn, wanted):
                write(line(Record(task)))
            return
        scene = _scene(space.domain)
        tally = _Tally(wanted)
        limit = max_draws or 1000 * max(wanted, 1)
        try:
            for record in islice(_validated(islice(drawn, limit), scene, seed, workers, tally), wanted):
                write(line(record))
                tell(tally.line())
        finally:
            click.echo(tally.line(), err=True)
    if tally.passed < wanted:
        raise OutputError(f"only {tally.passed} of {wanted} tasks were found in {limit} draws; raise --max-draws")


@cli.command()
@click.argument("file", metavar="TASKS.jsonl")
@click.option("--domain", "folder", metavar="DOMAIN", help="Domain of the tasks.  [default: the one that they name]")
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True)
@click.option("--workers", type=click.IntRange(min=1), default=1, show_default=True, help="Processes for physics.")
@click.option("--witness-only", is_flag=True, help="Check the witnesses in the file, and look for no new ones.")
def validate(file: str, folder: str | None, seed: int, workers: int, witness_only: bool) -> None:
    """Check tasks of a file again: that their plans are valid, and that a robot can do them.

    Prints a line for each task: its number, its verdict and the reason.
    """
    from prag_asp.dataset.jsonl import read_lines

    with click.open_file(file, encoding="utf-8") as lines:
        records = list(read_lines(lines, file))
    if not records:
        raise QueryError(f"{file}: no tasks in it; write some with prag-asp sample --format jsonl -o {file}")
    failed = 0
    with _progress() as tell:
        for number, status, reason in _checked(records, folder, seed, workers, witness_only):
            failed += status != "feasible"
            click.echo(f"{number}\t{status}\t{reason}")
            tell(f"{number} of {len(records)} tasks")
    click.echo(f"{len(records) - failed} of {len(records)} tasks passed", err=True)
    if failed:
        raise click.exceptions.Exit(FAILED)


def _checked(
    records: Sequence[Record], folder: str | None, seed: int, workers: int, witness_only: bool
) -> Iterator[tuple[int, str, str]]:
    """Yield the number, the verdict and its reason for each record."""
    from prag_asp.physics import Witness, check_witness, validate_tasks
    from prag_asp.space.task_space import TaskSpace

    by_domain = {name: _load(folder or name, (), None) for name in {record.task.domain for record in records}}
    spaces = {name: TaskSpace(domain, 0) for name, domain in by_domain.items()}
    scenes = {name: _scene(domain) for name, domain in by_domain.items()}
    for number, record in zip(range(1, len(records) + 1), records, strict=True):
        task = record.task
        if task not in spaces[task.domain].at(len(task)):
            yield number, "invalid", "the plan does not belong to the domain"
        elif not witness_only:
            verdict = next(validate_tasks([task], scenes[task.domain], seed=seed, workers=1))
            yield number, verdict.status, verdict.reason
        elif record.witness is None:
            yield number, "not_found", "the file has no witness for it"
        else:
            problems = check_witness(task, Witness.from_json(record.witness), scenes[task.domain])
            yield number, "witness_fails" if problems else "feasible", problems[0] if problems else ""


class _Tally:
    """How many tasks were drawn, how many passed, and why the rest failed."""

    def __init__(self, wanted: int) -> None:
        self.wanted, self.drawn, self.passed = wanted, 0, 0
        self.budget = ""
        self.reasons: Counter[str] = Counter()

    def add(self, verdict: Verdict) -> None:
        self.drawn += 1
        self.passed += verdict.feasible
        self.budget = str(verdict.budget)
        if not verdict.feasible:
            kind = "proved infeasible" if verdict.status == "infeasible" else "not found"
            self.reasons[f"{kind}: {verdict.reason}"] += 1

    def line(self) -> str:
        share = f" ({100 * self.passed / self.drawn:.1f} %, budget {self.budget})" if self.drawn else ""
        why = "".join(f"\n  {number} {reason}" for reason, number in self.reasons.most_common())
        return f"{self.drawn} drawn, {self.passed} passed{share}{why}"


def _validated(
    tasks: Iterator[Task], scene: Scene, seed: int, workers: int, tally: _Tally
) -> Iterator[Record]:
    """Yield the feasible tasks with verdict and witness; count all of them."""
    from itertools import tee

    from prag_asp.dataset.jsonl import Record
    from prag_asp.physics import validate_tasks

    asked, kept = tee(tasks)
    for task, verdict in zip(kept, validate_tasks(asked, scene, seed=seed, workers=workers), strict=False):
        tally.add(verdict)
        if verdict.feasible:
            told = verdict.to_json()
            witness = told.pop("witness")
            yield Record(task, told, witness)


def _load(name: str, rules: tuple[str, ...], encodings: str | None) -> Domain:
    from prag_asp.domain.load import load_domain

    return load_domain(name, rules=rules, encodings=encodings)


def _space(
    name: str, rules: tuple[str, ...], encodings: str | None, length: int, engine: str, tell: Callable[[str], None]
) -> TaskSpace:
    from prag_asp.space.task_space import TaskSpace

    return TaskSpace(_load(name, rules, encodings), length, engine=engine, progress=tell)


def _scene(domain: Domain) -> Scene:
    from prag_asp.domain.scene import parse_scene

    if not domain.settings.scene:
        raise QueryError(f"{domain.name} has no [scene] in its domain.toml; add one, or draw with --no-physics")
    entities = {str(entity): name for entity, name in domain.facts.entities.items()}
    return parse_scene(domain.settings.scene, domain.facts.parents, entities)


def _split(prefix: str | None) -> list[str]:
    from prag_asp.domain.atom import split_terms

    return split_terms(prefix) if prefix else []


def _weights(options: Sequence[str]) -> dict[str, str]:
    found = {}
    for option in options:
        key, equals, weight = option.rpartition("=")
        if not equals or not key:
            raise QueryError(f"--weight {option}: write KEY=WEIGHT, such as grasp=2 or 'grasp>move=0.5'")
        found[key.strip()] = weight.strip()
    return found


@contextmanager
def _writer(output: str | None) -> Iterator[Callable[[str], None]]:
    """Yield a function that writes a line; what was written stays, whatever happens later."""
    try:
        stream: TextIO = open(output, "w", encoding="utf-8") if output else sys.stdout  # noqa: PTH123, SIM115
    except OSError as error:
        raise OutputError(f"{output}: cannot be written: {error.strerror}; choose another file") from None

    def write(line: str) -> None:
        try:
            stream.write(f"{line}\n")
        except BrokenPipeError:
            raise
        except OSError as error:
            raise OutputError(f"{output or 'stdout'}: cannot be written: {error.strerror}") from None

    try:
        yield write
    finally:
        try:
            stream.flush()
            if output:
                stream.close()
        except BrokenPipeError:
            raise
        except OSError as error:
            raise OutputError(f"{output or 'stdout'}: cannot be written: {error.strerror}") from None


@contextmanager
def _progress() -> Iterator[Callable[[str], None]]:
    """Yield a function that is told how far things are; a terminal sees it once 2 s have passed."""
    if not sys.stderr.isatty():
        yield lambda words: None
        return
    from time import monotonic

    from rich.console import Console
    from rich.status import Status

    status = Status("", console=Console(stderr=True))
    begun = monotonic()
    started = False

    def tell(words: str) -> None:
        nonlocal started
        if not started and monotonic() - begun > 2:  # noqa: PLR2004
            status.start()
            started = True
        if started:
            status.update(words.splitlines()[0])

    try:
        yield tell
    finally:
        status.stop()
