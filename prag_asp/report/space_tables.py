"""Tables that compare a whole space with the tasks in a report: counts by length, coverage, and frequencies."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from fractions import Fraction
from math import isfinite

from prag_asp.analysis.frequencies import FrequencyTest, compare_frequencies
from prag_asp.analysis.moments import Feature
from prag_asp.errors import EngineError, QueryError
from prag_asp.processes.progress_events import stage
from prag_asp.report.published import PUBLISHED, PublishedCount
from prag_asp.report.report_table import ReportTable, Value
from prag_asp.report.source import ReportedTask, ReportSource
from prag_asp.space.task_space import TaskSpace

FEATURES: tuple[Feature, ...] = ("names", "classes", "actions")
"""The features whose frequencies are compared."""

CERTAIN = 1e-12
"""P-values below this bound are not shown exactly, because floating-point error dominates them."""


def space_tables(source: ReportSource) -> Iterator[ReportTable]:
    """Yield the tables that need the exact space of the tasks; if it is not known, there are none.

    Raises:
        LimitReached: a limit ended the counting of the tasks of a length.
    """
    space = source.space
    if space is None:
        return
    stage("counting tasks by length")
    published = PUBLISHED.get(space.domain.name) if not space.condition.clauses else None
    yield counts_table(space, source, published)
    inside = [task for task in source.tasks if source.dataset is not None or task.plan in space.at(len(task.plan))]
    yield coverage_table(space, source, inside)
    if inside:
        stage("comparing frequencies")
        yield from frequency_tables(space, inside)


def counts_table(space: TaskSpace, source: ReportSource, published: PublishedCount | None) -> ReportTable:
    """Return the exact numbers of plans, tasks and skeletons of each length, and the number of given tasks.

    A level that the engine cannot count has empty cells.
    """
    own = Counter(len(task.plan) for task in source.tasks)
    names = len(space.action_texts("skeleton"))
    last = max([*source.lengths, *([published.length] if published else [])])
    rows: list[tuple[Value, ...]] = []
    for length in range(1, last + 1):
        at = space.at(length)
        counts: list[Value] = [_counted(at, "plan"), at.count(), _counted(at, "skeleton"), names**length]
        if published:
            counts.append(at.count("skeleton", prefix=(published.prefix,)))
            counts.append(published.count if length == published.length else None)
        rows.append((length, *counts, own[length]))
    columns: tuple[str, ...] = ("length", "plans", "tasks", "skeletons", f"{names}^n")
    if published:
        columns += (f"skeletons that begin with {published.prefix}", "published")
    note = (
        "Tasks are plans up to renaming of interchangeable entities; skeletons are sequences of action names; "
        f"{names}^n counts all sequences of the {names} names."
    )
    if space.condition.clauses:
        note += f" Conditions: {', '.join(map(str, space.condition.clauses))}."
    if published:
        note += f" Published: {published.source} of length {published.length} that begin with {published.prefix}."
    return ReportTable("counts", "Exact counts by length", (*columns, "given tasks"), tuple(rows), note)


def _counted(space: TaskSpace, level: str) -> int | None:
    try:
        return space.count("plan" if level == "plan" else "skeleton")
    except EngineError:
        return None


def coverage_table(space: TaskSpace, source: ReportSource, inside: Sequence[ReportedTask]) -> ReportTable:
    """Return the exact shares of the tasks and of the skeletons of each length that are among the given tasks."""
    rows: list[tuple[Value, ...]] = []
    spaces = {length: space.at(length) for length in {len(task.plan) for task in inside}}
    found = {task.number: canonical_plan(spaces[len(task.plan)], task.plan) for task in inside}
    for length in sorted({len(task.plan) for task in source.tasks}):
        own = [plan for plan in found.values() if len(plan) == length]
        at = space.at(length)
        rows.append(_share_row(f"tasks of length {length}", len(set(own)), at.count()))
        skeletons = {tuple(action.partition("(")[0] for action in plan) for plan in own}
        whole = _counted(at, "skeleton")
        if whole is not None:
            rows.append(_share_row(f"skeletons of length {length}", len(skeletons), whole))
    for part, size in source.sizes.items():
        rows.append(_share_row(f"part {part}", len({found[task.number] for task in inside if task.part == part}), size))
    total = sum(space.at(length).count() for length in source.lengths)
    rows.append(_share_row("all tasks", len(set(found.values())), total))
    note = "Numbers of distinct tasks, up to renaming of interchangeable entities; the denominators are exact."
    outside = len(source.tasks) - len(inside)
    if outside:
        note += f" {outside:,} of the given tasks are not in this space, and are left out."
    return ReportTable(
        "coverage",
        "Coverage of the exact space",
        ("of", "given", "in the space", "share", "exact share"),
        tuple(rows),
        note,
    )


def _share_row(name: str, given: int, whole: int) -> tuple[Value, ...]:
    share = Fraction(given, whole) if whole else Fraction(0)
    return name, given, whole, float(share), str(share)


def canonical_plan(space: TaskSpace, plan: Sequence[str]) -> tuple[str, ...]:
    """Return a plan from a space of one length with canonical names, which are the same for all plans of a task.

    Raises:
        QueryError: an action is not in the domain.
    """
    from prag_asp.logic.symmetry.renaming import renamed  # noqa: PLC0415
    from prag_asp.space.engines.prefix import parse_plan  # noqa: PLC0415
    from prag_asp.space.plans.canonical_plan import canonical_names  # noqa: PLC0415

    actions = space.engines.actions
    known = all(action in actions for action in plan)
    symbols = [actions[action] for action in plan] if known else parse_plan(list(plan), space.domain.facts)
    names = canonical_names(symbols, space.symmetries)
    return tuple(str(renamed(symbol, names)) for symbol in symbols)


def frequency_tables(space: TaskSpace, inside: Sequence[ReportedTask]) -> Iterator[ReportTable]:
    """Yield a table of the frequencies of names, classes and actions beside the expected ones, and one of tests."""
    rows: list[tuple[Value, ...]] = []
    tests: list[tuple[Value, ...]] = []
    for length in sorted({len(task.plan) for task in inside}):
        at, own = space.at(length), [task.plan for task in inside if len(task.plan) == length]
        for feature in FEATURES:
            try:
                found = compare_frequencies(at, own, feature)
            except (QueryError, EngineError):  # too many values, or a limit was reached: no row for this feature
                continue
            rows += [
                (feature, length, found.tasks, each.value, each.observed, float(each.expected), str(each.expected))
                for each in found.frequencies
            ]
            tests.append(_test_row(length, found))
    yield ReportTable(
        "frequencies",
        "Frequencies beside the exact expected ones",
        ("feature", "length", "tasks", "value", "given", "expected", "exact expected"),
        tuple(rows),
        "Expected: the exact expected number in as many uniform samples of the space. Physics, weights and a held-out "
        "part make the frequencies of a dataset differ.",
    )
    yield ReportTable(
        "frequency_tests",
        "Chi-square tests of the frequencies",
        ("feature", "length", "tasks", "chi-square", "degrees of freedom", "p-value", "values expected below 5"),
        tuple(tests),
        "The probability of frequencies at least as far from the expected ones, if the tasks were independent uniform "
        "samples; it is rough if many values are expected fewer than five times.",
    )


def _test_row(length: int, found: FrequencyTest) -> tuple[Value, ...]:
    statistic = found.statistic if isfinite(found.statistic) else None
    small = found.p_value < CERTAIN
    p_value: Value = f"below {CERTAIN:g}" if small else found.p_value
    return found.feature, length, found.tasks, statistic, found.degrees, p_value, found.few
