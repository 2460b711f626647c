"""The class of spatial predicates, which are used for placement, checks, rewards, proofs and captions."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple, Protocol

from prag_asp.physics.predicates.gaps import Demand
from prag_asp.physics.predicates.volume import Volume
from prag_asp.physics.situation import Situation
from prag_asp.scene.forms import Point
from prag_asp.scene.geometry import Quaternion
from prag_asp.scene.scene import Scene

Arguments = tuple[str, ...]


ViolationsFunction = Callable[[Situation, Arguments], Iterator[float]]
"""Yields the amount by which a situation violates each condition of a predicate, or at most 0 if it does not; the
conditions that are cheapest to compute come first."""

WayFunction = Callable[[Situation, Arguments], float]
"""Returns the length of a path to a situation that satisfies a predicate, around obstacles."""

VolumeFunction = Callable[[Situation, Arguments, Quaternion], Volume]
"""Returns a region for the subject of a predicate with a given rotation about z.

It does not depend on the pose of the subject in the situation. A sample from the region satisfies the predicate.
"""

DemandsFunction = Callable[[Scene, Arguments], Iterator[Demand]]
"""Yields constraints on the positions of bodies that a predicate implies; no argument is furniture."""

ImpossibleFunction = Callable[[Scene, Arguments], Iterator[str]]
"""Yields the reasons, in words, why a predicate cannot hold for the given entities of a scene, whatever their poses."""

ExcludesFunction = Callable[[Scene, Arguments, "Predicate", Arguments], str | None]
"""Returns the reason, in words, why a predicate cannot hold together with another, or None if it can."""

NowhereFunction = Callable[[Scene, Arguments, Point, Point], bool]
"""Returns whether a predicate cannot hold while the centre of its subject is over a rectangle.

The rectangle is given by its corners with the lowest and the highest coordinates, which may be infinite.
"""


class SentenceFunction(Protocol):
    """A function that returns a sentence: a predicate holds, or does not hold, for the given entities."""

    def __call__(self, arguments: Arguments, value: bool = True) -> str:
        """Return the sentence."""


class Gripper(Enum):
    """The relation of the gripper given by the first argument to the second argument; `OPEN` has no second argument."""

    HOLDS = "holds"
    AT = "is at"
    OVER = "is over"
    REACHES = "reaches"
    OPEN = "is open"


class Direction(NamedTuple):
    """A direction along an axis of the scene, 0 for x and 1 for y, with the sign 1 or -1."""

    axis: int
    sign: float

    def in_frame(self, frame: str) -> Direction:
        """Return the direction in the frame of the robot; a viewer faces the robot and sees the opposite direction."""
        return self if frame == "robot" else self.opposite

    @property
    def opposite(self) -> Direction:
        """The opposite direction."""
        return Direction(self.axis, -self.sign)


@dataclass(frozen=True, eq=False)
class Predicate:
    """A spatial predicate with all its properties; other modules read these and never test the predicate's name.

    Definition: `violations` returns how far a situation is from satisfying each condition, in metres or radians.
    `subject` is the index of the argument that moves to make the predicate true. `volume` is a region for the gripper
    if `of_gripper`, a range for the joint of furniture if `of_joint`, and otherwise a region for the subject; with
    `turns`, it has ranges of yaws. `inverse` names the predicate that holds for the swapped arguments if this predicate
    holds; a symmetric predicate names itself. With `looks_around`, the violations may depend on bodies that are not
    arguments.

    Words: `sentence` states the predicate, `robot_sentence` does so in scenes with several robots. Captions state
    predicates in the order of `caption_rank`, and those of infinite rank only if there are no others.

    Relations: with `supports`, the last argument carries the subject; with `places`, it is the place where the subject
    rests or is held above; with `rests_on_other`, the subject may stand on or in it. `direction` points from the
    second argument to the subject in the frame of the robot. `apart` holds the smallest and the largest horizontal
    distance between the bounding boxes of the first two arguments, in metres. With `lies_between`, the subject is
    between the two others. `gripper` is the relation of a gripper that the predicate states.

    For rewards: `way` is the length of a path to a situation that satisfies the predicate, if it is longer than the
    distance: fingers, for instance, have to open before they close around an object.

    For the search: with `on_the_spot`, a rotation about z suffices to satisfy the predicate anywhere; with
    `seen_close`, people recognise the relation only between near bodies. A sample from the volume `otherwise` violates
    the predicate. The `tight_volume` has no margin at its border and is used for packing objects.

    For proofs, which have to be valid for all poses of the bodies: `impossible` yields the reasons why the predicate
    can never hold, `demands` its constraints on positions; `excludes` returns the reason why it excludes another
    predicate, and `nowhere` whether it cannot hold over a rectangle.
    """

    name: str
    violations: ViolationsFunction
    volume: VolumeFunction
    sentence: SentenceFunction
    subject: int = 0
    of_gripper: bool = False
    of_joint: bool = False
    inverse: str | None = None
    turns: bool = False
    looks_around: bool = False
    robot_sentence: SentenceFunction | None = None
    caption_rank: float = 0.0
    supports: bool = False
    places: bool = False
    rests_on_other: bool = False
    direction: Direction | None = None
    apart: tuple[float, float] = (0.0, math.inf)
    lies_between: bool = False
    gripper: Gripper | None = None
    way: WayFunction | None = None
    on_the_spot: bool = False
    seen_close: bool = False
    otherwise: VolumeFunction | None = None
    tight_volume: VolumeFunction | None = None
    impossible: ImpossibleFunction | None = None
    demands: DemandsFunction | None = None
    excludes: ExcludesFunction | None = None
    nowhere: NowhereFunction | None = None

    def distance(self, situation: Situation, arguments: Arguments) -> float:
        """Return the distance of a situation from satisfying the predicate: 0 if and only if the predicate holds."""
        return max(0.0, *self.violations(situation, arguments))

    def signed_distance(self, situation: Situation, arguments: Arguments) -> float:
        """Return the largest violation, in metres or radians; it is at most 0 if and only if the predicate holds.

        In that case, the absolute value is the margin. The result changes by at most the distance that the subject
        moves; only the violation of `holding` may change faster, when an edge or a curved side is between the pads.
        """
        return max(self.violations(situation, arguments))

    def signed_way(self, situation: Situation, arguments: Arguments) -> float:
        """Return the signed distance, or the `way` if that is longer and the predicate does not hold."""
        signed = self.signed_distance(situation, arguments)
        if self.way is None or signed <= 0.0:
            return signed
        return max(signed, self.way(situation, arguments))

    def holds(self, situation: Situation, arguments: Arguments) -> bool:
        """Return whether the predicate holds in a situation."""
        for violation in self.violations(situation, arguments):  # noqa: SIM110 (all() is slower here)
            if violation > 0.0:
                return False
        return True


def words(entity: str) -> str:
    """Return an entity's name for use in a sentence: ``apple_1`` becomes ``apple 1``."""
    return entity.replace("_", " ")


def states(text: str) -> SentenceFunction:
    """Return a function that fills in a template: ``{0}`` and ``{1}`` by arguments, ``{is}`` by "is" or "is not"."""

    def sentence(arguments: Arguments, value: bool = True) -> str:
        return text.format(*map(words, arguments), **{"is": "is" if value else "is not"})

    return sentence
