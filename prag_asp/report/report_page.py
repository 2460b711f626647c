"""The page of a report: one self-contained HTML file with figures, tables, filters and film strips."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from prag_asp.atom import parse_atom
from prag_asp.html import Markup, element, html_page, json_block, scroll_table
from prag_asp.report.plots import ReportPlot
from prag_asp.report.report_table import ReportTable, Value, natural_order, shown_value
from prag_asp.report.source import ReportedTask, ReportSource
from prag_asp.report.task_tables import chosen_tasks
from prag_asp.versions import versions

MOST_TASKS = 10_000
"""The maximum number of tasks on a page, at about a megabyte per thousand tasks; of more tasks, a sample is shown."""

MOST_ROWS = 200
"""The largest number of rows of a table on a page; its CSV file has all of them."""

EXACT = 2**53
"""Integers of at least this size are strings in JSON, because JavaScript's numbers cannot represent all of them."""

LISTED = ("tasks", "episodes")
"""The tables whose rows a script lists on the page, according to the filters."""


def report_page(
    source: ReportSource,
    tables: Sequence[ReportTable],
    plots: Sequence[ReportPlot],
    strips: Mapping[int, str] | None = None,
    seed: int = 0,
) -> str:
    """Return the page of a report; its links and filters work without a server or network.

    If there are more than `MOST_TASKS` tasks, the page has a uniform sample of them, drawn with the seed.
    """
    tasks = chosen_tasks(source.tasks, MOST_TASKS, seed)
    parts: list[Markup] = []
    headings = [(table.name, table.title) for table in tables]
    for table in tables:
        if table.name == "tasks" and strips:
            headings.insert(len(headings) - 1, ("film-strips", "Film strips"))
            parts += [element("h2", "Film strips", id="film-strips"), element("div", id="strips")]
        parts += _section(table, [plot for plot in plots if plot.table == table.name])
    data = {
        "title": source.title,
        "tables": [_table_data(table) for table in tables if table.name != "tasks"],
        "plots": [asdict(plot) for plot in plots],
        "tasks": task_data(source, tasks),
        "total": len(source.tasks),
        "strips": {str(number): picture for number, picture in (strips or {}).items()},
    }
    return html_page(
        source.title,
        element("h1", source.title),
        element("p", _summary(source), class_="note"),
        *(element("p", note, class_="note") for note in source.notes),
        element("nav", *(element("a", title, href=f"#{name}") for name, title in headings), id="contents"),
        _filters(source, tasks),
        element("noscript", element("p", "The figures need JavaScript; the tables below do not.", class_="note")),
        *parts,
        element("p", versions(), class_="note"),
        element("div", id="tip", role="tooltip", hidden=True),
        json_block("report-data", data),
        styles=[_asset("report.css")],
        scripts=[_asset("plots.js") + _asset("report.js")],
    )


def _asset(name: str) -> str:
    return Path(__file__).with_name(name).read_text(encoding="utf-8")


def _summary(source: ReportSource) -> str:
    lengths = ", ".join(map(str, sorted({len(task.plan) for task in source.tasks})))
    number = len(source.tasks)
    text = f"{number:,} {'task' if number == 1 else 'tasks'} of {lengths} actions"
    parts = [f"{part} {sum(task.part == part for task in source.tasks):,}" for part in source.parts if part]
    return f"{text} ({', '.join(parts)})" if parts else text


def _filters(source: ReportSource, tasks: Sequence[ReportedTask]) -> Markup:
    """Return the form with the filters; a filter with only one option is left out."""
    names = {action.partition("(")[0] for task in tasks for action in task.plan}
    choices = {
        "length": [str(length) for length in sorted({len(task.plan) for task in tasks})],
        "action": sorted(names, key=natural_order),
        "entity": sorted({entity for task in tasks for entity in task.entities}, key=natural_order),
        "split": [part for part in source.parts if part],
    }
    fields = []
    for name, values in choices.items():
        if len(values) > 1:
            options = [element("option", "all", value=""), *(element("option", each) for each in values)]
            fields.append(element("label", name, " ", element("select", *options, name=name)))
    reset = element("button", "Reset", type="reset")
    status = element("output", "", id="shown", aria_live="polite")
    return element("form", *fields, reset, status, id="filters", aria_label="Filters")


def _section(table: ReportTable, plots: Sequence[ReportPlot]) -> Iterator[Markup]:
    """Yield the section of one table of a report: the heading, the figures, the note and the table itself."""
    yield element("h2", table.title, id=table.name)
    for plot in plots:
        if len(plots) > 1:
            yield element("h3", plot.title)
        hint = "" if plot.filtered else "Not filtered."
        yield element(
            "figure", element("figcaption", hint, class_="note"), id=f"figure-{plot.name}", data_plot=plot.name
        )
    if table.note:
        yield element("p", table.note, class_="note")
    save = element("button", "Save as CSV", type="button", data_csv=table.name)
    if table.name in LISTED:
        yield element("p", save)
        yield element("div", class_="list", data_list=table.name)
        return
    if table.rows:
        rows = [[shown_value(value) for value in row] for row in table.rows[:MOST_ROWS]]
        text = f"The first {len(rows)} of {len(table.rows):,} rows; the CSV file has all."
        notes = [element("p", text, class_="note")] if len(rows) < len(table.rows) else []
        shown = scroll_table(table.columns, rows, label=table.title)
        yield element("details", element("summary", "Table"), save, shown, *notes, open=not plots)


def _table_data(table: ReportTable) -> dict[str, Any]:
    rows = [[_json_value(value) for value in row] for row in table.rows]
    return {"name": table.name, "columns": table.columns, "rows": rows}


def _json_value(value: Value) -> Value:
    return str(value) if isinstance(value, int) and abs(value) >= EXACT else value


def task_data(source: ReportSource, tasks: Sequence[ReportedTask]) -> dict[str, Any]:
    """Return tasks by columns, for the filters of a page.

    `letters` holds the distinct actions as text, each with its name and its classes; `plans` holds lists of indices
    into `letters`, and `own` holds lists of indices into `entities`. `canonical` holds the plans with canonical names
    of interchangeable entities, where they differ.
    """
    from prag_asp.report.space_tables import canonical_plan  # noqa: PLC0415 - only with a space

    letters: dict[str, int] = {}
    entities: dict[str, int] = {}
    classes: dict[str, str] = {}

    def numbers(plan: Sequence[str]) -> list[int]:
        return [letters.setdefault(action, len(letters)) for action in plan]

    plans = []
    for task in tasks:
        plans.append(numbers(task.plan))
        for action in task.plan:
            if action not in classes:
                atom = parse_atom(action)
                arguments = [task.classes.get(argument, argument) for argument in atom.arguments]
                classes[action] = f"{atom.name}({','.join(arguments)})" if arguments else atom.name
    canonical = plans
    if source.space is not None:
        spaces = {length: source.space.at(length) for length in {len(task.plan) for task in tasks}}
        canonical = [numbers(canonical_plan(spaces[len(task.plan)], task.plan)) for task in tasks]
    return {
        "number": [task.number for task in tasks],
        "part": [task.part for task in tasks],
        "plans": plans,
        "canonical": None if canonical == plans else canonical,
        "own": [[entities.setdefault(entity, len(entities)) for entity in task.entities] for task in tasks],
        "instruction": [task.instruction for task in tasks],
        "letters": list(letters),
        "names": [letter.partition("(")[0] for letter in letters],
        "classes": [classes.get(letter, letter) for letter in letters],
        "entities": list(entities),
    }
