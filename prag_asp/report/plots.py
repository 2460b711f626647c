"""The figures of a report as plain values, made from its tables; the page and the PDF files show the same values."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import log10
from typing import Literal

from prag_asp.analysis.plots.curve import logarithms
from prag_asp.report.report_table import ReportTable, Value, natural_order

Kind = Literal["lines", "columns", "bars", "intervals", "map"]
Style = Literal["line", "dashed", "dots", "bars", "marks"]

MOST_BARS = 24
"""The maximum number of values in a figure of frequencies; the table has all of them."""

FEATURE_TITLES = {"names": "Names of actions", "classes": "Actions with classes", "actions": "Actions"}


@dataclass(frozen=True)
class PlotSeries:
    """Points of one colour in a figure: their places on the axis, their heights, and the bounds of their intervals.

    A place is a number, or the index of a category. If there are no intervals, `lows` and `highs` are empty.
    """

    name: str
    style: Style
    places: tuple[float, ...]
    heights: tuple[float, ...]
    lows: tuple[float, ...] = ()
    highs: tuple[float, ...] = ()


@dataclass(frozen=True)
class ReportPlot:
    """A figure: its name, the table behind it, its title, the labels of its axes, and its series.

    ``lines`` and ``columns`` have numbers on both axes, and columns are `width` wide; ``bars`` and ``intervals`` have a
    row for each of the `categories`; a ``map`` has no scales. If `logarithmic` is true, heights are decimal logarithms.
    If `share` is true, heights are shares from 0 to 1. A `filtered` figure depends on the filters of the page.
    """

    name: str
    table: str
    title: str
    kind: Kind
    across: str
    up: str
    series: tuple[PlotSeries, ...]
    categories: tuple[str, ...] = ()
    logarithmic: bool = False
    share: bool = False
    filtered: bool = False
    width: float = 1.0


def report_plots(tables: Sequence[ReportTable]) -> tuple[ReportPlot, ...]:
    """Return the figures of a report, in the order of its tables; a table without points has none."""
    makers = {
        "results": _results, "counts": _counts, "coverage": _coverage, "frequencies": _frequencies,
        "pass_rates": _pass_rates, "effort": _effort, "causes": _causes, "complexity": _complexity,
        "difficulty": _difficulty, "distances": _distances, "map": _map,
    }  # fmt: skip
    plots = [plot for table in tables if table.rows and table.name in makers for plot in makers[table.name](table)]
    return tuple(plot for plot in plots if any(each.places for each in plot.series))


def _results(table: ReportTable) -> Iterator[ReportPlot]:
    rows = table.records()
    groups = dict.fromkeys((str(row["by"]), str(row["group"])) for row in rows)
    categories = tuple("all episodes" if by == "all" else f"{by} {group}" for by, group in groups)
    place = {group: number for number, group in enumerate(groups)}
    series = []
    for policy in dict.fromkeys(row["policy"] for row in rows):
        own = [row for row in rows if row["policy"] == policy]
        places = tuple(float(place[str(row["by"]), str(row["group"])]) for row in own)
        series.append(
            PlotSeries(str(policy), "dots", places, *(_floats(own, name) for name in ("rate", "low", "high")))
        )
    yield ReportPlot(
        "results", table.name, table.title, "intervals", "success rate, 95 % interval", "", tuple(series), categories,
        share=True, filtered=True,
    )  # fmt: skip


def _counts(table: ReportTable) -> Iterator[ReportPlot]:
    lengths = _floats(table.records(), "length")
    series = []
    for name in table.columns[1:]:
        style: Style = "dashed" if name.endswith("^n") else "dots" if name in ("published", "given tasks") else "line"
        counts = tuple(count if isinstance(count, int) else 0 for count in table.column(name))
        heights = zip(lengths, logarithms(counts), strict=True)
        points = [(length, height) for length, height in heights if height is not None]
        series.append(PlotSeries(name, style, *_columns(points)))
    yield ReportPlot("counts", table.name, table.title, "lines", "length n", "number", tuple(series), logarithmic=True)


def _coverage(table: ReportTable) -> Iterator[ReportPlot]:
    series = []
    for what in ("tasks", "skeletons"):
        points = []
        for row in table.records():
            kind, of, length = str(row["of"]).partition(" of length ")
            share = row["share"]
            if of and kind == what and isinstance(share, float) and share:
                points.append((float(length), log10(share)))
        series.append(PlotSeries(what, "line", *_columns(points)))
    yield ReportPlot(
        "coverage", table.name, table.title, "lines", "length n", "share of the space", tuple(series), logarithmic=True
    )


def _frequencies(table: ReportTable) -> Iterator[ReportPlot]:
    for feature, title in FEATURE_TITLES.items():
        given: Counter[str] = Counter()
        expected: dict[str, float] = {}
        for row in table.records():
            if row["feature"] == feature and isinstance(row["given"], int) and isinstance(row["expected"], float):
                value = str(row["value"])
                given[value] += row["given"]
                expected[value] = expected.get(value, 0.0) + row["expected"]
        values = sorted(expected, key=lambda value: (-expected[value], natural_order(value)))[:MOST_BARS]
        places = tuple(float(place) for place in range(len(values)))
        yield ReportPlot(
            f"frequencies_{feature}", table.name, f"{title}: given and expected", "bars", "occurrences", "",
            (PlotSeries("given", "bars", places, tuple(float(given[value]) for value in values)),
             PlotSeries("expected, exactly", "marks", places, tuple(expected[value] for value in values))),
            tuple(values), filtered=True,
        )  # fmt: skip


def _pass_rates(table: ReportTable) -> Iterator[ReportPlot]:
    series = PlotSeries(
        "feasible", "dots", *(_floats(table.records(), name) for name in ("length", "rate", "low", "high"))
    )
    yield ReportPlot(
        "pass_rates", table.name, table.title, "lines", "length n", "pass rate, 95 % interval", (series,), share=True
    )


def _effort(table: ReportTable) -> Iterator[ReportPlot]:
    series = []
    for budget in dict.fromkeys(table.column("budget")):
        own = [row for row in table.records() if row["budget"] == budget]
        columns = (_floats(own, name) for name in ("initial states", "rate", "low", "high"))
        series.append(PlotSeries(str(budget), "dots", *columns))
    yield ReportPlot(
        "effort", table.name, table.title, "lines", "initial states tried", "pass rate, 95 % interval", tuple(series),
        share=True,
    )  # fmt: skip


def _causes(table: ReportTable) -> Iterator[ReportPlot]:
    found: Counter[str] = Counter()
    for row in table.records():
        found[str(row["cause"])] += row["failed attempts"] if isinstance(row["failed attempts"], int) else 0
    ordered = sorted(found, key=lambda cause: (-found[cause], cause))
    places = tuple(float(place) for place in range(len(ordered)))
    series = PlotSeries("failed attempts", "bars", places, tuple(float(found[cause]) for cause in ordered))
    yield ReportPlot("causes", table.name, table.title, "bars", "failed attempts", "", (series,), tuple(ordered))


def _complexity(table: ReportTable) -> Iterator[ReportPlot]:
    for name, column, across in (("lengths", "length", "length n"), ("entities", "entities", "entities in the plan")):
        found: Counter[float] = Counter()
        for row in table.records():
            value, tasks = row[column], row["tasks"]
            if isinstance(value, int) and isinstance(tasks, int):
                found[float(value)] += tasks
        ordered = sorted(found.items())
        series = PlotSeries("tasks", "bars", *_columns([(value, float(count)) for value, count in ordered]))
        yield ReportPlot(
            name, table.name, f"Tasks by {column}", "columns", across, "tasks", (series,), filtered=True, width=0.8
        )


def _difficulty(table: ReportTable) -> Iterator[ReportPlot]:
    for name, column in (("detours", "detour"), ("undone", "changes undone")):
        found = sorted(Counter(_floats(table.records(), column)).items())
        series = PlotSeries("tasks", "bars", *_columns([(value, float(count)) for value, count in found]))
        title = f"Tasks by {column}"
        yield ReportPlot(name, table.name, title, "columns", column, "tasks", (series,), width=0.8)


def _distances(table: ReportTable) -> Iterator[ReportPlot]:
    rows = table.records()
    lows, highs, counts = (_floats(rows, name) for name in ("distance from", "to", "pairs"))
    middles = tuple((low + high) / 2 for low, high in zip(lows, highs, strict=True))
    yield ReportPlot(
        "distances", table.name, table.title, "columns", "distance", "pairs of tasks",
        (PlotSeries("pairs", "bars", middles, counts),), width=highs[0] - lows[0],
    )  # fmt: skip


def _map(table: ReportTable) -> Iterator[ReportPlot]:
    rows = table.records()
    series = []
    for length in dict.fromkeys(sorted(_floats(rows, "length"))):
        own = [row for row in rows if row["length"] == length]
        series.append(PlotSeries(f"length {length:.0f}", "dots", _floats(own, "x"), _floats(own, "y")))
    yield ReportPlot("map", table.name, table.title, "map", "", "", tuple(series), filtered=True)


def _floats(rows: Sequence[Mapping[str, Value]], name: str) -> tuple[float, ...]:
    return tuple(float(value) for row in rows if isinstance(value := row[name], int | float))


def _columns(points: Sequence[tuple[float, float]]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    return tuple(place for place, _ in points), tuple(height for _, height in points)
