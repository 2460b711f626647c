"""Which contacts a task asks for, and which others there are in what is recorded.

Told are the contacts of a robot, and of what it moves: bodies that a finger touches, and what rests on those. A task
asks for

- the fingers of a gripper and the object that it holds, takes, lets go or is at, before or after the action; and the
  furniture that the action opens or closes;
- what the robot moves and what it rests on, or what rests on it, in the state before the action or after it;
- two bodies that rest on what the robot moves.

Any other is a fault, whichever two bodies touch, where it presses by more than `GENTLE`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from prag_asp.physics.predicates import Gripper
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import Fact, PhysicalTask
from prag_asp.physics.witness import ROBOT_PARTS
from prag_asp.physics.world.support import TABLE, contacts

GENTLE = 1.0
"""Newtons that no contact exceeds for which a task does not ask."""

ARM, *FINGERS = ROBOT_PARTS
BOARD = "table"
Pair = tuple[str, str]


class Touch(NamedTuple):
    """Two bodies that press on each other in a frame, with the largest force in newtons since the frame before."""

    frame: int
    one: str
    two: str
    force: float

    def sentence(self) -> str:
        """Return in plain words that the bodies press on each other."""
        return f"{_named(self.one)} presses on {_named(self.two)} with {self.force:.1f} N"


@dataclass(frozen=True)
class IntendedContacts:
    """The contacts that a task asks for during an action.

    `handled` are the bodies that the fingers of each robot may touch; `resting` are pairs of bodies of which the first
    rests on the second before the action or after it.
    """

    handled: Mapping[str, frozenset[str]]
    resting: frozenset[Pair]


def intended_contacts(physical: PhysicalTask, number: int, *around: Situation) -> IntendedContacts:
    """Return the contacts that a task asks for during an action, counted from 1; 0 is before the first.

    `around` are the situations before and after it.
    """
    states = physical.states[max(0, number - 1) : number + 1]
    effect = physical.effects[number - 1] if number else None
    handled = {}
    for robot in around[0].scene.robots:
        bodies: set[str | None] = {fact.arguments[1] for facts in states for fact in facts if _at_hand(fact, robot)}
        if effect is not None and effect.robot in (None, robot):
            bodies |= {effect.grasps, effect.releases, effect.holds, effect.visits, *effect.turns}
        handled[robot] = frozenset(body for body in bodies if body is not None)
    return IntendedContacts(handled, frozenset(pair for situation in around for pair in _resting(situation)))


def unintended_contacts(touches: Iterable[Touch], wanted: IntendedContacts) -> list[Touch]:
    """Return the contacts of an action for which the task does not ask, of each two bodies the one with most force."""
    found: dict[Pair, Touch] = {}
    for together in _frames(touches):
        moved = _moved(together, wanted)
        for touch in together:
            pair = (touch.one, touch.two)
            if touch.force > GENTLE and not _is_intended(touch, moved, wanted):
                worst = found.get(pair)
                found[pair] = touch if worst is None or touch.force > worst.force else worst
    return sorted(found.values(), key=lambda touch: touch.frame)


class _Moved(NamedTuple):
    """What robots move: the bodies that their fingers touch, and those that rest on these."""

    touched: frozenset[str]
    riding: frozenset[str]


def _moved(touches: Iterable[Touch], wanted: IntendedContacts) -> _Moved:
    """Return what the robots move in a frame."""
    pairs = [pair for touch in touches for pair in ((touch.one, touch.two), (touch.two, touch.one))]
    touched = {two for one, two in pairs if _part(one)[0] in FINGERS and not _part(two)[0]} - {BOARD}
    riding = set(touched)
    while more := {upper for upper, lower in wanted.resting if lower in riding} - riding:
        riding |= more
    return _Moved(frozenset(touched), frozenset(riding - touched))


def _is_intended(touch: Touch, moved: _Moved, wanted: IntendedContacts) -> bool:
    """Return whether a task asks for a contact, or no robot has to do with it."""
    (part, robot), (other_part, other_robot) = _part(touch.one), _part(touch.two)
    if part and other_part:
        return False
    if part:
        return part in FINGERS and touch.two in wanted.handled[robot]
    if other_part:
        return other_part in FINGERS and touch.one in wanted.handled[other_robot]
    pair = {touch.one, touch.two}
    if pair.isdisjoint(moved.touched | moved.riding) or pair <= moved.riding:
        return True
    return (touch.one, touch.two) in wanted.resting or (touch.two, touch.one) in wanted.resting


def _frames(touches: Iterable[Touch]) -> Iterator[Sequence[Touch]]:
    """Yield contacts by their frames."""
    frames: dict[int, list[Touch]] = {}
    for touch in touches:
        frames.setdefault(touch.frame, []).append(touch)
    yield from frames.values()


def _at_hand(fact: Fact, robot: str) -> bool:
    """Return whether a fact says that the gripper of a robot holds something or is at it."""
    return fact.value and fact.predicate.gripper in (Gripper.HOLDS, Gripper.AT) and fact.arguments[0] == robot


def _resting(situation: Situation) -> Iterator[Pair]:
    """Yield each body with what it rests on."""
    for entity in situation.poses:
        for contact in contacts(situation, entity, situation.poses):
            yield entity, BOARD if contact.support == TABLE else contact.support


def _part(body: str) -> tuple[str, str]:
    """Return which part of which robot a body is, two empty texts where it is of none."""
    part, _, robot = body.partition(" of ")
    return (part, robot) if part in ROBOT_PARTS else ("", "")


def _named(body: str) -> str:
    """Return how a sentence names a body."""
    return f"the {body}" if _part(body)[0] or body == BOARD else body
