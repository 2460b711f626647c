"""Check a state of a witness: its facts, collisions, stability and grasps."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from prag_asp.physics.grasps.body_grasps import is_hand_free
from prag_asp.physics.grasps.pads import ParallelGripper
from prag_asp.physics.predicates import PREDICATES
from prag_asp.physics.predicates.grip_friction import SLIPS, held_load, slips
from prag_asp.physics.predicates.grip_geometry import grip_width, lowest_grip
from prag_asp.physics.situation import Situation, fixed_pose
from prag_asp.physics.symbolic_facts import PhysicalTask
from prag_asp.physics.witness import Arm, Moment
from prag_asp.physics.world.collisions import arm_collision, colliding
from prag_asp.physics.world.simulator import Simulator
from prag_asp.physics.world.support import contacts, unsupported
from prag_asp.scene.boxes import Vector
from prag_asp.scene.geometry import Pose, Quaternion, compose, invert, rotate, turn_between, yaw_quaternion
from prag_asp.scene.solids import weight

POSITION_TOLERANCE = 1e-4
TURN_TOLERANCE = 1e-3
UP, DOWN = (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)


def state_problems(moment: Moment, physical: PhysicalTask, k: int, simulator: Simulator) -> Iterator[str]:
    """Yield violated facts of a state, collisions, falling objects, and held objects that are not in the gripper."""
    simulator.place(moment.poses, moment.openings)
    poses = {entity: simulator.read(entity) for entity in moment.poses}
    situation = situation_of(simulator, poses, moment.openings, moment.arms)
    for entity in simulator.scene.fixed:
        if entity in poses and not near(fixed_pose(simulator.scene, entity), poses[entity]):
            yield f"{entity} is not at its place in the scene"
    for fact in physical.states[k]:
        if not fact.is_satisfied(situation):
            yield f"this fact does not hold: {fact.sentence()}"
    pair = colliding(simulator, situation, list(poses), list(poses))
    if pair is not None:
        yield f"{pair[0]} collides with {pair[1]}"
    falling = unsupported(situation, list(poses))
    if falling is not None:
        yield f"{falling} would fall"
    for name, arm in moment.arms.items():
        simulator.turn_to(name)
        hit = arm_collision(simulator, situation, arm.joints, arm.width, arm.held or object_at_gripper(situation, name))
        if hit is not None:
            yield f"the arm collides with {hit.other}"
        if arm.held is not None and arm.grasp is not None:
            expected = compose(situation.tool(name), arm.grasp)
            if not near(expected, poses[arm.held]):
                yield f"{arm.held} is not where the gripper holds it"
            yield from _grip_problems(situation, name, arm.held)
            if slips(situation.scene, arm.held, name) is not None and not contacts(situation, arm.held, poses):
                yield f"{arm.held} slips out of the gripper"
            elif held_load(situation, arm.held, name) > SLIPS and not contacts(situation, arm.held, poses):
                yield f"{arm.held} turns between the pads"


def _grip_problems(situation: Situation, robot: str, held: str) -> Iterator[str]:
    """Yield violations of the assumptions of proofs: grasps from above, and held bodies upright and within the opening.

    A body with a model may be held from any direction; the predicate `holding` checks that both pads touch it.
    """
    if weight(situation.scene, held) > situation.robot(robot).payload:
        yield f"{held} is heavier than the payload"
    if situation.shape(held).model is not None:
        tool = compose(invert(situation.pose(held)), situation.tool(robot))
        gripper = ParallelGripper.of(situation.robot(robot))
        if not is_hand_free(situation.shape(held), gripper, tool, situation.arm(robot).width):
            yield f"the hand penetrates {held}"
        return
    if tilt(situation.tool(robot).quaternion, DOWN) > TURN_TOLERANCE:
        yield f"{held} is not held from above"
    if situation.shape(held).traits.flat and tilt(situation.pose(held).quaternion, UP) > TURN_TOLERANCE:
        yield f"{held} does not stand upright in the gripper"
    narrowest = situation.shape(held).breadth(widest=False)
    if max(narrowest, grip_width(situation, held, robot)) > situation.robot(robot).opening + POSITION_TOLERANCE:
        yield f"{held} is wider than the gripper can open"
    lowest = situation.bottom(held) + lowest_grip(situation.robot(robot), situation.shape(held).size[2])
    if situation.tool(robot).position[2] < lowest - POSITION_TOLERANCE:
        yield f"the fingers reach below {held}"


def tilt(quaternion: Quaternion, direction: Vector) -> float:
    """Return the angle, in radians, between the z axis of a frame and a direction given as a unit vector."""
    along = sum(a * b for a, b in zip(rotate(quaternion, UP), direction, strict=True))
    return math.acos(max(-1.0, min(1.0, along)))


def situation_of(
    simulator: Simulator, poses: Mapping[str, Pose], openings: Mapping[str, float], arms: Mapping[str, Arm]
) -> Situation:
    """Return a situation with tool poses that the simulator computes by forward kinematics."""
    tools = {}
    for name, arm in arms.items():
        simulator.turn_to(name)
        simulator.pose_arm(arm.joints, arm.width)
        tools[name] = tool_in(simulator)
    return Situation(simulator.scene, poses, arms, openings, tools)


def tool_in(simulator: Simulator) -> Pose:
    """Return the pose of the acting tool, which the simulator computes by forward kinematics."""
    robot = simulator.robot
    offset = Pose((0.0, 0.0, robot.tool_offset), yaw_quaternion(robot.tool_turn))
    return compose(simulator.flange(), offset)


def object_at_gripper(situation: Situation, robot: str) -> str | None:
    """Return the object at which a gripper is, or None if there is none."""
    return next((entity for entity in situation.poses if PREDICATES["at"].holds(situation, (robot, entity))), None)


def near(one: Pose, two: Pose) -> bool:
    """Return whether two poses are equal within the tolerances."""
    turn = turn_between(one.quaternion, two.quaternion)
    return math.dist(one.position, two.position) <= POSITION_TOLERANCE and turn <= TURN_TOLERANCE
