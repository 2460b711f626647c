"""``prag-asp validate``: the tasks in a file, validated again."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

import click

from prag_asp.cli import options, shell_completion
from prag_asp.cli.domain_options import OF_FILE, WHERE, DomainOptions, domain_options
from prag_asp.cli.exits import Exit
from prag_asp.cli.line_output import recordings_folder, require_writable, writer
from prag_asp.cli.physics_options import BUDGET, CameraOptions, PhysicsOptions, camera_options, physics_options
from prag_asp.cli.terminal import progress
from prag_asp.errors import PragError, QueryError
from prag_asp.safe_reading import lines_of, open_binary, open_text

if TYPE_CHECKING:
    from prag_asp.dataset import Record
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
    """Validate the tasks in a file: plans and feasibility.

    Prints a line for each task: its number, its verdict and the reason. Use the same --rule, --encodings, --flat and
    --where as when the tasks were generated.
    """
    from prag_asp.cli.summary import tallied, tally_line
    from prag_asp.dataset import Tally, read_lines, recheck
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
    limits = f"witnesses only, {budget.tier}" if witness_only else f"budget {budget}"
    tally = Tally()

    def summary() -> str:
        return tally_line(tally, ("task", "tasks"), limits)

    with open_text(file) as stream, progress() as tell:
        total = None  # unknown if the file can be read only once
        if stream.seekable():
            total = sum(1 for line in lines_of(stream) if line.strip())
            stream.seek(0)
            if not total:
                remedy = f"write some with prag-asp sample --format jsonl -o {file}"
                raise QueryError(f"{file}:1: no tasks in it; {remedy}")
        staging = filming.staging(*_scenes_in(file, request) if filming.any else ())
        with tallied(tally, summary), recordings_folder(validation.demonstrate) as folder, writer(output) as out:
            outcomes = recheck(
                read_lines(lines_of(stream), file), where=request.conditions(), seed=seed, witness_only=witness_only,
                load=lambda record, of: request.of(record, of).domain(), folder=Path(file).parent, staging=staging,
                **{**validation.arguments(), "demonstrate": folder},
            )  # fmt: skip
            with closing(outcomes):
                for outcome in outcomes:
                    tally.count(outcome.status, outcome.reason, outcome.causes)
                    line = f"{tally.seen}\t{outcome.status}\t{outcome.reason}\t{outcome.detail}".rstrip()
                    out.write(line, flush=True)
                    tell(summary(), tally.seen, total)
    if tally.passed < tally.seen:
        raise click.exceptions.Exit(Exit.NOT_FOUND)


def _scenes_in(file: str, request: DomainOptions) -> list[Scene]:
    """Return the scenes of the domains of the tasks in a file, or none if the file can be read only once.

    A damaged line is skipped, because `recheck` reports it.

    Raises:
        PragError: a domain cannot be loaded, or has no scene.
    """
    import msgspec

    from prag_asp.dataset import read_lines
    from prag_asp.dataset.scenes import scene_of

    if not Path(file).is_file():
        return []
    firsts: dict[tuple[bytes, bytes], Record] = {}
    with open_binary(file) as lines:
        for line in lines:
            try:
                named = msgspec.json.decode(line, type=dict[str, msgspec.Raw])
                key = (bytes(named["domain"]), bytes(named.get("constants", msgspec.Raw(b""))))
                if key not in firsts:
                    firsts[key] = next(read_lines([line.decode(errors="replace")], file))
            except (msgspec.MsgspecError, KeyError, RecursionError, PragError, StopIteration):
                continue
    return [scene_of(request.of(record, Path(file).parent).domain(tell=False)) for record in firsts.values()]
