"""``prag-asp report``: a page with figures and tables on a dataset, a file of tasks, or evaluations."""

from __future__ import annotations

from pathlib import Path

import click

from prag_asp.cli import options, shell_completion
from prag_asp.cli.domain_options import OF_FILE, DomainOptions, domain_options
from prag_asp.cli.line_output import require_writable
from prag_asp.cli.options import whole
from prag_asp.cli.terminal import progress, say
from prag_asp.errors import QueryError


@click.command()
@click.argument("sources", metavar="SOURCE...", nargs=-1, required=True, shell_complete=shell_completion.files)
@domain_options(*OF_FILE, options.trust)
@click.option(
    "-o", "--output", metavar="FILE.html", shell_complete=shell_completion.files,
    help="Write the page to FILE.html, which needs no other file and no network; FILE.html is replaced as a whole.",
)  # fmt: skip
@click.option(
    "--tables", metavar="DIR", shell_complete=shell_completion.files, help="Write each table to DIR as a CSV file."
)
@click.option(
    "--figures", metavar="DIR", shell_complete=shell_completion.files,
    help="Write each figure to DIR as a vector PDF file, as wide as a column of a paper.",
)  # fmt: skip
@click.option(
    "--strips", type=whole(0, 100), metavar="K", default=6, show_default=True,
    help="Number of tasks with a film strip in the page, if the dataset has witnesses.",
)  # fmt: skip
@click.option(
    "--sample", type=whole(2, 5000), metavar="K", default=1000, show_default=True,
    help="Maximum number of tasks to compare in pairs; if there are more, a sample is taken with --seed.",
)  # fmt: skip
@options.seed
def report(
    *, sources: tuple[str, ...], request: DomainOptions, output: str | None, tables: str | None, figures: str | None,
    strips: int, sample: int, seed: int,
) -> None:  # fmt: skip
    """Report on a dataset, a file of tasks, or evaluations.

    A SOURCE is a dataset, a file of tasks as JSON lines, or the folder of an evaluation; evaluations may be given
    alone, or together with a dataset or a file. The report contains exact counts by length, the coverage of the space,
    actual and expected frequencies, pass rates, distances, a map, film strips, and success rates of policies.
    Prints the names of the files written.
    """
    from prag_asp.report import write_report

    if output is None and tables is None and figures is None:
        raise QueryError("a report needs -o FILE.html, --tables DIR or --figures DIR")
    if output is not None:
        if Path(output).suffix.lower() not in (".html", ".htm"):
            raise QueryError(f"--output {output}: a report is written to a file that ends in .html")
        require_writable(output)
    with progress():
        domain = request.domain() if request.names else None
        written = write_report(
            *sources, output=output, tables=tables, figures=figures, domain=domain, strips=strips, sample=sample,
            seed=seed, trust=request.trust,
        )  # fmt: skip
    for path in written:
        say(path)
