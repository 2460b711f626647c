"""The distance between two tasks, minimised over renamings, and its explanation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

from prag_asp.similarity.background import Background, Trace, UpTo
from prag_asp.similarity.edits import Edit
from prag_asp.similarity.features import Feature
from prag_asp.similarity.measures import Distance, Measure, MixedMeasure
from prag_asp.similarity.metrics import COMBINED, METRICS, Metric, metric_of
from prag_asp.similarity.symbols import entities_in, renamer


@dataclass(frozen=True)
class TaskComparison:
    """Two tasks compared by a metric, with the entities of the second renamed so that the distance is minimal.

    `renaming` maps the entities of the second task that change their names to the new ones. `distance` is in the
    metric's own unit; `normalised` lies between 0 and 1.
    """

    metric: Metric
    background: Background = field(repr=False)
    measure: Measure = field(repr=False)
    one: Feature
    other: Feature
    renaming: Mapping[str, str]
    distance: Distance

    @cached_property
    def normalised(self) -> Distance:
        """The distance between 0 and 1."""
        return self.measure.normalised(self.one, self.other)

    @property
    def similarity(self) -> float:
        """1 minus the normalised distance."""
        return float(1 - self.normalised)

    @property
    def parts(self) -> Mapping[str, TaskComparison]:
        """The parts of a mixture, by name, under the same renaming; empty for any other metric."""
        if not isinstance(self.measure, MixedMeasure):
            return {}
        parts = zip(COMBINED, self.measure.parts, self.one, self.other, strict=True)
        return {
            name: TaskComparison(
                METRICS[name], self.background, measure, one, other, self.renaming, measure.distance(one, other)
            )
            for name, (_, measure), one, other in parts
        }

    @property
    def edits(self) -> tuple[Edit, ...]:
        """The edits that turn the first task into the renamed second one."""
        return self.measure.edits(self.one, self.other)


def compare(
    one: Trace,
    other: Trace,
    metric: str | Metric = "combined",
    background: Background | None = None,
    up_to: UpTo = "names",
) -> TaskComparison:
    """Compare two tasks by a metric; `up_to` selects the interchangeable entities if there is no background.

    Raises:
        QueryError: there is no such metric, the metric cannot compare these tasks, or an entity has different classes
            in them.
        SimilarityMissingError: the metric needs rapidfuzz, which is not installed.
    """
    found = metric if isinstance(metric, Metric) else metric_of(metric)
    known = Background.of_tasks((one, other), up_to) if background is None else background
    measure, entities = found.measure(known), known.interchange.entities
    first, second = (found.features(task, known) for task in (one, other))
    best: TaskComparison | None = None
    mentioned, fixed = (tuple(entities_in(each, entities)) for each in (second, first))
    for names in known.interchange.renamings(mentioned, fixed):
        renamed = renamer(names)(second)
        distance = measure.distance(first, renamed)
        if best is None or distance < best.distance:
            best = TaskComparison(found, known, measure, first, renamed, names, distance)
        if not distance:
            break
    assert best is not None, "there is always the renaming that changes nothing"
    return best
