"""Check a witness in a fresh simulator: every state is loaded anew, nothing of the search is trusted."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import pairwise

from prag_asp.domain.scene import Scene
from prag_asp.physics.arm import LIFT
from prag_asp.physics.collisions import arm_collision, colliding
from prag_asp.physics.facts import Effect, Problem, problem
from prag_asp.physics.geometry import Pose, compose, finite, invert, turn_between, yaw_quaternion
from prag_asp.physics.predicates import PREDICATES
from prag_asp.physics.simulator import Simulator, open_simulator
from prag_asp.physics.situation import Situation
from prag_asp.physics.support import riders, unsupported
from prag_asp.physics.verdict import TRANSIT, Moment, Waypoint, Witness
from prag_asp.space.task import Task

POSITION_TOLERANCE = 1e-4
TURN_TOLERANCE = 1e-3
LIMIT_TOLERANCE = 1e-9
LEVEL_TOLERANCE = 1e-3


def check_witness(task: Task, witness: Witness, scene: Scene) -> list[str]:
    """Return what is wrong with a witness of a task, nothing where it passes.

    Every state is loaded into a fresh simulator: all numbers are finite, joints within their limits, the
    facts that are known to hold do and the others do not, nothing collides or falls, the simulator's own
    forward kinematics agrees with the grasp of the held object, and only what an action moves has moved.

    Raises:
        SceneError: the task speaks about something for which the scene has no shape.
    """
    seen = problem(task, scene)
    if len(witness.moments) != len(seen.states) or len(witness.motions) != len(seen.effects):
        return [
            f"the witness has {len(witness.moments)} states and {len(witness.motions)} motions; "
            f"the task has {len(seen.states)} states and {len(seen.effects)} actions"
        ]
    with open_simulator(scene) as simulator:
        return list(_problems(seen, witness, simulator))


def tool_in(simulator: Simulator) -> Pose:
    """Return the pose of the tool by the simulator's own forward kinematics."""
    robot = simulator.robot
    offset = Pose((0.0, 0.0, robot.tool_offset), yaw_quaternion(robot.tool_turn))
    return compose(simulator.flange(), offset)


def _problems(seen: Problem, witness: Witness, simulator: Simulator) -> Iterator[str]:
    """Yield what is wrong with a witness, state by state."""
    for k, moment in enumerate(witness.moments):
        where = f"state {k}"
        broken = list(_broken_numbers(moment, seen, simulator))
        yield from (f"{where}: {text}" for text in broken)
        if not broken:
            yield from (f"{where}: {text}" for text in _state_problems(moment, seen, k, simulator))
    for k, motion in enumerate(witness.motions):
        before, after = witness.moments[k], witness.moments[k + 1]
        where = f"action {k + 1}, {seen.effects[k].action}"
        broken = [text for moment in (before, after) for text in _broken_numbers(moment, seen, simulator)]
        if not broken:
            yield from (f"{where}: {text}" for text in _motion_problems(motion, before, after, simulator))
            yield from (f"{where}: {text}" for text in _stray(seen.effects[k], before, after, simulator))


def _broken_numbers(moment: Moment, seen: Problem, simulator: Simulator) -> Iterator[str]:
    """Yield missing objects, numbers that are not finite, and what is beyond the limits of the robot."""
    for entity in seen.objects:
        if entity not in moment.poses:
            yield f"{entity} has no pose"
        elif not finite(moment.poses[entity]):
            yield f"the pose of {entity} is not a finite position and rotation"
    for entity in moment.poses:
        if entity not in simulator.bodies:
            yield f"{entity} is not in the scene"
    yield from _broken_arm(moment.joints, moment.width, simulator)
    if (moment.held is None) != (moment.grasp is None):
        yield "a held object and its grasp go together"
    elif moment.held is not None and (moment.held not in moment.poses or not finite(moment.grasp or Pose((0, 0, 0)))):
        yield f"the grasp of {moment.held} is not a finite position and rotation"


def _broken_arm(joints: tuple[float, ...], width: float, simulator: Simulator) -> Iterator[str]:
    """Yield joint angles and openings that the robot cannot take."""
    robot = simulator.robot
    if len(joints) != len(robot.lower) or not all(map(math.isfinite, (*joints, width))):
        yield "the arm needs seven finite joint angles and a finite opening"
    elif not robot.within_limits(joints, LIMIT_TOLERANCE):
        yield f"the joint angles {tuple(round(angle, 4) for angle in joints)} are beyond the limits"
    elif not -LIMIT_TOLERANCE <= width <= robot.opening + LIMIT_TOLERANCE:
        yield f"the gripper cannot open {width:.4f} m"


