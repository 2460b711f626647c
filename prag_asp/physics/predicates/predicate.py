"""What a spatial predicate is: one definition that serves placement, checks, rewards and captions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

from prag_asp.physics.predicates.volume import Volume
from prag_asp.physics.situation import Situation
from prag_asp.scene.geometry import Quaternion

Arguments = tuple[str, ...]


class ViolationsFunction(Protocol):
    """Yields by how much a situation misses each condition of a predicate, the cheapest first; >0 is a miss."""

    def __call__(self, situation: Situation, arguments: Arguments) -> Iterator[float]:
        """Yield the violations."""


class VolumeFunction(Protocol):
    """Gives the region of a predicate's subject, which is turned by a rotation about z.

    The subject's own place in the situation is not read. What is drawn from the region satisfies the predicate.
    """

    def __call__(self, situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
        """Return the volume."""


class SentenceFunction(Protocol):
    """Says in plain words that a predicate holds of some entities, or that it does not."""

    def __call__(self, arguments: Arguments, value: bool = True) -> str:
        """Return the sentence."""


@dataclass(frozen=True, eq=False)
class Predicate:
    """A spatial predicate.

    `violations` defines it: metres or radians by which a situation misses each of its conditions. `subject`
    is the position of the argument that moves when the predicate is made true; where `of_gripper` is true the
    volume is the gripper's, otherwise that of the subject. `inverse` names the predicate that holds of the
    two swapped arguments whenever this one does: itself where their order does not matter. `turns` is set where the
    volume has ranges of yaws, `rests_on_other` where the subject may stand on or in its last argument, `looks_around`
    where the violations may depend on more than the arguments: so those from a Python file may.
    """

    name: str
    violations: ViolationsFunction
    volume: VolumeFunction
    sentence: SentenceFunction
    subject: int = 0
    of_gripper: bool = False
    inverse: str | None = None
    turns: bool = False
    rests_on_other: bool = False
    looks_around: bool = False

    def distance(self, situation: Situation, arguments: Arguments) -> float:
        """Return how far a situation is from satisfying the predicate, 0 exactly where it holds."""
        return max(0.0, *self.violations(situation, arguments))

    def holds(self, situation: Situation, arguments: Arguments) -> bool:
        """Check the predicate on a situation; the first violation ends the check."""
        for violation in self.violations(situation, arguments):  # noqa: SIM110 (all() is slower here)
            if violation > 0.0:
                return False
        return True


def words(entity: str) -> str:
    """Return an entity's name as it reads in a sentence: ``apple_1`` is ``apple 1``."""
    return entity.replace("_", " ")


def states(text: str) -> SentenceFunction:
    """Return a sentence of the arguments ``{0}``, ``{1}`` and of ``{is}``: is, or is not where false."""

    def sentence(arguments: Arguments, value: bool = True) -> str:
        return text.format(*map(words, arguments), **{"is": "is" if value else "is not"})

    return sentence
