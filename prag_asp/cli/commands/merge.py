"""``prag-asp merge``: the parts of a data set that several machines have made, as the one that it is."""

from __future__ import annotations

import click

from prag_asp.cli import options, shell_completion
from prag_asp.cli.commands.generate import show, tell_what_is_there, warnings_as_lines
from prag_asp.cli.terminal import progress, tell_line
from prag_asp.errors import NotFound


@click.command()
@click.argument("parts", metavar="DIR...", nargs=-1, required=True, shell_complete=shell_completion.files)
@options.TRUST
@click.option(
    "--workers", type=options.whole(1, 4096), default=1, show_default=True,
    help="Processes for the draws that no part has looked at.",
)  # fmt: skip
@options.ON
@options.MAX_DRAWS
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    required=True,
    shell_complete=shell_completion.files,
    help="Folder of the data set.",
)
def merge(
    *, parts: tuple[str, ...], trust: bool, workers: int, on: str | None, max_draws: int | None, output: str
) -> None:
    """Merge the parts that `generate --part 1/N` to `N/N` have made, all of them, into one data set.

    Its bytes are those that one machine writes without --part. Parts end at different draws; the few that none of them
    has looked at are looked at here. A run that was broken off goes on where it was when it is started again.
    """
    from prag_asp.dataset.merging import merge as make
    from prag_asp.missing import require_pyarrow

    require_pyarrow()
    with progress() as tell, warnings_as_lines():
        tell_what_is_there(output)
        try:
            made = make(parts, output, workers=workers, on=on, max_draws=max_draws, trust=trust, progress=tell)
        except NotFound:
            tell_line(f"{output}: holds what was found")
            raise
    show(made)
