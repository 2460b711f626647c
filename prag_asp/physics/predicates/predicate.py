"""What a spatial predicate is: one definition that serves placement, checks, rewards and captions."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from prag_asp.physics.geometry import Vector, wrap
from prag_asp.physics.situation import Situation

Arguments = tuple[str, ...]


@dataclass(frozen=True)
class Volume:
    """Where the subject of a predicate may be: a box for its centre, a range of yaws, a range of openings.

    The box bounds what is allowed, so a place drawn from it still has to pass the check. Metres and radians;
    the box is aligned with the world's axes and infinite where the predicate does not care.
    """

    low: Vector = (-math.inf, -math.inf, -math.inf)
    high: Vector = (math.inf, math.inf, math.inf)
    yaw: tuple[float, float] | None = None
    width: tuple[float, float] = (0.0, math.inf)

    @property
    def empty(self) -> bool:
        """Tell whether nothing is left."""
        return (
            any(low > high for low, high in zip(self.low, self.high, strict=True))
            or self.width[0] > self.width[1]
        )

    def meet(self, other: Volume) -> Volume:
        """Return what both volumes allow; of two ranges of yaws the part of the first within the second."""
        low = tuple(map(max, self.low, other.low))
        high = tuple(map(min, self.high, other.high))
        return Volume(
            (low[0], low[1], low[2]),
            (high[0], high[1], high[2]),
            _meet_yaws(self.yaw, other.yaw),
            (max(self.width[0], other.width[0]), min(self.width[1], other.width[1])),
        )


class VolumeFunction(Protocol):
    """Gives the volume of a predicate's subject, whose world bounding box has the half sides `half`."""

    def __call__(self, situation: Situation, arguments: Arguments, half: Vector) -> Volume:
        """Return the volume."""


class SentenceFunction(Protocol):
    """Says in plain words that a predicate holds of some entities, or that it does not."""

    def __call__(self, arguments: Arguments, value: bool = True) -> str:
        """Return the sentence."""


@dataclass(frozen=True, eq=False)
class Predicate:
    """A spatial predicate.

    `subject` is the position of the argument that moves when the predicate is made true; where `of_gripper`
    is true the volume is the gripper's, otherwise that of the subject. `distance` is how far a situation is
    from satisfying it, in metres or radians, and 0 exactly where it holds. `inverse` names the predicate that
    holds of the swapped arguments whenever this one does.
    """

    name: str
    distance: Callable[[Situation, Arguments], float]
    volume: VolumeFunction
    sentence: SentenceFunction
    subject: int = 0
    of_gripper: bool = False
    inverse: str | None = None

    def holds(self, situation: Situation, arguments: Arguments) -> bool:
        """Check the predicate on a situation."""
        return self.distance(situation, arguments) == 0.0


def words(entity: str) -> str:
    """Return an entity's name as it reads in a sentence: ``apple_1`` is ``apple 1``."""
    return entity.replace("_", " ")


def states(text: str) -> SentenceFunction:
    """Return a sentence of the arguments ``{0}``, ``{1}`` and of ``{is}``: is, or is not where false."""

    def sentence(arguments: Arguments, value: bool = True) -> str:
        return text.format(*map(words, arguments), **{"is": "is" if value else "is not"})

    return sentence


def excess(*amounts: float) -> float:
    """Return the largest of several violations, 0 where there is none."""
    return max(0.0, *amounts)


def _meet_yaws(
    first: tuple[float, float] | None, second: tuple[float, float] | None
) -> tuple[float, float] | None:
    """Return the common part of two ranges of yaws, each a centre and a half width in radians."""
    if first is None or second is None:
        return first or second
    offset = wrap(second[0] - first[0])
    low, high = max(-first[1], offset - second[1]), min(first[1], offset + second[1])
    return (first[0] + (low + high) / 2, (high - low) / 2)
