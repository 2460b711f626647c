"""Write the page, the tables and the figures of a report."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.errors import OutputError
from prag_asp.output import file_in, make_folder, replace_file
from prag_asp.processes.progress_events import stage
from prag_asp.report.all_tables import report_tables
from prag_asp.report.pdf_figures import pdf_figure, require_matplotlib
from prag_asp.report.plots import report_plots
from prag_asp.report.report_page import report_page
from prag_asp.report.report_table import csv_text
from prag_asp.report.source import read_source
from prag_asp.report.strips import STRIPS, film_strips
from prag_asp.report.task_tables import SAMPLE

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain


def write_report(
    *sources: str | Path,
    output: str | Path | None = None,
    tables: str | Path | None = None,
    figures: str | Path | None = None,
    domain: Domain | None = None,
    strips: int = STRIPS,
    sample: int = SAMPLE,
    seed: int = 0,
    trust: bool = False,
) -> list[Path]:
    """Write a report on a dataset, a file of tasks or evaluations, and return the files that were written.

    `output` is the page, `tables` is a folder for a CSV file of each table, and `figures` is a folder for a PDF file of
    each figure. Existing files are replaced. The page has film strips for at most `strips` tasks with witnesses. The
    pairs of at most `sample` tasks are compared; if there are more tasks, a uniform sample is drawn with the seed. The
    same arguments give the same bytes.

    Raises:
        QueryError: a source is not a dataset, file of tasks or evaluation, is damaged, or has no task.
        DomainError: the domain of the tasks cannot be loaded.
        OutputError: nothing is requested, or a file cannot be written.
        PicturesMissingError: figures are requested, and matplotlib is not installed.
    """
    if output is None and tables is None and figures is None:
        raise OutputError("a report needs an output, a folder of tables or a folder of figures")
    if figures is not None:
        require_matplotlib()
    source = read_source(*sources, domain=domain, trust=trust)
    made = report_tables(source, sample=sample, seed=seed)
    plots = report_plots(made)
    pictures = film_strips(source, strips) if output is not None else {}
    stage("writing the report")
    written: list[Path] = []
    if tables is not None:
        written += _write(tables, [(f"{table.name}.csv", csv_text(table).encode()) for table in made])
    if figures is not None:
        written += _write(figures, [(f"{plot.name}.pdf", pdf_figure(plot)) for plot in plots])
    if output is not None:
        replace_file(output, report_page(source, made, plots, pictures, seed).encode())
        written.append(Path(output))
    return written


def _write(folder: str | Path, contents: Sequence[tuple[str, bytes]]) -> list[Path]:
    """Write files into a folder, which is created if it is missing."""
    targets = [file_in(make_folder(folder), name) for name, _ in contents]
    for target, (_, content) in zip(targets, contents, strict=True):
        replace_file(target, content)
    return targets
