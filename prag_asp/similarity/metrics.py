"""The metrics between tasks; to add a metric, add a row to `METRICS`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

from prag_asp.errors import QueryError
from prag_asp.similarity import features
from prag_asp.similarity.background import Background, Trace
from prag_asp.similarity.edit_costs import Cost, class_cost, effect_cost, unit_cost
from prag_asp.similarity.features import Feature
from prag_asp.similarity.measures import (
    EditMeasure,
    Measure,
    MixedMeasure,
    PlaceMeasure,
    SetMeasure,
    StateMeasure,
    StringMeasure,
)
from prag_asp.similarity.string_distances import (
    StringDistance,
    damerau_distance,
    jaro_distance,
    jaro_winkler_distance,
    subsequence_distance,
    substring_distance,
)
from prag_asp.wording import unknown


@dataclass(frozen=True)
class Metric:
    """A way to compare two tasks: `features` extracts the features of a task, and `measure` compares them.

    `axioms` is true if the measure is a metric: zero only for equal features, symmetric, and subject to the triangle
    inequality. Otherwise, it is a dissimilarity. `source` is the publication that defines it.
    """

    name: str
    summary: str
    source: str
    features: Callable[[Trace, Background], Feature]
    measure: Callable[[Background], Measure]
    axioms: bool = True


COMBINED = {
    "levenshtein-classes": Fraction(2, 5),
    "goal": Fraction(3, 10),
    "links": Fraction(1, 5),
    "states": Fraction(1, 10),
}
"""The weights of the parts of the combined similarity: actions, changes, causal links, and states."""


def edits_by(cost: Callable[[Background], Cost]) -> Callable[[Background], Measure]:
    """Return a function that makes an edit distance with the given costs."""
    return lambda background: EditMeasure(cost(background))


def places_by(cost: Callable[[Background], Cost]) -> Callable[[Background], Measure]:
    """Return a function that makes a position-by-position distance with the given costs."""
    return lambda background: PlaceMeasure(cost(background))


def strings_by(function: Callable[[], StringDistance], *, bounded: bool) -> Callable[[Background], Measure]:
    """Return a function that makes a distance between texts."""
    return lambda background: StringMeasure(function(), bounded)


def combined_features(task: Trace, background: Background) -> Feature:
    """Return the features of the parts of the combined metric."""
    return tuple(METRICS[name].features(task, background) for name in COMBINED)


def combined_measure(background: Background) -> Measure:
    """Return the weighted mean of the parts of the combined metric."""
    return MixedMeasure(tuple((weight, METRICS[name].measure(background)) for name, weight in COMBINED.items()))


METRICS = {
    metric.name: metric
    for metric in (
        Metric(
            "combined",
            "Weighted mean of levenshtein-classes (0.4), goal (0.3), links (0.2) and states (0.1), each from 0 to 1",
            "",
            combined_features,
            combined_measure,
        ),
        Metric(
            "levenshtein", "Number of actions to insert, delete or replace",
            "Levenshtein 1966", features.actions, edits_by(unit_cost),
        ),
        Metric(
            "levenshtein-classes", "As levenshtein; replacing an action by one on a similar object costs less",
            "Wagner and Fischer 1974, Rada et al. 1989", features.actions, edits_by(class_cost),
        ),
        Metric(
            "levenshtein-effects", "As levenshtein; replacing an action by one with similar effects costs less",
            "Wagner and Fischer 1974, Jaccard 1901", features.effects, edits_by(effect_cost),
        ),
        Metric(
            "hamming", "Number of positions with different actions, for tasks of the same length",
            "Hamming 1950", features.actions, places_by(unit_cost),
        ),
        Metric(
            "hamming-classes", "As hamming, with the costs of levenshtein-classes",
            "Hamming 1950, Rada et al. 1989", features.actions, places_by(class_cost),
        ),
        Metric(
            "hamming-effects", "As hamming, with the costs of levenshtein-effects",
            "Hamming 1950, Jaccard 1901", features.effects, places_by(effect_cost),
        ),
        Metric(
            "goal", "Facts that only one of the tasks changes from its initial to its final state",
            "Jaccard 1901, Steinhaus (Marczewski and Steinhaus 1958)", features.changes, lambda _: SetMeasure(),
        ),
        Metric(
            "states", "Facts to change, and states to insert or delete, to turn one sequence of states into the other",
            "Waterman, Smith and Beyer 1976", features.states, lambda _: StateMeasure(),
        ),
        Metric(
            "links", "Causal links (an action needs a fact that another made true) that only one of the tasks has",
            "McAllester and Rosenblitt 1991", features.links, lambda _: SetMeasure(),
        ),
        Metric(
            "damerau", "As levenshtein; a swap of two neighbouring actions counts as one edit",
            "Damerau 1964", features.actions, strings_by(damerau_distance, bounded=False),
        ),
        Metric(
            "jaro", "1 less the similarity of Jaro",
            "Jaro 1989", features.actions, strings_by(jaro_distance, bounded=True), axioms=False,
        ),
        Metric(
            "jaro-winkler", "As jaro, with more weight on equal beginnings",
            "Winkler 1990", features.actions, strings_by(jaro_winkler_distance, bounded=True), axioms=False,
        ),
        Metric(
            "subsequence", "Length of the longer task less that of the longest common subsequence of actions",
            "Bakkelund 2009", features.actions, strings_by(subsequence_distance, bounded=False),
        ),
        Metric(
            "substring", "Actions to remove and to add at the ends: both lengths less twice the longest common run",
            "", features.actions, strings_by(lambda: substring_distance, bounded=False),
        ),
    )
}  # fmt: skip
"""All metrics, by name."""


def metric_of(name: str) -> Metric:
    """Return the metric with a given name.

    Raises:
        QueryError: there is no metric with this name.
    """
    if name not in METRICS:
        raise QueryError(unknown(name, tuple(METRICS), "metric"))
    return METRICS[name]
