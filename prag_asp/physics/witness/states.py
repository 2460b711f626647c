"""Check a state of a witness: its facts, collisions, what would fall, and what the grippers hold."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from prag_asp.physics.facts import Problem
from prag_asp.physics.geometry import Pose, compose, turn_between, yaw_quaternion
from prag_asp.physics.predicates import PREDICATES
from prag_asp.physics.situation import Situation, Standing, fixed_pose
from prag_asp.physics.verdict import ArmState, Moment
from prag_asp.physics.world.collisions import arm_collision, colliding
from prag_asp.physics.world.simulator import Simulator
from prag_asp.physics.world.support import unsupported

POSITION_TOLERANCE = 1e-4
TURN_TOLERANCE = 1e-3


def state_problems(moment: Moment, seen: Problem, k: int, simulator: Simulator) -> Iterator[str]:
    """Yield wrong facts of a state, collisions, falling objects and a held object out of the hand."""
    simulator.place(moment.poses, moment.openings)
    poses = {entity: simulator.read(entity) for entity in moment.poses}
    situation = situation_of(simulator, poses, moment.openings, moment.arms(), moment.robot)
    for entity in simulator.scene.fixed:
        if entity in poses and not near(fixed_pose(simulator.scene, entity), poses[entity]):
            yield f"{entity} is not where the scene has it"
    for fact in seen.states[k]:
        if not fact.satisfied(situation):
            yield f"it does not hold that {fact.sentence()}"
    pair = colliding(simulator, situation, list(poses), list(poses))
    if pair is not None:
        yield f"{pair[0]} collides with {pair[1]}"
    falling = unsupported(situation, list(poses), moment.held)
    if falling is not None:
        yield f"{falling} would fall"
    for name, arm in moment.arms().items():
        own = situation_of(simulator, poses, moment.openings, moment.arms(), name)
        hit = arm_collision(simulator, own, arm.joints, arm.width, arm.held or visited(own))
        if hit is not None:
            yield f"the arm collides with {hit.other}"
        if arm.held is not None and arm.grasp is not None:
            expected = compose(own.tool, arm.grasp)
            if not near(expected, poses[arm.held]):
                yield f"{arm.held} is not where the gripper holds it"


def situation_of(
    simulator: Simulator,
    poses: Mapping[str, Pose],
    openings: Mapping[str, float],
    arms: Mapping[str, ArmState],
    acting: str,
) -> Situation:
    """Return a situation by the simulator's own forward kinematics of all arms; the one that acts comes last."""
    others = {}
    for name in sorted(arms, key=lambda name: name == acting):
        joints, width, held, grasp = arms[name]
        simulator.turn_to(name)
        simulator.pose_arm(joints, width)
        others[name] = Standing(joints, tool_in(simulator), width, held, grasp)
    own = others.pop(acting)
    return Situation(simulator.scene, poses, own.tool, own.width, openings=openings, acting=acting, others=others)


def tool_in(simulator: Simulator) -> Pose:
    """Return the pose of the tool by the simulator's own forward kinematics."""
    robot = simulator.robot
    offset = Pose((0.0, 0.0, robot.tool_offset), yaw_quaternion(robot.tool_turn))
    return compose(simulator.flange(), offset)


def visited(situation: Situation) -> str | None:
    """Return the object that the gripper is at."""
    return next((entity for entity in situation.poses if PREDICATES["at"].holds(situation, ("", entity))), None)


def near(one: Pose, two: Pose) -> bool:
    """Tell whether two poses are the same within the tolerances."""
    turn = turn_between(one.quaternion, two.quaternion)
    return math.dist(one.position, two.position) <= POSITION_TOLERANCE and turn <= TURN_TOLERANCE