def _state_problems(moment: Moment, seen: Problem, k: int, simulator: Simulator) -> Iterator[str]:
    """Yield wrong facts of a state, collisions, falling objects and a held object out of the hand."""
    simulator.place(moment.poses)
    simulator.pose_arm(moment.joints, moment.width)
    poses = {entity: simulator.read(entity) for entity in moment.poses}
    situation = Situation(simulator.scene, poses, tool_in(simulator), moment.width)
    for fact in seen.states[k]:
        if not fact.satisfied(situation):
            yield f"it does not hold that {fact.sentence()}"
    pair = colliding(simulator, situation, list(poses), list(poses))
    if pair is not None:
        yield f"{pair[0]} collides with {pair[1]}"
    falling = unsupported(situation, list(poses), moment.held)
    if falling is not None:
        yield f"{falling} would fall"
    touched = moment.held or _at(situation)
    hit = arm_collision(simulator, situation, moment.joints, moment.width, touched)
    if hit is not None:
        yield f"the arm collides with {hit.other}"
    if moment.held is not None and moment.grasp is not None:
        expected = compose(situation.tool, moment.grasp)
        if not _near(expected, poses[moment.held]):
            yield f"{moment.held} is not where the gripper holds it"


def _motion_problems(
    motion: tuple[Waypoint, ...], before: Moment, after: Moment, simulator: Simulator
) -> Iterator[str]:
    """Yield waypoints that the arm cannot take, approaches that are not straight above, and a wrong end."""
    if not motion:
        yield "it has no waypoint"
        return
    heights: list[Pose] = []
    for waypoint in motion:
        broken = list(_broken_arm(waypoint.joints, waypoint.width, simulator))
        if broken:
            yield from (f"{waypoint.name}: {text}" for text in broken)
            return
        simulator.pose_arm(waypoint.joints, waypoint.width)
        heights.append(tool_in(simulator))
    stops = [(waypoint.name, pose) for waypoint, pose in zip(motion, heights, strict=True) if waypoint.name != TRANSIT]
    for (name, high), (other, low) in pairwise(stops):
        if (name, other) == ("approach", "at") and not _straight_above(high, low):
            yield f"its approach is not {LIFT * 100:.0f} cm straight above the object"
    last = motion[-1]
    if (last.joints, last.width, last.held) != (after.joints, after.width, after.held):
        yield "its last waypoint is not the arm of the next state"
    for waypoint in motion[:-1]:
        hit = _waypoint_collision(waypoint, before, after, simulator)
        if hit is not None:
            yield f"{waypoint.name}: {hit}"


def _waypoint_collision(waypoint: Waypoint, before: Moment, after: Moment, simulator: Simulator) -> str | None:
    """Return what collides at a waypoint, objects where they are then; None where all is free."""
    poses = dict(before.poses)
    simulator.pose_arm(waypoint.joints, waypoint.width)
    tool = tool_in(simulator)
    grasp = before.grasp if waypoint.held == before.held else after.grasp
    if waypoint.held is not None and grasp is not None:
        poses = _carried(poses, waypoint.held, compose(tool, grasp), simulator.scene)
    elif before.held is not None:
        poses = dict(after.poses)
    situation = Situation(simulator.scene, poses, tool, waypoint.width)
    touched = waypoint.held or _at(situation)
    hit = arm_collision(simulator, situation, waypoint.joints, waypoint.width, touched)
    if hit is not None:
        return f"the arm collides with {hit.other}"
    moved = [entity for entity in poses if poses[entity] != before.poses[entity]] if waypoint.name == TRANSIT else []
    pair = colliding(simulator, situation, moved, list(poses))
    return None if pair is None else f"{pair[0]} collides with {pair[1]}"


def _carried(poses: Mapping[str, Pose], entity: str, pose: Pose, scene: Scene) -> dict[str, Pose]:
    """Return all poses with one object and all that rests on it moved."""
    situation = Situation(scene, poses, Pose((0.0, 0.0, 1.0)), 0.0)
    delta = compose(pose, invert(poses[entity]))
    moved = {rider: compose(delta, poses[rider]) for rider in riders(situation, entity, set(poses) - {entity})}
    return {**poses, **moved, entity: pose}


def _stray(effect: Effect, before: Moment, after: Moment, simulator: Simulator) -> Iterator[str]:
    """Yield objects that an action has moved though it does not move them."""
    may_move = {*effect.moved, effect.grasps, effect.releases, effect.holds} - {None}
    situation = Situation(simulator.scene, before.poses, Pose((0.0, 0.0, 1.0)), 0.0)
    for entity in [entity for entity in may_move if entity in before.poses]:
        may_move |= set(riders(situation, str(entity), set(before.poses) - {str(entity)}))
    for entity, pose in before.poses.items():
        moved = not _near(pose, after.poses.get(entity, pose))
        if moved and (entity not in may_move or entity in simulator.scene.fixed):
            yield f"{entity} has moved"


def _at(situation: Situation) -> str | None:
    """Return the object that the gripper is at."""
    return next((entity for entity in situation.poses if PREDICATES["at"].holds(situation, ("", entity))), None)


def _near(one: Pose, two: Pose) -> bool:
    """Tell whether two poses are the same within the tolerances."""
    turn = turn_between(one.quaternion, two.quaternion)
    return math.dist(one.position, two.position) <= POSITION_TOLERANCE and turn <= TURN_TOLERANCE


def _straight_above(high: Pose, low: Pose) -> bool:
    """Tell whether one pose of the tool is `LIFT` straight above another."""
    x, y, z = low.position
    return _near(high, Pose((x, y, z + LIFT), low.quaternion))
