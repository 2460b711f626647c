"""The type of spatial predicates: one definition serves placement, checks, rewards, proofs and captions."""

from __future__ import annotations

import math
from collections.abc import Iterator
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


class ViolationsFunction(Protocol):
    """Yields by how much a situation violates each condition of a predicate, in order of cost; > 0 is a violation."""

    def __call__(self, situation: Situation, arguments: Arguments) -> Iterator[float]:
        """Yield the violations."""


class WayFunction(Protocol):
    """Returns the length of the way to a situation that satisfies a predicate, around what bars the direct way."""

    def __call__(self, situation: Situation, arguments: Arguments) -> float:
        """Return the way."""


class VolumeFunction(Protocol):
    """Returns the region of a predicate's subject, which is rotated about z.

    The subject's own pose in the situation is not read. A sample of the region satisfies the predicate.
    """

    def __call__(self, situation: Situation, arguments: Arguments, quaternion: Quaternion) -> Volume:
        """Return the volume."""


class SentenceFunction(Protocol):
    """Returns a sentence which says that a predicate holds of some entities, or does not."""

    def __call__(self, arguments: Arguments, value: bool = True) -> str:
        """Return the sentence."""


class DemandsFunction(Protocol):
    """Yields the constraints on the positions of bodies that a predicate implies; none of them is furniture."""

    def __call__(self, scene: Scene, arguments: Arguments) -> Iterator[Demand]:
        """Yield the demands."""


class ImpossibleFunction(Protocol):
    """Yields the reasons, in words, why a predicate can never hold of some entities of a scene, in any pose."""

    def __call__(self, scene: Scene, arguments: Arguments) -> Iterator[str]:
        """Yield the reasons."""


class ExcludesFunction(Protocol):
    """Returns the reason, in words, why a predicate cannot hold together with another, None if it can."""

    def __call__(self, scene: Scene, arguments: Arguments, other: Predicate, others: Arguments) -> str | None:
        """Return the reason."""


class NowhereFunction(Protocol):
    """Returns whether a predicate cannot hold with the centre of its subject in a rectangle, at any height."""

    def __call__(self, scene: Scene, arguments: Arguments, low: Point, high: Point) -> bool:
        """Return the answer; the corners of the rectangle may be at infinity."""


class Gripper(Enum):
    """What a predicate says about the gripper of its first argument, a robot; all but `OPEN` concern the second one."""

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
        """Return the direction for the robot of what this is in a frame of the scene: a viewer faces the robot."""
        return self if frame == "robot" else self.opposite

    @property
    def opposite(self) -> Direction:
        """The opposite direction."""
        return Direction(self.axis, -self.sign)


@dataclass(frozen=True, eq=False)
class Predicate:
    """A spatial predicate with all its properties: other modules read these, and never test for its name.

    `violations` defines it: metres or radians by which a situation violates each of its conditions. `subject` is the
    position of the argument that moves when the predicate is made true. The volume is that of the gripper if
    `of_gripper`, that of the joint of furniture if `of_joint`, otherwise that of the subject. `inverse` names the
    predicate that holds of the swapped arguments whenever this one holds: itself for a symmetric predicate. `turns`
    means that the volume has ranges of yaws, `looks_around` that the violations may depend on more than the arguments,
    as those from a Python file may. `sentence` says it in plain words, `robot_sentence` in scenes with several robots.
    Captions state predicates in the order of `caption_rank`, and those of infinite rank only if there are no others.

    Support: `supports` means that the last argument bears the subject, `places` that it is the place of the subject,
    which rests there or is held above, `rests_on_other` that the subject may stand on or in it. `direction` is the
    direction of the subject from the second argument, as the robot sees it. `apart` are the least and the greatest
    distance between the bounding boxes of the first two arguments, seen from above, in metres. `lies_between` means
    that the subject is between the two others. `gripper` is what the predicate says about a robot's gripper.

    For rewards: `way` is the length of the way to a situation that satisfies the predicate, where it is more than the
    distance, because fingers have to open before they close around an object.

    For the search: `on_the_spot` means that the subject can satisfy the predicate in any place by a rotation about z,
    `seen_close` that people recognise the relation only if the bodies are close to each other. A sample of the volume
    `otherwise` does not satisfy the predicate.

    For proofs, each of which has to hold for all poses of the bodies: why it is `impossible`, what it `demands` of
    positions, why it `excludes` others, and whether it holds `nowhere` in a region.
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
    impossible: ImpossibleFunction | None = None
    demands: DemandsFunction | None = None
    excludes: ExcludesFunction | None = None
    nowhere: NowhereFunction | None = None

    def distance(self, situation: Situation, arguments: Arguments) -> float:
        """Return how far a situation is from satisfying the predicate; it is 0 if and only if the predicate holds."""
        return max(0.0, *self.violations(situation, arguments))

    def signed_distance(self, situation: Situation, arguments: Arguments) -> float:
        """Return the signed distance of a situation to satisfying the predicate: minus the margin where it holds.

        It is at most 0 if and only if the predicate holds. The unit is that of the largest violation, metres or
        radians. It changes by at most as much as the subject moves.
        """
        return max(self.violations(situation, arguments))

    def signed_way(self, situation: Situation, arguments: Arguments) -> float:
        """Return the length of the way until the predicate holds: the signed distance, or `way` if that is longer.

        So it is at most 0 if and only if the predicate holds, whatever `way` returns.
        """
        signed = self.signed_distance(situation, arguments)
        if self.way is None or signed <= 0.0:
            return signed
        return max(signed, self.way(situation, arguments))

    def holds(self, situation: Situation, arguments: Arguments) -> bool:
        """Return whether the predicate holds in a situation; the first violation ends the check."""
        for violation in self.violations(situation, arguments):  # noqa: SIM110 (all() is slower here)
            if violation > 0.0:
                return False
        return True


def words(entity: str) -> str:
    """Return an entity's name for a sentence: ``apple_1`` becomes ``apple 1``."""
    return entity.replace("_", " ")


def states(text: str) -> SentenceFunction:
    """Return a function that fills a template with the arguments ``{0}``, ``{1}`` and with ``{is}``: is, or is not."""

    def sentence(arguments: Arguments, value: bool = True) -> str:
        return text.format(*map(words, arguments), **{"is": "is" if value else "is not"})

    return sentence
