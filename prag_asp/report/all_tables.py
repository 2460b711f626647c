"""All tables of a report."""

from __future__ import annotations

from prag_asp.report.outcome_tables import episode_tables, physics_tables, result_tables
from prag_asp.report.report_table import ReportTable
from prag_asp.report.source import ReportSource
from prag_asp.report.space_tables import space_tables
from prag_asp.report.task_tables import SAMPLE, complexity_table, difficulty_tables, similarity_tables, task_table


def report_tables(source: ReportSource, *, sample: int = SAMPLE, seed: int = 0) -> tuple[ReportTable, ...]:
    """Return the tables of a report, in the order of the page.

    The pairs of at most `sample` tasks are compared; if there are more tasks, a uniform sample is drawn with the seed.

    Raises:
        LimitReached: a limit ended the counting of the tasks of a length.
    """
    return (
        *result_tables(source),
        *space_tables(source),
        *physics_tables(source.outcomes),
        complexity_table(source),
        *difficulty_tables(source, seed),
        *similarity_tables(source, sample, seed),
        *episode_tables(source),
        task_table(source),
    )
