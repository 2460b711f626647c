"""The contacts that a task intends, and the unintended contacts in an episode.

The check covers the contacts of robots and of moved bodies, which are the bodies that a finger touches and the bodies
that rest on these. A task intends contacts between

- the fingers of a gripper and the object that it holds, grasps, releases or is at, before or after the action, or the
  furniture that the action opens or closes;
- a moved body and its support, or a moved body and a body that rests on it, in the state before the action or after it;
- two bodies that rest on moved bodies.

Any other contact is a fault if its force exceeds `GENTLE`. An intended contact is a fault if it is deeper than
`DEEPEST` or its force exceeds a bound for the object that the robot moves: `FIRM` plus `FACTOR` times its weight.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import chain
from typing import NamedTuple

from prag_asp.physics.predicates import Gripper
from prag_asp.physics.predicates.grip_friction import GRAVITY
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import PhysicalTask
from prag_asp.physics.witness import ROBOT_PARTS
from prag_asp.physics.world.support import TABLE, contacts
from prag_asp.scene.scene import Scene
from prag_asp.scene.solids import weight

GENTLE = 1.0
"""The largest force of an unintended contact, in newtons."""

FIRM, FACTOR = 20.0, 10.0
"""The largest force of an intended contact: a number of newtons, plus a multiple of the weight of the moved object.

A stiff arm that puts down 50 g a millimetre too low presses with 25 N; heavy objects press with their weight alone.
"""

DEEPEST = 0.002
"""The largest depth of an intended contact, in metres."""

ARM, *FINGERS = ROBOT_PARTS
BOARD = "table"
Pair = tuple[str, str]


class Touch(NamedTuple):
    """A contact of two bodies in a frame, with the largest force (newtons) and depth (metres) since the previous frame.

    The depth is 0 if it is unknown, as in recordings.
    """

    frame: int
    one: str
    two: str
    force: float
    depth: float = 0.0

    def sentence(self) -> str:
        """Return a sentence that describes the contact."""
        deep = f", {1000 * self.depth:.1f} mm deep" if self.depth > DEEPEST else ""
        return f"{_named(self.one)} presses on {_named(self.two)} with {self.force:.1f} N{deep}"


@dataclass(frozen=True)
class IntendedContacts:
    """The contacts that a task intends during an action.

    `handled` are the bodies that the fingers of each robot may touch; `resting` are pairs of bodies of which the first
    rests on the second before the action or after it.
    """

    handled: Mapping[str, frozenset[str]]
    resting: frozenset[Pair]


def intended_contacts(physical: PhysicalTask, number: int, *around: Situation) -> IntendedContacts:
    """Return the contacts that a task intends during an action, given by its number from 1, or before action 1, for 0.

    `around` are the situations before and after the action.
    """
    states = physical.states[max(0, number - 1) : number + 1]
    effect = physical.effects[number - 1] if number else None
    handled = {}
    for robot in around[0].scene.robots:
        at_hand = (
            fact
            for fact in chain.from_iterable(states)
            if fact.value and fact.predicate.gripper in (Gripper.HOLDS, Gripper.AT) and fact.arguments[0] == robot
        )
        bodies: set[str | None] = {fact.arguments[1] for fact in at_hand}
        if effect is not None and effect.robot in (None, robot):
            bodies |= {effect.grasps, effect.releases, effect.holds, effect.visits, *effect.turns}
        handled[robot] = frozenset(body for body in bodies if body is not None)
    resting = {
        (entity, BOARD if contact.support == TABLE else contact.support)
        for situation in around
        for entity in situation.poses
        for contact in contacts(situation, entity, situation.poses)
    }
    return IntendedContacts(handled, frozenset(resting))


def unintended_contacts(touches: Iterable[Touch], intended: IntendedContacts) -> list[Touch]:
    """Return the strongest unintended contact of each pair of bodies during an action."""
    handled = handled_contacts(touches, intended)
    return _strongest(each.touch for each in handled if not each.intended and each.touch.force > GENTLE)


def excessive_contacts(touches: Iterable[Touch], intended: IntendedContacts, scene: Scene) -> list[Touch]:
    """Return the strongest excessive contact of each pair of bodies: intended, but too strong or too deep."""
    excessive = []
    for touch, is_intended, moved in handled_contacts(touches, intended):
        heaviest = max((weight(scene, entity) for entity in moved if entity in scene.shapes), default=0.0)
        if is_intended and (touch.force > FIRM + FACTOR * GRAVITY * heaviest or touch.depth > DEEPEST):
            excessive.append(touch)
    return _strongest(excessive)


class HandledContact(NamedTuple):
    """A contact of a robot or a moved body, whether the task intends it, and which of the two bodies are `moved`."""

    touch: Touch
    intended: bool
    moved: frozenset[str]


def handled_contacts(touches: Iterable[Touch], intended: IntendedContacts) -> Iterator[HandledContact]:
    """Yield the contacts of robots and of moved bodies: the bodies that fingers touch, and those that rest on them."""
    frames: dict[int, list[Touch]] = {}
    for touch in touches:
        frames.setdefault(touch.frame, []).append(touch)
    for together in frames.values():
        pairs = [pair for touch in together for pair in ((touch.one, touch.two), (touch.two, touch.one))]
        touched = {two for one, two in pairs if _part(one)[0] in FINGERS and not _part(two)[0]} - {BOARD}
        moved = set(touched)
        while more := {upper for upper, lower in intended.resting if lower in moved} - moved:
            moved |= more
        for touch in together:
            pair = (touch.one, touch.two)
            if any(_part(body)[0] for body in pair) or not moved.isdisjoint(pair):
                is_intended = _is_intended(pair, touched, moved, intended)
                yield HandledContact(touch, is_intended, frozenset(moved.intersection(pair)))


def _strongest(touches: Iterable[Touch]) -> list[Touch]:
    """Return the strongest contact of each pair of bodies, in the order of their frames."""
    strongest: dict[Pair, Touch] = {}
    for touch in touches:
        pair = (touch.one, touch.two)
        if pair not in strongest or touch.force > strongest[pair].force:
            strongest[pair] = touch
    return sorted(strongest.values(), key=lambda touch: touch.frame)


def _is_intended(pair: Pair, touched: set[str], moved: set[str], intended: IntendedContacts) -> bool:
    """Return whether a contact of a robot or a moved body is intended.

    `moved` are the bodies `touched` by fingers, and the bodies that rest on these.
    """
    (part, robot), (other_part, other_robot) = map(_part, pair)
    if part and other_part:
        return False
    if part:
        return part in FINGERS and pair[1] in intended.handled[robot]
    if other_part:
        return other_part in FINGERS and pair[0] in intended.handled[other_robot]
    return moved - touched >= set(pair) or pair in intended.resting or pair[::-1] in intended.resting


def _part(body: str) -> tuple[str, str]:
    """Return the part and the robot of a body, or two empty strings if it belongs to no robot."""
    part, _, robot = body.partition(" of ")
    return (part, robot) if part in ROBOT_PARTS else ("", "")


def _named(body: str) -> str:
    """Return the name of a body for use in a sentence."""
    return f"the {body}" if _part(body)[0] or body == BOARD else body
