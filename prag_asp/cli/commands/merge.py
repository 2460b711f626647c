"""``prag-asp merge``: one dataset from the parts that several machines have generated."""

from __future__ import annotations

import click

from prag_asp.cli import options, shell_completion
from prag_asp.cli.commands.generate import print_existing, print_parts, warnings_as_lines
from prag_asp.cli.options import whole
from prag_asp.cli.physics_options import max_draws, ray
from prag_asp.cli.terminal import progress, tell_line
from prag_asp.errors import NotFound


@click.command()
@click.argument("parts", metavar="DIR...", nargs=-1, required=True, shell_complete=shell_completion.files)
@options.trust
@click.option(
    "--workers", type=whole(1, 4096), default=1, show_default=True,
    help="Number of processes for tasks that no part has validated.",
)  # fmt: skip
@ray
@max_draws
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    required=True,
    shell_complete=shell_completion.files,
    help="Folder of the dataset.",
)
def merge(
    *, parts: tuple[str, ...], trust: bool, workers: int, on: str | None, max_draws: int | None, output: str
) -> None:
    """Merge the parts of a dataset that several machines have generated.

    The parts are the results of `generate --part 1/N` to `--part N/N`. The merged dataset is the same, byte for byte,
    as the one that a single machine writes without --part. Parts end at different samples; this command validates the
    few samples that no part has validated. If it is interrupted, run it again: it continues.
    """
    from prag_asp.dataset.merging import merge as make
    from prag_asp.missing import require_pyarrow

    require_pyarrow()
    with progress() as tell, warnings_as_lines():
        print_existing(output)
        try:
            dataset = make(parts, output, workers=workers, on=on, max_draws=max_draws, trust=trust, progress=tell)
        except NotFound:
            tell_line(f"{output}: holds the tasks that were found")
            raise
    print_parts(dataset)
