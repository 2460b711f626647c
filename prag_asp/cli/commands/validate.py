"""``prag-asp validate``: tasks of a file, validated again."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

import click

from prag_asp.cli import options, shell_completion
from prag_asp.cli.domain_options import OF_FILE, WHERE, DomainOptions, domain_options
from prag_asp.cli.exits import Exit
from prag_asp.cli.line_output import require_writable, writer
from prag_asp.cli.physics_options import BUDGET, CameraOptions, PhysicsOptions, camera_options, physics_options
from prag_asp.cli.run_fingerprint import domains_of, run_on_file
from prag_asp.cli.terminal import Tell, progress
from prag_asp.errors import QueryError
from prag_asp.safe_reading import lines_of, open_text

if TYPE_CHECKING:
    from prag_asp.dataset import Tally
    from prag_asp.scene.scene import Scene


@click.command()
@click.argument("file", metavar="TASKS.jsonl", shell_complete=shell_completion.files)
@domain_options(*OF_FILE, WHERE, options.trust)
@options.seed
@physics_options
@camera_options
@click.option("--witness-only", is_flag=True, help="Check only the witnesses in the file; do not search for new ones.")
@options.output
def validate(
    *,
    request: DomainOptions,
    file: str,
    seed: int,
    validation: PhysicsOptions,
    filming: CameraOptions,
    witness_only: bool,
    output: str | None,
) -> None:
    """Validate the tasks of a file: plans and feasibility.

    Prints a line for each task: its number, its verdict and the reason. Give the same --rule, --encodings, --flat and
    --where as when the tasks were made.
    """
    from prag_asp.physics import require_physics

    require_writable(output)
    validation.parse_budget()
    filming.check(validation.demonstrate)
    if witness_only and validation.budget != BUDGET:
        raise QueryError(
            f"--budget {validation.budget} is for a search, but --witness-only searches nothing; leave one of them out"
        )
    require_physics()
    budget = validation.parse_budget()
    check = _Validation(request, file, seed, validation, filming, witness_only, output)
    with open_text(file) as stream, progress() as tell:
        tally = check.run(stream, f"witnesses only, {budget.tier}" if witness_only else f"budget {budget}", tell)
    if tally.passed < tally.seen:
        raise click.exceptions.Exit(Exit.NOT_FOUND)


@dataclass(frozen=True)
class _Validation:
    """The tasks to validate, and how."""

    request: DomainOptions
    file: str
    seed: int
    validation: PhysicsOptions
    filming: CameraOptions
    witness_only: bool
    output: str | None

    def run(self, stream: TextIO, limits: str, tell: Tell) -> Tally:
        """Validate the tasks of a file, write a line for each, and return the tally; `limits` is printed with it.

        Raises:
            PragError: there are none, or one cannot be read.
        """
        from prag_asp.cli.summary import tallied, tally_line
        from prag_asp.dataset import Tally, read_lines, recheck
        from prag_asp.dataset.episode_files import claim, recorded

        total, folder, tally = self._tasks_in(stream), self.validation.demonstrate, Tally()

        def fits(_: int, state: Any) -> bool:
            tally.go_on(state)
            return folder is None or recorded(folder, tally.seen) == tally.passed

        def summary() -> str:
            return tally_line(tally, ("task", "tasks"), limits)

        run = run_on_file(self.request, self.file) if self.output or folder else None
        staging = self.filming.staging(*self._scenes() if self.filming.any else ())
        if folder is not None:
            claim(folder, run)
        with tallied(tally, summary), writer(self.output, run, fits) as out:
            tally.go_on(out.state)
            outcomes = recheck(
                read_lines(lines_of(stream), self.file), where=self.request.conditions(), seed=self.seed,
                witness_only=self.witness_only, load=lambda record, of: self.request.of(record, of).domain(),
                folder=Path(self.file).parent, done=tally.seen, staging=staging, **self.validation.arguments(),
            )  # fmt: skip
            with closing(outcomes):
                for outcome in outcomes:
                    tally.count(outcome.status, outcome.reason, outcome.causes)
                    line = f"{tally.seen}\t{outcome.status}\t{outcome.reason}\t{outcome.detail}".rstrip()
                    out.write(line, tally.state())
                    tell(summary(), tally.seen, total)
        return tally

    def _scenes(self) -> list[Scene]:
        """Return the scenes of the domains of the tasks, none if the file can be read only once.

        Raises:
            PragError: a domain cannot be loaded, or has no scene.
        """
        from prag_asp.dataset.scenes import scene_of

        if not Path(self.file).is_file():
            return []
        return [scene_of(domain) for domain in domains_of(self.request, self.file)[0]]

    def _tasks_in(self, stream: TextIO) -> int | None:
        """Return the number of lines that are not empty, None if the file can be read only once.

        Raises:
            QueryError: none does.
        """
        if not stream.seekable():
            return None
        number = sum(1 for line in lines_of(stream) if line.strip())
        stream.seek(0)
        if number:
            return number
        raise QueryError(
            f"{self.file}:1: no tasks in it; write some with prag-asp sample --format jsonl -o {self.file}"
        )
