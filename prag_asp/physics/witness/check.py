"""Check a witness in a fresh simulator: every state is loaded anew, nothing of the search is trusted."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from itertools import pairwise

from prag_asp.domain.scene import Scene
from prag_asp.errors import SceneError
from prag_asp.physics.facts import Effect, Problem, problem
from prag_asp.physics.geometry import Pose, compose, finite, invert, turn_between, yaw_quaternion
from prag_asp.physics.predicates import PREDICATES
from prag_asp.physics.search.grasping import LIFT
from prag_asp.physics.situation import Situation, Standing, fixed_pose
from prag_asp.physics.verdict import TRANSIT, ArmState, Moment, Waypoint, Witness
from prag_asp.physics.witness.handling import carried_along, handling_problems, opening_problems, openings_at
from prag_asp.physics.world.collisions import arm_collision, colliding
from prag_asp.physics.world.simulator import Simulator, open_simulator
from prag_asp.physics.world.support import riders, unsupported
from prag_asp.space.task import Task

POSITION_TOLERANCE = 1e-4
TURN_TOLERANCE = 1e-3
LIMIT_TOLERANCE = 1e-9


def check_witness(task: Task, witness: Witness, scene: Scene) -> list[str]:
    """Return what is wrong with a witness of a task, nothing where it passes; `open_witness_check` checks many.

    Every state is loaded into a fresh simulator: all numbers are finite, joints within their limits, the
    facts that are known to hold do and the others do not, nothing collides or falls, the simulator's own
    forward kinematics agrees with the grasp of the held object, and only what an action moves has moved.

    Raises:
        SceneError: the task speaks about something for which the scene has no shape.
    """
    with open_witness_check(scene) as check:
        return check(task, witness)


@contextmanager
def open_witness_check(scene: Scene) -> Iterator[Callable[[Task, Witness], list[str]]]:
    """Yield a function like `check_witness` for tasks of one scene, which checks them all in one simulator."""
    with open_simulator(scene) as simulator:
        yield lambda task, witness: _checked(task, witness, scene, simulator)


def _checked(task: Task, witness: Witness, scene: Scene, simulator: Simulator) -> list[str]:
    """Return what is wrong with a witness of a task."""
    seen = problem(task, scene)
    if len(witness.moments) != len(seen.states) or len(witness.motions) != len(seen.effects):
        return [
            f"the witness has {len(witness.moments)} states and {len(witness.motions)} motions; "
            f"the task has {len(seen.states)} states and {len(seen.effects)} actions"
        ]
    unsized = [entity for entity in seen.objects if entity in scene.ranges and entity not in witness.sizes]
    if unsized:
        return [f"the witness has no size of {', '.join(unsized)}"]
    try:
        simulator.use(scene.with_sizes(witness.sizes))
    except SceneError as error:
        return [str(error)]
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
        broken = list(broken_numbers(moment, seen, simulator))
        yield from (f"{where}: {text}" for text in broken)
        if not broken:
            yield from (f"{where}: {text}" for text in _state_problems(moment, seen, k, simulator))
    for k, motion in enumerate(witness.motions):
        before, after = witness.moments[k], witness.moments[k + 1]
        where = f"action {k + 1}, {seen.effects[k].action}"
        broken = [text for moment in (before, after) for text in broken_numbers(moment, seen, simulator)]
        if not broken:
            yield from (f"{where}: {text}" for text in _motion_problems(motion, before, after, simulator))
            yield from (f"{where}: {text}" for text in _stray(seen.effects[k], before, after, simulator))


def broken_numbers(moment: Moment, seen: Problem, simulator: Simulator) -> Iterator[str]:
    """Yield missing objects, numbers that are not finite, and what is beyond the limits of the robot."""
    for entity in seen.objects:
        if entity not in moment.poses:
            yield f"{entity} has no pose"
        elif not finite(moment.poses[entity]):
            yield f"the pose of {entity} is not a finite position and rotation"
    yield from opening_problems(moment, seen, simulator.scene)
    for entity in moment.poses:
        if entity not in simulator.bodies:
            yield f"{entity} is not in the scene"
    if sorted(moment.arms()) != sorted(simulator.arms):
        yield f"it has the arms {_arms(moment.arms())}; the scene has {_arms(simulator.arms)}"
        return
    for name, arm in moment.arms().items():
        yield from _broken_arm(name, arm.joints, arm.width, simulator)
        if (arm.held is None) != (arm.grasp is None):
            yield "a held object and its grasp go together"
        elif arm.held is not None and (arm.held not in moment.poses or not finite(arm.grasp or Pose((0, 0, 0)))):
            yield f"the grasp of {arm.held} is not a finite position and rotation"


def _arms(names: Iterable[str]) -> str:
    """Return the names of some arms; a single robot has none."""
    return ", ".join(name or "one without a name" for name in names)


def _broken_arm(name: str, joints: tuple[float, ...], width: float, simulator: Simulator) -> Iterator[str]:
    """Yield joint angles and openings that a robot cannot take."""
    if name not in simulator.arms:
        yield f"there is no robot {name}"
        return
    robot = simulator.arms[name].robot
    if len(joints) != len(robot.lower) or not all(map(math.isfinite, (*joints, width))):
        yield "the arm needs seven finite joint angles and a finite opening"
    elif not robot.within_limits(joints, LIMIT_TOLERANCE):
        yield f"the joint angles {tuple(round(angle, 4) for angle in joints)} are beyond the limits"
    elif not -LIMIT_TOLERANCE <= width <= robot.opening + LIMIT_TOLERANCE:
        yield f"the gripper cannot open {width:.4f} m"


def _state_problems(moment: Moment, seen: Problem, k: int, simulator: Simulator) -> Iterator[str]:
    """Yield wrong facts of a state, collisions, falling objects and a held object out of the hand."""
    simulator.place(moment.poses, moment.openings)
    poses = {entity: simulator.read(entity) for entity in moment.poses}
    situation = _situation(simulator, poses, moment.openings, moment.arms(), moment.robot)
    for entity in simulator.scene.fixed:
        if entity in poses and not _near(fixed_pose(simulator.scene, entity), poses[entity]):
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
        own = _situation(simulator, poses, moment.openings, moment.arms(), name)
        hit = arm_collision(simulator, own, arm.joints, arm.width, arm.held or _at(own))
        if hit is not None:
            yield f"the arm collides with {hit.other}"
        if arm.held is not None and arm.grasp is not None:
            expected = compose(own.tool, arm.grasp)
            if not _near(expected, poses[arm.held]):
                yield f"{arm.held} is not where the gripper holds it"


def _situation(
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


def _motion_problems(
    motion: tuple[Waypoint, ...], before: Moment, after: Moment, simulator: Simulator
) -> Iterator[str]:
    """Yield waypoints that the arm cannot take, approaches that are not straight above, and a wrong end."""
    if not motion:
        yield "it has no waypoint"
        return
    heights: list[Pose] = []
    for waypoint in motion:
        broken = list(_broken_arm(waypoint.robot, waypoint.joints, waypoint.width, simulator))
        if waypoint.held is not None and waypoint.held not in before.poses:
            broken.append(f"it holds {waypoint.held}, which has no pose")
        if broken:
            yield from (f"{waypoint.name}: {text}" for text in broken)
            return
        simulator.turn_to(waypoint.robot)
        simulator.pose_arm(waypoint.joints, waypoint.width)
        heights.append(tool_in(simulator))
    stops = [(waypoint.name, pose) for waypoint, pose in zip(motion, heights, strict=True) if waypoint.name != TRANSIT]
    for (name, high), (other, low) in pairwise(stops):
        if (name, other) == ("approach", "at") and not _straight_above(high, low):
            yield f"its approach is not {LIFT * 100:.0f} cm straight above the object"
    wrong = list(handling_problems(motion, heights, before, after, simulator.scene))
    yield from wrong
    arms = before.arms()
    for i, waypoint in enumerate(() if wrong else motion):
        grasp = arms[waypoint.robot].grasp if waypoint.held == arms[waypoint.robot].held else None
        if waypoint.held is not None and grasp is None:
            grasp = after.arms()[waypoint.robot].grasp
        arms[waypoint.robot] = ArmState(waypoint.joints, waypoint.width, waypoint.held, grasp)
        if i < len(motion) - 1:
            openings, moving = openings_at(motion, i, before), waypoint.name == TRANSIT
            hit = _waypoint_collision(arms, waypoint.robot, (before, after), openings, simulator, moving)
            if hit is not None:
                yield f"{waypoint.name}: {hit}"
    for name, arm in () if wrong else after.arms().items():
        if arms[name][:3] != arm[:3]:
            yield "its last waypoint is not the arm of the next state"


def _waypoint_collision(
    arms: Mapping[str, ArmState],
    robot: str,
    around: tuple[Moment, Moment],
    openings: Mapping[str, float],
    simulator: Simulator,
    moving: bool,
) -> str | None:
    """Return what collides at a waypoint, objects where they are then; None where all is free.

    Furniture is checked, and where the arm is `moving` what it carries.
    """
    before, after = around
    poses = carried_along(before.poses, before.openings, openings, simulator.scene)
    situation = _situation(simulator, poses, openings, arms, robot)
    joints, width, held, grasp = arms[robot]
    if held is not None and grasp is not None:
        poses = _carried(poses, held, compose(situation.tool, grasp), simulator.scene)
    elif before.arms()[robot].held is not None:
        poses = dict(after.poses)
    situation = situation.with_poses(poses)
    carried = [entity for entity in poses if poses[entity] != before.poses[entity]] if moving else []
    hit = arm_collision(simulator, situation, joints, width, held or _at(situation))
    if hit is not None:
        return f"the arm collides with {hit.other}"
    pair = colliding(simulator, situation, [*openings, *carried], list(poses))
    return None if pair is None else f"{pair[0]} collides with {pair[1]}"


def _carried(poses: Mapping[str, Pose], entity: str, pose: Pose, scene: Scene) -> dict[str, Pose]:
    """Return all poses with one object and all that rests on it moved."""
    situation = Situation(scene, poses, Pose((0.0, 0.0, 1.0)), 0.0)
    delta = compose(pose, invert(poses[entity]))
    moved = {rider: compose(delta, poses[rider]) for rider in riders(situation, entity, set(poses) - {entity})}
    return {**poses, **moved, entity: pose}


def _stray(effect: Effect, before: Moment, after: Moment, simulator: Simulator) -> Iterator[str]:
    """Yield objects that an action has moved though it does not move them, and furniture that it has opened so."""
    for furniture, opening in after.openings.items():
        if opening != before.openings[furniture] and furniture not in effect.turns:
            yield f"{furniture} has been opened or closed"
    along = carried_along(before.poses, before.openings, after.openings, simulator.scene)
    held = (effect.grasps, effect.releases, effect.holds)
    may_move = {*effect.moved, *(entity for entity in held if entity is not None)}
    situation = Situation(simulator.scene, before.poses, Pose((0.0, 0.0, 1.0)), 0.0, openings=before.openings)
    for entity in [entity for entity in may_move if entity in before.poses]:
        may_move |= set(riders(situation, entity, set(before.poses) - {entity}))
    for entity, pose in along.items():
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
