"""The states of a witness as they stand in a file, and what is wrong with one by itself."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from tests.independent.collisions import Arm, arm, overlapping
from tests.independent.frames import Frame, frame, sound
from tests.independent.grips import RUBBER, borne, in_fingers, tilted
from tests.independent.relations import Seen, grip_of, holds
from tests.independent.statics import falling, rests
from tests.independent.tolerances import GRIP_FORCE, HANDLE, LIGHT, MOVED, ROUNDING, STRAINED, TURNED
from tests.independent.world import Layout, World


@dataclass(frozen=True)
class Hand:
    """An arm at a moment: joint angles, how far its gripper is open, what it holds, and that in the frame of the tool.

    Of furniture it holds the handle; its grip is then the tool in the frame of the joint. `load` are the places, in the
    same frame, of what stands on what it holds, or lies in it, and moves along.
    """

    joints: tuple[float, ...]
    width: float
    held: str | None = None
    grip: Frame | None = None
    load: Mapping[str, Frame] = field(default_factory=dict)


@dataclass(frozen=True)
class Moment:
    """One state of a witness, or what is where at a waypoint."""

    layout: Layout
    hands: Mapping[str, Hand]

    @property
    def world(self) -> World:
        return self.layout.world

    def tool(self, robot: str) -> Frame:
        return self.world.robots[robot].tool(self.hands[robot].joints)

    def seen(self) -> Seen:
        """Return what a predicate can see of it."""
        return Seen(
            self.layout,
            {name: self.tool(name) for name in self.hands},
            {name: hand.width for name, hand in self.hands.items()},
        )

    def arm(self, robot: str) -> Arm:
        hand = self.hands[robot]
        return arm(self.world.robots[robot], hand.joints, hand.width)

    def held(self) -> set[str]:
        """Return what is held by any arm."""
        return {hand.held for hand in self.hands.values() if hand.held is not None}

    def with_hand(self, robot: str, hand: Hand, layout: Layout | None = None) -> Moment:
        """Return the moment with one arm changed, and the bodies elsewhere if so."""
        return replace(self, layout=layout or self.layout, hands={**self.hands, robot: hand})


def same(one: Frame, two: Frame) -> bool:
    """Tell whether two frames are the same within the tolerances."""
    far, angle = one.offset(two)
    return far <= MOVED and angle <= TURNED


def broken(data: Mapping[str, Any], named: set[str], world: World) -> Iterator[str]:
    """Yield why a moment in a file cannot even be computed with."""
    poses, openings = data["poses"], data.get("openings", {})
    if not named | (world.places.keys() & world.parts.keys()) <= set(poses) <= set(world.parts):
        yield "a body is missing, or is not in the scene"
    if not all(sound(pose) for pose in poses.values()):
        yield "a pose is not a finite place and rotation"
    if set(openings) != set(poses) & set(world.furniture):
        yield "furniture has no opening, or something else has one"
    elif not all(-ROUNDING <= at <= world.furniture[name].limit + ROUNDING for name, at in openings.items()):
        yield "furniture is open beyond its limit"
    if set(data["arms"]) != set(world.robots):
        yield "an arm is missing, or is not in the scene"
        return
    for name, each in data["arms"].items():
        if not world.robots[name].fits(each["joints"], float(each["width"])):
            yield "the arm or the gripper is beyond its limits"
        if (each["held"] is None) != (each["grasp"] is None) or each["held"] not in (None, *poses):
            yield "the held body and its grasp do not go together"
        elif each["grasp"] is not None and not sound(each["grasp"]):
            yield "the grasp is not a finite place and rotation"


def read(data: Mapping[str, Any], world: World) -> Moment:
    """Return a moment of a file."""
    poses = {name: frame(pose) for name, pose in data["poses"].items()}
    hands = {
        name: Hand(tuple(each["joints"]), each["width"], each["held"], each["grasp"] and frame(each["grasp"]))
        for name, each in data["arms"].items()
    }
    return Moment(Layout(world, poses, data.get("openings", {})), hands)


def state_problems(moment: Moment, before: Moment | None) -> Iterator[str]:
    """Yield what bodies and arms are in, what falls and what is not held; `before` is known to be told already."""
    layout, world = moment.layout, moment.world
    if before is None or not (_unmoved(before.layout, layout) and before.held() <= moment.held()):
        yield from overlapping(layout, layout.poses)
        body = falling(layout, moment.held())
        if body is not None:
            yield f"{body} falls"
    for name, place in world.places.items():
        if name in layout.poses and not same(layout.poses[name], place):
            yield f"{name} is not where the scene has it"
    seen = moment.seen()
    for robot, hand in moment.hands.items():
        yield from arm_problems(moment, robot)
        if hand.held is not None and hand.grip is not None:
            if not same(moment.tool(robot) @ hand.grip, layout.poses[hand.held]):
                yield f"{hand.held} is not where the gripper holds it"
            if not holds(seen, "holding", (robot, hand.held), True):
                yield f"the gripper does not grip {hand.held}"
            elif hand.held in world.models:
                yield from _strain(moment, robot, hand.held)


def _strain(moment: Moment, robot: str, held: str) -> Iterator[str]:
    """Yield that a finger is in what is held, or that it slips, turns or tilts in the hand where it is in the air."""
    layout, world = moment.layout, moment.world
    found = grip_of(moment.seen(), robot, held)
    parts = [(solid.part, solid.place) for solid in layout.body(held).solids]
    if in_fingers(parts, moment.tool(robot), moment.hands[robot].width):
        yield f"a finger is in {held}"
    if found is None or rests(layout, held):
        return
    bears = 2 * RUBBER * world.frictions[held] * GRIP_FORCE
    if 9.81 * world.masses[held] > STRAINED * bears:
        yield f"{held} slips out of the gripper"
    tool = moment.tool(robot)
    x, z = np.mean(found.centres, axis=0)
    weight = 9.81 * world.masses[held]
    lever = layout.centre(held) - tool.at
    down = tool.turn.T @ np.array([0.0, 0.0, -weight])
    torque = np.cross(tool.turn.T @ lever - np.array([x, 0.0, z]), down)
    if abs(torque[1]) > STRAINED * borne(found, world.frictions[held], GRIP_FORCE):
        yield f"{held} turns between the pads"
    torque = np.cross(tool.turn.T @ lever, down)
    if tilted(found, torque, world.frictions[held], min(GRIP_FORCE, LIGHT * weight)) > STRAINED:
        yield f"{held} tilts out of the pads"


def _unmoved(one: Layout, two: Layout) -> bool:
    """Tell whether nothing at all has moved."""
    poses = ((one.poses[name], two.poses[name]) for name in one.poses)
    return one.openings == two.openings and all((a.at == b.at).all() and (a.turn == b.turn).all() for a, b in poses)


def arm_problems(moment: Moment, robot: str) -> Iterator[str]:
    """Yield what an arm is in; its fingers may touch what it holds, and a handle that they are at."""
    layout, own, hand = moment.layout, moment.arm(robot), moment.hands[robot]
    if own.in_table(layout):
        yield "the arm is in the table"
    touched = () if hand.held is None else (hand.held,)
    solid = [name for name in touched if name not in moment.world.furniture]
    for name in own.in_bodies(layout, layout.poses, solid, at_handle(moment, robot)):
        yield f"the arm is in {name}"
    if own.in_itself():
        yield "the arm is in itself"
    for other in moment.hands:
        if other != robot and own.in_arm(moment.arm(other)):
            yield f"the arm is in that of {other}"


def at_handle(moment: Moment, robot: str) -> str | None:
    """Return the furniture at whose handle a gripper is."""
    at = moment.tool(robot).at
    for name, furniture in moment.world.furniture.items():
        if name in moment.layout.poses:
            joint = moment.layout.joint(name)
            if np.linalg.norm(joint.turn @ furniture.grip + joint.at - at) <= HANDLE:
                return name
    return None
