"""``prag-asp validate``: tasks of a file checked again."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

import click

from prag_asp.cli import complete, options
from prag_asp.cli.asked import Asked
from prag_asp.cli.bundles.films import Filming, films
from prag_asp.cli.exits import Exit
from prag_asp.cli.options import Checking, asks
from prag_asp.cli.runs import domains_of, run_on_file
from prag_asp.cli.terminal import progress
from prag_asp.cli.writing import require_writable, writer
from prag_asp.errors import QueryError
from prag_asp.reading import lines_of, open_text

if TYPE_CHECKING:
    from prag_asp.scene.model import Scene


@click.command()
@click.argument("file", metavar="TASKS.jsonl", shell_complete=complete.files)
@asks((*options.OF_FILE, options.WHERE, options.TRUST))
@options.seed
@options.checks
@films
@click.option("--witness-only", is_flag=True, help="Check the witnesses in the file, and look for no new ones.")
@options.output
def validate(
    *,
    asked: Asked,
    file: str,
    seed: int,
    checking: Checking,
    filming: Filming,
    witness_only: bool,
    output: str | None,
) -> None:
    """Check tasks of a file again: that their plans are valid, and that a robot can do them.

    Prints a line for each task: its number, its verdict and the reason. Give the options of --rule, --encodings, --flat
    and --where that the tasks were made with. FILE is replaced as a whole at the end; a run that was broken off goes on
    where it was when it is started again.
    """
    from prag_asp.physics import require_physics

    require_writable(output)
    checking.tries()
    filming.refuse_at_odds(checking.demonstrate)
    if witness_only and checking.budget != options.BUDGET:
        raise QueryError(
            f"--budget {checking.budget} is for a search; --witness-only makes none, so leave one of them out"
        )
    require_physics()
    with open_text(file) as stream, progress() as tell:
        total = _tasks_in(stream)
        if total == 0:
            raise QueryError(f"{file}:1: no tasks in it; write some with prag-asp sample --format jsonl -o {file}")
        from prag_asp.cli.tally import tallied, tally_line
        from prag_asp.dataset import Tally, read_lines, recheck
        from prag_asp.dataset.recordings import claim, recorded

        budget = checking.limits()
        limits = f"witnesses only, {budget.tier}" if witness_only else f"budget {budget}"
        tally = Tally()

        def fits(_: int, state: Any) -> bool:
            tally.go_on(state)
            return checking.demonstrate is None or recorded(checking.demonstrate, tally.seen) == tally.passed

        def told() -> str:
            return tally_line(tally, ("task", "tasks"), limits)

        run = run_on_file(asked, file) if output or checking.demonstrate else None
        staging = filming.staging(*_scenes(asked, file) if filming.asked else ())
        if checking.demonstrate is not None:
            claim(checking.demonstrate, run)
        with tallied(tally, told), writer(output, run, fits) as out:
            tally.go_on(out.state)
            outcomes = recheck(
                read_lines(lines_of(stream), file), where=asked.conditions(), seed=seed, witness_only=witness_only,
                load=lambda record, folder: asked.of(record, folder).domain(), folder=Path(file).parent,
                done=tally.seen, staging=staging, **checking.arguments(),
            )  # fmt: skip
            with closing(outcomes):
                for outcome in outcomes:
                    tally.count(outcome.status, outcome.reason, outcome.causes)
                    line = f"{tally.seen}\t{outcome.status}\t{outcome.reason}\t{outcome.detail}".rstrip()
                    out.write(line, tally.state())
                    tell(told(), tally.seen, total)
    if tally.passed < tally.seen:
        raise click.exceptions.Exit(Exit.NOT_FOUND)


def _scenes(asked: Asked, file: str) -> list[Scene]:
    """Return the scenes of the domains that the tasks of a file are of, none where that can be read only once.

    Raises:
        PragError: a domain cannot be loaded, or has no scene.
    """
    from prag_asp.dataset.scenes import scene_of

    return [scene_of(domain) for domain in domains_of(asked, file)[0]] if Path(file).is_file() else []


def _tasks_in(stream: TextIO) -> int | None:
    """Return how many lines of a file hold something, None where it can be read only once."""
    if not stream.seekable():
        return None
    number = sum(1 for line in lines_of(stream) if line.strip())
    stream.seek(0)
    return number
