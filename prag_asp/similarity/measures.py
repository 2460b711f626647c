"""Kinds of distances between two features: by edits, by position, by common elements, by strings, and mixtures.

Every measure also has a normalised value between 0 and 1. For a metric d, it is the Steinhaus transform with respect to
the empty feature, 2 d(x, y) / (d(x, 0) + d(y, 0) + d(x, y)), which is also a metric (Deza and Deza 2009). For sets, it
is the Jaccard distance; for the Levenshtein distance, it is the normalised metric of Yujian and Bo (2007).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Protocol

from prag_asp.similarity.edit_costs import Cost, state_cost
from prag_asp.similarity.edits import Edit, check_lengths, edit_distance, least_edits, replacements
from prag_asp.similarity.features import Feature
from prag_asp.similarity.string_distances import StringDistance, spelled

if TYPE_CHECKING:
    from prag_asp.similarity.distance_tables import DistanceTable

Distance = Fraction | float
"""A distance, which is exact if it is a fraction."""


class Measure(Protocol):
    """A way to compare two features."""

    def distance(self, one: Feature, other: Feature) -> Distance:
        """Return the distance between two features."""
        ...

    def normalised(self, one: Feature, other: Feature) -> Distance:
        """Return the normalised distance between two features, from 0 to 1."""
        ...

    def edits(self, one: Feature, other: Feature) -> tuple[Edit, ...]:
        """Return edits that explain the distance."""
        ...

    def table(self, features: Sequence[Feature]) -> DistanceTable:
        """Return the distances between all pairs of features, to be computed in blocks."""
        ...


def steinhaus(distance: Distance, one: Distance, other: Distance) -> Distance:
    """Return the Steinhaus transform of a distance, given the distances of both features from the empty feature."""
    return 2 * distance / (one + other + distance) if distance else Fraction(0)


@dataclass(frozen=True)
class EditMeasure:
    """The smallest total cost of insertions, deletions and replacements."""

    cost: Cost

    def distance(self, one: Feature, other: Feature) -> Fraction:
        """Return the edit distance."""
        return edit_distance(one, other, self.cost)

    def normalised(self, one: Feature, other: Feature) -> Distance:
        """Return the Steinhaus transform."""
        sizes = (sum((self.cost(symbol, None) for symbol in each), Fraction(0)) for each in (one, other))
        return steinhaus(self.distance(one, other), *sizes)

    def edits(self, one: Feature, other: Feature) -> tuple[Edit, ...]:
        """Return edits of smallest total cost."""
        return least_edits(one, other, self.cost)

    def table(self, features: Sequence[Feature]) -> DistanceTable:
        """Return the distances between all pairs of features."""
        from prag_asp.similarity.distance_tables import EditTable  # noqa: PLC0415 - a pair needs no arrays

        return EditTable.of(features, self.cost)


@dataclass(frozen=True)
class StateMeasure(EditMeasure):
    """The smallest cost of edits between sequences of states, which are too many for a table of all costs."""

    cost: Cost = state_cost

    def table(self, features: Sequence[Feature]) -> DistanceTable:
        """Return the distances between all pairs of features."""
        from prag_asp.similarity.distance_tables import StateTable  # noqa: PLC0415 - a pair needs no arrays

        return StateTable.of(features)


@dataclass(frozen=True)
class PlaceMeasure:
    """The total cost of replacements at each position, for sequences of the same length (Hamming 1950)."""

    cost: Cost

    def distance(self, one: Feature, other: Feature) -> Fraction:
        """Return the sum of the costs.

        Raises:
            QueryError: the lengths differ.
        """
        return sum((edit.cost for edit in self.edits(one, other)), Fraction(0))

    def normalised(self, one: Feature, other: Feature) -> Distance:
        """Return the mean cost per position; no replacement costs more than 1."""
        return self.distance(one, other) / max(len(one), 1)

    def edits(self, one: Feature, other: Feature) -> tuple[Edit, ...]:
        """Return the replacements."""
        check_lengths({len(one), len(other)})
        return replacements(one, other, self.cost)

    def table(self, features: Sequence[Feature]) -> DistanceTable:
        """Return the distances between all pairs of features."""
        from prag_asp.similarity.distance_tables import PlaceTable  # noqa: PLC0415 - a pair needs no arrays

        return PlaceTable.of(features, self.cost)


@dataclass(frozen=True)
class SetMeasure:
    """The number of elements that only one of two sets has (symmetric difference)."""

    def distance(self, one: Feature, other: Feature) -> Fraction:
        """Return the size of the symmetric difference."""
        return Fraction(len({*one} ^ {*other}))

    def normalised(self, one: Feature, other: Feature) -> Distance:
        """Return the Jaccard distance."""
        union = len({*one} | {*other})
        return self.distance(one, other) / union if union else Fraction(0)

    def edits(self, one: Feature, other: Feature) -> tuple[Edit, ...]:
        """Return the elements that are in only one of the sets, beginning with those of the first."""
        lost, gained = ({*one} - {*other}, {*other} - {*one})
        return (
            *(Edit(0, each, None, Fraction(1)) for each in sorted(lost, key=str)),
            *(Edit(0, None, each, Fraction(1)) for each in sorted(gained, key=str)),
        )

    def table(self, features: Sequence[Feature]) -> DistanceTable:
        """Return the distances between all pairs of features."""
        from prag_asp.similarity.distance_tables import SetTable  # noqa: PLC0415 - a pair needs no arrays

        return SetTable.of(features)


@dataclass(frozen=True)
class StringMeasure:
    """A distance between texts: between 0 and 1 if `bounded`, and otherwise a number of edits."""

    function: StringDistance
    bounded: bool

    def distance(self, one: Feature, other: Feature) -> Distance:
        """Return the distance between the texts; a number of edits is exact."""
        value = self.function(*spelled(one, other))
        return value if self.bounded else Fraction(int(value))

    def normalised(self, one: Feature, other: Feature) -> Distance:
        """Return the distance itself, or the Steinhaus transform of a number of edits."""
        distance = self.distance(one, other)
        return distance if self.bounded else steinhaus(distance, len(one), len(other))

    def edits(self, one: Feature, other: Feature) -> tuple[Edit, ...]:
        """Return nothing, because no unique edits explain these distances."""
        return ()

    def table(self, features: Sequence[Feature]) -> DistanceTable:
        """Return the distances between all pairs of features."""
        from prag_asp.similarity.distance_tables import StringTable  # noqa: PLC0415 - a pair needs no arrays

        return StringTable.of(features, self.function, bounded=self.bounded)


@dataclass(frozen=True)
class MixedMeasure:
    """The weighted mean of the normalised distances of several features; the weights add up to 1."""

    parts: tuple[tuple[Fraction, Measure], ...]

    def distance(self, one: Feature, other: Feature) -> Distance:
        """Return the weighted mean."""
        weighted = zip(self.parts, one, other, strict=True)
        return sum((w * measure.normalised(*pair) for (w, measure), *pair in weighted), Fraction(0))

    def normalised(self, one: Feature, other: Feature) -> Distance:
        """Return the distance, which lies between 0 and 1."""
        return self.distance(one, other)

    def edits(self, one: Feature, other: Feature) -> tuple[Edit, ...]:
        """Return the edits of the first part."""
        return self.parts[0][1].edits(one[0], other[0])

    def table(self, features: Sequence[Feature]) -> DistanceTable:
        """Return the distances between all pairs of features."""
        from prag_asp.similarity.distance_tables import MixedTable  # noqa: PLC0415 - a pair needs no arrays

        tables = [measure.table([each[at] for each in features]) for at, (_, measure) in enumerate(self.parts)]
        return MixedTable(tuple((float(w), table) for (w, _), table in zip(self.parts, tables, strict=True)))
