"""The complexity of the tasks in a file or dataset: by their logic, and by the effort of physics."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from prag_asp.cli.terminal import aligned

if TYPE_CHECKING:
    from prag_asp.cli.comparison.compared_tasks import GivenTask
    from prag_asp.dataset.store.dataset import Dataset
    from prag_asp.space.task_space import TaskSpace

FIGURES = {
    "entities": "entities used",
    "undone": "changes undone",
    "bits": "choices, bits",
    "shortest": "shortest plan",
    "shortest_plans": "shortest plans",
    "detour": "detour",
    "restarts": "initial states tried",
    "failed": "failed attempts",
    "seconds": "seconds of the episode",
}
"""The figures, with their names in text."""


def complexities(given: Sequence[GivenTask], dataset: Dataset | None, space: TaskSpace) -> dict[str, Any]:
    """Return the figures of each task; those of physics need a verdict, and `seconds` needs a recording.

    `restarts` is the number of initial states that the search tried, and `causes` counts the failed attempts by cause.

    Raises:
        QueryError: a task is not in the space, or the states of the space are too many to be listed.
        LimitReached: a limit was reached.
    """
    from prag_asp.analysis.complexity import ComplexityMeasure

    measure, seconds = ComplexityMeasure(space), dict[str, float]()
    for entry, _, length in dataset.recorded_seconds() if dataset is not None else ():
        seconds[str(entry.task)] = max(length, seconds.get(str(entry.task), 0.0))
    rows = []
    for record in (each.record for each in given):
        own, verdict, text = measure.of(record.task), record.verdict, str(record.task)
        row: dict[str, Any] = {"task": text, "actions": own.length, "entities": own.entities, "undone": own.undone}
        row |= {"bits": own.bits, "shortest": own.shortest, "shortest_plans": own.shortest_plans, "detour": own.detour}
        if verdict is not None:
            causes = dict(verdict["causes"])
            row |= {"restarts": verdict["restarts"], "failed": sum(causes.values()), "causes": causes}
        rows.append(row | ({"seconds": seconds[text]} if text in seconds else {}))
    return {"tasks": rows}


def complexity_text(found: dict[str, Any]) -> Iterator[str]:
    """Yield the smallest, the mean and the largest value of each figure, and the failed attempts by cause."""
    rows = found["tasks"]
    table = [(f"{len(rows)} tasks" if len(rows) != 1 else "1 task", "min", "mean", "max")]
    for key, name in FIGURES.items():
        values = [row[key] for row in rows if key in row]
        if values:
            spelled = "{:.2f}" if isinstance(values[0], float) else "{}"
            low, high = (spelled.format(value) for value in (min(values), max(values)))
            table.append((name, low, f"{sum(values) / len(values):.2f}", high))
    yield from aligned(table)
    causes = Counter[str]()
    for row in rows:
        causes.update(row.get("causes", {}))
    if causes:
        yield ""
        yield from aligned(
            [("cause", "failed attempts"), *((cause, f"{count}") for cause, count in causes.most_common())]
        )
