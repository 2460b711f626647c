"""Tables of the tasks themselves: all tasks, their complexity, their distances and a map."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from random import Random

import numpy as np

from prag_asp.analysis.complexity import ComplexityMeasure
from prag_asp.analysis.distance_matrix import SimilarityMatrix, similarity_matrix
from prag_asp.analysis.plots.task_scaling import task_map
from prag_asp.errors import MissingError, PragError, QueryError
from prag_asp.processes.progress_events import counted, stage
from prag_asp.report.report_table import ReportTable, Value
from prag_asp.report.source import ReportedTask, ReportSource

SAMPLE = 1_000
"""The default number of tasks whose pairs are compared: half a million distances take a few seconds."""

MEASURED = 200
"""The maximum number of tasks whose shortest plans are searched for."""

BINS = 40
"""The number of bars of the histogram of distances."""


def task_table(source: ReportSource) -> ReportTable:
    """Return all tasks."""
    rows = tuple(
        (task.number, task.part, len(task.plan), len(task.entities), " ".join(task.plan), task.instruction)
        for task in source.tasks
    )
    return ReportTable("tasks", "Tasks", ("task", "part", "length", "entities", "plan", "instruction"), rows)


def complexity_table(source: ReportSource) -> ReportTable:
    """Return the number of tasks with each length and number of entities."""
    found = Counter((len(task.plan), len(task.entities), task.part) for task in source.tasks)
    return ReportTable(
        "complexity", "Complexity of the tasks", ("length", "entities", "part", "tasks"),
        tuple((*key, count) for key, count in sorted(found.items())),
        "Entities: the number of different entities that the actions of a task name.",
    )  # fmt: skip


def difficulty_tables(source: ReportSource, seed: int = 0) -> Iterator[ReportTable]:
    """Yield the complexity of tasks according to the logic of their space: choices, detours, changes that are undone.

    If there are more than `MEASURED` tasks, they are sampled uniformly with the seed. Without a space, there is no
    table; if its states are too many to be listed, the table has only a note.
    """
    space = source.space
    known = [each for each in source.tasks if each.task is not None]
    if space is None or not known:
        return
    stage("measuring complexity")
    chosen = chosen_tasks(known, MEASURED, seed)
    measures = {length: ComplexityMeasure(space.at(length)) for length in {len(each.plan) for each in chosen}}
    title = "Complexity by the logic of the space"
    columns = ("task", "length", "bits of choices", "shortest plan", "detour", "shortest plans", "changes undone")
    rows: list[tuple[Value, ...]] = []
    try:
        for each in counted(chosen, "tasks"):
            assert each.task is not None, "only tasks with states are chosen"
            found = measures[len(each.plan)].of(each.task)
            bits = round(found.bits, 6)
            rows.append(
                (each.number, found.length, bits, found.shortest, found.detour, found.shortest_plans, found.undone)
            )
    except PragError as error:  # too many states, a nondeterministic step, or older encodings in a dataset
        yield ReportTable("difficulty", title, columns, (), str(error))
        return
    yield ReportTable(
        "difficulty", title, columns, tuple(rows),
        f"Of {sample_text(len(chosen), len(known), seed)}. Detour: actions beyond a shortest plan to the same goal. "
        "Bits: the sum of log2 of the number of alternatives to each action, including itself.",
    )  # fmt: skip


def sample_text(chosen: int, whole: int, seed: int) -> str:
    """Return a phrase for the number of chosen tasks and their total."""
    if chosen == whole:
        return f"all {whole:,} tasks"
    return f"{chosen:,} of {whole:,} tasks, sampled uniformly with seed {seed}"


def chosen_tasks(tasks: Sequence[ReportedTask], count: int, seed: int) -> list[ReportedTask]:
    """Return at most `count` tasks, in order: all of them, or a uniform sample without replacement."""
    if len(tasks) <= count:
        return list(tasks)
    return [tasks[place] for place in sorted(Random(seed).sample(range(len(tasks)), count))]


def similarity_tables(source: ReportSource, sample: int = SAMPLE, seed: int = 0) -> Iterator[ReportTable]:
    """Yield the histogram of the distances between all pairs of tasks, and a map of the tasks in two dimensions.

    If there are more than `sample` tasks, they are sampled uniformly with the seed. If the tasks have no states, there
    are no tables.
    """
    known = [each for each in source.tasks if each.task is not None]
    chosen = chosen_tasks(known, sample, seed)
    if len(chosen) < 2:
        return
    stage("comparing tasks")
    try:
        matrix = similarity_matrix([each.task for each in chosen if each.task is not None], within=source.space)
    except (MissingError, QueryError) as error:
        yield ReportTable("distances", "Distances of pairs of tasks", ("distance from", "to", "pairs"), (), str(error))
        return
    of = sample_text(len(chosen), len(known), seed)
    yield _histogram(matrix, of)
    placed = task_map(matrix.distances)
    rows = tuple(
        (task.number, task.part, len(task.plan), round(float(across), 5), round(float(up), 5))
        for task, (across, up) in zip(chosen, placed.points, strict=True)
    )
    yield ReportTable(
        "map", "Map of the tasks", ("task", "part", "length", "x", "y"), rows,
        f"Classical scaling (Torgerson 1952) of the distances of {of}: near points are similar tasks. "
        f"The two axes show {placed.share:.0%} of the variance.",
    )  # fmt: skip


def _histogram(matrix: SimilarityMatrix, of: str) -> ReportTable:
    """Return the number of pairs with a distance in each of `BINS` intervals of equal width."""
    first, second = np.triu_indices(matrix.count, 1)
    values = matrix.units[first, second].astype(np.float64) / float(matrix.denominator or 1)
    most = float(values.max())
    counts, edges = np.histogram(values, BINS, (0.0, most if most > 0 else 1.0))
    rows: list[tuple[Value, ...]] = [
        (round(float(low), 6), round(float(high), 6), int(count))
        for low, high, count in zip(edges[:-1], edges[1:], counts, strict=True)
    ]
    note = (
        f"Metric combined, up to renaming, of {of}; 0 is equal, 1 has nothing in common. "
        f"The mean distance is {values.mean():.4f}, and {int((values == 0).sum()):,} pairs are equal."
    )
    return ReportTable("distances", "Distances of pairs of tasks", ("distance from", "to", "pairs"), tuple(rows), note)
