"""``prag-asp validate``: tasks of a file, validated again."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

import click

from prag_asp.cli import options, shell_completion
from prag_asp.cli.domain_options import OF_FILE, WHERE, DomainOptions, domain_options
from prag_asp.cli.exits import Exit
from prag_asp.cli.line_output import recordings_folder, require_writable, writer
from prag_asp.cli.physics_options import BUDGET, CameraOptions, PhysicsOptions, camera_options, physics_options
from prag_asp.cli.terminal import Tell, progress
from prag_asp.errors import PragError, QueryError
from prag_asp.safe_reading import lines_of, open_binary, open_text

if TYPE_CHECKING:
    from prag_asp.dataset import Record, Tally
    from prag_asp.domain.load import Domain
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

        total, tally = self._tasks_in(stream), Tally()

        def summary() -> str:
            return tally_line(tally, ("task", "tasks"), limits)

        staging = self.filming.staging(*self._scenes() if self.filming.any else ())
        with (
            tallied(tally, summary),
            recordings_folder(self.validation.demonstrate) as folder,
            writer(self.output) as out,
        ):
            arguments = {**self.validation.arguments(), "demonstrate": folder}
            outcomes = recheck(
                read_lines(lines_of(stream), self.file), where=self.request.conditions(), seed=self.seed,
                witness_only=self.witness_only, load=lambda record, of: self.request.of(record, of).domain(),
                folder=Path(self.file).parent, staging=staging, **arguments,
            )  # fmt: skip
            with closing(outcomes):
                for outcome in outcomes:
                    tally.count(outcome.status, outcome.reason, outcome.causes)
                    line = f"{tally.seen}\t{outcome.status}\t{outcome.reason}\t{outcome.detail}".rstrip()
                    out.write(line, flush=True)
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
        return [scene_of(domain) for domain in _domains_of(self.request, self.file)]

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


def _domains_of(request: DomainOptions, file: str) -> list[Domain]:
    """Return the domains that the tasks of a file are of.

    Raises:
        PragError: a domain that the file names cannot be loaded.
    """
    firsts: dict[tuple[bytes, bytes], Record] = {}
    with open_binary(file) as lines:
        for line in lines:
            _take_first(line, file, firsts)
    return [request.of(record, Path(file).parent).domain(tell=False) for record in firsts.values()]


def _take_first(line: bytes, file: str, firsts: dict[tuple[bytes, bytes], Record]) -> None:
    """Add the record of a line where it is the first of its domain and constants; `recheck` reports a damaged line."""
    import msgspec

    from prag_asp.dataset.jsonl import read_lines

    try:
        named = msgspec.json.decode(line, type=dict[str, msgspec.Raw])
        key = (bytes(named["domain"]), bytes(named.get("constants", msgspec.Raw(b""))))
        if key not in firsts:
            firsts[key] = next(read_lines([line.decode(errors="replace")], file))
    except (msgspec.MsgspecError, KeyError, RecursionError, PragError, StopIteration):
        return
