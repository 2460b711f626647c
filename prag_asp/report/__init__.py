"""Reports on datasets, files of tasks and evaluations of policies: tables, figures and one page.

>>> from prag_asp.report import write_report
>>> write_report("dataset", output="report.html")                     # doctest: +SKIP
[PosixPath('report.html')]
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from prag_asp.lazy import names_from

if TYPE_CHECKING:
    from prag_asp.report.all_tables import report_tables
    from prag_asp.report.plots import PlotSeries, ReportPlot, report_plots
    from prag_asp.report.report_table import ReportTable
    from prag_asp.report.source import PhysicsOutcome, ReportedTask, ReportSource, read_source
    from prag_asp.report.writing import write_report

__all__ = [
    "PhysicsOutcome", "PlotSeries", "ReportPlot", "ReportSource", "ReportTable", "ReportedTask", "read_source",
    "report_plots", "report_tables", "write_report",
]  # fmt: skip

_HOMES = {
    "prag_asp.report.plots": ("PlotSeries", "ReportPlot", "report_plots"),
    "prag_asp.report.report_table": ("ReportTable",),
    "prag_asp.report.all_tables": ("report_tables",),
    "prag_asp.report.source": ("PhysicsOutcome", "ReportSource", "ReportedTask", "read_source"),
    "prag_asp.report.writing": ("write_report",),
}

__getattr__ = names_from(__name__, _HOMES)


def __dir__() -> list[str]:
    return __all__
