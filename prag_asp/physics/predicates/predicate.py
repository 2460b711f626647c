"""What a spatial predicate is: one definition that serves placement, checks, rewards, proofs and captions."""

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
    """Yields by how much a situation misses each condition of a predicate, the cheapest first; >0 is a miss."""

    def __call__(self, situation: Situation, arguments: Arguments) -> Iterator[float]:
        """Yield the violations."""


class WayFunction(Protocol):
    """Gives how far there is to go until a predicate holds where it does not, round what bars the shortest way."""

    def __call__(self, situation: Situation, arguments: Arguments) -> float:
        """Return the way."""


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


class DemandsFunction(Protocol):
    """Yields what a predicate demands of the places of bodies wherever it holds; none of them is furniture."""

    def __call__(self, scene: Scene, arguments: Arguments) -> Iterator[Demand]:
        """Yield the demands."""


class ImpossibleFunction(Protocol):
    """Yields in words why a predicate can never hold of some entities of a scene, wherever they are."""

    def __call__(self, scene: Scene, arguments: Arguments) -> Iterator[str]:
        """Yield the reasons."""


class ExcludesFunction(Protocol):
    """Says in words why a predicate cannot hold together with another one, None where it can."""

    def __call__(self, scene: Scene, arguments: Arguments, other: Predicate, others: Arguments) -> str | None:
        """Return the reason."""


class NowhereFunction(Protocol):
    """Tells whether a predicate holds nowhere with the centre of its subject in a rectangle, at any height."""

    def __call__(self, scene: Scene, arguments: Arguments, low: Point, high: Point) -> bool:
        """Tell so; the corners of the rectangle may be infinitely far."""


class Gripper(Enum):
    """What a predicate says that the gripper of its first argument, a robot, does; all but `OPEN` with the second."""

    HOLDS = "holds"
    AT = "is at"
    OVER = "is over"
    REACHES = "reaches"
    OPEN = "is open"


class Direction(NamedTuple):
    """A direction along an axis of the scene, 0 for x and 1 for y, with the sign 1 or -1."""

    axis: int
    sign: float

    def seen(self, frame: str) -> Direction:
        """Return what is this direction to the robot as the frame of the scene sees it: the viewer faces the robot."""
        return self if frame == "robot" else self.opposite

    @property
    def opposite(self) -> Direction:
        """The direction back."""
        return Direction(self.axis, -self.sign)


@dataclass(frozen=True, eq=False)
class Predicate:
    """A spatial predicate, and all that is to be known of it; what another file asks of predicates is asked here.

    `violations` defines it: metres or radians by which a situation misses each of its conditions. `subject`
    is the position of the argument that moves when the predicate is made true; where `of_gripper` is true the
    volume is the gripper's, where `of_joint` is true that of the joint of furniture, otherwise that of the subject.
    `inverse` names the predicate that holds of the two swapped arguments whenever this one does: itself where their
    order does not matter. `turns` is set where the volume has ranges of yaws, `looks_around` where the violations may
    depend on more than the arguments: so those from a Python file may. `sentence` tells it in plain words, or `named`
    where there are several robots. A caption tells first what has the least `told`, and only where nothing else is so
    what has an infinite one.

    What it does to bodies: `supports` is set where the last argument bears the subject, `places` where that is in any
    case the place of the subject, which rests there or is held above, `rests_on_other` where the subject may stand on
    or in it. `direction` is where the subject lies from the second argument, as the robot sees it. `apart` are the
    least and the greatest distance of the bounding boxes of the first two arguments, seen from above, in metres.
    `lies_between` is set where the subject is between the two others, `gripper` says what a robot's gripper does.

    `way` is how far there is to go where that is more than the distance, for the rewards of agents: fingers open before
    they go around something.

    For the search: `on_the_spot` is set where the subject can be turned to satisfy the predicate wherever it is,
    `seen_close` where the relation is seen at a glance only if the bodies are close to each other. What is drawn from
    `otherwise` does not satisfy the predicate.

    For proofs, each of which goes for all poses of the bodies: why it is `impossible`, what it `demands` of places, why
    it `excludes` others, and whether it is so `nowhere` in a region.
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
    named: SentenceFunction | None = None
    told: float = 0.0
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
        """Return how far a situation is from satisfying the predicate, 0 exactly where it holds."""
        return max(0.0, *self.violations(situation, arguments))

    def signed_distance(self, situation: Situation, arguments: Arguments) -> float:
        """Return how far a situation is from satisfying the predicate; where it holds, minus what it has to spare.

        It is at most 0 exactly where the predicate holds, in metres or, where that is missed more, in radians. It
        changes by at most as much as the subject moves.
        """
        return max(self.violations(situation, arguments))

    def signed_way(self, situation: Situation, arguments: Arguments) -> float:
        """Return how far there is to go until the predicate holds: the signed distance, or its `way` if longer.

        So it is at most 0 exactly where the predicate holds, whatever its way says.
        """
        signed = self.signed_distance(situation, arguments)
        if self.way is None or signed <= 0.0:
            return signed
        return max(signed, self.way(situation, arguments))

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
