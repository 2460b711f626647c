"""The report of an audit: tables of strings, which are written as text, as a web page or as JSON."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from prag_asp.audit.auditing import BenchmarkAudit
from prag_asp.html import element, html_page, scroll_table
from prag_asp.wording import plural

SHOWN_GROUPS, SHOWN_MEMBERS = 5, 3
"""The maximum numbers of groups of equal goals, and of problems in each group, that the text report shows."""


@dataclass(frozen=True)
class AuditTable:
    """A table with a title, a row of headings, rows of cells, and a sentence about the table."""

    title: str
    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""


def audit_tables(audit: BenchmarkAudit, *, full: bool = False) -> Iterator[AuditTable]:
    """Yield the tables of a report; with `full`, all groups, nearest problems and missing combinations are included."""
    rows = [
        (each.suite, *map(str, (each.files, each.problems, each.goals, each.tasks)))
        for each in ([*audit.suites, audit.total] if len(audit.suites) > 1 else audit.suites)
    ]
    yield AuditTable(
        "distinct tasks", ("suite", "files", "read", "goals", "goals with initial states"), tuple(rows),
        "Problems that differ only by a renaming of the objects of a class are counted once.",
    )  # fmt: skip
    if len(audit.suites) > 1:
        yield from _overlap_tables(audit)
    yield from _nearest_tables(audit, full=full)
    combinations = audit.combinations
    if combinations.occurring:
        known = "known to be " if any(each.kind == "unchecked-goal" for each in audit.findings) else ""
        share = 100 * len(combinations.occurring) / combinations.possible
        rows = [
            ("possible", str(combinations.possible)),
            ("in some initial state", str(len(combinations.present))),
            *(
                []
                if combinations.reachable is None
                else [(f"of these, {known}reachable by actions", str(len(combinations.reachable)))]
            ),
            ("in some goal", str(len(combinations.occurring))),
        ]
        size = (
            f"{plural(len(combinations.classes), 'class', 'classes')} and {plural(len(combinations.targets), 'target')}"
        )
        yield AuditTable(
            "pairs of a moved class and a target",
            ("pairs", "number"),
            tuple(rows),
            f"{size}; {share:.1f} % of the pairs are in some goal.",
        )
    if audit.same:
        yield _same_table(audit.same, full=full)
    if full and combinations.occurring:
        missing = [
            (one, other)
            for one in combinations.classes
            for other in combinations.targets
            if (one, other) not in combinations.occurring
        ]
        marks = [(one, other, "yes" if (one, other) in combinations.present else "no") for one, other in missing]
        yield AuditTable("pairs in no goal", ("class", "target", "in an initial state"), tuple(marks))
    yield _finding_table(audit)


def _overlap_tables(audit: BenchmarkAudit) -> Iterator[AuditTable]:
    names = [each.suite for each in audit.suites]
    cells = {(each.test, each.train): each for each in audit.overlaps}
    for title, kind in (
        ("problems whose goal occurs in another suite", "goals"),
        ("problems whose goal and initial state occur in another suite", "tasks"),
    ):
        rows = tuple(
            (test, *(str(getattr(cells[test, train], kind)) if test != train else "-" for train in names))
            for test in names
        )
        note = "Each row counts the problems of one suite whose goal occurs in the suite of the column."
        yield AuditTable(title, ("suite", *names), rows, note if kind == "goals" else "")


def _nearest_tables(audit: BenchmarkAudit, *, full: bool) -> Iterator[AuditTable]:
    if not audit.nearest:
        return
    suites = list(dict.fromkeys(each.suite for each in audit.nearest))
    distances = sorted({each.distance for each in audit.nearest})
    counts = Counter((each.suite, each.distance) for each in audit.nearest)
    rows = tuple((suite, *(str(counts[suite, distance]) for distance in distances)) for suite in suites)
    note = (
        "Each column counts the problems whose goal differs from the nearest goal in another suite by this number of "
        "facts."
    )
    yield AuditTable("distance to the nearest goal", ("suite", *map(str, distances)), rows, note)
    if full:
        listed = (
            (each.problem, each.nearest, str(each.distance), "yes" if each.same_start else "no")
            for each in audit.nearest
        )
        yield AuditTable("nearest problems", ("problem", "nearest", "distance", "same initial state"), tuple(listed))


def _same_table(same: Sequence[Sequence[str]], *, full: bool) -> AuditTable:
    shown = same if full else same[:SHOWN_GROUPS]
    rows = []
    for group in shown:
        members = group if full else group[:SHOWN_MEMBERS]
        more = "" if len(members) == len(group) else " ..."
        rows.append((str(len(group)), ", ".join(members) + more))
    note = f"{plural(len(same), 'goal')} {'occurs' if len(same) == 1 else 'occur'} in several problems."
    return AuditTable("problems with the same goal", ("problems", "names"), tuple(rows), note)


def _finding_table(audit: BenchmarkAudit) -> AuditTable:
    rows = tuple((each.kind, each.place, each.text) for each in audit.findings)
    note = "" if rows else "None found."
    return AuditTable("mistakes", ("kind", "place", "mistake"), rows, note)


def audit_text(audit: BenchmarkAudit, *, full: bool = False) -> Iterator[str]:
    """Yield the lines of the report."""
    for number, table in enumerate(audit_tables(audit, full=full)):
        if number:
            yield ""
        yield table.title
        if table.rows:
            yield from _lines([table.heads, *table.rows], last_left=table.heads[-1] in ("names", "mistake"))
        if table.note:
            yield table.note


def _lines(rows: Sequence[Sequence[str]], *, last_left: bool) -> Iterator[str]:
    """Yield the lines of a table; columns of numbers are right-aligned."""
    columns = [*zip(*rows, strict=True)]
    widths = [max(map(len, column)) for column in columns]
    right = [all(cell.isdigit() or cell == "-" for cell in column[1:]) for column in columns]
    for row in rows:
        cells = [
            cell.rjust(width) if is_right and not (last_left and place == len(row) - 1) else cell.ljust(width)
            for place, (cell, width, is_right) in enumerate(zip(row, widths, right, strict=True))
        ]
        yield "  " + "  ".join(cells).rstrip()


def audit_page(audit: BenchmarkAudit) -> str:
    """Return the report as a self-contained HTML page."""
    parts = []
    for table in audit_tables(audit, full=True):
        parts.append(element("h2", table.title.capitalize()))
        if table.rows:
            parts.append(scroll_table(table.heads, table.rows, label=table.title))
        if table.note:
            parts.append(element("p", table.note, class_="note"))
    title = f"Audit of {', '.join(each.suite for each in audit.suites)}"
    return html_page(title, element("h1", title), *parts)


def audit_json(audit: BenchmarkAudit) -> dict[str, Any]:
    """Return the report as JSON values."""
    combinations = audit.combinations
    return {
        "suites": [asdict(each) for each in audit.suites],
        "total": asdict(audit.total),
        "overlaps": [asdict(each) for each in audit.overlaps],
        "nearest": [asdict(each) for each in audit.nearest],
        "same_goals": [list(each) for each in audit.same],
        "combinations": {
            "classes": list(combinations.classes),
            "targets": list(combinations.targets),
            "possible": combinations.possible,
            "occurring": sorted(map(list, combinations.occurring)),
            "present": sorted(map(list, combinations.present)),
            "reachable": None if combinations.reachable is None else sorted(map(list, combinations.reachable)),
        },
        "findings": [asdict(each) for each in audit.findings],
    }
